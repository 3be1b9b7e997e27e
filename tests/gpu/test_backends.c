/* test_backends.c - Vulkan and GL give the same image, per output, on the built-in scene, on all captures and for all presets;
 * the validation layer and GL debug output are silent; pipelines survive changes of plan and size. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../matrix.h"

#include "../captures.h"
#include "../numeric/decimate.h"
#include "compare.h"

static runner *vulkan, *gl;

static void compare(const char *where, const capture *cap, const char *config)
{
    hbil_plan pv = plan_of(config, "vulkan"), pg = plan_of(config, "gl");
    image ov[HBIL_MAX_TEXTURES], og[HBIL_MAX_TEXTURES];
    uint32_t t;
    memset(ov, 0, sizeof ov);
    memset(og, 0, sizeof og);
    run(vulkan, &pv, cap, ov);
    run(gl, &pg, cap, og);
    for (t = 0; t < pv.texture_count; ++t) {
        if (pv.textures[t].life == HBIL_LIFE_OUTPUT) same_image(where, pv.textures[t].name, &ov[t], &og[t]);
        image_free(&ov[t]);
        image_free(&og[t]);
    }
}

#define ALL "outputs=ao+near+bent+composite "
#define EVERYTHING "outputs=ao+uniform_ao+bent+cone+near+sh+far+irradiance+specular_occlusion+composite f0=rgb "

static void backends_agree_on_the_built_in_scene(void **state)
{
    static const char *const configs[] = { ALL, ALL "reach=1 noise=ign slices=2", ALL "normals=depth depth=device depth_direction=reversed",
        ALL "normals=world spacing=geometric noise=none slices=1", "outputs=ao steps=12",
        "outputs=composite depth=device depth_far=infinite", EVERYTHING "environment=cube multisample=yes sample=2",
        EVERYTHING "environment=probes", EVERYTHING "environment=hook", "outputs=ao+multi_bounce",
        EVERYTHING "environment=sh estimator=bitmask far_visibility=free_bits",
        "outputs=ao+far environment=constant estimator=hbao", "outputs=ao estimator=hbao_plus" };
    static const int sizes[][2] = { { 160, 90 }, { 37, 61 }, { 1, 1 } };
    size_t i, k;
    (void)state;
    for (k = 0; k < sizeof sizes / sizeof sizes[0]; ++k) {
        capture cap;
        if (!capture_scene(&cap, "cornell", sizes[k][0], sizes[k][1], 0, NULL, error, sizeof error)) fail_msg("%s", error);
        for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) compare(configs[i], &cap, configs[i]);
        capture_free(&cap);
    }
}

static void backends_agree_on_all_captures(void **state)
{
    const capture_names list = captures_list();
    int i, frame;
    (void)state;
    if (!list.count) {
        print_message("skipped: HBIL_CAPTURES is not set, or holds no frame\n");
        skip();
    }
    for (i = 0; i < list.count; ++i)
        for (frame = 0; captures_has(list.name[i], frame); ++frame) {
            char where[80];
            capture cap;
            snprintf(where, sizeof where, "%s %03d", list.name[i], frame);
            if (!captures_load(list.name[i], frame, &cap, error, sizeof error)) fail_msg("%s", error);
            compare(where, &cap, ALL);
            capture_free(&cap);
        }
}

/* On every second pixel of the first frame of every capture (HBIL_LONG=1: on all). The sample counts of `reference` are for patience; its
 * code is the same with fewer. */
static void backends_agree_on_all_presets(void **state)
{
    const capture_names list = captures_list();
    int i, k;
    (void)state;
    if (!list.count) {
        print_message("skipped: HBIL_CAPTURES is not set, or holds no frame\n");
        skip();
    }
    for (i = 0; i < list.count; ++i) {
        capture cap;
        if (strstr(list.name[i], "-move") && !getenv("HBIL_LONG")) continue; /* another capture's scene, seen on the way */
        if (!captures_load(list.name[i], 0, &cap, error, sizeof error)) fail_msg("%s", error);
        assert_true(getenv("HBIL_LONG") || decimate(&cap, 2));
        for (k = 0; hbil_preset_name(k); ++k) {
            hbil_config c;
            char where[80], text[2048];
            memset(&c, 0, sizeof c);
            assert_int_equal(hbil_config_preset(hbil_preset_name(k), &c, NULL), HBIL_OK);
            if (c.slices > 8) c.slices = 4;
            if (c.steps > 16) c.steps = 12;
            hbil_config_print(&c, 0, text, sizeof text, NULL);
            snprintf(where, sizeof where, "%s %s", list.name[i], hbil_preset_name(k));
            compare(where, &cap, text);
        }
        capture_free(&cap);
    }
}

/* A row of the option matrix made fit for this test's frame. */
static void make_fit(hbil_config *c)
{
    if (c->width) c->width = 32, c->height = 18;
    if (c->projection == HBIL_PROJECTION_ORTHOGRAPHIC) c->projection = 0; /* this scene's camera is perspective */
    c->slices = c->slices > 4 ? 4 : c->slices;
    c->steps = c->steps > 16 ? 16 : c->steps;
    /* three slices without noise look exactly between two pixels (cos 60 degrees = 1/2), and a tie may go either way */
    if (c->noise == HBIL_NOISE_NONE && (c->slices == 0 || c->slices == 3)) c->slices = 4;
    if (c->roughness > 0 && c->roughness < 0.2f) c->roughness = 0.2f; /* a narrow lobe magnifies the rounding of 1 - ao */
    if (c->storage == HBIL_STORAGE_HALF) c->near_intensity = c->far_intensity = 0; /* above 4 a half float has no step of 2e-3 */
    c->sample %= RUNNER_SAMPLES;
    c->sky_depth = 0;
    c->target = c->stage = 0;
}

/* Rows of the option matrix in which every value of every option has run on both devices (HBIL_LONG=1: half of all rows); the text is
 * checked by the glsl tests. */
static void options_run_on_both_backends(void **state)
{
    static hbil_config configs[MATRIX_ROWS];
    const int by = getenv("HBIL_LONG") ? 2 : 1;
    int k, n = matrix_pairwise(configs), ran = 0;
    capture cap;
    (void)state;
    if (!capture_scene(&cap, "cornell", 32, 18, 0, NULL, error, sizeof error)) fail_msg("%s", error);
    for (k = 0; k < n; ++k) make_fit(&configs[k]);
    if (!getenv("HBIL_LONG")) n = matrix_cover(configs, n);
    for (k = 0; k < n; k += by) {
        char text[2048];
        hbil_config_print(&configs[k], 0, text, sizeof text, NULL);
        compare(text, &cap, text);
        ++ran;
    }
    capture_free(&cap);
    print_message("%d configs on both\n", ran);
}

/* Each lever of the frames, alone and together, with history to carry. */
static void backends_agree_over_frames(void **state)
{
    static const char *const configs[] = { "filter=3x3", "filter=5x5 filter_passes=3", "temporal=yes", "temporal=yes rectify=range",
        "temporal=yes rectify=none reproject=gather", "temporal=yes reproject=scatter", "bounces=recursive",
        "bounces=recursive reproject=scatter", "downscale=2", "downscale=4 filter=3x3", "storage=half arithmetic=half filter=5x5",
        "temporal=yes filter=5x5 filter_passes=2 bounces=recursive reproject=scatter downscale=2 storage=half",
        "march=sweep temporal=yes bounces=recursive filter=3x3 downscale=2", "slices=1 temporal=yes filter=5x5" };
    capture film[MOVES];
    size_t i;
    int f;
    (void)state;
    make_film(film);
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) {
        char config[256];
        image ov[HBIL_MAX_TEXTURES], og[HBIL_MAX_TEXTURES];
        hbil_plan pv, pg;
        uint32_t t;
        snprintf(config, sizeof config, ALL "%s", configs[i]);
        pv = plan_of(config, "vulkan");
        pg = plan_of(config, "gl");
        memset(ov, 0, sizeof ov);
        memset(og, 0, sizeof og);
        run_moves(vulkan, &pv, film, ov);
        run_moves(gl, &pg, film, og);
        for (t = 0; t < pv.texture_count; ++t) {
            if (pv.textures[t].life == HBIL_LIFE_OUTPUT) same_image(configs[i], pv.textures[t].name, &ov[t], &og[t]);
            image_free(&ov[t]);
            image_free(&og[t]);
        }
    }
    for (f = 0; f < MOVES; ++f) capture_free(&film[f]);
}

static void no_validation_message(void **state)
{
    (void)state;
    assert_int_equal(runner_messages(vulkan), 0);
    assert_int_equal(runner_messages(gl), 0);
}

static int set_up(void **state)
{
    (void)state;
    vulkan = runner_open("vulkan", 1, error, sizeof error);
    if (!vulkan) print_error("%s\n", error);
    gl = runner_open("gl", 1, error, sizeof error);
    if (!gl) print_error("%s\n", error);
    if (!vulkan || !gl || !runner_hook(vulkan, hook) || !runner_hook(gl, hook)) return -1;
    print_message("vulkan: %s, %s\ngl: %s, %s\n", runner_about(vulkan)->device, runner_about(vulkan)->driver,
                  runner_about(gl)->device, runner_about(gl)->driver);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    runner_close(vulkan);
    runner_close(gl);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(backends_agree_on_the_built_in_scene),
        cmocka_unit_test(backends_agree_on_all_captures),
        cmocka_unit_test(backends_agree_on_all_presets),
        cmocka_unit_test(options_run_on_both_backends),
        cmocka_unit_test(backends_agree_over_frames),
        cmocka_unit_test(no_validation_message),
    };
    return cmocka_run_group_tests_name("backends", tests, set_up, tear_down);
}
