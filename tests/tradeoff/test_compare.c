/* test_compare.c - two runs of a sweep, written by hand: which rows match, how far the times are apart, and who has
 * changed places. */
#include <math.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/tradeoff/compare.h"

#define HEAD "config_hash,config,preset,device,backend,frame,width,height,output,ms_median,rmse_hf,bias_hf\n"
#define NEAR(a, b) assert_true(fabs((double)(a) - (double)(b)) <= 1e-9)

static char path[] = "/tmp/test_compare_XXXXXX", error[512], *printed;
static const selection all = {NULL, -1, NULL, NULL, NULL, NULL};

/* A line of config and preset `name` on a device. */
#define LINE(name, preset, device, frame, ms, rmse)                                                                    \
    name "," name "," preset "," device ",vulkan," frame ",8,8,ao," #ms "," #rmse ",\n"

/* Four configs on two frames; c is dominated by b. */
#define FIRST                                                                                                          \
    HEAD LINE("a", "fast", "gpu", "one", 1, .4) LINE("a", "fast", "gpu", "two", 1, .4)                                 \
    LINE("b", "", "gpu", "one", 1, .2) LINE("b", "", "gpu", "two", 4, .2)                                              \
    LINE("c", "", "gpu", "one", 4, .3) LINE("c", "", "gpu", "two", 4, .3)                                              \
    LINE("d", "quality", "gpu", "one", 8, .1) LINE("d", "quality", "gpu", "two", 8, .1)

static csv table_of(const char *text)
{
    csv   table;
    FILE *f = fopen(path, "w");

    assert_non_null(f);
    fputs(text, f);
    assert_int_equal(fclose(f), 0);
    if (!csv_read(&table, path, error, sizeof error)) fail_msg("%s", error);
    return table;
}

static comparison compared(csv tables[2], const char *first, const char *second)
{
    comparison c;

    tables[0] = table_of(first);
    tables[1] = table_of(second);
    if (!compare_make(&c, tables, &all, error, sizeof error)) fail_msg("%s", error);
    return c;
}

/* What compare_print returns; its words are in `printed`. */
static int print_of(const char *first, const char *second, const selection *s)
{
    static const char *const paths[2] = {"A", "B"};
    csv    tables[2];
    size_t size;
    FILE  *out;
    int    got;

    free(printed);
    out = open_memstream(&printed, &size);
    assert_non_null(out);
    tables[0] = table_of(first);
    tables[1] = table_of(second);
    got = compare_print(out, tables, paths, s, error, sizeof error);
    assert_int_equal(fclose(out), 0);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
    return got;
}

static void assert_says(const char *part)
{
    if (!strstr(printed, part)) fail_msg("no \"%s\" in:\n%s", part, printed);
}

/* Half as long again, c by another fifth: ratios 1.5 1.5 1.8 1.5. Frames of b: 3 and 3 have the mean of 1.5 and 6. */
#define SLOWER                                                                                                         \
    HEAD LINE("a", "fast", "gpu", "one", 9, .7) LINE("a", "fast", "gpu", "one", 1.5, .4)                               \
    LINE("a", "fast", "gpu", "two", 1.5, .4) LINE("d", "quality", "gpu", "one", 12, .1)                                \
    LINE("d", "quality", "gpu", "two", 12, .1) LINE("b", "", "gpu", "one", 3, .2) LINE("b", "", "gpu", "two", 3, .2)   \
    LINE("c", "", "gpu", "one", 7.2, .3) LINE("c", "", "gpu", "two", 7.2, .3) LINE("e", "", "gpu", "one", 1, .3)

static void times_match_numbers_worked_out_by_hand(void **state)
{
    csv        tables[2];
    comparison c = compared(tables, FIRST, SLOWER);
    deviation  d;

    (void)state;
    assert_int_equal(c.matched, 8);
    assert_int_equal(c.count, 4);
    assert_int_equal(c.only[0], 0);
    assert_int_equal(c.only[1], 1); /* of two lines of a on one, the last counts */
    assert_int_equal(c.differ, 0);
    NEAR(c.twins[1].ms[0], 2.0);
    NEAR(c.twins[1].ms[1], 3.0);
    assert_true(compare_times(&c, 1.0, &d));
    NEAR(d.median, 1.5);
    NEAR(d.p90, 0.5 + 0.7 * 0.3); /* rank 2.7 of .5 .5 .5 .8 */
    NEAR(d.most, 0.8);
    NEAR(d.within, 0.0);
    assert_string_equal(d.worst->text[CSV_config_hash], "c");
    assert_true(compare_times(&c, 1.5, &d));
    NEAR(d.median, 1.0);
    NEAR(d.p90, 0.14);
    NEAR(d.most, 0.2);
    NEAR(d.within, 0.75);
    NEAR(compare_tau(&c), 1.0);
    compare_free(&c);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
}

static void a_faster_config_counts_as_a_slower_one(void **state)
{
    csv        tables[2];
    comparison c = compared(tables, HEAD LINE("a", "", "gpu", "one", 3, .1) LINE("b", "", "gpu", "one", 5, .1)
                            LINE("c", "", "gpu", "one", 6, .1),
                            HEAD LINE("a", "", "gpu", "one", 3, .1) LINE("b", "", "gpu", "one", 2, .1)
                            LINE("c", "", "gpu", "one", 6, .1));
    deviation  d;

    (void)state;
    assert_true(compare_times(&c, 1.0, &d));
    NEAR(d.most, 1.5);
    NEAR(compare_tau(&c), 1.0 / 3.0); /* one pair of three is swapped */
    compare_free(&c);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
}

static void other_errors_are_found(void **state)
{
    csv        tables[2];
    comparison c = compared(tables, HEAD LINE("a", "", "gpu", "one", 3, .1) LINE("b", "", "gpu", "one", 5, .2),
                            HEAD LINE("a", "", "gpu", "one", 3, .1) LINE("b", "", "gpu", "one", 5, .25));

    (void)state;
    assert_int_equal(c.differ, 1);
    assert_int_equal(c.column, CSV_rmse_hf);
    assert_string_equal(c.worst->text[CSV_config_hash], "b");
    NEAR(c.most, 0.2);
    compare_free(&c);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
    c = compared(tables, HEAD "a,a,,gpu,vulkan,one,8,8,ao,3,.1,-.01\n", HEAD "a,a,,gpu,vulkan,one,8,8,ao,3,.1,\n");
    assert_int_equal(c.column, CSV_bias_hf);
    NEAR(c.most, 1.0); /* in one alone */
    compare_free(&c);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
}

static void runs_are_the_same_or_not(void **state)
{
    selection s = all;

    (void)state;
    assert_int_equal(print_of(FIRST, FIRST, &all), 1);
    assert_says("8 match, of 4 configs (gpu, vulkan); 0 only in A, 0 only in B");
    assert_says("equal to the last digit");
    assert_says("3 configs on both fronts by rmse_hf; 2 presets by time in the same order; 2 presets by error");
    assert_says("\nthe same\n");
    assert_int_equal(print_of(FIRST, SLOWER, &all), 0); /* the 90th percentile is 14 % */
    assert_says("1.500 of the first");
    assert_says("that factor taken out: 90th percentile 14.0 %, largest 20.0 % (c); 75.0 % of configs within 10 %");
    assert_int_equal(print_of(FIRST, HEAD LINE("a", "fast", "gpu", "one", 1, .41), &all), 0);
    assert_says("or costs of 1 rows differ, most rmse_hf by 2.4 % (fast, ao of one)");
    assert_int_equal(print_of(FIRST, HEAD LINE("a", "fast", "other", "one", 1, .4), &all), -1);
    assert_non_null(strstr(error, "no row of one is in the other"));
    assert_int_equal(print_of(FIRST LINE("a", "fast", "other", "one", 1, .4),
                              FIRST LINE("a", "fast", "other", "one", 1, .4), &all), -1);
    assert_non_null(strstr(error, "--device"));
    s.device = "gpu";
    assert_int_equal(print_of(FIRST LINE("a", "fast", "other", "one", 1, .4),
                              FIRST LINE("a", "fast", "other", "one", 1, .4), &s), 1);
}

/* Six configs, of which the presets p and q take these times. */
#define RUN(p, q)                                                                                                      \
    HEAD LINE("a", "p", "gpu", "one", p, .4) LINE("b", "q", "gpu", "one", q, .2) LINE("c", "", "gpu", "one", 1, .5)    \
    LINE("d", "", "gpu", "one", 20, .1) LINE("e", "", "gpu", "one", 21, .6) LINE("f", "", "gpu", "one", 22, .6)

static void presets_and_fronts_keep_their_places_or_not(void **state)
{
    (void)state;
    assert_int_equal(print_of(RUN(5, 5.2), RUN(5.2, 5), &all), 1); /* 4 % apart: none can be told */
    assert_says("3 configs on both fronts by rmse_hf; left, and off it by: `p` 100.0 %");
    assert_int_equal(print_of(RUN(5.2, 5), RUN(5, 5.2), &all), 1);
    assert_says("entered, and off the first by: `p` 100.0 %");
    assert_int_equal(print_of(RUN(5, 5.6), RUN(5.6, 5), &all), 0);
    assert_says("; by time in another order: q and p");
    assert_says("not the same");
}

static int make_file(void **state)
{
    const int file = mkstemp(path);

    (void)state;
    return file < 0 ? -1 : close(file);
}

static int remove_file(void **state)
{
    (void)state;
    free(printed);
    return remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(times_match_numbers_worked_out_by_hand),
        cmocka_unit_test(a_faster_config_counts_as_a_slower_one),
        cmocka_unit_test(other_errors_are_found),
        cmocka_unit_test(runs_are_the_same_or_not),
        cmocka_unit_test(presets_and_fronts_keep_their_places_or_not),
    };

    return cmocka_run_group_tests_name("compare", tests, make_file, remove_file);
}
