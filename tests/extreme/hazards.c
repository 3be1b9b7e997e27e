/* hazards.c - scenes whose truth is known: flat walls see all of their sky, a pixel alone is open, a pit is dark. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "frames.h"
#include "hazards.h"

#define PI 3.14159265358979323846

/* ------------------------------------------------------------------------------------------------ what is expected */

static const image *output(const hbil_plan *plan, const image outputs[HBIL_MAX_TEXTURES], const char *name)
{
    const int32_t t = hbil_plan_texture(plan, name);
    return t < 0 || plan->textures[t].life != HBIL_LIFE_OUTPUT ? NULL : &outputs[t];
}

/* Surface pixels of an output's channel 0, `margin` pixels from the border, lie in [low, high]. */
static int within(const hbil_plan *plan, const extreme_frame *f, const image outputs[HBIL_MAX_TEXTURES], const char *name, int margin,
                  double low, double high, char *why, size_t size)
{
    const image *img = output(plan, outputs, name), *depth = &f->inputs[hbil_plan_texture(plan, "depth")];
    int x, y;
    if (!img) return 1;
    for (y = margin; y < img->height - margin; ++y)
        for (x = margin; x < img->width - margin; ++x) {
            const double v = (double)img->data[(y * img->width + x) * img->channels];
            if (v >= low && v <= high) continue;
            snprintf(why, size, "%s at (%d, %d), depth %g: %.7g is not in [%g, %g]", name, x, y,
                     (double)depth->data[y * img->width + x], v, low, high);
            return 0;
        }
    return 1;
}

#define EXPECT(name) int name(const hbil_plan *plan, int index, const extreme_frame *f, const image outputs[HBIL_MAX_TEXTURES], char *why, size_t size)
#define FILL(name) void name(const hbil_plan *plan, int index, extreme_frame *out)

EXPECT(expect_open)
{
    (void)index;
    return within(plan, f, outputs, "ao", 0, 0.999, 1, why, size) && within(plan, f, outputs, "near", 0, 0, 1e-3, why, size)
           && within(plan, f, outputs, "specular_occlusion", 0, 0.995, 1, why, size);
}

/* Of half floats the rounding shows, of a pull of 8e-4 little. */
EXPECT(expect_nearly_open) { (void)index; return within(plan, f, outputs, "ao", 0, 0.98, 1, why, size); }

/* The wall is half of the normal's hemisphere but for the cosine: (1 + n.m) / 2 = 0.75, n.m = cos 60 degrees. Not where the normal
 * faces away from the eye, since it is turned there. In perspective the wall ends with the screen, and 64 pixels are few of 170 degrees. */
EXPECT(expect_corner)
{
    const int ortho = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    const double off = ortho ? 0.01 : 0.08;
    double sum = 0, count = 0;
    const image *ao = output(plan, outputs, "ao"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    int x, y;
    (void)index;
    for (y = 8; y < ao->height - 8; ++y)
        for (x = 8; x < ao->width - 8; ++x) {
            const float *n = &normal->data[3 * (y * ao->width + x)];
            const double v = (double)ao->data[y * ao->width + x];
            double ray[2] = { 0, 0 };
            if (!ortho) frames_ray(plan, &f->frame, x + 0.5, y + 0.5, ray);
            if ((double)n[2] - ray[0] * (double)n[0] - ray[1] * (double)n[1] < 0.1 * sqrt(ray[0] * ray[0] + ray[1] * ray[1] + 1)) continue;
            if (fabs(v - 0.75) > off) return snprintf(why, size, "ao at (%d, %d) is %.7g, not 0.75", x, y, v), 0;
            sum += v, ++count;
        }
    if (count > 0 && fabs(sum / count - 0.75) > 0.02) return snprintf(why, size, "ao is %.7g in the mean, not 0.75", sum / count), 0;
    return 1;
}

/* radiance 1: near + ao = 1, to the rounding of the last bits of sums of steps. */
EXPECT(expect_near_and_ao_to_be_1)
{
    const image *ao = output(plan, outputs, "ao"), *near = output(plan, outputs, "near");
    const image *depth = &f->inputs[hbil_plan_texture(plan, "depth")];
    int p;
    (void)index;
    for (p = 0; p < ao->width * ao->height; ++p) {
        const double sum = (double)ao->data[p] + (double)near->data[p * 4];
        if (!(depth->data[p] > 0) || fabs(sum - 1) <= 2e-5) continue;
        return snprintf(why, size, "near + ao at (%d, %d) is %.8g", p % ao->width, p / ao->width, sum), 0;
    }
    return 1;
}

EXPECT(expect_no_light)
{
    (void)index;
    return within(plan, f, outputs, "near", 0, 0, 0, why, size) && within(plan, f, outputs, "sh", 0, 0, 0, why, size);
}

/* ao is the same seen in a mirror. */
EXPECT(expect_symmetry)
{
    const image *ao = output(plan, outputs, "ao");
    int x, y;
    (void)index, (void)f;
    for (y = 0; y < ao->height; ++y)
        for (x = 0; x < ao->width / 2; ++x) {
            const double a = (double)ao->data[y * ao->width + x], b = (double)ao->data[y * ao->width + ao->width - 1 - x];
            if (fabs(a - b) > 1e-4) return snprintf(why, size, "ao at (%d, %d) is %.7g, in the mirror %.7g", x, y, a, b), 0;
        }
    return 1;
}

/* ------------------------------------------------------------------------------------------------------ flat walls */

enum { WIDTH = 64, HEIGHT = 40 };

static camera usual(const hbil_plan *plan)
{
    const camera c = { WIDTH, HEIGHT, plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC ? 5 : 60, 0.1, 1000, 1, { 0, 0 }, 0 };
    return c;
}

/* A wall through (0, 0, -z), turned by `tilt` degrees about an axis of the screen at `axis` degrees. */
static void wall(const hbil_plan *plan, extreme_frame *out, double tilt, double axis, double z)
{
    const double t = tilt * PI / 180, a = axis * PI / 180;
    const plane p = { { sin(t) * cos(a), sin(t) * sin(a), cos(t) }, -z * cos(t), { 0, 0, 0 }, { 0, 0, 0 } };
    frames_planes(plan, out, &p, 1);
}

FILL(fill_tilted_walls)
{
    static const double tilts[] = { 0, 30, 60, 75, 85 };
    const camera c = usual(plan);
    frames_begin(plan, out, &c, index);
    wall(plan, out, tilts[index % 5], 37.0 * index, 3);
    frames_fill(frames_input(plan, out, "radiance"), 1);
}

/* H8: as the formats round depth: 1 m, 20 m, 100 m, 200 m, 10,000 m. */
static const double distances[] = { 1, 20, 100, 200, 10000 };

static void far_wall(const hbil_plan *plan, int index, extreme_frame *out, double far_z)
{
    camera c = usual(plan);
    c.far_z = far_z;
    frames_begin(plan, out, &c, index);
    wall(plan, out, 40, 20, distances[index % 5]);
}

FILL(fill_depth_float) { far_wall(plan, index, out, 1e5); }

static void round_depth(const hbil_plan *plan, extreme_frame *out, double levels)
{
    image *depth = frames_input(plan, out, "depth");
    int p;
    for (p = 0; p < depth->width * depth->height; ++p) depth->data[p] = (float)(floor((double)depth->data[p] * levels + 0.5) / levels);
}

FILL(fill_depth_24_bits) { far_wall(plan, index, out, 1e5); round_depth(plan, out, 16777215.0); }
FILL(fill_depth_16_bits) { far_wall(plan, index, out, 1e5); round_depth(plan, out, 65535.0); }

FILL(fill_depth_half)
{
    image *depth;
    int p;
    far_wall(plan, index, out, 1e5);
    depth = frames_input(plan, out, "depth");
    for (p = 0; p < depth->width * depth->height; ++p) { /* 11 bits of mantissa */
        int e;
        const double m = frexp((double)depth->data[p], &e);
        depth->data[p] = (float)ldexp(floor(m * 2048 + 0.5) / 2048, e);
    }
}

FILL(fill_odd_wall) /* the view vector of the middle is exactly the normal */
{
    camera c = usual(plan);
    c.width = 33, c.height = 21;
    frames_begin(plan, out, &c, index);
    wall(plan, out, 0, 0, 2);
}

/* ------------------------------------------------------------------------------- shading normals that lean from it */

static void lean(const hbil_plan *plan, extreme_frame *out, double angle, double axis)
{
    image *normal = frames_input(plan, out, "normal");
    const double n[3] = { sin(angle) * cos(axis), sin(angle) * sin(axis), cos(angle) };
    int p, k;
    for (p = 0; p < normal->width * normal->height; ++p)
        for (k = 0; k < 3; ++k) normal->data[3 * p + k] = (float)n[k];
    (void)plan;
}

static void leaning(const hbil_plan *plan, int index, extreme_frame *out, const camera *c)
{
    frames_begin(plan, out, c, index);
    wall(plan, out, 0, 0, 2);
    lean(plan, out, PI / 3, 0.7 * index);
}

FILL(fill_leaning)
{
    camera c = usual(plan);
    if (plan->config.projection == HBIL_PROJECTION_PERSPECTIVE) c.fov = 170; /* a wall without end */
    leaning(plan, index, out, &c);
}

FILL(fill_wide_pixels) /* four times as wide as high, off the centre */
{
    camera c = usual(plan);
    c.fov = 150, c.stretch = 4, c.shift[0] = 0.3, c.shift[1] = -0.4;
    leaning(plan, index, out, &c);
}

/* H17: one slice a pixel; what a pixel's azimuth gets wrong, its neighbours make good: means of 8 x 8 pixels are all alike. */
EXPECT(expect_blue_noise)
{
    const image *ao = output(plan, outputs, "ao");
    double sum = 0, squares = 0, blocks = 0;
    int x, y, i, k, n = 0, m = 0;
    (void)index, (void)f;
    for (y = 8; y + 16 <= ao->height; y += 8)
        for (x = 8; x + 16 <= ao->width; x += 8, ++m) {
            double block = 0;
            for (i = 0; i < 8; ++i)
                for (k = 0; k < 8; ++k, ++n) {
                    const double v = (double)ao->data[(y + i) * ao->width + x + k];
                    block += v / 64;
                    sum += v, squares += v * v;
                }
            blocks += block * block;
        }
    sum /= n, squares = squares / n - sum * sum, blocks = blocks / m - sum * sum;
    if (squares > 1e-6 && blocks * 64 < HAZARD_BLUE * squares) return 1;
    return snprintf(why, size, "noise of variance %g leaves %g in means of 64 pixels, %g of what white noise does", squares, blocks,
                    blocks * 64 / squares), 0;
}

/* ------------------------------------------------------------------------------------------------- a pixel alone */

static const double alone[][3] = { { 0, 0, 1 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, -1 }, { 0.6, -0.8, 0 }, { -1, 0, 1e-3 }, { 0.7, 0.7, -0.14 } };

FILL(fill_alone)
{
    camera c = usual(plan);
    c.width = 33, c.height = 21;
    frames_begin(plan, out, &c, index);
    frames_put(plan, out, index % 2 ? 16 : 3 + index, index % 2 ? 10 : 19 - index, 2, alone[index % 7]);
    frames_put(plan, out, 32, 20, 2, alone[(index + 3) % 7]);
}

/* H12: two channels, longer together than 1. */
FILL(fill_two_channels)
{
    const double n[3] = { 90.0 / 127, index % 2 ? 90.0 / 127 : -90.0 / 127, 0 };
    camera c = usual(plan);
    frames_begin(plan, out, &c, index);
    frames_put(plan, out, 32, 20, 2, n);
}

/* The bent vector of an open pixel leans the way of its normal. */
EXPECT(expect_bent_along_normal)
{
    const image *bent = output(plan, outputs, "bent"), *normal = &f->inputs[hbil_plan_texture(plan, "normal")];
    const float *b = &bent->data[4 * (20 * bent->width + 32)], *n = &normal->data[3 * (20 * bent->width + 32)];
    const double along = (double)(b[0] * n[0] + b[1] * n[1]);
    (void)index;
    if (along > 0.5) return expect_open(plan, index, f, outputs, why, size);
    return snprintf(why, size, "bent vector (%g, %g, %g) of the normal (%g, %g)", (double)b[0], (double)b[1], (double)b[2], (double)n[0], (double)n[1]), 0;
}

/* ------------------------------------------------------------------------------------------------------ pits, ridges */

FILL(fill_pit)
{
    const double n[3] = { 0, 0, 1 };
    const camera c = usual(plan);
    int x, y;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) frames_put(plan, out, x, y, x % 9 == 4 && y % 9 == 4 ? 1000 : 1e-3 * (index + 1), n);
    frames_fill(frames_input(plan, out, "radiance"), 1);
}

EXPECT(expect_dark_pits)
{
    const image *ao = output(plan, outputs, "ao"), *cone = output(plan, outputs, "cone");
    int x, y;
    (void)index, (void)f;
    for (y = 4; y < HEIGHT; y += 9)
        for (x = 4; x < WIDTH; x += 9) {
            const int p = y * WIDTH + x;
            const float *a = cone ? &cone->data[4 * p] : NULL;
            if (!(ao->data[p] <= 0.02f)) return snprintf(why, size, "ao of the pit at (%d, %d) is %g", x, y, (double)ao->data[p]), 0;
            if (a && fabs((double)(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) - 1) > 1e-3)
                return snprintf(why, size, "cone of the pit at (%d, %d): (%g, %g, %g)", x, y, (double)a[0], (double)a[1], (double)a[2]), 0;
        }
    return 1;
}

FILL(fill_ridges) /* left and right alike, ridges on the border */
{
    const camera c = usual(plan);
    int x, y;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            const int m = x < WIDTH / 2 ? x : WIDTH - 1 - x;
            const double n[3] = { 0, 0, 1 };
            frames_put(plan, out, x, y, m == 0 ? 1.5 : m == 3 ? 2.6 : m == 9 + index ? 2.2 : m > 20 ? 3.3 : 3, n);
        }
}

FILL(fill_silhouettes) /* a pixel is a hundredth of a degree: neighbours at other depths are seen along v */
{
    camera c = usual(plan);
    int x, y;
    c.fov = 0.4;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            const double n[3] = { 0.3, -0.2, 0.9 };
            frames_put(plan, out, x, y, 1 + 40 * (double)frames_random((uint32_t)(x + 64 * index), (uint32_t)y), n);
        }
    frames_fill(frames_input(plan, out, "radiance"), 1);
}

FILL(fill_bowl) /* many small rises */
{
    const camera c = usual(plan);
    int x, y;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            const double u = (x - 31.5) / 32, v = (y - 19.5) / 32, n[3] = { -u, v, 1 };
            const double l = sqrt(u * u + v * v + 1), unit[3] = { n[0] / l, n[1] / l, n[2] / l };
            frames_put(plan, out, x, y, 3 - 0.8 * (u * u + v * v) + 1e-4 * (double)frames_random((uint32_t)x, (uint32_t)(y + index)), unit);
        }
    frames_fill(frames_input(plan, out, "radiance"), 1);
}

/* ---------------------------------------------------------------------------------------------------- sky and reach */

FILL(fill_floor_under_sky)
{
    const camera c = usual(plan);
    const plane floor_ = { { 0, 1, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } };
    frames_begin(plan, out, &c, index);
    frames_planes(plan, out, &floor_, 1);
    frames_fill(frames_input(plan, out, "radiance"), 1);
}

static hbil_config *dial(extreme_frame *out)
{
    out->frame.live = &out->live;
    return &out->live;
}

FILL(fill_reach_below_a_pixel)
{
    frames_room(plan, out, WIDTH, HEIGHT, index);
    dial(out)->reach = 1e-6f;
}

FILL(fill_reach_of_near_depths)
{
    static const float depths[] = { 1e-4f, 1e-7f, 1e-15f, 1e-8f };
    image *depth;
    int p;
    frames_room(plan, out, WIDTH, HEIGHT, index);
    depth = frames_input(plan, out, "depth");
    for (p = 0; p < depth->width * depth->height; ++p) depth->data[p] *= depths[index % 4];
    dial(out)->reach = index % 2 ? 1e9f : 1.0f;
}

FILL(fill_dials) /* every option that is dynamic at its ends */
{
    hbil_config *c = dial(out);
    const int high = index % 2;
    frames_room(plan, out, WIDTH, HEIGHT, index);
    c = dial(out);
    c->slices = high ? 8 : 1;
    c->steps = high ? 32 : 1;
    c->exponent = high ? 8 : 1;
    c->reach = index % 4 > 1 ? 1e9f : 1e-6f;
    c->falloff = high ? 1 : 0.01f;
    c->bias = high ? 0.5f : 1e-6f;
    c->pull = high ? 0.01f : 1e-8f;
    c->firefly = high ? 60000 : 0.001f;
    c->near_intensity = c->far_intensity = high ? 100 : 0.01f;
    c->ao_exponent = high ? 8 : 0.1f;
    c->sky_depth = high ? 1e15f : 1e-3f;
}

FILL(fill_most_samples)
{
    frames_room(plan, out, WIDTH, HEIGHT, index);
    dial(out)->slices = 64;
    dial(out)->steps = 128;
}

/* --------------------------------------------------------------------------------------------------------- feedback */

FILL(fill_white_room)
{
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    out->frame.index = (uint32_t)index;
    out->frame.reset = index == 0;
    frames_fill(frames_input(plan, out, "radiance"), 1);
    frames_fill(frames_input(plan, out, "albedo"), index % 2 ? 1.0f : 4.0f);
    frames_fill(frames_input(plan, out, "f0"), 0);
    frames_fill(frames_input(plan, out, "probes"), 0);
}

/* k (1 + 0.95 / k near) at most: k / (1 - 0.95). */
EXPECT(expect_light_to_die_out)
{
    (void)index;
    return within(plan, f, outputs, "near", 0, 0, (double)plan->config.near_intensity * 20 * 1.02, why, size);
}

FILL(fill_no_radiance) { frames_room(plan, out, WIDTH, HEIGHT, index); frames_fill(frames_input(plan, out, "radiance"), index % 2 ? NAN : -1); }

FILL(fill_mirrors)
{
    frames_room(plan, out, WIDTH, HEIGHT, index);
    frames_fill(frames_input(plan, out, "roughness"), index % 2 ? 0.0f : 1e-6f);
}

/* Everything is NaN or infinite in frame 2; after it the room is as it was. */
FILL(fill_poison)
{
    static const char *const names[] = { "depth", "normal", "radiance", "albedo", "f0", "motion", "direct", "roughness" };
    size_t i;
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    out->frame.index = (uint32_t)index;
    out->frame.reset = index == 0;
    if (index != 2 && index != 3) return;
    for (i = 0; i < sizeof names / sizeof *names; ++i) {
        image *img = frames_input(plan, out, names[i]);
        int p;
        if (i == 0 && index == 3) continue; /* depth is right, all else is not */
        for (p = 0; img && p < img->width * img->height * img->channels; ++p) img->data[p] = p % 3 == 0 ? NAN : p % 3 == 1 ? INFINITY : -INFINITY;
    }
}

/* Light of this room is below 1 * intensity, or 20 times that with all bounces: what is above comes from the poison. */
EXPECT(expect_no_trace)
{
    const double bounced = plan->config.bounces == HBIL_BOUNCES_RECURSIVE ? 20.4 : 1.02;
    if (index < 9) return 1;
    return within(plan, f, outputs, "near", 0, 0, (double)plan->config.near_intensity * bounced, why, size);
}

/* --------------------------------------------------------------------------------------------------------- far light */

FILL(fill_bright_sky)
{
    camera c = usual(plan);
    c.width = 33, c.height = 21;
    frames_begin(plan, out, &c, index);
    frames_put(plan, out, 16, 10, 2, alone[0]);
    frames_fill(frames_input(plan, out, "sky"), 30000);
}

EXPECT(expect_all_of_the_sky)
{
    const double v = (double)output(plan, outputs, "far")->data[4 * (10 * 33 + 16)];
    (void)index, (void)f;
    return v > 29900 && v < 30100 ? 1 : (snprintf(why, size, "far light of a sky of 30000: %g", v), 0);
}

/* --------------------------------------------------------------------------------------------------- cameras, sizes */

static void by_camera(const hbil_plan *plan, int index, extreme_frame *out, double fov, double near_z, double far_z)
{
    camera c = usual(plan);
    c.fov = fov, c.near_z = near_z, c.far_z = far_z;
    frames_room_by(plan, out, &c, index);
}

FILL(fill_fov_1) { by_camera(plan, index, out, 1, 0.1, 100); }
FILL(fill_fov_170) { by_camera(plan, index, out, 170, 0.1, 100); }
FILL(fill_fov_179_9) { by_camera(plan, index, out, 179.9, 0.1, 100); }
FILL(fill_near_1e_4_far_1e9) { by_camera(plan, index, out, 60, 1e-4, 1e9); }

FILL(fill_off_centre) /* V is parallel to Y but for 1e-4 */
{
    camera c = usual(plan);
    const double n[3] = { 0, 0, 1 };
    int x, y;
    c.shift[1] = index % 2 ? -5773 : 5773; /* of tan 30 degrees */
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) frames_put(plan, out, x, y, 3, n);
}

static void sized(const hbil_plan *plan, int index, extreme_frame *out, int width, int height) { frames_room(plan, out, width, height, index); }
FILL(fill_1x1) { sized(plan, index, out, 1, 1); }
FILL(fill_1x4096) { sized(plan, index, out, 1, 4096); }
FILL(fill_16384x1) { sized(plan, index, out, 16384, 1); }
FILL(fill_7680x4320) { sized(plan, index, out, 7680, 4320); }

FILL(fill_checkerboard)
{
    const camera c = usual(plan);
    int x, y;
    frames_begin(plan, out, &c, index);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) {
            const double n[3] = { 0, 0, 1 };
            if ((x + y + index) % 2) frames_put(plan, out, x, y, index % 3 == 0 ? 2 : index % 3 == 1 ? 1e-4 : 5e8, n);
            else if (index % 2) frames_put(plan, out, x, y, 7, n);
        }
}

FILL(fill_spikes)
{
    const double n[3] = { 0, 0, 1 };
    int x, y;
    frames_room(plan, out, WIDTH, HEIGHT, index);
    for (y = 2; y < HEIGHT; y += 5)
        for (x = 2; x < WIDTH; x += 5) frames_put(plan, out, x, y, (x + y + index) % 2 ? 0.2 : 500, n);
}

static void broken(extreme_frame *out, int index)
{
    hbil_frame *f = &out->frame;
    static const float numbers[] = { NAN, INFINITY, 0.0f, 1e-30f, 1e30f };
    f->projection[index % 2 ? 0 : 5] = numbers[index / 2 % 5];
}

FILL(fill_broken_projection) { frames_room(plan, out, WIDTH, HEIGHT, 0); broken(out, index); }

FILL(fill_broken_view)
{
    static const float numbers[] = { NAN, INFINITY, 1e30f, -INFINITY };
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    out->frame.view[index % 2 ? 12 : 14] = numbers[index / 2 % 4];
}

FILL(fill_broken_environment)
{
    frames_room(plan, out, WIDTH, HEIGHT, 0);
    out->frame.far_color[index % 3] = index % 2 ? NAN : INFINITY;
    out->frame.far_sh[index % 4][0] = index % 2 ? INFINITY : NAN;
    out->frame.probe_origin[0] = NAN;
}

FILL(fill_huge_environment) /* finite, and the sums are not */
{
    int i, k;
    frames_room(plan, out, WIDTH, HEIGHT, index);
    for (i = 0; i < 9; ++i)
        for (k = 0; k < 3; ++k) out->frame.far_sh[i][k] = (i + k + index) % 2 ? 3e38f : -3e38f;
    for (k = 0; k < 3; ++k) out->frame.far_color[k] = k == index % 3 ? 3e38f : -1e30f;
    out->frame.probe_origin[0] = 3e38f;
    out->frame.probe_step[1] = 2e-6f;
    out->frame.view[12] = 1e12f;
    out->frame.last_view[12] = -1e12f;
}
