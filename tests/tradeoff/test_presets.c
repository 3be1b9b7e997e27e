/* test_presets.c - fast, balanced and quality are points of the recorded front: no other config of the record is
 * neither slower nor worse in any output and more than 10 % better in time or in an error; and the README's figures are
 * those of the record. HBIL_RECORDED: the CSV of the sweep that chose them. HBIL_README: the page. */
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/frame/image.h"
#include "../../examples/tradeoff/marginals.h"

#define ALLOWED 0.10
#define TEXT    4096

static const char *const presets[] = {"fast", "balanced", "quality"};
static const char *const outputs[] = CSV_OUTPUT_NAMES;

static csv    table;
static points sets[3];
static int    set_count;

/* All outputs with a height-field truth, on the device of the first line. */
static int load(void **state)
{
    selection s;
    char      error[1024];
    size_t    i;

    (void)state;
    if (!csv_read(&table, getenv("HBIL_RECORDED"), error, sizeof error)) {
        print_error("%s\n", error);
        return -1;
    }
    memset(&s, 0, sizeof s);
    s.error = CSV_rmse_hf;
    s.backend = table.rows[0].text[CSV_backend];
    s.device = table.rows[0].text[CSV_device];
    for (i = 0; i < 3; i++) {
        s.output = outputs[i];
        set_count += points_make(&sets[set_count], &table, &s, error, sizeof error);
    }
    if (set_count == 0) print_error("%s\n", error);
    return set_count > 0 ? 0 : -1;
}

static int unload(void **state)
{
    (void)state;
    while (set_count > 0) points_free(&sets[--set_count]);
    csv_free(&table);
    return 0;
}

static void no_preset_is_dominated_by_more_than_10_percent(void **state)
{
    size_t i;
    int    bad = 0;

    (void)state;
    for (i = 0; i < 3; i++) {
        const point *p = points_find(&sets[0], presets[i]), *by;
        double       gain;

        if (!p) fail_msg("%s is not recorded on all frames. Sweep it", presets[i]);
        gain = front_dominated(sets, set_count, p->row->text[CSV_config_hash], &by);
        if (gain <= ALLOWED) continue;
        print_error("%s (%.4g ms, %.4f) is dominated by %.1f %%: %s (%.4g ms, %.4f)\n", presets[i], p->ms, p->error,
                    100.0 * gain, by->row->text[CSV_config], by->ms, by->error);
        bad++;
    }
    assert_int_equal(bad, 0);
}

/* A record of other values would say nothing of ours. */
static void recorded_presets_have_the_values_of_hbil_h(void **state)
{
    size_t i;

    (void)state;
    for (i = 0; i < 3; i++) {
        const point *p = points_find(&sets[0], presets[i]);
        hbil_config  config;
        char         text[TEXT], recorded[MARGINAL_TEXT], *word;

        assert_non_null(p);
        assert_int_equal(hbil_config_preset(presets[i], &config, NULL), HBIL_OK);
        assert_int_equal(hbil_config_print(&config, 0, text, sizeof text, NULL), HBIL_OK);
        for (word = strtok(text, " \n"); word; word = strtok(NULL, " \n")) {
            char *value = strchr(word, '=');

            assert_non_null(value);
            *value++ = 0;
            config_value(p->row->text[CSV_config], word, recorded);
            if (strcmp(value, recorded) != 0 && strcmp(word, "outputs") != 0 && strcmp(word, "target") != 0)
                fail_msg("%s: %s is %s, but recorded with %s. Sweep again", presets[i], word, value, recorded);
        }
    }
}

/* Mean of an error over the frames of the record that have it. */
static double recorded(const char *output, int error_column, const char *preset)
{
    selection    s;
    points       p;
    const point *q;
    char         error[1024];
    double       result;

    memset(&s, 0, sizeof s);
    s.output = output;
    s.error = error_column;
    s.backend = table.rows[0].text[CSV_backend];
    s.device = table.rows[0].text[CSV_device];
    if (!points_make(&p, &table, &s, error, sizeof error)) fail_msg("%s", error);
    q = points_find(&p, preset);
    assert_non_null(q);
    result = q->error;
    points_free(&p);
    return result;
}

static void the_readme_has_the_figures_of_the_record(void **state)
{
    static const char *const rows[] = {"fast", "balanced", "quality", "sampled"};
    char                    *page, line[256], error[1024];
    size_t                   i;

    (void)state;
    page = text_read(getenv("HBIL_README"), (size_t)1 << 20, "page", error, sizeof error);
    if (!page) fail_msg("%s", error);
    for (i = 0; i < sizeof rows / sizeof *rows; i++) {
        snprintf(line, sizeof line, "| `%s` | %.3g | %.3f | %.3f | %.3f | %.3f |", rows[i],
                 points_find(&sets[0], rows[i])->ms, recorded("ao", CSV_rmse_hf, rows[i]),
                 recorded("ao", CSV_rmse_model, rows[i]), recorded("near", CSV_rmse_hf, rows[i]),
                 recorded("near", CSV_rmse_model, rows[i]));
        if (!strstr(page, line)) fail_msg("the README has not this row of the record:\n%s", line);
    }
    free(page);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_preset_is_dominated_by_more_than_10_percent),
        cmocka_unit_test(recorded_presets_have_the_values_of_hbil_h),
        cmocka_unit_test(the_readme_has_the_figures_of_the_record),
    };

    if (!getenv("HBIL_RECORDED") || access(getenv("HBIL_RECORDED"), R_OK) != 0) {
        puts("skipped: no record of a sweep at HBIL_RECORDED (examples/tradeoff/report/results.csv)");
        return 77;
    }
    return cmocka_run_group_tests_name("presets", tests, load, unload);
}
