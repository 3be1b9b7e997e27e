/* run_case.c - runs a case frame by frame, and the checks after each. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contract.h"
#include "devices.h"
#include "run_case.h"
#include "../../examples/frame/runner.h"

struct subject {
    device     *device;
    const char *from, *to;
    hbil_plan   plan;               /* of the last case */
    char       *text;               /* of a pass, for subject_plant */
};

subject *subject_open(const char *name, char *error, size_t error_size)
{
    subject *s = (subject *)calloc(1, sizeof *s);
    if (!s) return frame_error(error, error_size, "out of memory"), NULL;
    s->device = device_open(name, error, error_size);
    s->text = (char *)malloc(4 * HBIL_GLSL_MAX);
    if (s->device && s->text && device_hook(s->device, case_hook)) return s;
    if (s->device) frame_error(error, error_size, "out of memory");
    subject_close(s);
    return NULL;
}

void subject_close(subject *s)
{
    if (!s) return;
    device_close(s->device);
    free(s->text);
    free(s);
}

const char *subject_name(const subject *s)   { return device_name(s->device); }
int32_t     subject_target(const subject *s) { return runner_target(device_target(s->device)); }

void subject_plant(subject *s, const char *from, const char *to)
{
    s->from = from;
    s->to = to;
}

/* 0: out of memory. */
static int plant(subject *s)
{
    char *plain = s->text, *changed = s->text + 2 * HBIL_GLSL_MAX, *at, *copy = changed;
    int32_t p;
    if (!s->from) return 1;
    for (p = (int32_t)s->plan.pass_count - 1; p >= 0; --p) {
        if (hbil_emit_glsl_hook(&s->plan, p, case_hook, plain, 2 * HBIL_GLSL_MAX, NULL, NULL) != HBIL_OK) continue;
        if (!strstr(plain, s->from)) continue;
        for (; (at = strstr(plain, s->from)) != NULL; plain = at + strlen(s->from)) {
            memcpy(copy, plain, (size_t)(at - plain));
            copy += at - plain;
            strcpy(copy, s->to);
            copy += strlen(s->to);
        }
        strcpy(copy, plain);
        return device_text(s->device, s->plan.passes[p].name, changed);
    }
    return device_text(s->device, NULL, NULL);
}

static run_result say(verdict *out, int frame, const char *kind, const char *why)
{
    out->frame = frame;
    snprintf(out->kind, sizeof out->kind, "%.63s", kind);
    snprintf(out->why, sizeof out->why, "frame %d: %.300s", frame, why);
    return RUN_FAILS;
}

/* --------------------------------------------------------------------------------------------------------------- checks */

/* What history may hold: the brightest of all frames since it was reset, as one frame. */
typedef struct bound { hbil_frame frame; hbil_config live; image radiance; double most; } bound;

static double live_or(const hbil_config *config, float live, float baked, uint32_t bit)
{
    return (double)(config->dynamic & bit && live != 0 ? live : baked);
}

static void widen(const hbil_plan *plan, const test_case *c, int i, const image *inputs, bound *b)
{
    const hbil_config *k = &plan->config, *live = &c->live[i];
    const int32_t t = hbil_plan_texture(plan, "radiance");
    const int keeps = k->temporal == HBIL_TEMPORAL_YES && !c->frame[i].reset && i;
    const double near = live_or(k, live->near_intensity, k->near_intensity, HBIL_DYNAMIC_NEAR_INTENSITY);
    const double far = live_or(k, live->far_intensity, k->far_intensity, HBIL_DYNAMIC_FAR_INTENSITY);
    const double most = contract_brightest(plan, &c->frame[i], inputs) / near;
    const hbil_config last = b->live;
    float colour[3];
    int j;
    memcpy(colour, b->frame.far_color, sizeof colour);
    b->frame = c->frame[i];
    b->frame.live = &b->live;
    b->live = *live;
    b->live.near_intensity = (float)(keeps ? fmax(near, (double)last.near_intensity) : near);
    b->live.far_intensity = (float)(keeps ? fmax(far, (double)last.far_intensity) : far);
    for (j = 0; j < 3 && keeps; ++j) b->frame.far_color[j] = fmaxf(colour[j], b->frame.far_color[j]);
    if (!keeps || most >= b->most) {
        b->most = most;
        memset(&b->radiance, 0, sizeof b->radiance);
        if (t >= 0) b->radiance = inputs[t];
    } else {
        b->live.firefly = last.firefly;
    }
}

static run_result check_contract(const hbil_plan *plan, const bound *b, int i, const image *inputs, const image *outputs, verdict *out)
{
    const int32_t t = hbil_plan_texture(plan, "radiance");
    image mine[HBIL_MAX_TEXTURES];
    char why[256], kind[64], *end;
    memcpy(mine, inputs, sizeof mine);
    if (t >= 0) mine[t] = b->radiance;
    if (contract_holds(plan, &b->frame, mine, outputs, why, sizeof why)) return RUN_HOLDS;
    end = strpbrk(why, ",:");
    snprintf(kind, sizeof kind, "%.*s: %s", end ? (int)(end - why) : 20, why,
             strstr(why, "nan is") || strstr(why, "inf is") ? "not finite" : strstr(why, "longer") ? "too long" : "out of range");
    return say(out, i, kind, why);
}

/* Is that no surface, whatever else is? 0 where rounding decides. */
static int is_sky(const hbil_config *c, const hbil_frame *f, float raw)
{
    const double limit = live_or(c, f->live->sky_depth, c->sky_depth, HBIL_DYNAMIC_SKY_DEPTH);
    if (raw != raw) return 1;
    if (raw != 0 && fabs((double)raw) < 1e-30) return 0; /* some devices flush denormals */
    if (c->depth == HBIL_DEPTH_LINEAR) return (double)raw >= limit || (c->projection == HBIL_PROJECTION_PERSPECTIVE && raw <= 0);
    return c->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED ? raw <= 0 : raw >= 1;
}

static double clean(float v) { return v > 0 ? fmin((double)v, 60000) : 0; }

static run_result check_sky(const hbil_plan *plan, const hbil_frame *f, int i, const image *inputs, const image *outputs, verdict *out)
{
    const image *depth = &inputs[hbil_plan_texture(plan, "depth")];
    const int32_t d = hbil_plan_texture(plan, "direct");
    uint32_t t, x, y;
    int layer, k;
    for (t = 0; t < plan->texture_count; ++t) {
        const image *img = &outputs[t];
        const char *name = plan->textures[t].name;
        const int open = strstr("ao uniform_ao specular_occlusion multi_bounce", name) != NULL, composite = strcmp(name, "composite") == 0;
        if (plan->textures[t].life != HBIL_LIFE_OUTPUT || !img->data) continue;
        for (layer = 0; layer < image_slices(img); ++layer)
            for (y = 0; y < f->height; ++y)
                for (x = 0; x < f->width; ++x)
                    for (k = 0; k < (img->channels < 3 ? img->channels : 3); ++k) {
                        const double v = (double)img->data[(((uint32_t)(layer * img->height) + y) * (uint32_t)img->width + x) *
                                                           (uint32_t)img->channels + (uint32_t)k];
                        double want = open;
                        char kind[64], why[200];
                        if (!is_sky(&plan->config, f, depth->data[y * (uint32_t)depth->width + x])) break;
                        if (composite) want = clean(inputs[d].data[(y * (uint32_t)inputs[d].width + x) * 3 + (uint32_t)k]);
                        if (fabs(v - want) < 1e-30) continue; /* denormals may be flushed */
                        snprintf(kind, sizeof kind, "%s: sky", name);
                        snprintf(why, sizeof why, "%s, pixel (%u, %u), channel %d: %.9g on the sky, not %g", name, x, y, k, v, want);
                        return say(out, i, kind, why);
                    }
    }
    return RUN_HOLDS;
}

/* Does near + ao = 1 follow from the config? */
static int is_balanced(const hbil_config *c)
{
    const uint32_t taste = HBIL_DYNAMIC_FIREFLY | HBIL_DYNAMIC_NEAR_INTENSITY | HBIL_DYNAMIC_AO_EXPONENT;
    return (c->outputs & HBIL_OUTPUTS_AO) && (c->outputs & HBIL_OUTPUTS_NEAR) &&
           (c->estimator == HBIL_ESTIMATOR_HORIZON || c->estimator == HBIL_ESTIMATOR_BITMASK) && c->facing == HBIL_FACING_NONE &&
           c->f0 == HBIL_F0_NONE && c->firefly == 0 && c->near_intensity == 1 && c->ao_exponent == 1 && !c->seed_compat &&
           c->bounces == HBIL_BOUNCES_ONE && !(c->dynamic & taste);
}

static int all_one(const image *img)
{
    int k;
    for (k = 0; k < img->width * img->height * img->channels && img->data[k] == 1; ++k) { }
    return img->data && k == img->width * img->height * img->channels;
}

static run_result check_balance(const hbil_plan *plan, int i, const image *outputs, verdict *out)
{
    const image *ao = &outputs[hbil_plan_texture(plan, "ao")], *near = &outputs[hbil_plan_texture(plan, "near")];
    /* half floats round each of both, and each pass again */
    const double most = plan->config.storage == HBIL_STORAGE_HALF || plan->config.arithmetic == HBIL_ARITHMETIC_HALF ? 4e-3 : 1e-3;
    char why[200];
    int p, k;
    for (p = 0; p < ao->width * ao->height; ++p)
        for (k = 0; k < 3; ++k) {
            const double sum = (double)ao->data[p] + (double)near->data[p * near->channels + k];
            if (near->data[p * near->channels] == 0 && ao->data[p] == 1) break; /* sky, or open */
            if (fabs(sum - 1) <= most) continue;
            snprintf(why, sizeof why, "near + ao, pixel (%d, %d), channel %d: %.9g + %.9g is not 1", p % ao->width, p / ao->width, k,
                     (double)near->data[p * near->channels + k], (double)ao->data[p]);
            return say(out, i, "near + ao: not 1", why);
        }
    return RUN_HOLDS;
}

/* ------------------------------------------------------------------------------------------------------------------ run */

static void free_images(image images[HBIL_MAX_TEXTURES])
{
    int t;
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&images[t]);
}

/* inputs: those of the case, and plain ones where it has none; made: these, to be freed. */
static int gather(const hbil_plan *plan, const test_case *c, int i, image *inputs, image *made)
{
    int k;
    memset(inputs, 0, HBIL_MAX_TEXTURES * sizeof *inputs);
    for (k = 0; k < CASE_INPUTS; ++k) {
        const int32_t t = hbil_plan_texture(plan, case_inputs[k]);
        const image *depth = &c->input[i][CASE_DEPTH];
        if (t < 0 || plan->textures[t].life != HBIL_LIFE_INPUT) continue;
        inputs[t] = c->input[i][k];
        if (inputs[t].data) continue;
        if (!case_plain(&plan->config, &c->frame[i], k, depth->data ? depth->width : (int)c->frame[i].width,
                        depth->data ? depth->height : (int)c->frame[i].height, &made[t])) return 0;
        inputs[t] = made[t];
    }
    return 1;
}

static int same_bytes(const image *a, const image *b)
{
    const size_t n = (size_t)a->width * (size_t)a->height * (size_t)image_slices(a) * (size_t)a->channels;
    return memcmp(a->data, b->data, n * sizeof *a->data) == 0;
}

static run_result check_same(const hbil_plan *plan, int i, const image *outputs, const image *first, verdict *out)
{
    char kind[64], why[200];
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t) {
        if (plan->textures[t].life != HBIL_LIFE_OUTPUT || same_bytes(&outputs[t], &first[t])) continue;
        snprintf(kind, sizeof kind, "%s: two runs", plan->textures[t].name);
        snprintf(why, sizeof why, "%s: a second run gives other bytes", plan->textures[t].name);
        return say(out, i, kind, why);
    }
    return RUN_HOLDS;
}

static run_result check(const hbil_plan *plan, const test_case *c, int i, const bound *b, const image *inputs, const image *outputs,
                        int ones, verdict *out)
{
    run_result result = check_contract(plan, b, i, inputs, outputs, out);
    if (result == RUN_HOLDS) result = check_sky(plan, &c->frame[i], i, inputs, outputs, out);
    if (result == RUN_HOLDS && ones && is_balanced(&plan->config)) result = check_balance(plan, i, outputs, out);
    return result;
}

/* kept: outputs of each frame, or of the run before if `again`. */
static run_result sequence(subject *s, const test_case *c, int again, image kept[CASE_FRAMES][HBIL_MAX_TEXTURES], verdict *out)
{
    image inputs[HBIL_MAX_TEXTURES], made[CASE_FRAMES][HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    const int32_t radiance = hbil_plan_texture(&s->plan, "radiance");
    run_result result = RUN_HOLDS;
    char error[512];
    int i, ones = 1;
    bound b;
    memset(&b, 0, sizeof b);
    memset(made, 0, sizeof made);
    for (i = 0; i < c->frames && result == RUN_HOLDS; ++i) {
        hbil_frame frame = c->frame[i];
        frame.live = &c->live[i];
        memset(outputs, 0, sizeof outputs);
        if (!gather(&s->plan, c, i, inputs, made[i])) result = say(out, i, "out of memory", "out of memory");
        else if (!device_run(s->device, &s->plan, &frame, inputs, outputs, error, sizeof error)) result = say(out, i, "device", error);
        else {
            ones = ones && radiance >= 0 && all_one(&inputs[radiance]);
            widen(&s->plan, c, i, inputs, &b);
            result = again ? check_same(&s->plan, i, outputs, kept[i], out) : check(&s->plan, c, i, &b, inputs, outputs, ones, out);
        }
        if (again) free_images(outputs);
        else memcpy(kept[i], outputs, sizeof outputs);
    }
    for (i = 0; i < CASE_FRAMES; ++i) free_images(made[i]);
    return result;
}

run_result case_run(subject *s, const test_case *c, int twice, verdict *out)
{
    image kept[CASE_FRAMES][HBIL_MAX_TEXTURES];
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_diag item;
    run_result result;
    int i;
    memset(&item, 0, sizeof item);
    memset(out, 0, sizeof *out);
    for (i = 0; i < c->frames; ++i) {
        hbil_diags diags = { &item, 1, 0 };
        hbil_frame frame = c->frame[i];
        hbil_config config = c->config;
        frame.live = &c->live[i];
        config.target = subject_target(s);
        if ((i || hbil_plan_build(&config, &s->plan, &diags) == HBIL_OK) &&
            hbil_pack_constants(&s->plan, &frame, block, sizeof block, NULL, (diags.count = 0, &diags)) == HBIL_OK) continue;
        snprintf(out->why, sizeof out->why, "frame %d: %s", i, item.text);
        return RUN_REFUSED;
    }
    if (!plant(s)) return say(out, 0, "out of memory", "out of memory");
    memset(kept, 0, sizeof kept);
    result = sequence(s, c, 0, kept, out);
    if (result == RUN_HOLDS && twice) result = sequence(s, c, 1, kept, out);
    for (i = 0; i < c->frames; ++i) free_images(kept[i]);
    return result;
}
