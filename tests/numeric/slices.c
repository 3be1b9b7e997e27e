/* slices.c - see slices.h */
#include "slices.h"

#include "kernel.h"

#define PULL 1e-5   /* of the depth, as the brute force */
#define STEP 0.25   /* pixels */
#define RISE 0.01   /* of a horizon's cosine at once; more is looked at again in halves, down to STEP / 2^HALVES */
#define HALVES 10
#define BIAS 0.001  /* sine, the shader's default: samples below it are left out */

/* One side of one slice. */
typedef struct side {
    const bf_scene *scene;
    double          x, y, dx, dy; /* start and direction on the screen, from pixel centre to pixel centre */
    double          p[3], v[3], n[3], d[3], height; /* receiver; d: tangent on this side; height: 1/depth of p */
    double          nx, ny, c;    /* c: horizon so far */
    double         *near;
} side;

static double height_at(const bf_scene *s, int x, int y)
{
    return 1.0 / (double)s->depth[y * s->camera.width + x];
}

/* Corner of cell (ix, iy) that stands above height h, nearest to (a, b) in it. */
static int blocker(const bf_scene *s, int ix, int iy, double a, double b, double h)
{
    int    best = iy * s->camera.width + ix;
    double best_weight = -1.0;
    for (int k = 0; k < 4; ++k) {
        const int    x = ix + (k & 1), y = iy + (k >> 1);
        const double weight = ((k & 1) ? a : 1.0 - a) * ((k >> 1) ? b : 1.0 - b);
        if (weight > best_weight && height_at(s, x, y) >= h) {
            best = y * s->camera.width + x;
            best_weight = weight;
        }
    }
    return best;
}

/* Height, at a distance on the screen, of the ray from the receiver whose cosine to V is c. */
static double ray_height(const side *s, double c, double distance)
{
    const bf_camera *cam = &s->scene->camera;
    const double     sine = sqrt(1.0 - c * c), forward = -(sine * s->d[2] + c * s->v[2]);
    const double     gx = (sine * s->d[0] + c * s->v[0] - (s->x + 0.5) * cam->ray[0] * forward - cam->ray[2] * forward) / cam->ray[0];
    const double     gy = (sine * s->d[1] + c * s->v[1] - (s->y + 0.5) * cam->ray[1] * forward - cam->ray[3] * forward) / cam->ray[1];
    return s->height * (1.0 - forward * distance / hypot(gx, gy));
}

/* Raise the horizon to c > s->c, with light from a pixel. */
static void rise(side *s, double c, int pixel, kernel_primitive g)
{
    const double light = kernel_rise(s->nx, s->ny, s->c, c, g);
    for (int k = 0; k < 3; ++k) {
        s->near[k] += light * (double)s->scene->radiance[3 * pixel + k];
    }
    s->c = c;
}

/* Cosine between V and the way to a point; *above: sine of its elevation above the tangent plane. */
static double cosine_to(const side *s, double px, double py, double depth, double *above)
{
    double h[3];
    bf_point(&s->scene->camera, px, py, depth, h);
    for (int k = 0; k < 3; ++k) {
        h[k] -= s->p[k];
    }
    const double length = sqrt(kernel_dot(h, h));
    *above = kernel_dot(h, s->n) / length;
    return fmin(kernel_dot(h, s->v) / length, 1.0);
}

/* Follow the surface from a distance to the next. 0: the screen ends. */
static int follow(side *s, double from, double to, int halves)
{
    const bf_scene *scene = s->scene;
    const double    x = s->x + s->dx * to, y = s->y + s->dy * to, a = x - floor(x), b = y - floor(y);
    const int       ix = (int)floor(x), iy = (int)floor(y), width = scene->camera.width;
    double          above;
    if (ix < 0 || iy < 0 || ix >= width - 1 || iy >= scene->camera.height - 1) {
        return 0;
    }
    for (int k = 0; k < 4; ++k) {
        if ((double)scene->depth[(iy + (k >> 1)) * width + ix + (k & 1)] >= scene->sky_depth) {
            return 1;
        }
    }
    const double top = (1.0 - a) * height_at(scene, ix, iy) + a * height_at(scene, ix + 1, iy);
    const double bottom = (1.0 - a) * height_at(scene, ix, iy + 1) + a * height_at(scene, ix + 1, iy + 1);
    const double c = cosine_to(s, x + 0.5, y + 0.5, 1.0 / ((1.0 - b) * top + b * bottom), &above);
    if (c <= s->c || above <= 0.0) {
        return 1;
    }
    if (c > s->c + RISE && halves > 0) {
        follow(s, from, 0.5 * (from + to), halves - 1);
        return follow(s, 0.5 * (from + to), to, halves - 1);
    }
    rise(s, c, blocker(scene, ix, iy, a, b, ray_height(s, 0.5 * (c + s->c), to)), kernel_g);
    return 1;
}

/* The samples of the shader: the nearest pixel centres, never one twice, up to the border of the screen but for a little. */
static void follow_centres(side *s, int steps)
{
    const bf_camera *cam = &s->scene->camera;
    const double     room_x = (s->dx > 0.0 ? cam->width - 1 - s->x : s->x) + 0.49;
    const double     room_y = (s->dy > 0.0 ? cam->height - 1 - s->y : s->y) + 0.49;
    const double     reach = fmin(room_x / fmax(fabs(s->dx), 1e-6), room_y / fmax(fabs(s->dy), 1e-6));
    double           offset = 0.0, above;
    for (int i = 0; i < steps; ++i) {
        const double t = (i + 0.5) / steps;
        offset = fmax(1.0 + t * t * (reach - 1.0), offset + 1.0);
        const int x = (int)(s->x + floor(offset * s->dx + 0.5)), y = (int)(s->y + floor(offset * s->dy + 0.5)), pixel = y * cam->width + x;
        if (offset > reach || x < 0 || y < 0 || x >= cam->width || y >= cam->height) {
            return;
        }
        if ((double)s->scene->depth[pixel] >= s->scene->sky_depth) {
            continue;
        }
        const double c = cosine_to(s, x + 0.5, y + 0.5, (double)s->scene->depth[pixel], &above);
        if (c > s->c && above > BIAS) {
            rise(s, c, pixel, kernel_g_polynomial);
        }
    }
}

/* The horizon of one side; near grows by its light. */
static double run_side(side *s, double sign, const double d[3], double nx, int steps)
{
    const bf_camera *cam = &s->scene->camera;
    double           length;
    for (int k = 0; k < 3; ++k) {
        s->d[k] = sign * d[k];
    }
    s->nx = sign * nx;
    s->c = kernel_horizon(s->nx, s->ny);
    s->dx = (s->d[0] - s->d[2] * s->p[0] / s->p[2]) / cam->ray[0];
    s->dy = (s->d[1] - s->d[2] * s->p[1] / s->p[2]) / cam->ray[1];
    length = hypot(s->dx, s->dy);
    s->dx /= length;
    s->dy /= length;
    if (steps > 0) {
        follow_centres(s, steps);
        return s->c;
    }
    for (int i = 1; follow(s, (i - 1) * STEP, i * STEP, HALVES); ++i) {
    }
    return s->c;
}

void slices_run(const bf_scene *scene, int x, int y, int slices, int steps, double turn, bf_pixel *out)
{
    const bf_pixel empty = {0};
    const int      pixel = y * scene->camera.width + x;
    double         e1[3], e2[3], full = 0.0, open = 0.0;
    side           s = {.scene = scene, .x = x, .y = y};
    *out = empty;
    s.near = out->near;
    s.height = height_at(scene, x, y) / (1.0 - PULL);
    bf_point(&scene->camera, x + 0.5, y + 0.5, 1.0 / s.height, s.p);
    const double distance = sqrt(kernel_dot(s.p, s.p));
    for (int k = 0; k < 3; ++k) {
        s.v[k] = -s.p[k] / distance;
        s.n[k] = (double)scene->normal[3 * pixel + k];
    }
    const double length = sqrt(kernel_dot(s.n, s.n));
    for (int k = 0; k < 3; ++k) {
        s.n[k] /= length;
    }
    kernel_face_camera(s.n, s.v, SLICES_FACING);
    kernel_frame(s.v, e1, e2);
    s.ny = kernel_dot(s.n, s.v);
    for (int i = 0; i < slices; ++i) {
        const double phi = (i + turn) * KERNEL_PI / slices;
        double       d[3];
        for (int k = 0; k < 3; ++k) {
            d[k] = cos(phi) * e1[k] + sin(phi) * e2[k];
        }
        const double nx = kernel_dot(s.n, d), cF = run_side(&s, 1.0, d, nx, steps), cB = run_side(&s, -1.0, d, nx, steps);
        full += kernel_full(nx, s.ny, kernel_g);
        open += kernel_open(nx, s.ny, cB, cF, kernel_g);
    }
    out->ao = open / full;
    for (int k = 0; k < 3; ++k) {
        out->near[k] /= full;
    }
}
