/* test_sweep.c - the swept march (march=sweep, march=both) and the filter on a device: against the same march without a hull (sweep.h),
 * closed forms, and the height-field truth of the captures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../captures.h"
#include "analytic.h"
#include "brute_force.h"
#include "decimate.h"
#include "gpu.h"
#include "sweep.h"

#define SKY     1e9f  /* m: sky_depth of the default config and of captures */
#define FACING  0.001 /* normals are turned until n.V is no smaller */
#define SMALL   2e-3  /* |difference| of ao up to which shader and reference agree; of near plus that part of its value */
#define TIE     2e-6  /* sine: a horizon no farther from the bias counts or not, as a float rounds */
#define CONFIG  192   /* bytes of a config's text */

static const double k_pi = 3.14159265358979323846;

/* --- inputs and runs ---------------------------------------------------------------------------------------------- */

static const char *const k_scenes[] = {"cornell", "fence"};

/* The built-in scenes, then the first frame of every capture, every second pixel of every second row (HBIL_LONG=1: all); NULL when
 * there are no more. Free with capture_free. */
static const char *load(int index, capture *cap)
{
    static capture_names list;
    const int            scenes = sizeof k_scenes / sizeof *k_scenes;
    char                 error[512] = "";
    const char          *name;
    int                  loaded;
    if (!list.count) {
        list = captures_list();
    }
    if (index - scenes >= list.count) {
        return NULL;
    }
    name = index < scenes ? k_scenes[index] : list.name[index - scenes];
    loaded = index < scenes ? capture_scene(cap, name, 320, 180, 0, NULL, error, sizeof error)
                            : captures_load(name, 0, cap, error, sizeof error);
    if (!loaded) {
        fail_msg("%s", error);
    }
    assert_true(index < scenes || getenv("HBIL_LONG") || decimate(cap, 2));
    return name;
}

/* Whether the frame of an index is a capture, for messages: a built-in scene has the name of one. */
static const char *kind_of(int index)
{
    return index < (int)(sizeof k_scenes / sizeof *k_scenes) ? "built-in " : "";
}

static gpu_input make_input(const bf_camera *camera)
{
    gpu_input in;
    memset(&in, 0, sizeof in);
    in.frame = gpu_frame(camera);
    assert_true(image_make(&in.depth, camera->width, camera->height, 1));
    assert_true(image_make(&in.normal, camera->width, camera->height, 3));
    assert_true(image_make(&in.radiance, camera->width, camera->height, 3));
    return in;
}

static void free_input(gpu_input *in)
{
    image_free(&in->depth);
    image_free(&in->normal);
    image_free(&in->radiance);
}

static bf_camera centred_camera(int width, int height, double fov_y)
{
    const double pixel = 2.0 * tan(0.5 * fov_y) / height;
    bf_camera    c = {width, height, 0, {pixel, -pixel, -0.5 * width * pixel, 0.5 * height * pixel}};
    return c;
}

/* As it is without noise, unless the text says otherwise. */
static void run(const char *text, const gpu_input *in, gpu_output *out)
{
    hbil_diag   items[8];
    hbil_diags  diags = {items, 8, 0};
    hbil_config config;
    memset(&config, 0, sizeof config);
    config.noise = HBIL_NOISE_NONE;
    config.projection = in->frame.projection[11] == 0.0f ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    if (hbil_config_parse(&config, text, strlen(text), &diags) != HBIL_OK) {
        fail_msg("%s: %s", text, diags.count ? items[0].text : "?");
    }
    gpu_run(&config, in, out);
}

static double snorm16(double v)
{
    return floor(v * 32767.0 + 0.5) / 32767.0;
}

/* A unit normal as the passes keep it: octahedral, twice 16 bits. A pixel beside a slice stands above the tangent plane by little more or
 * less than the bias on every curved surface, and then counts or not: the last digits of a normal decide. */
static void store_normal(const float n[3], float out[3])
{
    const double size = fabs((double)n[0]) + fabs((double)n[1]) + fabs((double)n[2]), x = (double)n[0] / size, y = (double)n[1] / size;
    const int    faces = n[2] >= 0.0f; /* the camera: in the middle of the map */
    const double a = snorm16(faces ? x : copysign(1.0 - fabs(y), x)), b = snorm16(faces ? y : copysign(1.0 - fabs(x), y));
    const double z = 1.0 - fabs(a) - fabs(b), fold = fmax(-z, 0.0);
    const double v[3] = {a - copysign(fold, a), b - copysign(fold, b), z}, length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int k = 0; k < 3; ++k) {
        out[k] = (float)(v[k] / length);
    }
}

/* The surface that the input shows, with normals as the passes keep them, which are put into normal: free it. */
static bf_scene scene_of(const gpu_input *in, image *normal)
{
    bf_scene s = {bf_camera_from(in->frame.projection, (int)in->frame.width, (int)in->frame.height), in->depth.data, (double)SKY, NULL,
                  in->radiance.data, NULL, NULL};
    assert_true(image_make(normal, s.camera.width, s.camera.height, 3));
    for (int i = 0; i < s.camera.width * s.camera.height; ++i) {
        if (in->depth.data[i] < SKY) {
            store_normal(in->normal.data + 3 * i, normal->data + 3 * i);
        }
    }
    s.normal = normal->data;
    return s;
}

/* --- against the reference ---------------------------------------------------------------------------------------- */

/* counted: pixels with a surface. off: those that differ by more than SMALL. worst: largest |difference|; of near less its tolerated
 * part. at: the pixel that is worst beyond its tolerance. */
typedef struct verdict {
    long   counted, off[2];
    double worst[2], beyond;
    int    at;
} verdict;

/* |Difference| of ao, and of near light less its tolerated part. */
static void differ(const gpu_output *gpu, int pixel, const sweep_pixel *cpu, double *ao, double *near)
{
    *ao = fabs((double)gpu->ao.data[pixel] - cpu->ao);
    *near = 0.0;
    for (int c = 0; c < 3; ++c) {
        const double value = (double)gpu->near.data[4 * pixel + c];
        assert_true(value - value == 0.0);
        *near = fmax(*near, fabs(value - cpu->near[c]) - SMALL * cpu->near[c]);
    }
}

static void judge(const gpu_output *gpu, int pixel, const sweep_pixel *cpu, verdict *v)
{
    double ao, near;
    if (cpu->sky) {
        assert_true(gpu->ao.data[pixel] == 1.0f && gpu->near.data[4 * pixel] == 0.0f);
        return;
    }
    differ(gpu, pixel, cpu, &ao, &near);
    ++v->counted;
    v->off[0] += !(ao <= SMALL);
    v->off[1] += !(near <= SMALL);
    v->worst[0] = fmax(v->worst[0], ao);
    v->worst[1] = fmax(v->worst[1], near);
    if (fmax(ao, near) > v->beyond) {
        v->beyond = fmax(ao, near);
        v->at = pixel;
    }
}

/* All that the reference knows of a pixel, for a failure. */
static void print_pixel(const sweep *s, const gpu_output *gpu, int pixel)
{
    static sweep_side sides[SWEEP_MAX_SLICES][2];
    const int         x = pixel % s->scene->camera.width, y = pixel / s->scene->camera.width;
    sweep_pixel       cpu;
    sweep_at(s, x, y, &cpu, sides);
    print_message("    pixel %d %d, depth %g: ao %.5f, reference %.5f; near %.5f %.5f %.5f, reference %.5f %.5f %.5f\n", x, y,
                  (double)s->scene->depth[pixel], (double)gpu->ao.data[pixel], cpu.ao, (double)gpu->near.data[4 * pixel],
                  (double)gpu->near.data[4 * pixel + 1], (double)gpu->near.data[4 * pixel + 2], cpu.near[0], cpu.near[1], cpu.near[2]);
    for (int i = 0; i < 2 * s->options.slices; ++i) {
        const sweep_side *a = &sides[i / 2][i % 2];
        print_message("      slice %d %s: horizon %d steps away, c %.6f, tangent plane %.6f, elevation %.6f, weight %.6f, light %.4f %.4f "
                      "%.4f\n", i / 2, i % 2 ? "back" : "front", a->reach, a->c, a->c0, a->elevation, a->weight, a->light[0], a->light[1],
                      a->light[2]);
    }
}

static int within(const verdict *v, double share)
{
    return (double)v->off[0] <= share * (double)v->counted && (double)v->off[1] <= share * (double)v->counted;
}

/* Where the shader differs, and a horizon lies so close to the bias that rounding decides whether it counts: what the reference finds
 * with the bias on the other side of it. */
static void resolve_tie(const sweep *s, const gpu_output *gpu, int pixel, sweep_pixel *cpu)
{
    sweep       tie = *s;
    sweep_pixel other;
    double      ao, near;
    for (int k = -1; k <= 1 && !cpu->sky; k += 2) {
        tie.options.bias = s->options.bias + k * TIE;
        sweep_at(&tie, pixel % s->scene->camera.width, pixel / s->scene->camera.width, &other, NULL);
        differ(gpu, pixel, &other, &ao, &near);
        if (ao <= SMALL && near <= SMALL) {
            *cpu = other;
            return;
        }
    }
}

/* Runs shader and reference on one frame, on every step-th pixel of every step-th row. The shares may be off; if it is more, the worst
 * pixel is told. */
static verdict meet(const gpu_input *in, int slices, int stride, int step, double share)
{
    const sweep_options options = {slices, stride, 0.5, 1e-5, 1e-3};
    image               normal;
    const bf_scene      scene = scene_of(in, &normal);
    const bf_grid       grid = bf_grid_of(scene.camera.width, scene.camera.height, 0, step);
    sweep_pixel        *cpu = malloc((size_t)(grid.columns * grid.rows) * sizeof *cpu);
    verdict             v = {0};
    gpu_output          gpu;
    sweep               s;
    char                text[CONFIG];
    assert_non_null(cpu);
    assert_true(sweep_open(&s, &options, &scene));
    snprintf(text, sizeof text, "outputs=ao+near march=sweep slices=%d sweep_stride=%d", slices, stride);
    run(text, in, &gpu);
    sweep_run(&s, grid, cpu);
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        const int at = i / grid.columns * step * scene.camera.width + i % grid.columns * step;
        double    ao, near;
        differ(&gpu, at, &cpu[i], &ao, &near);
        if (!(ao <= SMALL && near <= SMALL)) {
            resolve_tie(&s, &gpu, at, &cpu[i]);
        }
        judge(&gpu, at, &cpu[i], &v);
    }
    if (!within(&v, share)) {
        print_pixel(&s, &gpu, v.at);
    }
    sweep_close(&s);
    gpu_free(&gpu);
    image_free(&normal);
    free(cpu);
    return v;
}

static void shader_equals_cpu_sweep(void **state)
{
    static const int counts[][2] = {{4, 1}, {8, 1}, {2, 3}, {4, 3}};
    capture          cap;
    const char      *name;
    int              failed = 0;
    (void)state;
    for (int i = 0; (name = load(i, &cap)) != NULL; ++i) {
        const gpu_input in = gpu_input_of(&cap);
        for (int k = 0; k < 4; ++k) {
            const verdict v = meet(&in, counts[k][0], counts[k][1], cap.width > 320 ? 2 : 1, 1e-4); /* time */
            print_message("%s%s, slices %d, stride %d: of %ld pixels %.4f %% have another ao (largest %.1e), %.4f %% another near (%.1e)\n",
                          kind_of(i), name, counts[k][0], counts[k][1], v.counted, 100.0 * (double)v.off[0] / (double)v.counted, v.worst[0],
                          100.0 * (double)v.off[1] / (double)v.counted, v.worst[1]);
            failed += !within(&v, 1e-4);
        }
        capture_free(&cap);
    }
    assert_int_equal(failed, 0);
}

/* --- odd and tiny sizes ------------------------------------------------------------------------------------------- */

static double random_unit(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216.0;
}

/* Blocks and slopes in front of each other, an eighth sky; normals of all directions that can be seen, and some that can not. */
static gpu_input rough_input(const bf_camera *camera, uint32_t seed)
{
    gpu_input in = make_input(camera);
    for (int i = 0; i < camera->width * camera->height; ++i) {
        const int    x = i % camera->width, y = i / camera->width;
        const double block = 0.7 * ((x / 3 * 7 + y / 4 * 5) % 6), slope = 0.02 * x + 0.05 * y;
        double       n[3], length = 0.0;
        in.depth.data[i] = random_unit(&seed) < 0.125 ? SKY : (float)(2.0 + block + slope + 0.05 * random_unit(&seed));
        for (int k = 0; k < 3; ++k) {
            n[k] = 2.0 * random_unit(&seed) - 1.0 + (k == 2 ? 0.7 : 0.0);
            length += n[k] * n[k];
        }
        for (int k = 0; k < 3; ++k) {
            in.normal.data[3 * i + k] = (float)(n[k] / sqrt(length));
            in.radiance.data[3 * i + k] = (float)(2.0 * random_unit(&seed));
        }
    }
    return in;
}

static void odd_and_tiny_sizes(void **state)
{
    static const int sizes[][2] = {{1, 1}, {3, 5}, {17, 9}, {64, 1}, {1, 33}, {33, 57}};
    double           worst[2] = {0.0, 0.0};
    int              failed = 0;
    (void)state;
    for (int i = 0; i < 24; ++i) {
        const int *size = sizes[i / 4], stride = i % 2 ? 3 : 1;
        bf_camera  camera = centred_camera(size[0], size[1], 1.0);
        if (i % 4 > 1) {
            camera.orthographic = 1;
            for (int k = 0; k < 4; ++k) {
                camera.ray[k] *= 4.0;
            }
        }
        gpu_input     in = rough_input(&camera, (uint32_t)i + 1u);
        const verdict v = meet(&in, 4, stride, 1, 0.0);
        if (!within(&v, 0.0)) {
            print_message("    of %d x %d, stride %d%s: %ld and %ld of %ld pixels\n", size[0], size[1], stride,
                          camera.orthographic ? ", orthographic" : "", v.off[0], v.off[1], v.counted);
            ++failed;
        }
        worst[0] = fmax(worst[0], v.worst[0]);
        worst[1] = fmax(worst[1], v.worst[1]);
        free_input(&in);
    }
    print_message("6 odd sizes, both projections, stride 1 and 3: ao within %.1e of the reference, near within %.1e + %g of it\n", worst[0],
                  worst[1], SMALL);
    assert_int_equal(failed, 0);
}

/* --- furnace ------------------------------------------------------------------------------------------------------ */

/* Largest |near + ao - 1| of the pixels with a surface. */
static double furnace_error(const gpu_input *in, const char *text)
{
    gpu_output out;
    double     worst = 0.0;
    run(text, in, &out);
    for (int i = 0; i < in->depth.width * in->depth.height; ++i) {
        for (int c = 0; c < 3 && in->depth.data[i] < SKY; ++c) {
            const double error = fabs((double)out.ao.data[i] + (double)out.near.data[4 * i + c] - 1.0);
            worst = error <= worst ? worst : error; /* keeps NaN */
        }
    }
    gpu_free(&out);
    return worst;
}

static const char *const k_sweeps[] = {"march=sweep slices=1", "march=sweep slices=2", "march=sweep slices=3", "march=sweep slices=4",
    "march=sweep slices=8", "march=sweep slices=2 sweep_stride=2", "march=sweep slices=4 sweep_stride=3",
    "march=sweep slices=2 sweep_stride=5", "march=both estimator=bitmask occluder=height_field slices=2 reach=1",
    "march=both estimator=bitmask occluder=thick slices=3 reach=.3",
    "march=both estimator=bitmask occluder=thick slices=4 sweep_stride=3 reach=2"};
static const char *const k_filters[] = {"", " filter=3x3", " filter=5x5"};
enum { SWEEPS = sizeof k_sweeps / sizeof *k_sweeps };

static void furnace_is_white(void **state)
{
    capture     cap;
    const char *name;
    double      worst = 0.0;
    int         failed = 0;
    (void)state;
    for (int i = 0; (name = load(i, &cap)) != NULL; ++i) {
        gpu_input in = gpu_input_of(&cap);
        assert_true(image_make(&in.radiance, cap.width, cap.height, 3));
        for (int k = 0; k < 3 * cap.width * cap.height; ++k) {
            in.radiance.data[k] = 1.0f;
        }
        for (int k = 0; k < 3 * SWEEPS; ++k) {
            char text[CONFIG];
            if (i > 0 && k / SWEEPS != (k + i) % 3) {
                continue; /* all on the first frame, in turn on the others: time */
            }
            snprintf(text, sizeof text, "outputs=ao+near %s%s", k_sweeps[k % SWEEPS], k_filters[k / SWEEPS]);
            const double error = furnace_error(&in, text);
            if (!(error <= 1e-3)) {
                print_message("    furnace, %s%s, %s: near + ao is off by %.1e\n", kind_of(i), name, text, error);
                ++failed;
            }
            worst = error <= worst ? worst : error;
        }
        image_free(&in.radiance);
        capture_free(&cap);
    }
    print_message("furnace: near + ao is 1 within %.1e\n", worst);
    assert_int_equal(failed, 0);
}

/* --- open planes and corners -------------------------------------------------------------------------------------- */

static gpu_input wedge_input(const wedge *w, const bf_camera *camera)
{
    const float grey[2] = {1.0f, 1.0f};
    gpu_input   in = make_input(camera);
    wedge_render(w, camera, SKY, grey, in.depth.data, in.normal.data, in.radiance.data);
    return in;
}

/* Cosine between a plane's normal and the direction from pixel i to the camera. */
static double facing(const bf_camera *camera, const double normal[3], int i)
{
    double p[3];
    bf_point(camera, i % camera->width + 0.5, i / camera->width + 0.5, 1.0, p);
    return -(normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2]) / sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

/* worst[0]: of all pixels that face the camera by more than the angle to which the shader turns normals; [1]: of the others. */
static void check_open_plane(const char *text, double fov, double tilt, double azimuth, double worst[2])
{
    const bf_camera camera = centred_camera(160, 90, fov);
    const double    point[3] = {0.0, 0.0, -5.0}, normal[3] = {sin(tilt) * cos(azimuth), sin(tilt) * sin(azimuth), cos(tilt)};
    const wedge     w = wedge_plane(point, normal);
    gpu_input       in = wedge_input(&w, &camera);
    gpu_output      out;
    run(text, &in, &out);
    for (int i = 0; i < camera.width * camera.height; ++i) {
        const double error = fabs((double)out.ao.data[i] - 1.0);
        double      *kind = &worst[facing(&camera, normal, i) > FACING ? 0 : 1];
        if (in.depth.data[i] < SKY) {
            *kind = error <= *kind ? *kind : error;
        }
    }
    gpu_free(&out);
    free_input(&in);
}

static void open_planes_are_open(void **state)
{
    static const char *const texts[] = {"outputs=ao march=sweep", "outputs=ao march=sweep slices=4 sweep_stride=3 filter=3x3"};
    static const int         fovs[] = {60, 90, 120}, tilts[] = {0, 20, 40, 60, 75, 85};
    (void)state;
    for (int t = 0; t < 2; ++t) {
        double worst[2] = {0.0, 0.0};
        for (int i = 0; i < 90; ++i) {
            check_open_plane(texts[t], fovs[i / 30] * k_pi / 180.0, tilts[i % 30 / 5] * k_pi / 180.0, i % 5 * 72.0 * k_pi / 180.0, worst);
        }
        print_message("open plane, %s: ao is 1 within %.1e (where n.v < %g and the normal is turned: %.1e)\n", texts[t], worst[0], FACING,
                      worst[1]);
        assert_true(worst[0] <= 2e-3);
    }
}

#define BLOCK 4 /* pixels: directions of a stride of 4 are spread evenly over such a block */

/* Error of ao at the image centre and in the four corners. mean: of the blocks there, the largest |mean|; centre: that of the block at
 * the centre; single: the largest error of one pixel. */
typedef struct corner_error { double mean, centre, single; } corner_error;

static void check_block(const wedge *w, const bf_camera *camera, const gpu_input *in, const image *ao, int x0, int y0, corner_error *worst)
{
    double sum = 0.0;
    int    count = 0;
    for (int i = 0; i < BLOCK * BLOCK; ++i) {
        const int x = x0 + i % BLOCK, y = y0 + i / BLOCK, pixel = y * camera->width + x;
        int       plane;
        wedge_depth(w, camera, x + 0.5, y + 0.5, &plane);
        if (in->depth.data[pixel] < SKY && facing(camera, w->n[plane], pixel) > FACING) {
            const double error = (double)ao->data[pixel] - wedge_visible(w, camera, x, y, plane);
            worst->single = fabs(error) <= worst->single ? worst->single : fabs(error);
            sum += error;
            ++count;
        }
    }
    if (count == BLOCK * BLOCK) {
        worst->mean = fabs(sum) / count <= worst->mean ? worst->mean : fabs(sum) / count;
    }
}

static void check_corner(const char *text, const wedge *w, const bf_camera *camera, corner_error *worst)
{
    const int    right = camera->width - BLOCK, bottom = camera->height - BLOCK;
    gpu_input    in = wedge_input(w, camera);
    corner_error centre = {0.0, 0.0, 0.0};
    gpu_output   out;
    run(text, &in, &out);
    check_block(w, camera, &in, &out.ao, right / 2, bottom / 2, &centre);
    worst->centre = fmax(worst->centre, centre.mean);
    worst->mean = fmax(worst->mean, centre.mean);
    worst->single = fmax(worst->single, centre.single);
    for (int i = 0; i < 4; ++i) {
        check_block(w, camera, &in, &out.ao, (i & 1) ? right : 0, (i >> 1) ? bottom : 0, worst);
    }
    gpu_free(&out);
    free_input(&in);
}

/* Three poses of an edge that passes beside the image centre and the corners of the image. */
static void check_opening(const char *text, int opening_degrees, int fov_degrees, corner_error *worst)
{
    const double    fov = fov_degrees * k_pi / 180.0, opening = opening_degrees * k_pi / 180.0, beside = 0.3 * tan(0.5 * fov);
    const bf_camera camera = centred_camera(240, 135, fov);
    for (int pose = 0; pose < 3; ++pose) {
        const double angle = (5.0 + 55.0 * pose) * k_pi / 180.0;
        const double point[3] = {-4.0 * beside * sin(angle), 4.0 * beside * cos(angle), -4.0};
        const double along[3] = {cos(angle), sin(angle), 0.0};
        const wedge  w = wedge_make(point, along, opening, (pose - 1) * 0.15 * fmin(opening, 2.0 * k_pi - opening));
        check_corner(text, &w, &camera, worst);
    }
}

static void corners_have_their_exact_visibility(void **state)
{
    static const char *const texts[] = {"outputs=ao march=sweep slices=32", "outputs=ao march=sweep slices=32 sweep_stride=4"};
    static const int         openings[] = {50, 90, 130, 240}, fovs[] = {60, 90, 120};
    /* a stride of 4 takes pixels up to two beside the slice, and next to the border most lines end at once: measured, with room */
    static const double      limits[] = {0.01, 0.08};
    (void)state;
    for (int t = 0; t < 2; ++t) {
        corner_error all = {0.0, 0.0, 0.0};
        for (int i = 0; i < 12; ++i) {
            corner_error one = {0.0, 0.0, 0.0};
            check_opening(texts[t], openings[i / 3], fovs[i % 3], &one);
            print_message("corner of %3d degrees, fov %3d, %s: ao off by %.4f (centre %.4f, one pixel %.4f)\n", openings[i / 3],
                          fovs[i % 3], texts[t], one.mean, one.centre, one.single);
            all.centre = fmax(all.centre, one.centre);
            all.mean = fmax(all.mean, one.mean);
            all.single = fmax(all.single, one.single);
        }
        print_message("corners, %s: ao off by %.4f (centre %.4f, one pixel %.4f) at most\n", texts[t], all.mean, all.centre, all.single);
        assert_true(all.mean <= limits[t]);
    }
}

/* --- the height-field truth of captures --------------------------------------------------------------------------- */

enum { TRUTHS = 3 };

static capture truths[TRUTHS];

/* Loads the three captures that have the truth of their height field; 0: not all are there. */
static int load_truths(void)
{
    static const char *const names[TRUTHS] = {"cornell", "atrium", "terrain"};
    char                     error[512] = "";
    for (int i = 0; i < TRUTHS; ++i) {
        if (!captures_has(names[i], 0)) {
            print_message("HBIL_CAPTURES has no %s: left out\n", names[i]);
            return 0;
        }
        if (!truths[i].depth.data && !captures_load(names[i], 0, &truths[i], error, sizeof error)) {
            fail_msg("%s", error);
        }
        if (!truths[i].hf_ao.data) {
            print_message("%s has no height-field truth: left out\n", names[i]);
            return 0;
        }
    }
    return 1;
}

/* Means over the three captures. near: parts of its mean. */
typedef struct errors { double ao_rmse, ao_bias, near_mae, near_bias; } errors;

static void add_errors(const capture *cap, const image *ao, const image *near, errors *sum)
{
    double count = 0.0, square = 0.0, bias = 0.0, size = 0.0, signed_sum = 0.0, truth = 0.0;
    for (int i = 0; i < cap->width * cap->height; ++i) {
        if (!(cap->hf_valid.data[i] > 0.5f)) {
            continue;
        }
        const double off = (double)ao->data[i] - (double)cap->hf_ao.data[i];
        count += 1.0;
        square += off * off;
        bias += off;
        for (int c = 0; near && c < 3; ++c) {
            const double near_off = (double)near->data[4 * i + c] - (double)cap->hf_near.data[3 * i + c];
            size += fabs(near_off);
            signed_sum += near_off;
            truth += (double)cap->hf_near.data[3 * i + c];
        }
    }
    sum->ao_rmse += sqrt(square / count) / TRUTHS;
    sum->ao_bias += bias / count / TRUTHS;
    sum->near_mae += near ? size / truth / TRUTHS : 0.0;
    sum->near_bias += near ? signed_sum / truth / TRUTHS : 0.0;
}

static errors errors_of(const char *text)
{
    errors sum = {0.0, 0.0, 0.0, 0.0};
    for (int i = 0; i < TRUTHS; ++i) {
        const gpu_input in = gpu_input_of(&truths[i]);
        gpu_output      out;
        run(text, &in, &out);
        add_errors(&truths[i], &out.ao, &out.near, &sum);
        gpu_free(&out);
    }
    print_message("%s: ao rmse %.4f, mean %+.4f; near mae %.3f, mean %+.1f %%\n", text, sum.ao_rmse, sum.ao_bias, sum.near_mae,
                  100.0 * sum.near_bias);
    return sum;
}

static void captures_meet_the_goal(void **state)
{
    (void)state;
    if (!load_truths()) {
        skip();
    }
    const errors four = errors_of("outputs=ao+near march=sweep slices=4"), eight = errors_of("outputs=ao+near march=sweep slices=8");
    assert_true(four.ao_rmse <= 0.060 && four.near_mae <= 0.33);
    assert_true(eight.ao_rmse <= 0.035 && eight.near_mae <= 0.25);
    assert_true(fabs(eight.ao_bias) <= 0.005 && fabs(eight.near_bias) <= 0.05);
}

static void filter_halves_the_slices(void **state)
{
    (void)state;
    if (!load_truths()) {
        skip();
    }
    const errors two = errors_of("outputs=ao+near march=sweep slices=2 sweep_stride=3 filter=3x3");
    const errors four = errors_of("outputs=ao+near march=sweep slices=4");
    assert_true(two.ao_rmse <= four.ao_rmse && two.near_mae <= four.near_mae);
}

static void frames_turn_the_directions(void **state)
{
    static const char text[] = "outputs=ao march=sweep slices=4 noise=hilbert_r2";
    enum { FRAMES = 8 };
    errors one = {0.0, 0.0, 0.0, 0.0}, all = {0.0, 0.0, 0.0, 0.0};
    double turned = 0.0;
    (void)state;
    if (!load_truths()) {
        skip();
    }
    for (int i = 0; i < TRUTHS; ++i) {
        const int  pixels = truths[i].width * truths[i].height;
        gpu_input  in = gpu_input_of(&truths[i]);
        gpu_output first, more;
        image      mean;
        double     apart = 0.0;
        assert_true(image_make(&mean, truths[i].width, truths[i].height, 1));
        run(text, &in, &first);
        for (int frame = 0; frame < FRAMES; ++frame) {
            in.frame.index = (uint32_t)frame;
            run(text, &in, &more);
            for (int k = 0; k < pixels; ++k) {
                mean.data[k] += more.ao.data[k] / (float)FRAMES;
                apart += frame == 1 ? fabs((double)more.ao.data[k] - (double)first.ao.data[k]) / pixels : 0.0;
                assert_true(frame > 0 || more.ao.data[k] == first.ao.data[k]); /* the same frame again is the same image */
            }
            add_errors(&truths[i], &more.ao, NULL, &one);
            gpu_free(&more);
        }
        add_errors(&truths[i], &mean, NULL, &all);
        turned = fmax(turned, apart);
        assert_true(apart > 1e-3);
        gpu_free(&first);
        image_free(&mean);
    }
    print_message("4 slices, frames 0 and 1: mean |difference| of ao up to %.4f; ao rmse of one frame %.4f, of the mean of %d %.4f\n",
                  turned, one.ao_rmse / FRAMES, FRAMES, all.ao_rmse);
    assert_true(all.ao_rmse < one.ao_rmse / FRAMES);
}

/* --- a hull that overflows ---------------------------------------------------------------------------------------- */

#define WIDE 960 /* pixels */
#define HIGH 640

/* A sphere of 620 pixels, half sunk in a tilted plane: on a line over it every pixel is a vertex of the hull. */
static void sphere_at(const bf_camera *camera, int i, double *depth, double normal[3], int *is_sphere)
{
    static const double centre[3] = {0.0, 0.0, -5.0}, plane[3] = {0.0, 0.5, 0.8660254037844386};
    const double        radius = 1.0;
    double              d[3], a, b, c, root;
    bf_point(camera, i % camera->width + 0.5, i / camera->width + 0.5, 1.0, d);
    a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    b = d[0] * centre[0] + d[1] * centre[1] + d[2] * centre[2];
    c = centre[0] * centre[0] + centre[1] * centre[1] + centre[2] * centre[2] - radius * radius;
    root = b * b - a * c;
    *depth = (plane[0] * centre[0] + plane[1] * centre[1] + plane[2] * centre[2]) / (plane[0] * d[0] + plane[1] * d[1] + plane[2] * d[2]);
    *is_sphere = root > 0.0 && (b - sqrt(root)) / a < *depth;
    *depth = *is_sphere ? (b - sqrt(root)) / a : *depth;
    for (int k = 0; k < 3; ++k) {
        normal[k] = *is_sphere ? (d[k] * *depth - centre[k]) / radius : plane[k];
    }
}

static void full_hull_stays_close(void **state)
{
    const double    pixel = 2.0 * tan(asin(1.0 / 5.0)) / 620.0; /* the sphere is 620 pixels wide */
    const bf_camera camera = {WIDE, HIGH, 0, {pixel, -pixel, -0.5 * WIDE * pixel, 0.5 * HIGH * pixel}};
    gpu_input       in = make_input(&camera);
    long            sphere = 0;
    (void)state;
    for (int i = 0; i < WIDE * HIGH; ++i) {
        double depth, normal[3];
        int    is_sphere;
        sphere_at(&camera, i, &depth, normal, &is_sphere);
        in.depth.data[i] = depth > 0.0 ? (float)depth : SKY;
        for (int k = 0; k < 3; ++k) {
            in.normal.data[3 * i + k] = (float)normal[k];
            in.radiance.data[3 * i + k] = (float)(0.6 + 0.4 * sin(i % WIDE * 0.01 * (k + 1)) * cos(i / WIDE * 0.013));
        }
        sphere += is_sphere;
    }
    assert_true((double)sphere > 0.5 * 0.785 * 620.0 * 620.0);
    const verdict v = meet(&in, 4, 1, 3, 1e-3);
    print_message("sphere over a plane, hundreds of vertices: of %ld pixels %.2f %% have another ao (largest %.1e), %.2f %% another near "
                  "(%.1e)\n", v.counted, 100.0 * (double)v.off[0] / (double)v.counted, v.worst[0],
                  100.0 * (double)v.off[1] / (double)v.counted, v.worst[1]);
    assert_true(within(&v, 1e-3));
    free_input(&in);
}

/* --- march=both --------------------------------------------------------------------------------------------------- */

/* Mean |difference| of ao between the sweep alone and samples up to a reach; *bias the mean difference. */
static double apart(const gpu_input *in, const image *sweeps, const char *reach, double *bias)
{
    double     count = 0.0, sum = 0.0;
    char       text[CONFIG];
    gpu_output both;
    snprintf(text, sizeof text, "outputs=ao march=both estimator=bitmask occluder=height_field steps=64 slices=4 reach=%s",
             reach);
    run(text, in, &both);
    *bias = 0.0;
    for (int i = 0; i < in->depth.width * in->depth.height; ++i) {
        if (in->depth.data[i] < SKY) {
            const double off = (double)both.ao.data[i] - (double)sweeps->data[i];
            count += 1.0;
            sum += fabs(off);
            *bias += off;
        }
    }
    gpu_free(&both);
    *bias /= count;
    return sum / count;
}

static void both_converges_to_the_sweep(void **state)
{
    static const char *const reaches[] = {"1e-6", ".03", ".3", "1"};
    capture                  cap;
    const char              *name;
    int                      failed = 0;
    (void)state;
    for (int i = 0; (name = load(i, &cap)) != NULL; ++i) {
        const gpu_input in = gpu_input_of(&cap);
        gpu_output      sweeps;
        run("outputs=ao march=sweep slices=4", &in, &sweeps);
        print_message("%s%s, samples up to a reach and the sweep beyond, against the sweep alone: ao", kind_of(i), name);
        for (int k = 0; k < 4; ++k) {
            double       bias;
            const double size = apart(&in, &sweeps.ao, reaches[k], &bias);
            print_message(" %s m: %.4f (mean %+.4f)", reaches[k], size, bias);
            failed += k == 0 && !(size <= 0.01);
        }
        print_message("\n");
        gpu_free(&sweeps);
        capture_free(&cap);
    }
    assert_int_equal(failed, 0);
}

static int tear_down(void **state)
{
    for (int i = 0; i < TRUTHS; ++i) {
        capture_free(&truths[i]);
    }
    return gpu_close(state);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shader_equals_cpu_sweep),
        cmocka_unit_test(odd_and_tiny_sizes),
        cmocka_unit_test(furnace_is_white),
        cmocka_unit_test(open_planes_are_open),
        cmocka_unit_test(corners_have_their_exact_visibility),
        cmocka_unit_test(captures_meet_the_goal),
        cmocka_unit_test(filter_halves_the_slices),
        cmocka_unit_test(full_hull_stays_close),
        cmocka_unit_test(both_converges_to_the_sweep),
        cmocka_unit_test(frames_turn_the_directions),
    };
    return cmocka_run_group_tests_name("numeric_sweep", tests, gpu_open, tear_down);
}
