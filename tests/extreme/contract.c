/* contract.c - bounds of each output, in one table. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contract.h"

#define RADIANCE_MAX 60000.0 /* HBIL_RADIANCE_MAX of the shaders */
#define ROUND 1.01           /* packed radiance .002, half floats .0005, fp32 sums of 64 slices, the fit F0(ao) .0061 */
#define SPHERE 12.56637062

unsigned long long contract_values;

static const image *input(const hbil_plan *plan, const image inputs[HBIL_MAX_TEXTURES], const char *name)
{
    const int32_t t = hbil_plan_texture(plan, name);
    return t < 0 || plan->textures[t].life != HBIL_LIFE_INPUT ? NULL : &inputs[t];
}

/* The largest channel as the shaders read it: NaN and negative are 0. */
static double largest(const image *img)
{
    double most = 0;
    size_t i, n;
    if (!img || !img->data) return 0;
    n = (size_t)img->width * (size_t)img->height * (size_t)image_slices(img) * (size_t)img->channels;
    for (i = 0; i < n; ++i)
        if ((double)img->data[i] > most) most = (double)img->data[i];
    return fmin(most, RADIANCE_MAX);
}

static double far_bound(const hbil_plan *plan, const hbil_frame *frame)
{
    const hbil_config *c = &plan->config;
    const double intensity = (double)(c->dynamic & HBIL_DYNAMIC_FAR_INTENSITY && frame->live && frame->live->far_intensity > 0
                                          ? frame->live->far_intensity : c->far_intensity);
    double most = RADIANCE_MAX;
    int k;
    if (c->environment == HBIL_ENVIRONMENT_NONE) return 0;
    if (c->environment == HBIL_ENVIRONMENT_CONSTANT)
        for (k = 0, most = 0; k < 3; ++k) /* NaN is 0 */
            if ((double)frame->far_color[k] > most) most = fmin((double)frame->far_color[k], RADIANCE_MAX);
    return most * intensity * ROUND * (c->seed_compat & HBIL_SEED_COMPAT_SLICE_MEAN ? 1.5708 : 1.0);
}

double contract_brightest(const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES])
{
    const hbil_config *c = &plan->config;
    const hbil_config *live = frame->live;
    double most = largest(input(plan, inputs, "radiance")), firefly = (double)c->firefly, intensity = (double)c->near_intensity;
    if (c->dynamic & HBIL_DYNAMIC_FIREFLY && live && live->firefly > 0) firefly = (double)live->firefly;
    if (c->dynamic & HBIL_DYNAMIC_NEAR_INTENSITY && live && live->near_intensity > 0) intensity = (double)live->near_intensity;
    if (firefly > 0 && firefly < most) most = firefly;
    if (c->bounces == HBIL_BOUNCES_RECURSIVE) /* history may be of a brighter frame: only the limit of the format holds */
        most = RADIANCE_MAX;
    return most * intensity;
}

/* One output: its channels 0..n-1 lie in [low, high]; a vector's length is at most `length` (0: not checked). */
typedef struct bound { const char *name; int channels; double low, high, length; } bound;

static int check(const bound *b, const image *img, char *why, size_t size)
{
    const int texels = img->width * img->height * image_slices(img);
    int i, k;
    contract_values += (unsigned long long)texels * (unsigned long long)img->channels;
    for (i = 0; i < texels; ++i) {
        const float *v = img->data + (size_t)i * (size_t)img->channels;
        double l2 = 0;
        for (k = 0; k < img->channels; ++k) {
            const double x = (double)v[k];
            const int bounded = k < b->channels;
            l2 += k < 3 ? x * x : 0;
            if (x - x == 0 && (!bounded || (x >= b->low && x <= b->high))) continue;
            snprintf(why, size, "%s, pixel (%d, %d) slice %d, channel %d: %.9g is not in [%g, %g]", b->name, i % img->width,
                     i / img->width % img->height, i / (img->width * img->height), k, x, b->low, b->high);
            return 0;
        }
        if (b->length <= 0 || l2 <= b->length * b->length) continue;
        snprintf(why, size, "%s, pixel (%d, %d): (%.9g, %.9g, %.9g) is longer than %g", b->name, i % img->width,
                 i / img->width % img->height, (double)v[0], (double)v[1], (double)v[2], b->length);
        return 0;
    }
    return 1;
}

int contract_holds(const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
                   const image outputs[HBIL_MAX_TEXTURES], char *why, size_t size)
{
    /* seed_compat=slice_mean divides by the number of slices: the light of one slice's open sky is up to pi/2 */
    const double mean = plan->config.seed_compat & HBIL_SEED_COMPAT_SLICE_MEAN ? 1.5708 : 1.0;
    const double near = contract_brightest(plan, frame, inputs) * mean * ROUND, far = far_bound(plan, frame);
    const double direct = largest(input(plan, inputs, "direct"));
    const double sh = contract_brightest(plan, frame, inputs) * SPHERE * ROUND;
    const double bent = 1.0 + 1e-5;
    const bound bounds[] = {
        {"ao", 1, 0, 1, 0}, {"uniform_ao", 1, 0, 1, 0}, {"specular_occlusion", 1, 0, 1, 0},
        {"multi_bounce", 3, 0, 1 + 1e-6, 0}, /* a quotient, which devices round either way */
        {"near", 3, 0, near, 0}, {"far", 3, 0, far, 0}, {"irradiance", 3, 0, near + far, 0},
        {"composite", 3, 0, (direct + near + far) * (1 + 1e-6), 0}, /* the sum is rounded */
        {"bent", 3, -2, 2, bent}, {"cone", 3, -1 - 1e-5, 1 + 1e-5, 1 + 1e-5}, {"sh", 4, -fmax(sh, SPHERE), fmax(sh, SPHERE), 0},
    };
    size_t i;
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t) {
        if (plan->textures[t].life != HBIL_LIFE_OUTPUT || !outputs[t].data) continue;
        for (i = 0; i < sizeof bounds / sizeof *bounds && strcmp(bounds[i].name, plan->textures[t].name); ++i) { }
        if (i == sizeof bounds / sizeof *bounds) return snprintf(why, size, "%s: no bound is known", plan->textures[t].name), 0;
        if (!check(&bounds[i], &outputs[t], why, size)) return 0;
    }
    return 1;
}
