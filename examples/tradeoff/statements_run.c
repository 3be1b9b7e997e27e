/* statements_run.c - hbil-tradeoff statements: what the articles say, measured. */
#include "commands.h"
#include "statements.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../tests/numeric/brute_force.h"
#include "fresnel.h"

#define DIELECTRIC 0.04f  /* F0 of glass and most plastics */
#define DROPPED    0.0003 /* Mayaux 2018 sec. 2.3.3: what Schlick's term is of the irradiance, at most */
#define COSINES    101    /* of n.V, between which the dropped share is interpolated */

/* A variant on all frames. */
typedef struct outcome {
    errors out[SUBJECTS_MAX][OUTS];
    price  cost;
    double turn[2][TIMING_RUNS_MAX]; /* of the base and of the variant, of all frames */
    int    turns;
} outcome;

typedef struct trial { outcome variants[STATEMENT_VARIANTS]; double dropped[SUBJECTS_MAX]; } trial;

typedef struct command {
    settings     s;
    const char  *only, *path;
    runner      *device;
    subject_list list;
    trial       *trials;         /* one a statement */
    lit          side[2];        /* the base, and the other */
    duel         d;
    int          done, of;       /* variants and frames */
} command;

void statements_help(void)
{
    int i;

    fputs(
        "  statements [--only A,B] [-o FILE] frames\n"
        "          what the source articles say, checked: a Markdown table of configs for each statement, with error,\n"
        "          time against the first of them in turns, fetches, and what the figures say: holds, does not hold,\n"
        "          or within noise. --repeat, default 9, counts turns of three runs; --seconds is 2 by default.\n"
        "          Four frames of 640x360 take about ten minutes on a GPU and half an hour on a CPU; what is not in the\n"
        "          cache comes on top\n"
        "  --only A,B        ",
        stdout);
    for (i = 0; i < statement_count; i++) printf("%s%s", i ? ", " : "", statements[i].name);
    fputs("\n  -o FILE           instead of the standard output\n", stdout);
}

/* Is the name in the list A,B? */
static int listed(const char *list, const char *name, size_t length)
{
    const char *p = list;

    for (; *p; p += strcspn(p, ","), p += *p == ',')
        if (strcspn(p, ",") == length && strncmp(p, name, length) == 0) return 1;
    return 0;
}

static int chosen(const command *c, int i)
{
    return !c->only || listed(c->only, statements[i].name, strlen(statements[i].name));
}

static int take(void *user, settings *s, const char *name, const char *value)
{
    command    *c = user;
    const char *p;
    int         i;

    if (strcmp(name, "-o") != 0 && strcmp(name, "--only") != 0)
        return *name ? -1 : frame_error(s->error, sizeof s->error, "%s: not expected here", value);
    if (!*value) return frame_error(s->error, sizeof s->error, "%s: without its value", name);
    if (strcmp(name, "-o") == 0) return c->path = value, 1;
    c->only = value;
    for (p = value; *p; p += strcspn(p, ","), p += *p == ',') {
        for (i = 0; i < statement_count && !listed(statements[i].name, p, strcspn(p, ",")); i++) continue;
        if (i == statement_count)
            return frame_error(s->error, sizeof s->error, "--only %s: no such statement; --help lists them", p);
    }
    return 1;
}

/* ---- measuring --------------------------------------------------------------------------------------------------- */

/* A variant on a frame; the base, variant 0, stays open in side 0. */
static int measure(command *c, const statement *st, int variant, const subject *sub, const truth *t, outcome *o,
                   int frame)
{
    const int   sampling = (st->figures & 1u << FIGURE_SAMPLING) != 0;
    settings   *s = &c->s;
    lit        *l = &c->side[variant > 0];
    image       converged[OUTS];
    hbil_config config;
    char        text[TEXT_MAX];
    int         k, code = TRADE_DONE;

    memset(converged, 0, sizeof converged);
    lit_close(l);
    statement_text(st, variant, text);
    if (!config_make(s, text, (st->outputs & 1u << OUT_FAR) != 0, subject_judged(sub), &config, s->error,
                     sizeof s->error))
        return TRADE_REFUSED;
    if (sampling) code = truth_converged(s, c->device, sub, &config, converged);
    if (code == TRADE_DONE && !lit_open(l, c->device, s, &config, sub, s->error, sizeof s->error)) code = TRADE_MISFIT;
    if (code == TRADE_DONE)
        code = measure_errors(s, l, t, &config, sampling ? converged : NULL,
                              (st->figures & 1u << FIGURE_NOISE) != 0, o->out[frame]);
    for (k = 0; k < OUTS; k++) image_free(&converged[k]);
    if (code == TRADE_DONE) code = measure_cost(s, &l->plan, &o->cost);
    if (code != TRADE_DONE || variant == 0) return code;
    code = duel_run(s, &c->side[0], l, &c->d);
    for (k = 0; code == TRADE_DONE && k < c->d.turns && o->turns < TIMING_RUNS_MAX; k++, o->turns++) {
        o->turn[0][o->turns] = c->d.turn[0][k];
        o->turn[1][o->turns] = c->d.turn[1][k];
    }
    return code;
}

/* What Schlick's term is of the irradiance of open surfaces that are turned as those of the frame. */
static double mean_dropped(const capture *cap)
{
    const bf_camera camera = bf_camera_from(cap->projection, cap->width, cap->height);
    double          table[COSINES + 1], sum = 0.0;
    int             i, count = 0;

    for (i = 0; i < COSINES; i++) table[i] = fresnel_dropped(i / (COSINES - 1.0));
    table[COSINES] = table[COSINES - 1];
    for (i = 0; i < cap->width * cap->height; i++) {
        const float *n = cap->normal.data + 3 * i;
        double       p[3] = {0.0, 0.0, -1.0}, cosine;

        if (!(cap->depth.data[i] < 1e9f)) continue;
        if (!cap->orthographic)
            bf_point(&camera, i % cap->width + 0.5, i / cap->width + 0.5, (double)cap->depth.data[i], p);
        cosine = -((double)n[0] * p[0] + (double)n[1] * p[1] + (double)n[2] * p[2]);
        cosine /= sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        cosine = (COSINES - 1.0) * fmin(fmax(cosine, 0.0), 1.0);
        sum += table[(int)cosine] + (cosine - floor(cosine)) * (table[(int)cosine + 1] - table[(int)cosine]);
        count++;
    }
    return sum / count;
}

/* All variants on a frame that has F0 if the statement wants it, under the light that is set. */
static int run_variants(command *c, int index, const subject *sub, int frame)
{
    const statement *st = &statements[index];
    trial           *tr = &c->trials[index];
    char             what[128];
    truth            t;
    int              v, count = statement_variants(st), code;

    code = truth_make(&c->s, sub, (st->outputs & 1u << OUT_FAR) != 0, &t);
    if (code != TRADE_DONE) return code;
    for (v = 0; code == TRADE_DONE && v < count; v++, c->done++) {
        snprintf(what, sizeof what, "%s (%d of %d), %s: %s", sub->name, frame + 1, c->list.count, st->name,
                 st->variants[v]);
        progress_show(&c->s, (double)c->done / c->of, what);
        code = measure(c, st, v, sub, &t, &tr->variants[v], frame);
    }
    if (st->fresnel) tr->dropped[frame] = mean_dropped(subject_judged(sub));
    truth_free(&t);
    return code;
}

/* F0 of dielectrics where the frame has none. */
static int run_with_f0(command *c, int index, const subject *sub, int frame)
{
    capture cap = *subject_judged(sub);
    subject one = {"", &cap, 1};
    int     i, code;

    if (cap.f0.data) return run_variants(c, index, sub, frame);
    memcpy(one.name, sub->name, sizeof one.name);
    if (!image_make(&cap.f0, cap.width, cap.height, 1))
        return frame_error(c->s.error, sizeof c->s.error, "out of memory for F0"), TRADE_BACKEND;
    for (i = 0; i < cap.width * cap.height; i++) cap.f0.data[i] = DIELECTRIC;
    code = run_variants(c, index, &one, frame);
    image_free(&cap.f0);
    return code;
}

/* Under the statement's own light. */
static int run_statement(command *c, int index, const subject *sub, int frame)
{
    const statement  *st = &statements[index];
    settings         *s = &c->s;
    const char       *env = s->env;
    const environment light = s->light;
    int               code = TRADE_DONE;

    if (st->env) {
        s->env = st->env;
        if (!environment_parse(&s->light, s->env, s->error, sizeof s->error)) code = TRADE_USAGE;
    }
    if (code == TRADE_DONE) code = st->fresnel ? run_with_f0(c, index, sub, frame) : run_variants(c, index, sub, frame);
    lit_close(&c->side[0]);
    lit_close(&c->side[1]);
    if (st->env) environment_free(&s->light);
    s->env = env;
    s->light = light;
    return code;
}

/* ---- the page ---------------------------------------------------------------------------------------------------- */

/* Of a variant, over frames. */
static void values_of(const command *c, const outcome *o, int figure, int out, double values[SUBJECTS_MAX])
{
    int f;

    for (f = 0; f < c->list.count; f++) values[f] = statement_value(&o->out[f][out], figure);
}

/* The middle, and of several the range with the word behind it. format: of one number. */
static void print_spread(FILE *page, const spread *s, const char *of, const char *format)
{
    char middle[32], low[32], high[32];

    snprintf(middle, sizeof middle, format, s->middle);
    snprintf(low, sizeof low, format, s->low);
    snprintf(high, sizeof high, format, s->high);
    fputs(s->count ? middle : "-", page);
    if (s->count > 1) fprintf(page, " (%s to %s%s)", low, high, of);
}

/* Is it a column of the table? */
static int shown(const statement *st, int out, int figure)
{
    return (st->outputs & 1u << out) != 0 && (st->figures & 1u << figure) != 0;
}

/* Heads of the columns, or the line below them. */
static void print_head(FILE *page, const statement *st, int line)
{
    int k, g;

    fputs(line ? "|---|" : "| config |", page);
    for (k = 0; k < OUTS; k++)
        for (g = 0; g < FIGURE_ERRORS; g++) {
            if (!shown(st, k, g)) continue;
            if (line) fputs("---:|", page);
            else fprintf(page, " %s %s |", out_names[k], figure_names[g]);
        }
    fputs(line ? "---|---:|\n" : " time | fetches |\n", page);
}

static void print_variant(FILE *page, const statement *st, int variant, const char *before, const char *behind)
{
    const char *text = st->variants[variant];

    if (*text) fprintf(page, "%s`%s`%s", before, text, behind);
    else fprintf(page, "%snothing else%s", before, behind);
}

static void print_row(const command *c, FILE *page, const statement *st, int variant, const outcome *o)
{
    double values[SUBJECTS_MAX];
    char   words[96] = "base";
    int    k, g;

    print_variant(page, st, variant, "| ", " |");
    for (k = 0; k < OUTS; k++)
        for (g = 0; g < FIGURE_ERRORS; g++) {
            spread s;

            if (!shown(st, k, g)) continue;
            values_of(c, o, g, k, values);
            s = spread_of(g, values, c->list.count);
            fputc(' ', page);
            print_spread(page, &s, "", g == FIGURE_BIAS ? "%+.4f" : "%.4f");
            fputs(" |", page);
        }
    if (variant > 0) {
        const timing_ratio ratio = timing_compare(o->turn[0], o->turn[1], o->turns);

        duel_words(&ratio, words, sizeof words);
    }
    fprintf(page, " %s | %.1f |\n", words, o->cost.fetches);
}

static void print_claim(const command *c, FILE *page, const trial *tr, const claim *one)
{
    const outcome *less = &tr->variants[one->less], *more = &tr->variants[one->more];
    double         a[SUBJECTS_MAX], b[SUBJECTS_MAX];
    spread         s;

    if (one->figure == FIGURE_TIME) {
        const timing_ratio ratio = timing_compare(less->turn[0], less->turn[1], less->turns);

        s.middle = ratio.median;
        s.low = ratio.range.low;
        s.high = ratio.range.high;
        s.count = less->turns;
    } else {
        values_of(c, less, one->figure, one->out, a);
        values_of(c, more, one->figure, one->out, b);
        s = spread_change(one->figure, a, b, c->list.count);
    }
    fprintf(page, "- **%s**: %s (%s): ", verdict_words[verdict_of(one->figure, &s, one->factor)], one->words,
            one->source);
    print_spread(page, &s, one->figure == FIGURE_TIME ? " at 99 %" : " over frames",
                 one->figure == FIGURE_BIAS ? "%+.4f" : "%.3f");
    fprintf(page, " against %.3g\n", one->factor);
}

static void print_contest(const command *c, FILE *page, const statement *st, const trial *tr, const contest *one)
{
    double values[SUBJECTS_MAX], least = (double)INFINITY;
    int    v, best = one->first;

    for (v = one->first; v <= one->last; v++) {
        spread s;

        values_of(c, &tr->variants[v], one->figure, one->out, values);
        s = spread_of(one->figure, values, c->list.count);
        if (!(s.middle < least)) continue;
        least = s.middle;
        best = v;
    }
    if (!isfinite(least)) return;
    fprintf(page, "- least %s error of %s%s: ", figure_names[one->figure], out_names[one->out], one->words);
    print_variant(page, st, best, "", "");
    fprintf(page, ", %.4f\n", least);
}

/* Schlick's term by itself. */
static void print_dropped(const command *c, FILE *page, const double *dropped)
{
    static const double cosines[] = {1.0, 0.95, 0.9, 0.8, 0.7, 0.5, 0.3, 0.1, 0.0};
    const double        most = fresnel_dropped(0.0);
    const spread        worst = {most, most, most, 1};
    double              percent[SUBJECTS_MAX];
    spread              s;
    size_t              i;
    int                 f;

    fputs("\nSchlick's (1 - cos)^5, which 1 - F0 leaves out, as a share of an open surface's irradiance, integrated:\n\n"
          "| n.V | % |\n|---:|---:|\n", page);
    for (i = 0; i < sizeof cosines / sizeof *cosines; i++)
        fprintf(page, "| %g | %.3f |\n", cosines[i], 100.0 * fresnel_dropped(cosines[i]));
    for (f = 0; f < c->list.count; f++) percent[f] = 100.0 * dropped[f];
    s = spread_of(FIGURE_BIAS, percent, c->list.count);
    fprintf(page, "\n- **%s**: it is at most %g %% (Mayaux 2018 sec. 2.3.3): %.2f %% at n.V = 0, and that little only "
            "from n.V = %.2f on; mean\n  of the frames' surfaces, in %%: ",
            verdict_words[verdict_of(FIGURE_FIELD, &worst, DROPPED)], 100.0 * DROPPED, 100.0 * most,
            fresnel_bound(DROPPED));
    print_spread(page, &s, "", "%.2f");
    fputc('\n', page);
}

static void print_statement(const command *c, FILE *page, int index)
{
    const statement *st = &statements[index];
    const trial     *tr = &c->trials[index];
    const int        count = statement_variants(st);
    int              i;

    fprintf(page, "\n## %s\n\n%s%s", st->name, st->words,
            st->fresnel ? " Frames without F0 have .04 everywhere." : "");
    if (*st->common) fprintf(page, " All with `%s`.", st->common);
    fputs("\n\n", page);
    print_head(page, st, 0);
    print_head(page, st, 1);
    for (i = 0; i < count; i++) print_row(c, page, st, i, &tr->variants[i]);
    fputc('\n', page);
    for (i = 0; i < STATEMENT_CLAIMS && st->claims[i].words; i++) print_claim(c, page, tr, &st->claims[i]);
    for (i = 0; i < STATEMENT_CONTESTS && st->contests[i].words; i++) print_contest(c, page, st, tr, &st->contests[i]);
    if (st->fresnel) print_dropped(c, page, tr->dropped);
}

static int print_page(command *c)
{
    settings         *s = &c->s;
    const runner_info *about = runner_about(c->device);
    char             *text = NULL;
    size_t            size;
    FILE             *page = open_memstream(&text, &size);
    int               i, ok = page != NULL;

    if (ok) {
        fprintf(page, "# What the articles say, measured\n\n%s: %s, %s. Frames:", about->backend, about->device,
                about->driver);
        for (i = 0; i < c->list.count; i++) fprintf(page, "%s %s", i ? "," : "", c->list.items[i].name);
        fputs(".\n\nErrors: root of the mean square over frames, and range. Time: against the first config, in turns,\n"
              "99 % interval. Noise: deviation of a pixel over six frames. A verdict holds the figure of the one config\n"
              "over that of the other, of biases the one less the other, against what is claimed.\n", page);
        for (i = 0; i < statement_count; i++)
            if (chosen(c, i)) print_statement(c, page, i);
        ok = fclose(page) == 0;
    }
    if (!ok) frame_error(s->error, sizeof s->error, "out of memory for the page");
    else if (c->path) ok = text_write(c->path, text, s->error, sizeof s->error);
    if (text && (!c->path || !ok)) fputs(text, stdout); /* rather here than lost */
    free(text);
    return ok ? TRADE_DONE : TRADE_FILES;
}

/* ---- ready ------------------------------------------------------------------------------------------------------- */

static int run_subject(command *c, int frame)
{
    subject sub;
    int     i, code = subject_load(&c->s, &c->list.items[frame], &sub);

    if (code != TRADE_DONE) return code;
    for (i = 0; code == TRADE_DONE && i < statement_count; i++)
        if (chosen(c, i)) code = run_statement(c, i, &sub, frame);
    subject_free(&sub);
    return code;
}

static int run(command *c)
{
    int i, code = subject_find(&c->s, &c->list);

    if (code != TRADE_DONE) return code;
    c->device = runner_open(c->s.backend, 0, c->s.error, sizeof c->s.error);
    c->trials = calloc((size_t)statement_count, sizeof *c->trials);
    if (!c->trials) frame_error(c->s.error, sizeof c->s.error, "out of memory");
    if (!c->device || !c->trials) return TRADE_BACKEND;
    for (i = 0; i < statement_count; i++)
        if (chosen(c, i)) c->of += c->list.count * statement_variants(&statements[i]);
    for (i = 0; code == TRADE_DONE && i < c->list.count; i++) code = run_subject(c, i);
    progress_end(&c->s);
    return code == TRADE_DONE ? print_page(c) : code;
}

int statements_main(int argc, char **argv)
{
    static command c;
    int            code;

    settings_default(&c.s);
    c.s.seconds = 2.0;
    if (command_line(&c.s, argc, argv, statements_help, take, &c, &code)) {
        code = run(&c);
        if (code != TRADE_DONE) command_fail(&c.s, code);
    }
    runner_close(c.device);
    free(c.trials);
    settings_free(&c.s);
    return code;
}
