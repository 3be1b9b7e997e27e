/* timing.h - times that can be trusted: medians, their bootstrap interval, warm-up. */
#ifndef HBIL_TRADEOFF_TIMING_H
#define HBIL_TRADEOFF_TIMING_H

#include <stddef.h>

#define TIMING_RUNS_MAX 1000

typedef struct interval { double low, high; } interval;

/* Of a copy of the values. count >= 1 */
double   timing_median(const double *values, int count);
/* Percentile bootstrap of the median, 1000 resamples by a generator with a fixed seed: the same values give the same
 * interval. confidence: .95. count in [1, TIMING_RUNS_MAX] */
interval timing_bootstrap(const double *values, int count, double confidence);

/* Milliseconds of `count` runs, one after the other. 1, or 0: error[] says why. */
typedef int timing_run(void *user, int count, double *ms, char *error, size_t error_size);
/* Runs until three medians of three runs lie within 5 % of each other, at most 10 of them or `seconds`. *ms: the last
 * median; *stable: did it come to that? */
int timing_warm(timing_run *run, void *user, double seconds, double *ms, int *stable, char *error, size_t error_size);

/* Of two that ran in turns: the median of b[i] / a[i], its interval of 99 %, and whether that says nothing: it holds 1,
 * or is closer to it than the 2 % that no clock here can be trusted with. */
typedef struct timing_ratio { double median; interval range; int within_noise; } timing_ratio;
timing_ratio timing_compare(const double *a, const double *b, int count);

#endif
