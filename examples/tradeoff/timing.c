/* timing.c - medians, their bootstrap interval, warm-up. */
#include "timing.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common.h"
#include "grid.h"

#define RESAMPLES  1000
#define BATCH      3    /* runs of a median of the warm-up */
#define BATCHES    10
#define STEADY     1.05
#define RESOLUTION 0.02
#define SURE       8    /* values, from which on a bootstrap of the median can tell 99 % */

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* Sorts values. */
static double sorted_median(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, by_size);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

double timing_median(const double *values, int count)
{
    double copy[TIMING_RUNS_MAX];

    memcpy(copy, values, (size_t)count * sizeof *copy);
    return sorted_median(copy, count);
}

interval timing_bootstrap(const double *values, int count, double confidence)
{
    double   medians[RESAMPLES], sample[TIMING_RUNS_MAX];
    const int cut = (int)floor(0.5 * (1.0 - confidence) * RESAMPLES);
    uint64_t state = 1;
    interval found;
    int      i, k;

    for (i = 0; i < RESAMPLES; i++) {
        for (k = 0; k < count; k++) sample[k] = values[grid_random(&state) % (uint64_t)count];
        medians[i] = sorted_median(sample, count);
    }
    qsort(medians, RESAMPLES, sizeof *medians, by_size);
    found.low = medians[cut];
    found.high = medians[RESAMPLES - 1 - cut];
    return found;
}

int timing_warm(timing_run *run, void *user, double seconds, double *ms, int *stable, char *error, size_t error_size)
{
    const double begun = seconds_now();
    double       batch[BATCH], medians[BATCHES];
    int          i;

    *stable = 0;
    if (!run(user, 1, batch, error, error_size)) return 0; /* compiles; its time counts for nothing */
    *ms = batch[0];
    for (i = 0; i < BATCHES && !*stable && seconds_now() - begun < seconds; i++) {
        if (!run(user, BATCH, batch, error, error_size)) return 0;
        *ms = medians[i] = sorted_median(batch, BATCH);
        if (i < 2) continue;
        *stable = fmax(fmax(medians[i], medians[i - 1]), medians[i - 2])
               <= STEADY * fmin(fmin(medians[i], medians[i - 1]), medians[i - 2]);
    }
    return 1;
}

timing_ratio timing_compare(const double *a, const double *b, int count)
{
    double       ratio[TIMING_RUNS_MAX];
    timing_ratio r;
    int          i;

    for (i = 0; i < count; i++) ratio[i] = a[i] > 0.0 ? b[i] / a[i] : 1.0;
    r.median = timing_median(ratio, count);
    r.range = timing_bootstrap(ratio, count, 0.99);
    if (count < SURE) { /* all on one side of 1 by chance is likelier than 1 %: as wide again on both sides */
        const double spread = r.range.high / r.range.low;

        r.range.low /= spread;
        r.range.high *= spread;
    }
    r.within_noise = (r.range.low <= 1.0 && r.range.high >= 1.0) || fabs(r.median - 1.0) < RESOLUTION;
    return r;
}
