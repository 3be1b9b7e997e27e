/* trial.c - the contract, what a case expects, and no undefined operation: on lavapipe with checked text, fragments on GL with their own. */
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

static const guard *removed; /* from the texts that the runners ask for */

/* Texts of all passes of a config, for trial_has. */
typedef struct variant {
    const char *config;
    hbil_plan   plan, checked;
    char       *texts[HBIL_MAX_PASSES];
} variant;

static variant **variants; /* by case; cases of the same config share one */
static int      *order, *groups; /* cases of one config after each other; number of the config */

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
    { extreme_inside, &extreme_inside_count },
};
enum { SOURCES = sizeof sources / sizeof *sources };

int trial_count(void)
{
    int i, n = 0;
    for (i = 0; i < SOURCES; ++i) n += *sources[i].count;
    return n;
}

const extreme_case *trial_case(int at)
{
    int i, index = order[at];
    for (i = 0; index >= *sources[i].count; ++i) index -= *sources[i].count;
    return &sources[i].cases[index];
}

static int draws(const extreme_case *c) { return strstr(c->config, "stage=fragment") != NULL; }

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

static variant *variant_of(const extreme_case *c, char *error, size_t size)
{
    variant *v = (variant *)need(calloc(1, sizeof *v));
    uint32_t p;
    v->config = c->config;
    if (!extreme_plan(c, draws(c) ? "gl" : "vulkan", &v->plan, error, size)) return NULL;
    v->checked = v->plan;
    if (!draws(c)) {
        checked_plan(&v->plan, &v->checked);
        show_inside(&v->checked);
    }
    for (p = 0; p < v->plan.pass_count; ++p) {
        v->texts[p] = (char *)need(malloc(HBIL_GLSL_MAX + sizeof hook));
        if (hbil_emit_glsl_hook(&v->plan, (int32_t)p, hook, v->texts[p], HBIL_GLSL_MAX + sizeof hook, NULL, NULL) != HBIL_OK) {
            snprintf(error, size, "%s: pass %s has no text", c->config, v->plan.passes[p].name);
            return NULL;
        }
    }
    return v;
}

int trial_prepare(char *error, size_t size)
{
    int i, k, n = 0, count = 0;
    const size_t room = (size_t)trial_count();
    char *placed = (char *)need(calloc(room, 1));
    variants = (variant **)need(calloc(room, sizeof *variants));
    order = (int *)need(calloc(room, sizeof *order));
    groups = (int *)need(calloc(room, sizeof *groups));
    for (i = 0; i < trial_count(); ++i) {
        const int first = n;
        if (placed[i]) continue;
        for (k = i; k < trial_count(); ++k) {
            if (placed[k]) continue;
            order[n] = k;
            if (k > i && strcmp(trial_case(n)->config, trial_case(first)->config) != 0) continue;
            placed[k] = 1;
            groups[n] = count;
            variants[n] = n > first ? variants[first] : variant_of(trial_case(n), error, size);
            if (!variants[n++]) return 0;
        }
        ++count;
    }
    free(placed);
    return 1;
}

int trial_group(int index) { return groups[index]; }

int trial_has(int index, const guard *g)
{
    static char out[HBIL_GLSL_MAX + 4096];
    const variant *v = variants[index];
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

static runner *open_for(const extreme_case *c, char *why, size_t size)
{
    static runner *runners[2];
    runner **r = &runners[draws(c)];
    if (!*r) *r = runner_open(draws(c) ? "gl" : "vulkan", 0, why, size);
    if (*r && !runner_hook(*r, hook)) return NULL;
    return *r;
}

static int judge(const extreme_case *c, const variant *v, int index, const extreme_frame *x, const image *out, char *why, size_t size)
{
    char what[400];
    const char *kind = "contract";
    const uint32_t faults = v->plan.texture_count;
    int ok = contract_holds(&v->plan, &x->frame, x->inputs, out, what, sizeof what);
    if (ok && c->expect) {
        kind = "expected";
        ok = c->expect(&v->plan, index, x, out, what, sizeof what);
    }
    if (ok && v->checked.texture_count > faults) {
        kind = "undefined";
        ok = checked_holds(&v->checked, &out[faults], what, sizeof what);
    }
    if (!ok) snprintf(why, size, "%s: frame %d: %s", kind, index, what);
    return ok;
}

int trial_run(int index, const guard *g, char *why, size_t size)
{
    const extreme_case *c = trial_case(index);
    const variant *v = variants[index];
    runner *r = open_for(c, why, size);
    int i, k, ok = r ? 1 : -1;
    if (ok == 1 && removed != g && !runner_text(r, "-", g ? g->id : "-")) return -1; /* of no pass: pipelines are made anew */
    removed = g;
    if (c->flags & (EXTREME_REFUSED | EXTREME_LONG)) return 1;
    for (i = 0; i < c->frames && ok == 1; ++i) {
        image out[HBIL_MAX_TEXTURES];
        extreme_frame *x = (extreme_frame *)need(calloc(1, sizeof *x));
        memset(out, 0, sizeof out);
        c->fill(&v->plan, i, x);
        ok = runner_run(r, &v->checked, &x->frame, x->inputs, out, 1, NULL, why, size) ? 1 : -1;
        if (ok == 1) ok = judge(c, v, i, x, out, why, size);
        for (k = 0; k < HBIL_MAX_TEXTURES; ++k) image_free(&out[k]);
        extreme_free(x);
        free(x);
    }
    return ok;
}
