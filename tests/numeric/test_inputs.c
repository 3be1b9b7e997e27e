/* test_inputs.c - normals in every encoding, space and handedness give the same image; of multisampled inputs the sample
 * asked for is read; normals rebuilt from depth against the captures' own. On a device: HBIL_BACKEND. */
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
#include "gpu.h"

#define WIDTH  96
#define HEIGHT 54
#define PIXELS (WIDTH * HEIGHT)
#define SKY    1e9f /* m, linear depth from which on a pixel is sky */
#define OWN    1.5e-4 /* rad: two roundings to the library's own 2 x snorm16 octahedral normals, and arithmetic in float */

/* World to view, column-major: a rotation that mixes all axes. */
static const double k_view[16] = {0.8, 0.36, -0.48, 0, 0, 0.8, 0.6, 0, 0.6, -0.48, 0.64, 0, 0.3, -2, 5, 1};

/* Nothing is within reach: the bent vector is the normal's. Slices enough to have its direction. */
static const char k_bare[] = "outputs=bent reach=1e-6 slices=64 steps=1 noise=none";
static const char k_lit[] = "outputs=ao+near slices=4 steps=8";

typedef struct fixture { bf_camera camera; image depth, normal, radiance; } fixture;

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void normalise(double v[3])
{
    const double inv = 1.0 / sqrt(fmax(dot(v, v), 1e-300));
    for (int c = 0; c < 3; ++c) v[c] *= inv;
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int c = 0; c < 3; ++c) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

/* rad; from the chord, since acos is rough for small angles. */
static double angle(const double a[3], const double b[3])
{
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return 2.0 * asin(fmin(0.5 * sqrt(dot(d, d)), 1.0));
}

/* Dents and bumps with slopes up to 60 degrees. */
static void surface(const bf_camera *camera, double px, double py, double out[3])
{
    bf_point(camera, px, py, 6.0 + 0.25 * sin(0.31 * px + 0.4) * cos(0.27 * py) + 0.15 * sin(0.19 * py - 0.1 * px), out);
}

static void make_fixture(fixture *f)
{
    const double pixel = 0.8 / HEIGHT, e = 1e-4;
    const bf_camera camera = {WIDTH, HEIGHT, 0, {pixel, -pixel, -0.5 * WIDTH * pixel, 0.5 * HEIGHT * pixel}};
    double flattest = 1.0;
    f->camera = camera;
    assert_true(image_make(&f->depth, WIDTH, HEIGHT, 1) && image_make(&f->normal, WIDTH, HEIGHT, 3)
                && image_make(&f->radiance, WIDTH, HEIGHT, 3));
    for (int i = 0; i < PIXELS; ++i) {
        const double px = i % WIDTH + 0.5, py = i / WIDTH + 0.5;
        double p[3], a[3], b[3], n[3];
        surface(&camera, px, py, p);
        surface(&camera, px + e, py, a);
        surface(&camera, px, py + e, b);
        for (int c = 0; c < 3; ++c) a[c] -= p[c], b[c] -= p[c];
        cross(b, a, n); /* rows run down: towards the eye */
        normalise(n);
        assert_true(dot(n, p) < 0.0 && n[2] > 0.2); /* faces the eye, and has a z that two channels can tell */
        flattest = fmin(flattest, n[2]);
        f->depth.data[i] = (float)-p[2];
        for (int c = 0; c < 3; ++c) {
            f->normal.data[3 * i + c] = (float)n[c];
            f->radiance.data[3 * i + c] = 0.3f + 0.2f * (float)c + 0.3f * (float)((i / 7) % 2);
        }
    }
    assert_true(flattest < 0.6);
}

static void free_fixture(fixture *f)
{
    image_free(&f->depth);
    image_free(&f->normal);
    image_free(&f->radiance);
}

/* ------------------------------------------------------------------------------------------------------------- encodings */

/* steps: of a whole channel, 255 for 8 bits; 0: floats. bound: of the quantisation, rad, in half steps of a channel from -1
 * to 1: a vector of three is off by sqrt(3) of them; an octahedral map turns two into at most sqrt(18); of two channels the
 * error grows with 1 / z. */
typedef struct encoding { const char *name; int id, channels, is_signed; double steps, bound; } encoding;

static const encoding k_encodings[] = {
    {"xyz",              HBIL_NORMAL_ENCODING_XYZ,              3, 1, 0,     0},
    {"xyz",              HBIL_NORMAL_ENCODING_XYZ,              3, 1, 254,   1.7321},
    {"xyz_unorm",        HBIL_NORMAL_ENCODING_XYZ_UNORM,        3, 0, 255,   1.7321},
    {"xyz_unorm",        HBIL_NORMAL_ENCODING_XYZ_UNORM,        3, 0, 1023,  1.7321},
    {"octahedral",       HBIL_NORMAL_ENCODING_OCTAHEDRAL,       2, 1, 0,     0},
    {"octahedral",       HBIL_NORMAL_ENCODING_OCTAHEDRAL,       2, 1, 65534, 4.2427},
    {"octahedral_unorm", HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM, 2, 0, 65535, 4.2427},
    {"octahedral_888",   HBIL_NORMAL_ENCODING_OCTAHEDRAL_888,   3, 0, 4095,  4.2427},
    {"xy",               HBIL_NORMAL_ENCODING_XY,               2, 1, 0,     0},
    {"xy",               HBIL_NORMAL_ENCODING_XY,               2, 1, 254,   1.5},
    {"xy_unorm",         HBIL_NORMAL_ENCODING_XY_UNORM,         2, 0, 255,   1.5},
};

static int is_xy(const encoding *e)
{
    return e->id == HBIL_NORMAL_ENCODING_XY || e->id == HBIL_NORMAL_ENCODING_XY_UNORM;
}

static int is_octahedral(const encoding *e)
{
    return e->id == HBIL_NORMAL_ENCODING_OCTAHEDRAL || e->id == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM
        || e->id == HBIL_NORMAL_ENCODING_OCTAHEDRAL_888;
}

/* A channel from [-1, 1] to what the texture gives. */
static double quantise(const encoding *e, double v)
{
    const double u = e->is_signed ? v : 0.5 * v + 0.5, scale = e->is_signed ? 0.5 * e->steps : e->steps;
    return e->steps > 0.0 ? floor(u * scale + 0.5) / scale : u;
}

static void encode(const encoding *e, const double n[3], float *out)
{
    double t[3] = {n[0], n[1], n[2]}, q[3];
    if (is_octahedral(e)) {
        const double l1 = fabs(n[0]) + fabs(n[1]) + fabs(n[2]), x = n[0] / l1, y = n[1] / l1;
        t[0] = n[2] >= 0.0 ? x : copysign(1.0 - fabs(y), x);
        t[1] = n[2] >= 0.0 ? y : copysign(1.0 - fabs(x), y);
    }
    for (int c = 0; c < 3; ++c) q[c] = quantise(e, t[c]);
    if (e->id == HBIL_NORMAL_ENCODING_OCTAHEDRAL_888) {
        const int x = (int)floor(q[0] * 4095.0 + 0.5), y = (int)floor(q[1] * 4095.0 + 0.5);
        q[0] = x % 256 / 255.0;
        q[1] = y % 256 / 255.0;
        q[2] = (x / 256 + 16 * (y / 256)) / 255.0;
    }
    for (int c = 0; c < e->channels; ++c) out[c] = (float)q[c];
}

/* Right-handed view normals to the space asked for. */
static void to_space(const float n[3], int world, int left, double out[3])
{
    const double v[3] = {(double)n[0], (double)n[1], (double)n[2]};
    for (int c = 0; c < 3; ++c) out[c] = world ? dot(k_view + 4 * c, v) : v[c]; /* to the world: the transposed rotation */
    if (!world && left) out[2] = -out[2];
}

static hbil_frame frame_of(const fixture *f, int left)
{
    hbil_frame frame = gpu_frame(&f->camera);
    for (int i = 0; i < 16; ++i) frame.view[i] = (float)k_view[i];
    for (int i = 8; i < 12 && left; ++i) frame.projection[i] = -frame.projection[i];
    for (int i = 2; i < 16 && left; i += 4) frame.view[i] = -frame.view[i];
    return frame;
}

static hbil_config config_of(const char *text)
{
    hbil_config c;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, text, strlen(text), NULL), HBIL_OK);
    return c;
}

static void run(const fixture *f, const char *text, const encoding *e, int world, int left, gpu_output *out)
{
    hbil_config c = config_of(text);
    gpu_input in;
    memset(&in, 0, sizeof in);
    in.frame = frame_of(f, left);
    in.depth = f->depth;
    in.radiance = f->radiance;
    c.normals = world ? HBIL_NORMALS_WORLD : HBIL_NORMALS_VIEW;
    c.normal_encoding = e->id;
    assert_true(image_make(&in.normal, WIDTH, HEIGHT, e->channels));
    for (int i = 0; i < PIXELS; ++i) {
        double n[3];
        to_space(f->normal.data + 3 * i, world, left, n);
        encode(e, n, in.normal.data + (size_t)(e->channels * i));
    }
    gpu_run(&c, &in, out);
    image_free(&in.normal);
}

/* Direction of the bent vector of a pixel, right-handed. */
static void bent_direction(const gpu_output *out, int i, int left, double n[3])
{
    for (int c = 0; c < 3; ++c) n[c] = (double)out->bent.data[4 * i + c] * (c == 2 && left ? -1.0 : 1.0);
    normalise(n);
}

/* Largest angle, rad; RMS differences of ao and near, of radiance up to 1; largest part of the tolerance that is used up. */
typedef struct worst { double angle, ao, near, share; } worst;

/* Angles at every pixel. Light and visibility as RMS: they are integrals over a hemisphere that turns, and change by about
 * the angle; but a sample that lies just at the tangent plane comes and goes with it, up to 0.02 at a single pixel. */
static void compare(const fixture *f, const encoding *e, int world, int left, const gpu_output *bare, const gpu_output *lit,
                    worst *w)
{
    const double half = e->steps > 0.0 ? 1.0 / e->steps : 0.0;
    double ao = 0.0, near = 0.0, allowed = 0.0;
    gpu_output b, l;
    run(f, k_bare, e, world, left, &b);
    run(f, k_lit, e, world, left, &l);
    for (int i = 0; i < PIXELS; ++i) {
        const double here = e->bound * half / (is_xy(e) ? (double)f->normal.data[3 * i + 2] : 1.0) + OWN;
        double a[3], n[3];
        bent_direction(bare, i, 0, a);
        bent_direction(&b, i, left, n);
        w->angle = fmax(w->angle, angle(a, n));
        w->share = fmax(w->share, angle(a, n) / here);
        assert_true(isfinite(angle(a, n)));
        allowed += here * here / PIXELS;
        ao += pow((double)lit->ao.data[i] - (double)l.ao.data[i], 2.0) / PIXELS;
        for (int c = 4 * i; c < 4 * i + 3; ++c)
            near += pow((double)lit->near.data[c] - (double)l.near.data[c], 2.0) / (3 * PIXELS);
    }
    w->ao = sqrt(ao);
    w->near = sqrt(near);
    assert_true(isfinite(ao) && isfinite(near));
    w->share = fmax(w->share, fmax(w->ao, w->near) / sqrt(allowed));
    gpu_free(&b);
    gpu_free(&l);
}

static void every_encoding_gives_the_same_image(void **state)
{
    fixture f;
    gpu_output bare, lit;
    double off = 0.0;
    int wrong = 0;
    (void)state;
    make_fixture(&f);
    run(&f, k_bare, &k_encodings[0], 0, 0, &bare);
    run(&f, k_lit, &k_encodings[0], 0, 0, &lit);
    for (int i = 0; i < PIXELS; ++i) {
        double a[3], n[3];
        to_space(f.normal.data + 3 * i, 0, 0, n);
        bent_direction(&bare, i, 0, a);
        off = fmax(off, angle(a, n));
    }
    print_message("the bare bent vector is off the normal by at most %.1e rad\n"
                  "encoding          steps            angle RMS: ao     near  part of the tolerance\n", off);
    assert_true(off < 1e-3);
    for (size_t k = 0; k < sizeof k_encodings / sizeof k_encodings[0]; ++k)
        for (int world = 0; world < (is_xy(&k_encodings[k]) ? 1 : 2); ++world)
            for (int left = 0; left < 2; ++left) {
                const encoding *e = &k_encodings[k];
                worst w = {0, 0, 0, 0};
                compare(&f, e, world, left, &bare, &lit, &w);
                print_message("%-16s %6.0f %-5s %s %8.1e %8.1e %8.1e  %.2f\n", e->name, e->steps, world ? "world" : "view",
                              left ? "L" : "R", w.angle, w.ao, w.near, w.share);
                wrong += !(w.share <= 1.0);
            }
    gpu_free(&bare);
    gpu_free(&lit);
    free_fixture(&f);
    assert_int_equal(wrong, 0);
}

static void run_flat(const fixture *f, int id, int left, const float *normal, int channels, gpu_output *out)
{
    hbil_config c = config_of("outputs=ao+near+bent slices=4 steps=8");
    gpu_input in;
    memset(&in, 0, sizeof in);
    in.frame = frame_of(f, left);
    in.depth = f->depth;
    in.radiance = f->radiance;
    c.normal_encoding = id;
    assert_true(image_make(&in.normal, WIDTH, HEIGHT, channels));
    for (int i = 0; i < channels * PIXELS; ++i) in.normal.data[i] = normal[i % channels];
    gpu_run(&c, &in, out);
    image_free(&in.normal);
}

/* Two rounded channels can be longer than 1: 90/127 each are 1.002. Then z is 0: the image is that of (x, y, 0). */
static void two_channels_longer_than_one_have_no_z(void **state)
{
    static const struct { int id; float value[2]; } cases[] = {
        {HBIL_NORMAL_ENCODING_XY, {90.0f / 127.0f, 90.0f / 127.0f}}, {HBIL_NORMAL_ENCODING_XY, {-1.0f, 0.25f}},
        {HBIL_NORMAL_ENCODING_XY_UNORM, {218.0f / 255.0f, 37.0f / 255.0f}}, {HBIL_NORMAL_ENCODING_XY_UNORM, {1.0f, 0.0f}}};
    fixture f;
    (void)state;
    make_fixture(&f);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; ++k)
        for (int left = 0; left < 2; ++left) {
            const float *v = cases[k].value;
            const int unorm = cases[k].id == HBIL_NORMAL_ENCODING_XY_UNORM;
            const float n[3] = {unorm ? 2.0f * v[0] - 1.0f : v[0], unorm ? 2.0f * v[1] - 1.0f : v[1], 0.0f};
            gpu_output two, three;
            assert_true(n[0] * n[0] + n[1] * n[1] > 1.0f);
            run_flat(&f, cases[k].id, left, v, 2, &two);
            run_flat(&f, HBIL_NORMAL_ENCODING_XYZ, left, n, 3, &three);
            for (int i = 0; i < PIXELS; ++i) {
                assert_true(fabsf(two.ao.data[i] - three.ao.data[i]) < 1e-3f);
                for (int j = 4 * i; j < 4 * i + 4; ++j) {
                    assert_true(fabsf(two.near.data[j] - three.near.data[j]) < 1e-3f);
                    assert_true(fabsf(two.bent.data[j] - three.bent.data[j]) < 1e-3f);
                }
            }
            gpu_free(&two);
            gpu_free(&three);
        }
    free_fixture(&f);
}

/* ---------------------------------------------------------------------------------------------------------- multisampled */

static void one_sample_is_the_plain_image(void **state)
{
    static const char *const normals[] = {"normals=view", "normals=world", "normals=depth"};
    fixture f;
    (void)state;
    make_fixture(&f);
    for (int k = 0; k < 3; ++k) {
        char text[128];
        gpu_input in;
        gpu_output plain;
        hbil_config c;
        memset(&in, 0, sizeof in);
        in.frame = frame_of(&f, 0);
        in.depth = f.depth;
        in.normal = f.normal; /* of whatever space: the same in both */
        in.radiance = f.radiance;
        snprintf(text, sizeof text, "outputs=ao+near+bent slices=4 steps=8 %s", normals[k]);
        c = config_of(text);
        gpu_run(&c, &in, &plain);
        for (int sample = 0; sample < 4; ++sample) {
            gpu_output out;
            c.multisample = HBIL_MULTISAMPLE_YES;
            c.sample = sample;
            gpu_run(&c, &in, &out);
            assert_memory_equal(out.ao.data, plain.ao.data, PIXELS * sizeof(float));
            assert_memory_equal(out.near.data, plain.near.data, 4 * PIXELS * sizeof(float));
            assert_memory_equal(out.bent.data, plain.bent.data, 4 * PIXELS * sizeof(float));
            gpu_free(&out);
        }
        gpu_free(&plain);
    }
    free_fixture(&f);
}

/* ------------------------------------------------------------------------------------------------------ normals of depth */

/* Angles of one way to get normals to the captured ones, degrees. */
typedef struct spread { double *angles; int count; } spread;
/* Degrees, degrees, part of the pixels that are off by more than 30 degrees. */
typedef struct summary { double median, ninety, share; } summary;

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static summary summarise(spread *s)
{
    summary out = {0, 0, 0};
    int above = 0;
    if (!s->count) return out;
    qsort(s->angles, (size_t)s->count, sizeof *s->angles, ascending);
    for (int i = 0; i < s->count; ++i) above += s->angles[i] > 30.0;
    out.median = s->angles[s->count / 2];
    out.ninety = s->angles[s->count * 9 / 10];
    out.share = (double)above / s->count;
    return out;
}

static void run_capture(const capture *cap, const char *text, gpu_output *out)
{
    hbil_config c = config_of(text);
    hbil_plan plan;
    hbil_frame frame;
    image inputs[HBIL_MAX_TEXTURES];
    char error[512] = "";
    gpu_input in;
    memset(&in, 0, sizeof in);
    if (cap->orthographic) c.projection = HBIL_PROJECTION_ORTHOGRAPHIC;
    gpu_plan(&c, &plan);
    if (!capture_encode(cap, &plan, &frame, inputs, error, sizeof error)) fail_msg("%s", error);
    in.frame = frame;
    in.depth = inputs[hbil_plan_texture(&plan, "depth")];
    if (hbil_plan_texture(&plan, "normal") >= 0) in.normal = inputs[hbil_plan_texture(&plan, "normal")];
    gpu_run(&c, &in, out);
    for (int i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
}

/* What everybody writes first: the cross product of the differences to the next pixel of the row and of the column. */
static void naive_normal(const capture *cap, const bf_camera *camera, int x, int y, double n[3])
{
    const int sx = x + 1 < cap->width ? 1 : -1, sy = y + 1 < cap->height ? 1 : -1;
    double p[3], a[3], b[3];
    const float *depth = cap->depth.data + (size_t)y * (size_t)cap->width + x;
    bf_point(camera, x + 0.5, y + 0.5, (double)depth[0], p);
    bf_point(camera, x + sx + 0.5, y + 0.5, (double)depth[sx], a);
    bf_point(camera, x + 0.5, y + sy + 0.5, (double)depth[sy * cap->width], b);
    for (int c = 0; c < 3; ++c) a[c] -= p[c], b[c] -= p[c];
    cross(a, b, n);
    normalise(n);
    if ((cap->orthographic ? -n[2] : dot(n, p)) > 0.0) for (int c = 0; c < 3; ++c) n[c] = -n[c];
}

/* Does the depth jump between the pixel and one of its four neighbours, by more than 5 %? Off the screen nothing jumps. */
static int at_silhouette(const capture *cap, int x, int y)
{
    static const int steps[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    const float z = cap->depth.data[y * cap->width + x];
    for (int k = 0; k < 4; ++k) {
        const int u = x + steps[k][0], v = y + steps[k][1];
        if (u < 0 || v < 0 || u >= cap->width || v >= cap->height) continue;
        if (fabsf(cap->depth.data[v * cap->width + u] - z) > 0.05f * z) return 1;
    }
    return 0;
}

enum { NAIVE, REBUILT, NAIVE_EDGE, REBUILT_EDGE, METHOD, SPREADS };

static void add(spread *s, const double a[3], const double b[3])
{
    s->angles[s->count++] = angle(a, b) * 180.0 / 3.14159265358979;
}

static void gather(const capture *cap, const gpu_output *view, const gpu_output *rebuilt, spread s[SPREADS])
{
    const bf_camera camera = bf_camera_from(cap->projection, cap->width, cap->height);
    for (int i = 0; i < cap->width * cap->height; ++i) {
        const int x = i % cap->width, y = i / cap->width, edge = at_silhouette(cap, x, y);
        double p[3], v[3], naive[3], own[3], n[3];
        if (!(cap->depth.data[i] < SKY)) continue;
        for (int c = 0; c < 3; ++c) n[c] = (double)cap->normal.data[3 * i + c];
        bf_point(&camera, x + 0.5, y + 0.5, (double)cap->depth.data[i], p);
        normalise(p);
        if (fabs(dot(n, n) - 1.0) > 0.01 || dot(n, p) > -0.02) continue; /* bent back by the library, or no normal at all */
        bent_direction(view, i, 0, v);
        bent_direction(rebuilt, i, 0, own);
        naive_normal(cap, &camera, x, y, naive);
        add(&s[METHOD], v, n);
        add(&s[NAIVE], naive, n);
        add(&s[REBUILT], own, n);
        if (edge) add(&s[NAIVE_EDGE], naive, n);
        if (edge) add(&s[REBUILT_EDGE], own, n);
    }
}

static double rmse(const capture *cap, const image *a, const image *b)
{
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < cap->width * cap->height; ++i) {
        const double d = (double)a->data[i] - (double)b->data[i];
        if (!(cap->depth.data[i] < SKY)) continue;
        sum += d * d;
        ++count;
    }
    return sqrt(sum / (count ? count : 1));
}

static void check_capture(const char *name, const capture *cap)
{
    const size_t size = (size_t)cap->width * (size_t)cap->height * sizeof(double);
    char text[256];
    gpu_output view, rebuilt, ao_view, ao_rebuilt;
    spread s[SPREADS];
    summary r[SPREADS];
    memset(s, 0, sizeof s);
    for (int k = 0; k < SPREADS; ++k) assert_non_null(s[k].angles = (double *)malloc(size));
    run_capture(cap, k_bare, &view);
    snprintf(text, sizeof text, "%s normals=depth", k_bare);
    run_capture(cap, text, &rebuilt);
    run_capture(cap, "outputs=ao", &ao_view);
    run_capture(cap, "outputs=ao normals=depth", &ao_rebuilt);
    gather(cap, &view, &rebuilt, s);
    for (int k = 0; k < SPREADS; ++k) r[k] = summarise(&s[k]);
    print_message("%-12s pixels    naive: median   90 %%  > 30 deg   five-tap: median   90 %%  > 30 deg\n", name);
    for (int k = 0; k < 4; k += 2)
        print_message("  %-10s %6d %15.2f %6.2f %8.2f %% %18.2f %6.2f %8.2f %%\n", k ? "silhouette" : "all", s[k].count,
                      r[k].median, r[k].ninety, 100.0 * r[k].share, r[k + 1].median, r[k + 1].ninety,
                      100.0 * r[k + 1].share);
    print_message("  ao RMSE against normals=view %.4f; angles are exact to %.3f degrees (90 %%)\n",
                  rmse(cap, &ao_view.ao, &ao_rebuilt.ao), r[METHOD].ninety);
    assert_true(r[METHOD].ninety < 0.1);
    assert_true(s[NAIVE_EDGE].count > 100);
    assert_true(r[REBUILT_EDGE].share < 0.75 * r[NAIVE_EDGE].share);
    assert_true(r[REBUILT].share < r[NAIVE].share && r[REBUILT].ninety < 1.02 * r[NAIVE].ninety + 0.02);
    for (int k = 0; k < SPREADS; ++k) free(s[k].angles);
    gpu_free(&view);
    gpu_free(&rebuilt);
    gpu_free(&ao_view);
    gpu_free(&ao_rebuilt);
}

static void normals_of_depth_hold_at_silhouettes(void **state)
{
    const capture_names names = captures_list();
    char error[512] = "";
    capture cap;
    (void)state;
    for (int i = 0; capture_scene_name(i); ++i) {
        if (!capture_scene(&cap, capture_scene_name(i), 320, 180, 0, NULL, error, sizeof error)) fail_msg("%s", error);
        check_capture(capture_scene_name(i), &cap);
        capture_free(&cap);
    }
    for (int i = 0; i < names.count; ++i) {
        if (!captures_load(names.name[i], 0, &cap, error, sizeof error)) fail_msg("%s", error);
        check_capture(names.name[i], &cap);
        capture_free(&cap);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_encoding_gives_the_same_image),
        cmocka_unit_test(two_channels_longer_than_one_have_no_z),
        cmocka_unit_test(one_sample_is_the_plain_image),
        cmocka_unit_test(normals_of_depth_hold_at_silhouettes),
    };
    return cmocka_run_group_tests_name("numeric.inputs", tests, gpu_open, gpu_close);
}
