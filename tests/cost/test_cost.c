/* test_cost.c - the counts of shaders that were counted by hand, those of real plans against the formulas of their
 * loops, and broken SPIR-V, which must end in an error. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include "../../backends/hbil_glslang.h"
#include "../../shadergen/cost.h"

#define WORDS 65536

static uint32_t words[WORDS], broken[WORDS];
static char     text[HBIL_GLSL_MAX], log_text[4096];

/* ------------------------------------------------------------------------------------------ shaders counted by hand */

enum { A, B, C }; /* textures: sampled r32f, image rgba32f, image r32ui */

/* A pass with the bindings of head[] below, and the dynamic option steps = 9 in its uniform block. */
static hbil_plan plan_of_hand(void)
{
    static const hbil_binding bindings[3] = { { A, 1, HBIL_ACCESS_SAMPLE, 0, 0, HBIL_ROLE_SAMPLE },
        { B, 2, HBIL_ACCESS_WRITE, 0, 0, HBIL_ROLE_UPDATE }, { C, 3, HBIL_ACCESS_WRITE, 0, 0, HBIL_ROLE_UPDATE } };
    static const hbil_format formats[3] = { HBIL_FORMAT_R32F, HBIL_FORMAT_RGBA32F, HBIL_FORMAT_R32UI };
    hbil_plan p;
    int i;
    memset(&p, 0, sizeof p);
    p.config.steps = 9;
    p.pass_count = 1;
    p.texture_count = 3;
    p.constant_count = 1;
    p.constants[0].offset = 4;
    p.constants[0].option = hbil_option_find("steps", 5, NULL);
    p.passes[0].constants = 1;
    p.passes[0].grid = HBIL_GRID_PIXELS;
    p.passes[0].binding_count = 3;
    for (i = 0; i < 3; ++i) {
        p.passes[0].bindings[i] = bindings[i];
        p.textures[i].format = (uint16_t)formats[i];
        p.textures[i].div = p.textures[i].layers = 1;
    }
    return p;
}

static const char head[] =
    "#version 450\n"
    "layout(local_size_x = 8, local_size_y = 8) in;\n"
    "layout(binding = 0, std140) uniform F { int other; int steps; };\n"
    "layout(binding = 1) uniform sampler2D u_a;\n"
    "layout(binding = 2, rgba32f) uniform image2D u_b;\n"
    "layout(binding = 3, r32ui) uniform uimage2D u_c;\n"
    "shared float tile[64];\n"
    "vec4 tap(int i) { return texelFetch(u_a, ivec2(i, 7), 0); }\n"
    "void main() {\n"
    "    ivec2 p = ivec2(gl_GlobalInvocationID.xy);\n"
    "    vec4 s = vec4(0.0);\n";

static size_t compile_hand(const char *body, int optimize)
{
    size_t need = 0;
    hbil_glslang_result r;
    snprintf(text, sizeof text, "%s%s\n    imageStore(u_b, p, s);\n}\n", head, body);
    r = (optimize ? hbil_glslang_optimize : hbil_glslang_compile)(text, HBIL_TARGET_VULKAN, words, WORDS, &need,
                                                                  log_text, sizeof log_text);
    if (r != HBIL_GLSLANG_OK) fail_msg("%s\n%s", log_text, text);
    return need;
}

static cost count_hand(const char *body)
{
    const hbil_plan plan = plan_of_hand();
    cost c;
    if (!cost_of_words(&plan, 0, words, compile_hand(body, 1), &c)) fail_msg("%s: %s", body, c.error);
    return c;
}

static void is(double counted, double by_hand, const char *what, const char *body)
{
    if (counted < by_hand || counted > by_hand) fail_msg("%s: %g, by hand %g: %s", what, counted, by_hand, body);
}

static void fetches_of_loops_and_branches(void **state)
{
    static const struct { int fetches; const char *body; } cases[] = {
        { 0, "" },
        { 14, "for (int i = 0; i < 7; ++i) s += tap(i) * tap(i + 1);" },
        { 15, "for (int i = 0; i < 3; ++i) for (int k = 0; k < 5; ++k) s += tap(i * k);" },
        { 18, "for (int i = 0; i < 3; ++i) { s += tap(i); for (int k = 9; k > 4; --k) s += tap(i * k); }" },
        { 6, "for (uint i = 32u; i > 0u; i >>= 1) s += tap(int(i));" },
        { 4, "for (int i = -3; i <= 4; i += 2) s += tap(i);" },
        { 10, "for (float x = 0.0; x < 2.5; x += 0.25) s += tap(int(x));" },
        { 5, "int i = 0; do { s += tap(i); ++i; } while (i < 5);" },
        { 0, "for (int i = 7; i < 7; ++i) s += tap(i);" },
        /* the costliest side */
        { 3, "if (p.x > 3) s += tap(1) + tap(2); else s += tap(3) + tap(4) + tap(5);" },
        { 2, "if (p.x > 3) s += tap(1) + tap(2);" },
        { 4, "if (p.x > 3) s += tap(1); if (p.y > 3) s += tap(2) + tap(3);"
             "else { s -= tap(4); if (p.x > p.y) s -= tap(5) * tap(6); }" },
        { 3, "switch (p.x) { case 0: s += tap(1); break; case 1: s += tap(2) + tap(9); case 2: s += tap(3); break;"
             "default: break; }" },
        /* ways out that the data choose: the whole loop */
        { 8, "for (int i = 0; i < 8; ++i) { s += tap(i); if (s.x > 1.0) break; }" },
        { 16, "for (int i = 0; i < 8; ++i) { s += tap(i); if (s.x > 1.0) continue; s += tap(i + 9); }" },
        { 4, "for (int i = 0; i < 4 && s.x < 3.0; ++i) s += tap(i);" },
        { 5, "for (int i = 0; i < 4; ++i) if (s.x > float(i)) { s += tap(i); return; } else s += tap(-i);"
             "s += tap(3);" },
        { 1, "if (p.x > 100) { imageStore(u_b, p, vec4(1.0)); return; } s = tap(2);" },
        /* bounds from the plan: steps = 9 */
        { 9, "for (int i = 0; i < steps; ++i) s += tap(i);" },
        { 38, "for (int i = 0; i < 2 * steps + 1; ++i) s += tap(i) + tap(-i);" },
        { 63, "for (int k = 0; k < 7; ++k) for (int i = 0; i < steps; ++i) s += tap(i * k);" },
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const cost c = count_hand(cases[i].body);
        is(c.fixed.access[COST_FETCH], cases[i].fetches, "fetches", cases[i].body);
        is(c.fixed.texture[COST_FETCH][A], cases[i].fetches, "fetches of u_a", cases[i].body);
        is(c.fixed.bytes_read, 4 * cases[i].fetches, "bytes read", cases[i].body);
        is(c.fixed.access[COST_STORE], 1, "stores", cases[i].body);
        is(c.fixed.bytes_written, 16, "bytes written", cases[i].body);
        assert_int_equal(c.loops, 0);
    }
}

/* The fixed part, a step, and how often the loop is entered. */
static void loops_of_unknown_length_are_told_apart(void **state)
{
    static const struct { int fixed, step, entered; const char *body; } cases[] = {
        { 0, 1, 1, "while (s.x < 1.0) s += tap(int(s.x));" },
        { 2, 3, 1, "s = tap(1); while (s.x < 1.0) for (int i = 0; i < 3; ++i) s += tap(i); s *= tap(2);" },
        { 4, 2, 4, "for (int i = 0; i < 4; ++i) { s += tap(i); while (s.x < 1.0) s += tap(i) + tap(-i); }" },
        { 0, 1, 1, "for (int i = 0; i < other; ++i) s += tap(i);" }, /* a uniform that is no option */
        { 0, 1, 1, "for (int i = 0; i < p.x; ++i) s += tap(i);" },
        { 0, 1, 1, "for (int i = p.x; i < 7; ++i) s += tap(i);" },
        { 0, 1, 1, "for (int i = 0; i < 70000; ++i) s += tap(i);" }, /* longer than is run */
    };
    size_t i;
    cost c;
    (void)state;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        c = count_hand(cases[i].body);
        assert_int_equal(c.loops, 1);
        is(c.fixed.access[COST_FETCH], cases[i].fixed, "fetches outside", cases[i].body);
        is(c.step[0].access[COST_FETCH], cases[i].step, "fetches of a step", cases[i].body);
        is(c.fixed.enters[0], cases[i].entered, "entered", cases[i].body);
    }
    c = count_hand("while (s.x < 1.0) { s += tap(1);"
                   "for (int i = 0; i < 2; ++i) while (s.y < 1.0) s += tap(2) + tap(3); }");
    assert_int_equal(c.loops, 2); /* the outer one first */
    assert_true(c.step[0].access[COST_FETCH] == 1 && c.step[1].access[COST_FETCH] == 2);
    assert_true(c.fixed.enters[0] == 1 && c.fixed.enters[1] == 0 && c.step[0].enters[1] == 2);
}

static void arithmetic_by_class(void **state)
{
    static const struct { double n; int class; const char *body; } cases[] = {
        { 4, COST_ROOT, "s = sqrt(tap(1));" },
        { 1, COST_ROOT, "s.x = length(tap(1).xyz);" },
        { 5, COST_FLOAT, "s.x = length(tap(1).xyz);" },
        { 8, COST_FLOAT, "s.xyz = normalize(tap(1).xyz);" },
        { 7, COST_FLOAT, "s.x = dot(tap(1), tap(2));" },
        { 4, COST_FLOAT, "s = tap(1) * tap(2);" },
        { 8, COST_FLOAT, "s = tap(1) * tap(2) + tap(3);" }, /* whether the optimiser fuses them or not */
        { 12, COST_FLOAT, "s = mix(tap(1), tap(2), tap(3));" },
        { 28, COST_FLOAT, "s = mat4(tap(1), tap(2), tap(3), tap(4)) * tap(5);" },
        { 0, COST_FLOAT, "s = abs(-tap(1));" },
        { 3, COST_DIVIDE, "s.xyz = tap(1).xyz / tap(2).xyz;" },
        { 1, COST_DIVIDE, "s.x = float(p.x / p.y);" },
        { 0, COST_DIVIDE, "s.x = float(p.x / 3);" },
        { 1, COST_INTEGER, "s.x = float(p.x / 3);" },
        { 3, COST_INTEGER, "s.x = float((p.x << 2) ^ ~p.y);" },
        { 5, COST_TRANSCENDENTAL, "s = cos(tap(1)); s.x = pow(s.x, s.y);" },
        { 30, COST_TRANSCENDENTAL, "for (int i = 0; i < 10; ++i) s.xyz += exp2(tap(i).xyz);" },
        { 2, COST_CONVERT, "s.xy = vec2(p);" },
        { 4, COST_CONVERT, "s = floor(tap(1));" },
        { 4, COST_COMPARE, "s = max(tap(1), tap(2));" },
        { 8, COST_COMPARE, "s = clamp(tap(1), tap(2), tap(3));" },
        { 8, COST_COMPARE, "s = mix(tap(1), tap(2), lessThan(tap(3), tap(4)));" },
        { 8, COST_COMPARE, "for (int i = 0; i < 7; ++i) s += tap(i);" }, /* the last test, too */
        { 8, COST_BRANCH, "for (int i = 0; i < 7; ++i) s += tap(i);" },
        { 7, COST_INTEGER, "for (int i = 0; i < 7; ++i) s += tap(i);" },
        { 28, COST_FLOAT, "for (int i = 0; i < 7; ++i) s += tap(i);" },
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i)
        is(count_hand(cases[i].body).fixed.ops[cases[i].class], cases[i].n, "operations", cases[i].body);
}

static void images_and_shared_memory(void **state)
{
    const cost c = count_hand("s = imageLoad(u_b, p); uint old = imageAtomicMin(u_c, p, uint(s.x)); s.y = float(old);"
                              "for (int i = 0; i < 3; ++i) imageAtomicAdd(u_c, p + i, 1u);"
                              "tile[p.x] = s.x; barrier(); s.z = tile[p.y] + tile[p.x + 1];");
    (void)state;
    assert_true(c.fixed.access[COST_LOAD] == 1 && c.fixed.texture[COST_LOAD][B] == 1);
    assert_true(c.fixed.access[COST_ATOMIC] == 4 && c.fixed.texture[COST_ATOMIC][C] == 4);
    assert_true(c.fixed.bytes_read == 16 + 4 * 4 && c.fixed.bytes_written == 4 * 4 + 16);
    assert_true(c.fixed.shared == 3);
}

static void registers_hold_what_is_alive(void **state)
{
    const int none = count_hand("s = tap(p.x);").registers;
    const int four = count_hand("vec4 a = tap(1), b = tap(2), c = tap(3), d = tap(4); s = a * b * c * d;").registers;
    const int one = count_hand("s = tap(1); s *= tap(2); s *= tap(3); s *= tap(4);").registers;
    const int loop = count_hand("vec4 a = tap(1); for (int i = 0; i < 3; ++i) s += tap(i); s *= a;").registers;
    (void)state;
    assert_int_equal(none, 2 + 4);  /* p, a texel */
    assert_int_equal(one, 2 + 8);   /* p, the product, a texel */
    assert_int_equal(four, 2 + 16);
    assert_int_equal(loop, 2 + 4 + 1 + 4 + 4); /* p, a, i, s, a texel */
}

static void unoptimised_words_are_counted_too(void **state)
{
    const hbil_plan plan = plan_of_hand();
    cost c;
    size_t count = compile_hand("s = tap(1) + tap(2); if (s.x > 0.0) s += sin(tap(3));", 0);
    (void)state;
    assert_true(cost_of_words(&plan, 0, words, count, &c));
    assert_true(c.fixed.access[COST_FETCH] == 3 && c.fixed.ops[COST_TRANSCENDENTAL] == 4 && c.loops == 0);
    count = compile_hand("for (int i = 0; i < 7; ++i) s += tap(i);", 0);
    assert_true(cost_of_words(&plan, 0, words, count, &c));
    assert_true(c.loops == 1 && c.step[0].access[COST_FETCH] == 1 && c.fixed.access[COST_FETCH] == 0);
}

/* ------------------------------------------------------------------------------------------------------- real plans */

static hbil_plan plan_from(const char *config)
{
    hbil_config c;
    hbil_plan p;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
    return p;
}

static cost count_real(const char *config, const char *pass)
{
    const hbil_plan p = plan_from(config);
    cost c;
    assert_int_equal(cost_of_pass(&p, hbil_plan_pass(&p, pass), NULL, &c), DONE);
    return c;
}

/* Accesses of a texture; 0 where the plan has none. */
static double of(const cost_counts *c, const char *config, int access, const char *name)
{
    const hbil_plan p = plan_from(config);
    const int32_t t = hbil_plan_texture(&p, name);
    return t < 0 ? 0 : c->texture[access][t];
}

/* The pixel's own depth and normal, and of each sample a depth; of each rise a radiance, and with facing a normal. */
static void fetches_of_the_march_by_its_formula(void **state)
{
    static const struct { const char *config; int slices, steps, depths, normals, radiances; } cases[] = {
        { "outputs=ao+near", 3, 6, 1, 0, 1 },
        { "outputs=ao+near slices=6", 6, 6, 1, 0, 1 },
        { "outputs=ao+near slices=3 steps=12", 3, 12, 1, 0, 1 },
        { "outputs=ao+near slices=5 steps=7 dynamic=slices+steps", 5, 7, 1, 0, 1 },
        { "outputs=ao+near dynamic=steps", 3, 6, 1, 0, 1 },
        { "outputs=ao", 3, 6, 1, 0, 0 },
        { "outputs=ao slices=1 steps=1", 1, 1, 1, 0, 0 },
        { "outputs=ao slices=64 steps=1024", 64, 1024, 1, 0, 0 },
        { "outputs=ao+near+bent estimator=bitmask", 3, 6, 1, 0, 1 },
        { "outputs=ao estimator=hbao reach=2", 3, 6, 1, 0, 0 },
        { "outputs=ao+near facing=half_space", 3, 6, 1, 1, 1 },
        { "outputs=ao sampling=bilinear", 3, 6, 4, 0, 0 },
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof cases / sizeof cases[0]; ++i) {
        const char *config = cases[i].config;
        const cost c = count_real(config, "march");
        const int samples = 2 * cases[i].slices * cases[i].steps;
        const int each = cases[i].depths + cases[i].normals + cases[i].radiances;
        is(of(&c.fixed, config, COST_FETCH, "view_depth"), 1 + samples * cases[i].depths, "depths", config);
        is(of(&c.fixed, config, COST_FETCH, "view_normal"), 1 + samples * cases[i].normals, "normals", config);
        is(of(&c.fixed, config, COST_FETCH, "radiance"), samples * cases[i].radiances, "radiances", config);
        is(c.fixed.access[COST_FETCH], 2 + samples * each, "fetches", config);
    }
}

static void slices_and_steps_scale_the_arithmetic(void **state)
{
    const cost one = count_real("outputs=ao slices=2 steps=4", "march");
    const cost two = count_real("outputs=ao slices=4 steps=4", "march");
    const cost four = count_real("outputs=ao slices=8 steps=4", "march");
    const cost far = count_real("outputs=ao slices=2 steps=8", "march");
    int k;
    (void)state;
    for (k = 0; k < COST_CLASSES; ++k) { /* a slice costs the same wherever it is */
        is(four.fixed.ops[k] - two.fixed.ops[k], 2 * (two.fixed.ops[k] - one.fixed.ops[k]), "operations", "slices");
        assert_true(far.fixed.ops[k] >= one.fixed.ops[k]);
    }
    assert_true(two.fixed.ops[COST_FLOAT] > 1.8 * one.fixed.ops[COST_FLOAT]);
    assert_int_equal(one.registers, four.registers);
}

/* Each texture that a pass of pixels writes gets one texel a layer. */
static void bytes_written_are_those_of_the_bindings(void **state)
{
    static const char *const configs[] = { "", "outputs=ao", "outputs=ao+near+bent+sh", "filter=5x5 storage=half",
        "outputs=ao+far+composite environment=cube", "temporal=yes filter=3x3 filter_passes=3 outputs=ao+bent+near",
        "march=sweep", "outputs=ao+near estimator=bitmask downscale=2 filter=3x3" };
    static const char *const passes[] = { "march", "filter", "filter_2", "temporal", "upsample", "light" };
    size_t i, k;
    int checked = 0;
    (void)state;
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) {
        const hbil_plan p = plan_from(configs[i]);
        for (k = 0; k < sizeof passes / sizeof passes[0]; ++k) {
            const int32_t index = hbil_plan_pass(&p, passes[k]);
            double bytes = 0;
            int b;
            cost c;
            if (index < 0) continue;
            for (b = 0; b < p.passes[index].binding_count; ++b) {
                const hbil_binding *binding = &p.passes[index].bindings[b];
                const hbil_texture *t = &p.textures[binding->texture];
                const double texel = hbil_format_bytes((hbil_format)t->format);
                if (binding->access == HBIL_ACCESS_WRITE) bytes += t->layers * texel;
            }
            assert_int_equal(cost_of_pass(&p, index, NULL, &c), DONE);
            is(c.fixed.bytes_written, bytes, passes[k], configs[i]);
            ++checked;
        }
    }
    assert_true(checked > 15);
}

/* Baked or dynamic, vulkan or gl: the same accesses. */
static void dynamic_and_gl_have_the_same_accesses(void **state)
{
    static const char *const configs[][2] = { { "slices=4 steps=5", "slices=4 steps=5 dynamic=slices+steps+exponent" },
        { "filter=5x5 temporal=yes", "filter=5x5 temporal=yes dynamic=history" },
        { "march=sweep filter=3x3", "march=sweep filter=3x3 target=gl" },
        { "outputs=ao+far+composite environment=probes", "outputs=ao+far+composite environment=probes target=gl" } };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) {
        cost_total a, b;
        const hbil_plan p = plan_from(configs[i][0]), q = plan_from(configs[i][1]);
        assert_int_equal(cost_of_plan(&p, NULL, &a), DONE);
        assert_int_equal(cost_of_plan(&q, NULL, &b), DONE);
        assert_memory_equal(a.fixed.access, b.fixed.access, sizeof a.fixed.access);
        assert_memory_equal(a.fixed.texture, b.fixed.texture, sizeof a.fixed.texture);
        assert_memory_equal(a.loops.access, b.loops.access, sizeof a.loops.access);
        assert_true(a.fixed.bytes_read == b.fixed.bytes_read && a.fixed.bytes_written == b.fixed.bytes_written);
    }
}

/* A walk passes each pixel once in each of the two layers of a slice; the hull it keeps is of unknown length. */
static void a_pixel_has_a_step_of_the_sweep_per_layer(void **state)
{
    static const char config[] = "march=sweep slices=4 outputs=ao+near";
    const hbil_plan p = plan_from(config);
    const cost c = count_real(config, "sweep"), march = count_real(config, "march");
    cost_counts pixel;
    cost_total total;
    (void)state;
    cost_per_pixel(&p, hbil_plan_pass(&p, "sweep"), &c, &pixel);
    assert_int_equal(c.loops, 2);
    assert_true(pixel.enters[1] == 8 && c.step[1].access[COST_FETCH] == 1 && c.step[1].access[COST_LOAD] == 2);
    is(of(&pixel, config, COST_FETCH, "view_depth"), 8, "depths of the sweep", config);
    is(of(&pixel, config, COST_FETCH, "view_radiance"), 8, "radiances of the sweep", config);
    is(of(&pixel, config, COST_STORE, "swept"), 8, "jumps", config);
    is(of(&pixel, config, COST_STORE, "swept_light"), 8, "lights", config);
    is(of(&march.fixed, config, COST_FETCH, "swept"), 8, "jumps read", config);
    is(of(&march.fixed, config, COST_FETCH, "view_depth"), 9, "depths of the march", config);
    assert_int_equal(cost_of_plan(&p, NULL, &total), DONE);
    assert_int_equal(total.unknown, 1); /* the walk is none in total */
    assert_true(total.loops.access[COST_FETCH] == 8 && total.loops.access[COST_LOAD] == 16);
}

static void coarse_grids_count_their_part(void **state)
{
    static const char coarse[] = "outputs=ao downscale=4", fine[] = "outputs=ao";
    const hbil_plan p = plan_from(coarse), q = plan_from(fine);
    const cost march = count_real(coarse, "march");
    cost_total a, b;
    (void)state;
    assert_int_equal(cost_of_plan(&p, NULL, &a), DONE);
    assert_int_equal(cost_of_plan(&q, NULL, &b), DONE);
    assert_true(of(&march.fixed, coarse, COST_FETCH, "view_depth") == 37);
    assert_true(a.fixed.access[COST_FETCH] < b.fixed.access[COST_FETCH]);
    assert_true(of(&a.fixed, coarse, COST_STORE, "view_depth") == 1.0 / 16);
    assert_true(of(&b.fixed, fine, COST_FETCH, "view_depth") == 37);
}

/* ----------------------------------------------------------------------------------------------------------- report */

static char *report_of(const char *config, const hook_file *hook, int want)
{
    const hbil_plan p = plan_from(config);
    FILE *f = tmpfile();
    char *all = (char *)calloc(1, 65536);
    assert_non_null(f);
    assert_non_null(all);
    assert_int_equal(cost_print(f, &p, hook), want);
    rewind(f);
    assert_true(fread(all, 1, 65535, f) > 0 || want != DONE);
    fclose(f);
    return all;
}

static void the_report_names_passes_totals_and_options(void **state)
{
    static const char *const wanted[] = { "\nprepare ", "\nsweep, a line", "  each step of the walk", "\nmarch ",
        "\nfilter ", "\nlight ", "\nall, of each pixel of the frame ", "\n  outputs+composite ", "\n  march=sweep ~ ",
        "\n  filter=3x3 ", "a pixel has 8: one in each layer of swept" };
    char *all = report_of("march=sweep slices=4 filter=3x3", NULL, DONE), *at;
    size_t i, bar = 0, rows = 0;
    (void)state;
    for (i = 0; i < sizeof wanted / sizeof wanted[0]; ++i)
        if (!strstr(all, wanted[i])) fail_msg("not in the report: %s\n%s", wanted[i], all);
    assert_null(strstr(all, "\n  target"));
    for (at = all; *at; at += strcspn(at, "\n"), at += *at == '\n') { /* columns stand below each other */
        const size_t column = strcspn(at, "|"), end = strcspn(at, "\n");
        if (column >= end || *at == '#') continue;
        if (rows++) assert_int_equal(column, bar);
        bar = column;
    }
    assert_true(rows > 12);
    free(all);
}

/* What an option adds is the difference of two plans. */
static void an_option_adds_the_difference(void **state)
{
    const hbil_plan with = plan_from("outputs=ao slices=5"), without = plan_from("outputs=ao");
    char *all = report_of("outputs=ao slices=5", NULL, DONE), *row = strstr(all, "\n  slices=5 ");
    cost_total a, b;
    double fetches;
    (void)state;
    assert_non_null(row);
    assert_null(strstr(all, "outputs+")); /* the only output cannot go */
    assert_int_equal(cost_of_plan(&with, NULL, &a), DONE);
    assert_int_equal(cost_of_plan(&without, NULL, &b), DONE);
    fetches = strtod(row + strlen("\n  slices=5 "), NULL);
    assert_true(fetches == 24 && fetches == a.fixed.access[COST_FETCH] - b.fixed.access[COST_FETCH]);
    free(all);
}

static void a_hook_is_counted_or_refused(void **state)
{
    static const char config[] = "outputs=far environment=hook";
    static const hook_file good = { "sky.glsl", "layout(set = 1, binding = 1) uniform sampler2D clouds;\n"
        "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
        "    return textureLod(clouds, direction.xy, 0.0).rgb; }\n" };
    static const hook_file bad = { "bad.glsl", "vec3 hbil_far_hook(vec3 position) { return no_such_thing; }\n" };
    char *all = report_of(config, &good, DONE);
    hbil_plan p = plan_from(config);
    cost c;
    double named = 0;
    int t;
    (void)state;
    assert_non_null(strstr(all, "\nlight "));
    free(all);
    assert_int_equal(cost_of_pass(&p, hbil_plan_pass(&p, "light"), &good, &c), DONE);
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) named += c.fixed.texture[COST_FETCH][t];
    is(c.fixed.access[COST_FETCH], named + 1, "fetches", "a texture of the hook, which has the binding of one of ours");
    free(report_of(config, &bad, CONFIG));
    free(report_of(config, NULL, CONFIG));
}

/* ----------------------------------------------------------------------------------------------------- broken words */

static uint32_t next_random(uint32_t *seed)
{
    *seed = *seed * 1664525u + 1013904223u;
    return *seed >> 8;
}

/* Run with HBIL_SANITIZE: nothing outside of the words may be read. The copy has their exact size. */
static int count_copy(const hbil_plan *p, int32_t pass, const uint32_t *from, size_t count)
{
    uint32_t *copy = (uint32_t *)malloc(count ? count * sizeof *copy : 1);
    cost c;
    int ok;
    assert_non_null(copy);
    memcpy(copy, from, count * sizeof *copy);
    ok = cost_of_words(p, pass, copy, count, &c);
    assert_true(ok || c.error);
    free(copy);
    return ok;
}

static void words_that_end_early_are_refused(void **state)
{
    const hbil_plan p = plan_of_hand();
    const size_t count = compile_hand("for (int i = 0; i < steps; ++i) { if (s.x > 1.0) break; s += tap(i); }", 1);
    size_t n;
    (void)state;
    assert_true(count_copy(&p, 0, words, count));
    for (n = 0; n < count; ++n) assert_false(count_copy(&p, 0, words, n));
}

static void broken_words_never_crash(void **state)
{
    const hbil_plan p = plan_of_hand();
    const size_t count = compile_hand("for (int i = 0; i < steps; ++i) { if (s.x > 1.0) break; s += sin(tap(i)); }"
                                      "while (s.x < 1.0) { s += tap(2); switch (p.x) { case 1: s *= tap(3); } }", 1);
    uint32_t seed = 1;
    size_t n, refused = 0;
    int k;
    (void)state;
    for (n = 0; n < 4 * count; ++n) { /* each word: zero, all ones, one more, a neighbour's */
        const uint32_t other[4] = { 0, 0xffffffffu, words[n / 4] + 1, words[(n / 4 + 7) % count] };
        memcpy(broken, words, count * sizeof *words);
        broken[n / 4] = other[n % 4];
        refused += !count_copy(&p, 0, broken, count);
    }
    for (n = 0; n < 4000; ++n) {
        memcpy(broken, words, count * sizeof *words);
        for (k = 0; k < 4; ++k) {
            const uint32_t r = next_random(&seed);
            broken[r % count] ^= n % 2 ? next_random(&seed) & 0xff : next_random(&seed) << 8;
        }
        refused += !count_copy(&p, 0, broken, count);
    }
    assert_true(refused > 1000);
}

static void arguments_that_make_no_sense_are_refused(void **state)
{
    const hbil_plan p = plan_of_hand();
    const size_t count = compile_hand("", 1);
    cost c;
    (void)state;
    assert_true(cost_of_words(&p, 0, words, count, &c));
    assert_false(cost_of_words(&p, 1, words, count, &c));
    assert_false(cost_of_words(&p, -1, words, count, &c));
    assert_false(cost_of_words(NULL, 0, words, count, &c));
    assert_false(cost_of_words(&p, 0, NULL, 0, &c));
    words[3] = 0x7fffffff; /* more ids than memory */
    assert_false(cost_of_words(&p, 0, words, count, &c));
    assert_non_null(c.error);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fetches_of_loops_and_branches),
        cmocka_unit_test(loops_of_unknown_length_are_told_apart),
        cmocka_unit_test(arithmetic_by_class),
        cmocka_unit_test(images_and_shared_memory),
        cmocka_unit_test(registers_hold_what_is_alive),
        cmocka_unit_test(unoptimised_words_are_counted_too),
        cmocka_unit_test(fetches_of_the_march_by_its_formula),
        cmocka_unit_test(slices_and_steps_scale_the_arithmetic),
        cmocka_unit_test(bytes_written_are_those_of_the_bindings),
        cmocka_unit_test(dynamic_and_gl_have_the_same_accesses),
        cmocka_unit_test(a_pixel_has_a_step_of_the_sweep_per_layer),
        cmocka_unit_test(coarse_grids_count_their_part),
        cmocka_unit_test(the_report_names_passes_totals_and_options),
        cmocka_unit_test(an_option_adds_the_difference),
        cmocka_unit_test(a_hook_is_counted_or_refused),
        cmocka_unit_test(words_that_end_early_are_refused),
        cmocka_unit_test(broken_words_never_crash),
        cmocka_unit_test(arguments_that_make_no_sense_are_refused),
    };
    int failed;
    if (!hbil_glslang_init()) return 1;
    failed = cmocka_run_group_tests_name("cost", tests, NULL, NULL);
    hbil_glslang_shutdown();
    return failed;
}
