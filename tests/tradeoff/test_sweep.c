/* test_sweep.c - what hbil-tradeoff's runs rest on: grids, intervals, warm-up, the results file, truths and their
 * families. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#define HBIL_IMPLEMENTATION
#include "csv.h"
#include "grid.h"
#include "rows.h"

static char error[512];
static char folder[64];

/* ---- grids */

static void ranges_and_lists(void **state)
{
    static grid g;
    static const char *const texts[] = {"slices=1 steps=2",  "slices=1 steps=4", "slices=1 steps=8",
                                        "slices=1 steps=16", "slices=4 steps=2", "slices=4 steps=4",
                                        "slices=4 steps=8",  "slices=4 steps=16"};
    char     text[256];
    uint64_t i;

    (void)state;
    assert_true(grid_parse(&g, "# all of it\n slices=1,4\n\tsteps=2..16*2 # doubled", error, sizeof error));
    assert_int_equal(grid_size(&g), 8);
    for (i = 0; i < 8; i++) {
        assert_true(grid_text(&g, i, text, sizeof text));
        assert_string_equal(text, texts[i]);
    }
    assert_false(grid_text(&g, 0, text, 10));
    assert_true(grid_parse(&g, "exponent=1..2+.25,4 steps=3..5", error, sizeof error));
    assert_int_equal(grid_size(&g), 18);
    assert_string_equal(g.axes[0].values[1], "1.25");
    assert_string_equal(g.axes[0].values[5], "4");
    assert_string_equal(g.axes[1].values[2], "5");
    assert_true(grid_parse(&g, "reach=.5..2*2 preset=none,fast", error, sizeof error));
    assert_true(grid_text(&g, 3, text, sizeof text));
    assert_string_equal(text, "preset=fast reach=1"); /* where a config begins comes first */
    assert_true(grid_parse(&g, "", error, sizeof error));
    assert_int_equal(grid_size(&g), 1);
}

static void faults_of_grids(void **state)
{
    static const char *const bad[] = {"slices",     "slice=1",      "slices=",         "slices=1,,2",
                                      "steps=4..2", "steps=1..8*1", "steps=1..8+0",    "steps=0..8*2",
                                      "steps=a..b", "steps=1..8x",  "steps=1 steps=2", "steps=1..1000"};
    static grid g;
    size_t      i;

    (void)state;
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        error[0] = 0;
        if (grid_parse(&g, bad[i], error, sizeof error)) fail_msg("%s was taken", bad[i]);
        assert_true(error[0] != 0);
    }
    grid_parse(&g, "slice=1", error, sizeof error);
    assert_non_null(strstr(error, "slices")); /* names the nearest */
    assert_true(grid_parse(
        &g, "slices=1..64 steps=1..64 history=2..63 filter_passes=1..3 sample=1..31 width=1..64 height=1..64", error,
        sizeof error));
    assert_int_equal(grid_size(&g), 0);
}

static void random_subsets(void **state)
{
    uint64_t a[40], b[40], c[40];
    int      hit[100] = {0}, i, seed, same = 1;

    (void)state;
    assert_true(grid_choose(100, 40, 7, a));
    assert_true(grid_choose(100, 40, 7, b));
    assert_true(grid_choose(100, 40, 8, c));
    assert_memory_equal(a, b, sizeof a);
    for (i = 0; i < 40; i++) {
        assert_true(a[i] < 100 && (i == 0 || a[i] > a[i - 1]));
        same &= a[i] == c[i];
    }
    assert_false(same);
    for (seed = 0; seed < 500; seed++) {
        assert_true(grid_choose(100, 40, (uint64_t)seed, a));
        for (i = 0; i < 40; i++) hit[a[i]]++;
    }
    for (i = 0; i < 100; i++) assert_in_range(hit[i], 145, 255); /* 200 expected, 5 deviations */
    assert_true(grid_choose(5, 5, 1, a));
    assert_int_equal(a[4], 4);
    assert_false(grid_choose(5, 6, 1, a));
}

/* ---- times */

static double uniform(uint64_t *state) { return ((double)(grid_random(state) >> 11) + 0.5) / 9007199254740992.0; }

static void bootstrap_of_known_samples(void **state)
{
    static const double one_to_nine[] = {9, 1, 8, 2, 7, 3, 6, 4, 5}, flat[] = {3, 3, 3, 3};
    uint64_t random = 11;
    interval r;
    double   sample[15];
    int      inside = 0, i, k;

    (void)state;
    assert_true(timing_median(one_to_nine, 9) == 5.0);
    assert_true(timing_median(one_to_nine, 2) == 5.0); /* 9 and 1 */
    r = timing_bootstrap(flat, 4, 0.95);
    assert_true(r.low == 3.0 && r.high == 3.0);
    /* the medians of nine draws are binomial: below 2 and above 8 with a chance of .0058 each, below 3 and above 7 with
     * .057 */
    r = timing_bootstrap(one_to_nine, 9, 0.95);
    assert_true(r.low >= 2.0 && r.low <= 3.0 && r.high >= 7.0 && r.high <= 8.0);
    r = timing_bootstrap(one_to_nine, 9, 0.5);
    assert_true(r.low >= 3.0 && r.low <= 5.0 && r.high >= 5.0 && r.high <= 7.0);
    for (i = 0; i < 200; i++) { /* how often does it hold the true median? */
        for (k = 0; k < 15; k++)
            sample[k] = sqrt(-2.0 * log(uniform(&random))) * cos(6.283185307179586 * uniform(&random));
        r = timing_bootstrap(sample, 15, 0.95);
        inside += r.low <= 0.0 && r.high >= 0.0;
    }
    assert_in_range(inside, 178, 200); /* .95 of 200 less four deviations */
}

static void differences_within_noise(void **state)
{
    double       a[25], b[25], c[25], d[25];
    uint64_t     random = 5;
    timing_ratio r;
    int          i;

    (void)state;
    for (i = 0; i < 25; i++) {
        a[i] = 10.0 + uniform(&random);
        b[i] = 10.0 + uniform(&random);
        c[i] = 1.2 * a[i] * (0.98 + 0.04 * uniform(&random));
        d[i] = 1.01 * a[i];
    }
    assert_true(timing_compare(a, b, 25).within_noise);
    assert_true(timing_compare(a, d, 25).within_noise); /* below what any clock here resolves */
    r = timing_compare(a, c, 25);
    assert_false(r.within_noise);
    assert_true(fabs(r.median - 1.2) < 0.02 && r.range.low > 1.15 && r.range.high < 1.25);
    r = timing_compare(c, a, 25);
    assert_true(!r.within_noise && r.median < 1.0);
    assert_false(timing_compare(a, c, 3).within_noise);
    for (i = 0; i < 3; i++) b[i] = a[i] * (1.05 + 0.1 * i); /* three on one side by chance: one of four times */
    assert_true(timing_compare(a, b, 3).within_noise);
}

/* Runs whose time falls by half until `rest` of them were made. */
typedef struct device { int made, rest; } device;

static int fake_run(void *user, int count, double *ms, char *message, size_t size)
{
    device *d = user;
    int     i;

    (void)message;
    (void)size;
    for (i = 0; i < count; i++, d->made++) ms[i] = d->made < d->rest ? pow(2.0, d->rest - d->made) : 1.0;
    return 1;
}

static void warm_until_it_rests(void **state)
{
    device quick = {0, 1}, slow = {0, 10}, never = {0, 1000};
    double ms;
    int    stable;

    (void)state;
    assert_true(timing_warm(fake_run, &quick, 100.0, &ms, &stable, error, sizeof error));
    assert_true(stable && ms == 1.0);
    assert_int_equal(quick.made, 10); /* one that compiles, three medians of three */
    assert_true(timing_warm(fake_run, &slow, 100.0, &ms, &stable, error, sizeof error));
    assert_true(stable && ms == 1.0 && slow.made > 10);
    assert_true(timing_warm(fake_run, &never, 100.0, &ms, &stable, error, sizeof error));
    assert_false(stable);
    assert_int_equal(never.made, 31);
    never.made = 0;
    assert_true(timing_warm(fake_run, &never, 0.0, &ms, &stable, error, sizeof error)); /* no time at all: one run */
    assert_int_equal(never.made, 1);
}

/* ---- the results file */

static void path_of(char out[128], const char *name) { snprintf(out, 128, "%s/%s", folder, name); }

static void put_file(const char *path, const char *mode, const char *text)
{
    FILE *f = fopen(path, mode);

    assert_non_null(f);
    fputs(text, f);
    assert_int_equal(fclose(f), 0);
}

static long size_of(const char *path)
{
    struct stat info;

    return stat(path, &info) == 0 ? (long)info.st_size : -1;
}

static void fill(measured *m)
{
    int k;

    memset(m, 0, sizeof *m);
    m->time.min = m->time.median = m->time.max = 1.5;
    m->time.runs = 3;
    for (k = 0; k < OUTS; k++) {
        m->out[k].present = k != OUT_FAR;
        m->out[k].rmse_model = 0.25;
        m->out[k].psnr = -3.5; /* an error above white */
        m->out[k].ring_field[1] = 0.125;
        m->out[k].ring_model[4] = 0.5 + k;
        m->out[k].flicker = (double)NAN;
    }
}

static void rows_survive(void **state)
{
    static const runner_info about = {"vulkan", "a device, of two parts", "driver 1", ""};
    static measured          m;
    hbil_config              config = {0};
    rows                     r;
    char                     path[128], key[512];
    long                     whole;

    (void)state;
    path_of(path, "rows.csv");
    fill(&m);
    assert_int_equal(hbil_config_resolve(&config, &config, NULL), HBIL_OK);
    assert_true(rows_open(&r, path, error, sizeof error));
    assert_true(rows_add(&r, &about, hbil_config_hash(&config), "slices=1", "", "fence", 64, 36, &m, 3u, error, sizeof error));
    rows_close(&r);
    whole = size_of(path);
    put_file(path, "a", "0.1.0,123,outputs=ao,,a dev"); /* torn */
    assert_true(rows_open(&r, path, error, sizeof error));
    assert_int_equal(r.repaired, 27);
    assert_int_equal(r.count, 2);
    assert_int_equal(size_of(path), whole);
    rows_key(key, sizeof key, &about, hbil_config_hash(&config), "fence", 64, 36, OUT_NEAR);
    assert_true(rows_has(&r, key));
    rows_key(key, sizeof key, &about, hbil_config_hash(&config), "fence", 64, 36, OUT_FAR); /* was not present */
    assert_false(rows_has(&r, key));
    rows_key(key, sizeof key, &about, hbil_config_hash(&config), "fence", 65, 36, OUT_AO);
    assert_false(rows_has(&r, key));
    config.slices = 5;
    rows_key(key, sizeof key, &about, hbil_config_hash(&config), "fence", 64, 36, OUT_AO);
    assert_false(rows_has(&r, key));
    rows_close(&r);
}

static void strange_files(void **state)
{
    rows r;
    char path[128], fresh[128];

    (void)state;
    path_of(path, "strange.csv");
    put_file(path, "w", "a,b,c\n1,2,3\n");
    assert_false(rows_open(&r, path, error, sizeof error));
    assert_int_equal(size_of(path), 12); /* is left as it was */
    put_file(path, "w", "notes without an end");
    assert_false(rows_open(&r, path, error, sizeof error));
    assert_int_equal(size_of(path), 20);
    put_file(path, "w", "version,config_h"); /* killed while it wrote the header */
    assert_true(rows_open(&r, path, error, sizeof error));
    rows_close(&r);
    path_of(fresh, "fresh.csv");
    assert_true(rows_open(&r, fresh, error, sizeof error));
    rows_close(&r);
    assert_true(size_of(path) == size_of(fresh) && size_of(path) > 100);
    put_file(path, "a", "1,2,3\n");
    assert_false(rows_open(&r, path, error, sizeof error));
    assert_non_null(strstr(error, "line 2"));
    path_of(path, "missing/rows.csv");
    assert_false(rows_open(&r, path, error, sizeof error));
}

/* What is measured comes back under the names of the columns. */
static void rows_are_read_by_the_analysis(void **state)
{
    static const runner_info about = {"vulkan", "a device, of two parts", "driver 1", ""};
    static measured          m;
    rows                     r;
    csv                      table;
    char                     path[128];

    (void)state;
    path_of(path, "read.csv");
    fill(&m);
    assert_true(rows_open(&r, path, error, sizeof error));
    assert_true(rows_add(&r, &about, 7u, "slices=1", "fast", "fence", 64, 36, &m, 3u, error, sizeof error));
    rows_close(&r);
    if (!csv_read(&table, path, error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(table.count, 2);
    assert_string_equal(table.rows[0].text[CSV_device], "a device; of two parts");
    assert_string_equal(table.rows[0].text[CSV_preset], "fast");
    assert_string_equal(table.rows[1].text[CSV_output], "near");
    assert_true(table.rows[1].number[CSV_width] == 64.0 && table.rows[1].number[CSV_ms_median] == 1.5);
    assert_true(table.rows[1].number[CSV_psnr] == -3.5 && table.rows[1].number[CSV_ring2_hf] == 0.125);
    assert_true(table.rows[0].number[CSV_ring5_model] == 0.5 && table.rows[1].number[CSV_ring5_model] == 1.5);
    assert_true(table.rows[1].number[CSV_ring4_model] == 0.0 && isnan(table.rows[1].number[CSV_flicker]));
    csv_free(&table);
}

/* ---- configs and truths */

static uint64_t family_of(const settings *s, const capture *cap, const char *text)
{
    hbil_config c, family;

    if (!config_make(s, text, 0, cap, &c, error, sizeof error)) fail_msg("%s", error);
    truth_family(s, &c, &family);
    return hbil_config_hash(&family);
}

static void families_of_estimators(void **state)
{
    static settings s;
    static capture  cap;
    uint64_t        plain;

    (void)state;
    settings_default(&s);
    plain = family_of(&s, &cap, "");
    assert_true(
        plain == family_of(&s, &cap, "slices=1 steps=32 exponent=1 mips=spread interleave=yes filter=5x5 downscale=2"));
    assert_true(plain == family_of(&s, &cap, "temporal=yes noise=ign storage=half gather=packed"));
    assert_true(plain != family_of(&s, &cap, "estimator=bitmask"));
    assert_true(plain != family_of(&s, &cap, "reach=2"));
    assert_true(plain != family_of(&s, &cap, "bounces=recursive"));
    assert_true(plain != family_of(&s, &cap, "seed_compat=slice_mean"));
    assert_true(plain != family_of(&s, &cap, "march=sweep"));
    assert_true(family_of(&s, &cap, "fast") == family_of(&s, &cap, "quality"));
    assert_true(family_of(&s, &cap, "estimator=hbao reach=1 exponent=1")
                != family_of(&s, &cap, "estimator=hbao reach=1 exponent=2"));
}

static void configs_from_text(void **state)
{
    static settings s;
    static capture  cap;
    hbil_config     c;
    char            text[TEXT_MAX];

    (void)state;
    settings_default(&s);
    s.sets[s.set_count++] = "slices=6";
    if (!config_make(&s, "preset=fast steps=9", 0, &cap, &c, error, sizeof error)) fail_msg("%s", error);
    assert_int_equal(c.slices, 6);
    assert_int_equal(c.march, HBIL_MARCH_SWEEP);
    assert_int_equal(c.outputs, HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR);
    assert_true(config_make(&s, "hbil_paper", 0, &cap, &c, error, sizeof error)); /* without f0, as the frame */
    assert_true(config_make(&s, "estimator=hbao", 0, &cap, &c, error, sizeof error));
    assert_int_equal(c.outputs, HBIL_OUTPUTS_AO);
    config_text(&c, ',', text);
    assert_string_equal(text, "outputs=ao,estimator=hbao,slices=6");
    assert_false(config_make(&s, "occluder=thick", 0, &cap, &c, error, sizeof error));
    assert_non_null(strstr(error, "bitmask"));
    assert_false(config_make(&s, "nonsense", 0, &cap, &c, error, sizeof error));
    s.set_count = 0;
    assert_true(config_make(&s, "quality", 0, &cap, &c, error, sizeof error));
    assert_string_equal(config_preset_of(&s, &c, 0, &cap), "quality");
    assert_true(config_make(&s, "preset=quality slices=6", 0, &cap, &c, error, sizeof error));
    assert_string_equal(config_preset_of(&s, &c, 0, &cap), "");
}

static void truths_of_a_scene(void **state)
{
    static settings s;
    capture         cap;
    truth           t, again;
    subject         sub = {"scene:fence", &cap, 1};
    size_t          i, count = 0;
    hbil_config     one = {0};

    (void)state;
    settings_default(&s);
    s.scenes = "fence";
    s.quiet = 1;
    s.cache = folder;
    assert_int_equal(settings_finish(&s), TRADE_DONE);
    assert_true(s.flat.color[0] > 0.37f && s.flat.color[0] < 0.38f); /* the mean of ground .30 and zenith .45 */
    assert_true(capture_scene(&cap, "fence", 24, 14, 32, NULL, error, sizeof error));
    assert_int_equal(truth_make(&s, &sub, 1, &t), TRADE_DONE);
    assert_int_equal(truth_make(&s, &sub, 1, &again), TRADE_DONE); /* out of the cache */
    for (i = 0; i < 24 * 14; i++) {
        const float *ao = t.field[OUT_AO].data + i, *far = t.field[OUT_FAR].data + 3 * i;

        assert_int_equal(t.field_mask[OUT_AO][i], again.field_mask[OUT_AO][i]);
        if (!t.field_mask[OUT_AO][i]) continue;
        count++;
        assert_true(*ao >= 0.0f && *ao <= 1.0f && *ao == again.field[OUT_AO].data[i]);
        assert_true(far[0] >= 0.299f * *ao && far[0] <= 0.451f * *ao); /* between ground and zenith */
    }
    assert_in_range(count, 100, 24 * 14);
    truth_free(&again);
    assert_true(image_make(&cap.f0, 24, 14, 1));
    for (i = 0; i < 24 * 14; i++) cap.f0.data[i] = 0.25f;
    assert_int_equal(truth_make(&s, &sub, 0, &again), TRADE_DONE);
    for (i = 0; i < 24 * 14; i++) { /* what metals reflect is not theirs to scatter */
        assert_true(fabsf(again.model[OUT_NEAR].data[3 * i] - 0.75f * t.model[OUT_NEAR].data[3 * i]) < 1e-5f);
        assert_true(again.model[OUT_AO].data[i] == t.model[OUT_AO].data[i]);
    }
    one.bounces = HBIL_BOUNCES_RECURSIVE;
    assert_null(truth_field(&t, &one, OUT_NEAR)); /* it has one bounce */
    assert_null(truth_model(&t, &s, &one, OUT_NEAR)); /* the scene's has, too */
    assert_non_null(truth_model(&t, &s, &one, OUT_AO));
    truth_free(&t);
    truth_free(&again);
    capture_free(&cap);
    settings_free(&s);
}

static void scale(image *img, float factor)
{
    const size_t count = (size_t)img->width * (size_t)img->height * (size_t)img->channels;
    size_t       i;

    for (i = 0; img->data && i < count; i++) img->data[i] *= factor;
}

/* A small Cornell box and its truths. */
static void make_box(settings *s, capture *cap, truth *t)
{
    subject sub = {"scene:cornell", cap, 1};

    settings_default(s);
    s->scenes = "cornell";
    s->quiet = 1;
    s->cache = folder;
    assert_int_equal(settings_finish(s), TRADE_DONE);
    assert_true(capture_scene(cap, "cornell", 32, 18, 16, NULL, error, sizeof error));
    assert_int_equal(truth_make(s, &sub, 0, t), TRADE_DONE);
}

static void the_truth_has_no_error(void **state)
{
    static settings s;
    static truth    t;
    capture         cap;
    hbil_config     config = {0};
    image           out, *ao = &t.model[OUT_AO];
    errors          e;
    size_t          i;

    (void)state;
    make_box(&s, &cap, &t);
    measure_image(&s, &cap, &t, &config, OUT_AO, ao, NULL, &e);
    assert_true(e.present && e.rmse_model == 0.0 && e.edge_rmse == 0.0 && e.ring_model[2] == 0.0 && isinf(e.psnr));
    assert_true(isnan(e.rmse_sampling) && isnan(e.flicker) && e.rmse_field > 0.0 && e.ring_field[2] > 0.0);
    assert_true(image_make(&out, 32, 18, 1));
    for (i = 0; i < 32 * 18; i++) out.data[i] = t.model_mask[i] ? ao->data[i] : 0.5f; /* nor what has no truth */
    assert_true(measure_flip(&cap, &out, ao, t.model_mask, OUT_AO) == 0.0);
    image_free(&out);
    measure_image(&s, &cap, &t, &config, OUT_AO, &out, NULL, &e); /* absent */
    assert_true(!e.present && isnan(e.rmse_model) && isnan(e.ring_model[0]) && isnan(e.psnr));
    truth_free(&t);
    capture_free(&cap);
    settings_free(&s);
}

/* Near light, .1 too much everywhere. */
static void an_offset_is_in_each_measure(void **state)
{
    static settings s;
    static truth    t;
    capture         cap;
    hbil_config     config = {0};
    image           out, *near = &t.model[OUT_NEAR];
    errors          e;
    double          mean = 0.0, flip;
    size_t          i, count = 0;

    (void)state;
    make_box(&s, &cap, &t);
    assert_true(image_make(&out, 32, 18, 3));
    for (i = 0; i < 3 * 32 * 18; i++) {
        out.data[i] = near->data[i] + 0.1f;
        mean += t.model_mask[i / 3] ? (double)near->data[i] : 0.0;
        count += t.model_mask[i / 3];
    }
    mean /= (double)count;
    measure_image(&s, &cap, &t, &config, OUT_NEAR, &out, NULL, &e);
    assert_true(fabs(e.rmse_model - 0.1) < 1e-6 && fabs(e.edge_rmse - 0.1) < 1e-6);
    assert_true(fabs(e.ring_model[1] - 0.1) < 1e-6 && fabs(e.relative - 0.1 / mean) < 1e-6);
    assert_true(fabs(e.psnr - 20.0 * log10(mean / 0.18 / 0.1)) < 1e-4); /* white is where the mean is .18 */
    flip = measure_flip(&cap, &out, near, t.model_mask, OUT_NEAR);
    assert_true(flip > 0.01 && flip < 1.0);
    scale(&out, 8.0f), scale(near, 8.0f), scale(&cap.direct, 8.0f), scale(&cap.emission, 8.0f);
    assert_true(fabs(measure_flip(&cap, &out, near, t.model_mask, OUT_NEAR) - flip) < 1e-6); /* exposed */
    scale(&cap.albedo, 0.0f); /* no light on black */
    assert_true(measure_flip(&cap, &out, near, t.model_mask, OUT_NEAR) == 0.0);
    image_free(&out);
    truth_free(&t);
    capture_free(&cap);
    settings_free(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranges_and_lists),    cmocka_unit_test(faults_of_grids),
        cmocka_unit_test(random_subsets),      cmocka_unit_test(bootstrap_of_known_samples),
        cmocka_unit_test(differences_within_noise), cmocka_unit_test(warm_until_it_rests),
        cmocka_unit_test(rows_survive),        cmocka_unit_test(strange_files),
        cmocka_unit_test(rows_are_read_by_the_analysis),
        cmocka_unit_test(families_of_estimators), cmocka_unit_test(configs_from_text),
        cmocka_unit_test(truths_of_a_scene),   cmocka_unit_test(the_truth_has_no_error),
        cmocka_unit_test(an_offset_is_in_each_measure),
    };
    char command[96];
    int  failed;

    strcpy(folder, "/tmp/test_sweep.XXXXXX");
    if (!mkdtemp(folder)) return 1;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    if (system(command) != 0) return 1;
    return failed;
}
