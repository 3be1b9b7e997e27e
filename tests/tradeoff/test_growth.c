/* test_growth.c - the law that times are held against, and marches without their arithmetic: that they read what the
 * marches read, and do nothing else. Includes bound.c, whose texts it breaks. Exit code 77 without Vulkan. */
#include <math.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"

static hbil_result emit_broken(const hbil_plan *plan, int32_t pass, char *buf, size_t cap, size_t *need);
#define hbil_emit_glsl emit_broken
#include "../../examples/tradeoff/bound.c"
#undef hbil_emit_glsl

#include "../../backends/hbil_glslang.h"
#include "../../shadergen/cost.h"
#include "growth.h"

#define WORDS_MAX 65536

static settings s;
static capture  frame;
static subject  fence = {"scene:fence", &frame, 1};
static runner  *device;

/* ---- the fit */

/* times: slices 1 2 4 x steps 2 8 x pixels 1000 4000. */
static int make_points(growth_point points[12], double constant, double sample, double slice)
{
    int i;

    for (i = 0; i < 12; i++) {
        growth_point *p = &points[i];

        p->slices = 1 << i % 3;
        p->steps = i / 3 % 2 ? 8.0 : 2.0;
        p->pixels = i / 6 ? 4000.0 : 1000.0;
        p->ms = p->pixels * (constant + sample * p->slices * p->steps + slice * p->slices);
    }
    return 12;
}

static void a_sum_of_known_terms_is_found(void **state)
{
    growth_point points[12];
    double       factor[GROWTH_TERMS];
    int          i, count = make_points(points, 3e-5, 2e-6, 0.0);

    (void)state;
    assert_true(growth_fit(points, count, 2, factor) < 1e-9);
    assert_true(fabs(factor[0] / 3e-5 - 1.0) < 1e-9 && fabs(factor[1] / 2e-6 - 1.0) < 1e-9 && factor[2] == 0.0);
    make_points(points, 3e-5, 2e-6, 2e-5);
    assert_true(growth_fit(points, count, 2, factor) > 0.1); /* two terms cannot say it */
    assert_true(growth_fit(points, count, 3, factor) < 1e-9);
    assert_true(fabs(factor[2] / 2e-5 - 1.0) < 1e-9);
    for (i = 0; i < count; i++) points[i].ms += 0.05; /* what a frame takes once */
    assert_true(growth_fit(points, count, 3, factor) > 0.1);
    assert_true(growth_fit(points, count, 4, factor) < 1e-9 && fabs(factor[3] / 0.05 - 1.0) < 1e-9);
    for (i = 0; i < count; i++) assert_true(fabs(points[i].predicted / points[i].ms - 1.0) < 1e-9);
}

static void what_does_not_grow_so_is_off(void **state)
{
    growth_point points[12];
    double       factor[GROWTH_TERMS];
    int          i, count = make_points(points, 3e-5, 2e-6, 0.0);

    (void)state;
    points[5].ms *= 1.5;
    assert_true(growth_fit(points, count, 4, factor) > 0.1);
    for (i = 0; i < count; i++) points[i].ms = pow(points[i].slices * points[i].steps, 2.0) * points[i].pixels;
    assert_true(growth_fit(points, count, 3, factor) > 0.3);
    for (i = 0; i < count; i++) points[i].steps = 1.0;
    assert_true(isinf(growth_fit(points, count, 3, factor))); /* slices x steps is slices */
    assert_true(isfinite(growth_fit(points, count, 2, factor)));
    for (i = 0; i < count; i++) {
        points[i].steps = 0.0;
        points[i].pixels = 1000.0;
    }
    assert_true(isinf(growth_fit(points, count, 3, factor))); /* of one size, a frame's time is its pixels' */
    assert_true(isfinite(growth_fit(points, count, 2, factor)));
}

/* ---- texts */

static const char *broken; /* a statement that the texts have otherwise; NULL: they are as they should be */

static hbil_result emit_broken(const hbil_plan *plan, int32_t pass, char *buf, size_t cap, size_t *need)
{
    const hbil_result result = hbil_emit_glsl_hook(plan, pass, NULL, buf, cap, need, NULL);
    char             *found = broken && buf ? strstr(buf, broken) : NULL;

    if (found) found[0] = ' ';
    return result;
}

static void plan_of(const char *config, hbil_plan *plan)
{
    char        error[512];
    hbil_config c;

    if (!config_make(&s, config, 0, subject_judged(&fence), &c, error, sizeof error)) fail_msg("%s: %s", config, error);
    assert_int_equal(hbil_plan_build(&c, plan, NULL), HBIL_OK);
}

/* Calls for every pass of every preset but reference that marches. */
static void each_pass(void (*call)(const hbil_plan *plan, const char *preset, const char *pass))
{
    static const char *const passes[] = {"sweep", "march"};
    static hbil_plan plan;
    const char      *name;
    int32_t          i, k;

    for (i = 0; (name = hbil_preset_name(i)) != NULL; i++) {
        if (strcmp(name, "reference") == 0) continue;
        plan_of(name, &plan);
        for (k = 0; k < 2; k++)
            if (hbil_plan_pass(&plan, passes[k]) >= 0) call(&plan, name, passes[k]);
    }
}

static void a_seam_that_is_gone_is_an_error(void **state)
{
    static const struct { const char *preset, *pass; int seams; } cases[] = {
        {"sampled", "march", 5}, {"bitmask", "march", 6}, {"hbao", "march", 3}, {"fast", "sweep", 2}};
    static hbil_plan plan, made;
    char             error[512], *text;
    size_t           i, k;
    int              gone;

    (void)state;
    for (k = 0; k < sizeof cases / sizeof *cases; k++) {
        plan_of(cases[k].preset, &plan);
        for (i = 0, gone = 0; i < sizeof seams / sizeof *seams; i++) {
            broken = seams[i].from;
            text = bound_text(&plan, cases[k].pass, BOUND_PROOF, &made, error, sizeof error);
            if (!text && strstr(error, seams[i].from)) gone++;
            free(text);
        }
        broken = NULL;
        assert_int_equal(gone, cases[k].seams);
    }
}

static void what_cannot_be_stood_for_is_refused(void **state)
{
    static hbil_plan plan, made;
    char             error[512], *text;

    (void)state;
    plan_of("slices=5 steps=9", &plan); /* two sides a channel: eight */
    assert_null(bound_text(&plan, "march", BOUND_BARE, &made, error, sizeof error));
    assert_non_null(strstr(error, "decisions"));
    plan_of("slices=4 steps=9", &plan);
    text = bound_text(&plan, "march", BOUND_BARE, &made, error, sizeof error);
    assert_non_null(text);
    free(text);
    assert_null(bound_text(&plan, "sweep", BOUND_BARE, &made, error, sizeof error));
}

/* ---- what is left of them, by shadergen's count */

static void count(const hbil_plan *plan, const char *pass, const char *text, cost_counts *all)
{
    static uint32_t words[WORDS_MAX];
    static cost     c;
    char            log[512];
    size_t          need;
    int             i, k;

    if (hbil_glslang_optimize(text, HBIL_TARGET_VULKAN, words, WORDS_MAX, &need, log, sizeof log) != HBIL_GLSLANG_OK)
        fail_msg("%s", log);
    if (!cost_of_words(plan, hbil_plan_pass(plan, pass), words, need, &c)) fail_msg("%s", c.error);
    *all = c.fixed;
    for (i = 0; i < c.loops; i++) {
        for (k = 0; k < COST_ACCESSES; k++) all->access[k] += c.step[i].access[k];
        for (k = 0; k < COST_CLASSES; k++) all->ops[k] += c.step[i].ops[k];
    }
}

static void accesses_stay_and_arithmetic_goes(const hbil_plan *plan, const char *preset, const char *pass)
{
    static hbil_plan made;
    cost_counts      real, bare;
    char             error[512], *text = emit(plan, hbil_plan_pass(plan, pass));
    const double     record = hbil_plan_pass(plan, "sweep") < 0 && (plan->config.outputs & HBIL_OUTPUTS_NEAR);
    int              k;

    count(plan, pass, text, &real);
    free(text);
    text = bound_text(plan, pass, BOUND_BARE, &made, error, sizeof error);
    if (!text) fail_msg("%s: %s", preset, error);
    count(&made, pass, text, &bare);
    free(text);
    assert_true(bare.access[COST_FETCH] == real.access[COST_FETCH] + record);
    assert_true(bare.access[COST_LOAD] == real.access[COST_LOAD] && bare.access[COST_STORE] == real.access[COST_STORE]);
    for (k = 0; k < HBIL_MAX_TEXTURES; k++) assert_true(bare.texture[COST_STORE][k] == real.texture[COST_STORE][k]);
    assert_true(bare.ops[COST_FLOAT] < 0.5 * real.ops[COST_FLOAT]);
    assert_true(bare.ops[COST_ROOT] <= 6.0 * plan->config.slices); /* the reach of a side has some, samples none */
}

static void texts_without_arithmetic(void **state)
{
    (void)state;
    each_pass(accesses_stay_and_arithmetic_goes);
}

/* ---- on a device */

static void light(const char *config, lit *l)
{
    char        error[512];
    hbil_config c;

    if (!config_make(&s, config, 0, subject_judged(&fence), &c, error, sizeof error)
        || !lit_open(l, device, &s, &c, &fence, error, sizeof error)) fail_msg("%s: %s", config, error);
}

static void reads_the_same_texels(const hbil_plan *plan, const char *preset, const char *pass)
{
    static lit l;
    bound      b;
    char       error[512];

    (void)plan;
    light(preset, &l);
    if (bound_make(&l, pass, &b, error, sizeof error) != TRADE_DONE) fail_msg("%s: %s", preset, error);
    assert_true(b.reads > 3.0);
    bound_free(&b);
    lit_close(&l);
}

static void every_preset_reads_the_same_texels(void **state)
{
    (void)state;
    each_pass(reads_the_same_texels);
}

/* A record of other decisions leads to other reads, and is found out. */
static void other_reads_are_found_out(void **state)
{
    static lit l;
    image      record, trace[2];
    char       error[512];
    double     reads;
    int        i;

    (void)state;
    light("sampled", &l);
    for (i = 0; i < 2; i++) {
        if (i == 1) record.data[4 * (record.width * 14 + 24)] += 1.0f; /* the first sample of a pixel in the middle */
        assert_true(run_traced(&l, "march", i ? BOUND_PROOF : BOUND_RECORD, &trace[i], &record, error, sizeof error));
    }
    assert_false(same_reads(&l, hbil_plan_pass(&l.plan, "march"), &trace[0], &trace[1], &reads));
    assert_true(same_reads(&l, hbil_plan_pass(&l.plan, "march"), &trace[0], &trace[0], &reads));
    for (i = 0; i < 2; i++) image_free(&trace[i]);
    image_free(&record);
    lit_close(&l);
}

static int close_all(void **state)
{
    (void)state;
    hbil_glslang_shutdown();
    runner_close(device);
    capture_free(&frame);
    settings_free(&s);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sum_of_known_terms_is_found), cmocka_unit_test(what_does_not_grow_so_is_off),
        cmocka_unit_test(a_seam_that_is_gone_is_an_error), cmocka_unit_test(what_cannot_be_stood_for_is_refused),
        cmocka_unit_test(texts_without_arithmetic), cmocka_unit_test(every_preset_reads_the_same_texels),
        cmocka_unit_test(other_reads_are_found_out),
    };
    char error[512];

    settings_default(&s);
    device = runner_open("vulkan", 0, error, sizeof error);
    if (!device) {
        printf("skipped: %s\n", error);
        return 77;
    }
    if (!hbil_glslang_init() || !environment_parse(&s.light, s.env, error, sizeof error)
        || !capture_scene(&frame, "fence", 48, 28, 0, NULL, error, sizeof error)) return 1;
    return cmocka_run_group_tests_name("growth", tests, NULL, close_all);
}
