/* hbil-peers - ambient occlusion of three.js (GTAOPass) and of n8ao beside presets of hbil.h: same frames, same device, same run.
 *
 * Fairness. The truths have no radius; the peers do. So each is run as shipped; "large", with a radius of the whole scene and no
 * fall-off or power; and "best", the settings out of a grid that come nearest to the truth they are judged by, on this very frame:
 * better than its user can know. Their own denoising is in image and time. Composition is in neither's time. */
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define HBIL_IMPLEMENTATION
#include "../../../hbil.h"
#include "../../../tests/captures.h"
#include "../../../tests/numeric/brute_force.h"
#include "../../frame/metric.h"
#include "../../frame/runner_internal.h"
#include "ours.h"
#include "peers.h"
#include "variants.h"

#define REPEATS_MAX 64
#define ROWS_MAX    96
#define RAYS        512  /* a pixel of our own height-field truth, where a frame brings none: standard error about .02 */
#define RAY_PIXELS  2500 /* about as many */
#define SAME_TIME   1.02 /* times ours counts as no slower */

enum { SCENE, HEIGHT_FIELD, TRUTHS };
enum { EXIT_USAGE = 2, EXIT_FRAME = 3, EXIT_NO_PEERS = 4, EXIT_RUN = 5 };

static const char *const truth_names[TRUTHS] = {"scene", "height field"};
static const char *const presets[] = {"balanced", "quality", "sampled", "gtao"};
enum { PRESETS = sizeof presets / sizeof *presets };

typedef struct errors { int known; double rmse, bias, correlation; } errors;

/* One method with its settings on one frame. */
typedef struct row {
    const char *who;
    int         peer, convention, judge; /* peer -1: ours. judge: of AS_BEST, the truth that chose the settings */
    char        settings[192];
    ours       *o;
    peer_pass *p;
    int         taps;
    double      ms[REPEATS_MAX], low, median, high;
    errors      e[TRUTHS];
} row;

typedef struct job {
    const char *frames, *frame, *scene, *cache, *script, *csv, *png;
    int         width, height, rays, repeats;
    void       *device;
    runner_info about;
    peers      *peers;
    char        cache_path[1024];
    FILE       *table;       /* of all frames: CSV */
    char       *table_text;
    size_t      table_size;
    int         won[PRESETS][PEERS][TRUTHS][2], asked[PRESETS][PEERS][TRUTHS][2]; /* [.. equal taps, equal time] */
} job;

typedef struct stage { job *j; const char *name; capture cap; char folder[1100]; row rows[ROWS_MAX]; int row_count; } stage;

static void die(int code, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    fputs("hbil-peers: ", stderr);
    vfprintf(stderr, format, args);
    fputc('\n', stderr);
    va_end(args);
    exit(code);
}

/* ------------------------------------------------------------------------------------------------------------- errors */

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
    if (!out || !image_make(&cap->hf_ao, cap->width, cap->height, 1) || !image_make(&cap->hf_valid, cap->width, cap->height, 1)
        || !bf_run(&scene, grid, RAYS, out)) die(EXIT_RUN, "out of memory for the height-field truth");
    for (i = 0; i < grid.columns * grid.rows; ++i) {
        const int at = (grid.first + i / grid.columns * grid.stride) * cap->width + grid.first + i % grid.columns * grid.stride;

        cap->hf_ao.data[at] = (float)out[i].ao;
        cap->hf_valid.data[at] = out[i].sky == 0.0;
    }
    free(out);
}

/* --------------------------------------------------------------------------------------------------------------- rows */

static row *add_row(stage *s, const char *who, int peer, int convention)
{
    row *r = &s->rows[s->row_count];

    if (s->row_count == ROWS_MAX) die(EXIT_RUN, "more than %d rows", ROWS_MAX);
    s->row_count++;
    r->who = who;
    r->peer = peer;
    r->convention = convention;
    return r;
}

static peer_pass *load(stage *s, int peer, int convention, int rung, int point)
{
    char         name[64], error[1024] = "";
    peer_pass *p;

    variant_name(peer, convention, rung, point, name);
    p = peer_load(s->j->peers, s->folder, name, error, sizeof error);
    if (!p) die(EXIT_RUN, "%s", error);
    return p;
}

static void run_peer(peer_pass *p, double *ms, image *ao)
{
    char error[512] = "";

    if (!peer_run(p, ms, error, sizeof error)) die(EXIT_RUN, "%s", error);
    if (ao && !peer_read(p, ao)) die(EXIT_RUN, "out of memory");
}

typedef struct choice { double rmse; int point; float power; } choice;

/* The point of the grid, and the power, that come nearest to each truth. */
static void choose(stage *s, int peer, int rung, choice best[TRUTHS])
{
    int point, truth, k;

    for (truth = 0; truth < TRUTHS; ++truth) best[truth].rmse = HUGE_VAL;
    for (point = 0; point < variant_grid(peer); ++point) {
        peer_pass *p = load(s, peer, AS_BEST, rung, point);
        image        ao = {0, 0, 0, NULL};

        run_peer(p, NULL, &ao);
        peer_free(p);
        for (truth = 0; truth < TRUTHS; ++truth)
            for (k = 0; k < (peer == PEER_N8AO ? 5 : 1); ++k) {
                const errors e = compare(&ao, &s->cap, truth, variant_intensities[k]);
                const choice c = {e.rmse, point, variant_intensities[k]};

                if (e.known && e.rmse < best[truth].rmse) best[truth] = c;
            }
        image_free(&ao);
    }
}

static void add_best(stage *s, int peer, int rung, float large)
{
    choice best[TRUTHS];
    int    truth;

    choose(s, peer, rung, best);
    for (truth = 0; truth < TRUTHS; ++truth) {
        row *r;

        if (best[truth].rmse == HUGE_VAL) continue;
        r = add_row(s, peer_names[peer], peer, AS_BEST);
        r->judge = truth;
        r->p = load(s, peer, AS_BEST, rung, best[truth].point);
        variant_text(peer, AS_BEST, best[truth].point, large, r->settings);
        if (peer != PEER_N8AO) continue;
        if (!peer_set(r->p, "intensity", best[truth].power)) die(EXIT_RUN, "n8ao has no intensity");
        sprintf(r->settings + strlen(r->settings), " intensity=%g", (double)best[truth].power);
    }
}

static void add_peer(stage *s, int peer)
{
    const float large = variant_large(&s->cap);
    int         rung, convention;

    for (rung = 0; rung < RUNGS_MAX && peer_rungs[peer][rung]; ++rung) {
        fprintf(stderr, "\r%s: %s, settings for %d samples  ", s->name, peer_names[peer], peer_rungs[peer][rung]);
        for (convention = 0; convention < AS_BEST; ++convention) {
            row *r = add_row(s, peer_names[peer], peer, convention);

            r->p = load(s, peer, convention, rung, 0);
            variant_text(peer, convention, 0, large, r->settings);
            if (convention == AS_LARGE && peer == PEER_N8AO) strcat(r->settings, " intensity=1");
        }
        add_best(s, peer, rung, large);
    }
}

static void add_ours(stage *s)
{
    char error[1024] = "";
    int  i;

    for (i = 0; i < PRESETS; ++i) {
        row *r = add_row(s, "hbil", -1, AS_SHIPPED);

        r->o = ours_open(s->j->device, presets[i], &s->cap, error, sizeof error);
        if (!r->o) die(EXIT_RUN, "%s", error);
        snprintf(r->settings, sizeof r->settings, "%s", presets[i]);
    }
}

static void run_row(row *r, double *ms, image *ao)
{
    char error[1024] = "";

    if (r->p) run_peer(r->p, ms, ao);
    else if (!ours_run(r->o, ms, error, sizeof error)) die(EXIT_RUN, "%s", error);
    else if (ao && !ours_read(r->o, ao)) die(EXIT_RUN, "out of memory");
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Errors of a first run, which also compiles; then A B C ... A B C ... */
static void measure(stage *s)
{
    const int repeats = s->j->repeats;
    int       i, k, truth;

    for (i = 0; i < s->row_count; ++i) {
        row  *r = &s->rows[i];
        image ao = {0, 0, 0, NULL};

        run_row(r, NULL, &ao);
        r->taps = r->p ? peer_taps(r->p) : ours_taps(r->o);
        for (truth = 0; truth < TRUTHS; ++truth) r->e[truth] = compare(&ao, &s->cap, truth, 1.0f);
        if (s->j->png) {
            char path[1300], error[512] = "";

            snprintf(path, sizeof path, "%s/%s-%s-%s-%d%s.png", s->j->png, s->name, r->who, r->p ? convention_names[r->convention] : r->settings,
                     r->taps, r->convention == AS_BEST && r->judge ? "-hf" : "");
            if (!png_write(path, &ao, 0, error, sizeof error)) die(EXIT_FRAME, "%s", error);
        }
        image_free(&ao);
    }
    for (k = 0; k < repeats; ++k) {
        fprintf(stderr, "\r%s: timing, round %d of %d                ", s->name, k + 1, repeats);
        for (i = 0; i < s->row_count; ++i) run_row(&s->rows[i], &s->rows[i].ms[k], NULL);
    }
    fputs("\r                                                        \r", stderr);
    for (i = 0; i < s->row_count; ++i) {
        row *r = &s->rows[i];

        qsort(r->ms, (size_t)repeats, sizeof *r->ms, by_size);
        r->low = r->ms[0];
        r->median = r->ms[repeats / 2];
        r->high = r->ms[repeats - 1];
    }
}

/* ------------------------------------------------------------------------------------------------------------- report */

static void label(const row *r, char out[320])
{
    if (r->peer < 0) snprintf(out, 320, "%s `%s`", r->who, r->settings);
    else snprintf(out, 320, "%s, %s%s%s%s%s", r->who, convention_names[r->convention], r->convention == AS_BEST ? " for the " : "",
                  r->convention == AS_BEST ? truth_names[r->judge] : "", *r->settings ? ": " : "", r->settings);
}

static void put_error(const errors *e)
{
    if (e->known) printf(" %.4f | %+.3f | %.2f |", e->rmse, e->bias, e->correlation);
    else printf(" - | - | - |");
}

static void put_rows(const stage *s)
{
    char name[320];
    int  i;

    printf("\n## %s, %dx%d\n\n", s->name, s->cap.width, s->cap.height);
    printf("\"large\" is %.3g m here. Medians of %d interleaved runs.\n\n", (double)variant_large(&s->cap), s->j->repeats);
    puts("| method | taps | ms | scene: rmse | bias | corr. | height field: rmse | bias | corr. |\n"
         "|---|---:|---:|---:|---:|---:|---:|---:|---:|");
    for (i = 0; i < s->row_count; ++i) {
        const row *r = &s->rows[i];

        label(r, name);
        printf("| %s | %d | %.1f |", name, r->taps, r->median);
        put_error(&r->e[SCENE]);
        put_error(&r->e[HEIGHT_FIELD]);
        putchar('\n');
    }
}

/* A peer's row may be judged by a truth unless its settings were chosen by the other. */
static int fits(const row *r, int peer, int truth)
{
    return r->peer == peer && r->e[truth].known && (r->convention != AS_BEST || r->judge == truth);
}

/* Fewest taps of the peer that are at least those of ours. */
static int equal_taps(const stage *s, int peer, int taps)
{
    int i, best = 0, most = 0;

    for (i = 0; i < s->row_count; ++i) {
        const row *r = &s->rows[i];

        if (r->peer != peer) continue;
        if (r->taps >= taps && (!best || r->taps < best)) best = r->taps;
        if (r->taps > most) most = r->taps;
    }
    return best ? best : most;
}

/* The peer's row of least error among those of so many taps, or, taps 0, among those no slower than ms. convention < 0: any. */
static const row *least(const stage *s, int peer, int truth, int taps, double ms, int convention)
{
    const row *best = NULL;
    int        i;

    for (i = 0; i < s->row_count; ++i) {
        const row *r = &s->rows[i];

        if (!fits(r, peer, truth) || (convention >= 0 && r->convention != convention)) continue;
        if (taps ? r->taps != taps : r->median > SAME_TIME * ms) continue;
        if (!best || r->e[truth].rmse < best->e[truth].rmse) best = r;
    }
    return best;
}

/* [how] 0: equal taps, 1: equal time. Nobody there to be beaten: won. */
static void judge(stage *s, int preset, int peer, int truth, int how, const row *theirs, const row *own)
{
    const int won = !theirs || own->e[truth].rmse <= theirs->e[truth].rmse;

    s->j->asked[preset][peer][truth][how]++;
    s->j->won[preset][peer][truth][how] += won;
    printf(won ? " |" : " **loses** |");
}

static void put_pair(stage *s, int preset, int peer, int truth)
{
    const row *own = &s->rows[preset];
    const int  taps = equal_taps(s, peer, own->taps);
    const row *at_taps = least(s, peer, truth, taps, 0.0, -1), *at_time = least(s, peer, truth, 0, own->median, -1);
    int        convention;

    if (!own->e[truth].known || !at_taps) return;
    printf("| `%s` | %d | %.1f | %.4f | %s | %s | %d | %.2f |", own->settings, own->taps, own->median, own->e[truth].rmse, truth_names[truth],
           peer_names[peer], taps, at_taps->median / own->median);
    for (convention = 0; convention < CONVENTIONS; ++convention) {
        const row *r = least(s, peer, truth, taps, 0.0, convention);

        if (r) printf(" %.4f |", r->e[truth].rmse);
        else printf(" - |");
    }
    judge(s, preset, peer, truth, 0, at_taps, own);
    if (at_time) printf(" %.4f (%d taps, %.1f ms) |", at_time->e[truth].rmse, at_time->taps, at_time->median);
    else printf(" none is that fast |");
    judge(s, preset, peer, truth, 1, at_time, own);
    putchar('\n');
}

static void put_pairs(stage *s)
{
    int preset, peer, truth;

    puts("\n| ours | taps | ms | rmse | truth | peer | its taps | its ms / ours | rmse as shipped | large | best | at equal taps, ours |"
         " at equal time, its least rmse | ours |\n|---|---:|---:|---:|---|---|---:|---:|---:|---:|---:|---|---|---|");
    for (preset = 0; preset < PRESETS; ++preset)
        for (truth = 0; truth < TRUTHS; ++truth)
            for (peer = 0; peer < PEERS; ++peer) put_pair(s, preset, peer, truth);
}

static void put_csv(stage *s)
{
    int i, truth;

    for (i = 0; i < s->row_count; ++i) {
        const row *r = &s->rows[i];

        fprintf(s->j->table, "%s,%d,%d,\"%s\",%s,%s,%s,%d,%.4f,%.4f,%.4f", s->name, s->cap.width, s->cap.height, s->j->about.device, r->who,
                r->p ? convention_names[r->convention] : "preset", r->settings, r->taps, r->low, r->median, r->high);
        for (truth = 0; truth < TRUTHS; ++truth)
            if (r->e[truth].known) fprintf(s->j->table, ",%.6f,%.6f,%.6f", r->e[truth].rmse, r->e[truth].bias, r->e[truth].correlation);
            else fputs(",,,", s->j->table);
        fprintf(s->j->table, ",%s\n", r->convention == AS_BEST ? truth_names[r->judge] : "");
    }
}

static void put_summary(const job *j)
{
    static const char *const how_names[2] = {"equal taps", "equal time"};
    int preset, peer, truth, how;

    puts("\n## Frames on which ours has the lower error\n\n| preset | truth | against | at | frames |\n|---|---|---|---|---:|");
    for (preset = 0; preset < PRESETS; ++preset)
        for (truth = 0; truth < TRUTHS; ++truth)
            for (peer = 0; peer < PEERS; ++peer)
                for (how = 0; how < 2; ++how)
                    printf("| `%s` | %s | %s, its best | %s | %d of %d |\n", presets[preset], truth_names[truth], peer_names[peer],
                           how_names[how], j->won[preset][peer][truth][how], j->asked[preset][peer][truth][how]);
}

static void put_head(const job *j)
{
    printf("# Ambient occlusion of peers, on %s, %s\n\n", j->about.device, j->about.driver);
    puts("- three: GTAOPass of three.js and its denoising. n8ao: its AO, depth mips and two denoising passes; it makes normals from\n"
         "  depth, the others read the frame's. Taps are depth samples a pixel of the ao pass; of our sweeps, horizons.\n"
         "- as shipped: the packages' defaults, but for the samples; radii 0.25 m and 5 m, n8ao with intensity 5, a power on its\n"
         "  result. large: radius of the whole scene, no fall-off, no power: what the truths are of. best: of a grid of radii,\n"
         "  fall-offs, spacings and powers, what comes nearest to the truth on this very frame. A user has no truth: this favours them.\n"
         "- n8ao's image goes through 8 bits between its passes, as shipped. Composition counts for nobody.\n"
         "- Scene truth is path-traced and noisy: about 0.03 of each rmse there is its own (see the captures' notes).\n"
         "- Near light: neither pass has any. (three.js has SSGINode, for its WebGPU renderer; n8ao's colour only tints its ao.)");
}

/* -------------------------------------------------------------------------------------------------------------- frames */

static void make_folder(const char *path)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST) die(EXIT_FRAME, "%s: cannot be made", path);
}

static void run_frame(job *j, const char *name, capture *cap)
{
    static stage s;
    char         error[1024] = "";
    int          missing, i;

    memset(&s, 0, sizeof s);
    s.j = j;
    s.name = name;
    s.cap = *cap;
    snprintf(s.folder, sizeof s.folder, "%s/%s-%dx%d", j->cache_path, name, cap->width, cap->height);
    make_folder(s.folder);
    if (!s.cap.hf_ao.data) make_height_field(&s.cap);
    if (!peers_frame(j->peers, &s.cap, error, sizeof error)) die(EXIT_FRAME, "%s: %s", name, error);
    if (!variants_extract(j->script, j->cache_path, s.folder, &s.cap, &missing, error, sizeof error))
        die(missing ? EXIT_NO_PEERS : EXIT_RUN, "%s", error);
    add_ours(&s);
    for (i = 0; i < PEERS; ++i) add_peer(&s, i);
    measure(&s);
    put_rows(&s);
    put_pairs(&s);
    put_csv(&s);
    fflush(stdout);
    for (i = 0; i < s.row_count; ++i) {
        ours_free(s.rows[i].o);
        peer_free(s.rows[i].p);
    }
    capture_free(&s.cap);
}

static void run_captures(job *j)
{
    capture_names all;
    capture       cap;
    char          error[1024] = "";
    int           i, found = 0;

    if (setenv("HBIL_CAPTURES", j->frames, 1) != 0) die(EXIT_RUN, "out of memory");
    all = captures_list();
    for (i = 0; i < all.count; ++i) {
        if (j->frame && strcmp(j->frame, all.name[i]) != 0) continue;
        if (!captures_load(all.name[i], 0, &cap, error, sizeof error)) die(EXIT_FRAME, "%s", error);
        run_frame(j, all.name[i], &cap);
        ++found;
    }
    if (!found) die(EXIT_FRAME, "%s: no folder%s%s in it has a frame-000.exr", j->frames, j->frame ? " " : "", j->frame ? j->frame : "");
}

static void run_scene(job *j)
{
    capture cap;
    char    error[1024] = "";

    if (!capture_scene(&cap, j->scene, j->width, j->height, j->rays, NULL, error, sizeof error)) die(EXIT_FRAME, "%s", error);
    run_frame(j, j->scene, &cap);
}

/* -------------------------------------------------------------------------------------------------------- command line */

static void usage(int code)
{
    fputs("usage: hbil-peers --frames DIR [--frame NAME] | --scene NAME [--size WxH] [--rays N]\n"
          "                  [--cache DIR] [--repeat N] [--csv FILE] [--png DIR]\n"
          "Ambient occlusion of three.js (GTAOPass) and n8ao beside presets of hbil.h, on OpenGL: error and time at their defaults, at\n"
          "equal taps and at equal time. Markdown on stdout, progress on stderr.\n"
          "  --frames DIR   subfolders with frame-000.exr, camera-000.json and, if there, hf-000.exr; --frame NAME: one of them\n"
          "  --scene NAME   a built-in scene: cornell (default size 320x180, 64 rays a pixel for its truth)\n"
          "  --cache DIR    npm packages and what is made of them; default ~/.cache/hbil-peers. Filled over the network once\n"
          "  --repeat N     timed rounds, default 5\n"
          "  --csv FILE     all rows as CSV; --png DIR: all images\n"
          "exit: 0 done; 2 usage; 3 a frame or file; 4 node, npm or the registry is not there; 5 GL, a package that changed, memory\n",
          code ? stderr : stdout);
    exit(code);
}

static int number(const char *text, int low, int high)
{
    char *end;
    long  v = strtol(text, &end, 10);

    if (end == text || *end || v < low || v > high) {
        fprintf(stderr, "hbil-peers: %s: a number in [%d, %d] is wanted\n", text, low, high);
        exit(EXIT_USAGE);
    }
    return (int)v;
}

static void read_arguments(int argc, char **argv, job *j)
{
    const char *size = NULL, *rays = NULL, *repeat = NULL;
    const struct { const char *name, **to; } options[] = {
        {"--frames", &j->frames}, {"--frame", &j->frame}, {"--scene", &j->scene}, {"--size", &size}, {"--rays", &rays},
        {"--cache", &j->cache}, {"--repeat", &repeat}, {"--csv", &j->csv}, {"--png", &j->png}, {"--extract", &j->script}};
    const int count = (int)(sizeof options / sizeof *options);
    int       i, k;

    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) usage(0);
        for (k = 0; k < count && strcmp(argv[i], options[k].name) != 0; ++k) { }
        if (k == count || i + 1 == argc) usage(EXIT_USAGE);
        *options[k].to = argv[++i];
    }
    if (!j->frames == !j->scene || (j->frame && !j->frames)) usage(EXIT_USAGE);
    if (size && (sscanf(size, "%dx%d", &j->width, &j->height) != 2 || j->width < 16 || j->height < 16)) usage(EXIT_USAGE);
    if (rays) j->rays = number(rays, 1, 65536);
    if (repeat) j->repeats = number(repeat, 1, REPEATS_MAX);
}

/* --cache, else the user's cache folder. It and its parent are made. */
static void find_cache(job *j)
{
    const char *home = getenv("HOME"), *xdg = getenv("XDG_CACHE_HOME");
    char        parent[900];

    if (j->cache) snprintf(j->cache_path, sizeof j->cache_path, "%s", j->cache);
    else {
        if (xdg && *xdg) snprintf(parent, sizeof parent, "%s", xdg);
        else snprintf(parent, sizeof parent, "%s/.cache", home && *home ? home : ".");
        make_folder(parent);
        snprintf(j->cache_path, sizeof j->cache_path, "%s/hbil-peers", parent);
    }
    make_folder(j->cache_path);
    if (j->png) make_folder(j->png);
}

int main(int argc, char **argv)
{
    static job j;
    char       error[1024] = "";

    j.width = 320;
    j.height = 180;
    j.rays = 64;
    j.repeats = 5;
    j.script = HBIL_PEERS_SCRIPT;
    read_arguments(argc, argv, &j);
    find_cache(&j);
    j.device = runner_gl.open(0, &j.about, error, sizeof error);
    if (!j.device) die(EXIT_RUN, "%s", error);
    j.peers = peers_open(j.device, error, sizeof error);
    if (!j.peers) die(EXIT_RUN, "%s", error);
    j.table = open_memstream(&j.table_text, &j.table_size);
    if (!j.table) die(EXIT_RUN, "out of memory");
    fputs("frame,width,height,device,who,convention,settings,taps,ms_min,ms_median,ms_max,scene_rmse,scene_bias,scene_correlation,"
          "hf_rmse,hf_bias,hf_correlation,chosen_by\n", j.table);
    put_head(&j);
    if (j.frames) run_captures(&j);
    else run_scene(&j);
    put_summary(&j);
    fclose(j.table);
    if (j.csv && !text_write(j.csv, j.table_text, error, sizeof error)) die(EXIT_FRAME, "%s", error);
    free(j.table_text);
    peers_close(j.peers);
    runner_gl.close(j.device);
    return 0;
}
