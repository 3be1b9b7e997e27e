/* analysis.c - the command line of report, recommend and compare. */
#include "analysis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../frame/image.h"
#include "compare.h"
#include "recommend.h"
#include "report.h"

enum { DONE = 0, MISFIT = 1, USAGE = 2, FILES = 3 };

#define TOLERANCE 0.25 /* of a prediction */

typedef struct arguments {
    const char *csv, *folder, *holdout, *anchor, *like, *runs[2]; /* like: --as-fast-as; runs: of compare */
    selection   selection;
    wish        wish;
    int         pictures;
} arguments;

int analysis_knows(const char *word)
{
    return strcmp(word, "report") == 0 || strcmp(word, "recommend") == 0 || strcmp(word, "compare") == 0;
}

static void print_help(FILE *out)
{
    fputs("usage: hbil-tradeoff report --csv FILE -o DIR [options]\n"
          "       hbil-tradeoff recommend --csv FILE (--budget-ms MS | --as-fast-as P | --max-rmse E) [options]\n"
          "       hbil-tradeoff compare FIRST.csv SECOND.csv [options]\n"
          "Says what a sweep has measured: which configs are worth their time.\n\n"
          "report: DIR/report.md with tables, and pictures of the Pareto front with the presets, of the error by\n"
          "distance from the image's centre, of each option alone, and of slices against steps, as SVG and PNG\n"
          "through gnuplot\n"
          "  -o DIR          made if need be\n"
          "  --no-plots      tables only\n\n"
          "recommend: the best config that was measured, its neighbours on the front, and the shadergen command\n"
          "  --budget-ms MS  the least error within this time\n"
          "  --as-fast-as P  within the time of this preset or config hash\n"
          "  --max-rmse E    the fastest within this error\n"
          "  --holdout F     choose by all frames but F, predict the error on F and compare with what was measured\n"
          "                  there. all: each frame in turn\n"
          "  --anchor P,Q    with --holdout: what presets or config hashes P, Q measured on F is known, too.\n"
          "                  The one whose errors are most alike counts, never the choice itself. Scenes differ more\n"
          "                  than configs: one run of a preset on a new frame tells how hard it is\n\n"
          "compare: is a second run of a sweep the same as the first? Errors, times with and without the factor that\n"
          "all of them share, Pareto fronts, order of the presets\n\n"
          "all:\n"
          "  --output O      ao, near or far; default ao, for report and compare all\n"
          "  --error E       rmse_hf (against the height field), rmse_model (against the scene), rmse_sampling\n"
          "                  (against the same estimator, converged) or rmse_estimator; default: the first that is\n"
          "                  measured\n"
          "  --backend B, --device D   if the CSV holds several\n\n"
          "exit: 0 done, 1 nothing fits, a prediction of --holdout is off by more than 25 %, or two runs differ:\n"
          "      other errors, a tenth of the times off by more than 10 % without that factor, or presets that are\n"
          "      farther apart than that in another order; 2 wrong usage, 3 cannot read or write\n",
          out);
}

static int fail(int code, const char *message)
{
    fprintf(stderr, "hbil-tradeoff: %s\n", message);
    return code;
}

/* ---- command line ------------------------------------------------------------------------------------------------ */

/* A number above 0. */
static int positive(const char *text, double *out)
{
    char *end;

    *out = strtod(text, &end);
    return *text && !*end && *out > 0.0 && isfinite(*out);
}

static int take(arguments *a, const char *name, const char *value)
{
    const char *const outputs[] = CSV_OUTPUT_NAMES;
    size_t            i;

    if (strcmp(name, "--csv") == 0) return a->csv = value, 1;
    if (strcmp(name, "-o") == 0) return a->folder = value, 1;
    if (strcmp(name, "--holdout") == 0) return a->holdout = value, 1;
    if (strcmp(name, "--anchor") == 0) return a->anchor = value, 1;
    if (strcmp(name, "--backend") == 0) return a->selection.backend = value, 1;
    if (strcmp(name, "--device") == 0) return a->selection.device = value, 1;
    if (strcmp(name, "--budget-ms") == 0) return positive(value, &a->wish.budget_ms);
    if (strcmp(name, "--as-fast-as") == 0) return a->like = value, 1;
    if (strcmp(name, "--max-rmse") == 0) return positive(value, &a->wish.max_rmse);
    if (strcmp(name, "--error") == 0) {
        a->selection.error = strncmp(value, "rmse_", 5) == 0 ? csv_number(value) : -1;
        return a->selection.error >= 0;
    }
    for (i = 0; strcmp(name, "--output") == 0 && i < 3; i++)
        if (strcmp(value, outputs[i]) == 0) return a->selection.output = value, 1;
    return 0;
}

static int parse(int argc, char **argv, arguments *a)
{
    const int compares = strcmp(argv[1], "compare") == 0;
    char      message[512];
    int       i;

    memset(a, 0, sizeof *a);
    a->selection.error = -1;
    a->pictures = 1;
    for (i = 2; i < argc; i++) {
        if (strcmp(argv[i], "--no-plots") == 0) {
            a->pictures = 0;
        } else if (compares && argv[i][0] != '-' && !a->runs[1]) {
            a->runs[a->runs[0] != NULL] = argv[i];
        } else if (i + 1 == argc || !take(a, argv[i], argv[i + 1])) {
            snprintf(message, sizeof message, "%.200s %.200s: not understood. See hbil-tradeoff %s --help", argv[i],
                     i + 1 < argc ? argv[i + 1] : "(no value)", argv[1]);
            return fail(USAGE, message);
        } else {
            i++;
        }
    }
    if (compares && !a->runs[1])
        return fail(USAGE, "compare wants the CSV files of two runs, as in: compare monday.csv tuesday.csv");
    if (!compares && !a->csv) return fail(USAGE, "--csv FILE is missing");
    return DONE;
}

/* ---- recommend --------------------------------------------------------------------------------------------------- */

static void print_point(const char *what, const points *p, const selection *s, const point *q)
{
    const char *config = q->row->text[CSV_config], *preset = q->row->text[CSV_preset];
    char       *command = recommend_command(config);

    printf("%-9s %s%s%s%s\n", what, config[0] ? config : "the defaults", preset[0] ? " (" : "", preset,
           preset[0] ? ")" : "");
    printf("          %s of %s %.4f (%.4f to %.4f over %d frame%s), %.4g ms (%.4g to %.4g)\n",
           csv_number_name(s->error), s->output, q->error, q->low, q->high, p->frame_count,
           p->frame_count == 1 ? "" : "s", q->ms, q->ms_low, q->ms_high);
    if (command) printf("          %s\n", command);
    free(command);
}

static const point *choose(const points *p, const arguments *a)
{
    const point *like = a->like ? points_find(p, a->like) : NULL;
    wish         w = a->wish;

    if (a->like && !like) return NULL;
    if (like) w.budget_ms = like->ms;
    return recommend_choose(p, &w);
}

static int nothing_fits(const points *p, const arguments *a)
{
    const selection *s = &a->selection;
    const point     *best = &p->list[p->count - 1];
    char             message[512];

    if (a->like && !points_find(p, a->like)) {
        snprintf(message, sizeof message, "--as-fast-as %.200s: not measured on all frames. Sweep it", a->like);
        return fail(MISFIT, message);
    }
    while (!best->on_front) best--;
    snprintf(message, sizeof message,
             "nothing fits: the fastest of %d configs takes %.4g ms, the most accurate has a %s of %s of %.4f "
             "and takes %.4g ms. Allow more, or sweep other options", p->count, p->list[0].ms,
             csv_number_name(s->error), s->output, best->error, best->ms);
    return fail(MISFIT, message);
}

static int recommend(const csv *table, const arguments *a)
{
    const point *best, *neighbour;
    points       p;
    char         error[1024];
    int          code = DONE;

    if (!points_make(&p, table, &a->selection, error, sizeof error)) return fail(MISFIT, error);
    if (p.left_out > 0) {
        snprintf(error, sizeof error, "note: %d configs lack some of the %d frames and are left out. Resume the sweep",
                 p.left_out, p.frame_count);
        fail(0, error);
    }
    best = choose(&p, a);
    if (best) {
        print_point("best", &p, &a->selection, best);
        if ((neighbour = recommend_neighbour(&p, best, -1)) != NULL)
            print_point("faster", &p, &a->selection, neighbour);
        if ((neighbour = recommend_neighbour(&p, best, 1)) != NULL) print_point("better", &p, &a->selection, neighbour);
    } else {
        code = nothing_fits(&p, a);
    }
    points_free(&p);
    return code;
}

/* ---- held-out frames --------------------------------------------------------------------------------------------- */

/* Chosen and predicted by `others`, compared on `one`. 1: within the tolerance, 0: beyond, -1: not measured. */
static int compare(const points *others, const points *one, const point *best, const arguments *a)
{
    const char  *hash = best->row->text[CSV_config_hash], *frame = one->frames[0]->text[CSV_frame];
    const point *actual = points_find(one, hash), *there = NULL, *anchor = NULL;
    double       predicted, off;

    if (a->anchor) {
        anchor = recommend_anchor(others, a->anchor, best, a->selection.error);
        there = anchor ? points_find(one, anchor->row->text[CSV_config_hash]) : NULL;
        if (!there) {
            printf("%s: %s is not measured on it and on all others, or is the choice itself: no anchor\n", frame,
                   a->anchor);
            return points_find(others, a->anchor) == best ? -1 : 0;
        }
    }
    predicted = recommend_predict(others, best, anchor, there ? there->row : NULL, a->selection.error);
    printf("%s: %s\n  predicted %s of %s %.4f from %d other frame%s", frame,
           best->row->text[CSV_config][0] ? best->row->text[CSV_config] : "the defaults",
           csv_number_name(a->selection.error), a->selection.output, predicted, others->frame_count,
                   others->frame_count == 1 ? "" : "s");
    if (anchor)
        printf(" and from %s on this one (%.4f without)",
               anchor->row->text[CSV_preset][0] ? anchor->row->text[CSV_preset] : a->anchor, best->error);
    if (!actual) {
        puts("; not measured on it");
        return -1;
    }
    off = actual->error == predicted ? 0.0 : actual->error / predicted - 1.0; /* both may be 0 */
    printf("; measured %.4f, %+.1f %%: %s %.0f %%\n", actual->error, 100.0 * off,
           fabs(off) <= TOLERANCE ? "within" : "beyond", 100.0 * TOLERANCE);
    return fabs(off) <= TOLERANCE;
}

/* As compare; 0 also if there is nothing to compare. Where the frame was swept, the choice is among what was measured
 * on it; where it has the anchor's line only, among all. */
static int hold_out(const csv *table, const arguments *a, const char *frame)
{
    selection    s = a->selection;
    points       others, one;
    const point *best;
    char         error[1024];
    int          within = 0;

    s.except = frame;
    if (!points_make(&others, table, &s, error, sizeof error)) return fail(0, error);
    s.except = NULL;
    s.only = frame;
    if (points_make(&one, table, &s, error, sizeof error)) {
        if (one.count > 1) points_keep(&others, &one);
        best = others.count > 0 ? choose(&others, a) : NULL;
        if (best) within = compare(&others, &one, best, a);
        else if (others.count > 0) nothing_fits(&others, a);
        else fail(0, "no config is measured on this frame and on all others");
        points_free(&one);
    } else {
        fail(0, error);
    }
    points_free(&others);
    return within;
}

static int has_error(const csv_row *row, const selection *s)
{
    return strcmp(row->text[CSV_output], s->output) == 0 && isfinite(row->number[s->error]);
}

/* 1: no line before this one has its frame and the error. */
static int is_first(const csv *table, int row, const selection *s)
{
    int i;

    if (!has_error(&table->rows[row], s)) return 0;
    for (i = 0; i < row; i++)
        if (has_error(&table->rows[i], s)
            && strcmp(table->rows[i].text[CSV_frame], table->rows[row].text[CSV_frame]) == 0) return 0;
    return 1;
}

static int hold_out_all(const csv *table, const arguments *a)
{
    int i, one, found = 0, held = 0, within = 0;

    for (i = 0; i < table->count; i++) {
        const char *frame = table->rows[i].text[CSV_frame];

        if (!is_first(table, i, &a->selection)) continue;
        if (strcmp(a->holdout, "all") != 0 && strcmp(a->holdout, frame) != 0) continue;
        found = 1;
        one = hold_out(table, a, frame);
        held += one >= 0;
        within += one > 0;
    }
    if (!found) {
        fprintf(stderr, "hbil-tradeoff: --holdout %s: no such frame of %s. There are: all", a->holdout,
                a->selection.output);
        for (i = 0; i < table->count; i++)
            if (is_first(table, i, &a->selection)) fprintf(stderr, " %s", table->rows[i].text[CSV_frame]);
        fputc('\n', stderr);
        return USAGE;
    }
    if (held > 1) printf("%d of %d within %.0f %%\n", within, held, 100.0 * TOLERANCE);
    return within == held ? DONE : MISFIT;
}

/* ---- ready ------------------------------------------------------------------------------------------------------- */

static int report(const csv *table, const arguments *a)
{
    char error[1024];
    int  nothing;

    if (!report_write(a->folder, table, &a->selection, a->pictures, &nothing, error, sizeof error))
        return fail(nothing ? MISFIT : FILES, error);
    printf("%s/report.md\n", a->folder);
    return DONE;
}

static int compare_runs(const arguments *a)
{
    csv  tables[2];
    char error[1024];
    int  i, is_same;

    if (!csv_read(&tables[0], a->runs[0], error, sizeof error)) return fail(FILES, error);
    if (!csv_read(&tables[1], a->runs[1], error, sizeof error)) {
        csv_free(&tables[0]);
        return fail(FILES, error);
    }
    for (i = 0; i < 2; i++)
        if (tables[i].note[0]) fail(0, tables[i].note);
    is_same = compare_print(stdout, tables, a->runs, &a->selection, error, sizeof error);
    if (is_same < 0) fail(0, error);
    csv_free(&tables[0]);
    csv_free(&tables[1]);
    return is_same > 0 ? DONE : MISFIT;
}

int analysis_main(int argc, char **argv)
{
    arguments a;
    csv       table;
    char      error[1024];
    int       code, i, reports;

    for (i = 1; i < argc; i++)
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return print_help(stdout), DONE;
    if (argc < 2 || !analysis_knows(argv[1])) return print_help(stderr), USAGE;
    code = parse(argc, argv, &a);
    if (code != DONE) return code;
    if (a.runs[0]) return compare_runs(&a);
    reports = strcmp(argv[1], "report") == 0;
    a.selection.ours = !reports; /* no shadergen command makes an external */
    if (reports && !a.folder) return fail(USAGE, "-o DIR is missing");
    if (!reports && !a.like && a.wish.budget_ms <= 0.0 && a.wish.max_rmse <= 0.0)
        return fail(USAGE, "--budget-ms, --as-fast-as or --max-rmse is missing");
    if (!csv_read(&table, a.csv, error, sizeof error)) return fail(FILES, error);
    if (table.note[0]) fail(0, table.note);
    if (!reports) {
        if (!a.selection.output) a.selection.output = "ao";
        if (a.selection.error < 0) a.selection.error = points_error(&table, &a.selection);
        if (a.selection.error < 0) a.selection.error = CSV_rmse_hf; /* says what there is instead */
    }
    code = reports ? report(&table, &a) : a.holdout ? hold_out_all(&table, &a) : recommend(&table, &a);
    csv_free(&table);
    return code;
}
