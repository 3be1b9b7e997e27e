/* truths_inside.c - see truths.h: what the textures between the passes hold. Only Vulkan shows these (tests/mutation/trial.c). */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "truths.h"
#include "frames.h"

#define NOWHERE 0xffffffffu /* HBIL_NOWHERE of the shaders */

/* Any texture that a pass writes. */
static const image *inside(const hbil_plan *plan, const image *outputs, const char *name)
{
    return &outputs[hbil_plan_texture(plan, name)];
}

static float value_at(const image *img, int x, int y, int slice)
{
    return img->data[(size_t)img->channels * (((size_t)slice * (size_t)img->height + (size_t)y) * (size_t)img->width + (size_t)x)];
}

static uint32_t bits_at(const image *img, int x, int y)
{
    const float v = value_at(img, x, y, 0);
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits;
}

/* As hbil_unpack_radiance: one channel, 0 to 2. */
static double light_at(const image *img, int x, int y, int channel)
{
    const uint32_t code = bits_at(img, x, y);
    return ldexp((double)(code >> 9 * channel & 511), (int)(code >> 27) - 24);
}

static camera camera_of(const hbil_plan *plan, int width, int height)
{
    camera c = { 0, 0, 60, 0.1, 1e6, 1, { 0, 0 }, 0 };
    if (plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC) c.fov = 5;
    c.width = width;
    c.height = height;
    return c;
}

/* ---------------------------------------------------------------------------------------------------------------------- the grid */

static const plane leaves[] = { { { 0, 0, 1 }, -2, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0.1, 0, 0.995 }, -4.5, { 0, 0, 0 }, { 0, 0, 0 } },
                                { { 0, -0.1, 0.995 }, -9, { 0, 0, 0 }, { 0, 0, 0 } } };
enum { LEAVES = sizeof leaves / sizeof *leaves };

/* Which leaf a pixel sees, -1: the sky. Every other block of 8 x 8 pixels is of one. */
static int leaf_of(int x, int y, int index)
{
    const int whole = (x / 8 + y / 8) & 1, seed = index + 40;
    const float r = whole ? frames_random((uint32_t)(x / 8 + 99 * (y / 8)), (uint32_t)seed) : frames_random((uint32_t)(x + 999 * y), (uint32_t)seed);
    return (int)(r * (LEAVES + 1)) - 1;
}

static double leaf_depth(const hbil_plan *plan, const hbil_frame *f, int leaf, double x, double y)
{
    const plane *q = &leaves[leaf];
    double ray[2], side;
    frames_ray(plan, f, x, y, ray);
    side = q->n[0] * ray[0] + q->n[1] * ray[1];
    return plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC ? (side - q->d) / q->n[2] : q->d / (side - q->n[2]);
}

static void fill_leaves(const hbil_plan *plan, int index, extreme_frame *out)
{
    static const int sizes[][2] = { { 48, 40 }, { 67, 21 }, { 37, 23 }, { 68, 20 } };
    const camera c = camera_of(plan, sizes[index][0], sizes[index][1]);
    int x, y;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < c.height; ++y)
        for (x = 0; x < c.width; ++x) {
            const int leaf = leaf_of(x, y, index);
            if (leaf >= 0) frames_put(plan, out, x, y, leaf_depth(plan, &out->frame, leaf, x + 0.5, y + 0.5), leaves[leaf].n);
        }
    out->frame.reset = 1;
}

static int smaller(int a, int b) { return a < b ? a : b; }

/* Depth of a pixel of the grid, as shrink.glsl says. */
static double grid_depth(const hbil_plan *plan, const hbil_frame *f, int px, int py, int index)
{
    const int d = plan->config.downscale, w = (int)f->width, h = (int)f->height, farthest = (px + py) & 1;
    const int x0 = smaller(px * d + d / 2 - 1, w - 2), y0 = smaller(py * d + d / 2 - 1, h - 2);
    double best = 1e15;
    int i, same = 1;
    for (i = 0; i < 4; ++i) {
        const int x = x0 + (i & 1), y = y0 + i / 2, leaf = leaf_of(x, y, index);
        const double z = leaf < 0 ? 1e15 : leaf_depth(plan, f, leaf, x + 0.5, y + 0.5);
        same = same && leaf == leaf_of(x0, y0, index);
        if (leaf >= 0 && (best > 1e14 || (farthest ? z > best : z < best))) best = z;
    }
    return same && best < 1e14 ? leaf_depth(plan, f, leaf_of(x0, y0, index), (px + 0.5) * d, (py + 0.5) * d) : best;
}

static int expect_grid(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *z = inside(plan, outputs, "view_depth");
    int x, y;
    for (y = 0; y < z->height; ++y)
        for (x = 0; x < z->width; ++x) {
            const double at = (double)value_at(z, x, y, 0), right = grid_depth(plan, &f->frame, x, y, index);
            if (right > 1e14 ? at == (double)1e15f : fabs(at - right) < 1e-4 * right) continue; /* HBIL_SKY */
            snprintf(why, size, "depth of the grid's pixel (%d, %d) is %g, not %g", x, y, at, right);
            return 0;
        }
    return 1;
}

/* Coarser levels: between the nearest and the farthest surface below; sky only where there is none. */
static int expect_levels(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *z = inside(plan, outputs, "depth_mips");
    const int w = z->width, h = z->height;
    int level, x, y, i, k;
    for (level = 1; level <= 3; ++level)
        for (y = 0; y << level < h; ++y)
            for (x = 0; x << level < w; ++x) {
                const double at = (double)value_at(z, x + (level > 1 ? (w + 1) / 2 : 0), y + (level > 2 ? (h + 3) / 4 : 0), 1);
                double low = 1e15, high = 0;
                for (k = y << level; k < smaller((y + 1) << level, h); ++k)
                    for (i = x << level; i < smaller((x + 1) << level, w); ++i) {
                        const double own = leaf_of(i, k, index) < 0 ? 1e15 : leaf_depth(plan, &f->frame, leaf_of(i, k, index), i + 0.5, k + 0.5);
                        low = fmin(low, own);
                        if (own < 1e14) high = fmax(high, own);
                    }
                if (low > 1e14 ? at > 1e14 : at > low * 0.9999 && at < high * 1.0001) continue;
                snprintf(why, size, "depth of texel (%d, %d) of level %d is %g, not in [%g, %g]", x, y, level, at, low, high);
                return 0;
            }
    return 1;
}

/* -------------------------------------------------------------------------------------------------------------- depths and signals */

/* Depths of an infinite far plane so small that they are farther than the sky. */
static void fill_beyond(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *depth;
    int p;
    frames_room(plan, out, 48, 40, 0);
    out->frame.reset = 1;
    depth = frames_input(plan, out, "depth");
    for (p = 0; p < depth->width * depth->height; ++p)
        if (frames_random((uint32_t)p, (uint32_t)(index + 12)) < 0.2f) depth->data[p] = 1e-25f;
}

/* They are the sky's own. */
static int expect_beyond(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *z = inside(plan, outputs, "view_depth");
    int p;
    (void)index, (void)f;
    for (p = 0; p < z->width * z->height; ++p)
        if (z->data[p] > 1e6f && z->data[p] != 1e15f) /* HBIL_SKY */
            return snprintf(why, size, "depth of pixel (%d, %d) is %g", p % z->width, p / z->width, (double)z->data[p]), 0;
    return 1;
}

/* Posts close before a wall: obscurance counts them many times. */
static void fill_posts(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan, 48, 40);
    const double n[3] = { 0, 0, 1 };
    int p;
    frames_begin(plan, out, &c, index);
    for (p = 0; p < c.width * c.height; ++p) frames_put(plan, out, p % c.width, p / c.width, p % c.width % 12 < 6 ? 3 : 2.9, n);
    out->frame.reset = 1;
}

/* What the filter gets is no blacker than black. */
static int expect_signal(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *raw = inside(plan, outputs, "raw");
    float least = 1;
    int p;
    (void)index, (void)f;
    for (p = 0; p < raw->width * raw->height; ++p) {
        least = fminf(least, raw->data[p]);
        if (raw->data[p] >= 0 && raw->data[p] <= 1) continue;
        snprintf(why, size, "raw ao of pixel (%d, %d) is %g", p % raw->width, p / raw->width, (double)raw->data[p]);
        return 0;
    }
    return least <= 0 || snprintf(why, size, "nothing is black: %g", (double)least) < 0;
}

/* -------------------------------------------------------------------------------------------------------------------- last light */

enum { ZOOM = 3 };

/* A plate before a wall, with normals of their own: they turn from column to column, and so does the far light; what leaves them is dark.
 * Frame 1 is seen through a lens three times as long: two of three pixels are holes. */
static void fill_zoom_at(const hbil_plan *plan, int index, extreme_frame *out, int width, int height, double up)
{
    const int ortho = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    camera c = camera_of(plan, width, height), tele = c;
    image *radiance, *albedo;
    int x, y, k;
    float first[16];
    tele.fov = ortho ? c.fov / ZOOM : 2 * 57.29577951 * atan(tan(c.fov / 2 / 57.29577951) / ZOOM);
    frames_begin(plan, out, &c, 0);
    memcpy(first, out->frame.projection, sizeof first);
    if (index) {
        extreme_free(out);
        memset(out, 0, sizeof *out);
        frames_begin(plan, out, &tele, 1);
    }
    memcpy(out->frame.last_projection, first, sizeof first);
    for (y = 0; y < height; ++y)
        for (x = 0; x < width; ++x) {
            const double side = x & 1 ? 0.5 : -0.5, wall[3] = { side, 0, 0.866025404 }, plate[3] = { 0, 0, 1 };
            double ray[2], z = ortho ? -0.1 - up : 2;
            int front;
            frames_ray(plan, &out->frame, x + 0.5, y + 0.5, ray);
            front = fabs(ray[0] * (ortho ? 1 : z)) < 0.25;
            frames_put(plan, out, x, y, front ? z : ortho ? 0.1 - up : 4, front ? plate : wall);
        }
    memset(out->frame.far_sh, 0, sizeof out->frame.far_sh);
    for (k = 0; k < 3; ++k) out->frame.far_sh[0][k] = 2, out->frame.far_sh[3][k] = 1.6f;
    radiance = frames_input(plan, out, "radiance");
    albedo = frames_input(plan, out, "albedo");
    if (radiance) frames_fill(radiance, 0);
    if (albedo) frames_fill(albedo, 1);
    out->frame.reset = index == 0;
}

static void fill_zoom(const hbil_plan *plan, int index, extreme_frame *out) { fill_zoom_at(plan, index, out, 48, 40, 0); }
static void fill_zoom_odd(const hbil_plan *plan, int index, extreme_frame *out) { fill_zoom_at(plan, index, out, 68, 20, 0); }
/* Behind the eye, where an orthographic camera sees as well. */
static void fill_zoom_behind(const hbil_plan *plan, int index, extreme_frame *out) { fill_zoom_at(plan, index, out, 68, 20, 3); }

/* What the wall or the plate reflects in frame 1 is what one of its pixels got in frame 0, or something between two of these. */
static int expect_zoom(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    static double range[2][2]; /* of the wall, of the plate */
    const image *far = inside(plan, outputs, "far"), *light = inside(plan, outputs, "view_radiance");
    const float *z = f->inputs[hbil_plan_texture(plan, "depth")].data;
    const double edge = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC ? 0 : 3;
    int p, what;
    if (index == 0)
        for (what = 0; what < 2; ++what) range[what][0] = 1e9, range[what][1] = 0;
    for (p = 0; p < far->width * far->height; ++p) {
        double *of = range[what = (double)z[p] < edge], at;
        if (index == 0) {
            of[0] = fmin(of[0], (double)far->data[4 * p]);
            of[1] = fmax(of[1], (double)far->data[4 * p]);
            continue;
        }
        at = light_at(light, p % far->width, p / far->width, 0) / 0.95; /* HBIL_GAIN_MAX */
        if (at > of[0] * 0.99 && at < of[1] * 1.01) continue;
        snprintf(why, size, "pixel (%d, %d) of the %s reflects %g, not in [%g, %g]", p % far->width, p / far->width, what ? "plate" : "wall", at, of[0],
                 of[1]);
        return 0;
    }
    return range[0][1] > 2 * range[0][0] || snprintf(why, size, "the wall is lit alike: %g to %g", range[0][0], range[0][1]) < 0;
}

/* Levels 1 and 2 of what fell know of a surface where one of their pixels does, and nowhere else. */
static int expect_pushed(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *pushed = inside(plan, outputs, "pushed"), *claimed = inside(plan, outputs, "claimed");
    const int w = claimed->width, h = claimed->height;
    int level, x, y, i, k;
    (void)f;
    if (index == 0) return 1;
    for (level = 1; level <= 2; ++level)
        for (y = 0; y << level < h; ++y)
            for (x = 0; x << level < w; ++x) {
                const size_t texel = (size_t)(y * w + x + (level == 2 ? (w + 1) / 2 : 0));
                int fell = 0;
                for (k = y << level; k < smaller((y + 1) << level, h); ++k)
                    for (i = x << level; i < smaller((x + 1) << level, w); ++i) fell += bits_at(claimed, i, k) != NOWHERE;
                if ((fell > 0) == (pushed->data[4 * texel + 3] != 0)) continue;
                snprintf(why, size, "texel (%d, %d) of level %d: depth %g, but %d surfaces fell there", x, y, level, (double)pushed->data[4 * texel + 3],
                         fell);
                return 0;
            }
    return 1;
}

/* A wall, through which the eye goes. */
static void fill_passed(const hbil_plan *plan, int index, extreme_frame *out)
{
    const camera c = camera_of(plan, 48, 40);
    const plane q = { { 0, 0, 1 }, -3, { 0, 0, 0 }, { 0, 0, 0 } };
    frames_begin(plan, out, &c, index);
    frames_planes(plan, out, &q, 1);
    if (index) out->frame.view[14] = 4;
}

/* It is behind now: nowhere on the screen. */
static int expect_passed(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *claimed = inside(plan, outputs, "claimed");
    int p;
    (void)f;
    for (p = 0; p < claimed->width * claimed->height && index; ++p)
        if (bits_at(claimed, p % claimed->width, p / claimed->width) != NOWHERE)
            return snprintf(why, size, "pixel (%d, %d) is claimed by what is behind the eye", p % claimed->width, p / claimed->width), 0;
    return 1;
}

/* A grey corner as bright as can be, amplified: grey it stays, and no darker than what leaves it. */
static void fill_glare(const hbil_plan *plan, int index, extreme_frame *out)
{
    truth_corner(plan, index, out);
    truth_light(plan, out, 50000);
    frames_fill(frames_input(plan, out, "albedo"), 0.6f);
    out->frame.reset = index == 0;
}

static int expect_glare(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *light = inside(plan, outputs, "view_radiance");
    double most = 0;
    int p;
    (void)f;
    for (p = 0; p < light->width * light->height; ++p) {
        const int x = p % light->width, y = p / light->width;
        const double r = light_at(light, x, y, 0), g = light_at(light, x, y, 1), b = light_at(light, x, y, 2);
        most = fmax(most, r);
        if (r == g && g == b && r > 49800 && r < 60200) continue;
        snprintf(why, size, "radiance of pixel (%d, %d): %g %g %g", x, y, r, g, b);
        return 0;
    }
    return index == 0 || most > 55000 || snprintf(why, size, "nothing is reflected: at most %g", most) < 0;
}

/* --------------------------------------------------------------------------------------------------------------------- the table */

#define GRID(config) { "truth_the_grid_has_a_surface_of_each_block", config, 3, fill_leaves, expect_grid, 0 }
#define LEVELS(config) { "truth_levels_are_between_their_surfaces", config, 4, fill_leaves, expect_levels, 0 }
#define LAST(config) { "truth_surfaces_reflect_what_they_got", config, 2, fill_zoom, expect_zoom, 0 }, \
    { "truth_surfaces_reflect_what_they_got", config, 2, fill_zoom_odd, expect_zoom, 0 }
#define GLARE(config) { "truth_grey_stays_grey_at_the_brightest", config, 4, fill_glare, expect_glare, 0 }

const extreme_case extreme_inside[] = {
    GRID("outputs=ao downscale=2 slices=1 steps=1"),
    GRID("outputs=ao downscale=4 slices=1 steps=1"),
    GRID("outputs=ao downscale=2 slices=1 steps=1 projection=orthographic"),
    LEVELS("outputs=ao mips=mean slices=1 steps=2"),
    LEVELS("outputs=ao mips=mean slices=1 steps=2 projection=orthographic"),
    LEVELS("outputs=ao mips=weighted slices=1 steps=2"),
    { "truth_beyond_the_sky_is_the_sky", "outputs=ao depth=device depth_direction=reversed depth_far=infinite slices=1 steps=1", 2, fill_beyond,
      expect_beyond, 0 },
    { "truth_black_is_no_blacker", "outputs=ao estimator=hbao_plus multiplier=16 filter=3x3 reach=0.4 noise=none slices=4 steps=4 exponent=1", 1,
      fill_posts, expect_signal, 0 },
    LAST("outputs=ao+near+far environment=sh far_visibility=ao bounces=recursive reproject=scatter slices=1 steps=1 reach=1e-6"),
    LAST("outputs=ao+near+far environment=sh far_visibility=ao bounces=recursive reproject=scatter slices=1 steps=1 reach=1e-6 "
         "projection=orthographic"),
    LAST("outputs=ao+near+far environment=sh far_visibility=ao bounces=recursive reproject=camera slices=1 steps=1 reach=1e-6"),
    { "truth_what_fell_is_known_to_its_levels", "outputs=ao+near+far environment=sh far_visibility=ao bounces=recursive reproject=scatter slices=1 "
      "steps=1 reach=1e-6", 2, fill_zoom_odd, expect_pushed, 0 },
    { "truth_what_fell_is_known_to_its_levels", "outputs=ao+near+far environment=sh far_visibility=ao bounces=recursive reproject=scatter slices=1 "
      "steps=1 reach=1e-6 projection=orthographic", 2, fill_zoom_behind, expect_pushed, 0 },
    { "truth_what_is_behind_falls_nowhere", "outputs=ao temporal=yes reproject=scatter slices=1 steps=1", 2, fill_passed, expect_passed, 0 },
    GLARE("outputs=ao+near bounces=recursive near_intensity=4 slices=2"),
    GLARE("outputs=ao+near bounces=recursive near_intensity=2 slices=2"),
};
const int extreme_inside_count = (int)(sizeof extreme_inside / sizeof *extreme_inside);
