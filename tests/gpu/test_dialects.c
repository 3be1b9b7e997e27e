/* test_dialects.c - the same config as GLSL 4.30 and ESSL 3.10 compute shaders, and as GLSL 3.30 and ESSL 3.00 fragment shaders,
 * gives the same image; what a dialect cannot say is refused with the reason. */

#define HBIL_IMPLEMENTATION
#include "../test.h"

#include "compare.h"

static runner *gl, *gles;

typedef struct dialect { const char *name, *values; } dialect;

static const dialect others[] = { { "gl", "target=gl stage=fragment" }, { "gles", "target=gles" },
                                  { "gles", "target=gles stage=fragment" } };

static int refused, compared;

/* 1: *plan is there. 0: refused with a message that names a fix. */
static int plan_in(const char *config, const dialect *d, hbil_plan *plan)
{
    hbil_diag items[8];
    hbil_diags diags = { items, 8, 0 };
    hbil_config c;
    int i, fix = 0;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_config_parse(&c, d->values, strlen(d->values), NULL), HBIL_OK);
    if (hbil_plan_build(&c, plan, &diags) == HBIL_OK) return 1;
    for (i = 0; i < diags.count; ++i) fix |= items[i].severity == HBIL_ERROR && strstr(items[i].text, "; set ") != NULL;
    assert_true(fix);
    ++refused;
    return 0;
}

static void free_all(image images[HBIL_MAX_TEXTURES])
{
    int i;
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&images[i]);
}

/* Compute shaders of GL against the others. film[1] and later are used only if moves. */
static void compare_dialects(const char *config, const capture *film, int moves)
{
    static hbil_plan reference, plan;
    image expected[HBIL_MAX_TEXTURES], got[HBIL_MAX_TEXTURES];
    size_t k;
    uint32_t t;
    reference = plan_of(config, "gl");
    memset(expected, 0, sizeof expected);
    if (moves) run_moves(gl, &reference, film, expected);
    else run(gl, &reference, film, expected);
    for (k = 0; k < sizeof others / sizeof others[0]; ++k) {
        runner *r = others[k].name[2] ? gles : gl;
        char where[512];
        if (!plan_in(config, &others[k], &plan)) continue;
        if (r == gles && strstr(config, "multisample")) continue; /* the runner cannot fill such an input there */
        snprintf(where, sizeof where, "%s: %s", others[k].values, config);
        memset(got, 0, sizeof got);
        if (moves) run_moves(r, &plan, film, got);
        else run(r, &plan, film, got);
        for (t = 0; t < plan.texture_count; ++t) {
            int32_t same = hbil_plan_texture(&reference, plan.textures[t].name);
            /* ES takes mediump at its word: half floats, 2^-11 of a value each */
            double mean = r == gles && plan.config.arithmetic == HBIL_ARITHMETIC_HALF ? 2e-4 : 1e-5;
            if (plan.textures[t].life == HBIL_LIFE_OUTPUT) like_image(where, plan.textures[t].name, &expected[same], &got[t], mean);
        }
        ++compared;
        free_all(got);
    }
    free_all(expected);
}

static void dialects_agree_on_one_frame(void **state)
{
    static const char *const configs[] = { "outputs=ao+near+bent", "outputs=ao estimator=hbao reach=2", "outputs=ao estimator=hbao_plus",
        "outputs=ao+near+bent estimator=bitmask occluder=thick", "outputs=sh+uniform_ao estimator=bitmask", "outputs=sh",
        "outputs=ao+far environment=sh estimator=bitmask far_visibility=free_bits", "outputs=far environment=cube",
        "outputs=far environment=probes", "outputs=far+composite environment=hook", "outputs=cone+specular_occlusion f0=rgb",
        "outputs=ao+multi_bounce", "outputs=ao mips=spread", "outputs=ao+near mips=mean", "outputs=ao mips=weighted",
        "outputs=ao+near mips=nearest interleave=yes", "outputs=ao+near gather=side", "outputs=ao+near facing=half_space",
        "outputs=ao normals=depth depth=device depth_direction=reversed", "outputs=ao normals=world normal_encoding=octahedral_unorm",
        "outputs=ao+near multisample=yes sample=2", "outputs=ao+near slices=1 filter=5x5", "outputs=ao+near march=sweep filter=3x3",
        "outputs=ao+near dynamic=slices+steps+exponent", "outputs=ao+near width=97 height=61" };
    static const char *const small[] = { "outputs=ao+near mips=spread filter=3x3", "outputs=ao downscale=2", "outputs=ao+near" };
    static const int sizes[][2] = { { 97, 61 }, { 20, 17 }, { 1, 1 } };
    size_t i, k;
    (void)state;
    for (k = 0; k < sizeof sizes / sizeof sizes[0]; ++k) {
        capture cap;
        if (!capture_scene(&cap, "cornell", sizes[k][0], sizes[k][1], 0, NULL, error, sizeof error)) fail_msg("%s", error);
        if (k == 0) for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) compare_dialects(configs[i], &cap, 0);
        else for (i = 0; i < sizeof small / sizeof small[0]; ++i) compare_dialects(small[i], &cap, 0);
        capture_free(&cap);
    }
    print_message("%d compared, %d refused\n", compared, refused);
    assert_true(compared > 6 * refused);
}

static void dialects_agree_over_frames(void **state)
{
    static const char *const configs[] = { "outputs=ao temporal=yes filter=3x3", "outputs=ao+near temporal=yes reproject=gather",
        "outputs=ao+near+bent temporal=yes filter=5x5 filter_passes=3 storage=half", "outputs=near bounces=recursive",
        "outputs=near+composite bounces=recursive downscale=2 temporal=yes reproject=gather filter=3x3", "outputs=ao+near downscale=4",
        "outputs=near bounces=recursive reproject=scatter temporal=yes", "outputs=sh temporal=yes filter=3x3",
        "outputs=ao+near temporal=yes filter=3x3 arithmetic=half rectify=range" };
    capture film[MOVES];
    size_t i;
    int f;
    (void)state;
    make_film(film);
    compared = refused = 0;
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) compare_dialects(configs[i], film, 1);
    for (f = 0; f < MOVES; ++f) capture_free(&film[f]);
    print_message("%d compared, %d refused\n", compared, refused);
}

/* Each as fragments allow it: sampled instead of swept, gathered instead of scattered. `reference` has fewer samples: its code is the same. */
static void presets_agree(void **state)
{
    capture film[MOVES];
    int k, f;
    (void)state;
    make_film(film);
    compared = refused = 0;
    for (k = 0; hbil_preset_name(k); ++k) {
        hbil_config c;
        char text[2048];
        assert_int_equal(hbil_config_preset(hbil_preset_name(k), &c, NULL), HBIL_OK);
        if (c.slices > 8) c.slices = 4;
        if (c.steps > 16) c.steps = 12;
        if (c.march == HBIL_MARCH_SWEEP) hbil_config_set(&c, "march", "sampled", NULL);
        if (c.reproject == HBIL_REPROJECT_SCATTER) hbil_config_set(&c, "reproject", "gather", NULL);
        hbil_config_print(&c, 0, text, sizeof text, NULL);
        compare_dialects(text, film, c.temporal == HBIL_TEMPORAL_YES || c.bounces == HBIL_BOUNCES_RECURSIVE);
    }
    for (f = 0; f < MOVES; ++f) capture_free(&film[f]);
    print_message("%d compared, %d refused\n", compared, refused);
}

static void refusals_name_the_reason(void **state)
{
    static const struct { const char *config, *says; } rows[] = {
        { "stage=fragment", "Vulkan always has compute" },
        { "target=gl stage=fragment march=sweep", "a fragment writes its own pixel only" },
        { "target=gl stage=fragment reproject=scatter temporal=yes", "atomics" },
        { "target=gles stage=fragment multisample=yes", "no multisampled textures" },
        { "target=gles stage=fragment outputs=ao+sh filter=3x3", "draws into 5 layers, stage=fragment has 4 targets" },
        { "target=gl stage=fragment outputs=ao+uniform_ao+bent+near+sh temporal=yes", "draws into 16 layers, stage=fragment has 8 targets" } };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof rows / sizeof rows[0]; ++i) {
        hbil_diag items[8];
        hbil_diags diags = { items, 8, 0 };
        int k, said = 0;
        hbil_config c;
        hbil_plan plan;
        memset(&c, 0, sizeof c);
        assert_int_equal(hbil_config_parse(&c, rows[i].config, strlen(rows[i].config), NULL), HBIL_OK);
        assert_int_equal(hbil_plan_build(&c, &plan, &diags), HBIL_E_CONFIG);
        for (k = 0; k < diags.count; ++k) said |= strstr(items[k].text, rows[i].says) != NULL;
        if (!said) fail_msg("%s: %s", rows[i].config, items[0].text);
    }
}

static void no_message_of_the_driver(void **state)
{
    (void)state;
    assert_int_equal(runner_messages(gl), 0);
    assert_int_equal(runner_messages(gles), 0);
}

static int set_up(void **state)
{
    (void)state;
    gl = runner_open("gl", 1, error, sizeof error);
    if (!gl) print_error("%s\n", error);
    gles = runner_open("gles", 1, error, sizeof error);
    if (!gles) print_error("%s\n", error);
    if (!gl || !gles || !runner_hook(gl, hook) || !runner_hook(gles, hook)) return -1;
    print_message("gl: %s, %s\ngles: %s, %s\n", runner_about(gl)->device, runner_about(gl)->driver, runner_about(gles)->device,
                  runner_about(gles)->driver);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    runner_close(gl);
    runner_close(gles);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dialects_agree_on_one_frame),
        cmocka_unit_test(dialects_agree_over_frames),
        cmocka_unit_test(presets_agree),
        cmocka_unit_test(refusals_name_the_reason),
        cmocka_unit_test(no_message_of_the_driver),
    };
    return cmocka_run_group_tests_name("dialects", tests, set_up, tear_down);
}
