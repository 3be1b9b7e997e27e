/* truths_counted.c - see truths.h: frames that meet a number at its last bit, and what only the text compiled for the CPU shows (tests/twin,
 * "loose"): work that is counted, devices that are inexact, histories that are spoiled, textures between fragments. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "truths.h"
#include "frames.h"

enum { WIDTH = 48, HEIGHT = 40, TEXELS = WIDTH * HEIGHT };

static const double facing[3] = { 0, 0, 1 };

static void begin(const hbil_plan *plan, extreme_frame *out, int width, int height)
{
    camera c = { 0, 0, 60, 0.1, 1e6, 1, { 0, 0 }, 0 };
    if (plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC) c.fov = 5;
    c.width = width;
    c.height = height;
    frames_begin(plan, out, &c, 0);
    truth_light(plan, out, 1);
}

/* A wall that faces the camera, 3 m away. */
static void wall_of(const hbil_plan *plan, extreme_frame *out, int width, int height)
{
    int p;
    begin(plan, out, width, height);
    for (p = 0; p < width * height; ++p) frames_put(plan, out, p % width, p / width, 3, facing);
}

static void fill_wall(const hbil_plan *plan, int index, extreme_frame *out)
{
    wall_of(plan, out, WIDTH, HEIGHT);
    out->frame.reset = index == 0;
}

/* The frame after the first has shrunk, its textures have not: less than half of its threads have a pixel. */
static void fill_shrinking_wall(const hbil_plan *plan, int index, extreme_frame *out)
{
    wall_of(plan, out, 17, 17);
    out->frame.reset = index == 0;
    out->frame.width = out->frame.height = index ? 9 : 17;
    out->frame.last_width = out->frame.last_height = 17;
}

/* Nothing but sky. */
static void fill_sky(const hbil_plan *plan, int index, extreme_frame *out)
{
    begin(plan, out, WIDTH, HEIGHT);
    out->frame.reset = index == 0;
}

/* As hbil_noise with hilbert_r2, number 0 turns the slices, 1 jitters the steps, 2 the edges of sectors. */
static float noise_of(uint32_t place, uint32_t frame, int number)
{
    static const uint32_t steps[3] = { 3242174889u, 2447445414u, 2654435769u };
    return (float)((steps[number] * (place + 288u * frame) + 2147483648u) >> 8) / 16777216.0f;
}

/* The first frame from `frame` on whose number of pixel (0, 0), place 0 of the curve, is `value`: of 24 bits, so that there is one. */
static uint32_t frame_of(uint32_t frame, int number, float value)
{
    while (noise_of(0, frame, number) != value) ++frame;
    return frame;
}

static void set_normal(const hbil_plan *plan, extreme_frame *out, int p, double x, double y, double z)
{
    float *n = frames_input(plan, out, "normal")->data + 3 * p;
    n[0] = (float)x, n[1] = (float)y, n[2] = (float)z;
}

/* ------------------------------------------------------------------------------------------------------------------ one pixel */

/* Steps of all heights, a hair above the tangent plane of pixel (0, 0), whose sectors' edges are jittered by the most there is. */
static void fill_last_sector(const hbil_plan *plan, int index, extreme_frame *out)
{
    const double tilt = 0.2 + 0.08 * index, n[3] = { -sin(tilt), 0, cos(tilt) };
    int x, y;
    begin(plan, out, WIDTH, HEIGHT);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            const double pixel = 5.0 / HEIGHT, far_away = sqrt((double)(x * x + y * y)); /* orthographic: 5 m high */
            const double step = far_away * 2e-6 * (1 + 9 * (double)frames_random((uint32_t)(x + 999 * y), (uint32_t)index));
            frames_put(plan, out, x, y, 3 - pixel * (x * tan(tilt) + step), n);
        }
    out->frame.index = frame_of((uint32_t)index << 24, 2, 16777215.0f / 16777216.0f);
    out->frame.reset = 1;
}

/* Columns that stand out and face along the rows' normal, beside pixel (0, 0), whose slice is the row. */
static void fill_sideways(const hbil_plan *plan, int index, extreme_frame *out)
{
    const double up[3] = { 0, 1, 0 };
    int p;
    (void)index;
    begin(plan, out, WIDTH, HEIGHT);
    for (p = 0; p < TEXELS; ++p) frames_put(plan, out, p % WIDTH, p / WIDTH, p % 4 < 2 ? 3 : 2, p % 4 < 2 ? facing : up);
    out->frame.index = frame_of(0, 0, 0);
    out->frame.reset = 1;
}

/* Depth that becomes `z` when a receiver is pulled to the eye. */
static float pulled_to(const hbil_plan *plan, float z)
{
    float from = z;
    while (from - plan->config.pull * from < z) from = nextafterf(from, 1e9f);
    return from;
}

/* So far to the side of so fine a grid that neighbours are in one place; two thirds of the columns end, by their thickness, at the
 * receivers between them. */
static void fill_coincident(const hbil_plan *plan, int index, extreme_frame *out)
{
    camera c = { WIDTH, HEIGHT, 0, 0.1, 1e6, 1, { 0, 0 }, 0 };
    const float start = pulled_to(plan, 2.5f);
    int p;
    (void)index;
    c.fov = 2e-6;
    c.shift[0] = c.shift[1] = 1e6;
    frames_begin(plan, out, &c, 0);
    truth_light(plan, out, 1);
    for (p = 0; p < TEXELS; ++p) {
        frames_put(plan, out, p % WIDTH, p / WIDTH, p % 3 == 1 ? (double)start : 2.0, facing);
    }
    out->frame.reset = 1;
}

/* Columns in turn: receivers, what lies as deep as these when they are pulled to the eye, and what stands out. */
static void fill_at_the_receiver(const hbil_plan *plan, int index, extreme_frame *out)
{
    const float start = pulled_to(plan, 2.5f);
    int p;
    (void)index;
    begin(plan, out, WIDTH, HEIGHT);
    for (p = 0; p < TEXELS; ++p)
        frames_put(plan, out, p % WIDTH, p / WIDTH, p % 3 == 0 ? (double)start : p % 3 == 1 ? 2.5 : 2.0, facing);
    out->frame.reset = 1;
}

/* ------------------------------------------------------------------------------------------------------------ lobes and cones */

/* Seen at 60 degrees, with lobes of all widths that only just touch the horizon. */
static void fill_touching(const hbil_plan *plan, int index, extreme_frame *out)
{
    const double o = (double)(16384 + 3 * index) / 32767, l = sqrt(o * o + (1 - o) * (1 - o)); /* a code of hbil_encode_normal */
    const double nv = (1 - o) / l;
    float r = (float)sqrt(log2(sqrt(1 - nv * nv)) / -3.32193);
    int p;
    wall_of(plan, out, WIDTH, HEIGHT);
    for (p = 0; p < TEXELS / 2; ++p) r = nextafterf(r, 0);
    for (p = 0; p < TEXELS; ++p, r = nextafterf(r, 1)) {
        set_normal(plan, out, p, o / l, 0, nv);
        frames_input(plan, out, "roughness")->data[p] = r;
    }
    out->frame.reset = 1;
}

/* Grooves of all depths: rows in their middle see a cone about their normal. Frame 0 says how wide; after it the lobe is as wide, to the
 * last few bits. */
static float cone[TEXELS];

static void fill_grooves(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    begin(plan, out, WIDTH, HEIGHT);
    for (p = 0; p < TEXELS; ++p) {
        const int x = p % WIDTH, y = p / WIDTH;
        float r = 0.3f;
        frames_put(plan, out, x, y, y % 8 == 4 ? 3 : 3 - 0.2 - 0.01 * x, facing);
        if (index) r = (float)sqrt(log2(fmin(fmax((double)cone[p], 0.2), 0.99)) / -3.32193) * (1 + 1e-7f * (float)(index + y / 8));
        frames_input(plan, out, "roughness")->data[p] = r;
    }
    out->frame.reset = 1;
}

static int expect_grooves(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *so = truth_output(plan, outputs, "specular_occlusion");
    int p;
    (void)f;
    for (p = 0; p < TEXELS; ++p) {
        if (index == 0) cone[p] = sqrtf(1 - ao->data[p]);
        else if (p / WIDTH % 8 == 4 && !(so->data[p] > 0.5f))
            return snprintf(why, size, "the lobe of pixel (%d, %d) is hidden: %g", p % WIDTH, p / WIDTH, (double)so->data[p]), 0;
    }
    return 1;
}

/* ------------------------------------------------------------------------------------------------------------------- fragments */

/* Codes of hbil_encode_normal are the nearest to their normals, where these face the camera: half a code away, and rounding. */
static int expect_codes(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *codes = &outputs[hbil_plan_texture(plan, "view_normal")];
    const float *normal = f->inputs[hbil_plan_texture(plan, "normal")].data;
    int p, k;
    (void)index;
    for (p = 0; p < codes->width * codes->height; ++p) {
        const float *n = normal + 3 * p;
        const double sum = fabs((double)n[0]) + fabs((double)n[1]) + fabs((double)n[2]);
        uint32_t bits;
        memcpy(&bits, &codes->data[p], sizeof bits);
        for (k = 0; k < 2 && !truth_is_sky(f, plan, p); ++k) {
            const double code = (double)(int16_t)(bits >> 16 * k), right = (double)n[k] / sum * 32767;
            if (n[2] > 0 && fabs(code - right) > 0.51)
                return snprintf(why, size, "code %d of the normal of pixel (%d, %d) is %g, not %g", k, p % codes->width, p / codes->width, code,
                                right), 0;
        }
    }
    return 1;
}

static void fill_room(const hbil_plan *plan, int index, extreme_frame *out)
{
    frames_room(plan, out, 37, 23, index);
    truth_light(plan, out, 1);
}

static void fill_wide_room(const hbil_plan *plan, int index, extreme_frame *out)
{
    frames_room(plan, out, WIDTH, HEIGHT, index);
    truth_light(plan, out, 1);
}

/* Rows that stand out and face along the slices, some a hair away from the eye. */
static void fill_along(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    begin(plan, out, WIDTH, HEIGHT);
    for (p = 0; p < TEXELS; ++p) {
        const int low = p / WIDTH % 4 < 2;
        frames_put(plan, out, p % WIDTH, p / WIDTH, low ? 3 : 2, facing);
        if (low) continue;
        set_normal(plan, out, p, 1e-3 * ((double)frames_random((uint32_t)p, (uint32_t)index) - 0.5), p & 1 ? 1 : -1,
                   -1e-3 * (double)frames_random((uint32_t)p, (uint32_t)index + 9));
    }
    out->frame.reset = 1;
}

/* --------------------------------------------------------------------------------------------------------------------- the table */

#define LOOSE(name, config, frames, fill, expect) { name, config, frames, fill, expect, EXTREME_TWIN }
#define GROOVES "outputs=ao+specular_occlusion projection=orthographic reach=0.5 slices=1 steps=4 noise=none"
#define SPOILED(config) { "truth_spoiled_history_is_gone", config, 3, fill_wide_room, NULL, EXTREME_TWIN | EXTREME_SPOILED }

const extreme_case extreme_counted[] = {
    { "truth_edges_end_with_the_last_sector", "outputs=ao estimator=bitmask slices=1 steps=48 bias=1e-6 pull=1e-8 "
      "projection=orthographic", 12, fill_last_sector, NULL, 0 },
    { "truth_a_source_across_the_slice_gives_light",
      "outputs=ao+near facing=half_space slices=1 steps=8 projection=orthographic", 1, fill_sideways, NULL, 0 },
    { "truth_a_source_across_the_slice_gives_light",
      "outputs=ao+near facing=half_space estimator=bitmask slices=1 steps=8 projection=orthographic", 1, fill_sideways, NULL, 0 },
    LOOSE("truth_back_ends_may_be_at_the_receiver",
          "outputs=ao estimator=bitmask occluder=thick thickness=0.5 slices=2 steps=4 projection=orthographic", 1, fill_coincident, NULL),
    { "truth_corners_may_be_at_the_receiver",
      "outputs=ao+near sampling=bilinear slices=2 steps=4 projection=orthographic", 1, fill_at_the_receiver, NULL, 0 },
    LOOSE("truth_lobes_may_touch_the_horizon",
          "outputs=specular_occlusion projection=orthographic reach=1e-6 slices=1 steps=1", 24, fill_touching, NULL),
    LOOSE("truth_lobes_may_be_as_wide_as_the_cone", GROOVES, 8, fill_grooves, expect_grooves),
    { "truth_lobes_may_be_as_wide_as_the_cone", GROOVES, 8, fill_grooves, expect_grooves, 0 },
    LOOSE("truth_codes_are_the_nearest", "outputs=ao stage=fragment slices=1 steps=1", 1, fill_room, expect_codes),
    LOOSE("truth_last_light_is_on_the_screen", "outputs=ao+near bounces=recursive stage=fragment downscale=2 slices=1 steps=2", 3, fill_room, NULL),
    LOOSE("truth_last_light_is_on_the_screen", "outputs=ao+near bounces=recursive stage=fragment downscale=4 slices=1 steps=2", 3, fill_room, NULL),
    LOOSE("truth_a_source_along_the_slice_gives_light", "outputs=ao+near facing=half_space noise=none slices=1 steps=8 projection=orthographic", 4,
          fill_along, NULL),
    LOOSE("truth_a_source_along_the_slice_gives_light", "outputs=ao+near facing=half_space estimator=bitmask noise=none slices=1 steps=8 "
          "projection=orthographic", 4, fill_along, NULL),
    SPOILED("outputs=ao+near temporal=yes rectify=none slices=2 steps=4 reproject=camera"),
    SPOILED("outputs=ao+near temporal=yes rectify=none slices=2 steps=4 reproject=scatter"),
    SPOILED("outputs=ao+near bounces=recursive slices=2 steps=4 reproject=scatter"),
    LOOSE("truth_marches_end_with_their_reach", "outputs=ao slices=1 steps=32 reach=0.3", 1, fill_wall, NULL),
    LOOSE("truth_marches_end_with_their_reach", "outputs=ao slices=1 steps=32 reach=0.3 estimator=bitmask", 1, fill_wall, NULL),
    LOOSE("truth_what_hides_nothing_has_no_edges", "outputs=ao slices=1 steps=32 estimator=bitmask", 1, fill_wall, NULL),
    LOOSE("truth_solid_back_ends_need_no_arc", "outputs=ao slices=1 steps=32 estimator=bitmask", 1, fill_wide_room, NULL),
    LOOSE("truth_threads_beside_the_frame_rest",
          "outputs=ao slices=1 steps=1 interleave=yes temporal=yes reproject=scatter", 2, fill_shrinking_wall, NULL),
    LOOSE("truth_the_sky_costs_nothing", "outputs=ao+near bounces=recursive reproject=scatter slices=1 steps=1", 2, fill_sky, NULL),
    LOOSE("truth_claims_are_read_once", "outputs=ao slices=1 steps=1 interleave=yes temporal=yes reproject=scatter", 2, fill_wall, NULL),
};
const int extreme_counted_count = (int)(sizeof extreme_counted / sizeof *extreme_counted);

/* Counted by hand where whole; else what the passes do, rounded up. */
const extreme_limit extreme_limits[] = {
    { "truth_marches_end_with_their_reach", "march", 8, 1, 20 },
    { "truth_what_hides_nothing_has_no_edges", "march", 40, 1, 45 },
    { "truth_solid_back_ends_need_no_arc", "march", 30, 1, 40 },
    { "truth_threads_beside_the_frame_rest", "march", 4, 2, 10 },
    { "truth_threads_beside_the_frame_rest", "scatter", 7.2, 4.6, 0 }, /* 17 x 17 pixels of last frame, 9 x 9 of this: 2 and 1 each, and 1 */
    { "truth_threads_beside_the_frame_rest", "claim", 10.8, 3.6, 0 },
    { "truth_the_sky_costs_nothing", "prepare", 1, 3, 0 },
    { "truth_the_sky_costs_nothing", "scatter", 1, 1, 0 },
    { "truth_the_sky_costs_nothing", "reproject", 1, 2, 0 },
    { "truth_claims_are_read_once", "temporal", 53, 4, 9 },
};
const int extreme_limit_count = (int)(sizeof extreme_limits / sizeof *extreme_limits);
