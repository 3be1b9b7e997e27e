/* bout.c - see bout.h */
#include "bout.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "../../../tests/numeric/brute_force.h"
#include "../../frame/metric.h"

#define RAYS 512        /* a pixel of our own height-field truth, where a frame brings none: standard error about .02 */
#define RAY_PIXELS 2500 /* about as many */

const char *const truth_names[TRUTHS] = {"scene", "height field"};
const char *const presets[PRESETS] = {"balanced", "quality", "sampled", "gtao", "bitmask"};

void die(int code, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    fputs("hbil-peers: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(code);
}

/* ---------------------------------------------------------------------------------------------------------- errors */

static const image *truth_of(const capture *cap, int truth)
{
    return truth == SCENE ? &cap->truth_ao : &cap->hf_ao;
}

static int counts(const capture *cap, int truth, size_t i)
{
    return truth == SCENE ? metric_counts(cap, i) : cap->hf_valid.data[i] > 0.5f;
}

/* power: of the result, for settings that are tried without drawing again. */
static errors compare(const image *ao, const capture *cap, int truth, float power)
{
    const image *t = truth_of(cap, truth);
    double       n = 0.0, a = 0.0, b = 0.0, aa = 0.0, bb = 0.0, ab = 0.0, spread;
    errors       e = {0, 0.0, 0.0, 0.0};
    size_t       i;

    if (!t->data || (truth == HEIGHT_FIELD && !cap->hf_valid.data)) return e;
    for (i = 0; i < (size_t)ao->width * (size_t)ao->height; ++i) {
        const double x = (double)(power == 1.0f ? ao->data[i] : powf(ao->data[i], power)), y = (double)t->data[i];

        if (!counts(cap, truth, i)) continue;
        n += 1.0;
        a += x;
        b += y;
        aa += x * x;
        bb += y * y;
        ab += x * y;
    }
    if (n == 0.0) return e;
    spread = sqrt((n * aa - a * a) * (n * bb - b * b));
    e.known = 1;
    e.rmse = sqrt((aa - 2.0 * ab + bb) / n);
    e.bias = (a - b) / n;
    e.correlation = spread > 0.0 ? (n * ab - a * b) / spread : 0.0;
    return e;
}

/* Height-field truth of a frame without one, on a grid of its pixels. */
static void make_height_field(capture *cap)
{
    const int stride = (int)fmax(1.0, floor(sqrt((double)cap->width * (double)cap->height / RAY_PIXELS)));
    bf_grid   grid = bf_grid_of(cap->width, cap->height, stride / 2, stride);
    bf_pixel *out = malloc((size_t)grid.columns * (size_t)grid.rows * sizeof *out);
    bf_scene  scene;
    int       i;

    memset(&scene, 0, sizeof scene);
    scene.camera = bf_camera_from(cap->projection, cap->width, cap->height);
    scene.depth = cap->depth.data;
    scene.sky_depth = 1e9;
    scene.normal = cap->normal.data;
    if (!out || !image_make(&cap->hf_ao, cap->width, cap->height, 1)
        || !image_make(&cap->hf_valid, cap->width, cap->height, 1) || !bf_run(&scene, grid, RAYS, out))
        die(EXIT_RUN, "out of memory for the height-field truth");
    for (i = 0; i < grid.columns * grid.rows; ++i) {
        const int at = (grid.first + i / grid.columns * grid.stride) * cap->width + grid.first
                       + i % grid.columns * grid.stride;

        cap->hf_ao.data[at] = (float)out[i].ao;
        cap->hf_valid.data[at] = out[i].sky == 0.0;
    }
    free(out);
}

/* ------------------------------------------------------------------------------------------------------------ rows */

static row *add_row(bout *b, int peer, int convention, int truth)
{
    row *r = &b->rows[b->row_count];

    if (b->row_count == ROWS_MAX) die(EXIT_RUN, "more than %d rows", ROWS_MAX);
    b->row_count++;
    r->peer = peer;
    r->convention = convention;
    r->judge = truth;
    return r;
}

static peer_pass *load(bout *b, int peer, int convention, int rung, int point)
{
    char       name[64], error[1024] = "";
    peer_pass *p;

    variant_name(peer, convention, rung, point, name);
    p = peer_load(b->peers, b->folder, name, error, sizeof error);
    if (!p) die(EXIT_RUN, "%s", error);
    return p;
}

static ours *open_ours(const bout *b, int preset, const char *options)
{
    char  error[1024] = "";
    ours *o = ours_open(b->device, presets[preset], options, &b->cap, error, sizeof error);

    if (!o) die(EXIT_RUN, "%s", error);
    return o;
}

/* ms and ao may be NULL. */
static void run(ours *o, peer_pass *p, double *ms, image *ao)
{
    char error[1024] = "";

    if (p ? !peer_run(p, ms, error, sizeof error) : !ours_run(o, ms, error, sizeof error)) die(EXIT_RUN, "%s", error);
    if (ao && (p ? !peer_read(p, ao) : !ours_read(o, ao))) die(EXIT_RUN, "out of memory");
}

/* What comes nearest to each truth so far. */
typedef struct choice {
    double rmse;
    int    point;
    float  power;
    int    known;
} choice;

static void try_powers(const bout *b, ours *o, peer_pass *p, int point, choice best[TRUTHS])
{
    image ao = {0, 0, 0, NULL};
    int   truth, k;

    run(o, p, NULL, &ao);
    for (truth = 0; truth < TRUTHS; ++truth)
        for (k = 0; k < POWERS; ++k) {
            const errors e = compare(&ao, &b->cap, truth, powers[k]);
            const choice c = {e.rmse, point, powers[k], 1};

            if (e.known && (!best[truth].known || e.rmse < best[truth].rmse)) best[truth] = c;
        }
    image_free(&ao);
}

static void add_best(bout *b, int peer, int rung, float large)
{
    choice best[TRUTHS] = {{0.0, 0, 0.0f, 0}, {0.0, 0, 0.0f, 0}};
    int    point, truth;

    for (point = 0; point < variant_grid(peer); ++point) {
        peer_pass *p = load(b, peer, AS_BEST, rung, point);

        try_powers(b, NULL, p, point, best);
        peer_free(p);
    }
    for (truth = 0; truth < TRUTHS; ++truth) {
        row   *r;
        size_t length;

        if (!best[truth].known) continue;
        r = add_row(b, peer, AS_BEST, truth);
        r->p = load(b, peer, AS_BEST, rung, best[truth].point);
        if (!peer_set(r->p, power_names[peer], best[truth].power))
            die(EXIT_RUN, "%s has no %s", peer_names[peer], power_names[peer]);
        variant_text(peer, AS_BEST, best[truth].point, large, r->settings);
        length = strlen(r->settings);
        snprintf(r->settings + length, sizeof r->settings - length, " %s=%g", power_names[peer],
                 (double)best[truth].power);
    }
}

static void add_peer(bout *b, int peer)
{
    const float large = variant_large(&b->cap);
    int         rung, convention;

    for (rung = 0; rung < RUNGS_MAX && peer_rungs[peer][rung]; ++rung) {
        fprintf(stderr, "\r%s: settings of %s with %d samples    ", b->name, peer_names[peer], peer_rungs[peer][rung]);
        for (convention = 0; convention < AS_BEST; ++convention) {
            row *r = add_row(b, peer, convention, 0);

            r->p = load(b, peer, convention, rung, 0);
            variant_text(peer, convention, 0, large, r->settings);
        }
        add_best(b, peer, rung, large);
    }
}

static int has_reach(int preset)
{
    hbil_config config;

    return hbil_config_preset(presets[preset], &config, NULL) == HBIL_OK && config.reach > 0.0f;
}

/* Ours under the same conventions. Large: presets with a reach lose it. Best: of these two and the powers, by
 * ao_exponent. */
static void add_preset(bout *b, int preset)
{
    const char *const bases[] = {"", "reach=0"};
    choice            best[TRUTHS] = {{0.0, 0, 0.0f, 0}, {0.0, 0, 0.0f, 0}};
    int               i, truth;
    row              *r;

    for (i = 0; i < (has_reach(preset) ? 2 : 1); ++i) {
        r = add_row(b, OURS, i == 0 ? AS_SHIPPED : AS_LARGE, 0);
        r->preset = preset;
        r->o = open_ours(b, preset, bases[i]);
        snprintf(r->settings, sizeof r->settings, "%s", bases[i]);
        try_powers(b, r->o, NULL, i, best);
    }
    for (truth = 0; truth < TRUTHS; ++truth) {
        if (!best[truth].known) continue;
        r = add_row(b, OURS, AS_BEST, truth);
        r->preset = preset;
        snprintf(r->settings, sizeof r->settings, "%s%sao_exponent=%g", bases[best[truth].point],
                 best[truth].point ? " " : "", (double)best[truth].power);
        r->o = open_ours(b, preset, r->settings);
    }
}

/* --------------------------------------------------------------------------------------------------------- measure */

static void put_picture(const bout *b, const char *what, int taps, const image *ao)
{
    char path[1300], error[512] = "";
    int  i;

    snprintf(path, sizeof path, "%s/%s-%s-%d.png", b->png, b->name, what, taps);
    for (i = (int)strlen(b->png); path[i]; ++i)
        if (path[i] == ' ') path[i] = '-';
    if (!png_write(path, ao, 0, error, sizeof error)) die(EXIT_FRAME, "%s", error);
}

static void first_run(const bout *b, row *r)
{
    image ao = {0, 0, 0, NULL};
    char  what[128];
    int   truth;

    run(r->o, r->p, NULL, &ao);
    r->taps = r->p ? peer_taps(r->p) : ours_taps(r->o);
    for (truth = 0; truth < TRUTHS; ++truth) r->e[truth] = compare(&ao, &b->cap, truth, 1.0f);
    snprintf(what, sizeof what, "%s-%s%s%s", r->p ? peer_names[r->peer] : presets[r->preset],
             convention_names[r->convention], r->convention == AS_BEST ? "-" : "",
             r->convention == AS_BEST ? truth_names[r->judge] : "");
    if (b->png) put_picture(b, what, r->taps, &ao);
    image_free(&ao);
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

void bout_run(bout *b)
{
    char error[1024] = "";
    int  i, k;

    if (!b->cap.hf_ao.data) make_height_field(&b->cap);
    if (!peers_frame(b->peers, &b->cap, error, sizeof error)) die(EXIT_FRAME, "%s: %s", b->name, error);
    for (i = 0; i < PRESETS; ++i) add_preset(b, i);
    for (i = 0; i < PEERS; ++i) add_peer(b, i);
    for (i = 0; i < b->row_count; ++i) first_run(b, &b->rows[i]); /* errors; and it compiles */
    if (b->png && b->cap.truth_ao.data) put_picture(b, "truth", 0, &b->cap.truth_ao);
    for (k = 0; k < b->repeats; ++k) { /* A B C ... A B C ... */
        fprintf(stderr, "\r%s: timing, round %d of %d                ", b->name, k + 1, b->repeats);
        for (i = 0; i < b->row_count; ++i) run(b->rows[i].o, b->rows[i].p, &b->rows[i].ms[k], NULL);
    }
    fputs("\r                                                        \r", stderr);
    for (i = 0; i < b->row_count; ++i) {
        qsort(b->rows[i].ms, (size_t)b->repeats, sizeof b->rows[i].ms[0], by_size);
        b->rows[i].median = b->rows[i].ms[b->repeats / 2];
    }
}

void bout_free(bout *b)
{
    int i;

    for (i = 0; i < b->row_count; ++i) {
        ours_free(b->rows[i].o);
        peer_free(b->rows[i].p);
    }
    capture_free(&b->cap);
    free(b);
}
