/* compare.h - two runs of a sweep: is the second the same as the first? */
#ifndef HBIL_TRADEOFF_COMPARE_H
#define HBIL_TRADEOFF_COMPARE_H

#include <stdio.h>

#include "front.h"

#define COMPARE_WITHIN 0.1 /* of a time */

/* A config on one device in both runs: geometric means over the frames that both have. */
typedef struct twin { const csv_row *row; double ms[2]; int rows; } twin;

/* Rows match by device, backend, config, frame with its size, and output; of several the last one counts. */
typedef struct comparison {
    twin          *twins;            /* of all configs */
    int            count;
    int            matched, only[2]; /* rows */
    int            differ;           /* matched rows with another error or cost */
    int            column;           /* the number that differs most, and its row in the first run; NULL: none */
    const csv_row *worst;
    double         most;             /* by that share of the larger one; 1: it is there in one of them alone */
} comparison;

/* Of rows that s has not ruled out by backend, device or output. 1; 0: error[] says why: no row matches, or they
 * are of several devices. The tables must outlive it. */
int    compare_make(comparison *out, const csv tables[2], const selection *s, char *error, size_t error_size);
void   compare_free(comparison *c);

/* How far the times are from each other. */
typedef struct deviation {
    double         median;    /* of second over first */
    double         p90, most; /* of the factors between both, less 1: 90th percentile and largest */
    double         within;    /* share of the configs that lie within COMPARE_WITHIN */
    const csv_row *worst;
} deviation;

/* Times of the second run are divided by `common` first. 1, or 0: no memory. */
int    compare_times(const comparison *c, double common, deviation *out);
/* Kendall's rank correlation of the times (tau a): 1 the same order, -1 the reverse, 0 for one config. */
double compare_tau(const comparison *c);

/* Writes all of it. 1: the same: errors equal, nine of ten times within COMPARE_WITHIN of the run's common factor,
 * presets in the same order but for those that lie so close; 0: not; -1: nothing to compare, error[] says why. */
int    compare_print(FILE *out, const csv tables[2], const char *const paths[2], const selection *s, char *error,
                     size_t error_size);

#endif
