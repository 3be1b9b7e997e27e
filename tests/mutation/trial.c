/* trial.c - the contract, what a case expects, and no undefined operation: on lavapipe with checked text, fragments on GL with their own,
 * on the CPU (tests/twin, loose) what only that shows. */
#define HBIL_IMPLEMENTATION
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "checked.h"
#include "emit.h"
#include "trial.h"
#include "../extreme/truths.h"
#include "../extreme/contract.h"
#include "../../examples/frame/runner.h"
#include "../twin/twin.h"

static const guard *removed; /* from the texts that the runners ask for */

/* Texts of all passes of a config, for trial_has. */
typedef struct variant {
    const char *config;
    hbil_plan   plan, checked;
    char       *texts[HBIL_MAX_PASSES];
} variant;

enum { ON_VULKAN, ON_GL, ON_LOOSE, DEVICES_ALL };

/* A case, where it runs, and what it shares with the others of its config. */
typedef struct entry {
    const extreme_case *c;
    int                 device, group;
    variant            *variant;
} entry;

static entry *entries;
static int    entry_count;

/* Far light of environment=hook that no engine should return. */
static const char hook[] =
    "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
    "    if (direction.x > 0.5) return vec3(uintBitsToFloat(0x7fc00000u));\n"
    "    if (direction.y > 0.5) return vec3(-1.0);\n"
    "    return direction.z > 0.5 ? vec3(1e30) : vec3(0.5);\n"
    "}\n";

/* All that there are, one after the other. */
static const struct { const extreme_case *cases; const int *count; } sources[] = {
    { extreme_cases, &extreme_case_count }, { extreme_truths, &extreme_truth_count }, { extreme_scenes, &extreme_scene_count },
    { extreme_inside, &extreme_inside_count }, { extreme_counted, &extreme_counted_count },
};
enum { SOURCES = sizeof sources / sizeof *sources };

/* Cases of tests/extreme that kill on "loose" what lavapipe forgives. */
static const char *const loose_too[] = { "checkerboard_depth", "depth_zero", "normal_zero", "size_1x1", "H5_cone_of_what_is_wholly_hidden",
                                         "H24_light_dies_out" };

static int draws(const extreme_case *c) { return strstr(c->config, "stage=fragment") != NULL; }

int trial_count(void) { return entry_count; }
const extreme_case *trial_case(int index) { return entries[index].c; }
int trial_group(int index) { return entries[index].group; }

const char *trial_label(int index, char out[128])
{
    snprintf(out, 128, "%s%s", entries[index].c->name, entries[index].device == ON_LOOSE ? " on loose" : "");
    return out;
}

static void *need(void *p)
{
    if (p) return p;
    fprintf(stderr, "hbil-mutate: out of memory\n");
    exit(3);
}

/* Transient textures are read back, too. */
static void show_inside(hbil_plan *plan)
{
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t) {
        hbil_texture *x = &plan->textures[t];
        if (x->life == HBIL_LIFE_TRANSIENT && (x->format == HBIL_FORMAT_R32F || x->format == HBIL_FORMAT_R32UI || x->format == HBIL_FORMAT_RGBA32F))
            x->life = HBIL_LIFE_OUTPUT;
    }
}

static variant *variant_of(const extreme_case *c, int device, char *error, size_t size)
{
    variant *v = (variant *)need(calloc(1, sizeof *v));
    uint32_t p;
    v->config = c->config;
    if (!extreme_plan(c, draws(c) ? "gl" : "vulkan", &v->plan, error, size)) return NULL;
    v->checked = v->plan;
    if (device == ON_VULKAN) checked_plan(&v->plan, &v->checked);
    if (device != ON_GL) show_inside(&v->checked);
    for (p = 0; p < v->plan.pass_count; ++p) {
        v->texts[p] = (char *)need(malloc(HBIL_GLSL_MAX + sizeof hook));
        if (hbil_emit_glsl_hook(&v->plan, (int32_t)p, hook, v->texts[p], HBIL_GLSL_MAX + sizeof hook, NULL, NULL) != HBIL_OK) {
            snprintf(error, size, "%s: pass %s has no text", c->config, v->plan.passes[p].name);
            return NULL;
        }
    }
    return v;
}

static void list(const extreme_case *c, int device)
{
    entries[entry_count].c = c;
    entries[entry_count++].device = device;
}

/* All cases, in the order of their tables. */
static void list_all(void)
{
    int i, k, n = 0;
    size_t l;
    for (i = 0; i < SOURCES; ++i) n += *sources[i].count;
    entries = (entry *)need(calloc(2 * (size_t)n, sizeof *entries));
    for (i = 0; i < SOURCES; ++i)
        for (k = 0; k < *sources[i].count; ++k) {
            const extreme_case *c = &sources[i].cases[k];
            list(c, c->flags & EXTREME_TWIN ? ON_LOOSE : draws(c) ? ON_GL : ON_VULKAN);
            for (l = 0; l < sizeof loose_too / sizeof *loose_too; ++l)
                if (strcmp(c->name, loose_too[l]) == 0) list(c, ON_LOOSE);
        }
}

/* Those of one config and device after each other: they share a variant. */
int trial_prepare(char *error, size_t size)
{
    entry *from;
    char *placed;
    int i, k, n = 0, count = 0;
    list_all();
    from = entries;
    placed = (char *)need(calloc((size_t)entry_count, 1));
    entries = (entry *)need(calloc((size_t)entry_count, sizeof *entries));
    for (i = 0; i < entry_count; ++i) {
        const int first = n;
        if (placed[i]) continue;
        for (k = i; k < entry_count; ++k) {
            if (placed[k] || from[k].device != from[i].device || strcmp(from[k].c->config, from[i].c->config) != 0) continue;
            placed[k] = 1;
            entries[n] = from[k];
            entries[n].group = count;
            entries[n].variant = n > first ? entries[first].variant : variant_of(from[k].c, from[k].device, error, size);
            if (!entries[n++].variant) return 0;
        }
        ++count;
    }
    free(placed);
    free(from);
    return 1;
}

int trial_has(int index, const guard *g)
{
    static char out[HBIL_GLSL_MAX + 4096];
    const variant *v = entries[index].variant;
    uint32_t p;
    for (p = 0; p < v->plan.pass_count; ++p)
        if (guard_remove(g, v->texts[p], out)) return 1;
    return 0;
}

hbil_result mutation_emit(const hbil_plan *plan, int32_t pass, const char *hook_text, char *buf, size_t cap, size_t *size, hbil_diags *diags)
{
    static char text[HBIL_GLSL_MAX + 4096], without[HBIL_GLSL_MAX + 8192], looks[CHECKED_TEXT_MAX];
    const char *from = text;
    hbil_plan plain;
    const int checked = checked_strip(plan, &plain);
    const hbil_result result = hbil_emit_glsl_hook(&plain, pass, hook_text, text, sizeof text, size, diags);
    if (result != HBIL_OK) return result;
    if (removed && guard_remove(removed, text, without)) from = without;
    if (checked) {
        checked_text(plan, pass, from, looks);
        from = looks;
    }
    if (size) *size = strlen(from) + 1;
    if (strlen(from) + 1 > cap) return HBIL_E_SPACE;
    strcpy(buf, from);
    return HBIL_OK;
}

/* ------------------------------------------------------------------------------------------------------------------------ runs */

static runner *runners[DEVICES_ALL];
static twin   *loose;

/* The device of a case, with texts that lack `removed`: pipelines are made anew when it has changed. */
static int open_for(int device, const guard *g, char *why, size_t size)
{
    const char *id = g ? g->id : "-"; /* a text of no pass */
    const int same = removed == g;
    removed = g;
    if (device == ON_LOOSE) {
        if (!loose) loose = (twin *)need(twin_open(TWIN_FLOAT, TWIN_STICKY | TWIN_LOOSE));
        return twin_hook(loose, hook) && (same || twin_text(loose, "-", id));
    }
    if (!runners[device]) runners[device] = runner_open(device == ON_GL ? "gl" : "vulkan", 0, why, size);
    return runners[device] && runner_hook(runners[device], hook) && (same || runner_text(runners[device], "-", id));
}

static int execute(const entry *e, int index, const extreme_frame *x, image *out, char *why, size_t size)
{
    const hbil_plan *plan = &e->variant->checked;
    uint32_t t;
    if (e->device != ON_LOOSE) return runner_run(runners[e->device], plan, &x->frame, x->inputs, out, 1, NULL, why, size);
    for (t = 0; t < plan->texture_count && index > 0 && e->c->flags & EXTREME_SPOILED; ++t)
        if (plan->textures[t].life == HBIL_LIFE_HISTORY && (index == 2 || strcmp(plan->textures[t].name, "seen") != 0)) twin_spoil(loose, (int32_t)t);
    twin_forgive(loose);
    return twin_run(loose, plan, &x->frame, x->inputs, out, why, size);
}

/* Work of the passes against the limits of a case. */
static int is_cheap(const entry *e, const extreme_frame *x, char *why, size_t size)
{
    const double pixels = (double)x->frame.width * (double)x->frame.height;
    const hbil_plan *plan = &e->variant->plan;
    int i;
    uint32_t p;
    for (i = 0; i < extreme_limit_count; ++i)
        for (p = 0; p < plan->pass_count && strcmp(extreme_limits[i].name, e->c->name) == 0; ++p) {
            const extreme_limit *l = &extreme_limits[i];
            const twin_counts n = twin_counted(loose, p);
            const double reads = (double)n.reads / pixels, writes = (double)n.writes / pixels, roots = (double)n.roots / pixels;
            if (strcmp(plan->passes[p].name, l->pass) != 0 || (reads <= l->reads && writes <= l->writes && roots <= l->roots)) continue;
            snprintf(why, size, "pass %s: %.4g reads, %.4g writes, %.4g roots per pixel, at most %g, %g and %g", l->pass, reads, writes, roots, l->reads,
                     l->writes, l->roots);
            return 0;
        }
    return 1;
}

static int judge(const entry *e, int index, const extreme_frame *x, const image *out, char *why, size_t size)
{
    char what[400];
    const char *kind = "contract";
    const variant *v = e->variant;
    const uint32_t faults = v->plan.texture_count;
    int ok = contract_holds(&v->plan, &x->frame, x->inputs, out, what, sizeof what);
    if (ok && e->c->expect && !(e->device == ON_LOOSE && e->c->flags & EXTREME_EXACT)) {
        kind = "expected";
        ok = e->c->expect(&v->plan, index, x, out, what, sizeof what);
    }
    if (ok) {
        kind = "undefined";
        if (e->device == ON_LOOSE) ok = twin_faultless(loose, what, sizeof what);
        else if (v->checked.texture_count > faults) ok = checked_holds(&v->checked, &out[faults], what, sizeof what);
    }
    if (ok && e->device == ON_LOOSE) {
        kind = "work";
        ok = is_cheap(e, x, what, sizeof what);
    }
    if (!ok) snprintf(why, size, "%s: frame %d: %s", kind, index, what);
    return ok;
}

int trial_run(int index, const guard *g, char *why, size_t size)
{
    const entry *e = &entries[index];
    int i, k, ok = 1;
    if (e->c->flags & (EXTREME_REFUSED | EXTREME_LONG)) return 1;
    if (!open_for(e->device, g, why, size)) return -1;
    for (i = 0; i < e->c->frames && ok == 1; ++i) {
        image out[HBIL_MAX_TEXTURES];
        extreme_frame *x = (extreme_frame *)need(calloc(1, sizeof *x));
        memset(out, 0, sizeof out);
        e->c->fill(&e->variant->plan, i, x);
        ok = execute(e, i, x, out, why, size) ? 1 : -1;
        if (ok == 1) ok = judge(e, i, x, out, why, size);
        for (k = 0; k < HBIL_MAX_TEXTURES; ++k) image_free(&out[k]);
        extreme_free(x);
        free(x);
    }
    return ok;
}
