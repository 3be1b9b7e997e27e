/* flip.c - LDR-FLIP, see metrics.h. Headings in quotes are the article's; constants are its, with the erratum that L +
 * 16 is divided by 116. All filters are sums of Gaussians and their derivatives in x or y, and so separable. */
#include "metrics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI         3.14159265358979323846
#define PPD_MAX    400.0
#define RADIUS_MAX 64 /* pixels; of the widest filter at PPD_MAX: 3 sqrt(0.04 / (2 pi^2)) 400 = 54 */

enum { FLAT, SLOPE, CURVE }; /* Gaussian, its first and second derivative */

typedef struct kernel { int radius; double weight[2 * RADIUS_MAX + 1]; } kernel; /* weight[radius] is the middle */

typedef struct triple { double v[3]; } triple;

/* One image on its way: planes of width * height values. */
typedef struct view {
    int    width, height;
    float *opponent[3]; /* Y Cx Cz, later their filtered values */
    float *edge, *point; /* how much of a feature there is */
    float *row, *sum, *more; /* scratch */
} view;

/* ---- colour ------------------------------------------------------------------------------------------------------ */

/* Linear sRGB to XYZ in units of the white point, whose XYZ are the row sums. Nine digits of the inverse. */
static const double white_from_rgb[3][3] = {
    {10135552.0 / 23359437.0, 8788810.0 / 23359437.0, 4435075.0 / 23359437.0},
    {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
    {1425312.0 / 80288307.0, 8788810.0 / 80288307.0, 70074185.0 / 80288307.0},
};
static const double rgb_from_xyz[3][3] = {
    {3.241003275, -1.537398934, -0.498615861},
    {-0.969224334, 1.875930071, 0.041554224},
    {0.055639423, -0.204011202, 1.057148933},
};
static const double white[3] = {23359437.0 / 24577794.0, 1.0, 80288307.0 / 73733382.0};

static double clamp(double v) { return v > 0.0 ? (v < 1.0 ? v : 1.0) : 0.0; }

static triple multiply(const double m[3][3], triple t)
{
    triple out;
    int    i;

    for (i = 0; i < 3; i++) out.v[i] = m[i][0] * t.v[0] + m[i][1] * t.v[1] + m[i][2] * t.v[2];
    return out;
}

/* L, a, b and Y, Cx, Cz alike: the former of the cube roots, the latter of the values themselves. */
static triple opponent_from(triple t)
{
    const triple out = {{116.0 * t.v[1] - 16.0, 500.0 * (t.v[0] - t.v[1]), 200.0 * (t.v[1] - t.v[2])}};

    return out;
}

static triple rgb_from_opponent(triple t)
{
    const double y = (t.v[0] + 16.0) / 116.0;
    const triple xyz = {{white[0] * (y + t.v[1] / 500.0), y, white[2] * (y - t.v[2] / 200.0)}};

    return multiply(rgb_from_xyz, xyz);
}

static double lab_root(double v)
{
    const double delta = 6.0 / 29.0;

    return v > delta * delta * delta ? cbrt(v) : v / (3.0 * delta * delta) + 4.0 / 29.0;
}

/* "Perceptually Uniform Color Space": L*a*b*, a and b scaled by L as the Hunt effect has it. */
static triple hunt_lab(triple rgb)
{
    triple t = multiply(white_from_rgb, rgb);
    int    i;

    for (i = 0; i < 3; i++) t.v[i] = lab_root(t.v[i]);
    t = opponent_from(t);
    t.v[1] *= 0.01 * t.v[0];
    t.v[2] *= 0.01 * t.v[0];
    return t;
}

/* "Color Metric": HyAB, to the power 0.7. */
static double color_distance(triple p, triple q)
{
    return pow(fabs(p.v[0] - q.v[0]) + hypot(p.v[1] - q.v[1], p.v[2] - q.v[2]), 0.7);
}

/* Spread over [0, 1]: the lower 40 % of what is possible, which is green against blue, take 95 %. */
static double redistribute(double distance, double most)
{
    const double knee = 0.4 * most;

    return distance < knee ? 0.95 * distance / knee : 0.95 + 0.05 * (distance - knee) / (most - knee);
}

/* ---- filters ----------------------------------------------------------------------------------------------------- */

/* exp(-scale x^2) and derivatives. Positive weights add up to 1, and negative ones to -1. */
static kernel make_kernel(double scale, int radius, int shape)
{
    kernel k;
    double positive = 0.0, negative = 0.0;
    int    x;

    k.radius = radius;
    for (x = -radius; x <= radius; x++) {
        const double g = exp(-scale * x * x);
        const double w = shape == FLAT ? g : shape == SLOPE ? -x * g : (2.0 * scale * x * x - 1.0) * g;

        k.weight[x + radius] = w;
        if (w > 0.0) positive += w;
        else negative -= w;
    }
    for (x = 0; x <= 2 * radius; x++) k.weight[x] /= k.weight[x] > 0.0 ? positive : negative > 0.0 ? negative : 1.0;
    return k;
}

static int clamped(int i, int count) { return i < 0 ? 0 : i < count ? i : count - 1; }

/* out = in filtered along x by `across`, then along y by `along`; borders are repeated. row: scratch. */
static void convolve(const float *in, float *out, float *row, int w, int h, const kernel *across, const kernel *along)
{
    int x, y, k;

    for (y = 0; y < h; y++) {
        for (x = 0; x < w; x++) {
            double sum = 0.0;

            for (k = -across->radius; k <= across->radius; k++)
                sum += across->weight[k + across->radius] * (double)in[y * w + clamped(x + k, w)];
            row[y * w + x] = (float)sum;
        }
    }
    for (y = 0; y < h; y++) {
        for (x = 0; x < w; x++) {
            double sum = 0.0;

            for (k = -along->radius; k <= along->radius; k++)
                sum += along->weight[k + along->radius] * (double)row[clamped(y + k, h) * w + x];
            out[y * w + x] = (float)sum;
        }
    }
}

/* "Spatial Filtering" by the contrast sensitivity of each opponent channel: a1 sqrt(pi / b1) exp(-pi^2 x^2 / b1), and
 * for Cz a second one. x in degrees. The widest filter gives all their radius. */
static void filter_opponents(view *v, double ppd)
{
    static const double b[4] = {0.0047, 0.0053, 0.04, 0.025};
    const int           radius = (int)ceil(3.0 * sqrt(0.04 / (2.0 * PI * PI)) * ppd);
    const size_t        count = (size_t)v->width * (size_t)v->height;
    double              mass[2];
    kernel              k;
    size_t              i;
    int                 c, x;

    for (c = 0; c < 2; c++) {
        k = make_kernel(PI * PI / (b[c] * ppd * ppd), radius, FLAT);
        convolve(v->opponent[c], v->sum, v->row, v->width, v->height, &k, &k);
        memcpy(v->opponent[c], v->sum, count * sizeof(float));
    }
    for (c = 0; c < 2; c++) { /* share of each of the two in Cz: its sum over all taps, of x and of y */
        double line = 0.0;

        for (x = -radius; x <= radius; x++) line += exp(-PI * PI * x * x / (b[2 + c] * ppd * ppd));
        mass[c] = (c ? 13.5 : 34.1) * sqrt(PI / b[2 + c]) * line * line;
    }
    k = make_kernel(PI * PI / (b[2] * ppd * ppd), radius, FLAT);
    convolve(v->opponent[2], v->sum, v->row, v->width, v->height, &k, &k);
    k = make_kernel(PI * PI / (b[3] * ppd * ppd), radius, FLAT);
    convolve(v->opponent[2], v->more, v->row, v->width, v->height, &k, &k);
    for (i = 0; i < count; i++)
        v->opponent[2][i] = (float)((mass[0] * (double)v->sum[i] + mass[1] * (double)v->more[i]) / (mass[0] + mass[1]));
}

/* "Feature Pipeline": length of the gradient, or of both second derivatives, of (Y + 16) / 116. The filter of edge
 * detection spans 0.082 degrees from peak to trough, two standard deviations. */
static void detect(view *v, float *out, int shape, double ppd)
{
    const double deviation = 0.5 * 0.082 * ppd, scale = 0.5 / (deviation * deviation);
    const int    radius = (int)ceil(3.0 * deviation);
    const kernel flat = make_kernel(scale, radius, FLAT), derivative = make_kernel(scale, radius, shape);
    const size_t count = (size_t)v->width * (size_t)v->height;
    size_t       i;

    convolve(v->opponent[0], out, v->row, v->width, v->height, &derivative, &flat);
    convolve(v->opponent[0], v->sum, v->row, v->width, v->height, &flat, &derivative);
    for (i = 0; i < count; i++)
        out[i] = hypotf(out[i], v->sum[i]) / 116.0f; /* the 16 is the same on all taps, which add up to 0 */
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

static void view_free(view *v) { free(v->opponent[0]); }

/* All planes in one block. 1, or 0: no memory. */
static int view_make(view *v, const image *img, double ppd)
{
    const size_t count = (size_t)img->width * (size_t)img->height;
    float       *block = malloc(8 * count * sizeof *block);
    size_t       i;
    int          c;

    if (!block) return 0;
    v->width = img->width;
    v->height = img->height;
    for (c = 0; c < 3; c++) v->opponent[c] = block + (size_t)c * count;
    v->edge = block + 3 * count;
    v->point = block + 4 * count;
    v->row = block + 5 * count;
    v->sum = block + 6 * count;
    v->more = block + 7 * count;
    for (i = 0; i < count; i++) {
        triple t;

        for (c = 0; c < 3; c++) t.v[c] = clamp((double)img->data[3 * i + (size_t)c]);
        t = opponent_from(multiply(white_from_rgb, t));
        for (c = 0; c < 3; c++) v->opponent[c][i] = (float)t.v[c];
    }
    detect(v, v->edge, SLOPE, ppd); /* before the filters, which overwrite the opponents */
    detect(v, v->point, CURVE, ppd);
    filter_opponents(v, ppd);
    return 1;
}

static triple view_lab(const view *v, size_t i)
{
    triple t = {{(double)v->opponent[0][i], (double)v->opponent[1][i], (double)v->opponent[2][i]}};
    int    c;

    t = rgb_from_opponent(t);
    for (c = 0; c < 3; c++) t.v[c] = clamp(t.v[c]);
    return hunt_lab(t);
}

/* "Final": the colour difference, to a power that falls with the difference in features. */
static double pixel_flip(const view *r, const view *t, size_t i, double most)
{
    const double color = redistribute(color_distance(view_lab(r, i), view_lab(t, i)), most);
    const double edge = fabs((double)r->edge[i] - (double)t->edge[i]);
    const double point = fabs((double)r->point[i] - (double)t->point[i]);

    return pow(color, 1.0 - sqrt(fmax(edge, point) / sqrt(2.0)));
}

double metric_flip(const image *reference, const image *test, const unsigned char *mask, double pixels_per_degree,
                   image *map)
{
    static const triple green = {{0.0, 1.0, 0.0}}, blue = {{0.0, 0.0, 1.0}};
    const double        most = color_distance(hunt_lab(green), hunt_lab(blue));
    view                views[2];
    double              sum = 0.0, value;
    size_t              i, count, used = 0;
    int                 k, made = 0;

    if (map) memset(map, 0, sizeof *map);
    if (!reference->data || !test->data || reference->width != test->width || reference->height != test->height
        || reference->channels != 3 || test->channels != 3 || image_slices(reference) != 1 || image_slices(test) != 1
        || !(pixels_per_degree > 0.0 && pixels_per_degree <= PPD_MAX)) return (double)NAN;
    memset(views, 0, sizeof views);
    count = (size_t)test->width * (size_t)test->height;
    for (k = 0; k < 2; k++) made += view_make(&views[k], k ? test : reference, pixels_per_degree);
    if (made == 2 && (!map || image_make(map, test->width, test->height, 1))) {
        for (i = 0; i < count; i++) {
            value = pixel_flip(&views[0], &views[1], i, most);
            if (map) map->data[i] = (float)value;
            if (mask && !mask[i]) continue;
            sum += value;
            used++;
        }
    }
    for (k = 0; k < 2; k++) view_free(&views[k]);
    return used > 0 ? sum / (double)used : (double)NAN;
}
