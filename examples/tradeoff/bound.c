/* bound.c - see bound.h: rewrites the text of a pass, records, proves, runs. */
#include "bound.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORD_BITS 24   /* of a float that hold a whole number */
#define ROUNDED   1e-4 /* of the pixels: with a world radius, rounding moves samples across texels: 1 of 230,400 seen */

/* ---- text -------------------------------------------------------------------------------------------------------- */

/* The text with `with` in place of `length` bytes; frees the old one. NULL: out of memory, or no text came in. */
static char *splice(char *text, size_t at, size_t length, const char *with)
{
    const size_t size = text ? strlen(text) : 0, added = strlen(with);
    char        *made = text ? malloc(size + added + 1) : NULL;

    if (made) {
        memcpy(made, text, at);
        memcpy(made + at, with, added);
        memcpy(made + at + added, text + at + length, size - at - length + 1);
    }
    free(text);
    return made;
}

/* End of the argument that begins at s: its comma or bracket. */
static const char *argument_end(const char *s)
{
    int depth = 0;

    for (; *s && (depth > 0 || (*s != ',' && *s != ')')); s++) depth += (*s == '(') - (*s == ')');
    return s;
}

static unsigned name_hash(const char *s, const char *end)
{
    unsigned h = 2166136261u;

    for (; s < end; s++) h = (h ^ (unsigned char)*s) * 16777619u;
    return h;
}

/* "texelFetch(u_a, p, 0).r" becomes "bound_seen(texelFetch(u_a, p, 0).r, bound_at(<hash of u_a>u, p))". */
static char *wrap_reads(char *text, const char *call)
{
    const char *found;
    size_t      at = 0;
    char        made[512];

    while (text && (found = strstr(text + at, call)) != NULL) {
        const char *name = found + strlen(call), *name_end = argument_end(name),
                   *place = name_end + 1, *place_end = argument_end(place), *end = place_end;

        while (*end == ',') end = argument_end(end + 1);
        if (*end) end++;
        if (*end == '.')
            for (end++; isalpha((unsigned char)*end); end++) { }
        snprintf(made, sizeof made, "bound_seen(%.*s, bound_at(%uu,%.*s))", (int)(end - found), found,
                 name_hash(name, name_end), (int)(place_end - place), place);
        at = (size_t)(found - text);
        text = splice(text, at, (size_t)(end - found), made);
        at += strlen(made);
    }
    return text;
}

/* Every store stores the sum of what was read, but u_swept, which says where the next read lies. */
static char *wrap_stores(char *text)
{
    static const char call[] = "imageStore(";
    const char *found;
    size_t      at = 0;

    while (text && (found = strstr(text + at, call)) != NULL) {
        const char *name = found + strlen(call), *value = argument_end(argument_end(name) + 1) + 1;
        const size_t begin = (size_t)(value - text), end = (size_t)(argument_end(value) - text);

        at = begin;
        if (strncmp(name, "u_swept,", 8) == 0) continue;
        text = splice(splice(text, end, 0, ")"), begin, 0, " bound_sum(");
    }
    return text;
}

/* A statement in which the texts differ: in a text of these kinds that holds all of `where`, it must be there once. */
typedef struct seam { int kinds; const char *where[2], *from, *to; } seam;

#define ALL    (BOUND_RECORD | BOUND_BARE | BOUND_PROOF)
#define NAKED  (BOUND_BARE | BOUND_PROOF)
#define TRACED (BOUND_RECORD | BOUND_PROOF)

static const seam seams[] = {
    /* where the search of a pixel begins, and that of a side */
    {ALL, {"hbil_receive("}, "float z = hbil_load_depth(p);", "bound_pixel(p);\n    float z = hbil_load_depth(p);"},
    {ALL, {"hbil_go(", "hbil_radiance_at("}, "hbil_visit at = hbil_start(r);",
     "bound_side();\n    hbil_visit at = hbil_start(r);"},
    /* what decides whether a sample's radiance is read */
    {ALL, {"float hbil_horizon(", "hbil_radiance_at("}, "if (c_sample > c && dot(r.n, h) * inv > HBIL_BIAS) {",
     "if (bound_take(i, c_sample > c && dot(r.n, h) * inv > HBIL_BIAS)) {"},
    {ALL, {"void hbil_fill(", "hbil_radiance_at("}, "if (fresh != 0u) {", "if (bound_take(i, fresh != 0u)) {"},
    /* what skips samples that give nothing: the record does */
    {NAKED, {"hbil_go("}, "if (at.z >= HBIL_SKY) continue;", ""},
    {NAKED, {"void hbil_fill("}, "if (dot(r.n, h) * inv <= HBIL_BIAS) continue;", ""},
    /* of a vertex of the hull only its address */
    {NAKED, {"hbil_walk("}, "uvec4(hbil_code(at))", "uvec4(uint(at.back))"},
    {TRACED, {""}, "void main() {", "void bound_main() {"},
};

static char *cut_seams(char *text, const char *pass, int kind, char *error, size_t error_size)
{
    size_t i;

    for (i = 0; text && i < sizeof seams / sizeof *seams; i++) {
        const seam *m = &seams[i];
        const char *found;

        if (!(m->kinds & kind) || !strstr(text, m->where[0]) || (m->where[1] && !strstr(text, m->where[1]))) continue;
        found = strstr(text, m->from);
        if (!found || strstr(found + 1, m->from)) {
            frame_error(error, error_size, "pass %s: its text does not have '%s' once. Adapt the seams of bound.c",
                        pass, m->from);
            free(text);
            return NULL;
        }
        text = splice(text, (size_t)(found - text), strlen(m->from), m->to);
    }
    return text;
}

/* ---- GLSL in front of the pass's own ----------------------------------------------------------------------------- */

static const char sum_text[] =
    "uint bound_read = 0u; // sum of all that was read\n"
    "float bound_seen(float v, uint at) { bound_read += floatBitsToUint(v); return v; }\n"
    "uint bound_seen(uint v, uint at) { bound_read += v; return v; }\n"
    "vec3 bound_seen(vec3 v, uint at) {\n"
    "    uvec3 u = floatBitsToUint(v);\n"
    "    bound_read += u.x + u.y + u.z;\n"
    "    return v;\n"
    "}\n"
    "vec4 bound_sum(vec4 other) { return vec4(uintBitsToFloat(bound_read)); }\n"
    "uvec4 bound_sum(uvec4 other) { return uvec4(bound_read); }\n";

static const char no_trace_text[] =
    "uint bound_at(uint name, ivec2 p) { return 0u; }\n"
    "uint bound_at(uint name, ivec3 p) { return 0u; }\n";

/* The order of reads does not count. */
static const char trace_text[] =
    "uint bound_hash = 0u, bound_count = 0u;\n"
    "ivec2 bound_place = ivec2(-1);\n"
    "uint bound_at(uint name, ivec3 p) {\n"
    "    uint h = name ^ uint(p.x) * 0x9e3779b1u ^ uint(p.y) * 0x85ebca77u ^ uint(p.z) * 0xc2b2ae3du;\n"
    "    h = (h ^ (h >> 15)) * 0x2c1b3c6du;\n"
    "    bound_hash += (h ^ (h >> 12)) * 0x297a2d39u;\n"
    "    ++bound_count;\n"
    "    return 0u;\n"
    "}\n"
    "uint bound_at(uint name, ivec2 p) { return bound_at(name, ivec3(p, 0)); }\n";

/* A bit for each sample, HBIL_STEPS a side. */
static const char bits_text[] =
    "const int BOUND_SIDES = 24 / HBIL_STEPS; // in a channel of u_record\n"
    "uvec4 bound_bits = uvec4(0u);\n"
    "int bound_sides = 0; // that have begun\n";

static const char record_text[] =
    "void bound_pixel(ivec2 p) { bound_place = p; }\n"
    "void bound_side() { ++bound_sides; }\n"
    "bool bound_take(int i, bool real) {\n"
    "    int side = bound_sides - 1;\n"
    "    if (real) bound_bits[side / BOUND_SIDES] |= 1u << uint(side % BOUND_SIDES * HBIL_STEPS + i);\n"
    "    return real;\n"
    "}\n";

/* %s: bound_place = p, where there is a trace. */
static const char replay_text[] =
    "uint bound_word; // of this side\n"
    "void bound_pixel(ivec2 p) {\n"
    "    bound_bits = uvec4(texelFetch(u_record, p, 0));\n"
    "    %s;\n"
    "}\n"
    "void bound_side() {\n"
    "    bound_word = bound_bits[bound_sides / BOUND_SIDES] >> uint(bound_sides %% BOUND_SIDES * HBIL_STEPS);\n"
    "    ++bound_sides;\n"
    "}\n"
    "bool bound_take(int i, bool real) { return ((bound_word >> uint(i)) & 1u) != 0u; }\n";

/* %s: what places the trace of a line; and what stores the record. */
static const char main_text[] =
    "\nvoid main() {\n"
    "    bound_main();\n"
    "%s"
    "    if (bound_place.x < 0) return;\n"
    "    imageStore(u_trace, bound_place, vec4(bound_hash & 0xffffffu, bound_hash >> 24, bound_count, 0u));\n"
    "%s"
    "}\n";

/* Lines beyond the width of the frame go on below. place_of does the same. */
static const char line_text[] =
    "    ivec2 id = ivec2(gl_GlobalInvocationID.xy);\n"
    "    int width = imageSize(u_trace).x;\n"
    "    bound_place = ivec2(id.x % width, id.x / width * 2 * HBIL_SLICES + id.y);\n";

static char *put_helpers(char *text, const hbil_pass *pass, int kind, int decides)
{
    const int   traced = (kind & TRACED) != 0;
    const char *first = text ? strstr(text, "\n// ---- ") : NULL; /* behind the constants */
    const size_t at = first ? (size_t)(first - text) : 0;
    char        pixel[512], end[1024];

    snprintf(pixel, sizeof pixel, replay_text, traced ? "bound_place = p" : "");
    if (!decides) snprintf(pixel, sizeof pixel, "void bound_pixel(ivec2 p) { %s; }\n", traced ? "bound_place = p" : "");
    text = splice(text, at, 0, decides && kind == BOUND_RECORD ? record_text : pixel);
    if (decides) text = splice(text, at, 0, bits_text);
    text = splice(text, at, 0, traced ? trace_text : no_trace_text);
    text = splice(splice(text, at, 0, sum_text), at, 0, "\n");
    if (!traced || !text) return text;
    snprintf(end, sizeof end, main_text, pass->grid == HBIL_GRID_LINES ? line_text : "",
             decides && kind == BOUND_RECORD ? "    imageStore(u_record, bound_place, vec4(bound_bits));\n" : "");
    return splice(text, strlen(text), 0, end);
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* A texture of four floats a pixel of the frame, which the pass reads (INPUT) or writes (OUTPUT). */
static void add_texture(hbil_plan *plan, hbil_pass *pass, const char *name, hbil_life life)
{
    const uint8_t access = life == HBIL_LIFE_INPUT ? HBIL_ACCESS_SAMPLE : HBIL_ACCESS_WRITE;
    hbil_texture *t = &plan->textures[plan->texture_count];
    hbil_binding *bind = &pass->bindings[pass->binding_count];
    uint16_t      i;

    snprintf(t->name, sizeof t->name, "%s", name);
    t->format = HBIL_FORMAT_RGBA32F;
    t->life = (uint16_t)life;
    t->dim = HBIL_DIM_2D;
    t->div = t->mips = t->copies = t->layers = 1;
    bind->texture = (uint16_t)plan->texture_count++;
    bind->access = access;
    bind->role = life == HBIL_LIFE_INPUT ? HBIL_ROLE_SAMPLE : HBIL_ROLE_WRITE;
    bind->slot = plan->config.target == HBIL_TARGET_VULKAN; /* behind the block there; GL counts each kind for itself */
    for (i = 0; i < pass->binding_count; i++)
        if (plan->config.target == HBIL_TARGET_VULKAN || pass->bindings[i].access == access)
            bind->slot = (uint16_t)(pass->bindings[i].slot + 1);
    pass->binding_count++;
}

static char *emit(const hbil_plan *plan, int32_t pass)
{
    char *text = malloc(HBIL_GLSL_MAX);

    if (text && hbil_emit_glsl(plan, pass, text, HBIL_GLSL_MAX, NULL) == HBIL_OK) return text;
    free(text);
    return NULL;
}

/* What no text of ours can stand for; NULL: nothing. */
static const char *unfit(const hbil_plan *plan, const char *text, int decides)
{
    const int sides = decides ? WORD_BITS / plan->config.steps : 1;

    if (plan->config.stage == HBIL_STAGE_FRAGMENT) return "it is a fragment shader. Set stage=compute";
    if (strstr(text, "texture(") || strstr(text, "textureLod(") || strstr(text, "hbil_far_hook("))
        return "it reads by other means than texelFetch. Leave out far light";
    if (decides && 2 * plan->config.slices > 4 * sides)
        return "there are more decisions than the record holds, 24 / steps sides in each of four channels. Take fewer "
               "slices or steps";
    return NULL;
}

char *bound_text(const hbil_plan *plan, const char *pass, int kind, hbil_plan *out, char *error, size_t error_size)
{
    const int32_t index = hbil_plan_pass(plan, pass);
    char         *text = index < 0 ? NULL : emit(plan, index);
    const int     decides = text && strstr(text, "hbil_go(") && strstr(text, "hbil_radiance_at(");
    const char   *why = text ? unfit(plan, text, decides) : "there is no such pass, or no memory";

    free(text);
    *out = *plan;
    if (why) return frame_error(error, error_size, "pass %s: %s", pass, why), NULL;
    if (kind & TRACED) add_texture(out, &out->passes[index], "trace", HBIL_LIFE_OUTPUT);
    if (decides)
        add_texture(out, &out->passes[index], "record", kind == BOUND_RECORD ? HBIL_LIFE_OUTPUT : HBIL_LIFE_INPUT);
    text = wrap_reads(wrap_reads(emit(out, index), "texelFetch("), "imageLoad(");
    if (kind & NAKED) text = wrap_stores(text);
    frame_error(error, error_size, "out of memory");
    return put_helpers(cut_seams(text, pass, kind, error, error_size), &out->passes[index], kind, decides);
}

/* ---- on a device ------------------------------------------------------------------------------------------------- */

/* Runs the plan with another text of the pass. */
static int run_text(const lit *l, const hbil_plan *plan, const char *pass, const char *text, const image *record,
                    image out[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    const int32_t at = hbil_plan_texture(plan, "record");
    image         in[HBIL_MAX_TEXTURES];

    memcpy(in, l->in, sizeof in);
    if (at >= 0 && record) in[at] = *record;
    if (!runner_text(l->device, pass, text)) return frame_error(error, error_size, "out of memory");
    return runner_run(l->device, plan, &l->frame, in, out, repeat, ms, error, error_size);
}

/* One run; leaves the textures of ours, absent where the text writes none. */
static int run_traced(const lit *l, const char *pass, int kind, image *trace, image *record, char *error,
                      size_t error_size)
{
    static hbil_plan plan;
    image            out[HBIL_MAX_TEXTURES];
    char            *text = bound_text(&l->plan, pass, kind, &plan, error, error_size);
    const int ok = text && run_text(l, &plan, pass, text, record, out, 1, NULL, error, error_size);
    int       i;

    free(text);
    for (i = 0; ok && i < HBIL_MAX_TEXTURES; i++) {
        if (i == hbil_plan_texture(&plan, "trace")) *trace = out[i];
        else if (kind == BOUND_RECORD && i == hbil_plan_texture(&plan, "record")) *record = out[i];
        else image_free(&out[i]);
    }
    return ok;
}

/* Equal hashes and numbers wherever the pass has an invocation, but for the few where the compiler's rounding moves a
 * sample that lies between two texels? *reads: their number. */
static int same_reads(const lit *l, int32_t pass, const image *a, const image *b, double *reads)
{
    const hbil_pass *p = &l->plan.passes[pass];
    const uint32_t   width = (uint32_t)a->width, height = (uint32_t)a->height;
    hbil_dispatch    groups[HBIL_MAX_PASSES];
    uint32_t         extent[2] = {0, 0}, x, y;
    double           count = 0.0, other = 0.0;

    hbil_plan_extent(&l->plan, p->domain, width, height, extent);
    if (p->grid == HBIL_GRID_LINES) {
        hbil_plan_frame(&l->plan, &l->frame, groups);
        extent[0] = groups[pass].groups[0] * p->group[0];
        extent[1] = l->plan.textures[p->domain].layers;
    }
    for (*reads = 0.0, y = 0; y < extent[1]; y++)
        for (x = 0; x < extent[0]; x++) {
            const uint32_t row = x / width * extent[1] + y;
            const size_t   at = 4 * ((size_t)row * width + x % width);

            if (row >= height) continue;
            count += 1.0;
            other += memcmp(a->data + at, b->data + at, 3 * sizeof *a->data) != 0;
            *reads += (double)a->data[at + 2];
        }
    return other <= ROUNDED * count;
}

int bound_make(const lit *l, const char *pass, bound *b, char *error, size_t error_size)
{
    image trace[2];
    int   ok;

    memset(b, 0, sizeof *b);
    memset(trace, 0, sizeof trace);
    b->pass = pass;
    b->text = bound_text(&l->plan, pass, BOUND_BARE, &b->plan, error, error_size);
    if (!b->text) return TRADE_REFUSED;
    ok = run_traced(l, pass, BOUND_RECORD, &trace[0], &b->record, error, error_size)
         && run_traced(l, pass, BOUND_PROOF, &trace[1], &b->record, error, error_size);
    if (ok) {
        ok = same_reads(l, hbil_plan_pass(&l->plan, pass), &trace[0], &trace[1], &b->reads)
             || frame_error(error, error_size, "pass %s: without arithmetic it reads other texels", pass);
        b->reads /= (double)trace[0].width * trace[0].height;
    }
    image_free(&trace[0]);
    image_free(&trace[1]);
    if (!ok) bound_free(b);
    return ok ? TRADE_DONE : TRADE_BACKEND;
}

void bound_free(bound *b)
{
    free(b->text);
    image_free(&b->record);
    b->text = NULL;
}

unsigned part_bit(const hbil_plan *plan, const char *pass)
{
    const int32_t at = hbil_plan_pass(plan, pass);

    return at < 0 ? 0 : 1u << at;
}

int part_run(void *user, int count, double *ms, char *error, size_t error_size)
{
    const part *p = user;
    const int   passes = (int)p->l->plan.pass_count;
    double     *all = malloc((size_t)(count * passes) * sizeof *all), sum = 0.0;
    image       out[HBIL_MAX_TEXTURES];
    int         i, ok;

    if (!all) return frame_error(error, error_size, "out of memory");
    ok = p->b ? run_text(p->l, &p->b->plan, p->b->pass, p->b->text, &p->b->record, out, count, all, error, error_size)
              : run_text(p->l, &p->l->plan, NULL, NULL, NULL, out, count, all, error, error_size);
    for (i = 0; ok && i < HBIL_MAX_TEXTURES; i++) image_free(&out[i]);
    for (i = 0; i < count; i++) ms[i] = 0.0;
    for (i = 0; ok && i < count * passes; i++) {
        if (p->passes >> (i % passes) & 1u) ms[i / passes] += all[i];
        sum += all[i];
    }
    free(all);
    return ok && (sum > 0.0 || frame_error(error, error_size,
                                           "this device has no timestamps, and the time of a pass is asked for"));
}
