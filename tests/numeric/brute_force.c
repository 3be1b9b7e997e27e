/* brute_force.c - see brute_force.h.
 *
 * A ray P + s w projects to a straight screen line. With g = w.xy - (P.xy / depth) * forward(w), the screen moves along g
 * (perspective: by m = s / (depth + s forward); orthographic: m = s, g = w.xy) and the ray's height h is linear in m:
 * 1/depth * (1 - m forward), or -depth - m forward. So in each cell the surface minus the ray is a quadratic along the line, and
 * the first place where it is not negative is found exactly. Cells and blocks of cells that the ray passes above are passed over. */
#include "brute_force.h"

#include <math.h>
#include <pthread.h>
#include <stdint.h>
#include <stdlib.h>

#define BF_THREADS 2
#define BF_BATCHES 8    /* independently shifted low-discrepancy sets: their spread gives the standard error */
#define BF_BLOCK   8    /* cells along the side of a block */
#define BF_PULL    1e-5 /* part of the depth by which a receiver moves towards the camera: the ray starts above its own surface */

static const double k_pi = 3.14159265358979323846;

typedef struct field {
    const bf_scene *scene;
    bf_grid         grid;
    int             rays;
    double         *height;  /* width * height values of h */
    double          highest; /* of all h */
    double         *top;     /* of every cell, by its first corner: the largest h; -infinity if one of its corners is sky */
    double         *blocks;  /* the largest of top in every block of cells */
    int             blocks_wide;
    bf_pixel       *out;
} field;

typedef struct share { const field *f; int first_row; } share;

/* One ray on the screen, in units of pixels from pixel centre to pixel centre. */
typedef struct line {
    double x, y;   /* start */
    double dx, dy; /* unit direction */
    double h, dh;  /* height at the start, rise per pixel */
    double end;    /* length to the vanishing point, or infinity */
} line;

bf_camera bf_camera_from(const float projection[16], int width, int height)
{
    const double sx = (double)projection[0], sy = (double)projection[5], forward = (double)projection[11];
    bf_camera c = {.width = width, .height = height, .orthographic = projection[11] == 0.0f};
    /* clip.xy = scale * view.xy + offset, with clip.w = -z = depth, or 1: ndc = scale * ray + offset */
    const double ox = c.orthographic ? (double)projection[12] : (double)projection[8] * forward;
    const double oy = c.orthographic ? (double)projection[13] : (double)projection[9] * forward;
    c.ray[0] = 2.0 / (width * sx);
    c.ray[1] = 2.0 / (height * sy);
    c.ray[2] = (-1.0 - ox) / sx;
    c.ray[3] = (-1.0 - oy) / sy;
    return c;
}

void bf_point(const bf_camera *camera, double px, double py, double depth, double out[3])
{
    const double scale = camera->orthographic ? 1.0 : depth;
    out[0] = scale * (px * camera->ray[0] + camera->ray[2]);
    out[1] = scale * (py * camera->ray[1] + camera->ray[3]);
    out[2] = -depth;
}

bf_grid bf_grid_of(int width, int height, int first, int stride)
{
    const bf_grid g = {first, stride, (width - first + stride - 1) / stride, (height - first + stride - 1) / stride};
    return g;
}

/* --- random numbers: R2 sequence with a shift per pixel and batch ------------------------------------------------ */

static double hash_unit(uint32_t a, uint32_t b)
{
    uint64_t v = ((uint64_t)a << 32) | b;
    v += 0x9e3779b97f4a7c15u; /* splitmix64 */
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
    v ^= v >> 31;
    return (double)(v >> 11) * 0x1p-53;
}

static void basis(const double n[3], double e1[3], double e2[3])
{
    const double s = n[2] >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n[2]), b = n[0] * n[1] * a;
    e1[0] = 1.0 + s * n[0] * n[0] * a; e1[1] = s * b; e1[2] = -s * n[0];
    e2[0] = b; e2[1] = s + n[1] * n[1] * a; e2[2] = -n[1];
}

/* Cosine-distributed about n: u, v in [0, 1). */
static void cosine_ray(const double n[3], const double e1[3], const double e2[3], double u, double v, double w[3])
{
    const double r = sqrt(u), c = r * cos(2.0 * k_pi * v), s = r * sin(2.0 * k_pi * v), z = sqrt(1.0 - u);
    for (int k = 0; k < 3; ++k) {
        w[k] = c * e1[k] + s * e2[k] + z * n[k];
    }
}

/* --- one ray ---------------------------------------------------------------------------------------------------- */

static line line_of(const bf_camera *c, int x, int y, double height, const double w[3])
{
    const double rx = (x + 0.5) * c->ray[0] + c->ray[2], ry = (y + 0.5) * c->ray[1] + c->ray[3], forward = -w[2];
    const double gx = (c->orthographic ? w[0] : w[0] - rx * forward) / c->ray[0];
    const double gy = (c->orthographic ? w[1] : w[1] - ry * forward) / c->ray[1];
    const double length = fmax(hypot(gx, gy), 1e-300); /* 0: along the view ray, the line is a point */
    line l = {.x = x, .y = y, .dx = gx / length, .dy = gy / length, .end = HUGE_VAL};
    if (c->orthographic) {
        l.h = height + BF_PULL * fabs(height);
        l.dh = -forward / length;
    } else {
        l.h = height / (1.0 - BF_PULL);
        l.dh = -l.h * forward / length;
        if (forward > 0.0) {
            l.end = length / forward;
        }
    }
    return l;
}

/* First t in [0, len] with a + b t + c t^2 >= 0, or -1. */
static double first_rise(double a, double b, double c, double len)
{
    if (a >= 0.0) {
        return 0.0;
    }
    const int    end_above = a + (b + c * len) * len >= 0.0;
    const double disc = b * b - 4.0 * a * c;
    if (!end_above && (c >= 0.0 || disc < 0.0 || b <= 0.0 || b > -2.0 * c * len)) {
        return -1.0; /* both ends below, and no peak above 0 between them */
    }
    /* a < 0, so this form of the first positive root divides by a sum of terms of one sign where b > 0 */
    const double root = sqrt(fmax(disc, 0.0));
    const double t = b > 0.0 ? -2.0 * a / (b + root) : (root - b) / (2.0 * c);
    return fmin(fmax(t, 0.0), len);
}

/* Of a cell's corners the one that blocks: the nearest to (a, b) that stands above the ray's height h. A surface that
 * joins two depths is thereby lit as its upper end, the pixel whose horizon it makes. */
static int blocking_pixel(const field *f, int cell, double a, double b, double h)
{
    const int width = f->scene->camera.width;
    int       best = cell;
    double    best_weight = -1.0;
    for (int k = 0; k < 4; ++k) {
        const int    pixel = cell + (k & 1) + (k >> 1) * width;
        const double weight = ((k & 1) ? a : 1.0 - a) * ((k >> 1) ? b : 1.0 - b);
        if (weight > best_weight && f->height[pixel] >= h - 1e-12 * fabs(h)) { /* level surfaces: rounding */
            best = pixel;
            best_weight = weight;
        }
    }
    return best;
}

/* Length from x to a border, in a direction of d = 1 / inverse pixels. */
static double to_border(double x, int border, double d, double inverse)
{
    return d == 0.0 ? HUGE_VAL : (border - x) * inverse;
}

/* The next cell behind `size` cells from `first` on in one direction, if the way out of them is through this side; else the one at x. */
static int step_on(int first, int size, int leaves, double d, double x)
{
    const int last = first + size - 1, at = (int)x;
    return leaves ? (d > 0.0 ? last + 1 : first - 1) : at < first ? first : at > last ? last : at;
}

/* Where the line leaves `size` x `size` cells from (ix, iy) on. */
typedef struct way_out { double tx, ty, t; } way_out;

static way_out leave(const line *l, int ix, int iy, int size, double ux, double uy)
{
    way_out w;
    w.tx = to_border(l->x, l->dx > 0.0 ? ix + size : ix, l->dx, ux);
    w.ty = to_border(l->y, l->dy > 0.0 ? iy + size : iy, l->dy, uy);
    w.t = fmin(fmin(w.tx, w.ty), l->end);
    return w;
}

/* The pixel that blocks the ray in a cell, from t to t + len, or -1. */
static int follow_cell(const field *f, const line *l, int ix, int iy, double t, double len)
{
    const int     width = f->scene->camera.width;
    const double  h = l->h + l->dh * t, a = l->x + l->dx * t - ix, b = l->y + l->dy * t - iy;
    const double *v = f->height + iy * width + ix;
    const double  sa = v[1] - v[0], sb = v[width] - v[0], sab = v[width + 1] - v[width] - sa;
    const double  rise = first_rise(v[0] + sa * a + sb * b + sab * a * b - h,
                                    sa * l->dx + sb * l->dy + sab * (a * l->dy + b * l->dx) - l->dh, sab * l->dx * l->dy, len);
    return rise < 0.0 ? -1 : blocking_pixel(f, iy * width + ix, a + rise * l->dx, b + rise * l->dy, h + rise * l->dh);
}

/* The pixel that blocks the ray, or -1. */
static int follow(const field *f, const line *l)
{
    const bf_camera *c = &f->scene->camera;
    const double     ux = 1.0 / l->dx, uy = 1.0 / l->dy;
    int              ix = l->dx < 0.0 ? (int)l->x - 1 : (int)l->x, iy = l->dy < 0.0 ? (int)l->y - 1 : (int)l->y, seen = -1;
    double           t = 0.0;
    while (ix >= 0 && iy >= 0 && ix < c->width - 1 && iy < c->height - 1 && t < l->end) {
        const double h = l->h + l->dh * t;
        const int    bx = ix / BF_BLOCK, by = iy / BF_BLOCK, block = by * f->blocks_wide + bx;
        int          x = ix, y = iy, size = 1;
        way_out      out;
        if (l->dh >= 0.0 && h > f->highest) {
            return -1;
        }
        if (block != seen) {
            seen = block;
            out = leave(l, bx * BF_BLOCK, by * BF_BLOCK, BF_BLOCK, ux, uy);
            if (fmin(h, l->h + l->dh * out.t) > f->blocks[block]) {
                x = bx * BF_BLOCK, y = by * BF_BLOCK, size = BF_BLOCK;
            }
        }
        if (size == 1) {
            out = leave(l, ix, iy, 1, ux, uy);
            if (fmin(h, l->h + l->dh * out.t) <= f->top[iy * c->width + ix]) {
                const int pixel = follow_cell(f, l, ix, iy, t, out.t - t);
                if (pixel >= 0) {
                    return pixel;
                }
            }
        }
        ix = step_on(x, size, out.tx <= out.ty, l->dx, l->x + l->dx * out.t);
        iy = step_on(y, size, out.ty <= out.tx, l->dy, l->y + l->dy * out.t);
        t = out.t;
    }
    return -1;
}

/* --- one pixel -------------------------------------------------------------------------------------------------- */

enum { SUM_OPEN = 0, SUM_NEAR = 1, SUM_BENT = 4, SUM_FAR = 7, SUMS = 10 }; /* three numbers each from SUM_NEAR on */

/* Means of one batch. */
static void run_batch(const field *f, int x, int y, const double n[3], int batch, double sum[SUMS])
{
    const int      pixel = y * f->scene->camera.width + x, count = f->rays / BF_BATCHES;
    const uint32_t key = (uint32_t)pixel;
    const double   shift_u = hash_unit(key, 2u * (uint32_t)batch), shift_v = hash_unit(key, 2u * (uint32_t)batch + 1u);
    double         e1[3], e2[3], w[3];
    basis(n, e1, e2);
    for (int k = 0; k < SUMS; ++k) {
        sum[k] = 0.0;
    }
    for (int i = 0; i < count; ++i) {
        double whole, sky[3] = {0.0, 0.0, 0.0};
        cosine_ray(n, e1, e2, modf(shift_u + i * 0.7548776662466927, &whole), modf(shift_v + i * 0.5698402909980532, &whole), w);
        const line l = line_of(&f->scene->camera, x, y, f->height[pixel], w);
        const int  hit = follow(f, &l);
        if (hit < 0) {
            sum[SUM_OPEN] += 1.0 / count;
            if (f->scene->sky) {
                f->scene->sky(f->scene->sky_data, w, sky);
            }
        }
        for (int k = 0; k < 3; ++k) {
            if (hit < 0) {
                sum[SUM_BENT + k] += w[k] / count;
                sum[SUM_FAR + k] += sky[k] / count;
            } else if (f->scene->radiance) {
                sum[SUM_NEAR + k] += (double)f->scene->radiance[3 * hit + k] / count;
            }
        }
    }
}

static void run_pixel(const field *f, int x, int y, bf_pixel *out)
{
    const int    pixel = y * f->scene->camera.width + x;
    const float *m = f->scene->normal + 3 * pixel;
    const double nx = (double)m[0], ny = (double)m[1], nz = (double)m[2], length = sqrt(nx * nx + ny * ny + nz * nz);
    const double n[3] = {nx / length, ny / length, nz / length};
    double       mean[SUMS] = {0}, square[SUMS] = {0}, se[SUMS];
    bf_pixel     p = {0};
    if ((double)f->scene->depth[pixel] >= f->scene->sky_depth) {
        p.sky = 1.0;
        *out = p;
        return;
    }
    for (int b = 0; b < BF_BATCHES; ++b) {
        double sum[SUMS];
        run_batch(f, x, y, n, b, sum);
        for (int k = 0; k < SUMS; ++k) {
            mean[k] += sum[k] / BF_BATCHES;
            square[k] += sum[k] * sum[k] / BF_BATCHES;
        }
    }
    for (int k = 0; k < SUMS; ++k) {
        se[k] = sqrt(fmax(square[k] - mean[k] * mean[k], 0.0) / (BF_BATCHES - 1));
    }
    p.ao = mean[SUM_OPEN];
    p.ao_se = se[SUM_OPEN];
    for (int k = 0; k < 3; ++k) {
        p.near[k] = mean[SUM_NEAR + k];
        p.near_se[k] = se[SUM_NEAR + k];
        p.bent[k] = mean[SUM_BENT + k];
        p.far[k] = mean[SUM_FAR + k];
        p.far_se[k] = se[SUM_FAR + k];
    }
    *out = p;
}

static void *run_share(void *arg)
{
    const share *s = arg;
    const field *f = s->f;
    for (int row = s->first_row; row < f->grid.rows; row += BF_THREADS) {
        for (int column = 0; column < f->grid.columns; ++column) {
            run_pixel(f, f->grid.first + column * f->grid.stride, f->grid.first + row * f->grid.stride,
                      f->out + row * f->grid.columns + column);
        }
    }
    return NULL;
}

static double height_of(const bf_scene *s, double depth)
{
    if (depth >= s->sky_depth) {
        return -HUGE_VAL; /* makes a cell's sum infinite */
    }
    return s->camera.orthographic ? -depth : 1.0 / depth;
}

/* 0: out of memory. Give back with close_field all the same. */
static int open_field(field *f)
{
    const int width = f->scene->camera.width, height = f->scene->camera.height, high = height / BF_BLOCK + 1;
    f->blocks_wide = width / BF_BLOCK + 1;
    f->height = malloc((size_t)(width * height) * sizeof *f->height);
    f->top = malloc((size_t)(width * height) * sizeof *f->top);
    f->blocks = malloc((size_t)(f->blocks_wide * high) * sizeof *f->blocks);
    if (!f->height || !f->top || !f->blocks) {
        return 0;
    }
    f->highest = -HUGE_VAL;
    for (int i = 0; i < width * height; ++i) {
        f->height[i] = height_of(f->scene, (double)f->scene->depth[i]);
        f->highest = fmax(f->highest, f->height[i]);
    }
    for (int i = 0; i < f->blocks_wide * high; ++i) {
        f->blocks[i] = -HUGE_VAL;
    }
    for (int i = 0; i < (width - 1) * (height - 1); ++i) {
        const int     x = i % (width - 1), y = i / (width - 1), block = y / BF_BLOCK * f->blocks_wide + x / BF_BLOCK;
        const double *v = f->height + y * width + x;
        double       *top = &f->top[y * width + x];
        *top = isfinite(v[0] + v[1] + v[width] + v[width + 1]) ? fmax(fmax(v[0], v[1]), fmax(v[width], v[width + 1])) : -HUGE_VAL;
        f->blocks[block] = fmax(f->blocks[block], *top);
    }
    return 1;
}

static void close_field(field *f)
{
    free(f->height);
    free(f->top);
    free(f->blocks);
}

int bf_run(const bf_scene *scene, bf_grid grid, int rays, bf_pixel *out)
{
    field     f = {.scene = scene, .grid = grid, .rays = rays, .out = out};
    share     shares[BF_THREADS];
    pthread_t threads[BF_THREADS];
    int       started = 0;
    if (!open_field(&f)) {
        close_field(&f);
        return 0;
    }
    for (int i = 0; i < BF_THREADS; ++i) {
        shares[i].f = &f;
        shares[i].first_row = i;
    }
    while (started < BF_THREADS && pthread_create(&threads[started], NULL, run_share, &shares[started]) == 0) {
        ++started;
    }
    for (int i = started; i < BF_THREADS; ++i) {
        run_share(&shares[i]); /* no thread to be had: do its rows here */
    }
    for (int i = 0; i < started; ++i) {
        pthread_join(threads[i], NULL);
    }
    close_field(&f);
    return 1;
}
