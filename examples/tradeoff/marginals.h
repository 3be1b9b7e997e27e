/* marginals.h - what each option alone does, and slices against steps, from configs that differ in nothing else. */
#ifndef HBIL_TRADEOFF_MARGINALS_H
#define HBIL_TRADEOFF_MARGINALS_H

#include "front.h"

#define MARGINAL_TEXT   64 /* bytes of an option's name or value */
#define MARGINAL_VALUES 32

/* An option that the sweep varies. Numbers ascend; choices are in the order of hbil.h. error and ms: factors against
 * the first value that can be compared with another (1); each step is the geometric mean over all pairs of configs that
 * differ in this option alone, of the value and of the nearest one before it that has such pairs. NaN and pairs 0:
 * none. */
typedef struct marginal {
    char   option[MARGINAL_TEXT], value[MARGINAL_VALUES][MARGINAL_TEXT];
    int    values, pairs[MARGINAL_VALUES];
    double error[MARGINAL_VALUES], ms[MARGINAL_VALUES];
} marginal;

/* Of a config text, name=value separated by blanks or commas: the value of an option. What the text leaves out is at
 * its default in hbil.h; "default" where that has no such option. */
void      config_value(const char *config, const char *option, char out[MARGINAL_TEXT]);
/* The options that vary, in the order of hbil.h; those with more than MARGINAL_VALUES values are left out. Free with
 * free(). *count: how many. NULL: there are none (*count 0) or no memory (-1). */
marginal *marginals_make(const points *p, int *count);

/* Among the configs that differ in slices and steps alone, those that fill most of a grid. */
typedef struct grid {
    int          columns, rows;                              /* slices, steps; 0: less than 2 x 2 are there */
    double       slices[MARGINAL_VALUES], steps[MARGINAL_VALUES]; /* ascending */
    const point *cell[MARGINAL_VALUES][MARGINAL_VALUES];     /* [row][column]; NULL: not measured */
} grid;

/* 1, or 0: no memory. */
int       grid_make(grid *out, const points *p);

#endif
