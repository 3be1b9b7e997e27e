/* metrics.h - how far an image is from the truth: every measure of these programs, in one place. */
#ifndef HBIL_TRADEOFF_METRICS_H
#define HBIL_TRADEOFF_METRICS_H

#include "../frame/image.h"

/* Common to all: a is measured against b. Both are plain images of one shape; otherwise, and where no pixel takes part,
 * the result is NaN. mask: one byte per pixel, 0 leaves it out; NULL: all take part. Pixels with a value that is not
 * finite are left out. Sums run over pixels and channels, in double. */

typedef struct metric_sums {
    size_t pixels, values;
    double difference, absolute, square; /* of a - b */
    double truth;                        /* of b */
} metric_sums;

/* Adds a pixel. 1, or 0 if it is left out. */
int         metric_add(metric_sums *sums, const float *a, const float *b, int channels);
metric_sums metric_compare(const image *a, const image *b, const unsigned char *mask);
double      metric_sums_rmse(const metric_sums *sums);
double      metric_sums_bias(const metric_sums *sums);

double metric_rmse(const image *a, const image *b, const unsigned char *mask);
double metric_bias(const image *a, const image *b, const unsigned char *mask);
/* Mean |difference| in units of the mean of b. NaN if that is not above 0. */
double metric_relative(const image *a, const image *b, const unsigned char *mask);
/* Of the pixels' |difference| in their worst channel; q in [0, 1], linear between ranks: .5 is the median. NaN also
 * without memory. */
double metric_percentile(const image *a, const image *b, const unsigned char *mask, double q);
/* dB; infinite for equal images. peak: the largest value that counts, 1 for ao. */
double metric_psnr(const image *a, const image *b, const unsigned char *mask, double peak);
/* RMSE of the two pixels either side of every step in linear depth (m, sky >= 1e9) of more than 5 % of the nearer depth
 * between pixels that share a side. NaN also without memory. */
double metric_edge_rmse(const image *a, const image *b, const unsigned char *mask, const image *depth);
#define METRIC_RINGS 5
/* RMSE by distance from the image's centre: in rings of equal width, the corner at the end of the last. NaN where a
 * ring has no pixel. */
void   metric_rings(const image *a, const image *b, const unsigned char *mask, double rmse[METRIC_RINGS]);
/* Standard deviation over time of each pixel's channels, mean over pixels: 0 if nothing moves. The camera stands still;
 * count >= 2. */
double metric_flicker(const image *frames, int count, const unsigned char *mask);

#define METRIC_FLIP_PPD 67.02 /* pixels per degree: 0.7 m from a screen 0.7 m and 3840 pixels wide, the article's */

/* LDR-FLIP, mean over the image, 0 to 1; symmetric. Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom, Fairchild:
 * FLIP: A Difference Evaluator for Alternating Images, HPG 2020. Linear sRGB, 3 channels; values are clamped to [0, 1],
 * NaN to 0. Masked pixels are neighbours all the same. pixels_per_degree in (0, 400]. map: NULL, or gets the value of
 * every pixel, 1 channel; free it with image_free. NaN, and map absent: other shape or range, or no memory. */
double metric_flip(const image *reference, const image *test, const unsigned char *mask, double pixels_per_degree,
                   image *map);

#endif
