/* measure.h - a config on a frame, in numbers. */
#ifndef HBIL_TRADEOFF_MEASURE_H
#define HBIL_TRADEOFF_MEASURE_H

#include "metrics.h"
#include "truth.h"

/* NaN where it is not known. Of all channels, as metrics.h has them. white: the value at which the truth's mean would
 * be a grey of .18; for ao 1. */
typedef struct errors {
    int    present;                     /* the config has this output */
    double rmse_sampling;               /* against its own converged estimator */
    double rmse_estimator;              /* of that one against the height field */
    double rmse_model, bias_model, p95_model, relative, edge_rmse, ring_model[METRIC_RINGS]; /* against the scene */
    double psnr;                        /* the same; the peak is white */
    double flip;                        /* the same, of pictures with the truth's white: ao as grey, direct + emission
                                           + albedo * near, albedo * far */
    double rmse_field, bias_field, ring_field[METRIC_RINGS]; /* against the height field */
    double flicker;                     /* of a still camera; not measured where a run takes long */
} errors;

typedef struct times {
    double   ms[TIMING_RUNS_MAX];
    int      runs, stable;              /* stable: the warm-up came to rest */
    double   min, median, max;
    interval range;                     /* of the median, 95 % */
    int      noisy;                     /* that is wider than 10 % of it, or there is no saying */
} times;

/* Per pixel of the frame, an upper bound, see shadergen/cost.h; loops of unknown length count one step. NaN: unknown,
 * of an external with such loops. */
typedef struct price { double fetches, bytes_read, bytes_written, registers; } price;

typedef struct measured {
    times  time;
    price  cost;
    errors out[OUTS];
} measured;

/* All of it, of what is opened. converged: of its config, as truth_converged made it; NULL: none. An exit code;
 * s->error says why. */
int  measure_all(settings *s, lit *l, const truth *t, const image *converged, measured *m);
/* Its parts; images come first, times after them. */
/* as: the config whose truths are taken; converged: NULL: no sampling and estimator error; slow: 1: flicker and FLIP,
 * too. */
int  measure_errors(settings *s, lit *l, const truth *t, const hbil_config *as, const image *converged, int slow,
                    errors out[OUTS]);
int  measure_time(settings *s, lit *l, times *t);
int  measure_cost(settings *s, const lit *l, price *cost);
/* Output k's image alone, which may be absent: all but flip and flicker. mask: the model's. */
void   measure_image(const settings *s, const capture *cap, const truth *t, const hbil_config *as, int k,
                     const image *out, const image *converged, errors *e);
double measure_flip(const capture *cap, const image *out, const image *model, const unsigned char *mask, int k);
/* min, median, max and interval of ms[runs]. */
void times_sum_up(times *t);

#endif
