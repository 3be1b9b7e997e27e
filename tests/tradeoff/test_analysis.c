/* test_analysis.c - metrics against numbers worked out by hand; CSV files, fronts, marginals, recommendations and
 * reports of sweeps whose results are known. */
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <sys/stat.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../examples/tradeoff/analysis.h"
#include "../../examples/tradeoff/labels.h"
#include "../../examples/tradeoff/marginals.h"
#include "../../examples/tradeoff/metrics.h"
#include "../../examples/tradeoff/recommend.h"

#define COUNT(a) (sizeof(a) / sizeof *(a))
#define NEAR(a, b, within) assert_true(fabs((double)(a) - (double)(b)) <= (within))
#define EXACT 1e-12
#define HEAD "version,config_hash,config,preset,device,driver,backend,frame,width,height,output," \
             "ms_min,ms_median,ms_max,rmse_hf,bias_hf\n"

static char folder[] = "test_analysis_XXXXXX"; /* in the working folder, removed at the end */
static char csv_path[64], log_path[64], error[1024], printed[16384];

/* ---- images ------------------------------------------------------------------------------------------------------ */

static image make_image(int width, int height, int channels)
{
    image img;

    assert_true(image_make(&img, width, height, channels));
    return img;
}

/* One row of grey pixels. */
static image row_of(int count, const float *values)
{
    image img = make_image(count, 1, 1);

    memcpy(img.data, values, (size_t)count * sizeof *values);
    return img;
}

static void sums_match_numbers_worked_out_by_hand(void **state)
{
    const float         a_values[] = {1.0f, 0.5f, 0.0f, NAN, 9.0f}, b_values[] = {0.5f, 0.5f, 1.0f, 0.5f, 0.5f};
    const unsigned char mask[] = {1, 1, 1, 1, 0};
    image               a = row_of(5, a_values), b = row_of(5, b_values), other = make_image(5, 1, 3);
    image               rgb = make_image(1, 1, 3), black = make_image(1, 1, 3);

    (void)state; /* differences .5, 0, -1, none, left out; of truths .5, .5, 1 */
    NEAR(metric_rmse(&a, &b, mask), sqrt(1.25 / 3.0), EXACT);
    NEAR(metric_bias(&a, &b, mask), -0.5 / 3.0, EXACT);
    NEAR(metric_relative(&a, &b, mask), 1.5 / 2.0, EXACT);
    NEAR(metric_psnr(&a, &b, mask, 2.0), 10.0 * log10(4.0 / (1.25 / 3.0)), 1e-9);
    NEAR(metric_bias(&a, &b, NULL), 8.0 / 4.0, EXACT);
    assert_int_equal(metric_compare(&a, &b, mask).pixels, 3);
    assert_true(isinf(metric_psnr(&b, &b, NULL, 1.0)));
    assert_true(isnan(metric_rmse(&a, &other, NULL)) && isnan(metric_psnr(&a, &other, NULL, 1.0)));
    assert_true(isnan(metric_relative(&rgb, &black, NULL))); /* mean truth 0 */
    rgb.data[0] = 3.0f, rgb.data[2] = -4.0f;                 /* channels count alike */
    NEAR(metric_rmse(&rgb, &black, NULL), sqrt(25.0 / 3.0), EXACT);
    NEAR(metric_bias(&rgb, &black, NULL), -1.0 / 3.0, EXACT);
    image_free(&a), image_free(&b), image_free(&other), image_free(&rgb), image_free(&black);
}

static void percentiles_match_numbers_worked_out_by_hand(void **state)
{
    const float         a_values[] = {4.0f, -1.0f, 2.0f, 3.0f, 100.0f}, b_values[] = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f};
    const unsigned char mask[] = {1, 1, 1, 1, 0};
    image               a = row_of(5, a_values), b = row_of(5, b_values);
    image               rgb = make_image(2, 1, 3), black = make_image(2, 1, 3);

    (void)state; /* ranks 1 2 3 4 */
    NEAR(metric_percentile(&a, &b, mask, 0.0), 1.0, EXACT);
    NEAR(metric_percentile(&a, &b, mask, 0.5), 2.5, EXACT);
    NEAR(metric_percentile(&a, &b, mask, 0.95), 3.85, 1e-9);
    NEAR(metric_percentile(&a, &b, mask, 1.0), 4.0, EXACT);
    assert_true(isnan(metric_percentile(&a, &b, mask, 1.5)));
    rgb.data[0] = 1.0f, rgb.data[1] = -7.0f, rgb.data[3] = 2.0f; /* worst channels 7 and 2 */
    NEAR(metric_percentile(&rgb, &black, NULL, 0.0), 2.0, EXACT);
    NEAR(metric_percentile(&rgb, &black, NULL, 1.0), 7.0, EXACT);
    image_free(&a), image_free(&b), image_free(&rgb), image_free(&black);
}

/* Depths 10 10 10 10 | 10.6 10.6 10.6 10.6 10.6 | sky sky: steps between 3 and 4, and 8 and 9. 10.6 to 10 is 6 % of the
 * nearer. */
static void edges_are_two_pixels_either_side_of_a_step(void **state)
{
    const float depths[] = {10, 10, 10, 10, 10.6f, 10.6f, 10.6f, 10.6f, 10.6f, 1e10f, NAN};
    const int   edge[] = {0, 0, 1, 1, 1, 1, 0, 1, 1, 1, 1};
    image       a = make_image(11, 1, 1), b = make_image(11, 1, 1), depth = row_of(11, depths);
    int         i;

    (void)state;
    for (i = 0; i < 11; i++) {
        a.data[i] = 1.0f; /* the only error */
        NEAR(metric_edge_rmse(&a, &b, NULL, &depth), edge[i] ? sqrt(1.0 / 8.0) : 0.0, EXACT);
        a.data[i] = 0.0f;
    }
    for (i = 4; i < 9; i++) depth.data[i] = 10.4f; /* 4 %: none, but for the sky */
    a.data[3] = 1.0f;
    NEAR(metric_edge_rmse(&a, &b, NULL, &depth), 0.0, EXACT);
    for (i = 0; i < 11; i++) depth.data[i] = 5.0f;
    assert_true(isnan(metric_edge_rmse(&a, &b, NULL, &depth))); /* no edge at all */
    image_free(&a), image_free(&b), image_free(&depth);
}

/* Of 10 x 1 pixels the corner is sqrt(25.25) from the centre: pixels at .5, 1.5 ... 4.5 are at .0995, .2985, .4975,
 * .6965, .8955 of it, two in each ring. */
static void rings_are_of_equal_width_from_the_centre_to_the_corner(void **state)
{
    const float         a_values[] = {0, 4, 3, 2, 1, 1, 4, 3, 4, NAN};
    const unsigned char mask[] = {1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
    image               a = row_of(10, a_values), b = make_image(10, 1, 1), rgb = make_image(1, 1, 3),
          black = make_image(1, 1, 3);
    double              rmse[METRIC_RINGS];
    int                 i;

    (void)state;
    metric_rings(&a, &b, mask, rmse);
    assert_true(rmse[0] == 1.0 && isnan(rmse[2]) && rmse[3] == 4.0 && rmse[4] == 0.0);
    NEAR(rmse[1], sqrt(10.0), EXACT); /* 2 and 4 */
    rgb.data[1] = 3.0f;
    metric_rings(&rgb, &black, NULL, rmse);
    NEAR(rmse[0], sqrt(3.0), EXACT);
    for (i = 1; i < METRIC_RINGS; i++) assert_true(isnan(rmse[i]));
    metric_rings(&rgb, &b, NULL, rmse); /* another shape */
    assert_true(isnan(rmse[0]));
    image_free(&a), image_free(&b), image_free(&rgb), image_free(&black);
}

/* Corners of a square lie in the last ring, the middles of its sides in the fourth: .7 of the corner's distance. */
static void rings_are_round(void **state)
{
    image  a = make_image(101, 101, 1), b = make_image(101, 101, 1);
    double rmse[METRIC_RINGS];

    (void)state;
    a.data[0] = a.data[100] = a.data[101 * 100] = a.data[101 * 101 - 1] = 1.0f;
    metric_rings(&a, &b, NULL, rmse);
    assert_true(rmse[4] > 0.0 && rmse[3] == 0.0);
    a.data[50] = a.data[101 * 50] = a.data[101 * 50 + 100] = a.data[101 * 100 + 50] = 1.0f;
    metric_rings(&a, &b, NULL, rmse);
    assert_true(rmse[3] > 0.0 && rmse[2] == 0.0);
    image_free(&a), image_free(&b);
}

static void flicker_is_the_deviation_over_time(void **state)
{
    image frames[2];
    int   k;

    (void)state;
    for (k = 0; k < 2; k++) {
        frames[k] = make_image(3, 1, 1);
        frames[k].data[0] = k ? 3.0f : 1.0f; /* deviation 1 */
        frames[k].data[1] = 7.0f;            /* 0 */
        frames[k].data[2] = k ? NAN : 5.0f;  /* left out */
    }
    NEAR(metric_flicker(frames, 2, NULL), 0.5, EXACT);
    NEAR(metric_flicker(frames, 2, (const unsigned char *)"\1\0\1"), 1.0, EXACT);
    assert_true(isnan(metric_flicker(frames, 1, NULL)));
    for (k = 0; k < 2; k++) image_free(&frames[k]);
}

/* ---- FLIP -------------------------------------------------------------------------------------------------------- */

static image flat(float r, float g, float b)
{
    image img = make_image(40, 30, 3);
    int   i;

    for (i = 0; i < 40 * 30; i++) img.data[3 * i] = r, img.data[3 * i + 1] = g, img.data[3 * i + 2] = b;
    return img;
}

static double flip_of(image a, image b)
{
    const double value = metric_flip(&a, &b, NULL, METRIC_FLIP_PPD, NULL);

    image_free(&a);
    image_free(&b);
    return value;
}

/* Flat images have no features: the value is that of their colours. L*a*b* of green is 87.737 -86.185 83.181, of blue
 * 32.303 79.197 -107.864; with the Hunt effect -75.616 72.981 and 25.583 -34.843. HyAB: 55.434 + |101.199, 107.824| =
 * 203.309, to the power .7: 41.280. The knee is at 16.512. Black and white are 100 apart, 25.119: .95 + .05 (25.119 -
 * 16.512) / (41.280 - 16.512) = .96738. Linear .18 and .20 have L 49.496 and 51.837: 2.341^.7 = 1.8139, .95 * 1.8139 /
 * 16.512 = .10436. */
static void flip_of_flat_images_matches_numbers_worked_out_by_hand(void **state)
{
    (void)state;
    NEAR(flip_of(flat(0.3f, 0.5f, 0.7f), flat(0.3f, 0.5f, 0.7f)), 0.0, 0.0);
    NEAR(flip_of(flat(0, 0, 0), flat(1, 1, 1)), 0.96738, 2e-5);
    NEAR(flip_of(flat(0, 1, 0), flat(0, 0, 1)), 1.0, 1e-6);
    NEAR(flip_of(flat(0.18f, 0.18f, 0.18f), flat(0.20f, 0.20f, 0.20f)), 0.10436, 2e-5);
    NEAR(flip_of(flat(0, 0, 0), flat(9, 9, 9)), 0.96738, 2e-5);       /* clamped */
    NEAR(flip_of(flat(0, 0, 0), flat(NAN, 0, -1)), 0.0, 0.0);
}

/* Ramps and waves, moved to the right by `shift` pixels, around the border. */
static image pattern(int shift)
{
    image img = make_image(96, 72, 3);
    int   x, y;

    for (y = 0; y < 72; y++) {
        for (x = 0; x < 96; x++) {
            float     *p = img.data + 3 * (y * 96 + (x + shift) % 96);

            p[0] = (float)x / 96.0f;
            p[1] = (float)y / 72.0f;
            p[2] = (float)(0.5 + 0.5 * sin(x * 0.4) * cos(y * 0.3));
        }
    }
    return img;
}

/* The numbers are those of the authors' formulas with two-dimensional filters in double, by numpy. */
static void flip_of_a_shifted_pattern_matches_the_published_formula(void **state)
{
    static unsigned char mask[96 * 72];

    image  a = pattern(0), b = pattern(1), map;
    double sum = 0.0, mean;
    int    i;

    (void)state;
    mean = metric_flip(&a, &b, NULL, METRIC_FLIP_PPD, &map);
    NEAR(mean, 0.1530490, 2e-6);
    NEAR(metric_flip(&a, &b, NULL, 30.0, NULL), 0.2026636, 2e-6);
    NEAR(metric_flip(&b, &a, NULL, METRIC_FLIP_PPD, NULL), mean, EXACT);
    for (i = 0; i < 96 * 72; i++) {
        assert_true(map.data[i] >= 0.0f && map.data[i] <= 1.0f);
        sum += (double)map.data[i] / (96.0 * 72.0);
    }
    NEAR(sum, mean, 1e-6);
    assert_true(isnan(metric_flip(&a, &b, mask, METRIC_FLIP_PPD, NULL)));
    mask[7] = mask[96 * 40] = 1;
    NEAR(metric_flip(&a, &b, mask, METRIC_FLIP_PPD, NULL), 0.5 * (double)(map.data[7] + map.data[96 * 40]), 1e-6);
    assert_true(isnan(metric_flip(&a, &b, NULL, 0.0, NULL)) && isnan(metric_flip(&a, &b, NULL, 401.0, NULL)));
    image_free(&map);
    b.width--;
    assert_true(isnan(metric_flip(&a, &b, NULL, 30.0, &map)) && !map.data);
    image_free(&a);
    image_free(&b);
}

/* ---- CSV --------------------------------------------------------------------------------------------------------- */

static void write_csv(const char *text) { assert_true(text_write(csv_path, text, error, sizeof error)); }

static void assert_refused(const char *text, const char *part)
{
    csv table;

    write_csv(text);
    assert_false(csv_read(&table, csv_path, error, sizeof error));
    if (!strstr(error, part)) fail_msg("error \"%s\" does not say \"%s\"", error, part);
    assert_true(!table.rows && !table.bytes && table.count == 0);
}

#define LINE "0.1.0,aa,slices=4,fast,GPU,1.0,vulkan,atrium,640,360,ao,1,2,3,0.25,-0.5\n"

static void csv_lines_are_read_and_faults_have_their_place(void **state)
{
    csv table;

    (void)state;
    write_csv(HEAD LINE "0.1.0,\"b\"\"b\",\"slices=4,steps=8\",,GPU,1.0,vulkan,atrium,640,360,near,,2.5,,,\r\n"
              HEAD LINE);
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    assert_int_equal(table.count, 3);
    assert_string_equal(table.note, "");
    assert_string_equal(table.rows[0].text[CSV_preset], "fast");
    assert_true(table.rows[0].number[CSV_bias_hf] == -0.5 && table.rows[0].number[CSV_width] == 640.0
                && table.rows[0].line == 2);
    assert_string_equal(table.rows[1].text[CSV_config_hash], "b\"b");
    assert_string_equal(table.rows[1].text[CSV_config], "slices=4,steps=8");
    assert_true(isnan(table.rows[1].number[CSV_bias_hf]) && isnan(table.rows[1].number[CSV_flicker]));
    csv_free(&table);

    write_csv(HEAD LINE "0.1.0,bb,slices=8,,GPU,1.0,vul"); /* stopped while it was written */
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    assert_int_equal(table.count, 1);
    assert_non_null(strstr(table.note, "csv:3: the last line has no end"));
    csv_free(&table);

    assert_refused(HEAD LINE "0.1.0,bb,slices=8\n" LINE, "csv:3: 3 fields, line 1 has 16");
    assert_refused(HEAD "0.1.0,aa,,,GPU,1.0,vulkan,atrium,640,360,ao,1,2ms,3,0.25,0\n", "csv:2: ms_median is \"2ms\"");
    assert_refused(HEAD "0.1.0,aa,,,GPU,1.0,vulkan,atrium,640,360,ao,1,2,3,-0.25,0\n", "csv:2: rmse_hf is \"-0.25\"");
    assert_refused(HEAD "0.1.0,aa,,,GPU,1.0,vulkan,atrium,640,360,ao,1,,3,0.25,0\n",
                   "csv:2: config_hash, frame or ms_median");
    assert_refused(HEAD "0.1.0,aa,,,GPU,1.0,vulkan,atrium,640,360,bent,1,2,3,0.25,0\n", "not ao, near or far");
    assert_refused("config,preset\n" LINE, "csv:1: no column config_hash");
    assert_refused(HEAD, "nothing is measured");
    assert_refused("", "nothing is measured");
    assert_false(csv_read(&table, "no/such.csv", error, sizeof error));
    assert_int_equal(csv_number("rmse_model"), CSV_rmse_model);
    assert_int_equal(csv_number("config"), -1);
}

/* ---- fronts ------------------------------------------------------------------------------------------------------ */

/* A line of the CSV; its config is its hash's, unless another is given. */
static void add(FILE *out, const char *hash, const char *config, const char *preset, const char *frame,
                const char *output, double ms, double rmse)
{
    fprintf(out, "0.1.0,%s,%s,%s,GPU,1.0,vulkan,%s,640,360,%s,,%.17g,,%.17g,\n", hash, config, preset, frame, output,
            ms, rmse);
}

/* Of two frames: time and error on the first; twice the time and three times the error on the second. */
static void add_two(FILE *out, const char *hash, const char *preset, const char *output, double ms, double rmse)
{
    char config[64];

    snprintf(config, sizeof config, "slices=%s", hash);
    add(out, hash, config, preset, "one", output, ms, rmse);
    add(out, hash, config, preset, "two", output, 2.0 * ms, 3.0 * rmse);
}

/* a b d are the front; c takes 1.25 times b's time at b's error. e lacks a frame. d's first line is measured anew
 * later. */
static void write_known(void)
{
    FILE *out = fopen(csv_path, "w");

    assert_non_null(out);
    fputs(HEAD, out);
    add(out, "d", "slices=d", "", "one", "ao", 99.0, 99.0);
    add_two(out, "b", "fast", "ao", 2.0, 0.04);
    add_two(out, "a", "", "ao", 1.0, 0.10);
    add_two(out, "c", "quality", "ao", 2.5, 0.05);
    add_two(out, "d", "balanced", "ao", 4.0, 0.02);
    add(out, "e", "slices=e", "", "one", "ao", 0.1, 0.001);
    add_two(out, "b", "fast", "near", 2.0, 0.5);
    add_two(out, "c", "quality", "near", 2.5, 0.4);
    add_two(out, "d", "balanced", "near", 4.0, 0.1);
    assert_int_equal(fclose(out), 0);
}

static points make_points(const csv *table, const char *output, const char *except, const char *only)
{
    selection s;
    points    p;

    memset(&s, 0, sizeof s);
    s.output = output;
    s.error = CSV_rmse_hf;
    s.except = except;
    s.only = only;
    if (!points_make(&p, table, &s, error, sizeof error)) fail_msg("%s", error);
    return p;
}

static void fronts_match_numbers_worked_out_by_hand(void **state)
{
    const char  *order = "abcd";
    csv          table;
    points       sets[2];
    const point *by;
    int          i;

    (void)state;
    write_known();
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    sets[0] = make_points(&table, "ao", NULL, NULL);
    sets[1] = make_points(&table, "near", NULL, NULL);
    assert_int_equal(sets[0].count, 4);
    assert_int_equal(sets[0].frame_count, 2);
    assert_int_equal(sets[0].left_out, 1);
    for (i = 0; i < 4; i++) {
        const point *p = &sets[0].list[i];

        assert_int_equal(p->row->text[CSV_config_hash][0], order[i]);
        assert_int_equal(p->on_front, order[i] != 'c');
    }
    NEAR(sets[0].list[3].ms, 4.0 * sqrt(2.0), EXACT); /* of 4 and 8 */
    NEAR(sets[0].list[3].error, 0.02 * sqrt(5.0), EXACT); /* of 1 and 3 times .02 */
    NEAR(sets[0].list[3].low, 0.02, EXACT);
    NEAR(sets[0].list[3].high, 0.06, EXACT);
    assert_true(sets[0].list[3].ms_low == 4.0 && sets[0].list[3].ms_high == 8.0);

    NEAR(front_dominated(sets, 1, "c", &by), 0.25, EXACT); /* 1.25 in time and .05 / .04 in error */
    assert_string_equal(by->row->text[CSV_config_hash], "b");
    NEAR(front_dominated(sets, 1, "d", &by), 0.0, EXACT);
    assert_null(by);
    NEAR(front_dominated(sets, 2, "c", &by), 0.0, EXACT); /* near light of c is the better one */
    NEAR(front_dominated(sets + 1, 1, "c", NULL), 0.0, EXACT);
    assert_ptr_equal(points_find(&sets[0], "balanced"), &sets[0].list[3]);
    assert_ptr_equal(points_find(&sets[0], "slices=b"), &sets[0].list[1]);
    assert_null(points_find(&sets[0], "e"));
    for (i = 0; i < 2; i++) points_free(&sets[i]);
    csv_free(&table);
}

/* Of two frames: errors by their squares, the rest plain; a frame without a value leaves none. */
static void columns_are_averaged_as_they_say(void **state)
{
    csv    table;
    points p;

    (void)state;
    write_csv("config_hash,config,preset,device,backend,frame,output,ms_median,rmse_hf,ring5_hf,edge_rmse,psnr,flip,"
              "ring1_hf\n"
              "aa,slices=4,,GPU,vulkan,one,ao,1,.1,1,3,-10,.2,1\n"
              "aa,slices=4,,GPU,vulkan,two,ao,1,.1,7,4,30,.4,\n");
    if (!csv_read(&table, csv_path, error, sizeof error)) fail_msg("%s", error);
    p = make_points(&table, "ao", NULL, NULL);
    NEAR(p.list[0].mean[CSV_ring5_hf], 5.0, EXACT);
    NEAR(p.list[0].mean[CSV_edge_rmse], sqrt(12.5), EXACT);
    NEAR(p.list[0].mean[CSV_psnr], 10.0, EXACT);
    NEAR(p.list[0].mean[CSV_flip], 0.3, EXACT);
    NEAR(p.list[0].mean[CSV_ring1_hf], 1.0, EXACT); /* of the one frame that has it */
    assert_true(points_know(&p, CSV_ring5_hf) && !points_know(&p, CSV_ring1_model));
    points_free(&p);
    csv_free(&table);
}

static void what_cannot_be_compared_is_refused(void **state)
{
    csv       table;
    points    p;
    selection s;

    (void)state;
    memset(&s, 0, sizeof s);
    s.output = "ao";
    s.error = CSV_rmse_model;
    write_csv(HEAD LINE "0.1.0,aa,slices=4,fast,GPU,1.0,gl,atrium,640,360,ao,1,2,3,0.25,-0.5\n");
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    assert_false(points_make(&p, &table, &s, error, sizeof error));
    assert_non_null(strstr(error, "no rmse_model of ao is measured. Errors of ao there: rmse_hf"));
    s.error = CSV_rmse_hf;
    assert_false(points_make(&p, &table, &s, error, sizeof error));
    assert_non_null(strstr(error, "lines 2 and 3 are of vulkan on GPU and of gl on GPU"));
    s.backend = "gl";
    assert_true(points_make(&p, &table, &s, error, sizeof error));
    assert_true(p.count == 1 && p.list[0].row->line == 3);
    points_free(&p);
    csv_free(&table);
}

/* ---- marginals --------------------------------------------------------------------------------------------------- */

/* error = .1 * slices^-1 * (1, .5, .4 without, with 3x3, with 5x5); time = slices * (1, 2, 3). The means of a lopsided
 * sample must not show: 16 slices are measured without a filter only. noise=ign is measured with nothing else the same.
 * */
static void write_grid(void)
{
    static const char *const filters[] = {"none", "3x3", "5x5"};
    static const double      errors[] = {1.0, 0.5, 0.4};
    const int                slices[] = {1, 3, 16};
    char                     config[128], hash[32];
    FILE                    *out = fopen(csv_path, "w");
    int                      i, k, steps;

    assert_non_null(out);
    fputs(HEAD, out);
    for (i = 0; i < 3; i++) {
        for (k = 0; k < (i == 2 ? 1 : 3); k++) {
            for (steps = 4; steps <= 6; steps += 2) {
                config[0] = 0; /* as hbil_config_print does: 3 slices, 6 steps and no filter are defaults */
                if (slices[i] != 3) snprintf(config, sizeof config, "slices=%d ", slices[i]);
                if (steps != 6) snprintf(config + strlen(config), 32, "steps=%d ", steps);
                if (k > 0) snprintf(config + strlen(config), 32, "filter=%s ", filters[k]);
                if (config[0]) config[strlen(config) - 1] = 0;
                snprintf(hash, sizeof hash, "h%d%d%d", i, k, steps);
                add(out, hash, config, "", "one", "ao", slices[i] * (k + 1.0) * steps,
                    0.1 / slices[i] * errors[k] / steps);
            }
        }
    }
    add(out, "odd", "slices=5 steps=9 noise=ign", "", "one", "ao", 7.0, 7.0);
    assert_int_equal(fclose(out), 0);
}

static const marginal *find_marginal(const marginal *list, int count, const char *option)
{
    int i;

    for (i = 0; i < count; i++)
        if (strcmp(list[i].option, option) == 0) return &list[i];
    return NULL;
}

static void marginals_match_the_factors_that_made_the_sweep(void **state)
{
    const marginal *m;
    marginal       *list;
    points          p;
    csv             table;
    char            value[MARGINAL_TEXT];
    int             count;

    (void)state;
    write_grid();
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    p = make_points(&table, "ao", NULL, NULL);
    list = marginals_make(&p, &count);
    assert_non_null(list);
    assert_int_equal(count, 3);
    m = find_marginal(list, count, "slices");
    assert_non_null(m);
    assert_int_equal(m->values, 4); /* 1 3 5 16 */
    assert_string_equal(m->value[1], "3");
    assert_true(m->error[0] == 1.0 && m->pairs[1] == 6 && m->pairs[3] == 2 && m->pairs[2] == 0 && isnan(m->error[2]));
    NEAR(m->error[1], 1.0 / 3.0, 1e-9);
    NEAR(m->error[3], 1.0 / 16.0, 1e-9);
    NEAR(m->ms[3], 16.0, 1e-9);
    m = find_marginal(list, count, "filter"); /* in the order of hbil.h */
    assert_non_null(m);
    assert_string_equal(m->value[0], "none");
    NEAR(m->error[1], 0.5, 1e-9);
    NEAR(m->error[2], 0.4, 1e-9);
    NEAR(m->ms[2], 3.0, 1e-9);
    assert_null(find_marginal(list, count, "noise"));
    free(list);
    points_free(&p);
    csv_free(&table);
    config_value("slices=4 filter=3x3,steps=8", "steps", value);
    assert_string_equal(value, "8");
    config_value("slices=4", "filter", value); /* what hbil.h has */
    assert_string_equal(value, "none");
    config_value("sweep_stride=3", "stride", value);
    assert_string_equal(value, "default");
}

static void the_grid_of_slices_and_steps_is_the_fullest(void **state)
{
    points p;
    csv    table;
    grid   g;
    int    x, y;

    (void)state;
    write_grid();
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    p = make_points(&table, "ao", NULL, NULL);
    assert_true(grid_make(&g, &p));
    assert_int_equal(g.columns, 3); /* without a filter; 5 slices with 9 steps stand alone */
    assert_int_equal(g.rows, 2);
    for (y = 0; y < 2; y++) {
        for (x = 0; x < 3; x++) {
            assert_non_null(g.cell[y][x]);
            NEAR(g.cell[y][x]->error, 0.1 / g.slices[x] / g.steps[y], 1e-12);
        }
    }
    points_free(&p);
    csv_free(&table);
}

/* ---- labels ------------------------------------------------------------------------------------------------------ */

/* Twelve points in a heap, one in a corner: the names lie on no other, on no point, and within the area. */
static void labels_keep_off_each_other_and_off_points(void **state)
{
    label list[13];
    spot  spots[13];
    int   i, k, t;

    (void)state;
    for (i = 0; i < 13; i++) {
        const spot at = {i < 12 ? 180.0 + 24.0 * (i % 4) : 395.0, i < 12 ? 130.0 + 24.0 * (i / 4) : 295.0};

        memset(&list[i], 0, sizeof list[i]);
        spots[i] = list[i].of = at;
        list[i].width = 60.0;
        list[i].height = 14.0;
    }
    labels_place(list, 13, spots, 13, 400.0, 300.0);
    for (i = 0; i < 13; i++) {
        const spot m = list[i].middle;

        assert_true(m.x >= 30.0 && m.x <= 370.0 && m.y >= 7.0 && m.y <= 293.0);
        assert_true(hypot(m.x - spots[i].x, m.y - spots[i].y) < 100.0);
        for (k = 0; k < 13; k++) {
            assert_false(fabs(spots[k].x - m.x) < 30.0 && fabs(spots[k].y - m.y) < 7.0);
            assert_false(k != i && fabs(list[k].middle.x - m.x) < 60.0 && fabs(list[k].middle.y - m.y) < 14.0);
            for (t = 0; k != i && t < 10; t++) /* nor does a line from a name to its point pass through another */
                assert_false(fabs(spots[k].x + 0.1 * t * (list[k].middle.x - spots[k].x) - m.x) < 30.0
                             && fabs(spots[k].y + 0.1 * t * (list[k].middle.y - spots[k].y) - m.y) < 7.0);
        }
    }
    spots[1].x = spots[0].x + 40.0; /* a point without a name */
    labels_place(list, 1, spots, 2, 400.0, 300.0);
    assert_true(fabs(spots[1].x - list[0].middle.x) > 30.0 || fabs(spots[1].y - list[0].middle.y) > 7.0);
    labels_place(list, 1, spots, 1, 400.0, 300.0);
    assert_true(list[0].middle.x > spots[0].x && list[0].middle.y == spots[0].y); /* alone: to the right */
}

/* ---- recommendations --------------------------------------------------------------------------------------------- */

static void recommendations_are_the_known_ones(void **state)
{
    const wish   budget = {5.0, 0.0}, little = {1.0, 0.0}, exact = {0.0, 0.1}, both = {2.0, 0.1};
    const wish   impossible = {0.0, 0.01};
    csv          table;
    points       p, one;
    const point *best;
    char        *command;

    (void)state; /* ms 1.41 2.83 3.54 5.66, error .224 .089 .112 .045 */
    write_known();
    assert_true(csv_read(&table, csv_path, error, sizeof error));
    p = make_points(&table, "ao", NULL, NULL);
    best = recommend_choose(&p, &budget);
    assert_non_null(best);
    assert_string_equal(best->row->text[CSV_config_hash], "b"); /* not c, which fits but is no better */
    assert_ptr_equal(recommend_neighbour(&p, best, -1), &p.list[0]);
    assert_ptr_equal(recommend_neighbour(&p, best, 1), &p.list[3]);
    assert_null(recommend_neighbour(&p, &p.list[0], -1));
    assert_null(recommend_neighbour(&p, &p.list[3], 1));
    assert_ptr_equal(recommend_choose(&p, &exact), best);
    assert_null(recommend_choose(&p, &little));
    assert_null(recommend_choose(&p, &both));
    assert_null(recommend_choose(&p, &impossible));
    points_free(&p);

    p = make_points(&table, "ao", "two", NULL); /* frame two is three times as hard: an anchor tells */
    one = make_points(&table, "ao", NULL, "two");
    best = points_find(&p, "b");
    NEAR(recommend_predict(&p, best, NULL, NULL, CSV_rmse_hf), 0.04, EXACT);
    NEAR(recommend_predict(&p, best, points_find(&p, "d"), points_find(&one, "d")->row, CSV_rmse_hf), 0.12, EXACT);
    points_free(&one);
    points_free(&p);
    csv_free(&table);
    command = recommend_command("outputs=ao+near slices=4");
    assert_string_equal(command, "shadergen --set outputs=ao+near,slices=4");
    free(command);
    command = recommend_command("");
    assert_string_equal(command, "shadergen");
    free(command);
}

/* Error^2 is sampling^2 + rest^2. Frame two has twice the sampling error of the anchor and its own rest. */
static void a_prediction_scales_the_samples_and_keeps_the_rest(void **state)
{
    static const struct { const char *hash, *frame; double sampling, rest, estimator; } rows[] = {
        {"a", "one", 0.03, 0.04, 0.05}, {"b", "one", 0.06, 0.04, 0.05}, {"c", "one", 0.03, 0.08, 0.09},
        {"a", "two", 0.05, 0.12, 0.13}, {"b", "two", 0.10, 0.12, 0.13}, {"c", "two", 0.05, 0.24, 0.25},
    };
    csv_row      row[6];
    const csv_row *of[6];
    point        point_of[3];
    points       p;
    size_t       i;

    (void)state;
    memset(row, 0, sizeof row);
    memset(point_of, 0, sizeof point_of);
    memset(&p, 0, sizeof p);
    for (i = 0; i < 6; i++) {
        row[i].number[CSV_rmse_sampling] = rows[i].sampling;
        row[i].number[CSV_rmse_hf] = hypot(rows[i].sampling, rows[i].rest);
        row[i].number[CSV_rmse_estimator] = rows[i].estimator;
        row[i].text[CSV_config_hash] = row[i].text[CSV_preset] = row[i].text[CSV_config] = rows[i].hash;
        of[i] = &row[i];
        if (i < 3) {
            point_of[i].row = &row[i];
            point_of[i].rows = &of[i];
        }
    }
    p.list = point_of;
    p.count = 3;
    p.frame_count = 1;
    /* the same estimator: the rest of frame two as it is; another one: as much larger as on frame one */
    NEAR(recommend_predict(&p, &point_of[1], &point_of[0], &row[3], CSV_rmse_hf), hypot(0.10, 0.12), EXACT);
    NEAR(recommend_predict(&p, &point_of[2], &point_of[0], &row[3], CSV_rmse_hf), hypot(0.05, 0.24), EXACT);
    assert_ptr_equal(recommend_anchor(&p, "b,a", &point_of[2], CSV_rmse_hf), &point_of[0]);
    assert_ptr_equal(recommend_anchor(&p, "b,c", &point_of[2], CSV_rmse_hf), &point_of[1]); /* not itself */
    assert_null(recommend_anchor(&p, "a,d", &point_of[2], CSV_rmse_hf));
}

/* ---- command lines ----------------------------------------------------------------------------------------------- */

/* Words are separated by single blanks. The exit code; what was written is in `printed`. */
static int run(const char *line)
{
    char  words[512], program[] = "hbil-tradeoff", *argv[32], *word;
    FILE *in;
    int   argc = 1, code, log, out = dup(STDOUT_FILENO), err = dup(STDERR_FILENO);

    snprintf(words, sizeof words, "%s", line);
    argv[0] = program;
    for (word = strtok(words, " "); word; word = strtok(NULL, " ")) argv[argc++] = word;
    fflush(stdout);
    log = open(log_path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_true(log >= 0 && dup2(log, STDOUT_FILENO) >= 0 && dup2(log, STDERR_FILENO) >= 0);
    code = analysis_main(argc, argv);
    fflush(stdout);
    dup2(out, STDOUT_FILENO), dup2(err, STDERR_FILENO);
    close(log), close(out), close(err);
    in = fopen(log_path, "r");
    assert_non_null(in);
    printed[fread(printed, 1, sizeof printed - 1, in)] = 0;
    fclose(in);
    return code;
}

static void assert_run(int code, const char *options, const char *part)
{
    char line[512];
    int  got;

    snprintf(line, sizeof line, options, csv_path);
    got = run(line);
    if (got != code || !strstr(printed, part))
        fail_msg("%s: exit code %d, not %d, or no \"%s\" in:\n%s", line, got, code, part, printed);
}

static void command_lines_end_with_the_documented_exit_codes(void **state)
{
    FILE *out;

    (void)state;
    write_known();
    assert_run(0, "--help", "usage: hbil-tradeoff report");
    assert_run(0, "recommend --csv %s --budget-ms 5",
               "best      slices=b (fast)\n          rmse_hf of ao 0.0894 (0.0400 to 0.1200 over 2");
    assert_run(0, "recommend --csv %s --budget-ms 5", "shadergen --set slices=b\n");
    assert_run(0, "recommend --csv %s --as-fast-as c", "shadergen --set slices=b\n"); /* b is faster, and better */
    assert_run(1, "recommend --csv %s --as-fast-as e", "--as-fast-as e: not measured on all frames");
    assert_run(0, "recommend --csv %s --max-rmse 0.3 --output near", "best      slices=d (balanced)");
    assert_run(1, "recommend --csv %s --budget-ms 1", "nothing fits: the fastest of 4 configs takes 1.414 ms");
    assert_run(1, "recommend --csv %s --budget-ms 1 --output far", "no rmse_hf of far is measured");
    assert_run(1, "recommend --csv %s --budget-ms 3 --holdout two", "+200.0 %: beyond 25 %");
    assert_run(0, "recommend --csv %s --budget-ms 3 --holdout two --anchor d", "+0.0 %: within 25 %");
    assert_run(0, "recommend --csv %s --budget-ms 5 --holdout all --anchor balanced", "is the choice itself");
    assert_run(0, "recommend --csv %s --budget-ms 5 --holdout all --anchor fast,balanced", "2 of 2 within 25 %");
    out = fopen(csv_path, "a"); /* a frame that has met one config only: d has .1 there, b twice that everywhere */
    assert_non_null(out);
    add(out, "d", "slices=d", "balanced", "new", "ao", 4.0, 0.1);
    assert_int_equal(fclose(out), 0);
    assert_run(0, "recommend --csv %s --budget-ms 3 --holdout new --anchor d",
               "predicted rmse_hf of ao 0.2000 from 2 other frames");
    assert_run(2, "recommend --csv %s --budget-ms 3 --holdout three",
               "no such frame of ao. There are: all one two new");
    assert_run(2, "recommend --csv %s", "--budget-ms, --as-fast-as or --max-rmse is missing");
    assert_run(2, "recommend --csv %s --budget-ms -1", "--budget-ms -1: not understood");
    assert_run(2, "recommend --csv %s --budget-ms 1 --output bent", "--output bent: not understood");
    assert_run(2, "recommend --csv %s --budget-ms 1 --error bias_hf", "--error bias_hf: not understood");
    assert_run(2, "recommend --budget-ms 1", "--csv FILE is missing");
    assert_run(2, "report --csv %s", "-o DIR is missing");
    assert_run(2, "report --csv %s -o", "-o (no value): not understood");
    assert_run(2, "sweep", "usage");
    assert_run(3, "recommend --csv no/such.csv --budget-ms 1", "no/such.csv: cannot be opened");
    assert_run(3, "report --csv %s -o no/such/folder", "cannot be made");
}

/* ---- reports ----------------------------------------------------------------------------------------------------- */

static const char *const drawn[] = {"ao-front", "ao-options", "ao-grid", "ao-rings"};
#define DRAWN_OF_GRID 3 /* of write_grid, which has no rings */

static char *read_file(const char *name)
{
    char path[128], *text;

    snprintf(path, sizeof path, "%s/report/%s", folder, name);
    text = text_read(path, (size_t)1 << 24, "a file of the report", error, sizeof error);
    if (!text) fail_msg("%s", error);
    return text;
}

static void need_gnuplot(void)
{
    if (system("command -v gnuplot >/dev/null 2>&1") == 0) return;
    puts("skipped: no gnuplot (Debian: gnuplot-nox)");
    skip();
}

static void reports_have_tables_and_pictures(void **state)
{
    char   options[128], name[64], *text;
    size_t i;

    (void)state;
    need_gnuplot();
    write_grid();
    snprintf(options, sizeof options, "report --csv %%s -o %s/report", folder);
    assert_run(0, options, "report/report.md");
    text = read_file("report.md");
    assert_non_null(strstr(text, "## ao"));
    assert_non_null(strstr(text, "15 configs, hbil 0.1.0, vulkan: GPU, 1.0. `rmse_hf`"));
    assert_non_null(strstr(text, "|  | 4 | 0.0250 | `slices=1 steps=4` |\n"));
    assert_non_null(strstr(text, "| `slices=1` | 1.000 | 1.000 | - |\n| `slices=3` | 0.333 | 3.000 | 6 |\n"
                                 "| `slices=16` |"));
    assert_non_null(strstr(text, "distance from the image's centre: left out"));
    for (i = 0; i < DRAWN_OF_GRID; i++) {
        snprintf(name, sizeof name, "](%s.svg)", drawn[i]);
        assert_non_null(strstr(text, name));
    }
    free(text);
    for (i = 0; i < DRAWN_OF_GRID; i++) {
        snprintf(name, sizeof name, "%s.svg", drawn[i]);
        text = read_file(name);
        assert_true(strstr(text, "<svg") && strstr(text, "</svg>"));
        assert_non_null(strstr(text, i == 0 ? "Pareto front" : i == 1 ? "slices" : "steps"));
        free(text);
        snprintf(name, sizeof name, "%s.png", drawn[i]);
        text = read_file(name);
        assert_memory_equal(text, "\x89PNG\r\n\x1a\n", 8);
        free(text);
    }
}

/* A line for each preset and for both ends of the front, for nothing else; a panel for what is measured. An error of 0
 * does no harm to logarithms. */
static void error_by_distance_is_drawn(void **state)
{
    char options[128], *text;

    (void)state;
    need_gnuplot();
    write_csv("config_hash,config,preset,device,backend,frame,output,ms_median,rmse_hf,edge_rmse,psnr,flip,ring1_hf,"
              "ring2_hf,ring3_hf,ring4_hf,ring5_hf,ring1_model,ring2_model,ring3_model,ring4_model,ring5_model\n"
              "aa,slices=1,,GPU,vulkan,one,ao,1,.4,.5,8.06,.25,.1,.2,.3,.4,.5,,,,,\n"
              "bb,slices=2,,GPU,vulkan,one,ao,2,.3,.5,8.06,.25,.1,.2,.3,.4,.5,,,,,\n"
              "cc,slices=3,it's,GPU,vulkan,one,ao,3,.2,.5,8.06,.25,.1,.2,.3,.4,,,,,,\n"
              "dd,slices=4,,GPU,vulkan,one,ao,4,0,.5,8.06,.25,.1,.2,.3,.4,.5,,,,,\n");
    snprintf(options, sizeof options, "report --csv %%s -o %s/report", folder);
    assert_run(0, options, "report/report.md");
    text = read_file("report.md");
    assert_non_null(strstr(text, "](ao-rings.svg)"));
    assert_non_null(strstr(text, "| preset | ms | rmse_hf | edge_rmse | psnr | flip | config |\n"));
    assert_non_null(strstr(text, "| `it's` | 3 | 0.2000 | 0.5000 | 8.1 | 0.2500 | `slices=3` |\n"));
    free(text);
    text = read_file("ao-rings.svg");
    assert_true(strstr(text, "fastest of all") && strstr(text, "it's") && strstr(text, "most accurate of all"));
    assert_true(strstr(text, "gnuplot_plot_3") && !strstr(text, "gnuplot_plot_4")); /* none for slices=2 */
    assert_true(strstr(text, "against the height field") && !strstr(text, "against the scene"));
    free(text);
    text = read_file("ao-rings.png");
    assert_memory_equal(text, "\x89PNG\r\n\x1a\n", 8);
    free(text);
}

static void a_missing_gnuplot_is_named_with_its_package(void **state)
{
    char  options[128], *path = strdup(getenv("PATH") ? getenv("PATH") : "");

    (void)state;
    write_known();
    setenv("PATH", "/nonexistent", 1);
    snprintf(options, sizeof options, "report --csv %%s -o %s/report", folder);
    assert_run(3, options, "gnuplot is missing. Install it (Debian: apt-get install gnuplot-nox)");
    snprintf(options, sizeof options, "report --csv %%s -o %s/report --no-plots", folder);
    assert_run(0, options, "report/report.md");
    assert_run(1, "report --csv %s -o . --no-plots --error rmse_model", "Errors of ao there: rmse_hf");
    setenv("PATH", path, 1);
    free(path);
    path = read_file("report.md");
    assert_non_null(strstr(path, "## near"));
    assert_non_null(strstr(path, "| option | error | time | pairs |"));
    assert_non_null(strstr(path, "| `quality` | 3.536 | 2.5 to 5 | 0.1118 | 0.0500 to 0.1500 | 25.0 %: 2.828 ms, "
                                 "0.0894 | `slices=c` |"));
    free(path);
}

/* ------------------------------------------------------------------------------------------------------------------ */

static int make_folder(void **state)
{
    (void)state;
    if (!mkdtemp(folder)) return -1;
    snprintf(csv_path, sizeof csv_path, "%s/sweep.csv", folder);
    snprintf(log_path, sizeof log_path, "%s/log", folder);
    return 0;
}

static int remove_folder(void **state)
{
    char   path[128];
    size_t i;

    (void)state;
    for (i = 0; i < 2 * COUNT(drawn); i++) {
        snprintf(path, sizeof path, "%s/report/%s.%s", folder, drawn[i / 2], i % 2 ? "png" : "svg");
        remove(path);
    }
    snprintf(path, sizeof path, "%s/report/report.md", folder);
    remove(path);
    snprintf(path, sizeof path, "%s/report", folder);
    rmdir(path);
    remove(csv_path);
    remove(log_path);
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_match_numbers_worked_out_by_hand),
        cmocka_unit_test(percentiles_match_numbers_worked_out_by_hand),
        cmocka_unit_test(edges_are_two_pixels_either_side_of_a_step),
        cmocka_unit_test(rings_are_of_equal_width_from_the_centre_to_the_corner),
        cmocka_unit_test(rings_are_round),
        cmocka_unit_test(flicker_is_the_deviation_over_time),
        cmocka_unit_test(flip_of_flat_images_matches_numbers_worked_out_by_hand),
        cmocka_unit_test(flip_of_a_shifted_pattern_matches_the_published_formula),
        cmocka_unit_test(csv_lines_are_read_and_faults_have_their_place),
        cmocka_unit_test(fronts_match_numbers_worked_out_by_hand),
        cmocka_unit_test(columns_are_averaged_as_they_say),
        cmocka_unit_test(what_cannot_be_compared_is_refused),
        cmocka_unit_test(marginals_match_the_factors_that_made_the_sweep),
        cmocka_unit_test(the_grid_of_slices_and_steps_is_the_fullest),
        cmocka_unit_test(labels_keep_off_each_other_and_off_points),
        cmocka_unit_test(recommendations_are_the_known_ones),
        cmocka_unit_test(a_prediction_scales_the_samples_and_keeps_the_rest),
        cmocka_unit_test(command_lines_end_with_the_documented_exit_codes),
        cmocka_unit_test(reports_have_tables_and_pictures),
        cmocka_unit_test(error_by_distance_is_drawn),
        cmocka_unit_test(a_missing_gnuplot_is_named_with_its_package),
    };

    return cmocka_run_group_tests_name("analysis", tests, make_folder, remove_folder);
}
