/* sweep.c - hbil-tradeoff sweep: a grid of configs on all frames, into a results file that a second run continues. */
#include "commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "grid.h"
#include "rows.h"

#define CONFIGS_MAX 100000
#define OPTIONS_MAX (1u << 16)

typedef struct sweep {
    settings    s;
    const char *options, *presets, *out, *commit;
    int         budget, seed;
    externals   own;
    char       *text;           /* of the grid */
    grid        g;
    char      (*configs)[TEXT_MAX];
    int         config_count;
    rows        r;
    runner     *device;
    /* of the frame at hand */
    subject     sub;
    truth       t;
    int         truth_made;
    image       converged[OUTS];
    uint64_t    family;         /* that `converged` is of; 0: none */
    /* counts, over all frames */
    int         ran, kept, refused, equal;
    char        why[ERROR_MAX]; /* of the first refusal */
} sweep;

/* A config, or the external `own` with its own, that is to be run. */
typedef struct task { hbil_config config; uint64_t hash; const external *own; unsigned wanted; char preset[32]; } task;

void sweep_help(void)
{
    fputs(
        "  sweep   --out R.csv [--options TEXT|FILE] [--preset A,B] [--budget N] [--seed N] frames\n"
        "          every combination of the options' values, and the presets, on every frame. What R.csv holds\n"
        "          already (same device, driver, version, config, frame) is not run again: stop and go on at will.\n"
        "          Refused combinations are counted\n"
        "  --options TEXT    \"slices=1,2,4 steps=2..16*2 exponent=1..3+.5\": lists; ranges by factor, by step, by 1.\n"
        "                    preset=A,B tells where configs begin. Or a file of such text; # starts a comment\n"
        "  --preset A,B      presets as points of their own, next to the options; all: every preset\n"
        "  --commit TEXT     what the rows say of the code, as in --commit $(git describe --always --dirty)\n"
        "  --budget N        N combinations at random instead of all; --seed N chooses others, default 1\n",
        stdout);
    externals_help();
}

static int take(void *user, settings *s, const char *name, const char *value)
{
    sweep *w = user;
    const struct { const char *name; const char **target; } texts[] = {
        {"--options", &w->options}, {"--preset", &w->presets}, {"--out", &w->out},
        {"--commit", &w->commit}};
    size_t i;

    for (i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        if (!*value) return frame_error(s->error, sizeof s->error, "%s: without its value", name);
        *texts[i].target = value;
        return 1;
    }
    if (strcmp(name, "--external") == 0) return externals_add(&w->own, s, value);
    if (strcmp(name, "--budget") == 0)
        return read_int(value, 1, CONFIGS_MAX, &w->budget)
               || frame_error(s->error, sizeof s->error, "--budget %s: must be a whole number in [1, %d]", value,
                              CONFIGS_MAX);
    if (strcmp(name, "--seed") == 0)
        return read_int(value, 0, 1000000000, &w->seed)
            || frame_error(s->error, sizeof s->error, "--seed %s: must be a whole number in [0, 1000000000]", value);
    if (!*name) return frame_error(s->error, sizeof s->error, "%s: not expected here", value);
    return -1;
}

/* ---- what is to be run ------------------------------------------------------------------------------------------- */

/* The axes, from text or from the file of that name. */
static int read_grid(sweep *w)
{
    const char *text = w->options ? w->options : "";

    if (w->options && !strchr(w->options, '=')) {
        w->text = text_read(w->options, OPTIONS_MAX, "options", w->s.error, sizeof w->s.error);
        if (!w->text) return TRADE_FILES;
        text = w->text;
    }
    return grid_parse(&w->g, text, w->s.error, sizeof w->s.error) ? TRADE_DONE : TRADE_USAGE;
}

/* Combinations of the grid: all of them, or as many as the budget has. */
static int list_grid(sweep *w, uint64_t total, uint64_t count)
{
    uint64_t *chosen = malloc((size_t)count * sizeof *chosen), i;
    int       ok = chosen && grid_choose(total, count, (uint64_t)w->seed, chosen);

    for (i = 0; ok && i < count; i++) {
        ok = grid_text(&w->g, chosen[i], w->configs[w->config_count], TEXT_MAX);
        w->config_count++;
    }
    free(chosen);
    return ok
           || frame_error(w->s.error, sizeof w->s.error, "a combination of the options is longer than %d characters",
                          TEXT_MAX);
}

static int list_presets(sweep *w)
{
    const char *p = w->presets, *name;
    int         i, length;

    if (p && strcmp(p, "all") == 0) {
        for (i = 0; (name = hbil_preset_name(i)) != NULL; i++)
            snprintf(w->configs[w->config_count++], TEXT_MAX, "%s", name);
        return 1;
    }
    for (; p && *p; p += length + (p[length] == ',')) {
        length = (int)strcspn(p, ",");
        for (i = 0; (name = hbil_preset_name(i)) != NULL; i++)
            if ((int)strlen(name) == length && strncmp(name, p, (size_t)length) == 0) break;
        if (!name)
            return frame_error(w->s.error, sizeof w->s.error,
                               "--preset %.*s: no such preset; hbil-frame --help lists them", length, p);
        snprintf(w->configs[w->config_count++], TEXT_MAX, "%s", name);
    }
    return 1;
}

/* Texts of all configs. */
static int list_configs(sweep *w)
{
    const int      gridded = w->g.count > 0 || (!w->presets && !w->own.count);
    const uint64_t total = gridded ? grid_size(&w->g) : 0,
                   count = w->budget && (uint64_t)w->budget < total ? (uint64_t)w->budget : total;
    size_t         most = 64; /* presets */
    const char    *p;

    if (gridded && (total == 0 || count > CONFIGS_MAX))
        return frame_error(w->s.error, sizeof w->s.error,
                           "--options: more than %d combinations. Use fewer values, or --budget N", CONFIGS_MAX);
    for (p = w->presets; p && (p = strchr(p, ',')) != NULL; p++) most++;
    w->configs = malloc((size_t)(count + most) * sizeof *w->configs);
    if (!w->configs) return frame_error(w->s.error, sizeof w->s.error, "out of memory for the combinations");
    return (!gridded || list_grid(w, total, count)) && list_presets(w);
}

/* Outputs of the task whose rows are not there yet, as bits; 0: none is missing. */
static unsigned missing_rows(const sweep *w, const task *one)
{
    static const unsigned bits[OUTS] = {HBIL_OUTPUTS_AO, HBIL_OUTPUTS_NEAR, HBIL_OUTPUTS_FAR};
    const capture *cap = subject_judged(&w->sub);
    unsigned       missing = 0;
    char           key[512];
    int            k;

    for (k = 0; k < OUTS; k++) {
        if (!(one->config.outputs & bits[k])) continue;
        rows_key(key, sizeof key, runner_about(w->device), one->hash, w->sub.name, cap->width, cap->height, k);
        if (!rows_has(&w->r, key)) missing |= 1u << k;
    }
    return missing;
}

/* The i-th of all configs, and of all externals behind them. 0: it is refused. */
static int make_task(sweep *w, int i, task *one)
{
    const capture *cap = subject_judged(&w->sub);
    char           error[ERROR_MAX];

    memset(one, 0, sizeof *one);
    if (i >= w->config_count) {
        one->own = &w->own.list[i - w->config_count];
        one->config = one->own->plan.config;
        one->hash = one->own->plan.hash;
        return 1;
    }
    if (!config_make(&w->s, w->configs[i], 0, cap, &one->config, error, sizeof error)) {
        if (!w->refused++) snprintf(w->why, sizeof w->why, "%s", error);
        return 0;
    }
    one->hash = hbil_config_hash(&one->config);
    snprintf(one->preset, sizeof one->preset, "%s", config_preset_of(&w->s, &one->config, 0, cap));
    return 1;
}

/* Those of this frame that resolve, differ, and are not in the file. How many; -1: out of memory. */
static int list_tasks(sweep *w, task **out)
{
    const int   most = w->config_count + w->own.count;
    task       *tasks = malloc(((size_t)most + 1) * sizeof *tasks);
    uint64_t   *seen = malloc(((size_t)most + 1) * sizeof *seen);
    int         i, k, count = 0, seen_count = 0;

    for (i = 0; tasks && seen && i < most; i++) {
        task *one = &tasks[count];

        if (!make_task(w, i, one)) continue;
        for (k = 0; k < seen_count && seen[k] != one->hash; k++) { }
        if (k < seen_count) {
            w->equal++;
            continue;
        }
        seen[seen_count++] = one->hash;
        one->wanted = missing_rows(w, one);
        if (one->wanted) count++;
        else w->kept++;
    }
    free(seen);
    *out = tasks;
    return tasks && seen ? count : -1;
}

/* ---- running it -------------------------------------------------------------------------------------------------- */

static void drop_converged(sweep *w)
{
    int k;

    for (k = 0; k < OUTS; k++) image_free(&w->converged[k]);
    w->family = 0;
}

/* The images of the config's family, unless they are there. An exit code. */
static int converge(sweep *w, const hbil_config *config)
{
    hbil_config family;
    uint64_t    hash;
    int         code;

    truth_family(&w->s, config, &family);
    hash = hbil_config_hash(&family);
    if (hash == w->family) return TRADE_DONE;
    drop_converged(w);
    code = truth_converged(&w->s, w->device, &w->sub, config, w->converged);
    if (code == TRADE_DONE) w->family = hash;
    return code;
}

static int run_task(sweep *w, const task *one)
{
    const capture *cap = subject_judged(&w->sub);
    settings      *s = &w->s;
    char           words[TEXT_MAX];
    measured       m;
    lit            l;
    int            code = one->own ? TRADE_DONE : converge(w, &one->config);

    if (code != TRADE_DONE) return code;
    if (!(one->own ? lit_open_external(&l, w->device, s, one->own, &w->sub, s->error, sizeof s->error)
                   : lit_open(&l, w->device, s, &one->config, &w->sub, s->error, sizeof s->error)))
        return TRADE_MISFIT;
    code = measure_all(s, &l, &w->t, one->own ? NULL : w->converged, &m);
    lit_close(&l);
    if (one->own) snprintf(words, sizeof words, "%s", one->own->name);
    else config_text(&one->config, ' ', words);
    if (code == TRADE_DONE
        && !rows_add(&w->r, runner_about(w->device), one->hash, words, one->preset, w->sub.name, cap->width,
                     cap->height, &m, one->wanted, s->error, sizeof s->error))
        code = TRADE_FILES;
    return code;
}

static int by_family(const void *a, const void *b) /* one converged estimator after the other */
{
    const hbil_config *x = &((const task *)a)->config, *y = &((const task *)b)->config;

    return x->estimator != y->estimator ? x->estimator - y->estimator : x->march - y->march;
}

static int run_tasks(sweep *w, const subject_list *list, int index)
{
    task *tasks = NULL;
    int   i, code = TRADE_DONE, far = 0, count = list_tasks(w, &tasks);
    char  what[128];

    if (count < 0) {
        frame_error(w->s.error, sizeof w->s.error, "out of memory for %d configs", w->config_count);
        code = TRADE_BACKEND;
    }
    for (i = 0; i < count; i++) far |= (tasks[i].config.outputs & HBIL_OUTPUTS_FAR) != 0;
    if (count > 0) {
        qsort(tasks, (size_t)count, sizeof *tasks, by_family);
        code = truth_make(&w->s, &w->sub, far, &w->t);
        w->truth_made = code == TRADE_DONE;
    }
    for (i = 0; code == TRADE_DONE && i < count; i++) {
        snprintf(what, sizeof what, "%s (%d of %d), config %d of %d", w->sub.name, index + 1, list->count, i + 1,
                 count);
        progress_show(&w->s, (index + (double)i / count) / list->count, what);
        code = run_task(w, &tasks[i]);
        w->ran += code == TRADE_DONE;
    }
    free(tasks);
    return code;
}

static int run_subject(sweep *w, const subject_list *list, int index)
{
    int code = subject_load(&w->s, &list->items[index], &w->sub);

    if (code != TRADE_DONE) return code;
    code = run_tasks(w, list, index);
    drop_converged(w);
    if (w->truth_made) truth_free(&w->t);
    w->truth_made = 0;
    subject_free(&w->sub);
    return code;
}

static int run(sweep *w)
{
    static subject_list list;
    int                 code = read_grid(w), i;

    if (code != TRADE_DONE) return code;
    if (!list_configs(w)) return TRADE_USAGE;
    code = externals_open(&w->own, &w->s);
    if (code == TRADE_DONE) code = subject_find(&w->s, &list);
    if (code != TRADE_DONE) return code;
    if (!rows_open(&w->r, w->out, w->s.error, sizeof w->s.error)) return TRADE_FILES;
    w->r.commit = w->commit;
    if (w->r.repaired)
        fprintf(stderr, "hbil-tradeoff: %s: a torn last line of %d bytes was cut off\n", w->out, w->r.repaired);
    w->device = runner_open(w->s.backend, 0, w->s.error, sizeof w->s.error);
    for (i = 0, code = w->device ? TRADE_DONE : TRADE_BACKEND; code == TRADE_DONE && i < list.count; i++)
        code = run_subject(w, &list, i);
    progress_end(&w->s);
    if (w->refused) fprintf(stderr, "hbil-tradeoff: %d refused, the first: %s\n", w->refused, w->why);
    printf("%d configs run, %d were there, %d equal to others, %d refused\n", w->ran, w->kept, w->equal, w->refused);
    if (code == TRADE_DONE && w->ran + w->kept == 0) {
        frame_error(w->s.error, sizeof w->s.error, "no combination was left to run");
        code = TRADE_REFUSED;
    }
    return code;
}

int sweep_main(int argc, char **argv)
{
    sweep *w = calloc(1, sizeof *w);
    int    code = TRADE_BACKEND;

    if (!w) return fputs("hbil-tradeoff: out of memory\n", stderr), TRADE_BACKEND;
    settings_default(&w->s);
    w->r.file = -1;
    w->seed = 1;
    if (command_line(&w->s, argc, argv, sweep_help, take, w, &code)) {
        if (w->out) code = run(w);
        else {
            frame_error(w->s.error, sizeof w->s.error, "no results file: add --out R.csv");
            code = TRADE_USAGE;
        }
        if (code != TRADE_DONE) command_fail(&w->s, code);
    }
    if (w->device) runner_close(w->device);
    if (w->r.file >= 0) rows_close(&w->r);
    settings_free(&w->s);
    externals_free(&w->own);
    free(w->configs);
    free(w->text);
    free(w);
    return code;
}
