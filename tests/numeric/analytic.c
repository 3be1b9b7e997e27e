/* analytic.c - see analytic.h */
#include "analytic.h"

#include <math.h>
#include <stddef.h>

#define MAX_CORNERS 8 /* of a rectangle clipped by two half-planes: 6 */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void scale_to_unit(double v[3])
{
    const double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; ++k) {
        v[k] /= length;
    }
}

wedge wedge_make(const double point[3], const double along[3], double opening, double turn)
{
    wedge  w = {.concave = opening < 3.14159265358979323846};
    double middle[3], side[3];
    for (int k = 0; k < 3; ++k) {
        middle[k] = -point[k] + along[k] * dot(along, point); /* from the edge to the camera, across the edge */
    }
    scale_to_unit(middle);
    cross(along, middle, side);
    for (int k = 0; k < 3; ++k) {
        const double m = cos(turn) * middle[k] + sin(turn) * side[k], s = cos(turn) * side[k] - sin(turn) * middle[k];
        w.n[0][k] = sin(0.5 * opening) * m - cos(0.5 * opening) * s;
        w.n[1][k] = sin(0.5 * opening) * m + cos(0.5 * opening) * s;
    }
    w.d[0] = dot(w.n[0], point);
    w.d[1] = dot(w.n[1], point);
    return w;
}

wedge wedge_plane(const double point[3], const double normal[3])
{
    wedge w = {.concave = 1};
    for (int i = 0; i < 2; ++i) {
        for (int k = 0; k < 3; ++k) {
            w.n[i][k] = normal[k];
        }
        w.d[i] = dot(normal, point);
    }
    return w;
}

/* Height (brute_force.h) of a plane over the screen: out[0] * px + out[1] * py + out[2] */
static void height_of_plane(const wedge *w, int plane, const bf_camera *c, double out[3])
{
    const double *n = w->n[plane], d = w->d[plane];
    const double  scale = c->orthographic ? -1.0 / n[2] : 1.0 / d;
    out[0] = scale * n[0] * c->ray[0];
    out[1] = scale * n[1] * c->ray[1];
    out[2] = scale * (n[0] * c->ray[2] + n[1] * c->ray[3] - (c->orthographic ? d : n[2]));
}

static double evaluate(const double affine[3], const double at[2])
{
    return affine[0] * at[0] + affine[1] * at[1] + affine[2];
}

double wedge_depth(const wedge *w, const bf_camera *camera, double px, double py, int *plane)
{
    const double at[2] = {px, py};
    double       affine[2][3], h[2];
    for (int i = 0; i < 2; ++i) {
        height_of_plane(w, i, camera, affine[i]);
        h[i] = evaluate(affine[i], at);
    }
    const int seen = (h[1] > h[0]) == (w->concave != 0);
    if (plane) {
        *plane = seen;
    }
    if (camera->orthographic) {
        return -h[seen];
    }
    return h[seen] > 0.0 ? 1.0 / h[seen] : 0.0;
}

void wedge_render(const wedge *w, const bf_camera *camera, float sky, const float grey[2], float *depth, float *normal,
                  float *radiance)
{
    for (int i = 0; i < camera->width * camera->height; ++i) {
        int          plane;
        const double z = wedge_depth(w, camera, i % camera->width + 0.5, i / camera->width + 0.5, &plane);
        if (depth) {
            depth[i] = z > 0.0 && z < (double)sky ? (float)z : sky;
        }
        for (int k = 0; k < 3; ++k) {
            if (normal) {
                normal[3 * i + k] = (float)w->n[plane][k];
            }
            if (radiance) {
                radiance[3 * i + k] = grey[plane];
            }
        }
    }
}

/* Keep the part of a convex polygon where affine >= 0. Returns its number of corners. */
static int clip(double polygon[MAX_CORNERS][2], int count, const double affine[3])
{
    double kept[MAX_CORNERS][2];
    int    n = 0;
    for (int i = 0; i < count; ++i) {
        const double *a = polygon[i], *b = polygon[(i + 1) % count];
        const double  fa = evaluate(affine, a), fb = evaluate(affine, b);
        if (fa >= 0.0) {
            kept[n][0] = a[0];
            kept[n++][1] = a[1];
        }
        if ((fa >= 0.0) != (fb >= 0.0)) {
            const double t = fa / (fa - fb);
            kept[n][0] = a[0] + t * (b[0] - a[0]);
            kept[n++][1] = a[1] + t * (b[1] - a[1]);
        }
    }
    for (int i = 0; i < n; ++i) {
        polygon[i][0] = kept[i][0];
        polygon[i][1] = kept[i][1];
    }
    return n;
}

/* Direction from p to the point of the given height at a pixel position; a point at infinity has a direction too. */
static void direction(const bf_camera *c, const double at[2], double height, const double p[3], double out[3])
{
    const double rx = at[0] * c->ray[0] + c->ray[2], ry = at[1] * c->ray[1] + c->ray[3];
    const double scale = c->orthographic ? 1.0 : height;
    out[0] = rx - scale * p[0];
    out[1] = ry - scale * p[1];
    out[2] = (c->orthographic ? height : -1.0) - scale * p[2];
}

double wedge_visible(const wedge *w, const bf_camera *camera, int x, int y, int plane)
{
    const double *n = w->n[plane];
    const double  right = camera->width - 0.5, bottom = camera->height - 0.5;
    double        polygon[MAX_CORNERS][2] = {{0.5, 0.5}, {right, 0.5}, {right, bottom}, {0.5, bottom}};
    double        own[3], other[3], nearer[3], p[3], sum = 0.0;
    int           count = 4;
    if (!w->concave) {
        return 1.0; /* neither plane of a roof's edge sees the other */
    }
    height_of_plane(w, plane, camera, own);
    height_of_plane(w, 1 - plane, camera, other);
    for (int k = 0; k < 3; ++k) {
        nearer[k] = other[k] - own[k];
    }
    count = clip(polygon, count, nearer);
    if (!camera->orthographic) {
        count = clip(polygon, count, other); /* up to its vanishing line */
    }
    bf_point(camera, x + 0.5, y + 0.5, wedge_depth(w, camera, x + 0.5, y + 0.5, NULL), p);
    for (int i = 0; i < count; ++i) {
        double a[3], b[3], axis[3];
        direction(camera, polygon[i], evaluate(other, polygon[i]), p, a);
        direction(camera, polygon[(i + 1) % count], evaluate(other, polygon[(i + 1) % count]), p, b);
        cross(a, b, axis);
        const double sine = sqrt(dot(axis, axis));
        if (sine > 0.0) {
            sum += atan2(sine, dot(a, b)) * dot(n, axis) / sine;
        }
    }
    return 1.0 - fabs(sum) / (2.0 * 3.14159265358979323846);
}
