/* metric.h - what an output holds, and how far it is from the truth. */
#ifndef HBIL_FRAME_METRIC_H
#define HBIL_FRAME_METRIC_H

#include "capture.h"

typedef struct metric {
    size_t nan, inf, negative;  /* values, of all pixels and channels. negative: a fault of light, not of a vector */
    double min, mean, max;      /* of the finite values; 0 if there are none */
    size_t compared;            /* pixels that took part below; 0: no truth, and rmse and bias are 0 */
    double rmse, bias;          /* root of the mean square, and mean, of result - truth over channels and pixels */
    size_t hf_compared;         /* the same against the height-field truth, see metric_height_field */
    double hf_rmse, hf_bias;
} metric;

/* 1: the pixel has a truth. Sky has none, nor do emitters (albedo and truth_ao 0). */
int    metric_counts(const capture *cap, size_t pixel);
/* truth may be absent or NULL, or of another shape than result: then nothing is compared. Pixels with a value that is not finite in
 * result or truth are left out of the comparison: they are counted in nan and inf. */
metric metric_measure(const image *result, const image *truth, const capture *cap);
/* Adds the comparison with a height-field truth (hf_ao, hf_near) on the pixels of hf_valid. It may be absent or NULL. */
void   metric_height_field(metric *m, const image *result, const image *truth, const capture *cap);

#endif
