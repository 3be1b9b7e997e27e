/* recommend.c - see recommend.h. */
#include "recommend.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OTHER_ESTIMATOR 1e3 /* farther than any sampling error */

const point *recommend_choose(const points *p, const wish *w)
{
    const point *best = NULL;
    int          i;

    for (i = 0; i < p->count; i++) {
        const point *q = &p->list[i];

        if (!q->on_front || (w->budget_ms > 0.0 && q->ms > w->budget_ms)) continue;
        if (w->max_rmse > 0.0 && q->error <= w->max_rmse) return q;
        best = q;
    }
    return w->max_rmse > 0.0 ? NULL : best;
}

const point *recommend_neighbour(const points *p, const point *from, int direction)
{
    const point *q = from + direction;

    while (q >= p->list && q < p->list + p->count && !q->on_front) q += direction;
    return q >= p->list && q < p->list + p->count ? q : NULL;
}

/* The part of an error that samples buy down; all of it where nobody knows. */
static double sampling_part(const csv_row *row, int error)
{
    const double sampling = row->number[CSV_rmse_sampling];

    return isfinite(sampling) && error != CSV_rmse_estimator ? sampling : row->number[error];
}

/* The square of the rest: below 0 where the two undo each other. */
static double rest(const csv_row *row, int error)
{
    const double sampling = sampling_part(row, error);

    return row->number[error] * row->number[error] - sampling * sampling;
}

/* Configs that converge to the same image share the estimator's error to the last digit. */
static int same_estimator(const point *a, const point *b, int frames)
{
    int i;

    for (i = 0; i < frames; i++)
        if (a->rows[i]->number[CSV_rmse_estimator] != b->rows[i]->number[CSV_rmse_estimator]) return 0;
    return 1;
}

const point *recommend_anchor(const points *p, const char *names, const point *best, int error)
{
    const point *nearest = NULL;
    double       least = (double)INFINITY;
    char         name[256];
    size_t       length;
    int          i;

    for (; *names; names += length + (names[length] == ',')) {
        const point *anchor;
        double       away;

        length = strcspn(names, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, names);
        anchor = points_find(p, name);
        if (!anchor) return NULL;
        if (anchor == best) continue; /* would predict itself */
        away = same_estimator(best, anchor, p->frame_count) ? 0.0 : OTHER_ESTIMATOR;
        for (i = 0; i < p->frame_count; i++)
            away += fabs(log(sampling_part(best->rows[i], error) / sampling_part(anchor->rows[i], error)));
        if (!nearest || away < least) {
            nearest = anchor;
            least = away;
        }
    }
    return nearest;
}

double recommend_predict(const points *p, const point *best, const point *anchor, const csv_row *there, int error)
{
    double logs = 0.0, mine = 0.0, others = 0.0, sampling, share = 1.0;
    int    i;

    if (!anchor) return best->error;
    for (i = 0; i < p->frame_count; i++) {
        const csv_row *b = best->rows[i], *a = anchor->rows[i];

        logs += log(sampling_part(b, error) / sampling_part(a, error));
        mine += rest(b, error);
        others += rest(a, error);
    }
    sampling = sampling_part(there, error) * exp(logs / p->frame_count);
    if (!same_estimator(best, anchor, p->frame_count) && others > 0.0) share = fmax(mine, 0.0) / others;
    return sqrt(fmax(sampling * sampling + share * rest(there, error), 0.25 * sampling * sampling));
}

char *recommend_command(const char *config)
{
    const size_t size = strlen(config) + sizeof "shadergen --set ";
    char        *out = malloc(size), *c;

    if (!out) return NULL;
    if (!*config) {
        snprintf(out, size, "shadergen");
        return out;
    }
    snprintf(out, size, "shadergen --set %s", config);
    for (c = out + strlen("shadergen --set "); *c; c++)
        if (*c == ' ') *c = ',';
    return out;
}
