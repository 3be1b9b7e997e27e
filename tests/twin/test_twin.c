/* test_twin.c - the emitted text itself on the CPU: it computes what lavapipe does, touches no texel that is not there or not written,
 * divides by no zero and converts no NaN whatever the inputs are, and float is near double. `test_twin sanitized`: the hostile frames alone,
 * under UndefinedBehaviorSanitizer. HBIL_LONG=1: the pairwise matrix of all options, too. */

#define HBIL_IMPLEMENTATION
#include "../test.h"

#include <math.h>

#include "../extreme/contract.h"
#include "../gpu/compare.h"
#include "../matrix.h"
#include "twin.h"

#define ALL "outputs=ao+uniform_ao+bent+cone+near+sh+far+irradiance+specular_occlusion+composite "

/* Every pass, estimator, environment, storage and stage at least once. */
static const char *const configs[] = {
    ALL "environment=sh reach=2 f0=rgb firefly=5 ao_exponent=2",
    ALL "environment=probes estimator=bitmask occluder=thick far_visibility=free_bits facing=half_space noise=ign",
    ALL "environment=cube march=both estimator=bitmask occluder=thick reach=1 storage=half filter=3x3 filter_passes=3",
    "outputs=ao+near+sh+bent march=sweep slices=4 sweep_stride=2 facing=filter filter=5x5 normals=world",
    "outputs=ao+near mips=spread spacing=geometric downscale=2 temporal=yes depth=device depth_far=infinite depth_direction=reversed",
    "outputs=near+far environment=constant bounces=recursive reproject=scatter mips=weighted facing=half_space slices=1 filter=3x3 exponent=1.5",
    "outputs=ao+near+bent bounces=recursive temporal=yes rectify=range reproject=gather downscale=4 interleave=yes normals=depth",
    "outputs=near+ao occluder=heuristic gather=packed sampling=bilinear multisample=yes sample=2 normal_encoding=octahedral_888",
    "outputs=ao+far environment=hook far_visibility=direction projection=orthographic sampling=bilinear gather=side reach=2",
    "outputs=ao estimator=hbao reach=2 attenuation=linear filter=3x3 temporal=yes", "outputs=ao+multi_bounce estimator=hbao_plus reach=2",
    "outputs=ao+near arithmetic=half storage=half filter=5x5 downscale=2 slices=1",
    "outputs=ao+near+sh target=gl stage=fragment mips=mean estimator=bitmask filter=3x3 temporal=yes",
    "outputs=ao+near+bent seed_compat=screen_azimuth+slice_mean+noise_2pi+uniform_bent dynamic=slices+steps+exponent+pull+bias+near_intensity",
};
enum { CONFIGS = sizeof configs / sizeof configs[0] };

static twin *one, *two; /* float; double. sanitized: float; float as inaccurate as Vulkan allows, with NaN that sticks */
static runner *device;
static int sanitized, complaints; /* a test goes on to its end: one config's fault must not hide another's */

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void complain(const char *config, const char *format, ...)
{
    char text[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    print_message("%s: %s\n", config, text);
    ++complaints;
}

static void free_all(image images[HBIL_MAX_TEXTURES])
{
    int i;
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&images[i]);
}

/* Frame f of a film as the plan wants it, from an orthographic camera too: that sees the same depths as another scene. */
static void encode(const hbil_plan *plan, const capture *film, int f, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES])
{
    static hbil_plan p;
    p = *plan;
    p.config.projection = HBIL_PROJECTION_PERSPECTIVE;
    memset(inputs, 0, HBIL_MAX_TEXTURES * sizeof *inputs);
    if (!inputs_encode(&film[f], &p, frame, inputs, error, sizeof error)) fail_msg("%s", error);
    if (f > 0) capture_follow(frame, &film[f - 1]);
    frame->index = (uint32_t)f - 2;
    if (plan->config.projection == HBIL_PROJECTION_PERSPECTIVE) return;
    memcpy(frame->projection, test_frame(&plan->config, frame->width, frame->height).projection, sizeof frame->projection);
    memcpy(frame->last_projection, frame->projection, sizeof frame->projection);
}

static void run_twin(twin *t, const hbil_plan *plan, const hbil_frame *frame, const image *inputs, image *outputs)
{
    static char said[8192];
    assert_int_equal(twin_hook(t, hook), 1);
    if (!twin_run(t, plan, frame, inputs, outputs, said, sizeof said)) fail_msg("%s", said);
}

static void must_be_faultless(const char *config, twin *t)
{
    char why[2048];
    if (!twin_faultless(t, why, sizeof why)) complain(config, "%s", why);
}

/* Difference of an output in float and in double, of its largest value: maximum, and what one value in a thousand exceeds. */
static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void like_double(const char *config, const char *name, const image *img, const double *exact)
{
    const int n = img->width * img->height * image_slices(img) * img->channels;
    double *d = (double *)malloc((size_t)n * sizeof *d), most = 1;
    int i;
    assert_non_null(d);
    for (i = 0; i < n; ++i) most = fmax(most, fabs(exact[i]));
    for (i = 0; i < n; ++i) d[i] = fabs((double)img->data[i] - exact[i]) / most;
    qsort(d, (size_t)n, sizeof *d, ascending);
    /* 1: a horizon, a sector or a texel that rounding moves */
    if (!(d[n - 1 - n / 1000] <= 5e-2 && d[n - 1 - n / 20] <= 1e-3))
        complain(config, "%s in float is %.1e off double in 5 of 100 values, %.1e in 1 of 1000, %.1e at most", name, d[n - 1 - n / 20],
                 d[n - 1 - n / 1000], d[n - 1]);
    free(d);
}

static double mean_difference(const image *a, const image *b)
{
    const int n = a->width * a->height * image_slices(a) * a->channels;
    double sum = 0;
    int i;
    for (i = 0; i < n; ++i) sum += fabs((double)a->data[i] - (double)b->data[i]);
    return sum / n;
}

static void compare_outputs(const char *config, const hbil_plan *plan, const image *got, const image *expected)
{
    /* half floats: lavapipe cuts off what we round, and takes mediump for float */
    const int half = plan->config.arithmetic == HBIL_ARITHMETIC_HALF || plan->config.storage == HBIL_STORAGE_HALF;
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t) {
        if (!got[t].data) continue;
        like_double(config, plan->textures[t].name, &got[t], twin_output(two, (int32_t)t));
        if (expected[t].data && !half) same_image(config, plan->textures[t].name, &got[t], &expected[t]);
        if (expected[t].data && half && mean_difference(&got[t], &expected[t]) > 1e-3)
            complain(config, "%s is %.1e off the device", plan->textures[t].name, mean_difference(&got[t], &expected[t]));
    }
}

/* The film's frames in float, in double and on the device. */
static void compare_film(const char *config, const hbil_plan *plan, const capture *film)
{
    image inputs[HBIL_MAX_TEXTURES], outputs[3][HBIL_MAX_TEXTURES];
    const int with_device = device != NULL && plan->config.stage == HBIL_STAGE_COMPUTE;
    int f;
    for (f = 0; f < MOVES; ++f) {
        hbil_frame frame;
        memset(outputs, 0, sizeof outputs);
        encode(plan, film, f, &frame, inputs);
        run_twin(one, plan, &frame, inputs, outputs[0]);
        run_twin(two, plan, &frame, inputs, outputs[1]);
        if (with_device) runner_hook(device, hook);
        if (with_device && !runner_run(device, plan, &frame, inputs, outputs[2], 1, NULL, error, sizeof error)) fail_msg("%s", error);
        if (f == MOVES - 1) compare_outputs(config, plan, outputs[0], outputs[2]);
        free_all(inputs);
        free_all(outputs[0]);
        free_all(outputs[1]);
        free_all(outputs[2]);
    }
    must_be_faultless(config, one);
    must_be_faultless(config, two);
}

static void float_is_the_device_and_near_double(void **unused)
{
    static hbil_plan plan;
    capture film[MOVES];
    int i;
    (void)unused;
    complaints = 0;
    make_film(film);
    for (i = 0; i < CONFIGS; ++i) {
        plan = plan_of(configs[i], strstr(configs[i], "target=gl") ? "gl" : "vulkan");
        twin_forgive(one);
        twin_forgive(two);
        compare_film(configs[i], &plan, film);
    }
    for (i = 0; i < MOVES; ++i) capture_free(&film[i]);
    assert_int_equal(complaints, 0);
}

/* One value in `every` of all inputs becomes one that no renderer should send. */
static void make_hostile(image inputs[HBIL_MAX_TEXTURES], uint32_t seed, uint32_t every)
{
    const float worst[] = { NAN, INFINITY, -INFINITY, 1e-45f, -1e-45f, 1e-38f, 3e38f, -3e38f, 0.0f, -0.0f, -1.0f, 1e30f, -1e9f, 1e15f, 65520.0f, 1.0f };
    int t;
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) {
        const size_t n = inputs[t].data ? (size_t)inputs[t].width * (size_t)inputs[t].height * (size_t)image_slices(&inputs[t]) *
                                              (size_t)inputs[t].channels : 0;
        size_t i;
        for (i = 0; i < n; ++i) {
            const uint32_t r = (uint32_t)(inputs_random((uint32_t)i + seed, (uint32_t)t + 17u * seed) * 16777216.0f);
            if (r % every == 0) inputs[t].data[i] = worst[r / every % (sizeof worst / sizeof worst[0])];
        }
    }
}

static void hostile_frames(const char *config, const hbil_plan *plan, const capture *film)
{
    static const uint32_t every[] = { 10, 2, 10, 3 };
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    char why[512];
    twin *const both[] = { one, two };
    size_t k;
    int f;
    for (k = sanitized && !getenv("HBIL_LONG"); k < 2; ++k) { /* loose alone, which finds more: time */
        twin_forgive(both[k]);
        for (f = 0; f < MOVES; ++f) {
            hbil_frame frame;
            encode(plan, film, f, &frame, inputs);
            make_hostile(inputs, 3u + (uint32_t)f, every[f]);
            run_twin(both[k], plan, &frame, inputs, outputs);
            if (!contract_holds(plan, &frame, inputs, outputs, why, sizeof why))
                complain(config, "%s, frame %d: %s", k == 0 ? "float" : sanitized ? "float, loose, NaN sticks" : "double", f, why);
            free_all(inputs);
            free_all(outputs);
        }
        must_be_faultless(config, both[k]);
    }
}

static void small_film(capture film[MOVES])
{
    int f;
    for (f = 0; f < MOVES; ++f) {
        const float move[3] = { 0.08f * (float)f, 0.0f, 0.1f * (float)f };
        if (!capture_scene_from(&film[f], "cornell", move, 1.5f * (float)f, 41, 29, 0, NULL, error, sizeof error)) fail_msg("%s", error);
        if (f > 0) assert_true(capture_motion(&film[f], &film[f - 1]));
    }
}

static void hostile_frames_keep_the_contract_and_nothing_is_undefined(void **unused)
{
    static hbil_plan plan;
    capture film[MOVES];
    int i;
    (void)unused;
    complaints = 0;
    small_film(film);
    for (i = 0; i < CONFIGS; ++i) {
        plan = plan_of(configs[i], strstr(configs[i], "target=gl") ? "gl" : "vulkan");
        hostile_frames(configs[i], &plan, film);
    }
    for (i = 0; i < MOVES; ++i) capture_free(&film[i]);
    assert_int_equal(complaints, 0);
}

static void the_whole_matrix_keeps_the_contract(void **unused)
{
    static hbil_config matrix[MATRIX_ROWS];
    static hbil_plan plan;
    capture film[MOVES];
    char text[2048];
    int i, count;
    (void)unused;
    if (!getenv("HBIL_LONG")) skip();
    complaints = 0;
    small_film(film);
    count = matrix_pairwise(matrix);
    for (i = 0; i < count; ++i) {
        if (matrix[i].width || matrix[i].height) matrix[i].width = film[0].width, matrix[i].height = film[0].height;
        if (matrix[i].slices > 8) matrix[i].slices = 8;
        if (matrix[i].steps > 16) matrix[i].steps = 16;
        if (hbil_plan_build(&matrix[i], &plan, NULL) != HBIL_OK) continue;
        hbil_config_print(&matrix[i], 0, text, sizeof text, NULL);
        if (i % 10 == 0) print_message("config %d of %d\n", i, count);
        hostile_frames(text, &plan, film);
    }
    for (i = 0; i < MOVES; ++i) capture_free(&film[i]);
    assert_int_equal(complaints, 0);
}

/* Frame 1 of a film with history, spoiled or after a cut. */
static void second_frame(const hbil_plan *plan, const capture *film, const char *spoiled, image outputs[HBIL_MAX_TEXTURES])
{
    image inputs[HBIL_MAX_TEXTURES];
    hbil_frame frame;
    int f;
    for (f = 0; f < 2; ++f) {
        encode(plan, film, f, &frame, inputs);
        if (f == 1 && spoiled) twin_spoil(one, hbil_plan_texture(plan, spoiled));
        frame.reset = f == 0 || !spoiled;
        run_twin(one, plan, &frame, inputs, outputs);
        if (f == 0) free_all(outputs);
        free_all(inputs);
    }
}

/* What no shader of ours writes, and a fault of the driver or of a hook may: it is gone with the frame, as after a cut. */
static void spoiled_history_is_thrown_away(void **unused)
{
    static const struct { const char *config, *texture; } rows[] = {
        { "outputs=ao+near temporal=yes rectify=none slices=2 steps=4 reproject=camera", "signal" },
        { "outputs=ao+near temporal=yes rectify=none slices=2 steps=4 reproject=camera", "seen" },
        { "outputs=ao+near temporal=yes rectify=none slices=2 steps=4 reproject=scatter", "seen" },
        { "outputs=ao+near bounces=recursive slices=2 steps=4 reproject=scatter", "seen" },
    };
    static hbil_plan plan;
    capture film[MOVES];
    size_t i;
    uint32_t t;
    (void)unused;
    small_film(film);
    for (i = 0; i < sizeof rows / sizeof *rows; ++i) {
        image spoiled[HBIL_MAX_TEXTURES], cut[HBIL_MAX_TEXTURES];
        plan = plan_of(rows[i].config, "vulkan");
        twin_forgive(one);
        second_frame(&plan, film, rows[i].texture, spoiled);
        second_frame(&plan, film, NULL, cut);
        for (t = 0; t < plan.texture_count; ++t)
            if (cut[t].data)
                assert_memory_equal(spoiled[t].data, cut[t].data, (size_t)cut[t].width * (size_t)cut[t].height * (size_t)cut[t].channels * sizeof(float));
        must_be_faultless(rows[i].config, one);
        free_all(spoiled);
        free_all(cut);
    }
    for (i = 0; i < MOVES; ++i) capture_free(&film[i]);
}

/* What is beyond the limit of hbil-bounds: an option, and two outputs in half floats. */
static void what_rounding_moves_far_says_so_and_nothing_else_does(void **unused)
{
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    (void)unused;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 0);
    c.noise = HBIL_NOISE_IGN;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 1);
    assert_int_equal(item.severity, HBIL_NOTE);
    assert_int_equal(item.option, hbil_option_find("noise", 5, NULL));
    assert_non_null(strstr(item.text, "3e-3"));
    memset(&c, 0, sizeof c);
    c.filter = HBIL_FILTER_3X3;
    c.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_CONE;
    diags.count = 0;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 0);
    c.storage = HBIL_STORAGE_HALF;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 1);
    assert_int_equal(item.option, hbil_option_find("storage", 7, NULL));
    assert_non_null(strstr(item.text, "specular_occlusion by 3e-2"));
}

static int begin(void **unused)
{
    (void)unused;
    one = twin_open(TWIN_FLOAT, sanitized ? TWIN_SANITIZE : 0);
    two = twin_open(sanitized ? TWIN_FLOAT : TWIN_DOUBLE, sanitized ? TWIN_SANITIZE | TWIN_STICKY | TWIN_LOOSE : 0);
    if (!sanitized) {
        device = runner_open("vulkan", 0, error, sizeof error);
        if (!device) print_message("no Vulkan device, float against double alone: %s\n", error);
    }
    return one && two ? 0 : -1;
}

static int end(void **unused)
{
    (void)unused;
    twin_close(one);
    twin_close(two);
    runner_close(device);
    return 0;
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hostile_frames_keep_the_contract_and_nothing_is_undefined),
        cmocka_unit_test(the_whole_matrix_keeps_the_contract),
        cmocka_unit_test(float_is_the_device_and_near_double),
        cmocka_unit_test(spoiled_history_is_thrown_away),
        cmocka_unit_test(what_rounding_moves_far_says_so_and_nothing_else_does),
    };
    const struct CMUnitTest hostile[] = {
        cmocka_unit_test(hostile_frames_keep_the_contract_and_nothing_is_undefined),
        cmocka_unit_test(the_whole_matrix_keeps_the_contract),
    };
    sanitized = argc > 1 && strcmp(argv[1], "sanitized") == 0;
    return sanitized ? cmocka_run_group_tests(hostile, begin, end) : cmocka_run_group_tests(tests, begin, end);
}
