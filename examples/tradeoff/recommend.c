/* recommend.c - see recommend.h. */
#include "recommend.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

double recommend_predict(const points *p, const point *best, const point *anchor, double anchor_error)
{
    double logs = 0.0;
    int    i;

    if (!anchor) return best->error;
    for (i = 0; i < p->frame_count; i++) logs += log(best->errors[i] / anchor->errors[i]);
    return anchor_error * exp(logs / p->frame_count);
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
