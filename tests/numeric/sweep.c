/* sweep.c - see sweep.h */
#include "sweep.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "kernel.h"

#define THREADS 2
#define FACING  0.001   /* normals are turned until n.V is no smaller */
#define BRIGHT  60000.0 /* radiance is limited to it */

typedef struct direction {
    double     x, y; /* on the screen, unit */
    int        is_row;
    const int *shift;
} direction;

/* A pixel and its line: where it begins across, and how far it can go. */
typedef struct line {
    const sweep     *sweep;
    const direction *d;
    int              step, start; /* of the pixel; across, at step 0 */
    int              steps, width;
} line;

/* What all slices of a pixel share. */
typedef struct receiver { double position[3], v[3], n[3], ny; } receiver;

/* --- lines -------------------------------------------------------------------------------------------------------- */

static int longest(const sweep *s)
{
    const bf_camera *c = &s->scene->camera;
    return c->width > c->height ? c->width : c->height;
}

static direction direction_of(const sweep *s, int index)
{
    const sweep_options *o = &s->options;
    const double         part = (index + o->turn) / (o->slices * o->stride), angle = (part - 0.25) * KERNEL_PI;
    const direction      d = {cos(angle), sin(angle), part < 0.5, s->shift + index * longest(s)};
    return d;
}

static void fill_shift(sweep *s, int index)
{
    const direction d = direction_of(s, index);
    const int       stride = s->options.stride;
    const double    slope = floor((d.is_row ? d.y / d.x : d.x / d.y) * 65536.0 / stride + 0.5);
    for (int step = 0; step < longest(s); ++step) {
        s->shift[index * longest(s) + step] = stride * (int)floor((slope * step + 32768.0) / 65536.0);
    }
}

static line line_through(const sweep *s, const direction *d, int x, int y)
{
    const bf_camera *c = &s->scene->camera;
    line             l = {s, d, d->is_row ? x : y, 0, d->is_row ? c->width : c->height, d->is_row ? c->height : c->width};
    l.start = (d->is_row ? y : x) - d->shift[l.step];
    return l;
}

/* Index of the line's pixel at a step, -1 off the screen. */
static int pixel_at(const line *l, int step)
{
    if (step < 0 || step >= l->steps) {
        return -1;
    }
    const int across = l->start + l->d->shift[step];
    if (across < 0 || across >= l->width) {
        return -1;
    }
    return l->d->is_row ? across * l->sweep->scene->camera.width + step : step * l->sweep->scene->camera.width + across;
}

static int is_sky(double nearness)
{
    return !(nearness > -HUGE_VAL);
}

/* --- one side ----------------------------------------------------------------------------------------------------- */

/* Steps to the pixel that stands highest over this one in (step, nearness), the nearest of several; 0: none. */
static int horizon(const line *l, int sign)
{
    const double *q = l->sweep->nearness, here = q[pixel_at(l, l->step)];
    double        rise = 0.0;
    int           reach = 0;
    for (int k = 1, i; (i = pixel_at(l, l->step + sign * k)) >= 0; ++k) {
        if (!is_sky(q[i]) && (!reach || (q[i] - here) * reach > rise * k)) {
            reach = k;
            rise = q[i] - here;
        }
    }
    return reach;
}

static double radiance_of(const bf_scene *scene, int pixel, int channel)
{
    const double value = scene->radiance ? (double)scene->radiance[3 * pixel + channel] : 0.0;
    return value > 0.0 ? fmin(value, BRIGHT) : 0.0;
}

static void mean_light(const line *l, int sign, int reach, double rgb[3])
{
    const bf_scene *scene = l->sweep->scene;
    const double   *q = l->sweep->nearness, *ray = scene->camera.ray;
    const double    pitch = hypot(ray[0] * l->d->x, ray[1] * l->d->y) / fmax(fabs(l->d->x), fabs(l->d->y));
    double          from = q[pixel_at(l, l->step)], all = 0.0, sum[3] = {0};
    int             first = -1;
    for (int k = 1; k <= reach; ++k) {
        const int    i = pixel_at(l, l->step + sign * k);
        const double rise = fmax(q[i] - from + (scene->camera.orthographic ? pitch : pitch * from), 0.0);
        if (is_sky(q[i])) {
            continue;
        }
        first = first < 0 ? i : first;
        all += rise;
        for (int c = 0; c < 3; ++c) {
            sum[c] += rise * radiance_of(scene, i, c);
        }
        from = q[i];
    }
    for (int c = 0; c < 3; ++c) {
        rgb[c] = all > 0.0 ? sum[c] / all : radiance_of(scene, first, c);
    }
}

static void look(const line *l, const receiver *r, const double tangent[3], int sign, sweep_side *side)
{
    const bf_scene *scene = l->sweep->scene;
    const double    nx = sign * kernel_dot(r->n, tangent);
    double          h[3], length;
    memset(side, 0, sizeof *side);
    side->c0 = kernel_horizon(nx, r->ny);
    side->c = side->c0;
    side->reach = horizon(l, sign);
    if (!side->reach) {
        return;
    }
    const int pixel = pixel_at(l, l->step + sign * side->reach), width = scene->camera.width;
    bf_point(&scene->camera, pixel % width + 0.5, pixel / width + 0.5, (double)scene->depth[pixel], h);
    for (int k = 0; k < 3; ++k) {
        h[k] -= r->position[k];
    }
    length = fmax(sqrt(kernel_dot(h, h)), 1e-150);
    side->c = fmin(fmax(kernel_dot(h, r->v) / length, -1.0), 1.0);
    side->elevation = kernel_dot(r->n, h) / length;
    side->taken = side->c > side->c0 && side->elevation > l->sweep->options.bias;
    if (side->taken) {
        side->weight = kernel_rise(nx, r->ny, side->c0, side->c, kernel_g);
        mean_light(l, sign, side->reach, side->light);
    }
}

/* --- one pixel ---------------------------------------------------------------------------------------------------- */

static receiver receiver_at(const sweep *s, int x, int y)
{
    const bf_camera *c = &s->scene->camera;
    const int        pixel = y * c->width + x;
    const double     depth = (double)s->scene->depth[pixel];
    receiver         r = {.v = {0.0, 0.0, 1.0}};
    bf_point(c, x + 0.5, y + 0.5, depth - s->options.pull * fabs(depth), r.position);
    if (!c->orthographic) {
        double p[3];
        bf_point(c, x + 0.5, y + 0.5, 1.0, p);
        for (int k = 0; k < 3; ++k) {
            r.v[k] = -p[k] / sqrt(kernel_dot(p, p));
        }
    }
    for (int k = 0; k < 3; ++k) {
        r.n[k] = (double)s->scene->normal[3 * pixel + k];
    }
    const double length = sqrt(kernel_dot(r.n, r.n));
    for (int k = 0; k < 3; ++k) {
        r.n[k] /= length;
    }
    kernel_face_camera(r.n, r.v, FACING);
    r.ny = kernel_dot(r.n, r.v);
    return r;
}

/* Slice tangent. Returns the azimuth about V that the slice stands for, up to a factor. */
static double tangent_of(const bf_camera *c, const direction *d, const double v[3], double tangent[3])
{
    const double u[3] = {d->x * c->ray[0], d->y * c->ray[1], 0.0}, along = kernel_dot(u, v);
    double       square = 0.0;
    for (int k = 0; k < 3; ++k) {
        tangent[k] = u[k] - along * v[k];
        square += tangent[k] * tangent[k];
    }
    for (int k = 0; k < 3; ++k) {
        tangent[k] /= sqrt(square);
    }
    return 1.0 / square;
}

void sweep_at(const sweep *s, int x, int y, sweep_pixel *out, sweep_side (*sides)[2])
{
    const sweep_options *o = &s->options;
    const sweep_pixel    nothing = {1, 1.0, {0.0, 0.0, 0.0}};
    double               full = 0.0, blocked = 0.0, near[3] = {0};
    *out = nothing;
    if (is_sky(s->nearness[y * s->scene->camera.width + x])) {
        return;
    }
    const receiver r = receiver_at(s, x, y);
    for (int j = 0; j < o->slices; ++j) {
        const direction d = direction_of(s, j * o->stride + (2 * j < o->slices ? y : x) % o->stride);
        const line      l = line_through(s, &d, x, y);
        sweep_side      own[2], *pair = sides ? sides[j] : own;
        double          tangent[3];
        const double    azimuth = tangent_of(&s->scene->camera, &d, r.v, tangent);
        full += azimuth * kernel_full(kernel_dot(r.n, tangent), r.ny, kernel_g);
        for (int k = 0; k < 2; ++k) {
            look(&l, &r, tangent, k ? -1 : 1, &pair[k]);
            blocked += azimuth * pair[k].weight;
            for (int c = 0; c < 3; ++c) {
                near[c] += azimuth * pair[k].weight * pair[k].light[c];
            }
        }
    }
    out->sky = 0;
    out->ao = fmin(fmax(1.0 - blocked / full, 0.0), 1.0);
    for (int c = 0; c < 3; ++c) {
        out->near[c] = near[c] / full;
    }
}

/* --- all pixels --------------------------------------------------------------------------------------------------- */

typedef struct share { const sweep *s; bf_grid grid; sweep_pixel *out; int first_row; } share;

static void *run_share(void *arg)
{
    const share *a = arg;
    for (int row = a->first_row; row < a->grid.rows; row += THREADS) {
        for (int column = 0; column < a->grid.columns; ++column) {
            sweep_at(a->s, a->grid.first + column * a->grid.stride, a->grid.first + row * a->grid.stride,
                     a->out + row * a->grid.columns + column, NULL);
        }
    }
    return NULL;
}

void sweep_run(const sweep *s, bf_grid grid, sweep_pixel *out)
{
    share     shares[THREADS];
    pthread_t threads[THREADS];
    int       started = 0;
    for (int i = 0; i < THREADS; ++i) {
        const share a = {s, grid, out, i};
        shares[i] = a;
    }
    while (started < THREADS && pthread_create(&threads[started], NULL, run_share, &shares[started]) == 0) {
        ++started;
    }
    for (int i = started; i < THREADS; ++i) {
        run_share(&shares[i]); /* no thread to be had: do its rows here */
    }
    for (int i = 0; i < started; ++i) {
        pthread_join(threads[i], NULL);
    }
}

int sweep_open(sweep *s, const sweep_options *options, const bf_scene *scene)
{
    const int pixels = scene->camera.width * scene->camera.height;
    s->options = *options;
    s->scene = scene;
    s->nearness = malloc((size_t)pixels * sizeof *s->nearness);
    s->shift = malloc((size_t)(options->slices * options->stride * longest(s)) * sizeof *s->shift);
    if (!s->nearness || !s->shift) {
        sweep_close(s);
        return 0;
    }
    for (int i = 0; i < options->slices * options->stride; ++i) {
        fill_shift(s, i);
    }
    for (int i = 0; i < pixels; ++i) {
        const double depth = (double)scene->depth[i];
        s->nearness[i] = !(depth < scene->sky_depth) ? -HUGE_VAL : scene->camera.orthographic ? -depth : (double)(float)(1.0 / depth);
    }
    return 1;
}

void sweep_close(sweep *s)
{
    free(s->nearness);
    free(s->shift);
    s->nearness = NULL;
    s->shift = NULL;
}
