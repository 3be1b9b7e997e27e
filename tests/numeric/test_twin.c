/* test_twin.c - the emitted shaders against the same pixels in double precision (methods.h, which shares no formula with them): every
 * estimator, occluder, facing filter, output, environment and visibility, over all captures and built-in scenes, of every second
 * pixel of every second row (HBIL_LONG=1: of all). */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../../hbil.h"
#include "decimate.h"
#include "methods.h"
#include "rig.h"

#define EVERY 11        /* of the pixels in both directions */
#define MEAN_MOST 2e-4  /* mean |difference|, in units of the larger of 1 and the output's mean */
#define FEW 0.02        /* part of the pixels that may differ by more than ten times that: horizons and sectors that flip on rounding */
#define ALL "outputs=ao+uniform_ao+bent+cone+near+sh+far+irradiance+specular_occlusion+composite "

/* ---- environments ------------------------------------------------------------------------------------------------ */

enum { SKY_1, SKY_2, COLOR, CUBE, PROBES, HOOK, NONE };

static const char *const environment_names[] = {"environment=sh sh_order=1", "environment=sh", "environment=constant",
    "environment=cube", "environment=probes", "environment=hook", ""};
static environment   environments[NONE + 1];
static methods_probes probes;

static void sky(const double d[3], double band_1, double rgb[3])
{
    static const double ground[3] = {0.30, 0.22, 0.14}, zenith[3] = {0.45, 0.75, 1.30};
    for (int k = 0; k < 3; ++k) rgb[k] = 0.5 * (ground[k] + zenith[k]) + 0.5 * band_1 * (zenith[k] - ground[k]) * d[2];
}

static void look_diffuse(void *user, const double position[3], const double direction[3], double cos_aperture, double rgb[3])
{
    (void)user, (void)position, (void)cos_aperture;
    sky(direction, 2.0 / 3.0, rgb);
}

static void look_sharp(void *user, const double position[3], const double direction[3], double cos_aperture, double rgb[3])
{
    (void)user, (void)position, (void)cos_aperture;
    sky(direction, 1.0, rgb);
}

static void make_cube(environment *e)
{
    enum { SIZE = 64 };
    memset(e, 0, sizeof *e);
    e->kind = HBIL_ENVIRONMENT_CUBE;
    assert_true(image_make_slices(&e->cube, SIZE, SIZE, 6, 3));
    for (int i = 0; i < 6 * SIZE * SIZE; ++i) {
        const double s = (i % SIZE + 0.5) * 2.0 / SIZE - 1.0, t = (i / SIZE % SIZE + 0.5) * 2.0 / SIZE - 1.0;
        const double faces[6][3] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
        const double *f = faces[i / (SIZE * SIZE)], l = 1.0 / sqrt(1.0 + s * s + t * t), d[3] = {f[0] * l, f[1] * l, f[2] * l};
        double rgb[3];
        sky(d, 1.0, rgb);
        for (int k = 0; k < 3; ++k) e->cube.data[3 * i + k] = (float)rgb[k];
    }
}

static void make_probes(environment *e)
{
    static double sh[3 * 2 * 2][9][3];
    uint32_t seed = 7;
    memset(e, 0, sizeof *e);
    e->kind = HBIL_ENVIRONMENT_PROBES;
    e->order = 2;
    probes.sh = (const double (*)[9][3])sh;
    for (int k = 0; k < 3; ++k) {
        static const int size[3] = {3, 2, 2};
        probes.count[k] = e->size[k] = size[k];
        probes.origin[k] = -1.0 - k;
        probes.step[k] = 1.5 + k;
        e->origin[k] = (float)probes.origin[k];
        e->step[k] = (float)probes.step[k];
    }
    assert_true(image_make_slices(&e->probes, 3, 2, 9 * 2, 3));
    for (int i = 0; i < 12; ++i)
        for (int l = 0; l < 9; ++l)
            for (int k = 0; k < 3; ++k) {
                seed = seed * 1664525u + 1013904223u;
                sh[i][l][k] = (double)(float)((l ? -0.2 : 2.0) + 0.4 * seed / 4294967296.0);
                e->probes.data[3 * ((l * 2 + i / 6) * 6 + i % 6) + k] = (float)sh[i][l][k];
            }
}

static int set_up(void **state)
{
    environments[SKY_1] = rig_environment("sky");
    environments[SKY_2] = rig_environment("sh:2,3,4,.3,.2,.1,.5,.9,1,-.4,.1,.2,.1,.2,.3,-.2,.1,.1,.3,.4,-.2,.2,.2,.1,-.3,-.1,.2");
    environments[COLOR] = rig_environment("color:.5,1,2");
    make_cube(&environments[CUBE]);
    make_probes(&environments[PROBES]);
    return rig_open(state);
}

static int tear_down(void **state)
{
    for (int i = 0; i < NONE; ++i) environment_free(&environments[i]);
    return rig_close(state);
}

/* ---- the same pixel on the CPU ----------------------------------------------------------------------------------- */

static methods_options options_of(const hbil_config *c, const methods_environment *env)
{
    methods_options o = {.estimator = c->estimator, .occluder = c->occluder, .attenuation = c->attenuation, .facing = c->facing,
        .environment = c->environment, .far_visibility = c->far_visibility, .sh_order = c->sh_order, .bounce = c->bounce,
        .noise = c->noise, .spacing = c->spacing, .slices = c->slices, .steps = c->steps};
    o.exponent = (double)c->exponent, o.reach = (double)c->reach, o.falloff = (double)c->falloff, o.bias = (double)c->bias;
    o.angle_bias = (double)c->angle_bias, o.multiplier = (double)c->multiplier, o.thickness = (double)c->thickness;
    o.decay = (double)c->decay, o.pull = (double)c->pull, o.firefly = (double)c->firefly, o.roughness = (double)c->roughness;
    o.near_intensity = (double)c->near_intensity, o.far_intensity = (double)c->far_intensity, o.ao_exponent = (double)c->ao_exponent;
    o.seed_compat = c->seed_compat;
    o.env = env;
    return o;
}

static methods_environment environment_of(int kind, const hbil_frame *f, const hbil_config *c)
{
    methods_environment e = {.probes = &probes};
    const float *m = f->view;
    for (int k = 0; k < 3; ++k) {
        e.color[k] = (double)f->far_color[k];
        for (int i = 0; i < 9; ++i) e.sh[i][k] = (double)f->far_sh[i][k];
        for (int j = 0; j < 3; ++j) e.to_world[3 * k + j] = (double)(j == 2 ? -m[4 * k + j] : m[4 * k + j]);
        e.eye[k] = -(double)m[4 * k] * (double)m[12] - (double)m[4 * k + 1] * (double)m[13] - (double)m[4 * k + 2] * (double)m[14];
    }
    (void)kind;
    e.lookup = c->far_visibility == HBIL_FAR_VISIBILITY_FREE_BITS ? look_sharp : look_diffuse;
    return e;
}

static void fill(methods_pixel *p, const capture *cap, const hbil_config *c, size_t at)
{
    for (size_t k = 0; k < 3; ++k) {
        p->albedo[k] = (double)cap->albedo.data[3 * at + k];
        p->direct[k] = (double)cap->direct.data[3 * at + k];
        if (c->f0 == HBIL_F0_RGB) p->f0[k] = (double)cap->f0.data[3 * at + k];
        if (c->f0 == HBIL_F0_SCALAR) /* luminance, as capture_encode hands it over */
            p->f0[k] = 0.2126 * (double)cap->f0.data[3 * at] + 0.7152 * (double)cap->f0.data[3 * at + 1]
                     + 0.0722 * (double)cap->f0.data[3 * at + 2];
    }
    p->roughness = (double)cap->roughness.data[at];
}

/* ---- comparison -------------------------------------------------------------------------------------------------- */

typedef struct tally { double sum, size, worst; long count, within, far_off; } tally;

static long all_within[2], all_count[2]; /* values of the horizon and others, of the bitmask */

static const struct { const char *name; size_t channels, offset; int view_z, layers; } kinds[] = {
    {"ao", 1, offsetof(methods_result, ao), 0, 1},
    {"uniform_ao", 1, offsetof(methods_result, uniform_ao), 0, 1},
    {"bent", 3, offsetof(methods_result, bent), 1, 1},
    {"cone", 4, offsetof(methods_result, cone), 1, 1},
    {"near", 3, offsetof(methods_result, near), 0, 1},
    {"sh", 4, offsetof(methods_result, sh), 0, 4},
    {"far", 3, offsetof(methods_result, far), 0, 1},
    {"irradiance", 3, offsetof(methods_result, irradiance), 0, 1},
    {"specular_occlusion", 1, offsetof(methods_result, specular_occlusion), 0, 1},
    {"multi_bounce", 3, offsetof(methods_result, multi_bounce), 0, 1},
    {"composite", 3, offsetof(methods_result, composite), 0, 1},
};
#define KINDS (sizeof kinds / sizeof *kinds)

/* Vectors of methods.h point into the screen, those of the outputs look down -z: z and the SH coefficient of z change sign. */
static void compare(size_t kind, const image *img, const methods_result *r, size_t at, tally *t)
{
    const double *cpu = (const double *)(const void *)((const char *)r + kinds[kind].offset);
    double off = 0.0;
    for (int layer = 0; layer < kinds[kind].layers; ++layer)
        for (size_t k = 0; k < kinds[kind].channels; ++k) {
            const size_t texels = (size_t)img->width * (size_t)img->height * (size_t)layer + at;
            const double gpu = (double)img->data[texels * (size_t)img->channels + k];
            double want = cpu[(size_t)layer * kinds[kind].channels + k];
            if ((kinds[kind].view_z && k == 2) || (kinds[kind].layers == 4 && layer == 2)) want = -want;
            assert_true(gpu - gpu == 0.0);
            off = fmax(off, fabs(gpu - want));
            t->size += fabs(want) / (double)(kinds[kind].channels * (size_t)kinds[kind].layers);
        }
    t->sum += off;
    t->worst = fmax(t->worst, off);
    t->within += off <= MEAN_MOST;
    t->far_off += off > 10.0 * MEAN_MOST;
    ++t->count;
}

static int faults; /* of all configs: all are told before the test fails */

static void check_config(const char *config, int env, const capture *cap, double loose, double *worst)
{
    char text[512];
    rig_light light;
    tally tallies[KINDS] = {{0}};
    methods_work work = {0};
    const bf_scene scene = rig_scene(cap);
    snprintf(text, sizeof text, "%s %s", config, environment_names[env]);
    rig_run(text, cap, env == NONE ? NULL : &environments[env], &light);
    const methods_environment e = environment_of(env, &light.frame, &light.plan.config);
    const methods_options o = options_of(&light.plan.config, &e);
    for (int y = EVERY / 2; y < cap->height; y += EVERY)
        for (int x = EVERY / 2; x < cap->width; x += EVERY) {
            const size_t at = (size_t)y * (size_t)cap->width + (size_t)x;
            methods_pixel p;
            methods_result r;
            assert_true(methods_place(&o, &scene, x, y, &work, &p));
            fill(&p, cap, &light.plan.config, at);
            methods_light(&o, &p, &r);
            for (size_t k = 0; k < KINDS; ++k)
                if (rig_image(&light, kinds[k].name)) compare(k, rig_image(&light, kinds[k].name), &r, at, &tallies[k]);
        }
    for (size_t k = 0; k < KINDS; ++k) {
        const tally *t = &tallies[k];
        if (!t->count) continue;
        all_within[o.estimator == METHODS_BITMASK] += t->within;
        all_count[o.estimator == METHODS_BITMASK] += t->count;
        const double scale = fmax(1.0, t->size / (double)t->count), mean = t->sum / (double)t->count / scale;
        worst[k] = fmax(worst[k], mean / loose);
        if (mean > MEAN_MOST * loose || (double)t->far_off > FEW * loose * (double)t->count)
            print_error("%s: %s: mean %.2g, worst %.2g, %ld of %ld far off\n", text, kinds[k].name, mean, t->worst, t->far_off, t->count), ++faults;
    }
    methods_work_free(&work);
    rig_free(&light);
}

typedef struct twin { const char *config; int env; double loose; } twin;

/* loose: sectors flip where an edge is within rounding of a boundary (G's polynomial moves edges by 1e-3 of a sector), a cube map of 16
 * texels a side is not its function. */
static const twin twins[] = {
    {ALL, SKY_2, 1}, {ALL "facing=filter f0=rgb", SKY_2, 1}, {ALL "facing=half_space f0=scalar firefly=.2", SKY_2, 1},
    {ALL "occluder=heuristic", SKY_2, 1}, {ALL "occluder=heuristic facing=half_space reach=1.5 decay=.3 steps=11", SKY_2, 1},
    {ALL "reach=1 falloff=1 slices=5 steps=4 near_intensity=2 far_intensity=.5 ao_exponent=1.7 roughness=.35", SKY_2, 1},
    {ALL "far_visibility=ao", SKY_2, 1}, {ALL "far_visibility=direction", SKY_2, 1}, {ALL "far_visibility=cone", SKY_2, 1},
    {ALL, SKY_1, 1}, {ALL "far_visibility=cone", SKY_1, 1}, {ALL, COLOR, 1}, {ALL, CUBE, 6}, {ALL "far_visibility=ao", CUBE, 6},
    {ALL, PROBES, 1}, {ALL "sh_order=1", PROBES, 1}, {ALL "far_visibility=cone", PROBES, 1}, {ALL "far_visibility=ao", PROBES, 1},
    {ALL, HOOK, 1}, {ALL "far_visibility=ao noise=ign", HOOK, 1}, {ALL "noise=none spacing=geometric", COLOR, 1},
    {"outputs=ao+multi_bounce", NONE, 1}, {"outputs=ao+multi_bounce bounce=cubic", NONE, 1},
    {ALL "seed_compat=screen_azimuth", SKY_2, 1}, {ALL "seed_compat=slice_mean far_visibility=direction", SKY_2, 1},
    {ALL "seed_compat=noise_2pi+cone_relation far_visibility=cone", SKY_2, 1}, {ALL "seed_compat=f0_ao far_visibility=ao", SKY_2, 1},
    {ALL "seed_compat=uniform_bent far_visibility=direction", SKY_2, 1},
    {ALL "estimator=bitmask", SKY_2, 3}, {ALL "estimator=bitmask facing=filter", SKY_2, 3},
    {ALL "estimator=bitmask facing=half_space", SKY_2, 3}, {ALL "estimator=bitmask occluder=thick thickness=.3", SKY_2, 3},
    {ALL "estimator=bitmask occluder=thick thickness=.1 facing=half_space reach=2", SKY_2, 3},
    {ALL "estimator=bitmask occluder=thick far_visibility=free_bits", SKY_2, 3},
    {ALL "estimator=bitmask far_visibility=free_bits", SKY_1, 3}, {ALL "estimator=bitmask far_visibility=free_bits", CUBE, 6},
    {ALL "estimator=bitmask far_visibility=free_bits", PROBES, 3}, {ALL "estimator=bitmask far_visibility=free_bits", HOOK, 3},
    {ALL "estimator=bitmask far_visibility=ao", SKY_2, 3}, {ALL "estimator=bitmask far_visibility=cone", SKY_2, 3},
    {ALL "estimator=bitmask far_visibility=direction", CUBE, 6}, {ALL "estimator=bitmask", COLOR, 3},
    {"estimator=bitmask outputs=ao+multi_bounce", NONE, 3},
    {"estimator=hbao outputs=ao+far+irradiance+composite far_visibility=ao", SKY_2, 1},
    {"estimator=hbao outputs=ao reach=1", NONE, 1}, {"estimator=hbao outputs=ao+multi_bounce reach=1 attenuation=linear", NONE, 1},
    {"estimator=hbao_plus outputs=ao+far far_visibility=ao", HOOK, 1}, {"estimator=hbao_plus outputs=ao reach=1", NONE, 1},
    {"estimator=hbao_plus outputs=ao reach=1 attenuation=linear multiplier=2 angle_bias=.02", COLOR, 1},
};

static void shaders_equal_their_twin_in_double_precision(void **state)
{
    double worst[KINDS] = {0};
    int frames = 0, runs = 0;
    capture cap;
    (void)state;
    for (; rig_load(&cap, frames); ++frames) {
        assert_true(getenv("HBIL_LONG") || decimate(&cap, 2));
        for (size_t i = 0; i < sizeof twins / sizeof *twins; ++i)
            if (frames == 0 || (i + (size_t)frames) % 3 == 0) /* all on one frame, a third on each other: time */
                check_config(twins[i].config, twins[i].env, &cap, twins[i].loose, worst), ++runs;
        capture_free(&cap);
    }
    assert_int_equal(faults, 0);
    print_message("%d configs, %d runs on %d frames; largest mean |difference| (sectors and cube maps by their factor):", (int)(sizeof twins / sizeof *twins),
                  runs, frames);
    for (size_t k = 0; k < KINDS; ++k) print_message(" %s %.1e", kinds[k].name, worst[k]);
    print_message("\nwithin %g: %.2f %% of all values, of the bitmask %.2f %%: the others have a sector's edge that rounding flips\n", MEAN_MOST,
                  100.0 * (double)all_within[0] / (double)all_count[0], 100.0 * (double)all_within[1] / (double)all_count[1]);
    assert_true((double)all_within[0] > 0.98 * (double)all_count[0] && (double)all_within[1] > 0.95 * (double)all_count[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_equal_their_twin_in_double_precision),
    };
    return cmocka_run_group_tests_name("numeric_twin", tests, set_up, tear_down);
}
