/* truths_scenes.c - see truths.h: scenes that each show one rule of a march, a filter or a history. View space: x right, y up, z towards
 * the eye. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "truths.h"
#include "frames.h"

enum { WIDTH = 48, HEIGHT = 40, TEXELS = WIDTH * HEIGHT };

static const double facing[3] = { 0, 0, 1 };

static void begin(const hbil_plan *plan, extreme_frame *out, double fov)
{
    camera c = { WIDTH, HEIGHT, 60, 0.1, 1e6, 1, { 0, 0 }, 0 };
    c.fov = fov;
    frames_begin(plan, out, &c, 0);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
}

static void put(const hbil_plan *plan, extreme_frame *out, int x, int y, double z) { frames_put(plan, out, x, y, z, facing); }

/* A wall that faces the camera, 3 m away. */
static void wall(const hbil_plan *plan, extreme_frame *out)
{
    int p;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p) put(plan, out, p % WIDTH, p / WIDTH, 3);
}

static void set_normal(const hbil_plan *plan, extreme_frame *out, int p, double x, double y, double z)
{
    float *n = frames_input(plan, out, "normal")->data + 3 * p;
    const double l = sqrt(x * x + y * y + z * z);
    n[0] = (float)(x / l), n[1] = (float)(y / l), n[2] = (float)(z / l);
}

static void color(const hbil_plan *plan, extreme_frame *out, int p, float r, float g, float b)
{
    image *radiance = frames_input(plan, out, "radiance");
    if (!radiance) return;
    radiance->data[radiance->channels * p] = r;
    radiance->data[radiance->channels * p + 1] = g;
    radiance->data[radiance->channels * p + 2] = b;
}

static double of(const image *img, int p, int channel) { return (double)img->data[(size_t)img->channels * (size_t)p + (size_t)channel]; }

static int fail(char *why, size_t size, const char *name, int p, double value, double low, double high)
{
    snprintf(why, size, "%s of pixel (%d, %d) is %g, not in [%g, %g]", name, p % WIDTH, p / WIDTH, value, low, high);
    return 0;
}

/* ao of one pixel. */
static int ao_at(const hbil_plan *plan, const image *outputs, int x, int y, double low, double high, char *why, size_t size)
{
    const double ao = of(truth_output(plan, outputs, "ao"), y * WIDTH + x, 0);
    return (ao >= low && ao <= high) || fail(why, size, "ao", y * WIDTH + x, ao, low, high);
}

/* --------------------------------------------------------------------------------------------------------------------- marches */

/* Pixel (0, 0) of this frame has no jitter: its first sample is one stride away, at t = 0. */
static void fill_unjittered(const hbil_plan *plan, int index, extreme_frame *out)
{
    uint32_t frame = 0;
    (void)index;
    wall(plan, out);
    while ((2447445414u * (288u * frame) + 2147483648u) >> 8 != 0) ++frame; /* hbil_noise: index 0 of the curve */
    out->frame.index = frame;
}

/* Two walls 2 m apart, seen along them through a lens so wide that one faces the other across more than 90 degrees. */
static void fill_corridor(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane q[] = { { { 1, 0, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } }, { { -1, 0, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } } };
    (void)index;
    begin(plan, out, 150);
    frames_planes(plan, out, q, 2);
}

static int expect_corridor(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index, (void)f;
    return ao_at(plan, outputs, 3, HEIGHT / 2, 0, 0.55, why, size);
}

/* A floor, and on it, nearly below the eye, a plate. The reach of the floor before it ends behind the eye. */
static void fill_overhead(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane q[] = { { { 0, 1, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 1 }, -0.1, { -9, -1, -9 }, { 9, -0.38, 0 } } };
    (void)index;
    begin(plan, out, 170);
    frames_planes(plan, out, q, 2);
}

static int expect_overhead(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index, (void)f;
    return ao_at(plan, outputs, WIDTH / 2, HEIGHT / 2 + 1, 0.5, 0.95, why, size);
}

/* A floor below a fence that hangs in the sky, of bars one pixel wide: no four pixels of it lie together. */
static void fill_fence(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane floor = { { 0, 1, 0 }, -1, { -99, -9, -99 }, { 99, 9, 0 } };
    int x, y;
    (void)index;
    begin(plan, out, 60);
    frames_planes(plan, out, &floor, 1);
    for (y = 0; y < 26; ++y)
        for (x = 0; x < WIDTH; ++x) {
            if (y >= 10 && y < 25 && x % 2 == 0) put(plan, out, x, y, 3);
            else frames_input(plan, out, "depth")->data[y * WIDTH + x] = 0;
        }
}

static int expect_fence(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao");
    int p;
    (void)index, (void)f;
    for (p = 26 * WIDTH; p < TEXELS; ++p)
        if (of(ao, p, 0) < 0.995) return fail(why, size, "ao", p, of(ao, p, 0), 0.995, 1);
    return 1;
}

/* A wall with a floor at its foot: two steps find what is within reach. */
static int expect_near_foot(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    double sum = 0;
    int n = 0, x;
    (void)index;
    for (x = WIDTH / 3; x < WIDTH * 2 / 3; ++x) {
        int y = 1;
        while (y < HEIGHT - 1 && (normal->data[3 * (y * WIDTH + x) + 1] > 0) == (normal->data[3 * x + 1] > 0)) ++y;
        sum += of(ao, (y + 1) * WIDTH + x, 0);
        ++n;
    }
    return sum / n < 0.92 || fail(why, size, "mean ao along the corner, first", 0, sum / n, 0, 0.92);
}

/* A room whose normals are bumped. */
static void fill_bumps(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *normal;
    int p, k;
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    truth_light(plan, out, 1);
    out->frame.reset = 1;
    out->frame.index = (uint32_t)index; /* the slices turn */
    normal = frames_input(plan, out, "normal");
    for (p = 0; p < TEXELS; ++p) {
        double n[3];
        for (k = 0; k < 3; ++k)
            n[k] = (double)normal->data[3 * p + k] + 1.8 * ((double)frames_random((uint32_t)p, (uint32_t)(k + 3 * index + 70)) - 0.5);
        if (n[0] != 0 || n[1] != 0 || n[2] != 0) set_normal(plan, out, p, n[0], n[1], n[2]);
    }
}

/* One of ten of its pixels gives light: no other takes any away. */
static void fill_sparse_bumps(const hbil_plan *plan, int index, extreme_frame *out)
{
    float *radiance;
    int p;
    fill_bumps(plan, index, out);
    radiance = frames_input(plan, out, "radiance")->data;
    for (p = 0; p < TEXELS; ++p)
        if (frames_random((uint32_t)p, (uint32_t)(index + 90)) > 0.1f) memset(radiance + 3 * p, 0, 3 * sizeof(float));
}

/* White surfaces give no more than they hide: a share of 1, and what sums round. */
static int expect_at_most_one(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index;
    return truth_within(plan, f, outputs, "near", 0, 1 + 2e-6, why, size);
}

/* A floor below the sky, up to the horizon. */
static void fill_plain(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane floor = { { 0, 1, 0 }, -1.3, { 0, 0, 0 }, { 0, 0, 0 } };
    (void)index;
    begin(plan, out, 120);
    frames_planes(plan, out, &floor, 1);
}

static int expect_plain(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index;
    return truth_within(plan, f, outputs, "ao", 0.97, 1, why, size);
}

/* A wall up to column 23, before it a post one pixel wide, then nothing. */
static void fill_post(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    (void)index;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p)
        if (p % WIDTH <= 24) put(plan, out, p % WIDTH, p / WIDTH, p % WIDTH == 24 ? 2 : 3);
}

static int expect_post(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index, (void)f;
    return ao_at(plan, outputs, 23, HEIGHT / 2, 0, 0.75, why, size);
}

/* A floor with a low wall on it, over which the floor goes on to the horizon. */
static void fill_low_wall(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane q[] = { { { 0, 1, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } }, { { 0, 0, 1 }, -3, { -99, -2, -99 }, { 99, -0.3, 0 } } };
    (void)index;
    begin(plan, out, 60);
    frames_planes(plan, out, q, 2);
}

/* On the floor, a row before the wall. */
static int expect_low_wall(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int y = HEIGHT - 1;
    (void)index;
    while (y > 0 && normal->data[3 * (y * WIDTH + WIDTH / 2) + 1] > 0.5f) --y;
    return ao_at(plan, outputs, WIDTH / 2, y + 2, 0, 0.8, why, size);
}

/* Beside a wall nothing, then a plate a little before it, then a post much nearer. The plate alone gives light. */
static void fill_behind_gap(const hbil_plan *plan, int index, extreme_frame *out)
{
    image *radiance;
    int p;
    (void)index;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p) {
        const int x = p % WIDTH;
        if (x < 20 || x >= 26) put(plan, out, x, p / WIDTH, x < 20 ? 3 : x < 30 ? 2.4 : 1);
    }
    radiance = frames_input(plan, out, "radiance");
    for (p = 0; p < TEXELS; ++p)
        if (p % WIDTH < 26 || p % WIDTH >= 30) memset(radiance->data + 3 * p, 0, 3 * sizeof(float));
}

static int expect_behind_gap(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const double near = of(truth_output(plan, outputs, "near"), HEIGHT / 2 * WIDTH + 19, 0);
    (void)index, (void)f;
    return near > 0.03 || fail(why, size, "near", HEIGHT / 2 * WIDTH + 19, near, 0.03, 1);
}

/* ----------------------------------------------------------------------------------------------------------------- whose light */

/* A black wall whose normals lean, with white holes, deeper than any horizon of theirs, and black knobs. */
static void fill_holes(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    (void)index;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p) {
        const float what = frames_random((uint32_t)p, 5);
        frames_put(plan, out, p % WIDTH, p / WIDTH, what < 0.2f ? 60 : what < 0.4f ? 1.2 : 3, facing);
        set_normal(plan, out, p, p & 1 ? 0.8 : -0.8, 0, 0.6);
        color(plan, out, p, what < 0.2f, 0, 0);
    }
}

/* Nobody on the wall sees into a hole. */
static int expect_holes(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *near = truth_output(plan, outputs, "near");
    const float *z = f->inputs[hbil_plan_texture(plan, "depth")].data;
    double most = 0;
    int p, at = 0;
    (void)index;
    for (p = 0; p < TEXELS; ++p)
        if (fabsf(z[p] - 3) < 0.1f && (double)near->data[near->channels * p] > most) most = (double)near->data[near->channels * (at = p)];
    /* 0; where corners are placed beyond their cell 0.007 */
    return most < 1e-3 || snprintf(why, size, "near of pixel (%d, %d) is %g, not below 1e-3", at % WIDTH, at / WIDTH, most) < 0;
}

/* A wall, a gap through which the sky shows, and a comb of near green and less near red rows. */
static void fill_comb(const hbil_plan *plan, int index, extreme_frame *out)
{
    int x, y;
    (void)index;
    begin(plan, out, 60);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            color(plan, out, y * WIDTH + x, x >= 40 && y & 1, x >= 40 && !(y & 1), 0);
            if (x < 20 || (x >= 28 && x < 40)) continue;
            frames_put(plan, out, x, y, x < 40 ? 30 : y & 1 ? 15 : 2, facing);
        }
}

static int expect_comb(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *near = truth_output(plan, outputs, "near");
    double red = 0, green = 0;
    int x, y;
    (void)index, (void)f;
    for (y = 8; y < HEIGHT - 8; ++y)
        for (x = 20; x < 28; ++x) {
            red += (double)near->data[near->channels * (y * WIDTH + x)];
            green += (double)near->data[near->channels * (y * WIDTH + x) + 1];
        }
    /* 1.92; from the sky on as from a surface 1.50 */
    return green > 1.7 * red || snprintf(why, size, "green light is %g times the red, not above 1.7", green / red) < 0;
}

/* Posts one pixel wide before a wall. */
static void fill_pole(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    (void)index;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p) frames_put(plan, out, p % WIDTH, p / WIDTH, p % 16 == 8 ? 2.7 : 3, facing);
}

/* Of all pixels deeper than that. m */
static double mean_ao(const hbil_plan *plan, const extreme_frame *f, const image *outputs, double deeper)
{
    const image *ao = truth_output(plan, outputs, "ao");
    const float *z = f->inputs[hbil_plan_texture(plan, "depth")].data;
    double sum = 0;
    int p, n = 0;
    for (p = 0; p < ao->width * ao->height; ++p)
        if ((double)z[p] > deeper) sum += (double)ao->data[p], ++n;
    return sum / n;
}

static int expect_pole(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const double ao = mean_ao(plan, f, outputs, 2.9);
    (void)index;
    /* 0.989; without decay 0.834 */
    return ao > 0.9 || snprintf(why, size, "mean ao of the wall is %g, not above 0.9", ao) < 0;
}

/* Strips of a wall, each 8 pixels wide, 0.6 m in front of the others. */
static void fill_battlements(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    (void)index;
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p) frames_put(plan, out, p % WIDTH, p / WIDTH, p % 16 < 8 ? 3 : 2.4, facing);
}

static int expect_battlements(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const double ao = mean_ao(plan, f, outputs, 2.9);
    (void)index;
    /* 0.838; where what fades sinks below the tangent plane 0.947 */
    return ao < 0.89 || snprintf(why, size, "mean ao of the wall is %g, not below 0.89", ao) < 0;
}

/* Black surfaces. */
static void fill_black(const hbil_plan *plan, int index, extreme_frame *out)
{
    truth_corner(plan, index, out);
    frames_fill(frames_input(plan, out, "albedo"), 0);
}

/* They have no second bounce. */
static int expect_black(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *ao = truth_output(plan, outputs, "ao"), *all = truth_output(plan, outputs, "multi_bounce");
    int p;
    (void)index, (void)f;
    for (p = 0; p < ao->width * ao->height; ++p)
        if (fabsf(all->data[all->channels * p] - ao->data[p]) > 1e-5f)
            return snprintf(why, size, "pixel (%d, %d): ao %g, with bounces %g", p % ao->width, p / ao->width, (double)ao->data[p],
                            (double)all->data[all->channels * p]), 0;
    return 1;
}

/* Under a sky brighter than any light may be, normals that are across the view and most slices. */
static void fill_across_the_view(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p, k;
    (void)index;
    wall(plan, out);
    for (p = 0; p < TEXELS; ++p) {
        const double a = 6.2831853 * (double)frames_random((uint32_t)p, 3);
        set_normal(plan, out, p, cos(a), sin(a), 0.02);
    }
    memset(out->frame.far_sh, 0, sizeof out->frame.far_sh);
    for (k = 0; k < 3; ++k) out->frame.far_sh[0][k] = 1e7f;
}

/* --------------------------------------------------------------------------------------------------------------------- filters */

/* One pixel of a wall is turned aside, for many frames. */
static void fill_turned(const hbil_plan *plan, int index, extreme_frame *out)
{
    wall(plan, out);
    set_normal(plan, out, HEIGHT / 2 * WIDTH + 24, 0.2, 0, 0.98);
    out->frame.reset = index == 0;
    out->frame.index = (uint32_t)index;
}

/* The filter goes on however long the history is: what is left of the difference. */
static int expect_turned(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const int p = HEIGHT / 2 * WIDTH + 24;
    const double left = of(truth_output(plan, outputs, "bent"), p, 0) / (0.2 * 2 / 3);
    (void)f;
    return index < 39 || (left > 0.4 && left < 0.6) || fail(why, size, "bent.x / that of its normal", p, left, 0.4, 0.6);
}

/* Normals that turn steadily from column to column. Index 1: normals of their own for each block of 4 x 4. */
static void fill_turning_wall(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    wall(plan, out);
    for (p = 0; p < TEXELS; ++p) {
        const int x = p % WIDTH, block = x / 4 + 99 * (p / WIDTH / 4);
        const double a = index ? 0.4 * ((double)frames_random((uint32_t)block, 5) - 0.5) : 0.02 * (x - 24);
        set_normal(plan, out, p, sin(a), 0, cos(a));
    }
}

/* Index 0: so does the bent vector; the grid takes the first pixel of the middle. Index 1: the corners have those of their own block. */
static int expect_turning_wall(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *bent = truth_output(plan, outputs, "bent");
    const float *n = f->inputs[hbil_plan_texture(plan, "normal")].data;
    int p;
    for (p = 0; p < TEXELS; ++p) {
        const int x = p % WIDTH, y = p / WIDTH, corner = (x == 0 || x == WIDTH - 1) && (y == 0 || y == HEIGHT - 1);
        const double right = 2.0 / 3 * (index ? (double)n[3 * p] : sin(0.02 * (x - 0.5 - 24))), room = index ? 2e-3 : 6e-3;
        if (index ? !corner : x < 4 || x >= WIDTH - 4) continue;
        if (fabs(of(bent, p, 0) - right) > room) return fail(why, size, "bent.x", p, of(bent, p, 0), right - room, right + room);
    }
    return 1;
}

/* A bright corner; then pixels alone in the sky, which the coarser grid does not see, without light. */
static void fill_alone(const hbil_plan *plan, int index, extreme_frame *out)
{
    int p;
    if (index == 0) {
        truth_corner(plan, 0, out);
        return;
    }
    begin(plan, out, 60);
    for (p = 0; p < TEXELS; ++p)
        if (p % WIDTH % 4 == 0 && p / WIDTH % 4 == 0) put(plan, out, p % WIDTH, p / WIDTH, 3);
    truth_light(plan, out, 0);
}

/* A bright corner; then a wall beside a column of sky, without light. Its normal, a code on the octahedral map of k / 32767, is at right
 * angles to the view of that sky, and in floats exactly so in some of the frames. */
static void fill_edge_on(const hbil_plan *plan, int index, extreme_frame *out)
{
    enum { SIDE = 32, HOLE = 27 };
    const double o = (5000 + 397 * index) / 32767.0, ray = 1 / o - 1, n[3] = { o, 0, 1 - o };
    camera c = { SIDE, SIDE, 0, 0.1, 1e6, 1, { 0, 0 }, 0 };
    int x, y;
    if (index == 0) {
        truth_corner(plan, 0, out);
        return;
    }
    c.fov = 2 * 57.295779513082321 * atan(ray * (SIDE / 2) / (HOLE + 0.5 - SIDE / 2));
    frames_begin(plan, out, &c, 0);
    for (y = 0; y < SIDE; ++y)
        for (x = 0; x < SIDE; ++x)
            if (x != HOLE) frames_put(plan, out, x, y, 3, n);
    truth_light(plan, out, 0);
    out->frame.reset = 1;
}

/* The sky has no light of the frame before to give. */
static int expect_dark(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    return index == 0 || truth_within(plan, f, outputs, "near", 0, 0, why, size);
}

/* --------------------------------------------------------------------------------------------------------------------- history */

/* A corner that is lit in the first frame only. */
static void fill_lit_once(const hbil_plan *plan, int index, extreme_frame *out)
{
    truth_corner(plan, 0, out);
    truth_light(plan, out, index == 0);
    out->frame.reset = index == 0;
}

/* Held to what the frame sees, nothing of it is left. */
static int expect_off(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    return index == 0 || truth_within(plan, f, outputs, "near", 0, 1e-4, why, size);
}

/* One that is dark in the first frame only. */
static void fill_lit_later(const hbil_plan *plan, int index, extreme_frame *out)
{
    truth_corner(plan, 0, out);
    truth_light(plan, out, index > 0);
    out->frame.reset = index == 0;
}

/* Where nothing else is done to it, history is a mean over all frames up to 4, then each frame counts a quarter. */
static int expect_mean(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    static float second[TEXELS];
    const image *near = truth_output(plan, outputs, "near");
    double dark = 1;
    int p, k, n = 0;
    (void)f;
    for (k = 1; k <= index; ++k) dark *= 1 - 1.0 / (k < 3 ? k + 1 : 4);
    for (p = 0; p < TEXELS && index > 0; ++p) {
        if (index == 1) second[p] = near->data[4 * p];
        if (second[p] < 0.03f) continue;
        ++n;
        if (fabs(of(near, p, 0) / (double)second[p] - 2 * (1 - dark)) > 0.01)
            return fail(why, size, "near / that of frame 1", p, of(near, p, 0) / (double)second[p], 2 * (1 - dark) - 0.01, 2 * (1 - dark) + 0.01);
    }
    return index == 0 || n > 200 || snprintf(why, size, "%d pixels are lit", n) < 0;
}

/* The eye goes to the left: what was seen half a pixel beside the border is not there any more. */
static void fill_leftwards(const hbil_plan *plan, int index, extreme_frame *out)
{
    const double step = -0.03;
    camera c = { WIDTH, HEIGHT, 60, 0.1, 1e6, 1, { 0, 0 }, 0 };
    c.eye_x = step * index;
    frames_room_by(plan, out, &c, index);
    truth_light(plan, out, 1);
    out->frame.last_view[12] = (float)(step - c.eye_x);
}

/* ---------------------------------------------------------------------------------------------------------------------- inputs */

/* A corner as bright as can be, and amplified: beyond what half floats hold. */
static void fill_blinding(const hbil_plan *plan, int index, extreme_frame *out)
{
    truth_corner(plan, index, out);
    truth_light(plan, out, 60000);
}

static int expect_blinding(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    (void)index;
    return truth_within(plan, f, outputs, "near", 0, 60100, why, size);
}

/* Walls of any turn that nothing hides: spherical harmonics of a hemisphere. */
static void fill_open_wall(const hbil_plan *plan, int index, extreme_frame *out)
{
    const plane q = { { index ? 0.6 : 0, index ? 0.3 : 0, index ? 0.74 : 1 }, -3, { 0, 0, 0 }, { 0, 0, 0 } };
    begin(plan, out, 60);
    frames_planes(plan, out, &q, 1);
}

static int expect_hemisphere(const hbil_plan *plan, int index, const extreme_frame *f, const image *outputs, char *why, size_t size)
{
    const image *sh = truth_output(plan, outputs, "sh");
    const float *n = f->inputs[hbil_plan_texture(plan, "normal")].data;
    int p, k;
    (void)index;
    for (p = 0; p < TEXELS; ++p)
        for (k = 0; k < 4; ++k) { /* Y00 Y1-1 Y10 Y11: 1, y, z, x */
            const double right = k == 0 ? 1.7725 : 1.5350 * (double)n[3 * p + k % 3], at = of(sh, k * TEXELS + p, 3);
            if (fabs(at - right) > 0.1) return fail(why, size, "visibility of sh", p, at, right - 0.1, right + 0.1);
        }
    return 1;
}

/* --------------------------------------------------------------------------------------------------------------------- the table */

#define BUMPS(config) { "truth_bumps_give_no_more_than_they_hide", config, 3, fill_bumps, expect_at_most_one, 0 }, \
    { "truth_bumps_give_no_more_than_they_hide", config, 6, fill_sparse_bumps, NULL, 0 }
#define LOW_WALL(config) { "truth_a_low_wall_hides", config, 1, fill_low_wall, expect_low_wall, 0 }

const extreme_case extreme_scenes[] = {
    { "truth_the_first_sample_without_jitter", "outputs=ao exponent=3 slices=1 steps=4", 1, fill_unjittered, NULL, 0 },
    { "truth_walls_see_each_other_behind_the_eye", "outputs=ao reach=50 slices=8 steps=32 noise=none", 1, fill_corridor, expect_corridor, 0 },
    { "truth_what_is_overhead_hides", "outputs=ao reach=1.5 falloff=0.1 slices=8 steps=32 noise=none", 1, fill_overhead, expect_overhead, 0 },
    { "truth_bars_of_a_pixel_are_no_surface", "outputs=ao sampling=bilinear slices=4 steps=16 noise=none", 1, fill_fence, expect_fence, 0 },
    { "truth_steps_are_spent_within_reach", "outputs=ao reach=0.6 falloff=0.1 slices=8 steps=2 exponent=1 noise=none", 1, truth_corner,
      expect_near_foot, 0 },
    BUMPS("outputs=ao+near slices=2"),
    BUMPS("outputs=ao+near slices=2 estimator=bitmask"),
    BUMPS("outputs=ao+near march=sweep slices=2"),
    { "truth_the_sky_hides_nothing", "outputs=ao march=both estimator=bitmask occluder=thick reach=4 slices=4", 1, fill_plain, expect_plain, 0 },
    { "truth_a_post_hides", "outputs=ao march=both estimator=bitmask occluder=thick reach=1e-6 slices=8", 1, fill_post, expect_post, 0 },
    LOW_WALL("outputs=ao march=both estimator=bitmask occluder=thick reach=0.1 slices=8"),
    LOW_WALL("outputs=ao march=sweep slices=8"),
    { "truth_what_stands_behind_a_gap_gives_light", "outputs=ao+near march=both estimator=bitmask occluder=thick reach=0.1 slices=8", 1,
      fill_behind_gap, expect_behind_gap, 0 },
    { "truth_the_filter_goes_on", "outputs=ao+bent temporal=yes filter=3x3 history=63 reach=1e-6 noise=none slices=8 steps=1", 40, fill_turned,
      expect_turned, 0 },
    { "truth_between_the_grid_is_between", "outputs=ao+bent downscale=4 reach=1e-6 noise=none slices=8 steps=1", 2, fill_turning_wall,
      expect_turning_wall, 0 },
    { "truth_the_sky_has_no_light_to_give", "outputs=ao+near downscale=4 slices=2", 2, fill_alone, expect_dark, 0 },
    { "truth_the_sky_has_no_light_to_give", "outputs=ao+near filter=5x5 filter_passes=2 slices=2", 24, fill_edge_on, expect_dark, 0 },
    { "truth_history_is_a_mean", "outputs=ao+near temporal=yes rectify=none history=4 reproject=camera noise=none slices=2", 8, fill_lit_later,
      expect_mean, 0 },
    { "truth_light_goes_out", "outputs=ao+near temporal=yes rectify=range reproject=camera noise=none slices=2", 2, fill_lit_once, expect_off, 0 },
    { "truth_light_goes_out", "outputs=ao+near temporal=yes rectify=variance reproject=camera noise=none slices=2", 2, fill_lit_once, expect_off, 0 },
    { "truth_white_to_the_left", "outputs=ao+near temporal=yes rectify=none reproject=camera slices=2", 4, fill_leftwards, truth_white, 0 },
    { "truth_beyond_half_floats", "outputs=ao+near storage=half filter=3x3 near_intensity=100 slices=2", 1, fill_blinding, expect_blinding, 0 },
    { "truth_sh_of_a_hemisphere", "outputs=ao+sh slices=8 steps=4 noise=none", 2, fill_open_wall, expect_hemisphere, 0 },
    { "truth_holes_light_nobody_above", "outputs=ao+near sampling=bilinear slices=8 steps=32", 1, fill_holes, expect_holes, 0 },
    { "truth_behind_a_gap_the_nearest_shines", "outputs=ao+near sampling=bilinear slices=8 steps=3", 1, fill_comb, expect_comb, 0 },
    { "truth_poles_hide_little", "outputs=ao occluder=heuristic decay=0.5 slices=8 steps=16", 1, fill_pole, expect_pole, 0 },
    { "truth_thick_walls_fade_as_solid_ones",
      "outputs=ao estimator=bitmask occluder=thick thickness=100 reach=2 falloff=1 slices=8 steps=32", 1, fill_battlements, expect_battlements, 0 },
    { "truth_black_surfaces_bounce_nothing", "outputs=ao+multi_bounce slices=2", 1, fill_black, expect_black, 0 },
    { "truth_far_light_is_no_brighter_edge_on",
      "outputs=ao+far estimator=bitmask environment=sh far_visibility=free_bits filter=3x3 slices=1 steps=1", 1, fill_across_the_view, NULL, 0 },
};
const int extreme_scene_count = (int)(sizeof extreme_scenes / sizeof *extreme_scenes);
