/* test_options.c - every row of the option table: lint, liveness, round trip, boundaries. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../matrix.h"

static char text_a[HBIL_GLSL_MAX], text_b[HBIL_GLSL_MAX];

static void row_is_complete_and_zero_is_its_default(void **state)
{
    int32_t i, j;
    (void)state;
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        assert_true(*o->name && *o->meaning && *o->source);
        if (!*o->choices) assert_true(*o->unit);
        assert_true(o->def == 0 || (o->def >= o->min && o->def <= o->max));
        assert_true(o->def == 0 || o->min > 0 || o->kind == HBIL_KIND_SET); /* 0 is no other legal value */
        assert_true(o->min < o->max);
        assert_true(strlen(o->name) < 20); /* HBIL_<NAME> fits hbil_constant.name */
        for (j = 0; j < i; ++j) {
            assert_string_not_equal(o->name, hbil_option_at(j)->name);
            assert_true(o->offset != hbil_option_at(j)->offset);
            assert_true(!o->dynamic || o->dynamic != hbil_option_at(j)->dynamic);
        }
    }
    assert_int_equal(sizeof(hbil_config), 8 + 4 * (size_t)hbil_option_count());
}

static void applies_refers_to_rows_above(void **state)
{
    int32_t i, j;
    char symbol[64];
    (void)state;
    for (i = 0; i < hbil_option_count(); ++i)
        for (j = i; j < hbil_option_count(); ++j) {
            size_t k;
            snprintf(symbol, sizeof symbol, "HBIL_%s_", hbil_option_at(j)->name);
            for (k = 5; symbol[k]; ++k) if (symbol[k] >= 'a' && symbol[k] <= 'z') symbol[k] = (char)(symbol[k] - 32);
            if (strstr(hbil_option_at(i)->applies, symbol)) /* a longer name may begin alike */
                assert_true(j < i || strcmp(symbol, "HBIL_DEPTH_") == 0);
        }
}

static const char hook[] = "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) { return direction; }";

/* Everything that a config decides: plan (config left out), text of all passes, uniform block. 0: this context refuses the value. */
static uint64_t fingerprint(const char *config, const char *name, const char *value)
{
    hbil_config c, asked;
    hbil_plan p;
    hbil_frame f;
    unsigned char block[HBIL_CONSTANTS_MAX];
    uint64_t h = 14695981039346656037u;
    size_t n = 0, k;
    int32_t i;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_config_set(&c, name, value, NULL), HBIL_OK);
    asked = c;
    matrix_repair(&c);
    i = hbil_option_find(name, strlen(name), NULL);
    if (hbil__get(&c, i).u != hbil__get(&asked, i).u) return 0;
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
    c = p.config;
    c.clip = HBIL_CLIP_VULKAN; /* one matrix for both: the option is how to read it */
    f = test_frame(&c, p.config.width ? (uint32_t)p.config.width : 64, p.config.height ? (uint32_t)p.config.height : 36);
    assert_int_equal(hbil_pack_constants(&p, &f, block, sizeof block, &n, NULL), HBIL_OK);
    for (k = 0; k < n; ++k) h = (h ^ block[k]) * 1099511628211u;
    for (i = 0; i < (int32_t)p.pass_count; ++i) {
        const char *body;
        assert_int_equal(hbil_emit_glsl_hook(&p, i, hook, text_a, sizeof text_a, &n, NULL), HBIL_OK);
        for (body = test_body(text_a); *body; ++body) h = (h ^ (unsigned char)*body) * 1099511628211u;
    }
    return h;
}

static void every_value_of_every_option_is_alive(void **state)
{
    int32_t i;
    (void)state;
    for (i = 0; i < hbil_option_count(); ++i) {
        matrix_text values[MATRIX_VALUES];
        const hbil_option *o = hbil_option_at(i);
        int a, b, n = matrix_values(i, values);
        for (a = 0; a < n; ++a)
            for (b = 0; b < a; ++b) {
                hbil_config ca, cb;
                size_t k;
                int alive = 0;
                memset(&ca, 0, sizeof ca);
                cb = ca;
                hbil_config_set(&ca, o->name, values[a], NULL);
                hbil_config_set(&cb, o->name, values[b], NULL);
                if (hbil_config_hash(&ca) == hbil_config_hash(&cb)) {
                    hbil_config_print(&ca, 1, text_a, sizeof text_a, NULL);
                    hbil_config_print(&cb, 1, text_b, sizeof text_b, NULL);
                    if (strcmp(text_a, text_b) == 0) continue; /* "default" and its spelling */
                }
                for (k = 0; k < sizeof matrix_contexts / sizeof matrix_contexts[0] && !alive; ++k) {
                    uint64_t fa = fingerprint(matrix_contexts[k], o->name, values[a]), fb = fingerprint(matrix_contexts[k], o->name, values[b]);
                    alive = fa && fb && fa != fb;
                }
                if (strchr(values[a], '+') || strchr(values[b], '+')) continue; /* all members at once may be refused everywhere */
                if (!alive) print_error("%s: %s and %s give the same shaders\n", o->name, values[a], values[b]);
                assert_true(alive);
            }
    }
}

static uint32_t random_next(uint32_t *s) { return *s = *s * 1664525u + 1013904223u; }

static void random_config(hbil_config *c, uint32_t *seed)
{
    int32_t i;
    memset(c, 0, sizeof *c);
    for (i = 0; i < hbil_option_count(); ++i) {
        matrix_text values[MATRIX_VALUES];
        const hbil_option *o = hbil_option_at(i);
        int n = matrix_values(i, values);
        hbil_config_set(c, o->name, values[(random_next(seed) >> 8) % (uint32_t)n], NULL);
        if (o->kind == HBIL_KIND_FLOAT && random_next(seed) >> 31) { /* any float of the range, dense near its low end */
            double t = (double)random_next(seed) / 4294967296.0;
            hbil__value v;
            v.f = (float)(o->min + (o->max - o->min) * t * t * t * t);
            hbil__set(c, i, v);
        }
    }
    matrix_repair(c);
}

static void print_then_parse_gives_the_same_config(void **state)
{
    const int rounds = getenv("HBIL_LONG") ? 20000 : 4000;
    uint32_t seed = 1;
    int round;
    (void)state;
    for (round = 0; round < rounds; ++round) {
        hbil_config c, again, a, b;
        size_t need;
        random_config(&c, &seed);
        assert_int_equal(hbil_config_print(&c, round & 1, text_a, sizeof text_a, &need), HBIL_OK);
        assert_int_equal(need, strlen(text_a) + 1);
        memset(&again, 0, sizeof again);
        assert_int_equal(hbil_config_parse(&again, text_a, need - 1, NULL), HBIL_OK);
        assert_int_equal(hbil_config_resolve(&c, &a, NULL), HBIL_OK);
        assert_int_equal(hbil_config_resolve(&again, &b, NULL), HBIL_OK);
        assert_memory_equal(&a, &b, sizeof a);
        assert_int_equal(hbil_config_resolve(&a, &b, NULL), HBIL_OK); /* idempotent */
        assert_memory_equal(&a, &b, sizeof a);
        assert_true(hbil_config_hash(&c) == hbil_config_hash(&again));
    }
}

/* A value just outside is refused, and the message names option, value and range. */
static void refuse(const char *name, const char *value, const char *range)
{
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    char head[96];
    memset(&c, 0, sizeof c);
    snprintf(head, sizeof head, "%s=%s", name, value);
    assert_int_equal(hbil_config_set(&c, name, value, &diags), HBIL_E_CONFIG);
    assert_int_equal(diags.count, 1);
    assert_int_equal(item.severity, HBIL_ERROR);
    assert_string_equal(hbil_option_at(item.option)->name, name);
    assert_memory_equal(item.text, head, strlen(head));
    assert_non_null(strstr(item.text, range));
    hbil_config_print(&c, 0, text_a, sizeof text_a, NULL);
    assert_string_equal(text_a, ""); /* unchanged */
}

static void ends_are_legal_and_beyond_is_refused(void **state)
{
    static const char *const junk[] = { "nan", "inf", "-1", "1e40", "99999999999999999999", "1x", "", "1,5", "0x10", "--1", "1e", "." };
    int32_t i;
    size_t k;
    char value[48];
    (void)state;
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        hbil_config c;
        memset(&c, 0, sizeof c);
        if (*o->choices) {
            refuse(o->name, "nonsense", "{");
            refuse(o->name, "", "{");
            continue;
        }
        snprintf(value, sizeof value, "%.9g", o->min);
        assert_int_equal(hbil_config_set(&c, o->name, value, NULL), HBIL_OK);
        snprintf(value, sizeof value, "%.9g", o->max);
        assert_int_equal(hbil_config_set(&c, o->name, value, NULL), HBIL_OK);
        snprintf(value, sizeof value, "%.9g", o->kind == HBIL_KIND_INT ? o->max + 1 : o->max * 1.000001);
        refuse(o->name, value, "[");
        if (o->kind == HBIL_KIND_FLOAT) {
            snprintf(value, sizeof value, "%.9g", o->min * 0.999999);
            refuse(o->name, value, "[");
        }
        for (k = 0; k < sizeof junk / sizeof junk[0]; ++k) refuse(o->name, junk[k], "[");
        if (o->kind == HBIL_KIND_INT) refuse(o->name, "1.5", "[");
    }
}

/* The same through the struct, where no text stands guard. */
static void refuse_raw(int32_t option, hbil__value v)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    hbil_config c, out;
    memset(&c, 0, sizeof c);
    hbil__set(&c, option, v);
    assert_int_equal(hbil_config_resolve(&c, &out, &diags), HBIL_E_CONFIG);
    assert_true(diags.count >= 1);
    assert_int_equal(items[0].option, option);
}

static void resolve_refuses_raw_values_out_of_range(void **state)
{
    static const float floats[] = { -1.0f, 1e30f, 1e-30f };
    int32_t i;
    size_t k;
    (void)state;
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        hbil__value v;
        for (k = 0; k < sizeof floats / sizeof floats[0] && o->kind == HBIL_KIND_FLOAT; ++k) {
            v.f = floats[k];
            refuse_raw(i, v);
        }
        v.u = 0x7fc00000u; /* NaN for a float, far out of range for an int */
        if (o->kind == HBIL_KIND_SET) v.u = ((uint32_t)o->max << 1) + 2;
        refuse_raw(i, v);
        v.u = 0x80000000u; /* the smallest int, the largest bit; -0 for a float is 0, the default */
        if (o->kind != HBIL_KIND_FLOAT) refuse_raw(i, v);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(row_is_complete_and_zero_is_its_default),
        cmocka_unit_test(applies_refers_to_rows_above),
        cmocka_unit_test(every_value_of_every_option_is_alive),
        cmocka_unit_test(print_then_parse_gives_the_same_config),
        cmocka_unit_test(ends_are_legal_and_beyond_is_refused),
        cmocka_unit_test(resolve_refuses_raw_values_out_of_range),
    };
    return cmocka_run_group_tests_name("options", tests, NULL, NULL);
}
