/* labels.c - see labels.h: each label in turn takes the cheapest of its places while the others stay, a few times. */
#include "labels.h"

#include <math.h>

#define PASSES     8
#define SAMPLES    16
#define DIRECTIONS 16
#define DISTANCES  6
#define STEP       9.0 /* pixels between two distances */
#define MARGIN     4.0 /* kept from points */

/* What is to be avoided, the worst first; a step further away costs 1. */
#define OUTSIDE 10000.0
#define LABEL   300.0
#define CROSSED 50.0 /* a line between a label and its point by another label */
#define POINT   20.0

/* Does a box of this size hold it? */
static int holds(spot middle, double width, double height, spot p)
{
    return 2.0 * fabs(p.x - middle.x) < width && 2.0 * fabs(p.y - middle.y) < height;
}

/* Does the line from the middle of one to its point meet the other's box? */
static int meets(const label *line, const label *box)
{
    int i;

    for (i = 0; i < SAMPLES; i++) {
        const double t = (double)i / SAMPLES;
        const spot   p = {line->of.x + t * (line->middle.x - line->of.x),
                          line->of.y + t * (line->middle.y - line->of.y)};

        if (holds(box->middle, box->width, box->height, p)) return 1;
    }
    return 0;
}

static double price(const label *list, int count, const label *l, const spot *points, int point_count, spot area)
{
    const spot middle = {0.5 * area.x, 0.5 * area.y};
    double     sum = holds(middle, area.x - l->width, area.y - l->height, l->middle) ? 0.0 : OUTSIDE;
    int        i;

    for (i = 0; i < count; i++) {
        const label *other = &list[i];

        if (other == l) continue;
        if (holds(l->middle, l->width + other->width + MARGIN, l->height + other->height, other->middle)) sum += LABEL;
        sum += CROSSED * (meets(l, other) + meets(other, l));
    }
    for (i = 0; i < point_count; i++)
        if (holds(l->middle, l->width + 2.0 * MARGIN, l->height + 2.0 * MARGIN, points[i])) sum += POINT;
    return sum;
}

/* Place number `place`: to the right of the point, then around it, then further away. */
static spot place_of(const label *l, int place)
{
    const double angle = 6.283185307179586 * (place % DIRECTIONS) / DIRECTIONS;
    const double away = MARGIN + STEP * (1 + place / DIRECTIONS);
    const spot   middle = {l->of.x + cos(angle) * (away + 0.5 * l->width),
                           l->of.y + sin(angle) * (away + 0.5 * l->height)};

    return middle;
}

/* 1: it has found a cheaper place. */
static int settle(label *list, int count, label *l, const spot *points, int point_count, spot area)
{
    const spot before = l->middle;
    spot       best = before;
    double     least = price(list, count, l, points, point_count, area) + 0.5; /* ties stay */
    int        place;

    for (place = 0; place < DIRECTIONS * DISTANCES; place++) {
        double cost;

        l->middle = place_of(l, place);
        cost = price(list, count, l, points, point_count, area) + place / DIRECTIONS;
        if (cost >= least) continue;
        least = cost;
        best = l->middle;
    }
    l->middle = best;
    return best.x != before.x || best.y != before.y;
}

void labels_place(label *list, int count, const spot *points, int point_count, double width, double height)
{
    const spot area = {width, height};
    int        pass, i, moved = 1;

    for (i = 0; i < count; i++) list[i].middle = place_of(&list[i], 0);
    for (pass = 0; moved && pass < PASSES; pass++)
        for (i = moved = 0; i < count; i++) moved |= settle(list, count, &list[i], points, point_count, area);
}
