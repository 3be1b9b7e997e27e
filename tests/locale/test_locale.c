/* test_locale.c - the core's texts and numbers are the same under every locale.
 *
 * German and Turkish write a decimal comma; Turkish also lower-cases I to a letter that is no i. Locales that the machine
 * lacks are made for this test by localedef. Exit 77, skipped, if neither can be had. */
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"

#include <ctype.h>
#include <locale.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define SKIPPED 77
#define RECORD_BYTES (4u << 20)

/* All that the core says about the configs below, one after the other. */
typedef struct record { unsigned char *bytes; size_t size; } record;

static record baseline; /* made before any setlocale: what the C locale gives */
static int    compared; /* locales with a decimal comma */

/* Many digits, exponents, letters that change case with the locale; faults, too, since messages hold numbers. */
static const char *const configs[] = {
    "",
    "target=gl outputs=ao+near+bent+composite slices=2 steps=5",
    "reach=2.5 falloff=0.615 bias=0.00125 pull=1.25e-6 exponent=1.75 sky_depth=12345.678",
    "REACH=2.5",
    "reach=1234567.5 dynamic=reach+falloff+bias+pull+sky_depth+exponent exponent=3.3333",
    "width=1920 height=1080 noise=ign projection=orthographic spacing=geometric",
    "depth=device depth_direction=reversed depth_far=infinite clip=gl normals=depth",
    "reach=2,5",
    "reach=2.5.5 falloff=7.25 bias=-0.5 exponent=0.5 pull=1e-9 slices=1.5",
    "falloff=0,3 exponent=1e39 sky_depth=nan",
};

static void append(record *r, const void *bytes, size_t size)
{
    assert_true(r->size + size <= RECORD_BYTES);
    memcpy(r->bytes + r->size, bytes, size);
    r->size += size;
}

static void append_diags(record *r, const hbil_diags *diags)
{
    int32_t i;

    append(r, &diags->count, sizeof diags->count);
    for (i = 0; i < diags->count && i < diags->capacity; ++i) append(r, diags->items[i].text, strlen(diags->items[i].text) + 1);
}

/* Texts, manifest and uniform block of one plan. */
static void append_plan(record *r, const hbil_plan *plan)
{
    static char text[HBIL_GLSL_MAX];
    hbil_diag   items[4];
    hbil_diags  diags = { items, 4, 0 };
    hbil_frame  frame;
    size_t      need = 0;
    int32_t     i;

    for (i = 0; i < (int32_t)plan->pass_count; ++i) {
        assert_int_equal(hbil_emit_glsl(plan, i, text, sizeof text, &need), HBIL_OK);
        append(r, text, need);
    }
    assert_int_equal(hbil_emit_manifest(plan, text, sizeof text, &need), HBIL_OK);
    append(r, text, need);
    memset(&frame, 0, sizeof frame);
    frame.width = plan->config.width ? 0 : 640;
    frame.height = plan->config.height ? 0 : 360;
    frame.projection[0] = 1e30f; /* refused, with the number in the message */
    hbil_pack_constants(plan, &frame, text, sizeof text, NULL, &diags);
    append_diags(r, &diags);
}

static record make_record(void)
{
    static hbil_plan plan;
    record      r = { NULL, 0 };
    char        text[4096];
    size_t      i, need = 0;

    r.bytes = (unsigned char *)malloc(RECORD_BYTES);
    assert_non_null(r.bytes);
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) {
        hbil_diag   items[32];
        hbil_diags  diags = { items, 32, 0 };
        hbil_config config;
        hbil_result result;
        int         all;

        memset(&config, 0, sizeof config);
        result = hbil_config_parse(&config, configs[i], strlen(configs[i]), &diags);
        append(&r, &result, sizeof result);
        append(&r, &config, sizeof config);
        for (all = 0; all < 2; ++all) {
            assert_int_equal(hbil_config_print(&config, all, text, sizeof text, &need), HBIL_OK);
            append(&r, text, need);
        }
        result = hbil_plan_build(&config, &plan, &diags);
        append(&r, &result, sizeof result);
        append_diags(&r, &diags);
        if (result != HBIL_OK) continue;
        append(&r, &plan, sizeof plan);
        append_plan(&r, &plan);
    }
    return r;
}

/* ---------------------------------------------------------------------------------------------------- locales */

static const char *const german[2] = { "de_DE.UTF-8", "de_DE" }; /* name, source */
static const char *const turkish[2] = { "tr_TR.UTF-8", "tr_TR" };

static char made_in[] = "/tmp/hbil-locale-XXXXXX";
static int  made; /* the folder is there */

static int make_locale(const char *const names[2])
{
    char command[256];

    snprintf(command, sizeof command, "localedef --no-archive -i %s -f UTF-8 %s/%s >/dev/null 2>&1", names[1], made_in, names[0]);
    return system(command) == 0;
}

/* Makes both locales in a folder of our own unless both are installed: while LOCPATH is set, others are not found. Before
 * the first setlocale that may fail there, as the C library remembers failures. */
static void make_locales(void)
{
    if (setlocale(LC_ALL, german[0]) && setlocale(LC_ALL, turkish[0])) return;
    made = mkdtemp(made_in) != NULL;
    if (made && make_locale(german) + make_locale(turkish) > 0) setenv("LOCPATH", made_in, 1);
}

static void remove_made_locales(void)
{
    char command[64];

    snprintf(command, sizeof command, "rm -rf %s", made_in);
    if (made && system(command) != 0) fprintf(stderr, "locale: cannot remove %s\n", made_in);
}

/* ---------------------------------------------------------------------------------------------------- tests */

/* First difference, shown with the text around it. */
static void expect_baseline(const char *locale)
{
    record r = make_record();
    size_t i = 0, from, shared = r.size < baseline.size ? r.size : baseline.size;

    while (i < shared && r.bytes[i] == baseline.bytes[i]) ++i;
    if (i < shared || r.size != baseline.size) {
        from = i < 40 ? 0 : i - 40;
        print_error("%s differs at byte %lu: \"%.60s\", in the C locale \"%.60s\"\n", locale, (unsigned long)i,
                    (const char *)r.bytes + from, (const char *)baseline.bytes + from);
        fail();
    }
    free(r.bytes);
}

static void same_under(const char *const names[2])
{
    char control[16];

    if (!setlocale(LC_ALL, names[0])) {
        print_message("%s is neither installed nor can it be made (Debian package locales)\n", names[0]);
        skip();
    }
    /* the locale does what we fear: without this the test would pass under any */
    snprintf(control, sizeof control, "%.1f", 0.5);
    assert_string_equal(control, "0,5");
    if (names == turkish) assert_int_not_equal(toupper('i'), 'I');
    expect_baseline(names[0]);
    ++compared;
}

static void same_text_under_the_c_locale_set_explicitly(void **state)
{
    (void)state;
    assert_non_null(setlocale(LC_ALL, "C"));
    expect_baseline("C");
}

static void same_text_with_a_decimal_comma(void **state)
{
    (void)state;
    same_under(german);
}

static void same_text_where_small_i_has_no_capital_I(void **state)
{
    (void)state;
    same_under(turkish);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(same_text_under_the_c_locale_set_explicitly),
        cmocka_unit_test(same_text_with_a_decimal_comma),
        cmocka_unit_test(same_text_where_small_i_has_no_capital_I),
    };
    int failed;

    baseline = make_record();
    make_locales();
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    remove_made_locales();
    free(baseline.bytes);
    return failed ? 1 : compared ? 0 : SKIPPED;
}
