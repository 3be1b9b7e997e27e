/* check.c - frames 0 and 1 of the built-in scene of examples/blender/export_frame.py, held against the scene's own
 * numbers: positions from depth and camera, normals, motion, light; and what hbil-frame made of them.
 *
 *   blender_check FOLDER ...     each holds frame-000.exr camera-000.json frame-001.exr camera-001.json; and ao.exr
 *                                of frame 0, if it should be checked
 *
 * Exit code 1: something is wrong, and said so. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../../examples/frame/capture.h"
#include "../../examples/frame/metric.h"

#define PI 3.14159265358979323846
#define COUNT(a) (sizeof(a) / sizeof *(a))
#define NEAR_ENOUGH 2e-3 /* m: a sphere of 96 x 48 faces lies up to 0.5 (1 - cos(pi / 48)) = 1.1e-3 within its own */

enum { FLOOR, BACK, LEFT, PANEL, TALL, LOW, SLIDER, BALL, MARBLE, THINGS };

static const char *const names[THINGS] = {"floor", "back", "left", "panel", "tall", "low", "slider", "ball", "marble"};
static const struct { double base[2], sides[3], turn; } boxes[] = {
    {{1.1, -1.2}, {.9, .9, 1.9}, 18}, {{2.6, -.9}, {1.2, .8, .6}, -12}, {{1.0, -3.3}, {.7, .7, .7}, 30},
};
static const struct { double centre[3], radius; } balls[] = {{{2.5, -2.2, .5}, .5}, {{3.6, -1.6, .3}, .3}};
static const double slide = .06; /* m along x, per frame */

static int faults;

static void check(int ok, const char *what, double value)
{
    printf("%s  %s: %.6g\n", ok ? "ok  " : "FAIL", what, value);
    faults += !ok;
}

/* ---- geometry ---------------------------------------------------------------------------------------------------- */

/* m: column-major. Rotate into (inverse: out of) view space. */
static void turn(const float m[16], const double v[3], int inverse, double out[3])
{
    int i;

    for (i = 0; i < 3; i++)
        out[i] = inverse ? (double)m[4 * i] * v[0] + (double)m[4 * i + 1] * v[1] + (double)m[4 * i + 2] * v[2]
                         : (double)m[i] * v[0] + (double)m[4 + i] * v[1] + (double)m[8 + i] * v[2];
}

/* The world position that a pixel's depth stands for. */
static void position(const capture *cap, int x, int y, double out[3])
{
    const float  *p = cap->projection;
    const double  z = -(double)cap->depth.data[y * cap->width + x], w = (double)p[11] * z + (double)p[15];
    const double  ndc[2] = {2 * (x + .5) / cap->width - 1, 2 * (y + .5) / cap->height - 1};
    const double  at[3] = {(ndc[0] * w - (double)p[8] * z - (double)p[12]) / (double)p[0] - (double)cap->view[12],
                           (ndc[1] * w - (double)p[9] * z - (double)p[13]) / (double)p[5] - (double)cap->view[13],
                           z - (double)cap->view[14]};

    turn(cap->view, at, 1, out);
}

/* Where a camera sees a world position, in pixels from the upper left corner. */
static void project(const capture *cap, const double at[3], double out[2])
{
    const float *p = cap->projection;
    double       v[3], w;
    int          i;

    turn(cap->view, at, 0, v);
    for (i = 0; i < 3; i++) v[i] += (double)cap->view[12 + i];
    w = (double)p[11] * v[2] + (double)p[15];
    out[0] = .5 * cap->width * (((double)p[0] * v[0] + (double)p[8] * v[2] + (double)p[12]) / w + 1);
    out[1] = .5 * cap->height * (((double)p[5] * v[1] + (double)p[9] * v[2] + (double)p[13]) / w + 1);
}

/* On a box of the scene, and of the normal of that side? */
static int on_box(int index, int frame, const double at[3], const double normal[3])
{
    const double angle = boxes[index].turn * PI / 180, c = cos(angle), s = sin(angle);
    const double x = at[0] - boxes[index].base[0] - (index + TALL == SLIDER ? slide * frame : 0);
    const double y = at[1] - boxes[index].base[1];
    const double local[3] = {c * x + s * y, c * y - s * x, at[2] - .5 * boxes[index].sides[2]};
    const double facing[3] = {c * normal[0] + s * normal[1], c * normal[1] - s * normal[0], normal[2]};
    int          i, inside = 1, side = 0;

    for (i = 0; i < 3; i++) {
        const double beyond = fabs(local[i]) - .5 * boxes[index].sides[i];

        inside = inside && beyond < NEAR_ENOUGH;
        side = side || (beyond > -NEAR_ENOUGH && facing[i] * (local[i] > 0 ? 1 : -1) > .9999);
    }
    return inside && side;
}

/* What the pixel shows, judged by position and normal together; THINGS: nothing of the scene. */
static int identify(int frame, const double at[3], const double normal[3])
{
    size_t i;
    int    k;

    for (i = 0; i < COUNT(balls); i++) {
        double d[3], distance = 0, cosine = 0;

        for (k = 0; k < 3; k++) {
            d[k] = at[k] - balls[i].centre[k];
            distance += d[k] * d[k];
            cosine += d[k] * normal[k];
        }
        distance = sqrt(distance);
        if (fabs(distance - balls[i].radius) < NEAR_ENOUGH && cosine / distance > .9995) return BALL + (int)i;
    }
    for (i = 0; i < COUNT(boxes); i++)
        if (on_box((int)i, frame, at, normal)) return TALL + (int)i;
    if (fabs(at[2]) < NEAR_ENOUGH && normal[2] > .9999) return FLOOR;
    if (fabs(at[0]) < NEAR_ENOUGH && normal[0] > .9999) return LEFT;
    if (fabs(at[1] + .02) < NEAR_ENOUGH && normal[1] < -.9999) return PANEL;
    if (fabs(at[1]) < NEAR_ENOUGH && normal[1] < -.9999) return BACK;
    return THINGS;
}

/* ---- light ------------------------------------------------------------------------------------------------------- */

/* E/pi of the panel at a floor point, per unit of its radiance: Lambert's sum over its edges. */
static double panel_light(const double at[3])
{
    static const double corners[4][3] = {{3.2, -.02, 1.1}, {4.6, -.02, 1.1}, {4.6, -.02, 1.8}, {3.2, -.02, 1.8}};
    double              ray[4][3], sum = 0;
    int                 i, k;

    for (i = 0; i < 4; i++) {
        double length = 0;
        for (k = 0; k < 3; k++) {
            ray[i][k] = corners[i][k] - at[k];
            length += ray[i][k] * ray[i][k];
        }
        for (k = 0; k < 3; k++) ray[i][k] /= sqrt(length);
    }
    for (i = 0; i < 4; i++) {
        const double *a = ray[i], *b = ray[(i + 1) % 4];
        const double  cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
        const double  sine = sqrt(cross[0] * cross[0] + cross[1] * cross[1] + cross[2] * cross[2]);

        sum += asin(sine < 1 ? sine : 1) * cross[2] / sine;
    }
    return fabs(sum) / (2 * PI);
}

/* A piece of floor that sun and panel light wholly: E of the sun 3 W/m2 times the cosine, radiance of the panel
 * 6, 4.2, 2.4. */
static void check_light(const capture *cap)
{
    static const double panel[3] = {6, 4.2, 2.4}, white[3] = {.75, .75, .72};
    const double        sun = 3 * .9 / sqrt(.5 * .5 + .3 * .3 + .9 * .9) / PI;
    double              at[3], got[3] = {0, 0, 0}, want[3] = {0, 0, 0};
    int                 x, y, c, count = 0;

    for (y = 0; y < cap->height; y++) {
        for (x = 0; x < cap->width; x++) {
            position(cap, x, y, at);
            if (fabs(at[2]) > NEAR_ENOUGH || fabs(at[0] - 4.3) > .2 || fabs(at[1] + 1.2) > .2) continue;
            for (c = 0; c < 3; c++) {
                got[c] += (double)cap->direct.data[3 * (y * cap->width + x) + c];
                want[c] += white[c] * (sun + panel[c] * panel_light(at));
            }
            count++;
        }
    }
    check(count > 30, "pixels of open floor", count);
    for (c = 0; c < 3; c++)
        check(fabs(got[c] / want[c] - 1) < .02, "direct light there, by that of sun and panel", got[c] / want[c]);
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* Surfaces, normals, emission of the panel; with `last` motion. Some pixels at borders are means of two surfaces. */
static void check_frame(const capture *cap, const capture *last, int frame)
{
    const int few = cap->width * cap->height / 500;
    int    seen[THINGS + 1] = {0}, x, y, sky = 0, dark = 0, off = 0, moved = 0, k;
    double at[3], normal[3], before[2], worst = 0;

    for (y = 0; y < cap->height; y++) {
        for (x = 0; x < cap->width; x++) {
            const int    p = y * cap->width + x;
            const double in_view[3] = {(double)cap->normal.data[3 * p], (double)cap->normal.data[3 * p + 1],
                                       (double)cap->normal.data[3 * p + 2]};
            int what;

            if (cap->depth.data[p] >= 1e9f) {
                sky++;
                continue;
            }
            position(cap, x, y, at);
            turn(cap->view, in_view, 1, normal);
            what = identify(frame, at, normal);
            seen[what]++;
            dark += (what == PANEL) != (fabsf(cap->emission.data[3 * p] - 6) < 1e-4f);
            if (!last || what == THINGS) continue;
            if (what == SLIDER) at[0] -= slide;
            project(last, at, before);
            before[0] -= x + .5 + (double)cap->motion.data[2 * p];
            before[1] -= y + .5 + (double)cap->motion.data[2 * p + 1];
            if (hypot(before[0], before[1]) > .01) off++;
            else if (hypot(before[0], before[1]) > worst) worst = hypot(before[0], before[1]);
            moved += hypot((double)cap->motion.data[2 * p], (double)cap->motion.data[2 * p + 1]) > .1;
        }
    }
    for (k = 0; k < THINGS; k++) check(seen[k] > 40, names[k], seen[k]);
    check(sky > 400 && sky * 2 < cap->width * cap->height, "sky", sky);
    check(seen[THINGS] < few, "pixels that are on no surface of the scene, or of another normal", seen[THINGS]);
    check(dark < few, "pixels with emission elsewhere than on the panel, or none there", dark);
    if (!last) return;
    check(off < few, "pixels whose motion is not that of their surface", off);
    check(moved * 2 > cap->width * cap->height, "pixels that move", moved);
    printf("      the others: within %.2g pixels\n", worst);
}

/* Means of a and b over the 8 x 8 pixels from (x, y). 0: some of them are sky, or glow, and have no truth. */
static int block(const capture *cap, const image *ao, int x, int y, double *a, double *b)
{
    int i, j;

    *a = *b = 0;
    for (j = y; j < y + 8; j++) {
        for (i = x; i < x + 8; i++) {
            const size_t p = (size_t)(j * cap->width + i);

            if (!metric_counts(cap, p)) return 0;
            *a += (double)ao->data[p] / 64;
            *b += (double)cap->truth_ao.data[p] / 64;
        }
    }
    return 1;
}

/* hbil-frame's ambient occlusion against Cycles' own, in blocks, as that one is noisy. */
static void check_occlusion(const char *path, const capture *cap)
{
    image_layer layer = {"ao", "Y", {0, 0, 0, NULL, 0}, 1};
    char        error[1024];
    double      sum[5] = {0, 0, 0, 0, 0}, least = 1, most = 0, count = 0, a, b, mean, correlation;
    int         x, y;

    if (!exr_read(path, &layer, 1, error, sizeof error)) {
        puts(error);
        faults++;
        return;
    }
    for (y = 0; y + 8 <= cap->height; y += 8) {
        for (x = 0; x + 8 <= cap->width; x += 8) {
            if (!block(cap, &layer.pixels, x, y, &a, &b)) continue;
            sum[0] += a, sum[1] += b, sum[2] += a * a, sum[3] += b * b, sum[4] += a * b, count++;
            if (a < least) least = a;
            if (a > most) most = a;
        }
    }
    image_free(&layer.pixels);
    mean = (sum[0] - sum[1]) / count;
    correlation = (count * sum[4] - sum[0] * sum[1])
                / sqrt((count * sum[2] - sum[0] * sum[0]) * (count * sum[3] - sum[1] * sum[1]));
    check(least > 0 && least < .35, "least ao of a block", least);
    check(most > .9 && most <= 1, "greatest", most);
    check(mean > -.02 && mean < .15, "mean, less Cycles', which sees what is off the screen, too", mean);
    check(correlation > .9, "correlation with Cycles'", correlation);
}

static int load(capture *cap, const char *folder, int frame)
{
    char exr[1024], json[1024], error[1024];

    snprintf(exr, sizeof exr, "%s/frame-%03d.exr", folder, frame);
    snprintf(json, sizeof json, "%s/camera-%03d.json", folder, frame);
    if (capture_load(cap, exr, json, error, sizeof error)) return 1;
    puts(error);
    faults++;
    return 0;
}

int main(int argc, char **argv)
{
    capture cap[2];
    char    ao[1024];
    int     i;

    for (i = 1; i < argc; i++) {
        if (!load(&cap[0], argv[i], 0) || !load(&cap[1], argv[i], 1)) return 1;
        printf("%s: %dx%d, %s\n", argv[i], cap[0].width, cap[0].height,
               cap[0].orthographic ? "orthographic" : "perspective");
        check_frame(&cap[0], NULL, 0);
        check_frame(&cap[1], &cap[0], 1);
        check_light(&cap[0]);
        snprintf(ao, sizeof ao, "%s/ao.exr", argv[i]);
        if (access(ao, F_OK) == 0) check_occlusion(ao, &cap[0]);
        capture_free(&cap[0]);
        capture_free(&cap[1]);
    }
    return faults > 0 || argc < 2;
}
