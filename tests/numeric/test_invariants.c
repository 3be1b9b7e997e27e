/* test_invariants.c - what must hold whatever the frame, asserted on the emitted shaders, on every capture and built-in scene: on every
 * second pixel of every second row, with HBIL_LONG=1 on all. */
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
#include "analytic.h"
#include "decimate.h"
#include "rig.h"

#define PI 3.14159265358979323846
#define WHITE_L00 "3.5449077" /* radiance 1 as the coefficient of Y00 */

static int is_sky(const capture *cap, size_t at) { return !(cap->depth.data[at] < 1e9f); }

static size_t pixels_of(const capture *cap) { return (size_t)cap->width * (size_t)cap->height; }

/* Run `check` on every frame. */
static void for_frames(void (*check)(const capture *cap, const char *name))
{
    capture     cap;
    const char *name;
    for (int i = 0; (name = rig_load(&cap, i)) != NULL; ++i) {
        assert_true(getenv("HBIL_LONG") || decimate(&cap, 2));
        check(&cap, name);
        capture_free(&cap);
    }
}

/* ---- furnace ----------------------------------------------------------------------------------------------------- */

static double largest_furnace;
static int    furnaces;

/* Every surface and the environment shine with radiance 1: so does what every surface receives. */
static void check_furnace(const capture *cap, const char *config, const environment *env)
{
    rig_light light;
    rig_run(config, cap, env, &light);
    const image *near = rig_image(&light, "near"), *far = rig_image(&light, "far");
    double worst = 0.0;
    for (size_t i = 0; i < pixels_of(cap); ++i)
        for (size_t k = 0; k < 3 && !is_sky(cap, i); ++k)
            worst = fmax(worst, fabs((double)near->data[4 * i + k] + (double)far->data[4 * i + k] - 1.0));
    if (!(worst <= 1e-3)) fail_msg("%s: near + far is off by %g", config, worst);
    largest_furnace = fmax(largest_furnace, worst);
    ++furnaces;
    rig_free(&light);
}

static void check_furnaces(const capture *cap, const char *name)
{
    static const char *const models[] = {"", "occluder=heuristic", "estimator=bitmask", "estimator=bitmask occluder=thick thickness=.2",
        "estimator=bitmask occluder=thick thickness=2 far_visibility=free_bits"};
    static const char *const reaches[] = {"", "reach=1.5 falloff=1", "reach=.3 falloff=.2"};
    static const int slices[] = {1, 2, 3, 5, 8};
    environment white = rig_environment("sh:" WHITE_L00 "," WHITE_L00 "," WHITE_L00);
    capture bright = *cap;
    static size_t turn; /* of all frames */
    const int large = cap->width > (getenv("HBIL_LONG") ? 320 : 160);
    assert_true(image_make(&bright.direct, cap->width, cap->height, 3));
    rig_whiten(&bright);
    (void)name;
    for (size_t m = 0; m < sizeof models / sizeof *models; ++m)
        for (size_t r = 0; r < sizeof reaches / sizeof *reaches; ++r, ++turn)
            for (size_t k = 0; k < sizeof slices / sizeof *slices; ++k) {
                char config[256];
                /* all on small frames, in turn on others: time */
                if (large && (k != turn % 5 || (turn % 2 && !getenv("HBIL_LONG")))) continue;
                /* of the frame: the same shader for all of them */
                snprintf(config, sizeof config, "outputs=near+far environment=sh dynamic=slices slices=%d %s %s", slices[k], models[m],
                         reaches[r]);
                check_furnace(&bright, config, &white);
            }
    image_free(&bright.direct);
    environment_free(&white);
}

static void near_and_far_fill_a_white_furnace(void **state)
{
    (void)state;
    for_frames(check_furnaces);
    print_message("%d furnaces: near + far is off by %.1e at most\n", furnaces, largest_furnace);
}

/* ---- spherical harmonics ----------------------------------------------------------------------------------------- */

static double largest_dot, largest_shell;

/* Visibility as SH against ao, and against the hemisphere that it and near radiance fill together. */
static void check_sh(const capture *cap, const char *name)
{
    static const char *const estimators[] = {"", "occluder=heuristic", "estimator=bitmask", "estimator=bitmask occluder=thick"};
    capture bright = *cap;
    assert_true(image_make(&bright.direct, cap->width, cap->height, 3));
    rig_whiten(&bright);
    for (size_t e = 0; e < sizeof estimators / sizeof *estimators; ++e) {
        char config[128];
        rig_light light;
        double dots = 0.0, shells = 0.0;
        size_t count = 0;
        snprintf(config, sizeof config, "outputs=ao+sh %s", estimators[e]);
        rig_run(config, &bright, NULL, &light);
        const float *ao = rig_image(&light, "ao")->data, *sh = rig_image(&light, "sh")->data;
        const size_t layer = 4 * pixels_of(cap);
        for (size_t i = 0; i < pixels_of(cap); ++i) {
            const float *n = cap->normal.data + 3 * i, *c = sh + 4 * i;
            if (is_sky(cap, i)) continue;
            const double seen = (double)(n[1] * c[layer + 3] + n[2] * c[2 * layer + 3] + n[0] * c[3 * layer + 3]) / (0.488603 * PI);
            const double shell = (double)(n[1] * c[layer] + n[2] * c[2 * layer] + n[0] * c[3 * layer]) / (0.488603 * PI) + seen;
            dots += fabs(seen - (double)ao[i]);
            shells += fabs(shell - 1.0) + fabs((double)(c[0] + c[3]) / (0.282095 * 2.0 * PI) - 1.0);
            ++count;
        }
        largest_dot = fmax(largest_dot, dots / (double)count);
        largest_shell = fmax(largest_shell, shells / (double)count);
        if (dots > 1e-3 * (double)count || shells > 1e-3 * (double)count)
            fail_msg("%s %s: n . b - ao %g, near + visible - all %g", name, config, dots / (double)count, shells / (double)count);
        rig_free(&light);
    }
    image_free(&bright.direct);
}

static void the_uniform_bent_vector_along_the_normal_is_ao(void **state)
{
    (void)state;
    for_frames(check_sh);
    print_message("mean |n . b_uniform - ao| %.1e, mean |near + visibility - hemisphere| %.1e\n", largest_dot, largest_shell);
}

static double largest_constant;

/* An environment that is the same everywhere comes in as ao says, whatever model of visibility asks for it. */
static void check_constant(const capture *cap, const char *name)
{
    static const char *const models[] = {"far_visibility=bent", "far_visibility=ao", "far_visibility=direction", "far_visibility=cone",
        "estimator=bitmask occluder=thick far_visibility=free_bits", "estimator=bitmask far_visibility=bent sh_order=1",
        "estimator=hbao far_visibility=ao", "estimator=hbao_plus far_visibility=ao reach=1"};
    environment white = rig_environment("sh:" WHITE_L00 "," WHITE_L00 "," WHITE_L00);
    for (size_t m = 0; m < sizeof models / sizeof *models; ++m) {
        char config[192];
        rig_light light;
        double worst = 0.0;
        snprintf(config, sizeof config, "outputs=ao+far environment=sh %s", models[m]);
        rig_run(config, cap, &white, &light);
        const float *ao = rig_image(&light, "ao")->data, *far = rig_image(&light, "far")->data;
        for (size_t i = 0; i < pixels_of(cap); ++i)
            if (!is_sky(cap, i)) worst = fmax(worst, fabs((double)far[4 * i] - (double)ao[i]));
        if (!(worst <= 2e-4)) fail_msg("%s %s: far - ao %g", name, config, worst);
        largest_constant = fmax(largest_constant, worst);
        rig_free(&light);
    }
    environment_free(&white);
}

static void an_even_sky_comes_in_as_ao_says(void **state)
{
    (void)state;
    for_frames(check_constant);
    print_message("|far - ao L0| %.1e at most\n", largest_constant);
}

/* ---- planes ------------------------------------------------------------------------------------------------------ */

/* A plane that fills the screen: bent vector 2/3 n, cone open, far light that of an open surface. */
static void check_plane(double tilt, double turn, const char *estimator)
{
    enum { WIDTH = 96, HEIGHT = 54 };
    const double point[3] = {0.0, 0.0, -5.0}, n[3] = {sin(tilt) * cos(turn), sin(tilt) * sin(turn), cos(tilt)};
    const bf_camera camera = {WIDTH, HEIGHT, 0, {2.0 / WIDTH, 2.0 / WIDTH, -1.0, -1.0 * HEIGHT / WIDTH}};
    const wedge plane = wedge_plane(point, n);
    environment sky = rig_environment("sky");
    capture cap;
    rig_light light;
    char config[192];
    double bent = 0.0, cone = 0.0, far = 0.0;
    memset(&cap, 0, sizeof cap);
    cap.width = WIDTH, cap.height = HEIGHT, cap.near_z = 0.1f, cap.far_z = 1e4f;
    assert_true(image_make(&cap.depth, WIDTH, HEIGHT, 1) && image_make(&cap.normal, WIDTH, HEIGHT, 3));
    wedge_render(&plane, &camera, 1e10f, NULL, cap.depth.data, cap.normal.data, NULL);
    rig_project(&camera, cap.projection);
    cap.view[0] = cap.view[5] = cap.view[10] = cap.view[15] = 1.0f;
    snprintf(config, sizeof config, "outputs=bent+cone+far environment=sh sh_order=1 slices=64 %s", estimator);
    rig_run(config, &cap, &sky, &light);
    for (size_t i = 0; i < pixels_of(&cap); ++i) {
        const float *b = rig_image(&light, "bent")->data + 4 * i, *c = rig_image(&light, "cone")->data + 4 * i;
        if (is_sky(&cap, i)) continue;
        for (int k = 0; k < 3; ++k) {
            const double ground[3] = {0.30, 0.22, 0.14}, zenith[3] = {0.45, 0.75, 1.30};
            const double open = ground[k] + (zenith[k] - ground[k]) * (0.5 + n[2] / 3.0);
            bent = fmax(bent, fabs((double)b[k] - n[k] * 2.0 / 3.0));
            cone = fmax(cone, fabs((double)c[k] - n[k]));
            far = fmax(far, fabs((double)rig_image(&light, "far")->data[4 * i + (size_t)k] - open));
        }
        cone = fmax(cone, (double)(c[3] * c[3]));
    }
    if (bent > 1e-3 || cone > 2e-3 || far > 1e-3) fail_msg("plane %g %g %s: bent %g, cone %g, far %g off", tilt, turn, config, bent, cone, far);
    rig_free(&light);
    capture_free(&cap);
    environment_free(&sky);
}

static void an_open_plane_sees_two_thirds_of_its_normal(void **state)
{
    (void)state;
    for (int tilt = 0; tilt <= 60; tilt += 20)
        for (int turn = 0; turn < 360; turn += 75) {
            check_plane(tilt * PI / 180.0, turn * PI / 180.0, "");
            check_plane(tilt * PI / 180.0, turn * PI / 180.0, "estimator=bitmask");
            check_plane(tilt * PI / 180.0, turn * PI / 180.0, "estimator=bitmask far_visibility=free_bits");
        }
}

/* ---- weights ----------------------------------------------------------------------------------------------------- */

/* Light from a few pixels only: no weight may take any away. */
static void check_weights(const capture *cap, const char *name)
{
    static const char *const models[] = {"slices=2 steps=12", "facing=half_space", "facing=filter reach=2", "occluder=heuristic steps=12",
        "estimator=bitmask", "estimator=bitmask occluder=thick facing=half_space"};
    capture sparse = *cap;
    uint32_t seed = 5;
    assert_true(image_make(&sparse.direct, cap->width, cap->height, 3));
    for (size_t i = 0; i < 3 * pixels_of(cap); ++i) {
        seed = seed * 1664525u + 1013904223u;
        sparse.direct.data[i] = seed >> 25 ? 0.0f : 1000.0f;
    }
    for (size_t m = 0; m < sizeof models / sizeof *models; ++m) {
        char config[128];
        rig_light light;
        snprintf(config, sizeof config, "outputs=ao+uniform_ao+near %s", models[m]);
        rig_run(config, &sparse, NULL, &light);
        for (size_t i = 0; i < pixels_of(cap); ++i) {
            const float *near = rig_image(&light, "near")->data + 4 * i;
            const float ao = rig_image(&light, "ao")->data[i], uniform = rig_image(&light, "uniform_ao")->data[i];
            if (!(near[0] >= 0.0f && near[1] >= 0.0f && near[2] >= 0.0f) || !(ao >= 0.0f && ao <= 1.0f) ||
                !(uniform >= -1e-6f && uniform <= 1.0f + 1e-5f))
                fail_msg("%s %s: pixel %zu has near %g %g %g, ao %g, uniform ao %g", name, config, i, (double)near[0], (double)near[1],
                         (double)near[2], (double)ao, (double)uniform);
        }
        rig_free(&light);
    }
    image_free(&sparse.direct);
}

static void no_weight_is_negative(void **state)
{
    (void)state;
    for_frames(check_weights);
}

/* ---- bitmask against horizon ------------------------------------------------------------------------------------- */

static double largest_gap, largest_mean, largest_bias;

/* Mean |difference| of ao; *bias the mean difference, *gap the largest. */
static double apart(const capture *cap, int slices, double *bias, double *gap)
{
    rig_light a, b;
    double sum = 0.0;
    size_t count = 0;
    char config[2][64 + 64];
    snprintf(config[0], sizeof config[0], "outputs=ao steps=12 slices=%d", slices);
    snprintf(config[1], sizeof config[1], "outputs=ao steps=12 slices=%d estimator=bitmask", slices);
    rig_run(config[0], cap, NULL, &a);
    rig_run(config[1], cap, NULL, &b);
    *bias = *gap = 0.0;
    for (size_t i = 0; i < pixels_of(cap); ++i) {
        const double off = (double)rig_image(&b, "ao")->data[i] - (double)rig_image(&a, "ao")->data[i];
        if (is_sky(cap, i)) continue;
        *gap = fmax(*gap, fabs(off));
        *bias += off;
        sum += fabs(off);
        ++count;
    }
    *bias /= (double)count;
    rig_free(&a);
    rig_free(&b);
    return sum / (double)count;
}

/* A slice is off by less than a sector per side, and by nothing in the mean. */
static void check_bitmask(const capture *cap, const char *name)
{
    double bias, gap, mean;
    apart(cap, 1, &bias, &gap);
    if (!(gap <= 1.0 / 16.0 + 1e-4) || fabs(bias) > 1e-3) fail_msg("%s: one slice: %g apart at most, %g in the mean", name, gap, bias);
    largest_gap = fmax(largest_gap, gap);
    largest_bias = fmax(largest_bias, fabs(bias));
    mean = apart(cap, 3, &bias, &gap);
    if (mean > 0.01) fail_msg("%s: three slices: mean |difference| %g", name, mean);
    largest_mean = fmax(largest_mean, mean);
}

static void a_solid_bitmask_is_the_horizon(void **state)
{
    (void)state;
    for_frames(check_bitmask);
    print_message("one slice: %.4f apart at most, mean %.1e; three slices: mean |difference| %.4f\n", largest_gap, largest_bias, largest_mean);
}

/* ---- thin occluders ---------------------------------------------------------------------------------------------- */

/* RMSE of ao against the path-traced truth. */
static double ao_error(const capture *cap, const char *config)
{
    rig_light light;
    double sum = 0.0;
    size_t count = 0;
    rig_run(config, cap, NULL, &light);
    for (size_t i = 0; i < pixels_of(cap); ++i) {
        const double off = (double)rig_image(&light, "ao")->data[i] - (double)cap->truth_ao.data[i];
        if (is_sky(cap, i)) continue;
        sum += off * off;
        ++count;
    }
    rig_free(&light);
    return sqrt(sum / (double)count);
}

/* 0.1 m: what the scene's own comment says of its thin things. */
static void behind_thin_occluders_a_thick_bitmask_has_half_the_error_of_a_height_field(void **state)
{
    static const char field[] = "outputs=ao slices=8 steps=32 exponent=1.5";
    capture cap;
    char error[512] = "", solid[128], thick[128];
    (void)state;
    snprintf(solid, sizeof solid, "%s estimator=bitmask", field);
    snprintf(thick, sizeof thick, "%s estimator=bitmask occluder=thick thickness=0.1", field);
    if (!capture_scene(&cap, "fence", 320, 180, 64, NULL, error, sizeof error)) fail_msg("%s", error);
    const double a = ao_error(&cap, field), b = ao_error(&cap, solid), c = ao_error(&cap, thick);
    print_message("fence: ao rmse of the height field %.3f, of the bitmask solid %.3f, 0.1 m thick %.3f\n", a, b, c);
    assert_true(c <= 0.5 * a);
    assert_true(b > 0.9 * a); /* it is the thickness, not the sectors */
    capture_free(&cap);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(near_and_far_fill_a_white_furnace),
        cmocka_unit_test(the_uniform_bent_vector_along_the_normal_is_ao),
        cmocka_unit_test(an_even_sky_comes_in_as_ao_says),
        cmocka_unit_test(an_open_plane_sees_two_thirds_of_its_normal),
        cmocka_unit_test(no_weight_is_negative),
        cmocka_unit_test(a_solid_bitmask_is_the_horizon),
        cmocka_unit_test(behind_thin_occluders_a_thick_bitmask_has_half_the_error_of_a_height_field),
    };
    return cmocka_run_group_tests_name("numeric_invariants", tests, rig_open, rig_close);
}
