/* metrics.c - see metrics.h; FLIP is in flip.c. */
#include "metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SKY_DEPTH  1e9f
#define EDGE_STEP  0.05f /* of the nearer depth */

static int same_shape(const image *a, const image *b)
{
    return a && b && a->data && b->data && a->width == b->width && a->height == b->height && a->channels == b->channels
        && image_slices(a) == 1 && image_slices(b) == 1;
}

static size_t pixel_count(const image *img) { return (size_t)img->width * (size_t)img->height; }

int metric_add(metric_sums *sums, const float *a, const float *b, int channels)
{
    double difference = 0.0, absolute = 0.0, square = 0.0, truth = 0.0;
    int    c;

    for (c = 0; c < channels; c++) {
        const double d = (double)a[c] - (double)b[c];

        difference += d;
        absolute += fabs(d);
        square += d * d;
        truth += (double)b[c];
    }
    if (!isfinite(square)) return 0;
    sums->difference += difference;
    sums->absolute += absolute;
    sums->square += square;
    sums->truth += truth;
    sums->pixels++;
    sums->values += (size_t)channels;
    return 1;
}

metric_sums metric_compare(const image *a, const image *b, const unsigned char *mask)
{
    metric_sums sums;
    size_t      i, channels;

    memset(&sums, 0, sizeof sums);
    if (!same_shape(a, b)) return sums;
    channels = (size_t)a->channels;
    for (i = 0; i < pixel_count(a); i++)
        if (!mask || mask[i]) metric_add(&sums, a->data + i * channels, b->data + i * channels, a->channels);
    return sums;
}

double metric_sums_rmse(const metric_sums *sums)
{
    return sums->values > 0 ? sqrt(sums->square / (double)sums->values) : (double)NAN;
}

double metric_sums_bias(const metric_sums *sums)
{
    return sums->values > 0 ? sums->difference / (double)sums->values : (double)NAN;
}

double metric_rmse(const image *a, const image *b, const unsigned char *mask)
{
    const metric_sums sums = metric_compare(a, b, mask);

    return metric_sums_rmse(&sums);
}

double metric_bias(const image *a, const image *b, const unsigned char *mask)
{
    const metric_sums sums = metric_compare(a, b, mask);

    return metric_sums_bias(&sums);
}

double metric_relative(const image *a, const image *b, const unsigned char *mask)
{
    const metric_sums sums = metric_compare(a, b, mask);

    return sums.truth > 0.0 ? sums.absolute / sums.truth : (double)NAN;
}

double metric_psnr(const image *a, const image *b, const unsigned char *mask, double peak)
{
    const double rmse = metric_rmse(a, b, mask);

    return rmse > 0.0 ? 20.0 * log10(peak / rmse) : isnan(rmse) ? rmse : (double)INFINITY;
}

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

double metric_percentile(const image *a, const image *b, const unsigned char *mask, double q)
{
    double *values, rank, result = (double)NAN;
    size_t  i, used = 0, below;
    int     c;

    if (!same_shape(a, b) || !(q >= 0.0 && q <= 1.0)) return result;
    values = malloc(pixel_count(a) * sizeof *values);
    if (!values) return result;
    for (i = 0; i < pixel_count(a); i++) {
        const float *x = a->data + i * (size_t)a->channels, *y = b->data + i * (size_t)b->channels;
        metric_sums  sums;
        double       worst = 0.0;

        memset(&sums, 0, sizeof sums);
        if ((mask && !mask[i]) || !metric_add(&sums, x, y, a->channels)) continue;
        for (c = 0; c < a->channels; c++) worst = fmax(worst, fabs((double)x[c] - (double)y[c]));
        values[used++] = worst;
    }
    if (used > 0) {
        qsort(values, used, sizeof *values, by_size);
        rank = q * (double)(used - 1);
        below = (size_t)rank;
        result = values[below];
        if (below + 1 < used) result += (rank - (double)below) * (values[below + 1] - values[below]);
    }
    free(values);
    return result;
}

/* ---- edges ------------------------------------------------------------------------------------------------------- */

static int is_step(float p, float q)
{
    const int p_sky = !(p < SKY_DEPTH), q_sky = !(q < SKY_DEPTH);

    return p_sky || q_sky ? p_sky != q_sky : fabsf(p - q) > EDGE_STEP * fminf(p, q);
}

/* The two pixels either side: the pixel beside a step, and all eight around it. */
static void mark_around(unsigned char *edges, const image *depth, int x, int y)
{
    int i, j;

    for (j = y > 0 ? y - 1 : 0; j <= y + 1 && j < depth->height; j++)
        for (i = x > 0 ? x - 1 : 0; i <= x + 1 && i < depth->width; i++) edges[j * depth->width + i] = 1;
}

static void mark_edges(unsigned char *edges, const image *depth)
{
    const int w = depth->width, h = depth->height;
    int       x, y;

    for (y = 0; y < h; y++) {
        for (x = 0; x < w; x++) {
            const float *d = depth->data + y * w + x;

            if (x + 1 < w && is_step(d[0], d[1])) mark_around(edges, depth, x, y), mark_around(edges, depth, x + 1, y);
            if (y + 1 < h && is_step(d[0], d[w])) mark_around(edges, depth, x, y), mark_around(edges, depth, x, y + 1);
        }
    }
}

double metric_edge_rmse(const image *a, const image *b, const unsigned char *mask, const image *depth)
{
    unsigned char *edges;
    double         result;
    size_t         i;

    if (!same_shape(a, b) || !depth || !depth->data || depth->channels != 1 || depth->width != a->width
        || depth->height != a->height) return (double)NAN;
    edges = calloc(pixel_count(a), 1);
    if (!edges) return (double)NAN;
    mark_edges(edges, depth);
    for (i = 0; mask && i < pixel_count(a); i++) edges[i] = edges[i] && mask[i];
    result = metric_rmse(a, b, edges);
    free(edges);
    return result;
}

/* ---- rings ------------------------------------------------------------------------------------------------------- */

void metric_rings(const image *a, const image *b, const unsigned char *mask, double rmse[METRIC_RINGS])
{
    metric_sums rings[METRIC_RINGS];
    int         x, y, k;

    memset(rings, 0, sizeof rings);
    for (y = 0; same_shape(a, b) && y < a->height; y++) {
        for (x = 0; x < a->width; x++) {
            const size_t at = (size_t)y * (size_t)a->width + (size_t)x, value = at * (size_t)a->channels;
            const double r = hypot(2 * x + 1 - a->width, 2 * y + 1 - a->height) / hypot(a->width, a->height); /* < 1 */

            if (!mask || mask[at])
                metric_add(&rings[(int)(METRIC_RINGS * r)], a->data + value, b->data + value, a->channels);
        }
    }
    for (k = 0; k < METRIC_RINGS; k++) rmse[k] = metric_sums_rmse(&rings[k]);
}

/* ---- over time --------------------------------------------------------------------------------------------------- */

double metric_flicker(const image *frames, int count, const unsigned char *mask)
{
    double sum = 0.0;
    size_t i, c, channels, pixels = 0;
    int    k;

    for (k = 0; k < count; k++)
        if (!same_shape(&frames[0], &frames[k])) return (double)NAN;
    if (count < 2) return (double)NAN;
    channels = (size_t)frames[0].channels;
    for (i = 0; i < pixel_count(&frames[0]); i++) {
        double deviation = 0.0;

        if (mask && !mask[i]) continue;
        for (c = 0; c < channels; c++) {
            double mean = 0.0, square = 0.0;

            for (k = 0; k < count; k++) mean += (double)frames[k].data[i * channels + c] / (double)count;
            for (k = 0; k < count; k++) square += pow((double)frames[k].data[i * channels + c] - mean, 2.0);
            deviation += sqrt(square / (double)count) / (double)channels;
        }
        if (!isfinite(deviation)) continue;
        sum += deviation;
        pixels++;
    }
    return pixels > 0 ? sum / (double)pixels : (double)NAN;
}
