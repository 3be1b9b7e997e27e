/* front.c - see front.h. */
#include "front.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../frame/image.h"

static int same(const char *a, const char *b) { return strcmp(a, b) == 0; }

int row_is_external(const csv_row *row)
{
    return strncmp(row->text[CSV_config], CSV_EXTERNAL, strlen(CSV_EXTERNAL)) == 0;
}

const char *row_name(const csv_row *row)
{
    return row_is_external(row) ? row->text[CSV_config] + strlen(CSV_EXTERNAL) : row->text[CSV_preset];
}

static int number_order(double a, double b) { return (a > b) - (a < b); } /* NaN equals all: the column is absent */

/* Frames are told apart by name and size. */
static int frame_order(const csv_row *a, const csv_row *b)
{
    const int name = strcmp(a->text[CSV_frame], b->text[CSV_frame]);
    const int width = number_order(a->number[CSV_width], b->number[CSV_width]);

    return name ? name : width ? width : number_order(a->number[CSV_height], b->number[CSV_height]);
}

static int by_frame(const void *a, const void *b)
{
    return frame_order(*(const csv_row *const *)a, *(const csv_row *const *)b);
}

static int by_config(const void *a, const void *b)
{
    const csv_row *x = *(const csv_row *const *)a, *y = *(const csv_row *const *)b;
    const int      hash = strcmp(x->text[CSV_config_hash], y->text[CSV_config_hash]);
    const int      frame = hash ? 0 : frame_order(x, y);

    return hash ? hash : frame ? frame : (x->line > y->line) - (x->line < y->line);
}

static int by_time(const void *a, const void *b)
{
    const point *p = a, *q = b;

    if (p->ms != q->ms) return p->ms < q->ms ? -1 : 1;
    if (p->error != q->error) return p->error < q->error ? -1 : 1;
    return strcmp(p->row->text[CSV_config_hash], q->row->text[CSV_config_hash]);
}

static int of_device(const csv_row *row, const selection *s)
{
    return (!s->backend || same(row->text[CSV_backend], s->backend))
        && (!s->device || same(row->text[CSV_device], s->device));
}

static int selected(const csv_row *row, const selection *s)
{
    return of_device(row, s) && same(row->text[CSV_output], s->output) && isfinite(row->number[s->error])
        && !(s->ours && row_is_external(row)) && !(s->except && same(row->text[CSV_frame], s->except))
        && !(s->only && !same(row->text[CSV_frame], s->only));
}

/* What could have been asked for. */
static int nothing_selected(const csv *table, const selection *s, char *error, size_t error_size)
{
    char   there[256] = "";
    size_t used;
    int    i, k;

    for (k = 0; k < CSV_NUMBER_COUNT; k++) {
        if (strncmp(csv_number_name(k), "rmse_", 5) != 0) continue;
        for (i = 0; i < table->count; i++) {
            const csv_row *row = &table->rows[i];

            if (!of_device(row, s) || !same(row->text[CSV_output], s->output) || !isfinite(row->number[k])) continue;
            used = strlen(there);
            snprintf(there + used, sizeof there - used, " %s", csv_number_name(k));
            break;
        }
    }
    return frame_error(error, error_size, "no %s of %s is measured%s%s%s%s. Errors of %s there:%s",
                       csv_number_name(s->error), s->output, s->backend ? " on " : "", s->backend ? s->backend : "",
                       s->only ? " on frame " : "", s->only ? s->only : "", s->output,
                               there[0] ? there : " none; choose another --output or --backend");
}

/* Selected rows, all of one device: how many, or -1. */
static int collect(const csv *table, const selection *s, const csv_row **rows, char *error, size_t error_size)
{
    int i, count = 0;

    for (i = 0; i < table->count; i++) {
        const csv_row *row = &table->rows[i];

        if (!selected(row, s)) continue;
        if (count > 0 && (!same(row->text[CSV_backend], rows[0]->text[CSV_backend])
                          || !same(row->text[CSV_device], rows[0]->text[CSV_device]))) {
            frame_error(error, error_size,
                        "lines %d and %d are of %s on %s and of %s on %s: their times do not compare. "
                        "Choose with --backend or --device", rows[0]->line, row->line, rows[0]->text[CSV_backend],
                        rows[0]->text[CSV_device], row->text[CSV_backend], row->text[CSV_device]);
            return -1;
        }
        rows[count++] = row;
    }
    if (count == 0) nothing_selected(table, s, error, error_size);
    return count > 0 ? count : -1;
}

/* Sorted rows without those that come before another of the same order. How many stay. */
static int keep_last(const csv_row **rows, int count, int (*order)(const csv_row *, const csv_row *))
{
    int i, kept = 0;

    for (i = 0; i < count; i++)
        if (i + 1 == count || order(rows[i], rows[i + 1]) != 0) rows[kept++] = rows[i];
    return kept;
}

static int config_order(const csv_row *a, const csv_row *b)
{
    const int hash = strcmp(a->text[CSV_config_hash], b->text[CSV_config_hash]);

    return hash ? hash : frame_order(a, b);
}

/* Of a column over the rows that have it; NaN: none has. */
static double mean_of(const csv_row *const *rows, int count, int column)
{
    const int square = csv_number_trait(column) == CSV_SQUARE;
    double    sum = 0.0;
    int       i, known = 0;

    for (i = 0; i < count; i++) {
        const double v = rows[i]->number[column];

        if (!isfinite(v)) continue;
        sum += square ? v * v : v;
        known++;
    }
    return known == 0 ? (double)NAN : square ? sqrt(sum / known) : sum / known;
}

/* From the rows of a config, one a frame. */
static void fill(point *p, const csv_row *const *rows, int count, int error_column)
{
    double logs = 0.0, squares = 0.0;
    int    i, k;

    memset(p, 0, sizeof *p);
    p->row = rows[0];
    p->rows = rows;
    for (i = 0; i < count; i++) {
        const double ms = rows[i]->number[CSV_ms_median], e = rows[i]->number[error_column];

        if (rows[i]->text[CSV_preset][0]) p->row = rows[i];
        p->ms_low = i && p->ms_low < ms ? p->ms_low : ms;
        p->ms_high = i && p->ms_high > ms ? p->ms_high : ms;
        p->low = i && p->low < e ? p->low : e;
        p->high = i && p->high > e ? p->high : e;
        logs += log(ms);
        squares += e * e;
    }
    for (k = 0; k < CSV_NUMBER_COUNT; k++) p->mean[k] = mean_of(rows, count, k);
    p->ms = exp(logs / count);
    p->error = sqrt(squares / count);
}

static void mark_front(points *p)
{
    double least = (double)INFINITY;
    int    i;

    for (i = 0; i < p->count; i++) {
        p->list[i].on_front = p->list[i].error < least;
        if (p->list[i].on_front) least = p->list[i].error;
    }
}

int points_make(points *out, const csv *table, const selection *s, char *error, size_t error_size)
{
    const csv_row **rows = malloc((size_t)table->count * sizeof *rows);
    int             count, i, end;

    memset(out, 0, sizeof *out);
    out->rows = rows;
    if (!rows) return frame_error(error, error_size, "out of memory");
    count = collect(table, s, rows, error, error_size);
    if (count > 0 && (out->frames = malloc((size_t)count * sizeof *out->frames)) != NULL) {
        memcpy(out->frames, rows, (size_t)count * sizeof *rows);
        qsort(out->frames, (size_t)count, sizeof *out->frames, by_frame);
        out->frame_count = keep_last(out->frames, count, frame_order);
        qsort(rows, (size_t)count, sizeof *rows, by_config);
        count = keep_last(rows, count, config_order);
        out->list = malloc((size_t)count * sizeof *out->list);
    }
    for (i = 0; out->list && i < count; i = end) {
        for (end = i + 1; end < count && same(rows[i]->text[CSV_config_hash], rows[end]->text[CSV_config_hash]); end++)
            continue;
        if (end - i == out->frame_count) fill(&out->list[out->count++], rows + i, end - i, s->error);
        else out->left_out++;
    }
    if (out->count > 0) {
        qsort(out->list, (size_t)out->count, sizeof *out->list, by_time);
        mark_front(out);
        return 1;
    }
    if (out->left_out > 0)
        frame_error(error, error_size, "no config is measured on all %d frames. Resume the sweep", out->frame_count);
    else if (count > 0)
        frame_error(error, error_size, "out of memory");
    points_free(out);
    return 0;
}

void points_free(points *p)
{
    free(p->list);
    free((void *)p->frames);
    free((void *)p->rows);
    memset(p, 0, sizeof *p);
}

const point *points_find(const points *p, const char *name)
{
    int i;

    for (i = 0; i < p->count; i++) {
        const csv_row *row = p->list[i].row;

        if (same(row->text[CSV_config_hash], name) || same(row->text[CSV_preset], name)
            || same(row->text[CSV_config], name))
            return &p->list[i];
    }
    return NULL;
}

int points_error(const csv *table, const selection *s)
{
    const int preferred[] = {CSV_rmse_hf, CSV_rmse_model, CSV_rmse_sampling};
    selection one = *s;
    points    p;
    char      unused[64];
    int       k;

    for (k = 0; k < (s->error < 0 ? 3 : 1); k++) {
        if (s->error < 0) one.error = preferred[k];
        if (!points_make(&p, table, &one, unused, sizeof unused)) continue;
        points_free(&p);
        return one.error;
    }
    return -1;
}

void points_keep(points *p, const points *also)
{
    int i, kept = 0;

    for (i = 0; i < p->count; i++)
        if (points_find(also, p->list[i].row->text[CSV_config_hash])) p->list[kept++] = p->list[i];
    p->count = kept;
    mark_front(p);
}

int points_know(const points *p, int column)
{
    int i;

    for (i = 0; i < p->count; i++)
        if (isfinite(p->list[i].mean[column])) return 1;
    return 0;
}

static double ratio(double mine, double other) { return mine > other ? mine / other : 1.0; }

double front_dominated(const points *sets, int set_count, const char *config_hash, const point **by)
{
    const point *mine = points_find(&sets[0], config_hash);
    double       most = 1.0;
    int          i, k;

    if (by) *by = NULL;
    for (i = 0; mine && i < sets[0].count && sets[0].list[i].ms <= mine->ms; i++) {
        const point *other = &sets[0].list[i];
        double       gain;

        gain = ratio(mine->ms, other->ms);
        for (k = 0; k < set_count; k++) {
            const point *o = points_find(&sets[k], other->row->text[CSV_config_hash]);
            const point *m = points_find(&sets[k], config_hash);

            if (!o || !m || o->error > m->error) break;
            gain = fmax(gain, ratio(m->error, o->error));
        }
        if (k < set_count || gain <= most) continue;
        most = gain;
        if (by) *by = other;
    }
    return most - 1.0;
}
