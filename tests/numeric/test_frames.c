/* test_frames.c - what becomes of a march over pixels and frames: filters, running mean, recursive bounces, the coarser
 * grid, cameras that move, views beside each other. HBIL_LONG=1: whole captures instead of every second pixel. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../captures.h"
#include "decimate.h"
#include "gpu.h"

#define SKY 1e9f /* m: sky_depth of captures */

/* --- what all tests begin with ----------------------------------------------------------------------------------- */

static hbil_config config_of(const char *base, const char *more)
{
    hbil_config c;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, base, strlen(base), NULL), HBIL_OK);
    assert_int_equal(hbil_config_parse(&c, more, strlen(more), NULL), HBIL_OK);
    return c;
}

/* The last of `frames` frames of a still camera, of which the first has the given index. */
static void run_still(const hbil_config *config, const gpu_input *scene, uint32_t first, int frames, gpu_output *out)
{
    gpu_input in = *scene;
    memset(out, 0, sizeof *out);
    for (int f = 0; f < frames; ++f) {
        gpu_free(out);
        in.frame.index = first + (uint32_t)f;
        in.frame.reset = f == 0;
        gpu_run(config, &in, out);
    }
}

/* Calls check for every single-frame capture; fails after the last one if any failed. */
static void for_all(int (*check)(const char *name, const capture *cap))
{
    const capture_names list = captures_list();
    int                 failed = 0;
    if (!list.count) {
        print_message("HBIL_CAPTURES is not set, or holds no frame: skipped\n");
        skip();
    }
    for (int i = 0; i < list.count; ++i) {
        capture cap;
        char    error[512] = "";
        if (captures_has(list.name[i], 1)) {
            continue;
        }
        if (!captures_load(list.name[i], 0, &cap, error, sizeof error)) {
            fail_msg("%s", error);
        }
        assert_true(getenv("HBIL_LONG") || decimate(&cap, 2));
        failed += !check(list.name[i], &cap);
        capture_free(&cap);
    }
    assert_int_equal(failed, 0);
}

/* --- noise ------------------------------------------------------------------------------------------------------- */

static const char k_noisy[] = "outputs=ao+near slices=2 steps=4";

typedef struct field { double *ao, *near; } field; /* of every pixel: 1 and 3 numbers */

static void field_make(field *f, const capture *cap)
{
    f->ao = calloc((size_t)(cap->width * cap->height), sizeof *f->ao);
    f->near = calloc((size_t)(3 * cap->width * cap->height), sizeof *f->near);
    assert_true(f->ao && f->near);
}

static void field_free(field *f)
{
    free(f->ao);
    free(f->near);
}

/* Adds share * the output to the field, or share * its square. */
static void field_add(field *f, const gpu_output *o, double share, int square)
{
    const int pixels = o->ao.width * o->ao.height;
    for (int k = 0; k < pixels; ++k) {
        const double a = (double)o->ao.data[k];
        f->ao[k] += share * a * (square ? a : 1.0);
        for (int c = 0; c < 3; ++c) {
            const double n = (double)o->near.data[4 * k + c];
            f->near[3 * k + c] += share * n * (square ? n : 1.0);
        }
    }
}

/* Mean of raw frames with other seeds than those of the tests. */
static void mean_of_frames(const capture *cap, int count, field *out)
{
    const hbil_config raw = config_of(k_noisy, "");
    gpu_input         in = gpu_input_of(cap);
    field_make(out, cap);
    for (int f = 0; f < count; ++f) {
        gpu_output o;
        in.frame.index = 1000u + (uint32_t)f;
        gpu_run(&raw, &in, &o);
        field_add(out, &o, 1.0 / count, 0);
        gpu_free(&o);
    }
}

/* A pixel with a neighbour of another depth. */
static int is_edge(const capture *cap, int x, int y)
{
    const float z = cap->depth.data[y * cap->width + x];
    for (int i = 0; i < 9; ++i) {
        const int u = x + i % 3 - 1, v = y + i / 3 - 1;
        if (u < 0 || v < 0 || u >= cap->width || v >= cap->height) {
            continue;
        }
        const float d = cap->depth.data[v * cap->width + u];
        if (d > 1.1f * z || z > 1.1f * d) {
            return 1;
        }
    }
    return 0;
}

typedef struct noise { double ao, near, edge_ao, edge_near; } noise; /* RMSE; edge: at silhouettes */

static noise noise_of(const capture *cap, const gpu_output *o, const field *truth)
{
    noise  sum = {0};
    double count = 0.0, edges = 1e-9;
    for (int k = 0; k < cap->width * cap->height; ++k) {
        const double a = pow((double)o->ao.data[k] - truth->ao[k], 2.0);
        double       n = 0.0;
        if (cap->depth.data[k] >= SKY) {
            continue;
        }
        for (int c = 0; c < 3; ++c) {
            n += pow((double)o->near.data[4 * k + c] - truth->near[3 * k + c], 2.0) / 3.0;
        }
        sum.ao += a;
        sum.near += n;
        count += 1.0;
        if (is_edge(cap, k % cap->width, k / cap->width)) {
            sum.edge_ao += a;
            sum.edge_near += n;
            edges += 1.0;
        }
    }
    const noise out = {sqrt(sum.ao / count), sqrt(sum.near / count), sqrt(sum.edge_ao / edges), sqrt(sum.edge_near / edges)};
    return out;
}

static noise run_noise(const capture *cap, const char *more, int frames, const field *truth)
{
    const hbil_config config = config_of(k_noisy, more);
    const gpu_input   in = gpu_input_of(cap);
    gpu_output        o;
    run_still(&config, &in, 0, frames, &o);
    const noise n = noise_of(cap, &o, truth);
    gpu_free(&o);
    return n;
}

static int check_noise(const char *name, const capture *cap)
{
    const int mean_frames = getenv("HBIL_LONG") ? 512 : 160; /* their noise is a twelfth of a frame's */
    static const struct { const char *config; int frames; double least; } rows[] = {
        {"filter=5x5", 1, 3.0}, {"temporal=yes", 12, 3.0}, {"temporal=yes filter=5x5", 12, 6.0},
        {"filter=3x3 filter_passes=2", 1, 3.0}, {"temporal=yes rectify=range", 12, 3.0},
        {"temporal=yes filter=5x5 storage=half", 12, 6.0}};
    field truth;
    int   good = 1;
    mean_of_frames(cap, mean_frames, &truth);
    const noise raw = run_noise(cap, "", 1, &truth);
    print_message("%s %dx%d, against the mean of %d frames: RMSE of ao %.4f, near %.4f\n", name, cap->width, cap->height,
                  mean_frames, raw.ao, raw.near);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; ++i) {
        const noise n = run_noise(cap, rows[i].config, rows[i].frames, &truth);
        const int   fits = raw.ao >= rows[i].least * n.ao && raw.near >= rows[i].least * n.near && n.edge_ao <= raw.edge_ao
                           && n.edge_near <= raw.edge_near;
        print_message("  %-38s less by ao %5.2f near %5.2f; at silhouettes ao %5.2f near %5.2f%s\n", rows[i].config, raw.ao / n.ao,
                      raw.near / n.near, raw.edge_ao / n.edge_ao, raw.edge_near / n.edge_near, fits ? "" : "  TOO LITTLE");
        good &= fits;
    }
    field_free(&truth);
    return good;
}

static void noise_falls_by_filter_and_running_mean(void **state)
{
    (void)state;
    for_all(check_noise);
}

/* One slice: the ratio of each pixel is biased, that of filtered sums is not. */
static int check_one_slice(const char *name, const capture *cap)
{
    const hbil_config one = config_of("outputs=ao+near slices=1 steps=8", "filter=5x5 filter_passes=2");
    const hbil_config many = config_of("outputs=ao+near slices=16 steps=8", "");
    const hbil_config biased = config_of("outputs=ao+near slices=1 steps=8", "");
    const gpu_input   in = gpu_input_of(cap);
    double            mean[3] = {0.0, 0.0, 0.0};
    gpu_output        o[3];
    int               count = 0;
    run_still(&one, &in, 0, 1, &o[0]);
    run_still(&many, &in, 0, 1, &o[1]);
    run_still(&biased, &in, 0, 1, &o[2]);
    for (int k = 0; k < cap->width * cap->height; ++k) {
        if (cap->depth.data[k] < SKY) {
            for (int i = 0; i < 3; ++i) {
                mean[i] += (double)o[i].ao.data[k];
            }
            ++count;
        }
    }
    for (int i = 0; i < 3; ++i) {
        gpu_free(&o[i]);
    }
    print_message("%s: mean ao of 16 slices %.4f; of one slice, sums filtered %+.4f, ratio per pixel %+.4f\n", name, mean[1] / count,
                  (mean[0] - mean[1]) / count, (mean[2] - mean[1]) / count);
    return fabs(mean[0] - mean[1]) < 0.008 * count && fabs(mean[0] - mean[1]) < 0.7 * fabs(mean[2] - mean[1]);
}

static void one_slice_is_divided_after_the_filter(void **state)
{
    (void)state;
    for_all(check_one_slice);
}

/* --- flicker ----------------------------------------------------------------------------------------------------- */

static int check_flicker(const char *name, const capture *cap)
{
    enum { FIRST = 16, COUNT = 16 };
    const hbil_config config = config_of(k_noisy, "temporal=yes history=32 filter=5x5 filter_passes=3");
    gpu_input         in = gpu_input_of(cap);
    field             mean, square;
    double            ao = 0.0, near = 0.0, light = 0.0;
    int               count = 0;
    field_make(&mean, cap);
    field_make(&square, cap);
    for (int f = 0; f < FIRST + COUNT; ++f) {
        gpu_output o;
        in.frame.index = (uint32_t)f;
        in.frame.reset = f == 0;
        gpu_run(&config, &in, &o);
        if (f >= FIRST) {
            field_add(&mean, &o, 1.0 / COUNT, 0);
            field_add(&square, &o, 1.0 / COUNT, 1);
        }
        gpu_free(&o);
    }
    for (int k = 0; k < cap->width * cap->height; ++k) {
        if (cap->depth.data[k] >= SKY) {
            continue;
        }
        ao += sqrt(fmax(square.ao[k] - mean.ao[k] * mean.ao[k], 0.0));
        for (int c = 3 * k; c < 3 * k + 3; ++c) {
            near += sqrt(fmax(square.near[c] - mean.near[c] * mean.near[c], 0.0)) / 3.0;
            light += mean.near[c] / 3.0;
        }
        ++count;
    }
    field_free(&mean);
    field_free(&square);
    print_message("%s: deviation over time of ao %.2f / 255, of near light %.2f %% of its mean\n", name, 255.0 * ao / count,
                  100.0 * near / light);
    return ao / count < 1.0 / 255.0 && near < 0.01 * light;
}

static void a_still_picture_does_not_flicker(void **state)
{
    (void)state;
    for_all(check_flicker);
}

/* --- recursive bounces ------------------------------------------------------------------------------------------- */

enum { ROOM_SIZE = 96 };

/* The inside of a sphere from a point of it: closed for the screen but for a thousandth, and all of its surface sees the same. A box
 * cannot be: the wall in which the eye is takes a sixth of what the others see. */
static void make_room(gpu_input *in, int size, double tangent /* of half the angle of view */, float emission, float albedo)
{
    const double    pixel = 2.0 * tangent / size;
    const bf_camera camera = {size, size, 0, {pixel, -pixel, -tangent, tangent}};
    memset(in, 0, sizeof *in);
    in->frame = gpu_frame(&camera);
    memcpy(in->frame.last_projection, in->frame.projection, sizeof in->frame.projection);
    memcpy(in->frame.last_view, in->frame.view, sizeof in->frame.view);
    assert_true(image_make(&in->depth, size, size, 1) && image_make(&in->normal, size, size, 3));
    assert_true(image_make(&in->radiance, size, size, 3) && image_make(&in->albedo, size, size, 3));
    for (int k = 0; k < size * size; ++k) {
        const double x = pixel * (k % size + 0.5) - tangent, y = tangent - pixel * (k / size + 0.5);
        const double z = 2.0 / (1.0 + x * x + y * y);
        float       *n = in->normal.data + 3 * k;
        in->depth.data[k] = (float)z;
        n[0] = (float)(-x * z);
        n[1] = (float)(-y * z);
        n[2] = (float)(z - 1.0);
        for (int c = 0; c < 3; ++c) {
            in->radiance.data[3 * k + c] = emission;
            in->albedo.data[3 * k + c] = albedo;
        }
    }
}

static void free_room(gpu_input *in)
{
    image_free(&in->depth);
    image_free(&in->normal);
    image_free(&in->radiance);
    image_free(&in->albedo);
}

/* Mean and greatest near light after some frames. NaN counts as greatest. */
static double light_of_room(const char *config, float albedo, int frames, double *most)
{
    const hbil_config c = config_of("outputs=ao+near bounces=recursive", config);
    gpu_input         in;
    gpu_output        o;
    double            mean = 0.0;
    make_room(&in, ROOM_SIZE, 60.0, 1.0f, albedo);
    run_still(&c, &in, 0, frames, &o);
    *most = 0.0;
    for (int k = 0; k < ROOM_SIZE * ROOM_SIZE; ++k) {
        const double near = (double)o.near.data[4 * k];
        mean += near / (ROOM_SIZE * ROOM_SIZE);
        *most = near <= *most ? *most : near;
    }
    gpu_free(&o);
    free_room(&in);
    return mean;
}

static void light_in_a_closed_room_adds_up(void **state)
{
    static const char *const configs[] = {"slices=8 steps=32", "slices=8 steps=32 reproject=scatter", "march=sweep slices=16",
                                          "slices=4 steps=32 temporal=yes filter=3x3"};
    static const float       albedo[] = {0.2f, 0.5f, 0.8f};
    int                      failed = 0;
    (void)state;
    for (int i = 0; i < 4; ++i) {
        for (int k = 0; k < 3; ++k) {
            double       most;
            const double truth = 1.0 / (1.0 - (double)albedo[k]), mean = light_of_room(configs[i], albedo[k], 32, &most); /* .8^32: .0008 */
            print_message("%-42s albedo %.1f: %.4f of %.4f\n", configs[i], (double)albedo[k], mean, truth);
            failed += !(fabs(mean - truth) < 0.01 * truth);
        }
    }
    assert_int_equal(failed, 0);
}

static void light_stays_bounded(void **state)
{
    const int    frames = getenv("HBIL_LONG") ? 1000 : 300; /* .95^300: 2e-7 */
    double       most;
    const double mean = light_of_room("slices=2 steps=4 near_intensity=2", 0.99f, frames, &most);
    (void)state;
    print_message("albedo 0.99, intensity 2, %d frames: mean %.3f, most %.3f; limit 2 / (1 - 0.95) = 40\n", frames, mean, most);
    assert_true(mean > 30.0 && most < 40.01);
}

/* --- the noise's period ------------------------------------------------------------------------------------------ */

static int same(const image *a, const image *b)
{
    assert_true(a->width == b->width && a->height == b->height && a->channels == b->channels);
    return memcmp(a->data, b->data, (size_t)(a->width * a->height * a->channels) * sizeof *a->data) == 0;
}

/* Jitters of 8, 16, 32 and 64 frames meet other noise in each round. */
static void noise_has_not_the_period_of_a_jitter(void **state)
{
    static const char *const noises[] = {"noise=hilbert_r2", "noise=ign", "noise=ign interleave=yes", "march=sweep"};
    static const int         periods[] = {8, 16, 32, 64, 61};
    (void)state;
    for (int i = 0; i < 4; ++i) {
        const hbil_config c = config_of("outputs=ao+near slices=2 steps=3", noises[i]);
        gpu_input         in;
        gpu_output        first, later;
        make_room(&in, 32, 2.0, 1.0f, 0.5f);
        run_still(&c, &in, 5, 1, &first);
        for (int k = 0; k < 5; ++k) {
            run_still(&c, &in, 5u + (uint32_t)periods[k], 1, &later);
            assert_int_equal(same(&first.ao, &later.ao), periods[k] == 61 && strstr(noises[i], "ign") != NULL);
            gpu_free(&later);
        }
        gpu_free(&first);
        free_room(&in);
    }
}

/* --- garbage ----------------------------------------------------------------------------------------------------- */

/* The text of a pass with a line put before the first line that has `before` in it. Caller frees. */
static char *with_line(const hbil_config *config, const char *pass, const char *before, const char *line)
{
    hbil_plan plan;
    size_t    need;
    char     *text, *out, *at;
    gpu_plan(config, &plan);
    assert_int_equal(hbil_emit_glsl(&plan, hbil_plan_pass(&plan, pass), NULL, 0, &need), HBIL_E_SPACE);
    text = malloc(need);
    out = malloc(need + strlen(line) + 1);
    assert_true(text && out);
    assert_int_equal(hbil_emit_glsl(&plan, hbil_plan_pass(&plan, pass), text, need, NULL), HBIL_OK);
    at = strstr(text, "void main()");
    assert_non_null(at);
    at = strstr(at, before);
    assert_non_null(at);
    while (at[-1] != '\n') {
        --at;
    }
    memcpy(out, text, (size_t)(at - text));
    strcpy(out + (at - text), line);
    strcat(out, at);
    free(text);
    return out;
}

/* Pixels of the last frame that are not finite or differ from the same frames without garbage by more than noise could. */
static int garbage_left(const char *config, const char *pass, const char *before, const char *line, int frames_after)
{
    const hbil_config c = config_of("outputs=ao+near slices=3 steps=8 bounces=recursive temporal=yes", config);
    char             *text = with_line(&c, pass, before, line);
    gpu_input         in;
    gpu_output        clean, dirty;
    int               left = 0;
    make_room(&in, ROOM_SIZE, 60.0, 1.0f, 0.5f);
    run_still(&c, &in, 0, 5 + 1 + frames_after, &clean);
    gpu_text(pass, text);
    run_still(&c, &in, 0, 5 + 1 + frames_after, &dirty);
    gpu_text(NULL, NULL);
    for (int k = 0; k < ROOM_SIZE * ROOM_SIZE; ++k) {
        for (int i = 0; i < 3; ++i) {
            left += !(fabs((double)dirty.near.data[4 * k + i] - (double)clean.near.data[4 * k + i]) < 0.2);
        }
        left += !(fabs((double)dirty.ao.data[k] - (double)clean.ao.data[k]) < 0.2);
    }
    gpu_free(&clean);
    gpu_free(&dirty);
    free_room(&in);
    free(text);
    return left;
}

static void garbage_in_history_is_gone_after_two_frames(void **state)
{
    /* frame 5 leaves it in a block of pixels of the running mean, or in the depths beside it. The history of bounces is packed: no
     * bits of it are NaN, infinite or above 65408 */
    static const char *const numbers[] = {"0x7fc00000u", "0x7f800000u", "0xff800000u", "0x7149f2cau"}; /* NaN, inf, -inf, 1e30 */
    static const char        block[] = "    if (HBIL_FRAME_INDEX == 5u && all(lessThan(abs(p - 40), ivec2(4))))";
    int                      left = 0;
    (void)state;
    for (int i = 0; i < 8; ++i) {
        char line[240];
        snprintf(line, sizeof line, i < 4 ? "%s imageStore(u_to, ivec3(p, 0), vec4(uintBitsToFloat(%s)));\n" : "%s imageStore(u_seen, p, uvec4(%s));\n",
                 block, numbers[i % 4]);
        const int pixels = garbage_left(i < 4 ? "" : "reproject=scatter", "temporal", "hbil_finish(p, s)", line, 2);
        print_message("%s in the %s: %d values off after two frames\n", numbers[i % 4], i < 4 ? "running mean" : "depths", pixels);
        left += pixels;
    }
    assert_int_equal(left, 0);
}

/* --- a camera that moves ----------------------------------------------------------------------------------------- */

enum { MOVES = 12 };

typedef struct film { capture frame[MOVES]; } film;

/* by: 1, or every by-th pixel and row. */
static void film_load(film *f, const char *name, int by)
{
    for (int i = 0; i < MOVES; ++i) {
        char error[512] = "";
        if (!captures_load(name, i, &f->frame[i], error, sizeof error)) {
            fail_msg("%s", error);
        }
        assert_true(by == 1 || decimate(&f->frame[i], by));
    }
}

static void film_free(film *f)
{
    for (int i = 0; i < MOVES; ++i) {
        capture_free(&f->frame[i]);
    }
}

/* Frame `now` after frame `last`; last < 0: the first one. */
static gpu_input step(const film *f, int last, int now)
{
    gpu_input in = gpu_input_of(&f->frame[now]);
    in.frame.index = (uint32_t)now;
    in.frame.reset = 1;
    if (last >= 0) {
        capture_follow(&in.frame, &f->frame[last]);
    }
    return in;
}

/* The last frame. */
static void run_film(const film *f, const hbil_config *config, gpu_output *out)
{
    memset(out, 0, sizeof *out);
    for (int i = 0; i < MOVES; ++i) {
        const gpu_input in = step(f, i - 1, i);
        gpu_free(out);
        gpu_run(config, &in, out);
    }
}

/* Calls check for every capture of twelve frames, of every by-th pixel and row. */
static void for_films(int (*check)(const char *name, const film *f), int by)
{
    const capture_names list = captures_list();
    int                 failed = 0, count = 0;
    for (int i = 0; i < list.count; ++i) {
        film f;
        if (!captures_has(list.name[i], MOVES - 1)) {
            continue;
        }
        film_load(&f, list.name[i], getenv("HBIL_LONG") ? 1 : by);
        failed += !check(list.name[i], &f);
        film_free(&f);
        ++count;
    }
    if (!count) {
        print_message("HBIL_CAPTURES is not set, or holds no moving camera: skipped\n");
        skip();
    }
    assert_int_equal(failed, 0);
}

/* RMSE of near light against an image of E/pi, where there is one. */
static double off_from(const capture *cap, const gpu_output *o, const image *truth)
{
    double sum = 0.0;
    int    count = 0;
    for (int k = 0; k < cap->width * cap->height; ++k) {
        if (cap->depth.data[k] >= SKY || cap->albedo.data[3 * k] + cap->albedo.data[3 * k + 1] + cap->albedo.data[3 * k + 2] <= 0.0f) {
            continue;
        }
        for (int c = 0; c < 3; ++c) {
            sum += pow((double)o->near.data[4 * k + c] - (double)truth->data[3 * k + c], 2.0);
        }
        count += 3;
    }
    return sqrt(sum / count);
}

/* RMSE between two results, of near light. */
static double apart(const capture *cap, const gpu_output *a, const gpu_output *b)
{
    double sum = 0.0;
    for (int k = 0; k < cap->width * cap->height; ++k) {
        for (int c = 0; c < 3; ++c) {
            sum += pow((double)a->near.data[4 * k + c] - (double)b->near.data[4 * k + c], 2.0);
        }
    }
    return sqrt(sum / (3 * cap->width * cap->height));
}

static int check_bounces(const char *name, const film *f)
{
    /* facing: in a height field without thickness, light of surfaces that face away is too much already at the first bounce */
    static const char *const marches[] = {"outputs=ao+near slices=3 steps=8 facing=half_space temporal=yes filter=5x5",
                                          "outputs=ao+near march=sweep slices=4 sweep_stride=3 facing=half_space filter=3x3"};
    static const char *const ways[] = {"", "bounces=recursive", "bounces=recursive reproject=gather", "bounces=recursive reproject=scatter"};
    const capture           *last = &f->frame[MOVES - 1];
    int                      good = 1;
    for (int m = 0; m < 2; ++m) {
        gpu_output o[4], again;
        double     off[4];
        for (int i = 0; i < 4; ++i) {
            const hbil_config c = config_of(marches[m], ways[i]);
            run_film(f, &c, &o[i]);
            off[i] = off_from(last, &o[i], &last->truth_bounce);
        }
        {
            hbil_config c = config_of(marches[m], ways[1]); /* the same with other noise */
            c.noise = HBIL_NOISE_IGN;
            run_film(f, &c, &again);
        }
        const double seeds = apart(last, &o[1], &again), gather = apart(last, &o[2], &o[1]), scatter = apart(last, &o[3], &o[2]);
        print_message("%s, %s\n  RMSE of near light to all bounces: one bounce %.4f, recursive %.4f, ratio %.3f\n"
                      "  apart from each other: gather and camera %.4f, scatter and gather %.4f, two seeds %.4f\n", name, marches[m], off[0],
                      off[1], off[1] / off[0], gather, scatter, seeds);
        /* a sweep has no noise but its turn: .004 is a twentieth of the light */
        good &= off[1] < off[0] && off[2] < off[0] && off[3] < off[0] && gather < 0.5 * fmax(seeds, 0.004) && scatter < fmax(seeds, 0.004);
        for (int i = 0; i < 4; ++i) {
            gpu_free(&o[i]);
        }
        gpu_free(&again);
    }
    return good;
}

static void recursive_light_is_nearer_to_all_bounces(void **state)
{
    (void)state;
    for_films(check_bounces, 2);
}

/* Was the surface at pixel k of a frame seen in the frame before? By both cameras and both depths. */
static int was_seen(const capture *cap, const capture *before, int k)
{
    const double z = (double)cap->depth.data[k], x = 2.0 * (k % cap->width + 0.5) / cap->width - 1.0, y = 2.0 * (k / cap->width + 0.5) / cap->height - 1.0;
    const float *p = cap->projection, *v = cap->view;
    const double at[3] = {z * (x + (double)p[8]) / (double)p[0], z * (y + (double)p[9]) / (double)p[5], -z};
    double       there[3], u, w;
    for (int i = 0; i < 3; ++i) {
        there[i] = (double)before->view[12 + i];
        for (int j = 0; j < 3; ++j) {
            double world = 0.0;
            for (int a = 0; a < 3; ++a) world += (double)v[4 * j + a] * (at[a] - (double)v[12 + a]);
            there[i] += (double)before->view[4 * j + i] * world;
        }
    }
    u = ((double)p[0] * there[0] / -there[2] - (double)p[8] + 1.0) * 0.5 * cap->width - 0.5;
    w = ((double)p[5] * there[1] / -there[2] - (double)p[9] + 1.0) * 0.5 * cap->height - 0.5;
    for (int i = 0; i < 4; ++i) {
        const int a = (int)floor(u) + (i & 1), b = (int)floor(w) + (i >> 1);
        if (a < 0 || b < 0 || a >= cap->width || b >= cap->height) continue;
        if (fabs((double)before->depth.data[b * cap->width + a] + there[2]) < 0.03 * z) return 1;
    }
    return 0;
}

static int check_ghosts(const char *name, const film *f)
{
    static const char *const ways[] = {"camera", "gather", "scatter"};
    const capture           *last = &f->frame[MOVES - 1], *before = &f->frame[MOVES - 2];
    field                    truth;
    int                      good = 1;
    mean_of_frames(last, 96, &truth);
    for (int i = 0; i < 3; ++i) {
        hbil_config config = config_of(k_noisy, "temporal=yes filter=5x5 filter_passes=2");
        double      sum[2][2] = {{0.0, 0.0}, {0.0, 0.0}}, count[2] = {0.0, 0.0};
        gpu_output  o;
        assert_int_equal(hbil_config_set(&config, "reproject", ways[i], NULL), HBIL_OK);
        run_film(f, &config, &o);
        for (int k = 0; k < last->width * last->height; ++k) {
            if (last->depth.data[k] < SKY) {
                const int seen = was_seen(last, before, k);
                sum[seen][0] += pow((double)o.ao.data[k] - truth.ao[k], 2.0);
                for (int c = 0; c < 3; ++c) {
                    sum[seen][1] += pow((double)o.near.data[4 * k + c] - truth.near[3 * k + c], 2.0) / 3.0;
                }
                count[seen] += 1.0;
            }
        }
        gpu_free(&o);
        const double ao = sqrt(sum[0][0] / count[0] / (sum[1][0] / count[1])), near = sqrt(sum[0][1] / count[0] / (sum[1][1] / count[1]));
        print_message("%s, %s: %.0f pixels are new; their RMSE is that of the others times %.2f (ao), %.2f (near)\n", name, ways[i],
                      count[0], ao, near);
        good &= count[0] > 100.0 && ao <= 1.5 && near <= 1.5;
    }
    field_free(&truth);
    return good;
}

static void disoccluded_pixels_begin_anew(void **state)
{
    (void)state;
    for_films(check_ghosts, 1); /* few pixels are new */
}

/* Every way to look back. */
static const char *const k_backs[] = {"outputs=ao+near temporal=yes bounces=recursive", "outputs=ao+near temporal=yes bounces=recursive reproject=scatter",
                                      "outputs=ao+near temporal=yes bounces=recursive reproject=gather downscale=2"};

static int check_cut(const char *name, const film *f)
{
    int good = 1;
    for (int i = 0; i < 3; ++i) {
        const hbil_config c = config_of(k_backs[i], "");
        const gpu_input   cut = step(f, -1, MOVES - 1);
        gpu_output        alone, after;
        for (int k = 0; k < 4; ++k) {
            const gpu_input in = step(f, k - 1, k);
            gpu_run(&c, &in, &after);
            gpu_free(&after);
        }
        gpu_run(&c, &cut, &after);
        gpu_view(1); /* which has seen nothing */
        gpu_run(&c, &cut, &alone);
        gpu_view(0);
        good &= same(&after.near, &alone.near) && same(&after.ao, &alone.ao);
        gpu_free(&alone);
        gpu_free(&after);
    }
    print_message("%s: after a cut all bits are those of a first frame%s\n", name, good ? "" : ", NOT SO");
    return good;
}

static void a_cut_leaves_no_trace(void **state)
{
    (void)state;
    for_films(check_cut, 2);
}

/* --- views and sizes --------------------------------------------------------------------------------------------- */

static void two_views_share_no_history(void **state)
{
    (void)state;
    for (int i = 0; i < 3; ++i) {
        const hbil_config c = config_of(k_backs[i], "");
        gpu_input         in[2];
        image             motion;
        gpu_output        together[2] = {{{0}, {0}, {0}}, {{0}, {0}, {0}}}, alone;
        assert_true(image_make(&motion, ROOM_SIZE, ROOM_SIZE, 2));
        for (int v = 0; v < 2; ++v) {
            make_room(&in[v], ROOM_SIZE, 60.0, v ? 3.0f : 1.0f, v ? 0.7f : 0.3f);
            in[v].motion = motion;
        }
        for (int f = 0; f < 6; ++f) {
            for (int v = 0; v < 2; ++v) {
                in[v].frame.index = (uint32_t)f;
                in[v].frame.reset = f == 0;
                gpu_view(v);
                gpu_free(&together[v]);
                gpu_run(&c, &in[v], &together[v]);
            }
        }
        gpu_view(0);
        for (int v = 0; v < 2; ++v) {
            run_still(&c, &in[v], 0, 6, &alone);
            assert_true(same(&alone.near, &together[v].near) && same(&alone.ao, &together[v].ao));
            gpu_free(&alone);
            gpu_free(&together[v]);
            free_room(&in[v]);
        }
        image_free(&motion);
    }
}

/* The first width x height pixels of an image; the rest is garbage. */
static image in_corner(const image *from, int room)
{
    image out;
    assert_true(image_make(&out, room, room, from->channels));
    for (int k = 0; k < room * room * from->channels; ++k) {
        out.data[k] = 1e30f;
    }
    for (int y = 0; y < from->height; ++y) {
        memcpy(out.data + y * room * from->channels, from->data + y * from->width * from->channels,
               (size_t)(from->width * from->channels) * sizeof *out.data);
    }
    return out;
}

/* A room of size x size pixels in the corner of larger textures. */
static gpu_input small_room(int size)
{
    gpu_input in;
    image    *images[] = {&in.depth, &in.normal, &in.radiance, &in.albedo};
    make_room(&in, size, 3.0, 1.0f, 0.7f);
    for (int i = 0; i < 4; ++i) {
        const image small = *images[i];
        *images[i] = in_corner(&small, ROOM_SIZE);
        free(small.data);
    }
    return in;
}

/* Mean near light of frames 32 to 39, of these sizes in turns. */
static double light_of_sizes(const hbil_config *config, const int sizes[8])
{
    double sum = 0.0;
    for (int f = 0; f < 40; ++f) {
        const int  size = sizes[f % 8];
        gpu_input  in = small_room(size);
        gpu_output o;
        in.frame.index = (uint32_t)f;
        in.frame.reset = f == 0;
        in.frame.last_width = in.frame.last_height = (uint32_t)sizes[(f + 7) % 8];
        gpu_run(config, &in, &o);
        assert_int_equal(o.near.width, size);
        for (int k = 0; k < size * size && f >= 32; ++k) {
            sum += (double)o.near.data[4 * k] / (8.0 * size * size);
        }
        gpu_free(&o);
        free_room(&in);
    }
    return sum;
}

static void a_frame_may_be_the_corner_of_larger_textures(void **state)
{
    static const int sizes[] = {96, 81, 81, 72, 90, 96, 65, 78}, still[] = {80, 80, 80, 80, 80, 80, 80, 80};
    (void)state;
    for (int i = 0; i < 3; ++i) {
        static const char *const ways[] = {"", "reproject=scatter", "downscale=2"};
        const hbil_config c = config_of("outputs=ao+near slices=8 steps=16 bounces=recursive temporal=yes filter=3x3", ways[i]);
        const hbil_config one = config_of("outputs=ao+near slices=8 steps=16 filter=3x3", ways[i][0] == 'd' ? ways[i] : "");
        const double      single = light_of_sizes(&one, still), fixed = light_of_sizes(&c, still), changing = light_of_sizes(&c, sizes);
        print_message("%-18s near light of one bounce %.4f, of all %.4f, with sizes from 65 to 96 in turns %.4f\n", ways[i], single, fixed, changing);
        assert_true(fabs(changing - fixed) < 0.05 * (fixed - single));
    }
}

/* --- the coarser grid -------------------------------------------------------------------------------------------- */

/* An inclined plane that fills the screen: nearness = a + b x + c y over ndc. */
static void make_plane(gpu_input *in, int width, int height)
{
    const double    pixel = 1.2 / (width > height ? width : height);
    const bf_camera camera = {width, height, 0, {pixel, -pixel, -0.5 * pixel * width, 0.5 * pixel * height}};
    const double    n[3] = {0.45, 0.6, 0.6614378}; /* towards the eye: z out of the screen */
    memset(in, 0, sizeof *in);
    in->frame = gpu_frame(&camera);
    assert_true(image_make(&in->depth, width, height, 1) && image_make(&in->normal, width, height, 3));
    assert_true(image_make(&in->radiance, width, height, 3) && image_make(&in->albedo, width, height, 3));
    for (int k = 0; k < width * height; ++k) {
        const double x = pixel * (k % width + 0.5) + camera.ray[2], y = -pixel * (k / width + 0.5) + camera.ray[3];
        in->depth.data[k] = (float)(5.0 * n[2] / (n[2] - n[0] * x - n[1] * y));
        for (int c = 0; c < 3; ++c) {
            in->normal.data[3 * k + c] = (float)n[c];
            in->radiance.data[3 * k + c] = 1.0f;
        }
    }
}

static void a_ramp_is_exact_and_a_plane_open(void **state)
{
    static const int  sizes[][2] = {{1, 1}, {3, 5}, {64, 36}, {61, 35}, {959, 539}, {2, 7}};
    static const char ramp[] = "    s[0] = vec4(vec2(p) + 0.5, 1.0, 0.5);\n";
    (void)state;
    for (int down = 1; down <= 4; down *= 2) {
        for (int i = 0; i < 6; ++i) {
            hbil_config c = config_of("outputs=ao+near slices=2 steps=8", "filter=none");
            const int   w = sizes[i][0], h = sizes[i][1], gw = (w + down - 1) / down, gh = (h + down - 1) / down;
            double      off = 0.0, closed = 0.0;
            gpu_input   in;
            gpu_output  o;
            char       *text;
            c.downscale = down;
            make_plane(&in, w, h);
            run_still(&c, &in, 0, 1, &o);
            for (int k = 0; k < w * h; ++k) {
                const double hidden = 1.0 - (double)o.ao.data[k];
                closed = hidden <= closed ? closed : hidden;
            }
            gpu_free(&o);
            if (down > 1) {
                text = with_line(&c, "march", "hbil_pass_on(p, s)", ramp);
                gpu_text("march", text);
                run_still(&c, &in, 0, 1, &o);
                gpu_text(NULL, NULL);
                for (int k = 0; k < w * h; ++k) {
                    const double x = fmin(fmax((k % w + 0.5) / down, 0.5), gw - 0.5), y = fmin(fmax((k / w + 0.5) / down, 0.5), gh - 0.5);
                    const double d = fmax(fabs((double)o.near.data[4 * k] - x) / gw, fabs((double)o.near.data[4 * k + 1] - y) / gh);
                    off = d <= off ? off : d;
                }
                gpu_free(&o);
                free(text);
            }
            free_room(&in);
            print_message("downscale %d, %dx%d: ramp off by %.1e of its range, plane hidden by %.1e\n", down, w, h, off, closed);
            assert_true(off < 1e-5 && closed < 1e-3);
        }
    }
}

static int check_downscale(const char *name, const capture *cap)
{
    static const char *const marches[] = {"outputs=ao+near slices=3 steps=6", "outputs=ao+near slices=3 steps=6 filter=5x5",
                                          "outputs=ao+near march=sweep slices=4 sweep_stride=3 filter=3x3"};
    int good = 1;
    for (int m = 0; m < 3; ++m) {
        double off[3][2];
        for (int i = 0; i < 3; ++i) {
            hbil_config     c = config_of(marches[m], "");
            const gpu_input in = gpu_input_of(cap);
            gpu_output      o;
            double          sum = 0.0;
            int             count = 0;
            c.downscale = 1 << i;
            run_still(&c, &in, 0, 1, &o);
            for (int k = 0; k < cap->width * cap->height; ++k) {
                if (cap->depth.data[k] < SKY && cap->truth_ao.data[k] > 0.0f) {
                    sum += pow((double)o.ao.data[k] - (double)cap->truth_ao.data[k], 2.0);
                    ++count;
                }
            }
            off[i][0] = sqrt(sum / count);
            off[i][1] = off_from(cap, &o, &cap->truth_near);
            gpu_free(&o);
        }
        print_message("%s, %s: RMSE of ao %.4f, at half size %+.0f %%, at a quarter %+.0f %%; near %.4f, %+.0f %%, %+.0f %%\n", name,
                      marches[m], off[0][0], 100.0 * (off[1][0] / off[0][0] - 1.0), 100.0 * (off[2][0] / off[0][0] - 1.0), off[0][1],
                      100.0 * (off[1][1] / off[0][1] - 1.0), 100.0 * (off[2][1] / off[0][1] - 1.0));
        good &= off[1][0] <= 1.25 * off[0][0] && off[1][1] <= 1.25 * off[0][1];
    }
    return good;
}

static void half_size_loses_little(void **state)
{
    (void)state;
    for_all(check_downscale);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(noise_falls_by_filter_and_running_mean),
        cmocka_unit_test(one_slice_is_divided_after_the_filter),
        cmocka_unit_test(noise_has_not_the_period_of_a_jitter),
        cmocka_unit_test(a_still_picture_does_not_flicker),
        cmocka_unit_test(light_in_a_closed_room_adds_up),
        cmocka_unit_test(light_stays_bounded),
        cmocka_unit_test(garbage_in_history_is_gone_after_two_frames),
        cmocka_unit_test(recursive_light_is_nearer_to_all_bounces),
        cmocka_unit_test(disoccluded_pixels_begin_anew),
        cmocka_unit_test(a_cut_leaves_no_trace),
        cmocka_unit_test(two_views_share_no_history),
        cmocka_unit_test(a_frame_may_be_the_corner_of_larger_textures),
        cmocka_unit_test(a_ramp_is_exact_and_a_plane_open),
        cmocka_unit_test(half_size_loses_little),
    };
    return cmocka_run_group_tests(tests, gpu_open, gpu_close);
}
