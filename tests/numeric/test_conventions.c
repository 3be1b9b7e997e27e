/* test_conventions.c - one scene through every depth, projection, normal and view convention: the same image on a device. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../../examples/frame/capture.h"
#include "analytic.h"
#include "gpu.h"

#define WIDTH  96
#define HEIGHT 54
#define PIXELS (WIDTH * HEIGHT)
#define SKY    1e10f /* m, linear depth of a pixel without a surface */
#define NEAR_Z 1.0   /* m; the scene lies between 1.5 m and 10 m, so that float device depth is exact to about 1e-6 of it */
#define FAR_Z  12.0  /* m */
#define TOLERANCE 1e-4

typedef enum camera_kind { SYMMETRIC, OFF_CENTRE, ORTHOGRAPHIC } camera_kind;
/* Right-handed view; left-handed view of the same world; left-handed view of the mirrored world (its z negated). */
typedef enum handedness { RIGHT, LEFT, LEFT_WORLD, HANDEDNESSES } handedness;

static const char *const k_cameras[] = {"symmetric", "off-centre and jittered", "orthographic"};

/* World to view, column-major: a rotation that mixes all axes. */
static const float k_view[16] = {0.8f, 0.36f, -0.48f, 0.0f, 0.0f, 0.8f, 0.6f, 0.0f, 0.6f, -0.48f, 0.64f, 0.0f, 0.3f, -2.0f, 5.0f, 1.0f};

/* Linear depth, view normals (right-handed), radiance. */
typedef struct fixture { bf_camera camera; image depth, normal, radiance; } fixture;

static bf_camera make_camera(camera_kind kind)
{
    const double pixel = (kind == ORTHOGRAPHIC ? 4.0 : 1.4) / HEIGHT;
    const double shift_x = kind == OFF_CENTRE ? 0.2 * WIDTH + 0.37 : 0.0, shift_y = kind == OFF_CENTRE ? -0.15 * HEIGHT + 0.21 : 0.0;
    bf_camera    c = {WIDTH, HEIGHT, kind == ORTHOGRAPHIC, {pixel, -pixel, 0.0, 0.0}};
    c.ray[2] = -(0.5 * WIDTH + shift_x) * pixel;
    c.ray[3] = (0.5 * HEIGHT + shift_y) * pixel;
    return c;
}

/* A room's corner, with a window to the sky. The edge runs through no pixel centre: there a normal rebuilt from depth may be either
 * plane's, by rounding. */
static void make_fixture(fixture *f, camera_kind kind)
{
    const double point[3] = {0.4137, 0.2291, -7.0}, along[3] = {0.6216099682706644, 0.7833269096274834, 0.0};
    const float  grey[2] = {0.3f, 1.0f};
    const wedge  w = wedge_make(point, along, 1.9, 0.2);
    f->camera = make_camera(kind);
    assert_true(image_make(&f->depth, WIDTH, HEIGHT, 1) && image_make(&f->normal, WIDTH, HEIGHT, 3)
                && image_make(&f->radiance, WIDTH, HEIGHT, 3));
    wedge_render(&w, &f->camera, SKY, grey, f->depth.data, f->normal.data, f->radiance.data);
    for (int i = 0; i < PIXELS; ++i) {
        assert_true(f->depth.data[i] > 1.5f && f->depth.data[i] < 10.0f);
        for (int c = 0; c < 3; ++c) {
            f->radiance.data[3 * i + c] *= 0.4f + 0.1f * (float)c + 0.5f * (float)(i % WIDTH) / WIDTH;
        }
    }
    for (int i = 0; i < 60; ++i) {
        f->depth.data[(8 + i / 10) * WIDTH + 20 + i % 10] = SKY;
    }
}

static void free_fixture(fixture *f)
{
    image_free(&f->depth);
    image_free(&f->normal);
    image_free(&f->radiance);
}

/* --- encoding ---------------------------------------------------------------------------------------------------- */

/* Clip z = a * depth + b, over w = depth (perspective) or 1: from the values of ndc z at the two ends. */
static void depth_row(const hbil_config *config, double *a, double *b)
{
    const int    reversed = config->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    const double low = config->clip == HBIL_CLIP_GL ? -1.0 : 0.0, at_near = reversed ? 1.0 : low, at_far = reversed ? low : 1.0;
    if (config->projection == HBIL_PROJECTION_ORTHOGRAPHIC) {
        *a = (at_far - at_near) / (FAR_Z - NEAR_Z);
        *b = at_near - *a * NEAR_Z;
    } else if (config->depth_far == HBIL_DEPTH_FAR_INFINITE) {
        *a = at_far;
        *b = (at_near - at_far) * NEAR_Z;
    } else {
        *b = (at_near - at_far) * NEAR_Z * FAR_Z / (FAR_Z - NEAR_Z);
        *a = at_far - *b / FAR_Z;
    }
}

static float device_depth(const hbil_config *config, float linear)
{
    double a, b, ndc;
    depth_row(config, &a, &b);
    if (linear >= SKY) {
        return config->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED ? 0.0f : 1.0f;
    }
    ndc = config->projection == HBIL_PROJECTION_ORTHOGRAPHIC ? a * (double)linear + b : a + b / (double)linear;
    return (float)(config->clip == HBIL_CLIP_GL ? 0.5 * ndc + 0.5 : ndc);
}

static hbil_frame encode_frame(const fixture *f, const hbil_config *config, handedness hand)
{
    hbil_frame frame = gpu_frame(&f->camera);
    double     a, b;
    depth_row(config, &a, &b);
    frame.projection[10] = (float)-a; /* view z = -depth */
    frame.projection[14] = (float)b;
    memcpy(frame.view, k_view, sizeof frame.view);
    if (hand != RIGHT) { /* view z = depth: whatever z is multiplied by changes its sign */
        for (int i = 8; i < 12; ++i) {
            frame.projection[i] = -frame.projection[i];
        }
        for (int i = 2; i < 16; i += 4) {
            frame.view[i] = -frame.view[i];
        }
    }
    if (hand == LEFT_WORLD) {
        for (int i = 8; i < 11; ++i) {
            frame.view[i] = -frame.view[i];
        }
    }
    return frame;
}

static void encode_normal(const float n[3], int world, handedness hand, float out[3])
{
    for (int c = 0; c < 3; ++c) { /* view to world: the transposed rotation */
        out[c] = world ? k_view[4 * c] * n[0] + k_view[4 * c + 1] * n[1] + k_view[4 * c + 2] * n[2] : n[c];
    }
    if (world ? hand == LEFT_WORLD : hand != RIGHT) {
        out[2] = -out[2];
    }
}

static void run_encoded(const fixture *f, const hbil_config *config, handedness hand, gpu_output *out)
{
    gpu_input in;
    memset(&in, 0, sizeof in);
    in.frame = encode_frame(f, config, hand);
    in.radiance = f->radiance;
    assert_true(image_make(&in.depth, WIDTH, HEIGHT, 1) && image_make(&in.normal, WIDTH, HEIGHT, 3));
    for (int i = 0; i < PIXELS; ++i) {
        in.depth.data[i] = config->depth == HBIL_DEPTH_DEVICE ? device_depth(config, f->depth.data[i]) : f->depth.data[i];
        encode_normal(f->normal.data + 3 * i, config->normals == HBIL_NORMALS_WORLD, hand, in.normal.data + 3 * i);
    }
    gpu_run(config, &in, out);
    image_free(&in.depth);
    image_free(&in.normal);
}

/* --- comparison -------------------------------------------------------------------------------------------------- */

/* Largest difference of any output; b's rows from the bottom up if flip, its view space left-handed if hand is. */
static double difference(const gpu_output *a, const gpu_output *b, int flip, handedness hand)
{
    double worst = 0.0;
    for (int i = 0; i < PIXELS; ++i) {
        const int    j = flip ? (HEIGHT - 1 - i / WIDTH) * WIDTH + i % WIDTH : i;
        const double ao = fabs((double)a->ao.data[i] - (double)b->ao.data[j]);
        worst = ao <= worst ? worst : ao; /* keeps NaN */
        for (int c = 0; c < 3; ++c) {
            const double sign = c == 2 && hand != RIGHT ? -1.0 : 1.0;
            const double near = fabs((double)a->near.data[4 * i + c] - (double)b->near.data[4 * j + c]);
            const double bent = fabs((double)a->bent.data[4 * i + c] - sign * (double)b->bent.data[4 * j + c]);
            worst = near <= worst ? worst : near;
            worst = bent <= worst ? worst : bent;
        }
    }
    return worst;
}

static hbil_config base_config(camera_kind kind)
{
    const hbil_config c = {.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR | HBIL_OUTPUTS_BENT, .slices = 4, .steps = 8,
                           .projection = kind == ORTHOGRAPHIC ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE};
    return c;
}

/* The i-th depth convention, 0: linear; 0 after the last. Conventions that do not apply to a projection are left out. */
static int set_depth(hbil_config *c, int i)
{
    const int orthographic = c->projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    c->depth = i == 0 || (orthographic && i == 1) ? HBIL_DEPTH_LINEAR : HBIL_DEPTH_DEVICE;
    if (i == 0) {
        return 1;
    }
    c->depth_direction = (i & 1) ? HBIL_DEPTH_DIRECTION_REVERSED : HBIL_DEPTH_DIRECTION_FORWARD;
    if (c->depth == HBIL_DEPTH_DEVICE) {
        c->clip = (i & 2) ? HBIL_CLIP_GL : HBIL_CLIP_VULKAN;
        c->depth_far = (i & 4) && !orthographic ? HBIL_DEPTH_FAR_INFINITE : 0;
    }
    return i < (orthographic ? 6 : 9);
}

/* The scene as it is captured: linear depth, normals as asked for, right-handed. */
static void run_reference(const fixture *f, camera_kind kind, int32_t normals, gpu_output *out)
{
    hbil_config c = base_config(kind);
    c.normals = normals == HBIL_NORMALS_DEPTH ? normals : HBIL_NORMALS_VIEW;
    run_encoded(f, &c, RIGHT, out);
}

static void check_camera(camera_kind kind)
{
    fixture f;
    double  worst = 0.0;
    int     runs = 0;
    make_fixture(&f, kind);
    for (int32_t normals = HBIL_NORMALS_VIEW; normals <= HBIL_NORMALS_DEPTH; ++normals) {
        hbil_config c = base_config(kind);
        gpu_output  reference, out;
        run_reference(&f, kind, normals, &reference);
        assert_true(reference.ao.data[PIXELS / 2] < 0.99f); /* the scene has something to compare */
        c.normals = normals;
        for (int i = 0; set_depth(&c, i); ++i) {
            for (int hand = 0; hand < HANDEDNESSES; ++hand) {
                char text[256] = "";
                run_encoded(&f, &c, (handedness)hand, &out);
                const double d = difference(&reference, &out, 0, (handedness)hand);
                gpu_free(&out);
                ++runs;
                if (!(d <= TOLERANCE)) {
                    hbil_config_print(&c, 0, text, sizeof text, NULL);
                    print_message("differs by %.1e: %s, handedness %d\n", d, text, hand);
                }
                worst = d <= worst ? worst : d;
            }
        }
        gpu_free(&reference);
    }
    print_message("%s: %d combinations differ by at most %.1e\n", k_cameras[kind], runs, worst);
    free_fixture(&f);
    assert_true(worst <= TOLERANCE);
}

static void every_convention_gives_the_same_image_symmetric(void **state)
{
    (void)state;
    check_camera(SYMMETRIC);
}

static void every_convention_gives_the_same_image_off_centre_and_jittered(void **state)
{
    (void)state;
    check_camera(OFF_CENTRE);
}

static void every_convention_gives_the_same_image_orthographic(void **state)
{
    (void)state;
    check_camera(ORTHOGRAPHIC);
}

static void flip_rows(image *img)
{
    const size_t row = (size_t)img->width * (size_t)img->channels;
    for (int y = 0; y < img->height / 2; ++y) {
        float *a = img->data + (size_t)y * row, *b = img->data + (size_t)(img->height - 1 - y) * row;
        for (size_t i = 0; i < row; ++i) {
            const float t = a[i];
            a[i] = b[i];
            b[i] = t;
        }
    }
}

/* Images stored from the bottom up, and a projection that says so. No noise: its pattern does not turn over with the image. */
static void mirrored_rows_give_the_mirrored_image(void **state)
{
    (void)state;
    for (int kind = SYMMETRIC; kind <= ORTHOGRAPHIC; ++kind) {
        hbil_config c = base_config((camera_kind)kind);
        fixture     f;
        gpu_output  straight, mirrored;
        make_fixture(&f, (camera_kind)kind);
        c.noise = HBIL_NOISE_NONE;
        run_encoded(&f, &c, RIGHT, &straight);
        flip_rows(&f.depth);
        flip_rows(&f.normal);
        flip_rows(&f.radiance);
        f.camera.ray[3] += HEIGHT * f.camera.ray[1];
        f.camera.ray[1] = -f.camera.ray[1];
        run_encoded(&f, &c, RIGHT, &mirrored);
        const double d = difference(&straight, &mirrored, 1, RIGHT);
        print_message("mirrored rows, %s: differs by %.1e\n", k_cameras[kind], d);
        assert_true(d <= TOLERANCE);
        gpu_free(&straight);
        gpu_free(&mirrored);
        free_fixture(&f);
    }
}

/* A frame that was never a file. Its images are the fixture's. */
static capture capture_of(const fixture *f)
{
    capture     cap;
    hbil_config gl = base_config(f->camera.orthographic ? ORTHOGRAPHIC : SYMMETRIC);
    gl.clip = HBIL_CLIP_GL;
    memset(&cap, 0, sizeof cap);
    const hbil_frame frame = encode_frame(f, &gl, RIGHT);
    cap.width = WIDTH;
    cap.height = HEIGHT;
    cap.orthographic = f->camera.orthographic;
    cap.near_z = (float)NEAR_Z;
    cap.far_z = (float)FAR_Z;
    memcpy(cap.projection, frame.projection, sizeof cap.projection);
    memcpy(cap.view, frame.view, sizeof cap.view);
    cap.depth = f->depth;
    cap.normal = f->normal;
    cap.direct = f->radiance;
    return cap;
}

static image input_named(const hbil_plan *plan, const image inputs[HBIL_MAX_TEXTURES], const char *name)
{
    const image   none = {0, 0, 0, NULL};
    const int32_t texture = hbil_plan_texture(plan, name);
    return texture < 0 ? none : inputs[texture];
}

static double run_capture(const capture *cap, const hbil_config *config, const gpu_output *reference)
{
    hbil_plan  plan;
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES];
    char       error[512] = "";
    gpu_output out;
    gpu_plan(config, &plan);
    if (!capture_encode(cap, &plan, &frame, inputs, error, sizeof error)) {
        fail_msg("%s", error);
    }
    const gpu_input in = {frame, input_named(&plan, inputs, "depth"), input_named(&plan, inputs, "normal"),
                          input_named(&plan, inputs, "radiance")};
    gpu_run(config, &in, &out);
    const double d = difference(reference, &out, 0, RIGHT);
    gpu_free(&out);
    for (int i = 0; i < HBIL_MAX_TEXTURES; ++i) {
        image_free(&inputs[i]);
    }
    return d;
}

static void a_capture_encoded_in_any_convention_gives_the_same_image(void **state)
{
    double worst = 0.0;
    (void)state;
    for (int kind = SYMMETRIC; kind <= ORTHOGRAPHIC; ++kind) {
        fixture f;
        make_fixture(&f, (camera_kind)kind);
        const capture cap = capture_of(&f);
        for (int32_t normals = HBIL_NORMALS_VIEW; normals <= HBIL_NORMALS_DEPTH; ++normals) {
            hbil_config c = base_config((camera_kind)kind);
            gpu_output  reference;
            run_reference(&f, (camera_kind)kind, normals, &reference);
            c.normals = normals;
            for (int i = 0; set_depth(&c, i); ++i) {
                const double d = run_capture(&cap, &c, &reference);
                worst = d <= worst ? worst : d;
            }
            gpu_free(&reference);
        }
        free_fixture(&f);
    }
    print_message("captures in every convention differ by at most %.1e\n", worst);
    assert_true(worst <= TOLERANCE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_convention_gives_the_same_image_symmetric),
        cmocka_unit_test(every_convention_gives_the_same_image_off_centre_and_jittered),
        cmocka_unit_test(every_convention_gives_the_same_image_orthographic),
        cmocka_unit_test(mirrored_rows_give_the_mirrored_image),
        cmocka_unit_test(a_capture_encoded_in_any_convention_gives_the_same_image),
    };
    return cmocka_run_group_tests_name("numeric.conventions", tests, gpu_open, gpu_close);
}
