/* growth.c - hbil-tradeoff growth: does the time of a march grow with pixels, slices and steps as it should, and how
 * near is it to that of its memory accesses alone? */
#include "growth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bound.h"
#include "commands.h"

#define WITHIN      0.10 /* of the time, that a prediction may be off */
#define VISIT       4    /* runs of a config in its turn, of which the first compiles and does not count */
#define SIZES       3
#define POINTS_MAX  64
#define PRESETS_MAX 32

static const int    slices_tried[] = {1, 2, 4, 8}, steps_tried[] = {4, 8, 16};
static const double sizes_tried[SIZES] = {1.0, 0.707, 0.5}; /* of width and height: as many pixels, half, a quarter */
enum { SLICES = sizeof slices_tried / sizeof *slices_tried, STEPS = sizeof steps_tried / sizeof *steps_tried };

typedef struct growth {
    settings    s;
    const char *presets, *part, *path;
    runner     *device;
    FILE       *out;
    int         off;    /* a prediction is off by more than WITHIN */
} growth;

void growth_help(void)
{
    fputs(
        "  growth  [--part fit|bound] [--preset A,B] [-o FILE] frames\n"
        "          how the time of marches grows, and what it cannot undercut, as tables of Markdown.\n"
        "          fit: march=sampled against slices, steps and pixels, march=sweep against slices and pixels; scenes\n"
        "          in three sizes, up to --size. Exit code 1 where a prediction is off by more than 10 %\n"
        "          bound: the march of presets, in turns with its memory accesses alone\n"
        "  --part P          only one of the two\n"
        "  --preset A,B      presets for bound, default: all but reference\n"
        "  -o FILE           a file in place of standard output\n",
        stdout);
}

static int take(void *user, settings *s, const char *name, const char *value)
{
    growth *g = user;
    const struct { const char *name; const char **target; } texts[] = {
        {"--part", &g->part}, {"--preset", &g->presets}, {"-o", &g->path}};
    size_t i;

    for (i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        if (!*value) return frame_error(s->error, sizeof s->error, "%s: without its value", name);
        *texts[i].target = value;
        return !g->part || strcmp(g->part, "fit") == 0 || strcmp(g->part, "bound") == 0
               || frame_error(s->error, sizeof s->error, "--part %s: must be fit or bound", g->part);
    }
    if (!*name) return frame_error(s->error, sizeof s->error, "%s: not expected here", value);
    return -1;
}

/* ---- the fit ----------------------------------------------------------------------------------------------------- */

static void terms_of(const growth_point *p, double out[GROWTH_TERMS])
{
    const int sampled = p->steps > 0.0;

    out[0] = p->pixels;
    out[1] = p->pixels * p->slices * (sampled ? p->steps : 1.0);
    out[2] = sampled ? p->pixels * p->slices : 1.0;
    out[3] = sampled ? 1.0 : 0.0;
}

/* Solves m x = m[][n], by elimination with pivots. 0: it has no single solution. */
static int solve(double m[GROWTH_TERMS][GROWTH_TERMS + 1], int n, double x[GROWTH_TERMS])
{
    int row, column, k, best;

    for (column = 0; column < n; column++) {
        for (best = row = column; row < n; row++)
            if (fabs(m[row][column]) > fabs(m[best][column])) best = row;
        if (fabs(m[best][column]) < 1e-9) return 0; /* columns have been scaled to 1 */
        for (k = 0; k <= n; k++) {
            const double other = m[best][k];

            m[best][k] = m[column][k];
            m[column][k] = other;
        }
        for (row = 0; row < n; row++) {
            const double factor = m[row][column] / m[column][column];

            for (k = column; row != column && k <= n; k++) m[row][k] -= factor * m[column][k];
        }
    }
    for (k = 0; k < n; k++) x[k] = m[k][n] / m[k][k];
    return 1;
}

double growth_fit(growth_point *points, int count, int terms, double factor[GROWTH_TERMS])
{
    double m[GROWTH_TERMS][GROWTH_TERMS + 1] = {{0}}, scale[GROWTH_TERMS] = {0}, t[GROWTH_TERMS], worst = 0.0;
    int    i, j, k;

    for (i = 0; i < count; i++)
        for (terms_of(&points[i], t), k = 0; k < terms; k++) scale[k] += pow(t[k] / points[i].ms, 2.0);
    for (k = 0; k < GROWTH_TERMS; k++) {
        scale[k] = sqrt(scale[k]);
        factor[k] = 0.0;
    }
    for (i = 0; i < count; i++) { /* normal equations of sum over k of factor[k] t[k] / ms = 1 */
        terms_of(&points[i], t);
        for (k = 0; k < terms; k++) t[k] /= points[i].ms * scale[k];
        for (k = 0; k < terms; k++) {
            for (j = 0; j < terms; j++) m[k][j] += t[k] * t[j];
            m[k][terms] += t[k];
        }
    }
    if (!solve(m, terms, factor)) return HUGE_VAL;
    for (k = 0; k < terms; k++) factor[k] /= scale[k];
    for (i = 0; i < count; i++) {
        terms_of(&points[i], t);
        for (points[i].predicted = 0.0, k = 0; k < terms; k++) points[i].predicted += factor[k] * t[k];
        worst = fmax(worst, fabs(points[i].predicted / points[i].ms - 1.0));
    }
    return worst;
}

/* ---- cost against pixels, slices, steps -------------------------------------------------------------------------- */

/* A config in a size, and its median of each round. */
typedef struct station { int size, slices, steps; double ms[TIMING_RUNS_MAX]; } station;

/* steps 0: a sweep. Samples are counted by uniforms: of numbers in the text, a driver makes other loops for each. */
static void station_text(const station *a, char out[TEXT_MAX])
{
    if (a->steps) snprintf(out, TEXT_MAX, "outputs=ao slices=%d steps=%d dynamic=slices+steps", a->slices, a->steps);
    else snprintf(out, TEXT_MAX, "outputs=ao march=sweep slices=%d", a->slices);
}

static int visit(growth *g, const subject *sizes, station *a, int round)
{
    settings   *s = &g->s;
    lit         l;
    part        march = {&l, NULL, 0};
    hbil_config config;
    double      ms[VISIT];
    char        text[TEXT_MAX];
    int         ok;

    station_text(a, text);
    if (!config_make(s, text, 0, subject_judged(&sizes[a->size]), &config, s->error, sizeof s->error))
        return TRADE_REFUSED;
    if (!lit_open(&l, g->device, s, &config, &sizes[a->size], s->error, sizeof s->error)) return TRADE_MISFIT;
    march.passes = part_bit(&l.plan, "sweep") | part_bit(&l.plan, "march");
    ok = part_run(&march, VISIT, ms, s->error, sizeof s->error);
    a->ms[round] = timing_median(ms + 1, VISIT - 1);
    lit_close(&l);
    return ok ? TRADE_DONE : TRADE_BACKEND;
}

static int list_stations(int sizes, int swept, station *out)
{
    int size, i, k, count = 0;

    for (size = 0; size < sizes; size++)
        for (i = 0; i < SLICES; i++)
            for (k = 0; k < (swept ? 1 : STEPS); k++) {
                out[count].size = size;
                out[count].slices = slices_tried[i];
                out[count++].steps = swept ? 0 : steps_tried[k];
            }
    return count;
}

/* The smallest sum that is within the limit, or the largest one. */
static void print_fit(growth *g, growth_point *points, int count, int swept)
{
    double factor[GROWTH_TERMS], worst = HUGE_VAL;
    int    i, terms, most = swept ? 3 : GROWTH_TERMS;

    for (terms = 1; terms < most && !(worst <= WITHIN);) worst = growth_fit(points, count, ++terms, factor);
    while (isinf(worst) && terms > 2) worst = growth_fit(points, count, --terms, factor); /* of one size */
    fprintf(g->out, "| pixels | slices |%s ms | predicted | off |\n|---:|---:|---:|---:|---:|%s\n",
            swept ? "" : " steps |", swept ? "" : "---:|");
    for (i = 0; i < count; i++) {
        const growth_point *p = &points[i];

        fprintf(g->out, "| %.0f | %.0f |", p->pixels, p->slices);
        if (!swept) fprintf(g->out, " %.0f |", p->steps);
        fprintf(g->out, " %.3f | %.3f | %+.1f %% |\n", p->ms, p->predicted, 100.0 * (p->predicted / p->ms - 1.0));
    }
    fprintf(g->out, "\nns a pixel = %.2f %+.2f x slices%s", 1e6 * factor[0], 1e6 * factor[1], swept ? "" : " x steps");
    if (terms > 2 && !swept) fprintf(g->out, " %+.2f x slices", 1e6 * factor[2]);
    if (terms == most) fprintf(g->out, ", and %.2f ms a frame", factor[most - 1]);
    fprintf(g->out, "; largest deviation %.1f %%, %s %.0f %%\n\n", 100.0 * worst,
            worst <= WITHIN ? "within" : "**not** within", 100.0 * WITHIN);
    g->off |= !(worst <= WITHIN);
}

/* Rounds over all configs, as many as --repeat says and --seconds a config allow. */
static int fit_march(growth *g, const subject *sizes, int size_count, int swept)
{
    static station stations[POINTS_MAX];
    growth_point   points[POINTS_MAX];
    const int      count = list_stations(size_count, swept, stations);
    const double   begun = seconds_now();
    const char    *name = swept ? "march=sweep" : "march=sampled";
    int            round, i, code = TRADE_DONE;

    for (round = 0; round < g->s.repeat && code == TRADE_DONE; round++) {
        if (round >= 3 && seconds_now() - begun > g->s.seconds * count) break;
        for (i = 0; i < count && code == TRADE_DONE; i++) {
            progress_show(&g->s, (round + (double)i / count) / g->s.repeat, name);
            code = visit(g, sizes, &stations[i], round);
        }
    }
    progress_end(&g->s);
    if (code != TRADE_DONE) return code;
    for (i = 0; i < count; i++) {
        const capture *cap = subject_judged(&sizes[stations[i].size]);

        points[i].pixels = (double)cap->width * cap->height;
        points[i].slices = stations[i].slices;
        points[i].steps = stations[i].steps;
        points[i].ms = timing_median(stations[i].ms, round);
    }
    fprintf(g->out, "### %s, %s: medians of %d rounds\n\n", sizes[0].name, name, round);
    print_fit(g, points, count, swept);
    return TRADE_DONE;
}

/* A scene in all sizes, a capture in its own. */
static int fit_subject(growth *g, const subject_name *name)
{
    subject   sizes[SIZES];
    const int width = g->s.width, height = g->s.height, most = name->folder[0] ? 1 : SIZES;
    int       count, code = TRADE_DONE;

    for (count = 0; count < most && code == TRADE_DONE; count += code == TRADE_DONE) {
        g->s.width = (int)fmax(1.0, width * sizes_tried[count] + 0.5);
        g->s.height = (int)fmax(1.0, height * sizes_tried[count] + 0.5);
        code = subject_load(&g->s, name, &sizes[count]);
    }
    g->s.width = width;
    g->s.height = height;
    if (code == TRADE_DONE) code = fit_march(g, sizes, count, 0);
    if (code == TRADE_DONE) code = fit_march(g, sizes, count, 1);
    while (count > 0) subject_free(&sizes[--count]);
    return code;
}

/* ---- the march against its accesses alone ------------------------------------------------------------------------ */

static int bound_pass(growth *g, lit *l, const char *preset, const char *pass)
{
    static duel  d;
    settings    *s = &g->s;
    bound        b;
    part         sides[2] = {{l, &b, part_bit(&l->plan, pass)}, {l, NULL, part_bit(&l->plan, pass)}};
    timing_ratio ratio;
    int          code;

    if (sides[0].passes == 0) return TRADE_DONE;
    code = bound_make(l, pass, &b, s->error, sizeof s->error);
    if (code != TRADE_DONE) return code;
    code = duel_turns(s, part_run, &sides[0], &sides[1], &d);
    if (code == TRADE_DONE) {
        ratio = timing_compare(d.turn[0], d.turn[1], d.turns);
        fprintf(g->out, "| %s | %s | %.3f | %.3f | %.2f [%.2f, %.2f] | %.1f |\n", preset, pass,
                timing_median(d.ms[1], d.runs), timing_median(d.ms[0], d.runs), ratio.median, ratio.range.low,
                ratio.range.high, b.reads);
    }
    bound_free(&b);
    return code;
}

static int bound_preset(growth *g, const subject *sub, const char *preset)
{
    settings   *s = &g->s;
    hbil_config config;
    lit         l;
    int         code;

    if (!config_make(s, preset, 0, subject_judged(sub), &config, s->error, sizeof s->error)) return TRADE_REFUSED;
    if (!lit_open(&l, g->device, s, &config, sub, s->error, sizeof s->error)) return TRADE_MISFIT;
    code = bound_pass(g, &l, preset, "sweep");
    if (code == TRADE_DONE) code = bound_pass(g, &l, preset, "march");
    lit_close(&l);
    return code;
}

/* Names of --preset, or of all presets but reference. Their number. */
static int list_presets(growth *g, char names[PRESETS_MAX][32])
{
    const char *p = g->presets, *name;
    int         count = 0, length, i;

    for (i = 0; !p && count < PRESETS_MAX && (name = hbil_preset_name(i)) != NULL; i++)
        if (strcmp(name, "reference") != 0) snprintf(names[count++], sizeof *names, "%s", name);
    for (; p && *p && count < PRESETS_MAX; p += length + (p[length] == ','), count++) {
        length = (int)strcspn(p, ",");
        snprintf(names[count], sizeof *names, "%.*s", length < 31 ? length : 31, p);
    }
    return count;
}

static int bound_subject(growth *g, const subject_name *name)
{
    char    presets[PRESETS_MAX][32];
    subject sub;
    int     i, count = list_presets(g, presets), code = subject_load(&g->s, name, &sub);

    if (code != TRADE_DONE) return code;
    fprintf(g->out, "### %s, %dx%d: march against its memory accesses alone\n\n", sub.name,
            subject_judged(&sub)->width, subject_judged(&sub)->height);
    fputs("| preset | pass | ms | accesses alone, ms | ratio | reads a pixel |\n|---|---|---:|---:|---:|---:|\n",
          g->out);
    for (i = 0; i < count && code == TRADE_DONE; i++) {
        progress_show(&g->s, (double)i / count, presets[i]);
        code = bound_preset(g, &sub, presets[i]);
    }
    progress_end(&g->s);
    fputc('\n', g->out);
    subject_free(&sub);
    return code;
}

/* ---- work -------------------------------------------------------------------------------------------------------- */

static int wants(const growth *g, const char *what) { return !g->part || strcmp(g->part, what) == 0; }

static int run(growth *g)
{
    static subject_list list;
    const runner_info  *about;
    int                 i, code = subject_find(&g->s, &list);

    if (code != TRADE_DONE) return code;
    g->device = runner_open(g->s.backend, 0, g->s.error, sizeof g->s.error);
    if (!g->device) return TRADE_BACKEND;
    about = runner_about(g->device);
    fprintf(g->out, "%s, %s: %s\n\n", about->device, about->backend, about->timing);
    for (i = 0; i < list.count && code == TRADE_DONE; i++) {
        if (wants(g, "fit")) code = fit_subject(g, &list.items[i]);
        if (code == TRADE_DONE && wants(g, "bound")) code = bound_subject(g, &list.items[i]);
    }
    if (code == TRADE_DONE && g->off) {
        frame_error(g->s.error, sizeof g->s.error, "a prediction is off by more than 10 %%: see the tables");
        code = TRADE_REFUSED;
    }
    return code;
}

int growth_main(int argc, char **argv)
{
    growth g;
    char  *text = NULL;
    size_t size = 0;
    int    code;

    memset(&g, 0, sizeof g);
    settings_default(&g.s);
    g.s.rays = 0; /* nothing is held against a truth */
    g.out = open_memstream(&text, &size);
    if (!g.out) return fputs("hbil-tradeoff: out of memory\n", stderr), TRADE_BACKEND;
    if (command_line(&g.s, argc, argv, growth_help, take, &g, &code)) {
        code = run(&g);
        if (code != TRADE_DONE) command_fail(&g.s, code);
    }
    fclose(g.out);
    if (!g.path) fputs(text, stdout);
    else if ((code == TRADE_DONE || g.off) && !text_write(g.path, text, g.s.error, sizeof g.s.error))
        code = command_fail(&g.s, TRADE_FILES);
    free(text);
    runner_close(g.device);
    settings_free(&g.s);
    return code;
}
