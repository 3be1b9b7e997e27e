/* long_run.c - hours of frames of a camera that walks in circles: nothing drifts, nothing leaks, nothing is NaN, equal frames are
 * equal bytes.
 *
 * A closed path of poses is traced once; its frames then run over and over, with running mean and recursive bounces. A run has two
 * parts, both with frame numbers that pass 2^32 amid their first round:
 *   walk     the noise of every frame is another. The means of each round must stay, and every texel be finite and bounded.
 *   circle   a reset, then the noise repeats with the path. The first round must be that of the walk, byte for byte; the later ones
 *            must become equal among themselves, as what the history began with dies out. */
#include <malloc.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../../hbil.h"

#include "../../examples/frame/capture.h"
#include "../../examples/frame/runner.h"

enum { DONE, FAULTY, USAGE, FAILED, SKIPPED = 77 };

#define POSES_MAX 600
#define CIRCLE_MAX 12000 /* frames: once equal, they stay so */
#define TAU 6.283185307f

static const char k_config[] = "outputs=ao+bent+near+far+irradiance+composite slices=2 steps=4 environment=constant temporal=yes "
                               "bounces=recursive";
static const char *const k_backends[] = {"vulkan", "gl"};
static const char *const k_reprojects[] = {"camera", "gather", "scatter"};
static const char *const k_storages[] = {"full", "half"};
static const float k_far[3] = {0.5f, 0.7f, 1.0f}; /* radiance of the environment */

typedef struct args {
    const char *backend, *scene, *reproject, *storage, *config; /* NULL: all, the default, none */
    int         frames, poses, width, height;
    unsigned    seed;
    int         white;      /* albedo 1: the longest memory that light can have */
    int         turns;      /* of the six combinations, each backend takes turns */
} args;

/* The path: a capture and the encoded frame of each pose. */
typedef struct path {
    int        count;
    capture    poses[POSES_MAX];
    hbil_frame frames[POSES_MAX];
    image      inputs[POSES_MAX][HBIL_MAX_TEXTURES];
    double     radiance_max, albedo_max;
} path;

/* What one round had. */
typedef struct lap { double near, ao; long resident; size_t heap; } lap;

typedef struct run {
    const args *args;
    const path *path;
    runner     *device;
    hbil_plan   plan;
    const char *backend, *reproject, *storage;
    double      light_max, near_max, far_max; /* bounds of radiance, near and far light */
    lap        *laps;                         /* of both parts, one after the other */
    int         lap_count;
    image       last[POSES_MAX][HBIL_MAX_TEXTURES]; /* outputs of the last round */
    uint64_t    first[POSES_MAX];             /* hashes of the walk's first round */
    long        unlike_first;                 /* frames of the circle's first round that have other bytes */
    long        differ, differ_before;        /* numbers of this round of the circle that are not those of the round before; of that one */
    double      most, most_early;             /* largest such difference in a round, of 1 + the value; of the second round */
    int         settled;                      /* first round of the circle from which on all bytes are equal; 0: none */
    int         walk, circle;                 /* frames of both parts */
    double      near_seen, frames_per_second;
    int         fault;                        /* an output was out of its bounds; error says where */
    char        error[1024];
} run;

static path g_path; /* large */
static run  g_run;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- the path ----------------------------------------------------------------------------------------------------- */

static uint32_t mix(uint32_t x)
{
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return x ^ x >> 16;
}

/* [low, high) */
static float between(uint32_t *state, float low, float high)
{
    *state = mix(*state + 0x9e3779b9u);
    return low + (high - low) * (float)(*state >> 8) / 16777216.0f;
}

/* Traces the poses of a closed path: its end is one step from its start. */
static int path_make(path *p, const args *a, char *error, size_t size)
{
    uint32_t    state = a->seed;
    const float wide[3] = {between(&state, 0.1f, 0.3f), between(&state, 0.05f, 0.15f), between(&state, 0.1f, 0.3f)};
    const float turn = between(&state, 4.0f, 10.0f), phase = between(&state, 0.0f, TAU);

    for (p->count = 0; p->count < a->poses; p->count++) {
        const float t = TAU * (float)p->count / (float)a->poses;
        const float move[3] = {wide[0] * sinf(t), wide[1] * sinf(2.0f * t + phase), wide[2] * cosf(t)};
        capture    *cap = &p->poses[p->count];
        if (!capture_scene_from(cap, a->scene, move, turn * sinf(t + phase), a->width, a->height, 0, NULL, error, size)) return 0;
        for (int k = 0; k < 3 * a->width * a->height; k++) {
            if (a->white && cap->depth.data[k / 3] < 1e9f) cap->albedo.data[k] = 1.0f;
            p->radiance_max = fmax(p->radiance_max, (double)cap->direct.data[k]);
            p->albedo_max = fmax(p->albedo_max, (double)cap->albedo.data[k]);
        }
    }
    for (int k = 0; k < a->poses; k++)
        if (!capture_motion(&p->poses[k], &p->poses[(k + a->poses - 1) % a->poses])) return frame_error(error, size, "out of memory");
    return 1;
}

static void path_forget(path *p)
{
    for (int k = 0; k < POSES_MAX; k++)
        for (int t = 0; t < HBIL_MAX_TEXTURES; t++) image_free(&p->inputs[k][t]);
}

/* The frames as a plan takes them, each after the one before. */
static int path_encode(path *p, const hbil_plan *plan, char *error, size_t size)
{
    path_forget(p);
    for (int k = 0; k < p->count; k++) {
        if (!capture_encode(&p->poses[k], plan, &p->frames[k], p->inputs[k], error, size)) return 0;
        capture_follow(&p->frames[k], &p->poses[(k + p->count - 1) % p->count]);
        memcpy(p->frames[k].far_color, k_far, sizeof k_far);
    }
    return 1;
}

static void path_free(path *p)
{
    path_forget(p);
    for (int k = 0; k < POSES_MAX; k++) capture_free(&p->poses[k]);
}

/* ---- what holds in every frame ------------------------------------------------------------------------------------ */

/* Light cannot grow beyond the sum of its bounces: each is at most `gain` of the one before. Packed numbers are off by 2^-9. */
static void find_bounds(run *r)
{
    const hbil_config *c = &r->plan.config;
    const double near_factor = (double)c->near_intensity, gain = fmin(r->path->albedo_max, 0.95 / near_factor) * (1.0 + 1.0 / 256.0);

    r->far_max = (double)(k_far[2] * c->far_intensity) * 1.00001;
    r->light_max = (r->path->radiance_max + gain * r->far_max) / (1.0 - gain * near_factor);
    r->near_max = near_factor * r->light_max;
}

/* 0: error names the texel. Bounds of outputs by name; all others must be finite. */
static int check_output(run *r, const hbil_texture *t, const image *out, uint32_t frame)
{
    const struct { const char *name; double high; } rows[] = {
        {"ao", 1.0}, {"uniform_ao", 1.0}, {"specular_occlusion", 1.0}, {"multi_bounce", 1.0}, {"near", r->near_max}, {"far", r->far_max},
        {"irradiance", r->near_max + r->far_max}, {"composite", r->path->radiance_max + r->near_max + r->far_max}};
    const size_t count = (size_t)out->width * (size_t)out->height * (size_t)image_slices(out) * (size_t)out->channels;
    double       low = -1e30, high = 1e30;

    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].name, t->name) == 0) low = 0.0, high = fmax(rows[i].high, 1.0); /* 1: alpha */
    if (strcmp(t->name, "bent") == 0 || strcmp(t->name, "cone") == 0) low = -1.00001, high = 1.00001;
    for (size_t k = 0; k < count; k++) {
        const double v = (double)out->data[k];
        if (v >= low && v <= high) continue; /* not NaN */
        return frame_error(r->error, sizeof r->error, "frame %u: %s is %g at pixel %zu, channel %zu; legal is [%g, %g]", frame, t->name, v,
                           k / (size_t)out->channels, k % (size_t)out->channels, low, high);
    }
    return 1;
}

static uint64_t hash(const image outputs[HBIL_MAX_TEXTURES])
{
    uint64_t h = 14695981039346656037u;

    for (int t = 0; t < HBIL_MAX_TEXTURES; t++) {
        const image *o = &outputs[t];
        const size_t count = (size_t)o->width * (size_t)o->height * (size_t)image_slices(o) * (size_t)o->channels;
        const size_t bytes = o->data ? sizeof(float) * count : 0;
        const unsigned char *at = (const unsigned char *)o->data;
        for (size_t k = 0; k < bytes; k++) h = (h ^ at[k]) * 1099511628211u;
    }
    return h;
}

/* Counts the numbers that differ from those of the same pose one round before. */
static void compare(run *r, const image *before, const image *after)
{
    for (int t = 0; t < HBIL_MAX_TEXTURES; t++) {
        const size_t count = (size_t)after[t].width * (size_t)after[t].height * (size_t)image_slices(&after[t]) * (size_t)after[t].channels;
        if (!after[t].data || !before[t].data || memcmp(after[t].data, before[t].data, count * sizeof(float)) == 0) continue;
        for (size_t k = 0; k < count; k++) {
            const double a = (double)before[t].data[k], d = fabs((double)after[t].data[k] - a) / (1.0 + fabs(a));
            r->differ += memcmp(&before[t].data[k], &after[t].data[k], sizeof(float)) != 0;
            r->most = fmax(r->most, d);
        }
    }
}

/* ---- a run -------------------------------------------------------------------------------------------------------- */

/* Pages in memory, and bytes that malloc has given out. */
static void look_at_memory(lap *l)
{
    FILE *f = fopen("/proc/self/statm", "r");
    long  size = 0, resident = 0;

    if (f && fscanf(f, "%ld %ld", &size, &resident) == 2) l->resident = resident * sysconf(_SC_PAGESIZE);
    if (f) fclose(f);
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
    l->heap = mallinfo2().uordblks;
#endif
}

static void add_means(run *r, lap *l, const image *outputs)
{
    const image *near = &outputs[hbil_plan_texture(&r->plan, "near")], *ao = &outputs[hbil_plan_texture(&r->plan, "ao")];
    const size_t pixels = (size_t)ao->width * (size_t)ao->height;
    const double share = 1.0 / ((double)pixels * r->path->count);

    for (size_t k = 0; k < pixels; k++) {
        for (int c = 0; c < 3; c++) {
            const double v = (double)near->data[4 * k + (size_t)c];
            l->near += share * v / 3.0;
            r->near_seen = fmax(r->near_seen, v);
        }
        l->ao += share * (double)ao->data[k];
    }
}

static void progress(const run *r, const char *part, int frame)
{
    static double last;

    if (now() - last < 1.0) return;
    last = now();
    fprintf(stderr, "\r%s reproject=%s storage=%s: %s, frame %d   ", r->backend, r->reproject, r->storage, part, frame);
    fflush(stderr);
}

/* One frame of the circle: against the walk's first round, or the round before. */
static void look_back(run *r, int pose, int round, const image *outputs)
{
    if (round == 0) r->unlike_first += hash(outputs) != r->first[pose];
    else compare(r, r->last[pose], outputs);
    if (round > 0 && pose == r->path->count - 1) {
        if (round == 1) r->most_early = r->most;
        if (r->differ == 0 && r->settled == 0) r->settled = round + 1;
        if (r->differ != 0) r->settled = 0;
        r->differ_before = r->differ;
    }
    for (int t = 0; t < HBIL_MAX_TEXTURES; t++) {
        image_free(&r->last[pose][t]);
        r->last[pose][t] = outputs[t];
    }
}

/* One of the two parts. 0: error says why. */
static int run_part(run *r, int circle)
{
    const int      poses = r->path->count;
    const uint32_t base = 0u - (uint32_t)(poses / 2); /* passes 2^32 in the first round */
    image          outputs[HBIL_MAX_TEXTURES];

    for (int f = 0; f < (circle ? r->circle : r->walk); f++) {
        const int  pose = f % poses;
        hbil_frame frame = r->path->frames[pose];
        lap       *l = &r->laps[r->lap_count];
        frame.index = base + (uint32_t)(circle ? pose : f);
        frame.reset = f == 0;
        if (pose == 0) r->differ = 0, r->most = 0.0;
        progress(r, circle ? "circle" : "walk", f);
        if (!runner_run(r->device, &r->plan, &frame, r->path->inputs[pose], outputs, 1, NULL, r->error, sizeof r->error)) return 0;
        for (uint32_t t = 0; t < r->plan.texture_count && !r->fault; t++)
            if (outputs[t].data) r->fault = !check_output(r, &r->plan.textures[t], &outputs[t], (uint32_t)f);
        add_means(r, l, outputs);
        if (!circle && f < poses) r->first[pose] = hash(outputs);
        if (circle) look_back(r, pose, f / poses, outputs);
        else for (int t = 0; t < HBIL_MAX_TEXTURES; t++) image_free(&outputs[t]);
        if (pose == poses - 1) {
            look_at_memory(l);
            r->lap_count++;
        }
    }
    return 1;
}

/* ---- the verdict -------------------------------------------------------------------------------------------------- */

#if defined(__SANITIZE_ADDRESS__)
#define MEMORY 0             /* AddressSanitizer keeps what is freed; it tells leaks itself */
#else
#define MEMORY 1
#endif
#define WARM 600             /* frames until history and bounces have forgotten how they began */
#define DRIFT_MAX 1e-4       /* of a mean over half a walk, against that over the other half, beside what noise explains */
#define RESIDENT_MAX 2097152 /* bytes that either part may grow by, once it is warm */
#define HEAP_MAX 0.5         /* bytes a frame: what malloc has given out tells more than pages do */
#define APART_MAX 1e-5       /* of a number in equal frames, of 1 + its value, where histories never become equal */

/* The first round that counts, of so many. */
static int warm_round(const run *r, int rounds)
{
    const int warm = (WARM + r->path->count - 1) / r->path->count;
    return warm < rounds / 2 ? warm : rounds / 2;
}

/* Half a walk against the other half, relative; `noise` gets the standard error of that. offset: of a mean in a lap. */
static double drift_of(const lap *l, int count, size_t offset, double *noise)
{
    const int half = count / 2;
    double    mean[2] = {0.0, 0.0}, square = 0.0;

    for (int i = 0; i < 2 * half; i++) mean[i / half] += *(const double *)((const char *)&l[i] + offset) / half;
    for (int i = 0; i < 2 * half; i++) square += pow(*(const double *)((const char *)&l[i] + offset) - mean[i / half], 2.0);
    *noise = half > 1 ? sqrt(square / (half * (half - 1.0))) / mean[0] : 0.01;
    return (mean[1] - mean[0]) / mean[0];
}

typedef struct verdict {
    double near, near_noise, ao, ao_noise; /* drifts */
    long   resident, heap;                 /* growth in either part, bytes */
    double apart;                          /* bound of r->most where the circle has not become equal */
} verdict;

static verdict judge(const run *r)
{
    const int counts[2] = {r->walk / r->path->count, r->circle / r->path->count};
    const int warm = warm_round(r, counts[0]);
    const lap *l = r->laps;
    verdict   v;

    memset(&v, 0, sizeof v);
    v.near = drift_of(l + warm, counts[0] - warm, offsetof(lap, near), &v.near_noise);
    v.ao = drift_of(l + warm, counts[0] - warm, offsetof(lap, ao), &v.ao_noise);
    for (int part = 0; part < 2; l += counts[part++]) {
        const lap *from = l + warm_round(r, counts[part]), *to = l + counts[part] - 1;
        v.resident = to->resident - from->resident > v.resident ? to->resident - from->resident : v.resident;
        v.heap = (long)to->heap - (long)from->heap > v.heap ? (long)to->heap - (long)from->heap : v.heap;
    }
    /* it falls to 1/e in less than 2.5 histories, from the second round on */
    v.apart = fmax(APART_MAX, r->most_early * exp((2.0 * r->path->count - r->circle) / (2.5 * r->plan.config.history)));
    return v;
}

static int complain(const char *what)
{
    printf("    FAULT: %s\n", what);
    return 0;
}

/* Prints what a run came to. 1: all holds. */
static int report(const run *r)
{
    const verdict v = judge(r);
    const lap    *first = r->laps + warm_round(r, r->walk / r->path->count), *last = r->laps + r->lap_count - 1;
    int           ok = 1;

    printf("%-6s reproject=%-7s storage=%-4s %5.0f frames/s, largest near %.3f of at most %.3f, drift of near %+.1e (noise %.1e), "
           "ao %+.1e (%.1e); ", r->backend, r->reproject, r->storage, r->frames_per_second, r->near_seen, r->near_max, v.near,
           v.near_noise, v.ao, v.ao_noise);
    if (r->settled) printf("equal bytes from round %d of %d on; ", r->settled, r->circle / r->path->count);
    else printf("%ld numbers still differ, by %.1e (second round %.1e); ", r->differ_before, r->most, r->most_early);
    printf("resident %.1f to %.1f MiB, heap %+ld bytes\n", (double)first->resident / 1048576.0, (double)last->resident / 1048576.0,
           v.heap);
    if (r->fault) ok = complain(r->error);
    if (!(fabs(v.near) <= DRIFT_MAX + 5.0 * v.near_noise) || !(fabs(v.ao) <= DRIFT_MAX + 5.0 * v.ao_noise)) ok = complain("means drift");
    if (!(first->near > 0.0) || !(first->ao > 0.0)) ok = complain("no light, or no visibility: nothing was measured");
    if (r->unlike_first) ok = complain("after the reset, frames are not those of a fresh start");
    if (!r->settled && !(r->most <= v.apart)) ok = complain("frames that should be equal are not");
    if (MEMORY && (v.resident > RESIDENT_MAX || (double)v.heap > HEAP_MAX * r->walk + 1024.0)) ok = complain("memory grows");
    return ok;
}

/* ---- all runs ----------------------------------------------------------------------------------------------------- */

static int make_plan(run *r)
{
    hbil_config config = {0};
    hbil_diag   items[8];
    hbil_diags  diags = {items, 8, 0};
    char        more[128];

    snprintf(more, sizeof more, "target=%s reproject=%s storage=%s", r->backend, r->reproject, r->storage);
    if (hbil_config_parse(&config, k_config, strlen(k_config), &diags) == HBIL_OK &&
        (!r->args->config || hbil_config_parse(&config, r->args->config, strlen(r->args->config), &diags) == HBIL_OK) &&
        hbil_config_parse(&config, more, strlen(more), &diags) == HBIL_OK && hbil_plan_build(&config, &r->plan, &diags) == HBIL_OK) {
        if (hbil_plan_texture(&r->plan, "near") >= 0 && hbil_plan_texture(&r->plan, "ao") >= 0) return 1;
        return frame_error(r->error, sizeof r->error, "--config: outputs must have ao and near, which are measured");
    }
    return frame_error(r->error, sizeof r->error, "%s", diags.count ? items[0].text : "config rejected");
}

static void forget(run *r)
{
    for (int k = 0; k < POSES_MAX; k++)
        for (int t = 0; t < HBIL_MAX_TEXTURES; t++) image_free(&r->last[k][t]);
    free(r->laps);
    r->laps = NULL;
}

/* Exit code of one combination. */
static int run_one(run *r, path *p)
{
    const double start = now();
    int          ok;

    r->path = p;
    r->walk = r->args->frames;
    r->circle = r->walk < CIRCLE_MAX / p->count * p->count ? r->walk : CIRCLE_MAX / p->count * p->count;
    r->laps = calloc((size_t)((r->walk + r->circle) / p->count), sizeof *r->laps);
    if (!r->laps) frame_error(r->error, sizeof r->error, "out of memory");
    ok = r->laps && make_plan(r) && path_encode(p, &r->plan, r->error, sizeof r->error);
    if (ok) find_bounds(r);
    ok = ok && run_part(r, 0) && run_part(r, 1);
    r->frames_per_second = (r->walk + r->circle) / (now() - start);
    fprintf(stderr, "\r%79s\r", "");
    if (!ok) {
        fprintf(stderr, "hbil-long-run: %s reproject=%s storage=%s: %s\n", r->backend, r->reproject, r->storage, r->error);
        return FAILED;
    }
    ok = report(r);
    fflush(stdout);
    return ok ? DONE : FAULTY;
}

static int wanted(const char *choice, const char *name) { return !choice || strcmp(choice, name) == 0; }

/* All combinations on one backend. turns: half of them, the other half on the other one. */
static int run_backend(const args *a, path *p, int which)
{
    char    error[1024] = "";
    runner *device = runner_open(k_backends[which], 0, error, sizeof error);
    int     worst = DONE;

    if (!device) {
        fprintf(stderr, "hbil-long-run: %s\n", error);
        return SKIPPED;
    }
    printf("%s: %s\n", runner_about(device)->backend, runner_about(device)->device);
    for (int i = 0; i < 6 && worst != FAILED; i++) {
        if (!wanted(a->reproject, k_reprojects[i / 2]) || !wanted(a->storage, k_storages[i % 2])) continue;
        if (a->turns && (i / 2 + i + which) % 2) continue;
        memset(&g_run, 0, sizeof g_run);
        g_run.args = a;
        g_run.device = device;
        g_run.backend = k_backends[which];
        g_run.reproject = k_reprojects[i / 2];
        g_run.storage = k_storages[i % 2];
        const int code = run_one(&g_run, p);
        forget(&g_run);
        if (code > worst) worst = code;
    }
    runner_close(device);
    return worst;
}

/* ---- command line ------------------------------------------------------------------------------------------------- */

static void help(void)
{
    printf("hbil-long-run - a camera walks in circles for hours: nothing drifts, leaks, becomes NaN; equal frames are equal bytes\n\n"
           "usage: hbil-long-run [options]\n\n"
           "  --frames N        frames of the walk, a multiple of --poses; the circle has %d at most. default 36000\n"
           "  --poses N         frames of the closed path, [2, %d]. default 60\n"
           "  --size WxH        default 64x36\n"
           "  --scene NAME      built-in scene. default cornell\n"
           "  --white           every albedo 1: light that dies out slowest\n"
           "  --backend NAME    vulkan or gl. default both\n"
           "  --reproject NAME  camera, gather or scatter. default all\n"
           "  --storage NAME    full or half. default both\n"
           "  --turns           of the combinations, each backend takes every second one\n"
           "  --config TEXT     options beside: %s\n"
           "  --seed N          of the path. default 1\n"
           "  -h, --help\n\n"
           "walk: the noise of every frame is another; circle: after a reset it repeats with the path. Both pass frame number 2^32.\n\n"
           "exit: 0 all holds, 1 something does not, 2 wrong usage, 3 a frame could not be run, 77 no backend\n", CIRCLE_MAX, POSES_MAX, k_config);
}

static int number(const char *text, int low, int high, int *out)
{
    char      *end;
    const long v = strtol(text, &end, 10);

    if (*text == 0 || *end != 0 || v < low || v > high) return 0;
    *out = (int)v;
    return 1;
}

/* An option with a value. 0: none of ours, or a value that is not legal. */
static int take(args *a, const char *name, const char *value)
{
    int used = 0, seed = 0;

    if (strcmp(name, "--frames") == 0) return number(value, 1, 100000000, &a->frames);
    if (strcmp(name, "--poses") == 0) return number(value, 2, POSES_MAX, &a->poses);
    if (strcmp(name, "--seed") == 0 && number(value, 0, 2147483647, &seed)) return a->seed = (unsigned)seed, 1;
    if (strcmp(name, "--size") == 0)
        return sscanf(value, "%dx%d%n", &a->width, &a->height, &used) == 2 && value[used] == 0 && a->width > 0 && a->height > 0;
    if (strcmp(name, "--scene") == 0) return a->scene = value, 1;
    if (strcmp(name, "--config") == 0) return a->config = value, 1;
    if (strcmp(name, "--backend") == 0) return a->backend = value, wanted(value, "vulkan") || wanted(value, "gl");
    if (strcmp(name, "--storage") == 0) return a->storage = value, wanted(value, "full") || wanted(value, "half");
    if (strcmp(name, "--reproject") == 0)
        return a->reproject = value, wanted(value, "camera") || wanted(value, "gather") || wanted(value, "scatter");
    return 0;
}

/* DONE, or the exit code; -1: help was asked for. */
static int read_args(args *a, int count, char **words)
{
    for (int i = 1; i < count; i++) {
        if (strcmp(words[i], "--help") == 0 || strcmp(words[i], "-h") == 0) return -1;
        if (strcmp(words[i], "--white") == 0) a->white = 1;
        else if (strcmp(words[i], "--turns") == 0) a->turns = 1;
        else if (i + 1 < count && take(a, words[i], words[i + 1])) i++;
        else {
            fprintf(stderr, "hbil-long-run: %s%s%s: no such option, or no such value. See --help\n", words[i], i + 1 < count ? " " : "",
                    i + 1 < count ? words[i + 1] : "");
            return USAGE;
        }
    }
    if (a->frames % a->poses == 0 && a->frames / a->poses >= 4) return DONE;
    fprintf(stderr, "hbil-long-run: --frames %d is not four or more whole rounds of --poses %d\n", a->frames, a->poses);
    return USAGE;
}

int main(int count, char **words)
{
    args a = {NULL, "cornell", NULL, NULL, NULL, 36000, 60, 64, 36, 1, 0, 0};
    char error[1024] = "";
    int  code = read_args(&a, count, words), opened = 0, worst = DONE;

    if (code < 0) return help(), DONE;
    if (code != DONE) return code;
    printf("walks of %d frames of %dx%d, scene %s%s, path of %d poses, seed %u\n", a.frames, a.width, a.height, a.scene,
           a.white ? " in white" : "", a.poses, a.seed);
    if (!path_make(&g_path, &a, error, sizeof error)) {
        fprintf(stderr, "hbil-long-run: %s\n", error);
        return USAGE;
    }
    for (int i = 0; i < 2; i++) {
        if (!wanted(a.backend, k_backends[i])) continue;
        code = run_backend(&a, &g_path, i);
        opened += code != SKIPPED;
        if (code != SKIPPED && code > worst) worst = code;
    }
    path_free(&g_path);
    return opened ? worst : SKIPPED;
}
