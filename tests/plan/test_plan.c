/* test_plan.c - the null backend proves every plan of the pairwise matrix, and finds every kind of broken plan. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../matrix.h"
#define HBIL_NULL_IMPLEMENTATION
#include "../../backends/hbil_null.h"

static hbil_config configs[MATRIX_ROWS];

static void null_backend_passes_over_the_matrix_and_odd_sizes(void **state)
{
    static const uint32_t sizes[][2] = { { 1, 1 }, { 3, 5 }, { 1919, 1079 }, { 16384, 1 }, { 8, 8 } };
    int k, n = matrix_pairwise(configs);
    size_t s;
    (void)state;
    for (k = 0; k < n; ++k)
        for (s = 0; s < sizeof sizes / sizeof sizes[0]; ++s) {
            hbil_plan plan;
            hbil_diag item;
            hbil_diags diags = { &item, 1, 0 };
            uint32_t w = sizes[s][0], h = sizes[s][1];
            configs[k].width = configs[k].width ? (int32_t)w : 0; /* a baked size is this one */
            configs[k].height = configs[k].height ? (int32_t)h : 0;
            assert_int_equal(hbil_plan_build(&configs[k], &plan, NULL), HBIL_OK);
            if (hbil_null_check(&plan, w, h, &diags)) fail_msg("%s", item.text);
        }
    print_message("%d configs x %d sizes\n", n, (int)(sizeof sizes / sizeof sizes[0]));
}

static hbil_plan full_plan(hbil_target target)
{
    hbil_config c;
    hbil_plan plan;
    memset(&c, 0, sizeof c);
    c.target = (int32_t)target;
    c.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR | HBIL_OUTPUTS_BENT | HBIL_OUTPUTS_COMPOSITE;
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    return plan;
}

static void finds(const hbil_plan *plan, const char *what)
{
    hbil_diag items[16];
    hbil_diags diags = { items, 16, 0 };
    int i;
    assert_true(hbil_null_check(plan, 640, 360, &diags) > 0);
    for (i = 0; i < diags.count && i < 16; ++i)
        if (strstr(items[i].text, what)) return;
    fail_msg("not found: %s (first: %s)", what, items[0].text);
}

static void null_backend_finds_each_fault(void **state)
{
    hbil_plan good = full_plan(HBIL_TARGET_VULKAN), p;
    int32_t march = hbil_plan_pass(&good, "march"), light = hbil_plan_pass(&good, "light");
    uint32_t b;
    (void)state;
    for (b = 0; b < good.passes[march].barrier_count; ++b) { /* each missing barrier */
        p = good;
        p.passes[march].barriers[b] = p.passes[march].barriers[--p.passes[march].barrier_count];
        finds(&p, "no barrier between write and read");
    }
    p = good;
    p.passes[0].barrier_count = 0;
    finds(&p, "no barrier between read and write");
    p = good;
    p.passes[light].barriers[p.passes[light].barrier_count++] = p.passes[march].barriers[0];
    finds(&p, "barrier without need");
    p = good;
    p.passes[march].barriers[0].before = HBIL_ACCESS_SAMPLE;
    finds(&p, "no barrier between write and read");
    p = good;
    p.passes[march].bindings[1].slot = p.passes[march].bindings[0].slot;
    finds(&p, "slot used twice");
    p = good;
    p.passes[march].bindings[0].slot = (uint16_t)p.constants_slot;
    finds(&p, "slot of the uniform block");
    p = good;
    p.passes[march].bindings[0].age = 1;
    finds(&p, "age is not below copies");
    p = good;
    p.passes[march].bindings[0].mip = 3;
    finds(&p, "mip is not below mips");
    p = good;
    p.passes[march].bindings[0].texture = 99;
    finds(&p, "does not exist");
    p = good;
    p.passes[0].bindings[p.passes[0].binding_count] = p.passes[march].bindings[0];
    p.passes[0].bindings[p.passes[0].binding_count++].slot = 9;
    finds(&p, "read and written by one pass");
    p = good; /* march before prepare */
    p.passes[0] = good.passes[march];
    p.passes[march] = good.passes[0];
    finds(&p, "read before it is written");
    p = good;
    p.pass_count = 1;
    finds(&p, "no pass uses it");
    p = good;
    p.passes[march].group[0] = 0;
    finds(&p, "out of range");
    p = good;
    p.textures[0].copies = 0;
    finds(&p, "at least 1");
    p = good;
    p.passes[march].bindings[0].role = HBIL_ROLE_UPDATE;
    finds(&p, "update, but not written");
    p = full_plan(HBIL_TARGET_GL);
    p.passes[march].bindings[3].slot = 8;
    finds(&p, "more units than GL 4.3 promises");
    assert_int_equal(hbil_null_check(&good, 0, 5, NULL), 1);
    assert_int_equal(hbil_null_check(&good, 640, 360, NULL), 0);
}

static hbil_plan plan_of(const char *config)
{
    hbil_config c;
    hbil_plan plan;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    return plan;
}

/* The grid of a sweep: lines of the longer side in whole strides, two layers a slice; nothing else has such a grid. */
static void a_sweep_covers_every_line_of_both_sides(void **state)
{
    hbil_plan plan = plan_of("march=sweep slices=4 sweep_stride=3");
    const int32_t sweep = hbil_plan_pass(&plan, "sweep"), swept = hbil_plan_texture(&plan, "swept");
    hbil_dispatch grid[HBIL_MAX_PASSES];
    hbil_frame frame;
    int32_t i;
    (void)state;
    memset(&frame, 0, sizeof frame);
    frame.width = 95; /* 96 lines in strides of 3, which are 3 groups of 32 */
    frame.height = 7;
    assert_true(sweep >= 0 && swept >= 0);
    assert_int_equal(plan.textures[swept].layers, 8);
    assert_int_equal(plan.passes[sweep].grid, HBIL_GRID_LINES);
    for (i = 0; i < (int32_t)plan.pass_count; ++i) assert_true(i == sweep || plan.passes[i].grid == HBIL_GRID_PIXELS);
    assert_int_equal(hbil_plan_frame(&plan, &frame, grid), HBIL_OK);
    assert_int_equal(grid[sweep].groups[0], 3);
    assert_int_equal(grid[sweep].groups[1], 8);
    frame.width = 97; /* 99 lines: a fourth group */
    assert_int_equal(hbil_plan_frame(&plan, &frame, grid), HBIL_OK);
    assert_int_equal(grid[sweep].groups[0], 4);
    assert_int_equal(hbil_null_check(&plan, 97, 7, NULL), 0);
}

static void null_backend_finds_each_wrong_shape(void **state)
{
    static const struct { const char *texture; int dim, layers, mips; const char *what; } wrong[] = {
        { "ao", 0, 1, 1, "dim is no hbil_dim" },
        { "ao", HBIL_DIM_3D + 1, 1, 1, "dim is no hbil_dim" },
        { "ao", HBIL_DIM_CUBE, 1, 1, "only an input" },
        { "view_depth", HBIL_DIM_2D_MULTISAMPLE, 1, 1, "only an input" },
        { "ao", HBIL_DIM_2D, 0, 1, "layers must be at least 1" },
        { "sh", HBIL_DIM_2D_ARRAY, 0, 1, "layers must be at least 1" },
        { "sh", HBIL_DIM_2D, 4, 1, "layers, but dim is not 2D_ARRAY" },
        { "sky", HBIL_DIM_CUBE, 6, 1, "layers, but dim is not 2D_ARRAY" },
        { "depth", HBIL_DIM_2D_MULTISAMPLE, 1, 2, "no mips" } };
    hbil_plan good = plan_of("outputs=ao+sh+far environment=cube multisample=yes sample=2"), p;
    uint16_t sky = (uint16_t)hbil_plan_texture(&good, "sky");
    size_t i;
    (void)state;
    assert_int_equal(hbil_null_check(&good, 640, 360, NULL), 0);
    assert_int_equal(good.textures[sky].dim, HBIL_DIM_CUBE);
    assert_int_equal(good.textures[hbil_plan_texture(&good, "sh")].layers, 4);
    for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i) {
        hbil_texture *t = &good.textures[hbil_plan_texture(&good, wrong[i].texture)], kept = *t;
        t->dim = (uint16_t)wrong[i].dim;
        t->layers = (uint16_t)wrong[i].layers;
        t->mips = (uint16_t)wrong[i].mips;
        finds(&good, wrong[i].what);
        *t = kept;
    }
    p = good;
    p.passes[0].domain = sky;
    finds(&p, "size of your own");
    p = good;
    p.passes[0].hook = 1;
    finds(&p, "environment is not hook");
    p = good;
    p.passes[0].bindings[p.passes[0].binding_count].texture = sky;
    p.passes[0].bindings[p.passes[0].binding_count].slot = 9;
    p.passes[0].bindings[p.passes[0].binding_count++].access = HBIL_ACCESS_WRITE;
    finds(&p, "neither 2D nor 2D_ARRAY");
    p = plan_of("outputs=far environment=hook");
    assert_int_equal(hbil_null_check(&p, 640, 360, NULL), 0);
    assert_int_equal(p.passes[hbil_plan_pass(&p, "light")].hook, 1);
}

/* A history of two copies, by hand: read last frame's, write this frame's. */
static void null_backend_follows_history(void **state)
{
    hbil_plan p;
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    (void)state;
    memset(&p, 0, sizeof p);
    p.texture_count = p.pass_count = 1;
    p.config.target = HBIL_TARGET_GL;
    strcpy(p.textures[0].name, "history");
    p.textures[0].format = HBIL_FORMAT_R32F;
    p.textures[0].life = HBIL_LIFE_HISTORY;
    p.textures[0].div = p.textures[0].mips = 1;
    p.textures[0].copies = 2;
    p.textures[0].dim = HBIL_DIM_2D;
    p.textures[0].layers = 1;
    strcpy(p.passes[0].name, "blend");
    p.passes[0].group[0] = p.passes[0].group[1] = 8;
    p.passes[0].binding_count = 2;
    p.passes[0].bindings[0].access = HBIL_ACCESS_SAMPLE;
    p.passes[0].bindings[0].role = HBIL_ROLE_LAST;
    p.passes[0].bindings[0].age = 1;
    p.passes[0].bindings[1].access = HBIL_ACCESS_WRITE;
    p.passes[0].bindings[1].role = HBIL_ROLE_WRITE;
    p.passes[0].barrier_count = 2;
    p.passes[0].barriers[0].before = p.passes[0].barriers[1].after = HBIL_ACCESS_WRITE;
    p.passes[0].barriers[0].after = p.passes[0].barriers[1].before = HBIL_ACCESS_SAMPLE;
    if (hbil_null_check(&p, 64, 64, &diags)) fail_msg("%s", item.text);
    p.passes[0].bindings[0].age = 0;
    p.passes[0].bindings[0].role = HBIL_ROLE_SAMPLE;
    finds(&p, "read and written by one pass");
}

static void equal_configs_give_equal_bytes(void **state)
{
    hbil_config a, b;
    hbil_plan p, q;
    (void)state;
    memset(&a, 0, sizeof a);
    memset(&p, 0xaa, sizeof p);
    memset(&q, 0x55, sizeof q);
    assert_int_equal(hbil_config_resolve(&a, &b, NULL), HBIL_OK); /* zero and its defaults spelt out */
    assert_int_equal(hbil_plan_build(&a, &p, NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&b, &q, NULL), HBIL_OK);
    assert_memory_equal(&p, &q, sizeof p);
}

static void plan_names_stand_in_the_text(void **state)
{
    static char text[HBIL_GLSL_MAX];
    hbil_plan p = full_plan(HBIL_TARGET_VULKAN);
    uint32_t i, b;
    char name[32];
    (void)state;
    for (i = 0; i < p.pass_count; ++i) {
        assert_int_equal(hbil_emit_glsl(&p, (int32_t)i, text, sizeof text, NULL), HBIL_OK);
        assert_non_null(strstr(text, p.passes[i].name));
        for (b = 0; b < p.passes[i].binding_count; ++b) {
            snprintf(name, sizeof name, "u_%s;", p.textures[p.passes[i].bindings[b].texture].name);
            assert_non_null(strstr(text, name));
        }
    }
}

/* Sum of the whole numbers of "const int HBIL_LAYERS = 0 + 1 + 4;" and its comments; -1: no such constant. */
static int layers_in(const char *text)
{
    const char *at = strstr(text, "const int HBIL_LAYERS = 0");
    int sum = 0;
    if (!at) return -1;
    for (at += 25; *at != ';'; ++at) {
        if (at[0] == '/' && at[1] == '/') at = strchr(at, '\n');
        if (at[0] == '+') sum += atoi(at + 1);
    }
    return sum;
}

/* The core counts the layers of a signal for the textures, the text adds them up for its loops. */
static void layers_of_a_signal_are_those_of_the_text(void **state)
{
    static char text[HBIL_GLSL_MAX];
    int k, n = matrix_pairwise(configs), compared = 0;
    (void)state;
    for (k = 0; k < n; ++k) {
        hbil_plan p;
        uint32_t i, b;
        configs[k].environment = configs[k].environment == HBIL_ENVIRONMENT_HOOK ? 0 : configs[k].environment; /* its text is the engine's */
        if (hbil_plan_build(&configs[k], &p, NULL) != HBIL_OK) continue;
        for (i = 0; i < p.pass_count; ++i)
            for (b = 0; b < p.passes[i].binding_count; ++b) {
                const hbil_binding *bind = &p.passes[i].bindings[b];
                if (bind->role != HBIL_ROLE_FROM && bind->role != HBIL_ROLE_TO) continue;
                assert_int_equal(hbil_emit_glsl(&p, (int32_t)i, text, sizeof text, NULL), HBIL_OK);
                assert_int_equal(layers_in(text), p.textures[bind->texture].layers);
                ++compared;
            }
    }
    assert_true(compared > 100);
}

/* hbil.h, >>targets: the most that a pass writes. GL 4.3 has eight image units, no more. */
static void no_pass_writes_more_than_eight_images(void **state)
{
    static const char config[] = "target=gl outputs=ao+uniform_ao+bent+cone+near+sh+far+irradiance+specular_occlusion+composite "
        "estimator=bitmask environment=sh far_visibility=free_bits temporal=yes bounces=recursive reproject=scatter";
    hbil_config c;
    hbil_plan p;
    uint32_t i, b, most = 0;
    (void)state;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, sizeof config - 1, NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
    for (i = 0; i < p.pass_count; ++i) {
        uint32_t writes = 0;
        for (b = 0; b < p.passes[i].binding_count; ++b) writes += p.passes[i].bindings[b].access == HBIL_ACCESS_WRITE;
        if (writes > most) most = writes;
    }
    assert_int_equal(most, 8);
    if (hbil_null_check(&p, 640, 360, NULL)) fail_msg("the largest plan has a fault");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(null_backend_passes_over_the_matrix_and_odd_sizes),
        cmocka_unit_test(null_backend_finds_each_fault),
        cmocka_unit_test(a_sweep_covers_every_line_of_both_sides),
        cmocka_unit_test(null_backend_finds_each_wrong_shape),
        cmocka_unit_test(null_backend_follows_history),
        cmocka_unit_test(equal_configs_give_equal_bytes),
        cmocka_unit_test(plan_names_stand_in_the_text),
        cmocka_unit_test(layers_of_a_signal_are_those_of_the_text),
        cmocka_unit_test(no_pass_writes_more_than_eight_images),
    };
    return cmocka_run_group_tests_name("plan", tests, NULL, NULL);
}
