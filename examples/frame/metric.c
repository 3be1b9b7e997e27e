/* metric.c - what an output holds, and how far it is from the truth. Sums in double: a frame has millions of values. */
#include "metric.h"

#include <math.h>
#include <string.h>

#include "../tradeoff/metrics.h"

int metric_counts(const capture *cap, size_t pixel)
{
    const float *albedo = cap->albedo.data + 3 * pixel;

    if (!(cap->depth.data[pixel] < 1e9f)) return 0; /* m; sky, or NaN */
    return albedo[0] > 0.0f || albedo[1] > 0.0f || albedo[2] > 0.0f || (cap->truth_ao.data && cap->truth_ao.data[pixel] > 0.0f);
}

static void measure_values(const image *result, metric *m)
{
    const size_t count = (size_t)result->width * (size_t)result->height * (size_t)image_slices(result)
                       * (size_t)result->channels;
    size_t       i, finite = 0;
    double       sum = 0.0;

    for (i = 0; i < count; i++) {
        const double v = (double)result->data[i];

        if (isnan(v)) m->nan++;
        if (isinf(v)) m->inf++;
        if (v < 0.0) m->negative++;
        if (!isfinite(v)) continue;
        if (finite == 0 || v < m->min) m->min = v;
        if (finite == 0 || v > m->max) m->max = v;
        sum += v;
        finite++;
    }
    if (finite > 0) m->mean = sum / (double)finite;
}

/* Root of the mean square, and mean, of result - truth over all pixels that count: those of `where`, NULL: those with a truth.
 * How many pixels. */
static size_t measure_error(const image *result, const image *truth, const image *where, const capture *cap, double *rmse,
                            double *bias)
{
    const size_t count = (size_t)result->width * (size_t)result->height, channels = (size_t)result->channels;
    metric_sums  sums;
    size_t       i;

    if (!truth || !truth->data || truth->width != result->width || truth->height != result->height
        || truth->channels != result->channels || image_slices(result) != 1) return 0;
    memset(&sums, 0, sizeof sums);
    for (i = 0; i < count; i++)
        if (where ? where->data[i] > 0.5f : metric_counts(cap, i))
            metric_add(&sums, result->data + i * channels, truth->data + i * channels, result->channels);
    if (sums.pixels == 0) return 0;
    *bias = metric_sums_bias(&sums);
    *rmse = metric_sums_rmse(&sums);
    return sums.pixels;
}

metric metric_measure(const image *result, const image *truth, const capture *cap)
{
    metric m;

    memset(&m, 0, sizeof m);
    measure_values(result, &m);
    m.compared = measure_error(result, truth, NULL, cap, &m.rmse, &m.bias);
    return m;
}

void metric_height_field(metric *m, const image *result, const image *truth, const capture *cap)
{
    if (cap->hf_valid.data) m->hf_compared = measure_error(result, truth, &cap->hf_valid, cap, &m->hf_rmse, &m->hf_bias);
}
