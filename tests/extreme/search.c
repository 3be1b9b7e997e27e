/* search.c - hbil-search: random configs on random frames, until something breaks the contract; then the smallest case that still does. */
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "case_file.h"
#include "devices.h"
#include "contract.h"
#include "run_case.h"
#include "shrink.h"

enum { CLEAN, FOUND, USAGE, DEVICE, OUTPUT, SKIPPED = 77 };
enum { BACKENDS_MAX = 8, KINDS_MAX = 64 };

static const char help[] =
    "hbil-search: random configs on random frames; every output must stay within its bounds\n"
    "\n"
    "  hbil-search [options]                  search\n"
    "  hbil-search --replay [options] CASE... run cases that were written before\n"
    "\n"
    "  --seed N          where to begin. Default: HBIL_SEED, else the days since 1970: every day tries new ones\n"
    "  --first K         the first variant of that seed, default 0\n"
    "  --variants N      stop after so many configs. Default: no limit\n"
    "  --seconds S       stop after so long. Default: 20, or no limit with --pixels or --variants\n"
    "  --pixels N        stop after so many. Default: no limit\n"
    "  --per-variant N   pixels on each config, default 40000; less where the march is long\n"
    "  --backend LIST    " DEVICES "; several with commas, which take turns. Default:\n"
    "                    vulkan. twin is the shaders' text compiled for the CPU: seconds a config; loose the same,\n"
    "                    as inaccurate as Vulkan allows\n"
    "  --failures N      stop after so many different ones, default 1\n"
    "  --shrink S        seconds for making a failure small, default 60\n"
    "  --out DIR         where cases of failures go, default .\n"
    "  --plant FROM TO   a fault in the shaders: TO stands for FROM. To see that it is found\n"
    "  --quiet           only what is found, and the closing line\n"
    "  --help            this text\n"
    "\n"
    "exit code: 0 nothing found, 1 a failure was found and written, 2 wrong arguments, 3 no such device, 4 a case cannot be read or written,\n"
    "77 none of the devices is there\n";

typedef struct options {
    uint64_t    seed;
    long long   first, variants, pixels;
    long        per_variant, failures;
    double      seconds, shrink;
    const char *backends[BACKENDS_MAX], *out, *from, *to;
    int         backend_count, replay, quiet, files;
    char        list[128];
} options;

typedef struct totals {
    long long variants, refused, refused_frames, failed, frames, pixels;
    uint64_t *hashes;                   /* of the plans so far; open addressing, 0 is free */
    size_t    room, distinct;
    char      kinds[KINDS_MAX][96];     /* device and kind of what was found */
    int       kind_count;
    double    until;                    /* 0: no limit */
} totals;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ------------------------------------------------------------------------------------------------ when a driver goes down */

static char where[256]; /* what to repeat */

static void on_signal(int number)
{
    const char *what = number == SIGALRM ? "hbil-search: no answer for two minutes: " : "hbil-search: crashed: ";
    ssize_t n = write(STDERR_FILENO, what, strlen(what));
    n = write(STDERR_FILENO, where, strlen(where));
    (void)n;
    _exit(FOUND);
}

/* -------------------------------------------------------------------------------------------------------------- counting */

static int is_new(totals *t, uint64_t hash)
{
    size_t i, k;
    if (2 * (t->distinct + 1) > t->room) {
        const size_t room = t->room ? 2 * t->room : 1024;
        uint64_t *more = (uint64_t *)calloc(room, sizeof *more);
        if (!more) return 0;
        for (i = 0; i < t->room; ++i) {
            if (!t->hashes[i]) continue;
            for (k = (size_t)t->hashes[i] & (room - 1); more[k]; k = (k + 1) & (room - 1)) { }
            more[k] = t->hashes[i];
        }
        free(t->hashes);
        t->hashes = more;
        t->room = room;
    }
    for (k = (size_t)hash & (t->room - 1); t->hashes[k]; k = (k + 1) & (t->room - 1))
        if (t->hashes[k] == hash) return 0;
    t->hashes[k] = hash;
    ++t->distinct;
    return 1;
}

static void say_totals(const options *o, const totals *t, double seconds, const char *head)
{
    printf("%sseed %llu: %lld frames, %lld pixels, %zu variants, %llu values checked, %lld configs and %lld frames refused, %lld failed, %.0f s\n",
           head, (unsigned long long)o->seed, t->frames, t->pixels, t->distinct, contract_values, t->refused, t->refused_frames, t->failed, seconds);
    fflush(stdout);
}

/* --------------------------------------------------------------------------------------------------------------- failures */

typedef struct wanted { subject *s; const char *kind; int twice; } wanted;

static int fails_alike(void *user, const test_case *c)
{
    const wanted *w = (const wanted *)user;
    verdict v;
    alarm(120);
    return case_run(w->s, c, w->twice, &v) == RUN_FAILS && strcmp(v.kind, w->kind) == 0;
}

/* A kind as part of a file's name. */
static void as_name(const char *kind, char *out, size_t size)
{
    size_t n = 0;
    for (; *kind && n + 1 < size; ++kind) {
        const int plain = (*kind >= 'a' && *kind <= 'z') || (*kind >= '0' && *kind <= '9') || *kind == '_';
        if (plain) out[n++] = *kind;
        else if (n && out[n - 1] != '-') out[n++] = '-';
    }
    out[n] = 0;
}

/* Makes it small and writes it. 0: it cannot be written. */
static int report(const options *o, subject *s, long long variant, const test_case *found, const verdict *first)
{
    wanted w = { s, first->kind, strstr(first->kind, "two runs") != NULL };
    char path[1024], name[64], note[1024], config[2048], error[512];
    test_case c;
    verdict last;
    int tried, ok;
    if (!case_copy(&c, found)) return fprintf(stderr, "hbil-search: out of memory\n"), 0;
    printf("FAILED on %s: %s\n  found by: hbil-search --seed %llu --first %lld --variants 1 --backend %s\n", subject_name(s), first->why,
           (unsigned long long)o->seed, variant, subject_name(s));
    fflush(stdout);
    tried = shrink(&c, fails_alike, &w, o->shrink);
    alarm(120);
    case_run(s, &c, w.twice, &last);
    as_name(first->kind, name, sizeof name);
    snprintf(path, sizeof path, "%s/%s-%s-%llu-%lld.case", o->out, name, subject_name(s), (unsigned long long)o->seed, variant);
    snprintf(note, sizeof note, "# %s: %s\n", subject_name(s), last.why);
    ok = case_write(path, &c, note, error, sizeof error);
    if (!ok) fprintf(stderr, "hbil-search: %s\n", error);
    hbil_config_print(&c.config, 0, config, sizeof config, NULL);
    printf("  as small as %d tries make it, %ld pixels in %d frames: %s\n  config: %s\n", tried, case_pixels(&c), c.frames, last.why, config);
    if (ok) printf("  written: %s\n  repeat:  hbil-search --replay --backend %s %s\n", path, subject_name(s), path);
    fflush(stdout);
    case_free(&c);
    return ok;
}

static int seen(totals *t, const subject *s, const char *kind)
{
    char key[96];
    int i;
    snprintf(key, sizeof key, "%s %s", subject_name(s), kind);
    for (i = 0; i < t->kind_count; ++i)
        if (strcmp(t->kinds[i], key) == 0) return 1;
    if (t->kind_count < KINDS_MAX) strcpy(t->kinds[t->kind_count++], key);
    return 0;
}

/* ----------------------------------------------------------------------------------------------------------------- search */

/* Samples cost more than pixels: at most 1e7 of them a config. */
static long pixels_for(const options *o, const hbil_config *c)
{
    const double samples = 2.0 * c->slices * (c->march == HBIL_MARCH_SWEEP ? 4 : c->steps) / (c->downscale * c->downscale);
    const double most = c->dynamic & (HBIL_DYNAMIC_SLICES | HBIL_DYNAMIC_STEPS) ? 1e5 : 1e7 / samples;
    return most < (double)o->per_variant ? (long)most + 1 : o->per_variant;
}

/* Frames on one config, until it has its pixels. */
static int run_variant(const options *o, subject *s, long long variant, totals *t)
{
    rng r = { o->seed * 0x9e3779b97f4a7c15u ^ (uint64_t)variant * 0xd1342543de82ef95u };
    hbil_config config;
    hbil_plan plan;
    long left;
    int tries;
    rng_next(&r);
    if (!random_config(&r, subject_target(s), &config) || hbil_plan_build(&config, &plan, NULL) != HBIL_OK) return ++t->refused, 1;
    snprintf(where, sizeof where, "--seed %llu --first %lld --variants 1 --backend %s\n", (unsigned long long)o->seed, variant, subject_name(s));
    left = pixels_for(o, &config);
    for (tries = 0; left > 0 && tries < 24 && (t->until <= 0 || now() < t->until); ++tries) {
        test_case c;
        verdict v;
        run_result result;
        if (!random_frames(&r, &plan, (int)left < 40000 ? (int)left : 40000, &c)) return fprintf(stderr, "hbil-search: out of memory\n"), 0;
        alarm(120);
        result = case_run(s, &c, rng_below(&r, 8) == 0, &v);
        left -= case_pixels(&c);
        if (result == RUN_REFUSED) ++t->refused_frames;
        if (result != RUN_REFUSED) t->pixels += case_pixels(&c), t->frames += c.frames, is_new(t, plan.hash);
        if (result == RUN_FAILS) {
            ++t->failed;
            if (!seen(t, s, v.kind) && !report(o, s, variant, &c, &v)) return case_free(&c), 0;
        }
        case_free(&c);
        if (result == RUN_FAILS) break;
    }
    return 1;
}

static int search(const options *o, subject **subjects, int count)
{
    const double start = now();
    double said = start;
    totals t;
    long long k;
    int ok = 1;
    memset(&t, 0, sizeof t);
    t.until = o->seconds > 0 ? start + o->seconds : 0;
    for (k = o->first; ok && t.kind_count < o->failures; ++k) {
        if (o->seconds > 0 && now() - start >= o->seconds) break;
        if (o->pixels && t.pixels >= o->pixels) break;
        if (o->variants && k - o->first >= o->variants) break;
        ok = run_variant(o, subjects[k % count], k, &t);
        if (o->quiet || now() - said < 2) continue;
        said = now();
        say_totals(o, &t, said - start, "  ");
    }
    alarm(0);
    say_totals(o, &t, now() - start, "hbil-search: ");
    free(t.hashes);
    return !ok ? OUTPUT : t.kind_count ? FOUND : CLEAN;
}

/* ----------------------------------------------------------------------------------------------------------------- replay */

static int replay(const options *o, subject **subjects, int count, char **files)
{
    int i, k, code = CLEAN;
    for (i = 0; i < o->files; ++i) {
        char error[512];
        test_case c;
        if (!case_read(files[i], &c, error, sizeof error)) {
            fprintf(stderr, "hbil-search: %s\n", error);
            code = OUTPUT;
            continue;
        }
        for (k = 0; k < count; ++k) {
            verdict v;
            run_result result;
            snprintf(where, sizeof where, "--replay --backend %s %.180s\n", subject_name(subjects[k]), files[i]);
            alarm(120);
            result = case_run(subjects[k], &c, 1, &v);
            if (result == RUN_FAILS && code == CLEAN) code = FOUND;
            if (result == RUN_HOLDS && !o->quiet) printf("%s on %s: holds\n", files[i], subject_name(subjects[k]));
            if (result != RUN_HOLDS)
                printf("%s on %s: %s: %s\n", files[i], subject_name(subjects[k]), result == RUN_FAILS ? "FAILED" : "refused", v.why);
        }
        case_free(&c);
    }
    alarm(0);
    printf("hbil-search: %d cases replayed on %d devices, %llu values checked\n", o->files, count, contract_values);
    return code;
}

/* ----------------------------------------------------------------------------------------------------------------- options */

static int wrong(const char *what, const char *name)
{
    fprintf(stderr, "hbil-search: %s: %s. See --help\n", name, what);
    return 0;
}

static int take_number(const char *name, const char *text, double least, double *out)
{
    char *end;
    *out = text ? strtod(text, &end) : 0;
    if (!text || end == text || *end || !(*out >= least) || *out > 1e18) return wrong(text ? "not such a number" : "a number must follow", name);
    return 1;
}

static int take_backends(options *o, const char *list)
{
    char *word;
    o->backend_count = 0;
    if (!list || strlen(list) >= sizeof o->list) return wrong(DEVICES " must follow", "--backend");
    strcpy(o->list, list);
    for (word = strtok(o->list, ","); word; word = strtok(NULL, ",")) {
        if (!device_known(word)) return wrong("no such device: " DEVICES, word);
        if (o->backend_count == BACKENDS_MAX) return wrong("more devices than eight", "--backend");
        o->backends[o->backend_count++] = word;
    }
    return o->backend_count > 0 || wrong(DEVICES " must follow", "--backend");
}

/* Files that are no options are moved to the front of argv. */
static int take_options(options *o, int argc, char **argv)
{
    int i, limited = 0, timed = 0;
    for (i = 1; i < argc; ++i) {
        const char *name = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        const struct { const char *name; double least; int kind; void *to; } numbers[] = {
            { "--first", 0, 1, &o->first }, { "--variants", 1, 1, &o->variants }, { "--pixels", 1, 1, &o->pixels },
            { "--per-variant", 1, 2, &o->per_variant }, { "--failures", 1, 2, &o->failures }, { "--seconds", 0, 3, &o->seconds },
            { "--shrink", 0, 3, &o->shrink }, { "--seed", 0, 4, &o->seed } };
        size_t k;
        double v;
        for (k = 0; k < sizeof numbers / sizeof *numbers && strcmp(name, numbers[k].name); ++k) { }
        if (k < sizeof numbers / sizeof *numbers) {
            if (!take_number(name, value, numbers[k].least, &v)) return 0;
            if (numbers[k].kind == 1) *(long long *)numbers[k].to = (long long)v;
            if (numbers[k].kind == 2) *(long *)numbers[k].to = (long)v;
            if (numbers[k].kind == 3) *(double *)numbers[k].to = v;
            if (numbers[k].kind == 4) *(uint64_t *)numbers[k].to = (uint64_t)v;
            limited |= k == 1 || k == 2;
            timed |= k == 5;
            ++i;
        } else if (strcmp(name, "--backend") == 0) {
            if (!take_backends(o, value)) return 0;
            ++i;
        } else if (strcmp(name, "--out") == 0) {
            if (!value) return wrong("a folder must follow", name);
            o->out = argv[++i];
        } else if (strcmp(name, "--plant") == 0) {
            if (i + 2 >= argc || !*value) return wrong("two texts must follow", name);
            o->from = argv[++i];
            o->to = argv[++i];
        } else if (strcmp(name, "--quiet") == 0) o->quiet = 1;
        else if (strcmp(name, "--replay") == 0) o->replay = 1;
        else if (name[0] == '-') return wrong("no such option", name);
        else argv[o->files++] = argv[i];
    }
    if (limited && !timed) o->seconds = 0;
    if (o->replay != (o->files > 0)) return wrong("cases and --replay go together", o->replay ? "--replay" : argv[0]);
    return 1;
}

int main(int argc, char **argv)
{
    const char *seed = getenv("HBIL_SEED");
    subject *subjects[BACKENDS_MAX] = { NULL };
    char error[512];
    options o;
    int i, k, count = 0, code;
    memset(&o, 0, sizeof o);
    o.seed = seed && *seed ? (uint64_t)strtoull(seed, NULL, 10) : (uint64_t)(time(NULL) / 86400);
    o.per_variant = 40000;
    o.failures = 1;
    o.seconds = 20;
    o.shrink = 60;
    o.out = ".";
    o.backends[0] = "vulkan";
    o.backend_count = 1;
    for (i = 1; i < argc; ++i)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return fputs(help, stdout), CLEAN;
    if (!take_options(&o, argc, argv)) return USAGE;
    if (!o.replay && mkdir(o.out, 0777) != 0 && access(o.out, W_OK) != 0)
        return fprintf(stderr, "hbil-search: %s: no folder that can be written to\n", o.out), OUTPUT;
    for (i = 0; i < o.backend_count; ++i) { /* the same device twice takes two turns */
        for (k = 0; k < count && strcmp(o.backends[i], subject_name(subjects[k])); ++k) { }
        subjects[count] = k < count ? subjects[k] : subject_open(o.backends[i], error, sizeof error);
        if (subjects[count]) {
            subject_plant(subjects[count++], o.from, o.to);
            continue;
        }
        fprintf(stderr, "hbil-search: %s: %s\n", o.backends[i], error);
        if (o.backend_count == 1) return SKIPPED;
    }
    signal(SIGSEGV, on_signal);
    signal(SIGABRT, on_signal);
    signal(SIGFPE, on_signal);
    signal(SIGALRM, on_signal);
    code = count == 0 ? SKIPPED : o.replay ? replay(&o, subjects, count, argv) : search(&o, subjects, count);
    for (i = 0; i < count; ++i) {
        for (k = 0; k < i && subjects[k] != subjects[i]; ++k) { }
        if (k == i) subject_close(subjects[i]);
    }
    return code;
}
