/* compare.c - see compare.h. */
#include "compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../frame/image.h"

static int same(const char *a, const char *b) { return strcmp(a, b) == 0; }

/* ---- matching rows ----------------------------------------------------------------------------------------------- */

/* Device first, and configs of a device together. */
static int order(const csv_row *a, const csv_row *b)
{
    static const int texts[] = {CSV_backend, CSV_device, CSV_config_hash, CSV_frame, CSV_output};
    static const int numbers[] = {CSV_width, CSV_height};
    size_t           i;

    for (i = 0; i < sizeof texts / sizeof *texts; i++) {
        const int by = strcmp(a->text[texts[i]], b->text[texts[i]]);

        if (by) return by;
    }
    for (i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        const double x = a->number[numbers[i]], y = b->number[numbers[i]];

        if (x < y || x > y) return x < y ? -1 : 1;
    }
    return 0;
}

static int by_order(const void *a, const void *b)
{
    const csv_row *x = *(const csv_row *const *)a, *y = *(const csv_row *const *)b;
    const int      by = order(x, y);

    return by ? by : (x->line > y->line) - (x->line < y->line);
}

static int wanted(const csv_row *row, const selection *s)
{
    return (!s->backend || same(row->text[CSV_backend], s->backend))
        && (!s->device || same(row->text[CSV_device], s->device))
        && (!s->output || same(row->text[CSV_output], s->output));
}

/* Sorted, the last of its kind each. How many. */
static int sort_rows(const csv *table, const selection *s, const csv_row **rows)
{
    int i, count = 0, kept = 0;

    for (i = 0; i < table->count; i++)
        if (wanted(&table->rows[i], s)) rows[count++] = &table->rows[i];
    if (count) qsort(rows, (size_t)count, sizeof *rows, by_order);
    for (i = 0; i < count; i++)
        if (i + 1 == count || order(rows[i], rows[i + 1]) != 0) rows[kept++] = rows[i];
    return kept;
}

/* Is it what the same config gives again on the same device? Times are not, nor what tells of them. */
static int lasts(int column)
{
    const char *name = csv_number_name(column);

    return strncmp(name, "ms_", 3) != 0 && !same(name, "runs") && !same(name, "noise");
}

static void compare_numbers(comparison *c, const csv_row *a, const csv_row *b)
{
    double most = 0.0;
    int    k;

    for (k = 0; k < CSV_NUMBER_COUNT; k++) {
        const double x = a->number[k], y = b->number[k];
        double       off;

        if (!lasts(k) || (isnan(x) && isnan(y))) continue;
        off = isnan(x) || isnan(y) ? 1.0 : x < y || x > y ? fabs(x - y) / fmax(fabs(x), fabs(y)) : 0.0;
        most = fmax(most, off);
        if (off <= c->most) continue;
        c->most = off;
        c->column = k;
        c->worst = a;
    }
    c->differ += most > 0.0;
}

/* Sums of logarithms, for now. */
static void add_times(comparison *c, const csv_row *a, const csv_row *b)
{
    twin *t = c->count > 0 ? &c->twins[c->count - 1] : NULL;

    if (!t || !same(t->row->text[CSV_config_hash], a->text[CSV_config_hash])) {
        t = &c->twins[c->count++];
        memset(t, 0, sizeof *t);
        t->row = a;
    }
    t->ms[0] += log(a->number[CSV_ms_median]);
    t->ms[1] += log(b->number[CSV_ms_median]);
    t->rows++;
}

static int merge(comparison *c, const csv_row **rows[2], const int count[2], char *error, size_t error_size)
{
    const csv_row *first = NULL;
    int            i = 0, k = 0;

    while (i < count[0] && k < count[1]) {
        const int by = order(rows[0][i], rows[1][k]);

        if (by < 0) i++;
        else if (by > 0) k++;
        else {
            const csv_row *a = rows[0][i++];

            if (!first) first = a;
            if (!same(first->text[CSV_device], a->text[CSV_device])
                || !same(first->text[CSV_backend], a->text[CSV_backend]))
                return frame_error(error, error_size,
                                   "lines %d and %d are of %s on %s and of %s on %s: each is a run of its own. Choose "
                                   "with --backend or --device", first->line, a->line, first->text[CSV_backend],
                                   first->text[CSV_device], a->text[CSV_backend], a->text[CSV_device]);
            compare_numbers(c, a, rows[1][k]);
            add_times(c, a, rows[1][k++]);
            c->matched++;
        }
    }
    for (i = 0; i < c->count; i++)
        for (k = 0; k < 2; k++) c->twins[i].ms[k] = exp(c->twins[i].ms[k] / c->twins[i].rows);
    c->only[0] = count[0] - c->matched;
    c->only[1] = count[1] - c->matched;
    return c->matched > 0
           || frame_error(error, error_size, "no row of one is in the other: no config and frame on the same device. "
                          "Give two runs of one sweep");
}

int compare_make(comparison *out, const csv tables[2], const selection *s, char *error, size_t error_size)
{
    const csv_row **rows[2];
    int             count[2] = {0, 0}, k, ok = 1;

    memset(out, 0, sizeof *out);
    out->twins = malloc(((size_t)tables[0].count + 1) * sizeof *out->twins);
    for (k = 0; k < 2; k++) {
        rows[k] = malloc(((size_t)tables[k].count + 1) * sizeof *rows[k]);
        ok = ok && rows[k];
    }
    for (k = 0; ok && k < 2; k++) count[k] = sort_rows(&tables[k], s, rows[k]);
    ok = ok && out->twins ? merge(out, rows, count, error, error_size)
                          : frame_error(error, error_size, "out of memory");
    for (k = 0; k < 2; k++) free((void *)rows[k]);
    if (!ok) compare_free(out);
    return ok;
}

void compare_free(comparison *c)
{
    free(c->twins);
    memset(c, 0, sizeof *c);
}

/* ---- times ------------------------------------------------------------------------------------------------------- */

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* Linear between ranks; sorted values. */
static double quantile(const double *sorted, int count, double q)
{
    const double at = q * (count - 1);
    const int    i = (int)at;

    return i + 1 < count ? sorted[i] + (at - i) * (sorted[i + 1] - sorted[i]) : sorted[count - 1];
}

/* The larger of both over the smaller, less 1. */
static double apart(double a, double b) { return fmax(a, b) / fmin(a, b) - 1.0; }

int compare_times(const comparison *c, double common, deviation *out)
{
    double *values = malloc((size_t)c->count * sizeof *values);
    int     i;

    memset(out, 0, sizeof *out);
    if (!values) return 0;
    for (i = 0; i < c->count; i++) values[i] = c->twins[i].ms[1] / (common * c->twins[i].ms[0]);
    qsort(values, (size_t)c->count, sizeof *values, by_size);
    out->median = quantile(values, c->count, 0.5);
    for (i = 0; i < c->count; i++) {
        const twin *t = &c->twins[i];

        values[i] = apart(t->ms[1], common * t->ms[0]);
        out->within += (values[i] <= COMPARE_WITHIN ? 1.0 : 0.0) / c->count;
        if (out->worst && values[i] <= out->most) continue;
        out->most = values[i];
        out->worst = t->row;
    }
    qsort(values, (size_t)c->count, sizeof *values, by_size);
    out->p90 = quantile(values, c->count, 0.9);
    free(values);
    return 1;
}

double compare_tau(const comparison *c)
{
    double sum = 0.0;
    int    i, k;

    for (i = 0; i < c->count; i++)
        for (k = 0; k < i; k++) {
            const int a = by_size(&c->twins[i].ms[0], &c->twins[k].ms[0]);
            const int b = by_size(&c->twins[i].ms[1], &c->twins[k].ms[1]);

            sum += a == b ? 1 : a * b;
        }
    return c->count > 1 ? sum / (0.5 * c->count * (c->count - 1.0)) : 0.0;
}

/* ---- ranks ------------------------------------------------------------------------------------------------------- */

static const char *name_of(const csv_row *row)
{
    return row->text[CSV_preset][0] ? row->text[CSV_preset] : row->text[CSV_config][0] ? row->text[CSV_config]
                                                                                      : "the defaults";
}

/* Configs on the front of one run that are not on that of the other, and by how much they miss it. */
static void print_front(FILE *out, const points *mine, const points *other, const char *what)
{
    int i, found = 0;

    for (i = 0; i < mine->count; i++) {
        const char  *hash = mine->list[i].row->text[CSV_config_hash];
        const point *there = points_find(other, hash);

        if (!mine->list[i].on_front || there->on_front) continue;
        fprintf(out, "%s `%s` %.1f %%", found++ ? "," : what, name_of(mine->list[i].row),
                100.0 * front_dominated(other, 1, hash, NULL));
    }
}

static int on_both_fronts(const points *a, const points *b)
{
    int i, count = 0;

    for (i = 0; i < a->count; i++)
        count += a->list[i].on_front && points_find(b, a->list[i].row->text[CSV_config_hash])->on_front;
    return count;
}

static double measure_of(const point *p, int error) { return error ? p->error : p->ms; }

/* Presets that have changed places, by time or by error: how many pairs. Times that lie closer than COMPARE_WITHIN in
 * both have none. */
static int print_swaps(FILE *out, const points sets[2], int error)
{
    int i, k, presets = 0, swaps = 0;

    for (i = 0; i < sets[0].count; i++) {
        const point *p = &sets[0].list[i], *q = points_find(&sets[1], p->row->text[CSV_config_hash]);

        if (!p->row->text[CSV_preset][0]) continue;
        presets++;
        for (k = 0; k < i; k++) {
            const point *r = &sets[0].list[k], *t = points_find(&sets[1], r->row->text[CSV_config_hash]);
            const double a[2] = {measure_of(p, error), measure_of(r, error)};
            const double b[2] = {measure_of(q, error), measure_of(t, error)};

            if (!r->row->text[CSV_preset][0] || (a[0] - a[1]) * (b[0] - b[1]) >= 0.0) continue;
            if (!error && apart(a[0], a[1]) <= COMPARE_WITHIN && apart(b[0], b[1]) <= COMPARE_WITHIN) continue;
            if (!swaps++) fprintf(out, "; by %s in another order:", error ? "error" : "time");
            fprintf(out, "%s %s and %s", swaps > 1 ? "," : "", name_of(p->row), name_of(r->row));
        }
    }
    if (!swaps) fprintf(out, "; %d presets by %s in the same order", presets, error ? "error" : "time");
    return swaps;
}

/* Front and presets of an output, on the device of a row. How many pairs of presets have changed places. */
static int print_ranks(FILE *out, const csv tables[2], const csv_row *row, int error, const char *output)
{
    selection s = {output, error, row->text[CSV_backend], row->text[CSV_device], NULL, NULL, 0};
    points    sets[2];
    char      unused[64];
    int       k, swaps = 0;

    s.error = points_error(&tables[0], &s);
    if (s.error < 0) return 0;
    for (k = 0; k < 2; k++)
        if (!points_make(&sets[k], &tables[k], &s, unused, sizeof unused)) memset(&sets[k], 0, sizeof sets[k]);
    points_keep(&sets[0], &sets[1]);
    points_keep(&sets[1], &sets[0]);
    if (sets[0].count > 0) {
        fprintf(out, "%-8s %d configs on both fronts by %s", output, on_both_fronts(&sets[0], &sets[1]),
                csv_number_name(s.error));
        print_front(out, &sets[0], &sets[1], "; left, and off it by:");
        print_front(out, &sets[1], &sets[0], "; entered, and off the first by:");
        swaps = print_swaps(out, sets, 0) + print_swaps(out, sets, 1);
        fputc('\n', out);
    }
    for (k = 0; k < 2; k++) points_free(&sets[k]);
    return swaps;
}

/* ---- ready ------------------------------------------------------------------------------------------------------- */

static void print_errors(FILE *out, const comparison *c)
{
    if (c->differ == 0) fprintf(out, "errors   and costs of all of them are equal to the last digit\n");
    else
        fprintf(out, "errors   or costs of %d rows differ, most %s by %.2g %% (%s, %s of %s)\n", c->differ,
                csv_number_name(c->column), 100.0 * c->most, name_of(c->worst), c->worst->text[CSV_output],
                c->worst->text[CSV_frame]);
}

static void print_deviation(FILE *out, const deviation *d, const char *what)
{
    fprintf(out, "%s 90th percentile %.1f %%, largest %.1f %% (%s); %.1f %% of configs within %.0f %%\n", what,
            100.0 * d->p90, 100.0 * d->most, name_of(d->worst), 100.0 * d->within, 100.0 * COMPARE_WITHIN);
}

int compare_print(FILE *out, const csv tables[2], const char *const paths[2], const selection *s, char *error,
                  size_t error_size)
{
    static const char *const outputs[] = CSV_OUTPUT_NAMES;
    comparison c;
    deviation  raw, d;
    int        i, swaps = 0, is_same;

    if (!compare_make(&c, tables, s, error, error_size)) return -1;
    if (!compare_times(&c, 1.0, &raw) || !compare_times(&c, raw.median, &d)) {
        compare_free(&c);
        return frame_error(error, error_size, "out of memory"), -1;
    }
    fprintf(out, "rows     %d match, of %d configs (%s, %s); %d only in %s, %d only in %s\n", c.matched, c.count,
            c.twins->row->text[CSV_device], c.twins->row->text[CSV_backend], c.only[0], paths[0], c.only[1], paths[1]);
    print_errors(out, &c);
    fprintf(out, "times    of the second are %.3f of the first (median of configs); Kendall's tau %.3f\n", raw.median,
            compare_tau(&c));
    print_deviation(out, &raw, "         off by:");
    print_deviation(out, &d, "         that factor taken out:");
    for (i = 0; i < CSV_OUTPUTS; i++)
        if (!s->output || same(s->output, outputs[i]))
            swaps += print_ranks(out, tables, c.twins->row, s->error, outputs[i]);
    is_same = c.differ == 0 && d.p90 <= COMPARE_WITHIN && swaps == 0;
    fprintf(out, "%s\n", is_same ? "the same" : "not the same");
    compare_free(&c);
    return is_same;
}
