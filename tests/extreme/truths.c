/* truths.c - see truths.h. View space: x right, y up, z towards the eye. Depth is linear in all of them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "truths.h"
#include "frames.h"

enum { WIDTH = 48, HEIGHT = 40 };

static const camera eye = { WIDTH, HEIGHT, 60, 0.1, 1e6, 1, { 0, 0 }, 0 };

const image *truth_output(const hbil_plan *plan, const image *outputs, const char *name)
{
    const int32_t t = hbil_plan_texture(plan, name);
    return t < 0 || plan->textures[t].life != HBIL_LIFE_OUTPUT ? NULL : &outputs[t];
}

void truth_light(const hbil_plan *plan, extreme_frame *out, float value)
{
    image *img = frames_input(plan, out, "radiance");
    if (img) frames_fill(img, value);
}

static camera camera_of(const hbil_plan *plan)
{
    camera c = eye;
    if (plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC) c.fov = 5;
    return c;
}

int truth_is_sky(const extreme_frame *f, const hbil_plan *plan, int p)
{
    const float z = f->inputs[hbil_plan_texture(plan, "depth")].data[p];
    return !(z > 0) || z > 1e9f;
}

int truth_within(const hbil_plan *plan, const extreme_frame *f, const image *outputs, const char *name, double low, double high, char *why,
                 size_t size)
{
    const image *img = truth_output(plan, outputs, name);
    int p;
    if (!img) return 1;
    for (p = 0; p < img->width * img->height; ++p) {
        const double v = (double)img->data[p * img->channels];
        if (truth_is_sky(f, plan, p) || (v >= low && v <= high)) continue;
        snprintf(why, size, "%s of pixel (%d, %d) is %g, not in [%g, %g]", name, p % img->width, p / img->width, v, low, high);
        return 0;
    }
    return 1;
}

/* ------------------------------------------------------------------------------------------------- nothing occludes */

static void one_plane(const hbil_plan *plan, extreme_frame *out, double x, double y, double z, double d)
{
    camera c = camera_of(plan);
    const plane q = { { x, y, z }, d, { 0, 0, 0 }, { 0, 0, 0 } };
    if (y > 0.999) c.fov = 120; /* a floor: much sky */
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, &q, 1);
    truth_light(plan, out, 1);
    if (frames_input(plan, out, "roughness")) frames_fill(frames_input(plan, out, "roughness"), d == -3 ? 0 : 0.3f);
    if (frames_input(plan, out, "f0")) frames_fill(frames_input(plan, out, "f0"), 0);
}

/* Walls at 0, 60 and 80 degrees, near and far, and a floor under the sky. */
static void fill_open(const hbil_plan *plan, int index, extreme_frame *out)
{
    if (index == 0) one_plane(plan, out, 0, 0, 1, -3);
    else if (index == 1) one_plane(plan, out, 0.866025404, 0, 0.5, -500);
    else if (index == 2) one_plane(plan, out, 0, 1, 0, -1.3);
    else if (index == 3) one_plane(plan, out, 0.6, 0.3, 0.74, -2e-3);
    else one_plane(plan, out, 0, 0.984807753, 0.173648178, -1);
    out->frame.reset = 1;
}

static int expect_open(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *bent = truth_output(plan, outputs, "bent"), *normal = &f->inputs[hbil_plan_texture(plan, "normal") < 0 ? 0 : hbil_plan_texture(plan, "normal")];
    /* hbao has no test of the sample's own elevation, a bitmask 32 sectors; coarse pixels are not quite on the plane */
    const hbil_config *of = &plan->config;
    const double least = of->estimator == HBIL_ESTIMATOR_BITMASK || of->estimator == HBIL_ESTIMATOR_HBAO ? 0.93
                       : of->mips > HBIL_MIPS_NONE || of->downscale > 1 ? 0.9 : 0.997;
    int p, k;
    (void)index;
    if (!truth_within(plan, f, outputs, "ao", least, 1, why, size) || !truth_within(plan, f, outputs, "uniform_ao", least - 0.03, 1, why, size)
        || !truth_within(plan, f, outputs, "near", 0, 1.001 - least, why, size)
        || !truth_within(plan, f, outputs, "multi_bounce", least, 1.001, why, size)
        || !truth_within(plan, f, outputs, "specular_occlusion", 0.97, 1, why, size)) return 0;
    for (p = 0; bent && normal->channels == 3 && p < bent->width * bent->height; ++p)
        for (k = 0; k < 3; ++k) {
            const double v = (double)bent->data[bent->channels * p + k], n = (double)normal->data[3 * p + k] * 2 / 3;
            if (truth_is_sky(f, plan, p) || fabs(v - n) < 0.04) continue;
            snprintf(why, size, "bent of pixel (%d, %d), channel %d: %g, not %g", p % bent->width, p / bent->width, k, v, n);
            return 0;
        }
    return 1;
}

/* Normals of any direction before the eye, some behind the tangent of the view, on a wall: the bent vector of what is open is theirs,
 * turned to the eye where they look away. */
static void fill_normals(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *normal;
    int p;
    one_plane(plan, out, 0, 0, 1, -3);
    out->frame.reset = 1;
    normal = frames_input(plan, out, "normal");
    for (p = 0; normal && p < WIDTH * HEIGHT; ++p) {
        const double a = 6.2831853 * (double)frames_random((uint32_t)p, 7), t = (index ? 0.55 : 0.45) * 3.14159265 * (double)frames_random((uint32_t)p, 9);
        normal->data[3 * p] = (float)(sin(t) * cos(a));
        normal->data[3 * p + 1] = (float)(sin(t) * sin(a));
        normal->data[3 * p + 2] = (float)cos(t);
    }
}

static int expect_normals(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *bent = truth_output(plan, outputs, "bent"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int p, k;
    (void)index;
    if (!truth_within(plan, f, outputs, "ao", 0.999, 1, why, size)) return 0;
    for (p = 0; p < bent->width * bent->height; ++p) {
        double ray[2], v[3], n[3], ny, l;
        frames_ray(plan, &f->frame, p % bent->width + 0.5, p / bent->width + 0.5, ray);
        l = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1);
        v[0] = -ray[0] / l, v[1] = -ray[1] / l, v[2] = 1 / l;
        for (k = 0, ny = 0; k < 3; ++k) n[k] = (double)normal->data[3 * p + k], ny += n[k] * v[k];
        if (ny < 0.001) {
            for (k = 0, l = 0; k < 3; ++k) n[k] += (0.001 - ny) * v[k], l += n[k] * n[k];
            for (k = 0; k < 3; ++k) n[k] /= sqrt(l);
        }
        for (k = 0; k < 3; ++k) {
            const double b = (double)bent->data[bent->channels * p + k];
            if (fabs(b - n[k] * 2 / 3) < 0.03) continue;
            snprintf(why, size, "bent of pixel (%d, %d), channel %d: %g, not %g", p % bent->width, p / bent->width, k, b, n[k] * 2 / 3);
            return 0;
        }
    }
    return 1;
}

/* ---------------------------------------------------------------------------------------------- near + ao = 1 */

static void fill_white(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    camera at = c;
    at.eye_x = 0.03 * index;
    frames_room_by(plan, out, &at, index);
    truth_light(plan, out, 1);
}

int truth_white(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *near = truth_output(plan, outputs, "near");
    double least = 1;
    int p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const double a = (double)ao->data[p], n = (double)near->data[near->channels * p];
        least = fmin(least, a);
        if (truth_is_sky(f, plan, p) ? a == 1 && n == 0 : fabs(a + n - 1) < 4e-3) continue;
        snprintf(why, size, "pixel (%d, %d)%s: ao %g, near %g", p % ao->width, p / ao->width, truth_is_sky(f, plan, p) ? ", sky" : "", a, n);
        return 0;
    }
    if (least < 0.8) return 1;
    snprintf(why, size, "nothing is occluded: the least ao is %g", least);
    return 0;
}

void truth_corner(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 0.8, 0.6 }, -4, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, -0.6, 0.8 }, -4.2, { 0, 0, 0 }, { 0, 0, 0 } } };
    (void)index;
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, q, 2);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

/* At the middle of the screen, a few pixels from the corner. The whole other plane would hide 0.5; what the screen has of it, most of that. */
static int expect_corner(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    double sum = 0;
    int n = 0, p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const int x = p % ao->width, y = p / ao->width, d = 5;
        if (x < ao->width / 3 || x >= ao->width * 2 / 3 || y < d || y >= ao->height - d) continue;
        if ((normal->data[3 * (p - d * ao->width) + 1] > 0) == (normal->data[3 * (p + d * ao->width) + 1] > 0)) continue;
        sum += (double)ao->data[p];
        ++n;
    }
    if (n > 0 && sum / n > 0.5 && sum / n < 0.66) return 1;
    snprintf(why, size, "ao at the corner is %g of %d pixels, not in [0.5, 0.66]", sum / (n ? n : 1), n);
    return 0;
}

/* --------------------------------------------------------------------------------- what an input means, as hbil.h says */

static image kept[HBIL_MAX_TEXTURES];

/* The outputs of frame `at` are kept; others must be the same up to `off`. */
static int same_as(int at, double off, const hbil_plan *plan, int index, const image *outputs, char *why, size_t size)
{
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t) {
        const image *img = &outputs[t];
        const size_t n = (size_t)img->width * (size_t)img->height * (size_t)image_slices(img) * (size_t)img->channels;
        size_t i;
        if (plan->textures[t].life != HBIL_LIFE_OUTPUT) continue;
        if (index == at) {
            kept[t].data = (float *)realloc(kept[t].data, n * sizeof(float));
            if (!kept[t].data) abort();
            memcpy(kept[t].data, img->data, n * sizeof(float));
        } else
            for (i = 0; i < n; ++i) {
                if (fabs((double)img->data[i] - (double)kept[t].data[i]) <= off) continue;
                snprintf(why, size, "%s, pixel (%d, %d): %g, but %g in frame %d", plan->textures[t].name, (int)(i / (size_t)img->channels) % img->width,
                         (int)(i / (size_t)img->channels) / img->width, (double)img->data[i], (double)kept[t].data[i], at);
                return 0;
            }
    }
    return 1;
}

/* What the sky gets: see the manual. */
static int expect_sky(const hbil_plan *plan, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    static const struct { const char *name; float value; } rows[] = { { "ao", 1 }, { "uniform_ao", 1 }, { "specular_occlusion", 1 },
        { "multi_bounce", 1 }, { "bent", 0 }, { "cone", 0 }, { "near", 0 }, { "far", 0 }, { "irradiance", 0 } };
    size_t i;
    int p;
    for (i = 0; i < sizeof rows / sizeof *rows; ++i) {
        const image *img = truth_output(plan, outputs, rows[i].name);
        for (p = 0; img && p < img->width * img->height; ++p) {
            if (!truth_is_sky(f, plan, p) || img->data[img->channels * p] == rows[i].value) continue;
            snprintf(why, size, "%s of the sky at pixel (%d, %d) is %g", rows[i].name, p % img->width, p / img->width, (double)img->data[img->channels * p]);
            return 0;
        }
    }
    return 1;
}

static int expect_same(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    return expect_sky(plan, f, outputs, why, size) && same_as(0, 1e-6, plan, index, outputs, why, size);
}

static void set_some(const hbil_plan *plan, extreme_frame *out, const char *name, float value, uint32_t seed)
{
    image *img = frames_input(plan, out, name);
    int p, k;
    for (p = 0; img && p < img->width * img->height * image_slices(img); ++p)
        for (k = 0; k < img->channels && frames_random((uint32_t)p, seed) < 0.08f; ++k) img->data[p * img->channels + k] = value;
}

/* Frame 0 what the manual says that the others stand for. */
static void fill_meant(const hbil_plan *plan, int index, extreme_frame *out)
{
    static const char *const light_of[] = { "radiance", "direct" }, *const share_of[] = { "albedo", "f0", "roughness" };
    const camera c = camera_of(plan);
    const float sky = 1e12f;
    size_t i;
    frames_room_by(plan, out, &c, 0);
    for (i = 0; i < 2; ++i) {
        set_some(plan, out, light_of[i], index ? NAN : 0, 31);
        set_some(plan, out, light_of[i], index ? -5 : 0, 32);
        set_some(plan, out, light_of[i], index ? INFINITY : 60000, 33);
    }
    for (i = 0; i < 3; ++i) {
        set_some(plan, out, share_of[i], index ? 3 : 1, 134 + 10 * (uint32_t)i);
        set_some(plan, out, share_of[i], index ? -3 : 0, 135 + 10 * (uint32_t)i);
    }
    set_some(plan, out, "normal", index ? INFINITY : 0, 52); /* both are replaced by the view vector */
    set_some(plan, out, "normal", index ? NAN : 0, 53);
    set_some(plan, out, "normal", index ? 1e20f : 0, 54);
    set_some(plan, out, "albedo", index ? NAN : 0, 36);
    set_some(plan, out, "f0", index ? NAN : 0, 36);
    set_some(plan, out, "depth", index ? NAN : sky, 37);
    if (plan->config.projection == HBIL_PROJECTION_PERSPECTIVE) set_some(plan, out, "depth", index ? -2 : sky, 38);
    set_some(plan, out, "depth", index ? INFINITY : sky, 39);
    set_some(plan, out, "depth", index ? 1e20f : sky, 40);
    out->frame.reset = 1;
    if (plan->config.environment == HBIL_ENVIRONMENT_CONSTANT) {
        out->frame.far_color[0] = index ? -1 : 0;
        out->frame.far_color[1] = index ? 1e30f : 60000;
    }
}

/* ---------------------------------------------------------------------------------------------------------- frames */

/* Frame 0, then others of another light and place; then the first one again after a cut: nothing of them is left. */
static void fill_cut(const hbil_plan *plan, int index, extreme_frame *out)
{
    camera at = camera_of(plan);
    at.eye_x = index == 3 ? 0 : 0.4 * index;
    frames_room_by(plan, out, &at, index == 3 ? 0 : index);
    truth_light(plan, out, index % 3 ? 50000 : 1);
    out->frame.index = index == 3 ? 0 : (uint32_t)index;
    out->frame.reset = index % 3 == 0;
}

static int expect_cut(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)f;
    return index % 3 ? 1 : same_as(0, 1e-6, plan, index, outputs, why, size);
}

/* A lit corner, then a wall elsewhere without any light: none of the first is on it. */
static void fill_gone(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *motion;
    if (index < 2) truth_corner(plan, index, out);
    else one_plane(plan, out, 0, 0, 1, index == 2 ? -1.5 : -9);
    truth_light(plan, out, index < 2 ? 1 : 0);
    out->frame.index = (uint32_t)index;
    out->frame.reset = index == 0;
    motion = frames_input(plan, out, "motion");
    if (motion) frames_fill(motion, 0);
}

static int expect_gone(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    if (index < 2) return 1;
    return truth_within(plan, f, outputs, "ao", 0.995, 1, why, size) && truth_within(plan, f, outputs, "near", 0, 5e-3, why, size);
}

/* Nothing changes, without noise: neither does the result, however many frames; one of them is poisoned by the brightest light. */
static void fill_still(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    frames_room_by(plan, out, &c, 0);
    truth_light(plan, out, index == 2 ? 1e30f : 1);
    if (frames_input(plan, out, "albedo")) frames_fill(frames_input(plan, out, "albedo"), 0.3f);
    out->frame.index = 0;
    out->frame.reset = index == 0;
}

static int expect_still(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const int poisoned = plan->config.outputs & HBIL_OUTPUTS_NEAR && index >= 2;
    (void)f;
    if (plan->config.bounces == HBIL_BOUNCES_RECURSIVE && index < 30) return 1; /* light has to go around, and out again */
    return poisoned && plan->config.bounces != HBIL_BOUNCES_RECURSIVE ? 1
         : same_as(plan->config.bounces == HBIL_BOUNCES_RECURSIVE ? 30 : 0, 2e-3, plan, index, outputs, why, size);
}

/* Plates before each other, turned differently: what stands behind a plate's plane does not occlude it, nor do its neighbours' values
 * get onto it. */
static void fill_plates(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 0, 1 }, -2, { -9, -9, -9 }, { -0.1, 9, 0 } }, { { -0.7, 0.1, 0.707 }, -2.5, { 0, -9, -99 }, { 9, 9, 0 } } };
    frames_begin(plan, out, &c, index);
    frames_planes(plan, out, q, 2);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

static int expect_plates(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        if (truth_is_sky(f, plan, p) ? ao->data[p] == 1 : normal->data[3 * p + 2] < 0.99f || ao->data[p] > 0.99f) continue;
        snprintf(why, size, "ao of pixel (%d, %d) is %g, where nothing occludes", p % ao->width, p / ao->width, (double)ao->data[p]);
        return 0;
    }
    return 1;
}

/* ------------------------------------------------------------------------------------------------- extremes of their own */

/* White spikes a hundred times nearer than what is around them: cosines at their borders round above 1. */
static void fill_spikes(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const double n[3] = { 0, 0, 1 };
    int p;
    frames_begin(plan, out, &c, 0);
    for (p = 0; p < WIDTH * HEIGHT; ++p) {
        const double r = (double)frames_random((uint32_t)p, (uint32_t)(index + 50)), s = (double)frames_random((uint32_t)p, 77);
        frames_put(plan, out, p % WIDTH, p / WIDTH, r < 0.25 ? 0.3 + 0.1 * s : 40 + (index ? 900 : 20) * s, n);
    }
    truth_light(plan, out, 1);
    out->frame.index = (uint32_t)index;
    out->frame.reset = index == 0;
}

/* Spikes of white paint: where nothing is seen the light between them is 0 / 0. */
static void fill_white_spikes(const hbil_plan *plan, int index, extreme_frame *out)
{
    fill_spikes(plan, index, out);
    frames_fill(frames_input(plan, out, "albedo"), 1);
}

/* Index 0: the nearest surfaces that are any, through the narrowest camera. 1: a camera so far off its axis that neighbours have one ray:
 * some samples lie where the receiver is when it is pulled to the eye by HBIL_PULL. */
static void fill_tiny(const hbil_plan *plan, int index, extreme_frame *out)
{
    camera c = camera_of(plan);
    const double n[3] = { 0, 0, 1 }, z = index ? 1.5 : 1.01e-9;
    int p;
    if (index && plan->config.projection == HBIL_PROJECTION_PERSPECTIVE) c.fov = 2e-4, c.shift[0] = 5e8;
    else c.fov = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC ? 2e-6 : 2e-4;
    frames_begin(plan, out, &c, 0);
    for (p = 0; p < WIDTH * HEIGHT; ++p)
        frames_put(plan, out, p % WIDTH, p / WIDTH, z * (frames_random((uint32_t)p, 60) < 0.5f ? 1.0 : 1.0 - 1e-5 + 6e-8 * (p % 5 - 2)), n);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

/* A room at sizes that nothing divides. */
static void fill_odd(const hbil_plan *plan, int index, extreme_frame *out)
{
    static const int sizes[][2] = { { 37, 23 }, { 1, 1 }, { 3, 2 }, { 5, 67 }, { 66, 17 }, { 2, 40 } };
    frames_room(plan, out, sizes[index][0], sizes[index][1], 0);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

/* Frames of changing size in the corner of textures that stay: what other frames left beside them is garbage. */
static void fill_resize(const hbil_plan *plan, int index, extreme_frame *out)
{
    static const uint32_t sizes[][2] = { { 64, 48 }, { 41, 30 }, { 41, 30 }, { 64, 48 }, { 17, 16 }, { 33, 48 } };
    const int before = index ? index - 1 : 0;
    frames_room(plan, out, 64, 48, index);
    truth_light(plan, out, 1);
    out->frame.width = sizes[index][0];
    out->frame.height = sizes[index][1];
    out->frame.last_width = sizes[before][0];
    out->frame.last_height = sizes[before][1];
}

/* A camera that turns around and walks through what it saw. */
static void fill_turning(const hbil_plan *plan, int index, extreme_frame *out)
{
    camera at = camera_of(plan);
    float *now = out->frame.view, *last = out->frame.last_view;
    frames_room_by(plan, out, &at, 0);
    truth_light(plan, out, 1);
    out->frame.index = (uint32_t)index;
    out->frame.reset = index == 0;
    if (index == 0) return;
    now[14] = 0.5f * (float)(index % 5);     /* along the view */
    last[14] = index % 5 ? now[14] - 3.5f : 4;
    if (index % 3 == 0) last[0] = last[10] = -1; /* half a turn about y */
    if (index % 3 == 1) now[12] = 1e4f;
}

/* Spherical harmonics whose radiance is negative from one side. */
static void fill_lobes(const hbil_plan *plan, int index, extreme_frame *out)
{
    int i, k;
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    for (i = 0; i < 9; ++i)
        for (k = 0; k < 3; ++k) out->frame.far_sh[i][k] = i == 0 ? 1 : (index & 1 ? -4.0f : 4.0f) * (i == 1 + index ? 1.0f : 0.0f);
    out->frame.reset = 1;
}

/* Probes that are all alike, and a room that reaches beyond them. */
static void fill_probes(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *probes;
    int p;
    one_plane(plan, out, 0, 0, 1, -30);
    (void)index;
    for (p = 0; p < 3; ++p) out->frame.probe_origin[p] = -1, out->frame.probe_step[p] = 0.5f;
    probes = frames_input(plan, out, "probes");
    frames_fill(probes, 0);
    for (p = 0; p < probes->width * probes->height * (image_slices(probes) / (plan->config.sh_order == 1 ? 4 : 9)) * probes->channels; ++p)
        probes->data[p] = 1;
    out->frame.reset = 1;
}

static int expect_probes(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index;
    return truth_within(plan, f, outputs, "far", 0.27, 0.29, why, size); /* 0.282095 of an open wall */
}

/* Some directions of the environment are no numbers: the others still light what sees them. */
static void fill_bad_sky(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *sky;
    int i;
    one_plane(plan, out, 0, 0, 1, -3);
    out->frame.reset = 1;
    sky = frames_input(plan, out, "sky");
    for (i = 0; sky && i < sky->width * sky->height * image_slices(sky) * sky->channels; ++i)
        sky->data[i] = i / (sky->width * sky->height * sky->channels) == index ? NAN : 0.5f;
}

static int expect_bad_sky(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index;
    return truth_within(plan, f, outputs, "far", 0.1, 60000, why, size);
}

/* Index 1: what is beyond the reach stands higher than what is within. It must not brighten. */
static void fill_behind(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 1, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 1 }, -3, { -9, -9, -99 }, { 9, -0.7, 0 } },
                        { { 0, 0, 1 }, -6, { -99, -9, -99 }, { 99, 99, 0 } } };
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, q, index ? 3 : 2);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

static int expect_behind(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao");
    static float before[WIDTH * HEIGHT], depths[WIDTH * HEIGHT];
    const float *z = f->inputs[hbil_plan_texture(plan, "depth")].data;
    int p, n = 0;
    if (index == 0) {
        memcpy(before, ao->data, sizeof before);
        memcpy(depths, z, sizeof depths);
        return 1;
    }
    for (p = 0; p < WIDTH * HEIGHT; ++p) {
        if (truth_is_sky(f, plan, p) || depths[p] != z[p]) continue;
        ++n;
        if (ao->data[p] <= before[p] + 1e-4f) continue;
        snprintf(why, size, "ao of pixel (%d, %d) is %g, %g without what stands beyond the reach", p % WIDTH, p / WIDTH, (double)ao->data[p],
                 (double)before[p]);
        return 0;
    }
    return n > 100 || snprintf(why, size, "too few pixels") < 0;
}

/* A ledge before a wall, at its side nothing; index 1: there, deep below the ledge, is a floor. It is behind the ledge's plane and must
 * not take from what the wall hides. */
static void fill_below(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 1, 0 }, -1, { -99, -9, -4 }, { 0.4, 9, 0 } }, { { 0, 0, 1 }, -4, { -99, -9, -99 }, { 0.4, 1, 0 } },
                        { { 0, 1, 0 }, -1.7, { -99, -9, -99 }, { 99, 9, 0 } } };
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, q, index ? 3 : 2);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

/* A wall with a floor at its foot, which the border of the screen cuts: only the samples that are there count. */
static void fill_foot(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 0, 1 }, -3, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 1, 0 }, -1.5, { 0, 0, 0 }, { 0, 0, 0 } } };
    (void)index;
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, q, 2);
    out->frame.reset = 1;
}

/* 64 steps downwards from the wall, of which at most 12 are on the screen. */
static int expect_foot(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        if (normal->data[3 * p + 2] < 0.9f || ao->data[p] > 0.6f) continue;
        snprintf(why, size, "ao of pixel (%d, %d) is %g", p % ao->width, p / ao->width, (double)ao->data[p]);
        return 0;
    }
    return 1;
}

/* A floor, and a higher one behind: its top faces away from the lower one, and its front is not there. */
static void fill_step(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const plane q[] = { { { 0, 1, 0 }, -1.2, { -99, -9, -3 }, { 99, 9, 0 } }, { { 0, 1, 0 }, -0.7, { -99, -9, -99 }, { 99, 9, -3 } } };
    (void)index;
    frames_begin(plan, out, &c, 0);
    frames_planes(plan, out, q, 2);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

static int expect_step(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *near = truth_output(plan, outputs, "near");
    double least = 1;
    int p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const double n = (double)near->data[near->channels * p];
        least = fmin(least, (double)ao->data[p]);
        if (truth_is_sky(f, plan, p) || n < 0.02) continue;
        snprintf(why, size, "pixel (%d, %d): near %g of what faces away", p % ao->width, p / ao->width, n);
        return 0;
    }
    return least < 0.95 || snprintf(why, size, "nothing is occluded") < 0;
}

/* Of a white world no more light comes than is hidden. */
static int expect_no_more(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *near = truth_output(plan, outputs, "near");
    int p;
    (void)index;
    (void)f;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const double a = (double)ao->data[p], n = (double)near->data[near->channels * p];
        if (a + n < 1.004) continue;
        snprintf(why, size, "pixel (%d, %d): ao %g and near %g", p % ao->width, p / ao->width, a, n);
        return 0;
    }
    return 1;
}

/* Facing. Index 0: in a corner all that is seen faces the receiver: near + ao = 1. Index 1: the normals of the wall look away from the
 * floor, which gets no light of it. */
static void fill_facing(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *normal;
    int p, k;
    truth_corner(plan, 0, out);
    normal = frames_input(plan, out, "normal");
    for (p = 0; index && p < WIDTH * HEIGHT; ++p)
        if (normal->data[3 * p + 1] < 0)
            for (k = 0; k < 3; ++k) normal->data[3 * p + k] *= -1;
}

static int expect_facing(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *near = truth_output(plan, outputs, "near"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int p;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const double a = (double)ao->data[p], n = (double)near->data[near->channels * p];
        if (index ? normal->data[3 * p + 2] < 0 || n < 0.03 : fabs(a + n - 1) < 0.05) continue;
        snprintf(why, size, "pixel (%d, %d): ao %g, near %g", p % ao->width, p / ao->width, a, n);
        return 0;
    }
    return 1;
}

/* Plates of one depth each before sky and before each other, some of them one or two pixels wide: nothing is within reach, so the bent vector is the
 * plate's normal, up to its last pixel. */
static void fill_cards(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const double facing[3] = { 0, 0, 1 }, leaning[3] = { index ? 0.8 : 0.6, 0, index ? 0.6 : 0.8 };
    int p;
    frames_begin(plan, out, &c, 0);
    for (p = 0; p < WIDTH * HEIGHT; ++p) {
        const int x = p % WIDTH, y = p / WIDTH;
        double ray[2];
        frames_ray(plan, &out->frame, x + 0.5, y + 0.5, ray);
        if (x >= 8 && x < 20 && y >= 6 && y < 30) frames_put(plan, out, x, y, 2, facing);
        else if (index == 0 && (x == 24 || x == 27 || x == 28) && y >= 1 && y < 8) frames_put(plan, out, x, y, 2, facing);
        else if (x >= 15 && x < 42 && y >= 10 && y < 36) frames_put(plan, out, x, y, 2.4 / (leaning[2] - leaning[0] * ray[0]), leaning);
    }
    out->frame.reset = 1;
}

static int expect_cards(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *bent = truth_output(plan, outputs, "bent");
    const float *z = f->inputs[hbil_plan_texture(plan, "depth")].data;
    int p;
    for (p = 0; p < WIDTH * HEIGHT; ++p) {
        const double nx = z[p] == 2 ? 0 : index ? 0.8 : 0.6, nz = z[p] == 2 ? 1 : index ? 0.6 : 0.8;
        const float *b = bent->data + bent->channels * p;
        if (truth_is_sky(f, plan, p) ? b[0] == 0 && b[2] == 0 : fabs((double)b[0] - nx * 2 / 3) < 0.03 && fabs((double)b[1]) < 0.03 && fabs((double)b[2] - nz * 2 / 3) < 0.03) continue;
        snprintf(why, size, "bent of pixel (%d, %d), depth %g: %g %g %g", p % WIDTH, p / WIDTH, (double)z[p], (double)b[0], (double)b[1], (double)b[2]);
        return 0;
    }
    return 1;
}

/* A pit that sees little: little of its mirror's lobe is left. */
static void fill_shaft(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan);
    const double n[3] = { 0, 0, 1 };
    int p;
    (void)index;
    frames_begin(plan, out, &c, 0);
    for (p = 0; p < WIDTH * HEIGHT; ++p)
        frames_put(plan, out, p % WIDTH, p / WIDTH, abs(p % WIDTH - WIDTH / 2) + abs(p / WIDTH - HEIGHT / 2) < 6 ? 6 : 1, n);
    out->frame.reset = 1;
}

static int expect_shaft(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *so = truth_output(plan, outputs, "specular_occlusion");
    int p, n = 0;
    (void)index;
    (void)f;
    for (p = 0; p < WIDTH * HEIGHT; ++p) {
        if (ao->data[p] > 0.03f) continue;
        ++n;
        if (so->data[p] < 0.5f) continue;
        snprintf(why, size, "pixel (%d, %d): specular occlusion %g, ao %g", p % WIDTH, p / WIDTH, (double)so->data[p], (double)ao->data[p]);
        return 0;
    }
    return n > 4 || snprintf(why, size, "no pixel is hidden") < 0;
}

/* -------------------------------------------------------------------------------------------------------------- the table */

#define SPIKES(config) { "truth_spikes", config, 2, fill_spikes, NULL, 0 },
#define TINY(config) { "truth_nearest_and_narrowest", config, 2, fill_tiny, NULL, 0 },
#define ODD(config) { "truth_odd_sizes", config, 6, fill_odd, NULL, 0 },
#define RESIZE(config) { "truth_frames_of_changing_size", config, 6, fill_resize, NULL, 0 },
#define TURNING(config) { "truth_a_camera_that_turns", config, 16, fill_turning, NULL, 0 },
#define LOBES(config) { "truth_sh_of_negative_radiance", config, 4, fill_lobes, NULL, 0 }
#define FACING(config) { "truth_facing", config, 2, fill_facing, expect_facing, 0 }
#define STEP(config) { "truth_what_faces_away_gives_no_light", config, 1, fill_step, expect_step, 0 }
#define NO_MORE(config) { "truth_no_more_light_than_is_hidden", config, 2, fill_white, expect_no_more, 0 }, \
    { "truth_no_more_light_than_is_hidden", config, 2, fill_normals, expect_no_more, 0 }
#define BELOW(config) { "truth_what_lies_below_never_brightens", config, 2, fill_below, expect_behind, 0 }
#define BEHIND(config) { "truth_beyond_reach_never_brightens", config, 2, fill_behind, expect_behind, 0 }

/* Of every march and every way to gather. */
#define MARCHES(X) \
    X("outputs=ao+near+bent+uniform_ao+sh slices=3") \
    X("outputs=ao+near+sh sampling=bilinear slices=2 spacing=geometric reach=2") \
    X("outputs=ao+near occluder=heuristic slices=2 reach=3 facing=half_space") \
    X("outputs=ao+near gather=side facing=half_space slices=2") \
    X("outputs=ao+near+sh+bent+uniform_ao estimator=bitmask occluder=thick slices=2 reach=3 facing=half_space") \
    X("outputs=ao+near+sh+bent estimator=bitmask slices=2 facing=filter") \
    X("outputs=ao+near estimator=bitmask occluder=thick thickness=0.01 slices=2") \
    X("outputs=ao estimator=hbao slices=2 reach=3") \
    X("outputs=ao estimator=hbao_plus slices=2 reach=3 attenuation=linear") \
    X("outputs=ao+near+bent march=sweep slices=4 facing=half_space") \
    X("outputs=ao+near march=sweep slices=2 sweep_stride=3 filter=3x3 facing=filter") \
    X("outputs=ao+near march=both estimator=bitmask occluder=thick reach=1 slices=2") \
    X("outputs=ao+near mips=spread slices=2 steps=16 interleave=yes") \
    X("outputs=ao+near mips=mean facing=half_space slices=2 steps=16") \
    X("outputs=ao+near mips=weighted slices=2 steps=16 normals=depth") \
    X("outputs=ao+near+cone+specular_occlusion projection=orthographic slices=2 reach=2 mips=weighted")

#define FRAMES(X) \
    X("outputs=ao+near temporal=yes bounces=recursive reproject=scatter slices=2 rectify=range") \
    X("outputs=ao+near temporal=yes bounces=recursive reproject=gather slices=2 storage=half filter=3x3 filter_passes=3") \
    X("outputs=ao+near temporal=yes bounces=recursive slices=2 downscale=2 filter=5x5") \
    X("outputs=ao+near bounces=recursive reproject=scatter slices=2 downscale=4 march=sweep") \
    X("outputs=ao+near downscale=4 normals=depth slices=2") \
    X("outputs=ao+near+cone temporal=yes projection=orthographic reproject=scatter bounces=recursive slices=2")

#define OPEN(config, frames) { "truth_open_surfaces_are_open", config, frames, fill_open, expect_open, 0 }
#define WHITE(config, frames) { "truth_white_near_and_ao_are_one", config, frames, fill_white, truth_white, 0 }
#define CORNER(config) { "truth_corner_hides_half", config, 1, truth_corner, expect_corner, 0 }
#define MEANT(config) { "truth_bad_input_means_what_the_manual_says", config, 2, fill_meant, expect_same, 0 }
#define CUT(config) { "truth_a_cut_leaves_nothing", config, 4, fill_cut, expect_cut, 0 }
#define GONE(config) { "truth_light_of_another_surface_is_gone", config, 4, fill_gone, expect_gone, 0 }
#define STILL(config, frames) { "truth_a_still_world_stays", config, frames, fill_still, expect_still, 0 }
#define PLATES(config) { "truth_plates_keep_their_own", config, 1, fill_plates, expect_plates, 0 }

const extreme_case extreme_truths[] = {
    MARCHES(ODD) MARCHES(TINY) MARCHES(SPIKES) FRAMES(ODD) FRAMES(RESIZE) FRAMES(TURNING)
    LOBES("outputs=ao+far environment=sh far_visibility=bent slices=2"),
    LOBES("outputs=ao+far environment=sh far_visibility=ao slices=2"),
    LOBES("outputs=ao+far environment=sh far_visibility=direction slices=2 seed_compat=f0_ao f0=scalar"),
    LOBES("outputs=ao+far environment=sh far_visibility=cone slices=2 seed_compat=cone_relation"),
    LOBES("outputs=ao+far environment=sh far_visibility=cone slices=2"),
    LOBES("outputs=ao+far environment=sh far_visibility=free_bits estimator=bitmask slices=2"),
    { "truth_probes_beyond_their_grid", "outputs=ao+far environment=probes far_visibility=ao slices=2", 1, fill_probes, expect_probes, 0 },
    { "truth_the_rest_of_the_sky", "outputs=ao+far environment=cube far_visibility=free_bits estimator=bitmask slices=4 noise=none", 6, fill_bad_sky,
      expect_bad_sky, 0 },
    { "truth_the_rest_of_the_sky", "outputs=ao+far environment=hook far_visibility=free_bits estimator=bitmask slices=4 noise=none", 1, fill_bad_sky,
      expect_bad_sky, 0 },
    FACING("outputs=ao+near slices=4 steps=8 facing=half_space"),
    FACING("outputs=ao+near slices=4 steps=8 facing=filter"),
    FACING("outputs=ao+near slices=4 steps=8 facing=half_space gather=side"),
    FACING("outputs=ao+near slices=4 steps=8 facing=half_space occluder=heuristic"),
    FACING("outputs=ao+near slices=4 steps=8 facing=half_space estimator=bitmask"),
    { "truth_facing", "outputs=ao+near slices=4 march=sweep facing=half_space", 1, fill_facing, expect_facing, 0 },
    { "truth_facing", "outputs=ao+near slices=4 march=sweep facing=filter", 1, fill_facing, expect_facing, 0 },
    BEHIND("outputs=ao estimator=hbao reach=1.5 slices=4 noise=none steps=16"),
    BEHIND("outputs=ao estimator=hbao reach=1.5 slices=4 noise=none steps=16 attenuation=linear"),
    BEHIND("outputs=ao estimator=hbao_plus reach=1.5 slices=4 noise=none steps=16"),
    BEHIND("outputs=ao reach=1.5 slices=4 noise=none steps=16"),
    { "truth_white_paint_in_the_dark", "outputs=ao+multi_bounce estimator=hbao_plus multiplier=16 slices=2", 2, fill_white_spikes, NULL, 0 },
    { "truth_white_paint_in_the_dark", "outputs=ao+multi_bounce estimator=hbao_plus multiplier=16 slices=2 bounce=cubic", 2, fill_white_spikes, NULL, 0 },
    { "truth_normals_of_888", "outputs=ao+bent normal_encoding=octahedral_888 slices=2", 2, fill_meant, NULL, 0 },
    { "truth_cards_have_their_own_normals", "outputs=ao+bent normals=depth slices=8 steps=1 reach=1e-6 noise=none", 2, fill_cards, expect_cards, 0 },
    { "truth_cards_have_their_own_normals", "outputs=ao+bent slices=8 steps=1 reach=1e-6 noise=none filter=5x5 filter_passes=3", 2, fill_cards,
      expect_cards, 0 },
    { "truth_cards_have_their_own_normals", "outputs=ao+bent slices=8 steps=1 reach=1e-6 noise=none downscale=2", 2, fill_cards, expect_cards, 0 },
    { "truth_cards_have_their_own_normals", "outputs=ao+bent slices=8 steps=1 reach=1e-6 noise=none downscale=2 filter=3x3", 2, fill_cards,
      expect_cards, 0 },
    { "truth_shafts_mirror_little", "outputs=ao+specular_occlusion roughness=0.45 slices=8 steps=32 noise=none", 1, fill_shaft, expect_shaft, 0 },
    { "truth_samples_beyond_the_border_do_not_count", "outputs=ao estimator=hbao_plus slices=1 steps=64 noise=none exponent=1", 1, fill_foot,
      expect_foot, 0 },
    STEP("outputs=ao+near slices=4 steps=8 facing=half_space"),
    STEP("outputs=ao+near slices=4 steps=8 facing=half_space gather=side"),
    STEP("outputs=ao+near slices=4 steps=8 facing=half_space occluder=heuristic"),
    STEP("outputs=ao+near slices=4 steps=8 facing=half_space estimator=bitmask"),
    NO_MORE("outputs=ao+near slices=2 facing=half_space"),
    NO_MORE("outputs=ao+near slices=2 facing=half_space gather=side"),
    NO_MORE("outputs=ao+near slices=2 facing=half_space occluder=heuristic"),
    NO_MORE("outputs=ao+near slices=2 facing=half_space estimator=bitmask occluder=thick"),
    BELOW("outputs=ao estimator=hbao_plus slices=4 noise=none steps=16"),
    BELOW("outputs=ao estimator=hbao slices=4 noise=none steps=16"),
    BELOW("outputs=ao slices=4 noise=none steps=16"),
    BELOW("outputs=ao+near slices=4 noise=none steps=16 estimator=bitmask"),
    OPEN("outputs=ao+bent+cone+specular_occlusion ao_exponent=0.1 slices=3", 5),
    OPEN("outputs=ao+far environment=constant seed_compat=f0_ao f0=scalar slices=3", 5),
    OPEN("outputs=ao+far environment=sh far_visibility=cone seed_compat=cone_relation ao_exponent=0.1 slices=3", 5),
    CORNER("outputs=ao march=both estimator=bitmask reach=0.3 slices=8"),
    CORNER("outputs=ao slices=4 steps=16 reach=50 noise=none"),
    CORNER("outputs=ao slices=4 steps=16 spacing=geometric noise=none"),
    CORNER("outputs=ao slices=4 steps=16 mips=weighted noise=none"),
    CORNER("outputs=ao slices=4 steps=16 occluder=heuristic decay=0.01 noise=none"),
    { "truth_normals_of_any_direction", "outputs=ao+bent+uniform_ao estimator=bitmask slices=4 occluder=thick", 2, fill_normals, NULL, 0 },
    { "truth_normals_of_any_direction", "outputs=ao+uniform_ao slices=1 steps=1 reach=1e-6", 2, fill_normals, NULL, 0 },
    { "truth_normals_of_any_direction", "outputs=ao+near+bent+uniform_ao+sh+specular_occlusion slices=2", 2, fill_normals, NULL, 0 },
    { "truth_normals_of_any_direction", "outputs=ao+bent+near march=sweep facing=half_space slices=4", 2, fill_normals, NULL, 0 },
    STILL("outputs=ao+near noise=none slices=2 bounces=recursive reproject=scatter facing=half_space", 40),
    STILL("outputs=ao+near noise=none slices=2 bounces=recursive facing=half_space stage=fragment downscale=2", 40),
    STILL("outputs=ao temporal=yes noise=none rectify=range history=63", 70),
    GONE("outputs=ao+near temporal=yes reproject=scatter bounces=recursive rectify=none slices=2"),
    GONE("outputs=ao+near temporal=yes reproject=camera rectify=none slices=2"),
    CUT("outputs=ao+near+bent temporal=yes bounces=recursive rectify=range reproject=gather storage=half slices=2"),
    CUT("outputs=ao+near+bent temporal=yes bounces=recursive rectify=none reproject=scatter slices=2"),
    MEANT("outputs=ao+near+far+composite environment=constant f0=rgb slices=2"),
    MEANT("outputs=ao+near+specular_occlusion+cone gather=packed slices=2"),
    MEANT("outputs=ao+multi_bounce slices=2"),
    MEANT("outputs=ao+near+far+irradiance+composite environment=hook bounces=recursive f0=scalar slices=2"),
    MEANT("outputs=ao+far environment=hook estimator=bitmask far_visibility=free_bits slices=2"),
    MEANT("outputs=ao+far environment=cube estimator=bitmask far_visibility=free_bits slices=2"),
    MEANT("outputs=ao+near+far environment=cube far_visibility=ao march=sweep slices=2 downscale=2"),
    MEANT("outputs=ao+near projection=orthographic mips=mean slices=2"),
    CORNER("outputs=ao slices=4 steps=16 noise=none"),
    CORNER("outputs=ao march=sweep slices=8"),
    CORNER("outputs=ao estimator=bitmask slices=4 steps=16"),
    CORNER("outputs=ao slices=4 steps=16 downscale=2 filter=3x3"),
    CORNER("outputs=ao sampling=bilinear slices=4 steps=16 normals=view"),
    WHITE("outputs=ao+near+bent slices=2", 1),
    WHITE("outputs=ao+near slices=2 reach=2 falloff=0.2 exponent=3", 1),
    WHITE("outputs=ao+near sampling=bilinear slices=2 spacing=geometric", 1),
    WHITE("outputs=ao+near occluder=heuristic slices=2", 1),
    WHITE("outputs=ao+near estimator=bitmask occluder=thick slices=2", 1),
    WHITE("outputs=ao+near march=sweep slices=4", 1),
    WHITE("outputs=ao+near march=sweep slices=2 sweep_stride=3 filter=3x3", 1),
    WHITE("outputs=ao+near march=both estimator=bitmask occluder=thick reach=1 slices=2", 1),
    WHITE("outputs=ao+near mips=spread slices=2 interleave=yes", 1),
    WHITE("outputs=ao+near mips=weighted slices=2 steps=16", 1),
    WHITE("outputs=ao+near gather=side slices=1 filter=5x5 filter_passes=3", 1),
    WHITE("outputs=ao+near downscale=2 filter=3x3 slices=2", 1),
    WHITE("outputs=ao+near downscale=4 slices=2", 1),
    WHITE("outputs=ao+near temporal=yes slices=1 filter=3x3", 6),
    WHITE("outputs=ao+near temporal=yes slices=2 rectify=range storage=half reproject=gather", 6),
    WHITE("outputs=ao+near projection=orthographic slices=2 mips=nearest", 1),
    WHITE("outputs=ao+near slices=2 stage=fragment", 1),
    WHITE("outputs=ao+near temporal=yes downscale=2 slices=2 stage=fragment filter=3x3", 4),
    WHITE("outputs=ao+near mips=mean slices=2 stage=fragment", 1),
    PLATES("outputs=ao+near filter=5x5 filter_passes=3 slices=2"),
    PLATES("outputs=ao+near downscale=2 filter=3x3 slices=2"),
    PLATES("outputs=ao+near march=sweep slices=2 sweep_stride=3 filter=3x3"),
    { "truth_bent_follows_the_normal", "outputs=ao+bent reach=1e-6 slices=64 steps=1 noise=none", 2, fill_normals, expect_normals, 0 },
    { "truth_bent_follows_the_normal", "outputs=ao+bent reach=1e-6 slices=64 steps=1 noise=none stage=fragment", 2, fill_normals, expect_normals, 0 },
    OPEN("outputs=ao+uniform_ao+bent+specular_occlusion+multi_bounce slices=8 steps=8 noise=none", 5),
    OPEN("outputs=ao+near slices=2 steps=8 normals=depth", 5),
    OPEN("outputs=ao+multi_bounce bounce=cubic sampling=bilinear slices=2 reach=3", 5),
    OPEN("outputs=ao estimator=hbao reach=2 slices=2 attenuation=linear", 2),
    OPEN("outputs=ao estimator=hbao reach=2 slices=2", 2),
    OPEN("outputs=ao estimator=hbao_plus slices=2", 5),
    OPEN("outputs=ao+near+bent+uniform_ao estimator=bitmask slices=8 noise=none", 5),
    OPEN("outputs=ao+near march=sweep slices=4", 5),
    OPEN("outputs=ao+near march=both estimator=bitmask occluder=thick reach=1 slices=4", 5),
    OPEN("outputs=ao+near mips=weighted slices=2", 2),
    OPEN("outputs=ao+near slices=2 spacing=geometric interleave=yes", 5),
    OPEN("outputs=ao+near slices=2 downscale=2 filter=3x3", 5),
    OPEN("outputs=ao+near slices=2 downscale=4", 5),
    OPEN("outputs=ao+near+bent slices=8 noise=none stage=fragment", 5),
};
const int extreme_truth_count = (int)(sizeof extreme_truths / sizeof *extreme_truths);
