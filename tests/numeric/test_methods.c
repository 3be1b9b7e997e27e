/* test_methods.c - the double-precision reference of every estimator and output (methods.h) against the definitions:
 * directions that are tested one by one and integrated by Gauss quadrature, points on the sphere, closed forms and reference
 * vectors. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../hbil.h"
#include "kernel.h"
#include "methods.h"

/* cmocka 1.1.5 compares floats only */
#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

#define PI METHODS_PI

/* --- numbers ----------------------------------------------------------------------------------------------------- */

static uint64_t g_seed; /* set by every test that draws numbers, so that tests do not depend on their order */

static double draw(double low, double high)
{
    g_seed = g_seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(g_seed >> 11) / 9007199254740992.0;
}

static void draw_unit(double v[3])
{
    const double z = draw(-1.0, 1.0), phi = draw(0.0, 2.0 * PI), r = sqrt(1.0 - z * z);
    v[0] = r * cos(phi);
    v[1] = r * sin(phi);
    v[2] = z;
}

static double dot(const double a[3], const double b[3])
{
    return kernel_dot(a, b);
}

static void unit(const double a[3], double out[3])
{
    const double length = sqrt(dot(a, a));
    for (int k = 0; k < 3; ++k) {
        out[k] = a[k] / length;
    }
}

/* The axis of a bent vector: 2e-5 of the normal say where nothing is left of it. */
static void lean(const double bent[3], const double n[3], double out[3])
{
    const double sum[3] = {bent[0] + 2e-5 * n[0], bent[1] + 2e-5 * n[1], bent[2] + 2e-5 * n[2]};
    unit(sum, out);
}

/* Gauss-Legendre nodes on [0, 1]: exact for polynomials of degree 2 GAUSS - 1. */
#define GAUSS 12
static double g_node[GAUSS], g_weight[GAUSS];

static int make_gauss(void **state)
{
    (void)state;
    for (int i = 0; i < GAUSS; ++i) {
        double x = cos(PI * (i + 0.75) / (GAUSS + 0.5)), slope = 1.0;
        for (int step = 0; step < 40; ++step) {
            double p0 = 1.0, p1 = x;
            for (int k = 2; k <= GAUSS; ++k) {
                const double p2 = ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k;
                p0 = p1;
                p1 = p2;
            }
            slope = GAUSS * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / slope;
        }
        g_node[i] = 0.5 * (1.0 - x);
        g_weight[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    return 0;
}

static void sort(double *cut, int count)
{
    for (int i = 1; i < count; ++i) {
        const double x = cut[i];
        int          k = i;
        for (; k > 0 && cut[k - 1] > x; --k) {
            cut[k] = cut[k - 1];
        }
        cut[k] = x;
    }
}

/* Angle at which the plane of s is edge-on, and the opposite one, both in [-pi, pi]. */
static void plane_ends(const double s[2], double out[2])
{
    out[0] = atan2(-s[1], s[0]);
    out[1] = out[0] > 0.0 ? out[0] - PI : out[0] + PI;
}

/* Light between t0 and t1 by quadrature; s: where w . s < 0 only, or NULL. */
static double gauss_energy(double nx, double ny, double t0, double t1, const double *s)
{
    double cut[5] = {t0, t1, 0.0, 0.0, 0.0}, sum = 0.0;
    if (s) {
        plane_ends(s, cut + 3);
    }
    sort(cut, 5);
    for (int i = 0; i < 4; ++i) {
        const double a = fmax(cut[i], t0), b = fmin(cut[i + 1], t1);
        for (int k = 0; k < GAUSS && b > a; ++k) {
            const double t = a + (b - a) * g_node[k];
            if (!s || s[0] * sin(t) + s[1] * cos(t) < 0.0) {
                sum += (b - a) * g_weight[k] * fabs(sin(t)) * (nx * sin(t) + ny * cos(t));
            }
        }
    }
    return sum;
}

/* --- pixels with random samples ---------------------------------------------------------------------------------- */

#define SAMPLES 6
#define SLICES 64

typedef struct fixture {
    methods_pixel  p;
    methods_slice  slice[SLICES];
    methods_sample sample[SLICES][2][SAMPLES];
    double         n[3]; /* turned to the eye */
} fixture;

static fixture g_fixture; /* too large for some stacks */

/* Slices without samples. turn: their rotation, [0, 1). */
static void open_slices(fixture *f, int slices, double turn)
{
    double e1[3], e2[3];
    memcpy(f->n, f->p.normal, sizeof f->n);
    kernel_face_camera(f->n, f->p.v, METHODS_FACING);
    kernel_frame(f->p.v, e1, e2);
    for (int i = 0; i < slices; ++i) {
        const double phi = (i + turn) * PI / slices;
        for (int k = 0; k < 3; ++k) {
            f->slice[i].tangent[k] = cos(phi) * e1[k] + sin(phi) * e2[k];
        }
        f->slice[i].jitter = draw(0.0, 1.0);
        for (int side = 0; side < 2; ++side) {
            f->slice[i].sample[side] = f->sample[i][side];
            f->slice[i].count[side] = 0;
        }
    }
    f->p.slice = f->slice;
    f->p.slices = slices;
}

/* Receiver, slices without samples. least: of n.V. */
static void open_fixture(fixture *f, int slices, double least, int orthographic)
{
    const methods_pixel empty = {0};
    const double        z = draw(4.0, 8.0);
    f->p = empty;
    f->p.orthographic = orthographic;
    f->p.position[0] = draw(-0.7, 0.7) * z;
    f->p.position[1] = draw(-0.5, 0.5) * z;
    f->p.position[2] = z;
    for (int k = 0; k < 3; ++k) {
        f->p.v[k] = orthographic ? (k == 2 ? -1.0 : 0.0) : -f->p.position[k] / sqrt(dot(f->p.position, f->p.position));
        f->p.albedo[k] = draw(0.0, 0.9);
        f->p.direct[k] = draw(0.0, 2.0);
    }
    f->p.roughness = draw(0.05, 1.0);
    do {
        draw_unit(f->p.normal);
    } while (dot(f->p.normal, f->p.v) < least);
    open_slices(f, slices, draw(0.0, 1.0));
}

/* A sample at a horizon c of a side, at a distance; its normal faces the receiver and its radiance is white. */
static methods_sample *put_sample(fixture *f, int slice, int side, double c, double distance)
{
    methods_sample *s = &f->sample[slice][side][f->slice[slice].count[side]++];
    const double    sine = (side ? -1.0 : 1.0) * sqrt(1.0 - c * c);
    s->skip = 0;
    for (int k = 0; k < 3; ++k) {
        const double along = sine * f->slice[slice].tangent[k] + c * f->p.v[k];
        s->position[k] = f->p.position[k] + distance * along;
        s->normal[k] = -along;
        s->radiance[k] = 1.0;
    }
    return s;
}

static double tangent_of(const fixture *f, int slice, int side)
{
    const double nx = dot(f->n, f->slice[slice].tangent), ny = dot(f->n, f->p.v);
    return (side ? 1.0 : -1.0) * nx / sqrt(nx * nx + ny * ny);
}

static void draw_fixture(fixture *f, int slices, int orthographic)
{
    open_fixture(f, slices, -0.2, orthographic);
    for (int i = 0; i < slices; ++i) {
        for (int side = 0; side < 2; ++side) {
            const double c0 = tangent_of(f, i, side);
            for (int k = 0; k < SAMPLES; ++k) {
                const double    r = draw(0.0, 1.0);
                const double    c = c0 + (1.0 - c0) * r * r * r - (k == 2 ? 0.3 * draw(0.0, 1.0 + c0) : 0.0);
                methods_sample *s = put_sample(f, i, side, fmin(c, 0.98), k == 3 ? 4.5 : (k + 1) * draw(0.5, 1.0));
                s->skip = draw(0.0, 1.0) < 0.1;
                draw_unit(s->normal);
                for (int m = 0; m < 3; ++m) {
                    s->radiance[m] = draw(-0.1, 3.0);
                }
            }
        }
    }
}

/* --- the definitions, direction by direction --------------------------------------------------------------------- */

/* A direction of a slice: solid angle, what is seen there. */
typedef struct node {
    double w[3], weight, cosine, light[3];
    int    free, slice, group; /* group: of 8 sectors, counted through all slices */
} node;

typedef struct truth {
    node   node[16384];
    int    count, slices;
    double full, open, ratio;
} truth;

static truth g_truth;

/* What a sample hides: directions of its side with low < cosine <= high; the light it gives them. */
typedef struct cover {
    double        low, high, light[3];
    const double *normal; /* lit where w . normal < 0 only, or NULL */
    int           side;
} cover;

typedef struct covers {
    cover  item[2 * SAMPLES];
    int    count;
    double nx, ny, point[METHODS_SECTORS]; /* direction by which a sector is judged */
} covers;

/* The sectors' map in the form of its other publication: relative to the normal, V at -gamma. (ANCHORS.md 3.3) */
static double published_cdf(double nx, double ny, double t)
{
    const double n = -atan2(nx, ny), phi = t + n, c = cos(n), s = sin(n), d = 4.0 * (c + n * s);
    return phi < n ? (c + cos(n - 2.0 * phi) + (2.0 * phi + PI) * s) / d :
                     (3.0 * c - cos(n - 2.0 * phi) + (4.0 * n - 2.0 * phi + PI) * s) / d;
}

static double published_inverse(double nx, double ny, double u)
{
    double low = atan2(nx, ny) - 0.5 * PI, high = low + PI;
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        *(published_cdf(nx, ny, middle) < u ? &low : &high) = middle;
    }
    return low;
}

/* First of the covers that hides the direction t; -1: none. */
static int hider(const covers *list, int count, double t)
{
    for (int i = 0; i < count; ++i) {
        const cover *c = &list->item[i];
        if ((t < 0.0) == c->side && cos(t) > c->low && cos(t) <= c->high) {
            return i;
        }
    }
    return -1;
}

/* Does the last cover hide something new? */
static int is_fresh(const methods_options *o, const covers *list)
{
    const int last = list->count - 1;
    if (o->estimator != METHODS_BITMASK) {
        for (int i = 0; i < last; ++i) {
            if (list->item[i].side == list->item[last].side && list->item[i].high >= list->item[last].high) {
                return 0;
            }
        }
        return 1;
    }
    for (int k = 0; k < METHODS_SECTORS; ++k) {
        if (hider(list, list->count, list->point[k]) == last) {
            return 1;
        }
    }
    return 0;
}

/* Radiance of a sample, its facing filter included. */
static void lamp(const methods_options *o, const methods_sample *s, const double along[3], double accepted[3])
{
    double top = 0.0, t = 1.0;
    for (int k = 0; k < 3; ++k) {
        top = fmax(top, s->radiance[k]);
    }
    if (o->facing == METHODS_FACING_FILTER) {
        t = fmin(fmax((-dot(s->normal, along) + 0.1) / 0.2, 0.0), 1.0);
        t = t * t * (3.0 - 2.0 * t);
    }
    for (int k = 0; k < 3; ++k) {
        const double light = fmax(s->radiance[k], 0.0) * (o->firefly > 0.0 && top > o->firefly ? o->firefly / top : 1.0);
        accepted[k] += t * (light - accepted[k]);
    }
}

/* The cover of a sample; 0: it hides nothing. */
static int cover_of(const methods_options *o, const fixture *f, double c0, const methods_sample *s, double along[3],
                    cover *out)
{
    double h[3], back[3], ray[3], distance;
    for (int k = 0; k < 3; ++k) {
        h[k] = s->position[k] - f->p.position[k];
    }
    distance = sqrt(dot(h, h));
    unit(h, along);
    out->low = c0;
    if (o->occluder == METHODS_THICK) {
        unit(s->position, ray);
        for (int k = 0; k < 3; ++k) {
            back[k] = h[k] + o->thickness * (f->p.orthographic ? (k == 2) : ray[k]);
        }
        out->low = fmax(c0, dot(back, f->p.v) / sqrt(dot(back, back)));
    }
    const double fade = o->reach > 0.0 ? fmin(fmax((1.0 - distance / o->reach) / o->falloff, 0.0), 1.0) : 1.0;
    out->high = out->low + fade * (dot(along, f->p.v) - out->low);
    out->normal = o->facing == METHODS_FACING_HALF_SPACE ? s->normal : NULL;
    return out->high > out->low && dot(along, f->n) > o->bias;
}

static void cover_side(const methods_options *o, const fixture *f, int slice, int side, covers *list)
{
    const methods_slice *sl = &f->slice[slice];
    double               accepted[3] = {0.0, 0.0, 0.0}, along[3];
    for (int i = 0; i < sl->count[side]; ++i) {
        cover *c = &list->item[list->count];
        if (sl->sample[side][i].skip || !cover_of(o, f, tangent_of(f, slice, side), &sl->sample[side][i], along, c)) {
            continue;
        }
        c->side = side;
        ++list->count;
        if (!is_fresh(o, list)) {
            --list->count;
            continue;
        }
        lamp(o, &sl->sample[side][i], along, accepted);
        memcpy(c->light, accepted, sizeof c->light);
    }
}

/* Weight of a side between the horizons a and b. */
static double side_weight(const covers *list, int side, double a, double b, const double *s)
{
    return side ? gauss_energy(list->nx, list->ny, -acos(a), -acos(b), s) :
                  gauss_energy(list->nx, list->ny, acos(b), acos(a), s);
}

/* The heuristic: one cover, of the mean radiance E/W that its history leaves. */
static void cover_side_heuristic(const methods_options *o, const fixture *f, int slice, int side, covers *list)
{
    const methods_slice *sl = &f->slice[slice];
    const double         c0 = tangent_of(f, slice, side), k_eff = 1.0 - pow(1.0 - o->decay, 8.0 / o->steps);
    double               accepted[3] = {0.0, 0.0, 0.0}, along[3], light[3] = {0.0, 0.0, 0.0}, weight = 0.0, c = c0;
    for (int i = 0; i < sl->count[side]; ++i) {
        const methods_sample *s = &sl->sample[side][i];
        cover                 next = {.high = c0};
        if (s->skip) {
            continue;
        }
        const int    solid = cover_of(o, f, c0, s, along, &next);
        const double seen[2] = {next.normal ? dot(s->normal, sl->tangent) : 0.0, next.normal ? dot(s->normal, f->p.v) : 0.0};
        if (next.high > c && solid) {
            lamp(o, s, along, accepted);
            for (int k = 0; k < 3; ++k) {
                light[k] += accepted[k] * side_weight(list, side, c, next.high, next.normal ? seen : NULL);
            }
            weight += side_weight(list, side, c, next.high, NULL);
            c = next.high;
        } else {
            const double lower = fmax(c0, c + k_eff * (fmin(next.high, c) - c));
            const double whole = side_weight(list, side, c0, c, NULL);
            const double part = whole > 0.0 ? side_weight(list, side, c0, lower, NULL) / whole : 0.0;
            for (int k = 0; k < 3; ++k) {
                light[k] *= part;
            }
            weight *= part;
            c = lower;
        }
    }
    cover *all = &list->item[list->count++];
    all->low = c0;
    all->high = c;
    all->normal = NULL;
    all->side = side;
    for (int k = 0; k < 3; ++k) {
        all->light[k] = weight > 0.0 ? light[k] / weight : 0.0;
    }
}

/* Angles between which nothing changes, of a slice: returns their number. */
static int pieces(const methods_options *o, const fixture *f, int slice, const covers *list, double cut[128])
{
    const double start = atan2(list->nx, list->ny) - 0.5 * PI;
    int          n = 0;
    cut[n++] = start;
    cut[n++] = start + PI;
    cut[n++] = 0.0;
    for (int k = 1; k < METHODS_SECTORS && o->estimator == METHODS_BITMASK; ++k) {
        cut[n++] = published_inverse(list->nx, list->ny, (double)k / METHODS_SECTORS);
    }
    for (int i = 0; i < list->count && o->estimator != METHODS_BITMASK; ++i) {
        const cover *c = &list->item[i];
        cut[n++] = (c->side ? -1.0 : 1.0) * acos(c->high);
        if (c->normal) {
            const double s[2] = {dot(c->normal, f->slice[slice].tangent), dot(c->normal, f->p.v)};
            plane_ends(s, cut + n);
            n += 2;
        }
    }
    sort(cut, n);
    return n;
}

/* Nodes of one piece; t: the direction by which the piece is judged. */
static void add_piece(const fixture *f, int slice, const covers *list, double a, double b, double t, int group, truth *out)
{
    const int     first = hider(list, list->count, t);
    const cover  *c = first < 0 ? NULL : &list->item[first];
    const double *d = f->slice[slice].tangent;
    double        judged[3];
    for (int k = 0; k < 3; ++k) {
        judged[k] = sin(t) * d[k] + cos(t) * f->p.v[k];
    }
    for (int g = 0; g < GAUSS; ++g) {
        const double at = a + (b - a) * g_node[g];
        node        *n = &out->node[out->count++];
        for (int k = 0; k < 3; ++k) {
            n->w[k] = sin(at) * d[k] + cos(at) * f->p.v[k];
            n->light[k] = c && (!c->normal || dot(judged, c->normal) < 0.0) ? c->light[k] : 0.0;
        }
        n->weight = (b - a) * g_weight[g] * fabs(sin(at));
        n->cosine = dot(n->w, f->n);
        n->free = !c;
        n->slice = slice;
        n->group = 4 * slice + group;
        out->full += n->weight * n->cosine;
        out->open += c ? 0.0 : n->weight * n->cosine;
    }
}

static void truth_slice(const methods_options *o, const fixture *f, int slice, truth *out)
{
    covers list = {.count = 0};
    double cut[128];
    list.nx = dot(f->n, f->slice[slice].tangent);
    list.ny = dot(f->n, f->p.v);
    for (int k = 0; k < METHODS_SECTORS; ++k) {
        const double u = (k + 1.0 - f->slice[slice].jitter) / METHODS_SECTORS;
        list.point[k] = published_inverse(list.nx, list.ny, u);
    }
    for (int side = 0; side < 2; ++side) {
        if (o->occluder == METHODS_HEURISTIC) {
            cover_side_heuristic(o, f, slice, side, &list);
        } else {
            cover_side(o, f, slice, side, &list);
        }
    }
    const int    n = pieces(o, f, slice, &list, cut);
    const double start = atan2(list.nx, list.ny) - 0.5 * PI, end = start + PI;
    for (int i = 0; i + 1 < n; ++i) {
        const double a = fmax(cut[i], start), b = fmin(cut[i + 1], end), t = 0.5 * (a + b);
        const int    sector = (int)fmin(floor(METHODS_SECTORS * published_cdf(list.nx, list.ny, t)), METHODS_SECTORS - 1.0);
        if (b > a) {
            add_piece(f, slice, &list, a, b, o->estimator == METHODS_BITMASK ? list.point[sector] : t, sector / 8, out);
        }
    }
}

static void truth_of(const methods_options *o, const fixture *f, truth *out)
{
    out->count = 0;
    out->slices = f->p.slices;
    out->full = out->open = 0.0;
    for (int i = 0; i < f->p.slices; ++i) {
        truth_slice(o, f, i, out);
    }
    out->ratio = o->seed_compat & METHODS_SLICE_MEAN ? out->slices : out->full;
}

/* --- environments ------------------------------------------------------------------------------------------------ */

#define GRID_X 3
#define GRID_Y 2
#define GRID_Z 4

static double              g_grid[GRID_X * GRID_Y * GRID_Z][9][3];
static double              g_slope[3][9][3]; /* probes are linear in the position, so that trilinear is exact. per m */
static methods_probes      g_probes = {{GRID_X, GRID_Y, GRID_Z}, {-3.0, -2.0, 1.0}, {2.5, 3.0, 2.0}, NULL};
static methods_environment g_env;

/* A function of everything that a hook gets, never negative. */
static void lookup(void *user, const double position[3], const double direction[3], double cos_aperture, double rgb[3])
{
    const double size = *(const double *)user;
    for (int c = 0; c < 3; ++c) {
        rgb[c] = size * (1.3 + sin(3.0 * direction[c] + direction[0] * direction[1])) + 0.01 * fabs(position[c]) +
                 0.2 * cos_aperture;
    }
}

static void linear_sh(const double position[3], double out[9][3])
{
    double at[3];
    for (int a = 0; a < 3; ++a) {
        const double end = g_probes.origin[a] + g_probes.step[a] * (g_probes.count[a] - 1);
        at[a] = fmin(fmax(position[a], g_probes.origin[a]), end);
    }
    for (int k = 0; k < 27; ++k) {
        out[k / 3][k % 3] = g_env.sh[k / 3][k % 3];
        for (int a = 0; a < 3; ++a) {
            out[k / 3][k % 3] += g_slope[a][k / 3][k % 3] * at[a];
        }
    }
}

static void draw_environment(void)
{
    static double user;
    double        axis[3], e1[3], e2[3];
    user = draw(0.5, 2.0);
    draw_unit(axis);
    kernel_frame(axis, e1, e2);
    for (int k = 0; k < 3; ++k) {
        g_env.color[k] = draw(0.1, 2.0);
        g_env.eye[k] = draw(-2.0, 2.0);
        g_env.to_world[k] = e1[k];
        g_env.to_world[3 + k] = e2[k];
        g_env.to_world[6 + k] = axis[k];
    }
    for (int k = 0; k < 27; ++k) {
        g_env.sh[k / 3][k % 3] = k < 3 ? draw(4.0, 6.0) : draw(-0.5, 0.5); /* bright enough never to be clamped */
        for (int a = 0; a < 3; ++a) {
            g_slope[a][k / 3][k % 3] = draw(-0.02, 0.02);
        }
    }
    for (int i = 0; i < GRID_X * GRID_Y * GRID_Z; ++i) {
        const int    at[3] = {i % GRID_X, i / GRID_X % GRID_Y, i / GRID_X / GRID_Y};
        const double position[3] = {g_probes.origin[0] + g_probes.step[0] * at[0],
                                    g_probes.origin[1] + g_probes.step[1] * at[1],
                                    g_probes.origin[2] + g_probes.step[2] * at[2]};
        linear_sh(position, g_grid[i]);
    }
    g_probes.sh = (const double(*)[9][3])g_grid;
    g_env.probes = &g_probes;
    g_env.lookup = lookup;
    g_env.user = &user;
}

static void world_direction(const double d[3], double out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] = dot(g_env.to_world + 3 * k, d);
    }
}

/* Radiance of bands low to high of an SH sky, in a direction of the passes' space. */
static void sky_radiance(const double sh[9][3], int low, int high, const double d[3], double rgb[3])
{
    double w[3], y[9];
    world_direction(d, w);
    methods_sh_basis(w, y);
    for (int c = 0; c < 3; ++c) {
        rgb[c] = 0.0;
        for (int k = low * low; k < (high + 1) * (high + 1); ++k) {
            rgb[c] += y[k] * sh[k][c];
        }
    }
}

/* E/pi through a cone about an axis that is the normal too, by quadrature. t: cosine of its half angle. */
static void cone_irradiance(const double sh[9][3], int low, int high, const double axis[3], double t, double rgb[3])
{
    double e1[3], e2[3], light[3];
    kernel_frame(axis, e1, e2);
    memset(rgb, 0, 3 * sizeof *rgb);
    for (int i = 0; i < GAUSS * 8; ++i) {
        const double c = t + (1.0 - t) * g_node[i / 8], s = sqrt(1.0 - c * c), phi = 2.0 * PI * (i % 8) / 8.0;
        double       w[3];
        for (int k = 0; k < 3; ++k) {
            w[k] = s * cos(phi) * e1[k] + s * sin(phi) * e2[k] + c * axis[k];
        }
        sky_radiance(sh, low, high, w, light);
        for (int k = 0; k < 3; ++k) {
            rgb[k] += light[k] * c * (1.0 - t) * g_weight[i / 8] * (2.0 * PI / 8.0) / PI;
        }
    }
}

/* --- outputs from the definitions -------------------------------------------------------------------------------- */

/* By what directions count in the bent vector. */
static double bent_weight(const methods_options *o, const node *n)
{
    return o->seed_compat & METHODS_UNIFORM_BENT ? 1.0 : n->cosine;
}

static void expect_march(const methods_options *o, const fixture *f, const truth *t, methods_result *e)
{
    const methods_result none = {0};
    double               y[9];
    *e = none;
    const double ao = t->open / t->ratio, lift = pow(ao, o->ao_exponent - 1.0);
    e->ao = pow(ao, o->ao_exponent);
    e->full = t->full;
    e->open = t->open;
    for (int i = 0; i < t->count; ++i) {
        const node *n = &t->node[i];
        methods_sh_basis(n->w, y);
        e->uniform_ao += n->free ? 0.5 * n->weight / t->slices : 0.0;
        for (int k = 0; k < 3; ++k) {
            e->bent[k] += n->free ? n->w[k] * bent_weight(o, n) * n->weight / t->slices * lift : 0.0;
            e->near[k] += n->light[k] * n->cosine * n->weight / t->ratio * o->near_intensity * (1.0 - f->p.f0[k]);
        }
        for (int k = 0; k < 4; ++k) {
            const double measure = PI * y[k] * n->weight / (k ? t->ratio : t->slices);
            for (int c = 0; c < 3; ++c) {
                e->sh[k][c] += measure * n->light[c] * o->near_intensity;
            }
            e->sh[k][3] += n->free ? measure : 0.0;
        }
    }
}

/* Free groups of sectors: their light in the mean direction of each. */
static void expect_free_bits(const methods_options *o, const double sh[9][3], const double position[3], const double normal[3],
                             const truth *t, double rgb[3])
{
    double energy[4 * SLICES] = {0.0}, bent[4 * SLICES][3] = {{0.0}}, axis[3], w[3], light[3];
    for (int i = 0; i < t->count; ++i) {
        const node *n = &t->node[i];
        for (int k = 0; k < 4 && n->free; ++k) {
            *(k < 3 ? &bent[n->group][k] : &energy[n->group]) += n->cosine * n->weight * (k < 3 ? n->w[k] : 1.0);
        }
        if (n->free && sh) {
            sky_radiance(sh, 0, 1, n->w, light);
            for (int c = 0; c < 3; ++c) {
                rgb[c] += light[c] * n->cosine * n->weight / t->ratio;
            }
        }
    }
    for (int g = 0; g < 4 * t->slices; ++g) {
        if (energy[g] <= 0.0) {
            continue;
        }
        for (int k = 0; k < 3; ++k) {
            w[k] = bent[g][k] / energy[g];
        }
        lean(w, normal, axis);
        if (sh) {
            sky_radiance(sh, 2, o->sh_order, axis, light);
        } else {
            world_direction(axis, w);
            lookup(g_env.user, position, w, 1.0, light);
        }
        for (int c = 0; c < 3; ++c) {
            rgb[c] += energy[g] * light[c] / t->ratio;
        }
    }
}

static void expect_sh(const methods_options *o, const double sh[9][3], const double n[3], const double axis[3],
                      double share, double cone, const truth *t, const methods_result *e, double rgb[3])
{
    double band_0[3], light[3];
    if (o->far_visibility == METHODS_BENT) { /* bands 0 and 1: what comes through the free directions */
        const double lift = e->ao * t->ratio / t->open, once = lift / t->slices, shared = lift / t->ratio;
        for (int i = 0; i < t->count; ++i) {
            const node *at = &t->node[i];
            sky_radiance(sh, 0, 0, at->w, band_0);
            sky_radiance(sh, 1, 1, at->w, light);
            for (int c = 0; c < 3 && at->free; ++c) {
                rgb[c] += (band_0[c] * at->cosine * shared + light[c] * bent_weight(o, at) * once) * at->weight;
            }
        }
        cone_irradiance(sh, 2, o->sh_order, axis, cone, light);
    } else {
        const int through = o->far_visibility == METHODS_CONE;
        cone_irradiance(sh, 0, o->sh_order, o->far_visibility == METHODS_AO ? n : axis, through ? cone : 0.0, light);
        share = through ? 1.0 : share;
    }
    for (int c = 0; c < 3; ++c) {
        rgb[c] += light[c] * (o->far_visibility == METHODS_BENT ? 1.0 : share);
    }
}

static void expect_far(const methods_options *o, const fixture *f, const truth *t, methods_result *e)
{
    const double ao = e->ao, cone = o->seed_compat & METHODS_CONE_RELATION ? 1.0 - ao : sqrt(1.0 - ao);
    const double share = o->seed_compat & METHODS_F0_AO ? ao * (1.0 + 0.5 * pow(1.0 - ao, 0.75)) : ao;
    double       sh[9][3], position[3], axis[3], w[3], rgb[3] = {0.0, 0.0, 0.0};
    lean(e->bent, f->n, axis);
    world_direction(f->p.position, position);
    for (int k = 0; k < 3; ++k) {
        position[k] += g_env.eye[k];
    }
    memcpy(sh, g_env.sh, sizeof sh);
    if (o->environment == METHODS_PROBES) {
        linear_sh(position, sh);
    }
    const int has_sh = o->environment == METHODS_SH || o->environment == METHODS_PROBES;
    if (o->environment == METHODS_CONSTANT) {
        for (int c = 0; c < 3; ++c) {
            rgb[c] = share * g_env.color[c];
        }
    } else if (o->far_visibility == METHODS_FREE_BITS) {
        expect_free_bits(o, has_sh ? (const double(*)[3])sh : NULL, position, f->n, t, rgb);
    } else if (has_sh) {
        expect_sh(o, (const double(*)[3])sh, f->n, axis, share, cone, t, e, rgb);
    } else if (o->environment != METHODS_ENVIRONMENT_NONE) {
        world_direction(o->far_visibility == METHODS_AO ? f->n : axis, w);
        lookup(g_env.user, position, w, cone, rgb);
        for (int c = 0; c < 3; ++c) {
            rgb[c] *= o->far_visibility == METHODS_BENT ? ao : share;
        }
    }
    for (int c = 0; c < 3; ++c) {
        e->far[c] = rgb[c] * o->far_intensity * (1.0 - f->p.f0[c]);
    }
}

static void expect_light(const methods_options *o, const fixture *f, const truth *t, methods_result *e)
{
    const double r = o->roughness > 0.0 ? o->roughness : f->p.roughness, x = fmin(fmax((r - 0.5) / 0.3, 0.0), 1.0);
    const double rough = x * x * (3.0 - 2.0 * x), lobe = acos(exp(-r * r * log(10.0))), nv = dot(f->n, f->p.v);
    double       mirror[3], axis[3];
    expect_far(o, f, t, e);
    lean(e->bent, f->n, axis);
    for (int k = 0; k < 3; ++k) {
        const double a = f->p.albedo[k], v = e->ao;
        const double cubic = ((2.0404 * a - 0.3324) * v * v * v) + (0.6417 - 4.7951 * a) * v * v + (2.7552 * a + 0.6903) * v;
        mirror[k] = 2.0 * nv * f->n[k] - f->p.v[k];
        e->cone[k] = axis[k];
        e->multi_bounce[k] = o->bounce == METHODS_CUBIC ? fmax(v, cubic) : v / (1.0 - a + a * v);
        e->irradiance[k] = e->near[k] + e->far[k];
        e->composite[k] = f->p.direct[k] + a * e->irradiance[k];
    }
    e->cone[3] = o->seed_compat & METHODS_CONE_RELATION ? 1.0 - e->ao : sqrt(1.0 - e->ao);
    const double seen = methods_caps(asin(sqrt(e->ao)), lobe, acos(fmin(dot(axis, mirror), 1.0)));
    const double open = methods_caps(0.5 * PI, lobe, acos(fmin(nv, 1.0)));
    e->specular_occlusion = (1.0 - rough) * fmin(seen / open, 1.0) + rough * e->ao;
}

/* --- comparison of all outputs ----------------------------------------------------------------------------------- */

#define OUTPUT(name, count) {#name, offsetof(methods_result, name), count}
static const struct output { const char *name; size_t offset; int count; } k_outputs[] = {
    OUTPUT(ao, 1), OUTPUT(uniform_ao, 1), OUTPUT(bent, 3), OUTPUT(cone, 4), OUTPUT(near, 3), OUTPUT(sh, 16), OUTPUT(far, 3),
    OUTPUT(irradiance, 3), OUTPUT(specular_occlusion, 1), OUTPUT(multi_bounce, 3), OUTPUT(composite, 3)};
#define OUTPUTS ((int)(sizeof k_outputs / sizeof k_outputs[0]))

static double difference(const methods_result *a, const methods_result *b, int output)
{
    const double *x = (const double *)((const char *)a + k_outputs[output].offset);
    const double *y = (const double *)((const char *)b + k_outputs[output].offset);
    double        worst = 0.0;
    for (int i = 0; i < k_outputs[output].count; ++i) {
        worst = fabs(x[i] - y[i]) <= worst ? worst : fabs(x[i] - y[i]); /* NaN is worst */
    }
    return worst;
}

static void describe(const methods_options *o)
{
    print_message("estimator %d occluder %d facing %d reach %g environment %d order %d visibility %d compat %u bounce %d\n",
                  o->estimator, o->occluder, o->facing, o->reach, o->environment, o->sh_order, o->far_visibility,
                  o->seed_compat, o->bounce);
}

/* Worst of all outputs so far. */
static void check_outputs(const methods_options *o, const fixture *f, const methods_result *expected, double worst[OUTPUTS])
{
    methods_result r;
    methods_light(o, &f->p, &r);
    for (int i = 0; i < OUTPUTS; ++i) {
        const double d = difference(&r, expected, i);
        worst[i] = d <= worst[i] ? worst[i] : d;
        if (!(d <= 1e-6)) {
            describe(o);
            fail_msg("%s is off by %g", k_outputs[i].name, d);
        }
    }
}

/* --- every legal combination ------------------------------------------------------------------------------------- */

static methods_options plain_options(int estimator, int occluder)
{
    const methods_options o = {.estimator = estimator, .occluder = occluder, .facing = METHODS_FACING_NONE,
                               .attenuation = METHODS_QUADRATIC, .environment = METHODS_ENVIRONMENT_NONE,
                               .far_visibility = METHODS_BENT, .sh_order = 2,
                               .bounce = METHODS_CLOSED, .steps = SAMPLES, .falloff = 0.6, .bias = 0.001, .angle_bias = 0.1,
                               .multiplier = 1.0, .thickness = 0.5, .decay = 0.1, .near_intensity = 1.0,
                               .far_intensity = 1.0, .ao_exponent = 1.0, .env = &g_env};
    return o;
}

static void season(methods_options *o, fixture *f)
{
    o->firefly = 1.5;
    o->near_intensity = 2.0;
    o->far_intensity = 0.7;
    o->ao_exponent = 1.6;
    o->roughness = 0.45;
    f->p.f0[0] = 0.04;
    f->p.f0[1] = 0.5;
    f->p.f0[2] = 0.9;
}

static int legal_far(int estimator, int environment, int visibility)
{
    const int cosine = estimator == METHODS_HORIZON || estimator == METHODS_BITMASK;
    const int has_sh = environment == METHODS_SH || environment == METHODS_PROBES;
    if (environment <= METHODS_CONSTANT) {
        return visibility == METHODS_BENT; /* the option has no effect */
    }
    return (cosine || visibility == METHODS_AO) && (visibility != METHODS_CONE || has_sh) &&
           (visibility != METHODS_FREE_BITS || estimator == METHODS_BITMASK);
}

/* Compares all outputs; returns how many pixels it compared. */
typedef int (*far_check)(const methods_options *o, const fixture *f, double worst[OUTPUTS]);

/* Calls check for every legal fallback. */
static int for_all_far(methods_options o, const fixture *f, far_check check, double worst[OUTPUTS])
{
    static const unsigned compat[] = {0, METHODS_SLICE_MEAN, METHODS_CONE_RELATION, METHODS_F0_AO, METHODS_UNIFORM_BENT};
    const unsigned        before = o.seed_compat;
    int                   count = 0;
    for (int i = METHODS_ENVIRONMENT_NONE; i <= METHODS_HOOK; ++i) {
        for (int k = 0; k < 5 * 2 * 5; ++k) {
            o.environment = i;
            o.far_visibility = METHODS_BENT + k / 10;
            o.sh_order = 1 + k / 5 % 2;
            o.seed_compat = before | compat[k % 5];
            o.bounce = 1 + k % 2;
            const int order_matters = i == METHODS_SH || i == METHODS_PROBES;
            const int horizons_matter = o.seed_compat & METHODS_UNIFORM_BENT && o.estimator != METHODS_HORIZON;
            if ((o.sh_order == 2 || order_matters) && !horizons_matter && legal_far(o.estimator, i, o.far_visibility)) {
                count += check(&o, f, worst);
            }
        }
    }
    return count;
}

static int check_far(const methods_options *o, const fixture *f, double worst[OUTPUTS])
{
    truth         *now = &g_truth;
    methods_result expected;
    now->ratio = o->seed_compat & METHODS_SLICE_MEAN ? now->slices : now->full;
    if (now->open / now->ratio > 1.0) {
        return 0; /* the mean over slices has no bound; a root of 1 - ao does not exist there */
    }
    expect_march(o, f, now, &expected);
    expect_light(o, f, now, &expected);
    check_outputs(o, f, &expected, worst);
    return 1;
}

/* Pixels of one march configuration: several without a fallback, one with each. */
static int check_march(methods_options o, int seasoned, double worst[OUTPUTS])
{
    fixture *f = &g_fixture;
    int      count = 0;
    for (int trial = 0; trial < 4; ++trial) {
        draw_fixture(f, 1 + trial % 3, trial == 3);
        draw_environment();
        if (seasoned) {
            season(&o, f);
        }
        truth_of(&o, f, &g_truth);
        if (trial == 1) {
            count = for_all_far(o, f, check_far, worst);
        } else {
            check_far(&o, f, worst);
        }
    }
    return count;
}

static void every_output_meets_its_definition_in_every_combination(void **state)
{
    double worst[OUTPUTS] = {0.0};
    int    count = 0;
    (void)state;
    g_seed = 1;
    for (int i = 0; i < 2 * 2 * 3 * 2 * 2; ++i) {
        const int       estimator = i & 1 ? METHODS_BITMASK : METHODS_HORIZON;
        const int       other = estimator == METHODS_BITMASK ? METHODS_THICK : METHODS_HEURISTIC;
        methods_options o = plain_options(estimator, i & 2 ? other : METHODS_HEIGHT_FIELD);
        o.reach = i & 4 ? 4.0 : 0.0;
        o.thickness = i & 4 ? 2.0 : 0.5; /* some end below the tangent plane where they fade */
        o.facing = 1 + i / 16;
        count += check_march(o, i >> 3 & 1, worst);
    }
    print_message("%d combinations of estimator, occluder, facing, reach, taste, fallback, compat; %d outputs in each; off:",
                  count, OUTPUTS);
    for (int i = 0; i < OUTPUTS; ++i) {
        print_message(" %s %.0e", k_outputs[i].name, worst[i]);
        assert_true(worst[i] <= 1e-7);
    }
    print_message("\n");
    assert_true(count > 2000);
}

/* --- hbao and hbao_plus ------------------------------------------------------------------------------------------ */

static double weight_at(const methods_options *o, const fixture *f, const methods_sample *s, double along[3])
{
    double h[3];
    for (int k = 0; k < 3; ++k) {
        h[k] = s->position[k] - f->p.position[k];
    }
    unit(h, along);
    const double r = o->reach > 0.0 ? sqrt(dot(h, h)) / o->reach : 0.0;
    return fmax(o->attenuation == METHODS_LINEAR ? 1.0 - r : 1.0 - r * r, 0.0);
}

/* HBAO's side as an integral over the horizon: every height counts with the weight of the first sample that reaches it. */
static double hbao_side(const methods_options *o, const fixture *f, int slice, int side)
{
    const methods_slice *sl = &f->slice[slice];
    double               cut[SAMPLES + 1], height[SAMPLES], weight[SAMPLES], along[3], sum = 0.0;
    int                  n = 0;
    for (int i = 0; i < sl->count[side]; ++i) {
        if (!sl->sample[side][i].skip) {
            weight[n] = weight_at(o, f, &sl->sample[side][i], along);
            height[n] = dot(along, f->p.v);
            cut[n + 1] = height[n];
            ++n;
        }
    }
    const double start = tangent_of(f, slice, side) + o->angle_bias;
    cut[0] = start;
    sort(cut, n + 1);
    for (int i = 0; i < n; ++i) {
        int first = 0;
        while (first < n && height[first] < cut[i + 1]) {
            ++first;
        }
        if (first < n) { /* else the start is above all */
            sum += fmax(cut[i + 1] - fmax(cut[i], start), 0.0) * weight[first];
        }
    }
    return sum;
}

static double expect_hbao(const methods_options *o, const fixture *f)
{
    double sum = 0.0, along[3];
    for (int i = 0; i < 2 * f->p.slices; ++i) {
        const methods_slice *sl = &f->slice[i / 2];
        if (o->estimator == METHODS_HBAO) {
            sum += hbao_side(o, f, i / 2, i % 2);
        }
        for (int k = 0; k < sl->count[i % 2] && o->estimator == METHODS_HBAO_PLUS; ++k) {
            const double weight = sl->sample[i % 2][k].skip ? 0.0 : weight_at(o, f, &sl->sample[i % 2][k], along);
            if (weight > 0.0) {
                sum += 2.0 * o->multiplier / o->steps * weight * fmin(fmax(dot(along, f->n) - o->angle_bias, 0.0), 1.0);
            }
        }
    }
    return fmax(1.0 - sum / (2.0 * f->p.slices), 0.0);
}

static int check_hbao(const methods_options *o, const fixture *f, double worst[OUTPUTS])
{
    const methods_result none = {0};
    methods_result       e = none;
    e.ao = pow(expect_hbao(o, f), o->ao_exponent);
    expect_far(o, f, &g_truth, &e);
    for (int k = 0; k < 3; ++k) {
        const double a = f->p.albedo[k], v = e.ao;
        e.multi_bounce[k] = methods_multi_bounce(o->bounce, v, a);
        e.irradiance[k] = e.far[k];
        e.composite[k] = f->p.direct[k] + a * e.far[k];
    }
    check_outputs(o, f, &e, worst);
    return 1;
}

static void hbao_and_hbao_plus_meet_their_definitions_in_every_combination(void **state)
{
    double worst[OUTPUTS] = {0.0}, most = 0.0;
    int    count = 0;
    (void)state;
    g_seed = 2;
    for (int i = 0; i < 2 * 2 * 2 * 2 * 16; ++i) {
        methods_options o = plain_options(i & 1 ? METHODS_HBAO_PLUS : METHODS_HBAO, METHODS_HEIGHT_FIELD);
        draw_fixture(&g_fixture, 1 + i / 16 % 3, i / 16 % 3 == 1);
        draw_environment();
        o.reach = i & 2 ? 4.0 : 0.0;
        o.attenuation = i & 4 ? METHODS_LINEAR : METHODS_QUADRATIC;
        if (i & 8) {
            season(&o, &g_fixture);
            o.multiplier = 2.5;
            o.angle_bias = 0.25;
        }
        const int legal = for_all_far(o, &g_fixture, check_hbao, worst);
        count += i < 16 ? legal : 0; /* the others are more pixels of the same */
    }
    for (int i = 0; i < OUTPUTS; ++i) {
        most = fmax(most, worst[i]);
    }
    print_message("%d combinations of hbao, hbao_plus, reach, attenuation, taste, fallback: off by at most %.0e\n", count,
                  most);
    assert_true(most <= 1e-9 && count > 400);
}

/* Samples anywhere on the sphere: half of them are below the surface, the others have the mean sine 1/2. */
static void hbao_plus_measures_a_mean_and_stays_within_its_bound(void **state)
{
    methods_options o = plain_options(METHODS_HBAO_PLUS, METHODS_HEIGHT_FIELD);
    methods_result  r;
    double          mean = 0.0;
    (void)state;
    g_seed = 3;
    o.angle_bias = 1e-9;
    for (int trial = 0; trial < 60; ++trial) {
        open_fixture(&g_fixture, SLICES, 0.0, 0);
        for (int i = 0; i < 2 * SLICES * SAMPLES; ++i) {
            double          w[3];
            methods_sample *s = put_sample(&g_fixture, i / 2 / SAMPLES, i / SAMPLES % 2, 0.0, 1.0);
            draw_unit(w);
            for (int k = 0; k < 3; ++k) {
                s->position[k] = g_fixture.p.position[k] + w[k];
            }
        }
        methods_light(&o, &g_fixture.p, &r);
        mean += r.ao / 60.0;
        for (double m = 0.1; m < 20.0; m *= 2.0) {
            methods_options much = o;
            much.multiplier = m;
            much.angle_bias = 0.3;
            methods_light(&much, &g_fixture.p, &r);
            assert_true(r.ao >= fmax(0.0, 1.0 - 2.0 * m * 0.7) && r.ao <= 1.0 && (m < 10.0 || r.ao == 0.0));
        }
    }
    print_message("hbao_plus among samples on a sphere: %.4f\n", mean);
    assert_near(mean, 0.5, 0.01);
}

/* --- arcs, the map of sectors, quantisation ---------------------------------------------------------------------- */

/* One column a name: section 16 of the formula sheet. */
static const double k_slices[][12] = { /* nx ny cB0 full cB cF AO near uniform x, y cosine x, y */
    {0, 1, 0, 1.000000000, 0, 0, 1.000000000, 0.000000000, 0.000000000, 1.000000000, 0.000000000, 0.666666667},
    {0, 1, 0, 1.000000000, .5, .25, 0.843750000, 0.156250000, 0.230934882, 0.843750000, 0.086070473, 0.619791667},
    {.6, .8, 0.600000000, 1.186100665, .6, -.6, 1.186100665, 0.000000000, 1.123501109, 0.640000000, 0.800000000,
     0.533333333},
    {.6, .8, 0.600000000, 1.186100665, .7, .1, 0.922689397, 0.263411269, 0.537815661, 0.750000000, 0.554353257, 0.565764943},
    {-.5, .3, -0.857492926, 0.815188413, .2, .9, 0.451188330, 0.364000083, -0.557376660, 0.575000000, -0.325278498,
     0.269264164},
    {.9, .05, 0.998460353, 1.413768039, .9985, -.2, 0.909676702, 0.504091337, 0.984001954, 0.481498875, 0.793276023,
     0.299006866},
    {-.8, .1, -0.992277877, 1.257153066, -.5, .995, 1.048695405, 0.208457661, -1.263370819, 0.379987500, -0.921637393,
     0.210936918}};

static void slices_meet_the_reference_vectors(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof k_slices / sizeof k_slices[0]; ++i) {
        const double         *v = k_slices[i], nx = v[0], ny = v[1];
        const methods_moments open = methods_arc(-acos(v[4]), acos(v[5])), front = methods_arc(acos(v[5]), acos(-v[2]));
        const methods_moments back = methods_arc(-acos(v[2]), -acos(v[4]));
        double                bent[2];
        methods_bent(nx, ny, &open, bent);
        assert_near(methods_full(nx, ny), v[3], 1e-9);
        assert_near(methods_energy(nx, ny, &open), v[6], 1e-9);
        assert_near(methods_energy(nx, ny, &front) + methods_energy(nx, ny, &back), v[7], 2e-9);
        assert_near(open.x, v[8], 1e-9);
        assert_near(open.y, v[9], 1e-9);
        assert_near(bent[0], v[10], 1e-9);
        assert_near(bent[1], v[11], 1e-9);
        assert_near(open.solid, 2.0 - v[4] - v[5], 1e-12);
    }
    static const double arcs[][5] = {{.6, .8, -.5, 1, 0.514994940}, {.6, -.3, .3, 1.2, 0.136172194},
                                     {.6, .2, -1.2, -.3, -0.175240427},
                                     {-.4, .7, -2, 2.5, 0.294534573}};
    for (int i = 0; i < 4; ++i) {
        const methods_moments arc = methods_arc(arcs[i][2], arcs[i][3]);
        assert_near(methods_energy(arcs[i][0], arcs[i][1], &arc), arcs[i][4], 1e-9);
    }
}

static void arcs_meet_quadrature(void **state)
{
    double worst = 0.0;
    (void)state;
    g_seed = 4;
    for (int i = 0; i < 5000; ++i) {
        const double          a = draw(-PI, PI), b = draw(-PI, PI), low = fmin(a, b), high = fmax(a, b);
        const methods_moments arc = methods_arc(low, high);
        double                sum[6] = {0.0};
        for (int k = 0; k < 2 * GAUSS; ++k) { /* |sin| bends at 0 */
            const double from = k < GAUSS ? low : fmax(low, 0.0), to = k < GAUSS ? fmin(high, 0.0) : high;
            const double t = from + (to - from) * g_node[k % GAUSS];
            const double weight = fmax(to - from, 0.0) * g_weight[k % GAUSS] * fabs(sin(t));
            const double value[6] = {1.0, sin(t), cos(t), sin(t) * sin(t), sin(t) * cos(t), cos(t) * cos(t)};
            for (int m = 0; m < 6; ++m) {
                sum[m] += weight * value[m];
            }
        }
        const double got[6] = {arc.solid, arc.x, arc.y, arc.xx, arc.xy, arc.yy};
        for (int m = 0; m < 6; ++m) {
            worst = fmax(worst, fabs(got[m] - sum[m]));
        }
    }
    print_message("arcs against quadrature: %.0e\n", worst);
    assert_true(worst <= 1e-12);
}

static void map_of_sectors_meets_quadrature_and_its_other_form_and_goes_back(void **state)
{
    double worst[3] = {0.0};
    (void)state;
    g_seed = 5;
    for (int i = 0; i < 3000; ++i) {
        const double gamma = draw(-0.499 * PI, 0.499 * PI), r = draw(0.05, 1.0), nx = r * sin(gamma), ny = r * cos(gamma);
        const double start = gamma - 0.5 * PI, end = start + PI, t = draw(start, end), x = draw(0.0, 1.0);
        const double u = methods_cdf(nx, ny, t);
        worst[0] = fmax(worst[0], fabs(u - gauss_energy(nx, ny, start, t, NULL) / gauss_energy(nx, ny, start, end, NULL)));
        worst[1] = fmax(worst[1], fabs(u - published_cdf(nx, ny, t)));
        worst[2] = fmax(worst[2], fabs(methods_cdf(nx, ny, methods_cdf_inverse(nx, ny, x)) - x));
        assert_true(methods_cdf(nx, ny, start) == 0.0 && methods_cdf(nx, ny, start + PI) == 1.0);
        assert_true(methods_cdf(nx, ny, t + 0.01) >= u);
    }
    print_message("map of sectors: against quadrature %.0e, other form %.0e, there and back %.0e\n", worst[0], worst[1],
                  worst[2]);
    assert_true(worst[0] <= 1e-12 && worst[1] <= 1e-11 && worst[2] <= 1e-12);
}

static int bits_of(uint32_t bits)
{
    int count = 0;
    for (; bits; bits &= bits - 1) {
        ++count;
    }
    return count;
}

/* 11.5: with one jitter for both edges the expected count is exact; without, rounding keeps the mean and lengths rounded up
 * do not. */
static void jittered_sectors_are_unbiased(void **state)
{
    double jittered = 0.0, middle = 0.0, up = 0.0, single = 0.0;
    (void)state;
    g_seed = 6;
    for (int i = 0; i < 4000; ++i) {
        const double a = draw(0.0, 1.0), b = draw(a, 1.0);
        double       mean = 0.0;
        for (int k = 0; k < 64; ++k) {
            mean += bits_of(methods_sectors(a, b, (k + 0.5) / 64.0)) / 32.0 / 64.0;
        }
        jittered = fmax(jittered, fabs(mean - (b - a)));
        middle += (bits_of(methods_sectors(a, b, 0.5)) / 32.0 - (b - a)) / 4000.0;
        up += (ceil(32.0 * (b - a)) / 32.0 - (b - a)) / 4000.0;
        single = fmax(single, fabs(bits_of(methods_sectors(a, b, draw(0.0, 1.0))) / 32.0 - (b - a)));
    }
    print_message("sectors: mean over jitters off by %.1e, one jitter by %.3f; no jitter: mean %+.1e, rounded up %+.3f\n",
                  jittered, single, middle, up);
    assert_true(jittered <= 1.0 / 32.0 / 64.0 + 1e-12);
    assert_true(single <= 1.0 / 32.0 && fabs(middle) <= 1e-3 && up >= 0.012);
    assert_true(methods_sectors(0.0, 1.0, 0.0) == UINT32_MAX && methods_sectors(0.0, 1.0, 0.999999) == UINT32_MAX);
    assert_true(methods_sectors(0.3, 0.3, 0.7) == 0 && methods_sectors(1.0, 1.0, 0.5) == 0);
}

static void half_space_mask_meets_a_test_per_direction(void **state)
{
    int set = 0, all = 0;
    (void)state;
    g_seed = 7;
    for (int i = 0; i < 2000; ++i) {
        const double gamma = draw(-1.5, 1.5), nx = sin(gamma), ny = cos(gamma), jitter = draw(0.0, 1.0), phi = draw(-PI, PI);
        const double s[2] = {sin(phi), cos(phi)};
        const uint32_t mask = methods_lit_sectors(nx, ny, s[0], s[1], jitter);
        for (int k = 0; k < METHODS_SECTORS; ++k) {
            const double t = published_inverse(nx, ny, (k + 1.0 - jitter) / METHODS_SECTORS);
            assert_int_equal(mask >> k & 1, s[0] * sin(t) + s[1] * cos(t) < 0.0);
        }
        set += bits_of(mask);
        all += mask == UINT32_MAX || mask == 0;
        assert_true(methods_lit_sectors(nx, ny, -nx, -ny, jitter) == UINT32_MAX &&
                    methods_lit_sectors(nx, ny, nx, ny, jitter) == 0);
    }
    assert_true(fabs(set / 64000.0 - 0.5) <= 0.02 && all < 400);
}

/* --- invariants of the estimators -------------------------------------------------------------------------------- */

/* Estimator and occluder of index 0 to 3. */
static methods_options cosine_options(int index)
{
    const int estimator = index & 1 ? METHODS_BITMASK : METHODS_HORIZON;
    const int other = index & 1 ? METHODS_THICK : METHODS_HEURISTIC;
    return plain_options(estimator, index & 2 ? other : METHODS_HEIGHT_FIELD);
}

static void whiten(fixture *f)
{
    for (int i = 0; i < 2 * f->p.slices * SAMPLES; ++i) {
        for (int k = 0; k < 3; ++k) {
            f->sample[i / 2 / SAMPLES][i / SAMPLES % 2][i % SAMPLES].radiance[k] = 1.0;
        }
    }
}

/* All light 1: what is hidden gives what it hides. Also of SH: the whole hemisphere of n. */
static void white_furnace_stays_white(void **state)
{
    double worst[4] = {0.0};
    (void)state;
    g_seed = 8;
    draw_environment();
    for (int i = 0; i < 400; ++i) {
        methods_options o = cosine_options(i % 4);
        methods_result  r;
        double          y[9], normal = 0.0;
        draw_fixture(&g_fixture, i % 7 == 0 ? SLICES : 2, i % 5 == 0);
        whiten(&g_fixture);
        o.environment = METHODS_CONSTANT;
        o.reach = i % 3 ? draw(1.0, 6.0) : 0.0;
        o.falloff = draw(0.1, 1.0);
        g_env.color[0] = g_env.color[1] = g_env.color[2] = 1.0;
        methods_light(&o, &g_fixture.p, &r);
        methods_sh_basis(g_fixture.n, y);
        for (int c = 0; c < 3; ++c) {
            worst[0] = fmax(worst[0], fabs(r.near[c] + r.far[c] - 1.0));
            worst[1] = fmax(worst[1], fabs(r.sh[0][c] + r.sh[0][3] - 2.0 * PI * y[0]));
        }
        for (int k = 1; k < 4; ++k) {
            normal += y[k] * (r.sh[k][0] + r.sh[k][3]);
            if (i % 7 == 0 && dot(g_fixture.n, g_fixture.p.v) > 0.1) {
                worst[2] = fmax(worst[2], fabs(r.sh[k][0] + r.sh[k][3] - PI * y[k]));
            }
        }
        worst[3] = fmax(worst[3], fabs(normal - PI * 3.0 / (4.0 * PI)));
    }
    print_message("white furnace: near + far - 1 %.0e; SH of the hemisphere: layer 0 %.0e, along n %.0e, 64 slices %.1e\n",
                  worst[0], worst[1], worst[3], worst[2]);
    assert_true(worst[0] <= 1e-12 && worst[1] <= 1e-12 && worst[3] <= 1e-12);
    assert_true(worst[2] <= 2e-3);
}

/* n . (visibility as a vector) = ao, whatever is hidden: invariant 5. */
static void visibility_in_sh_is_consistent_with_ao(void **state)
{
    double worst = 0.0;
    (void)state;
    g_seed = 9;
    for (int i = 0; i < 400; ++i) {
        const methods_options o = cosine_options(i % 4);
        methods_result        r;
        draw_fixture(&g_fixture, 1 + i % 4, 0);
        methods_light(&o, &g_fixture.p, &r);
        const double b[3] = {r.sh[3][3], r.sh[1][3], r.sh[2][3]};
        worst = fmax(worst, fabs(dot(g_fixture.n, b) / (0.48860251190292 * PI) - r.ao));
        assert_near(r.sh[0][3], 0.28209479177388 * 2.0 * PI * r.uniform_ao, 1e-12);
    }
    print_message("n . visibility of SH against ao: %.0e\n", worst);
    assert_true(worst <= 1e-12);
}

static void open_plane_is_open_and_bends_to_two_thirds_of_its_normal(void **state)
{
    double worst = 0.0;
    (void)state;
    g_seed = 10;
    for (int i = 0; i < 200; ++i) {
        const methods_options o = cosine_options(i % 4);
        methods_result        r;
        open_fixture(&g_fixture, SLICES, 0.1, 0);
        for (int k = 0; k < SLICES; ++k) { /* the plane itself: no occluder */
            put_sample(&g_fixture, k, k % 2, tangent_of(&g_fixture, k, k % 2), 1.0);
        }
        methods_light(&o, &g_fixture.p, &r);
        assert_true(fabs(r.ao - 1.0) <= 1e-12 && fabs(r.uniform_ao - 1.0) <= 1e-12 && r.near[0] == 0.0);
        assert_near(r.specular_occlusion, 1.0, 1e-3);
        for (int k = 0; k < 3; ++k) {
            worst = fmax(worst, fabs(r.bent[k] - 2.0 / 3.0 * g_fixture.n[k]));
        }
    }
    print_message("open plane: bent off by %.1e\n", worst);
    assert_true(worst <= 1e-3);
}

/* Invariant 12. Orthographic rays of infinite thickness end below the tangent plane, as height fields do. */
static void bitmask_of_infinite_thickness_meets_the_horizon(void **state)
{
    double side_worst = 0.0, mean_worst = 0.0;
    (void)state;
    g_seed = 11;
    for (int i = 0; i < 600; ++i) {
        const methods_options horizon = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
        methods_options       bits = plain_options(METHODS_BITMASK, i & 1 ? METHODS_THICK : METHODS_HEIGHT_FIELD);
        methods_result        h, b;
        double                mean = 0.0;
        bits.thickness = 1e9;
        draw_fixture(&g_fixture, 1, i & 1);
        if (i & 2) {
            g_fixture.slice[0].count[i >> 2 & 1] = 0; /* one side alone */
        }
        methods_light(&horizon, &g_fixture.p, &h);
        for (int k = 0; k < 64; ++k) {
            g_fixture.slice[0].jitter = (k + 0.5) / 64.0;
            methods_light(&bits, &g_fixture.p, &b);
            mean += b.ao / 64.0;
            assert_true(fabs(b.ao - h.ao) <= (i & 2 ? 1.0 : 2.0) / 32.0 + 1e-9);
            side_worst = fmax(side_worst, i & 2 ? fabs(b.ao - h.ao) : 0.0);
        }
        mean_worst = fmax(mean_worst, fabs(mean - h.ao));
    }
    print_message("bitmask, infinite thickness, against horizons: a side off by %.4f, mean over jitters by %.4f\n",
                  side_worst, mean_worst);
    assert_true(side_worst <= 1.0 / 16.0 && mean_worst <= 0.001);
}

/* 11.1: a horizon that has sunk has as much light as it hides; as a factor of the number of steps, it sinks alike. */
static void heuristic_keeps_energy_and_does_not_count_steps(void **state)
{
    static methods_sample many[65];
    double                worst = 0.0, counted = 0.0;
    (void)state;
    g_seed = 12;
    for (int i = 0; i < 2000; ++i) {
        methods_options o = plain_options(METHODS_HORIZON, METHODS_HEURISTIC);
        methods_result  r;
        draw_fixture(&g_fixture, 1, 0);
        whiten(&g_fixture);
        o.decay = draw(0.01, 0.9);
        o.reach = i & 1 ? 5.0 : 0.0;
        methods_light(&o, &g_fixture.p, &r);
        worst = fmax(worst, fabs(r.open + r.near[0] * r.full - r.full));
    }
    for (int i = 0; i < 100; ++i) {
        methods_options o = plain_options(METHODS_HORIZON, METHODS_HEURISTIC);
        methods_result  r;
        open_fixture(&g_fixture, 1, 0.3, 0);
        const double c0 = tangent_of(&g_fixture, 0, 0), high = draw(c0, 1.0), low = draw(-1.0, high);
        const double keep = pow(1.0 - 0.2, 8.0);
        const double nx = dot(g_fixture.n, g_fixture.slice[0].tangent), ny = dot(g_fixture.n, g_fixture.p.v);
        const double open = kernel_open(nx, ny, -c0, fmax(c0, low + (high - low) * keep), kernel_g);
        for (int n = 1; n <= 64; n *= 2) {
            for (int k = 0; k <= n; ++k) {
                g_fixture.slice[0].count[0] = 0;
                many[k] = *put_sample(&g_fixture, 0, 0, k ? low : high, 1.0);
            }
            g_fixture.slice[0].sample[0] = many;
            g_fixture.slice[0].count[0] = n + 1;
            o.decay = 0.2;
            o.steps = n;
            o.bias = 1e-12;
            methods_light(&o, &g_fixture.p, &r);
            counted = fmax(counted, fabs(r.open - open));
            g_fixture.slice[0].sample[0] = g_fixture.sample[0][0];
        }
    }
    print_message("heuristic: open + near - full %.0e; 1 to 64 steps differ by %.0e\n", worst, counted);
    assert_true(worst <= 1e-12 && counted <= 1e-9);
}

/* --- scenes whose answer is known over the hemisphere ------------------------------------------------------------ */

#define POINTS 40000
#define TURNS 16

static void sphere_point(int i, double w[3])
{
    const double z = 1.0 - (2.0 * i + 1.0) / POINTS, phi = i * PI * (3.0 - sqrt(5.0)), r = sqrt(1.0 - z * z);
    w[0] = r * cos(phi);
    w[1] = r * sin(phi);
    w[2] = z;
}

/* The receiver's plane meets another one of normal m: open where w . m > 0. Light 1 where w . s < 0 of the rest. */
static void corner_over_the_sphere(const fixture *f, const double m[3], const double s[3], methods_result *e)
{
    const methods_result none = {0};
    double               w[3], y[9];
    *e = none;
    for (int i = 0; i < POINTS; ++i) {
        sphere_point(i, w);
        const double cosine = dot(w, f->n), part = 4.0 * PI / POINTS;
        if (cosine <= 0.0) {
            continue;
        }
        const int free = dot(w, m) > 0.0, lit = !free && dot(w, s) < 0.0;
        methods_sh_basis(w, y);
        e->ao += free * cosine * part / PI;
        e->uniform_ao += free * part / (2.0 * PI);
        for (int k = 0; k < 3; ++k) {
            e->bent[k] += free * cosine * part / PI * w[k];
            e->near[k] += lit * cosine * part / PI;
        }
        for (int k = 0; k < 16; ++k) {
            e->sh[k / 4][k % 4] += (k % 4 < 3 ? lit : free) * y[k / 4] * part;
        }
    }
}

/* In every slice the plane m is a horizon; whether it is a front or a back one, the march has to find out. */
static void build_corner(fixture *f, const double m[3], const double s[3], double turn)
{
    open_slices(f, SLICES, turn);
    for (int i = 0; i < SLICES; ++i) {
        const double mx = dot(m, f->slice[i].tangent), my = dot(m, f->p.v);
        for (int side = 0; side < 2; ++side) {
            methods_sample *sample = put_sample(f, i, side, (side ? 1.0 : -1.0) * mx / sqrt(mx * mx + my * my), 1.0);
            memcpy(sample->normal, s, sizeof sample->normal);
        }
    }
}

static void add_result(methods_result *sum, const methods_result *r, double part)
{
    double       *x = (double *)(void *)sum;
    const double *y = (const double *)(const void *)r;
    for (size_t i = 0; i < sizeof *sum / sizeof *x; ++i) {
        x[i] += part * y[i];
    }
}

/* Invariant 7, over 1024 azimuths. Sectors have equal cosine-weighted light: their solid angles, uniform_ao and layer 0 of
 * sh, are only as fine as the sector that has the edge in it. */
static void corner_meets_points_on_the_sphere_and_its_closed_form(void **state)
{
    static const int     estimators[3] = {METHODS_HORIZON, METHODS_BITMASK, METHODS_HBAO};
    const methods_result none = {0};
    double               points[2][6] = {{0.0}}, closed[4] = {0.0};
    (void)state;
    g_seed = 13;
    for (int i = 0; i < 16; ++i) {
        methods_result e, sum[3] = {none, none, none}, r;
        double         m[3], s[3];
        open_fixture(&g_fixture, 1, 0.1, 0);
        do {
            draw_unit(m);
        } while (dot(m, g_fixture.p.v) < 0.1 || dot(m, g_fixture.n) > 0.9);
        draw_unit(s);
        corner_over_the_sphere(&g_fixture, m, s, &e);
        for (int k = 0; k < 3 * TURNS; ++k) {
            methods_options o = plain_options(estimators[k % 3], METHODS_HEIGHT_FIELD);
            o.facing = METHODS_FACING_HALF_SPACE;
            o.bias = o.angle_bias = 1e-9;
            build_corner(&g_fixture, m, s, (k / 3 + 0.5) / TURNS);
            methods_light(&o, &g_fixture.p, &r);
            add_result(&sum[k % 3], &r, 1.0 / TURNS);
        }
        const double nm = dot(g_fixture.n, m), cosine = 0.5 * (1.0 + nm), uniform = 1.0 - acos(nm) / PI;
        closed[0] = fmax(closed[0], fabs(sum[0].ao - cosine));
        closed[1] = fmax(closed[1], fabs(sum[0].uniform_ao - uniform));
        closed[2] = fmax(closed[2], fabs(sum[2].ao - uniform));
        closed[3] = fmax(closed[3], fabs(sum[1].ao - cosine));
        for (int k = 0; k < 12; ++k) { /* not of the cone, which is no sum */
            points[k / 6][k % 6] = k % 6 == 3 ? 0.0 : fmax(points[k / 6][k % 6], difference(&sum[k / 6], &e, k % 6));
        }
    }
    print_message("corner, closed form: ao %.0e, uniform %.0e, hbao %.0e, bitmask ao %.0e; points on the sphere:\n",
                  closed[0], closed[1], closed[2], closed[3]);
    for (int b = 0; b < 2; ++b) {
        const double *p = points[b];
        print_message("  %s: ao %.4f, uniform %.4f, bent %.4f, near %.4f, sh %.4f\n", b ? "bitmask" : "horizon", p[0], p[1],
                      p[2], p[4], p[5]);
        assert_true(p[0] <= 2e-3 && p[2] <= 3e-3 && p[4] <= 3e-3 && p[1] <= (b ? 0.015 : 2e-3) && p[5] <= (b ? 0.04 : 6e-3));
    }
    assert_true(closed[0] <= 1e-6 && closed[1] <= 1e-5 && closed[2] <= 1e-5 && closed[3] <= 2e-3);
}

/* --- environment ------------------------------------------------------------------------------------------------- */

static void spherical_harmonics_are_orthonormal_and_cones_have_their_bands(void **state)
{
    static const double z[3] = {0.0, 0.0, 1.0};
    double              worst = 0.0, product[81] = {0.0}, identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, y[9];
    (void)state;
    g_seed = 14;
    draw_environment();
    memcpy(g_env.to_world, identity, sizeof identity);
    for (int i = 0; i < GAUSS * 8; ++i) {
        const double c = 2.0 * g_node[i / 8] - 1.0, s = sqrt(1.0 - c * c), phi = 2.0 * PI * (i % 8) / 8.0;
        const double w[3] = {s * cos(phi), s * sin(phi), c};
        methods_sh_basis(w, y);
        for (int k = 0; k < 81; ++k) {
            product[k] += y[k / 9] * y[k % 9] * 2.0 * g_weight[i / 8] * 2.0 * PI / 8.0;
        }
    }
    for (int k = 0; k < 81; ++k) {
        assert_near(product[k], k / 9 == k % 9 ? 1.0 : 0.0, 1e-12);
    }
    for (int i = 0; i < 300; ++i) {
        const double t = draw(0.0, 1.0);
        double       sh[9][3], bands[3], cone[3], axis[3], quadrature[3], sum[3];
        for (int k = 0; k < 27; ++k) {
            sh[k / 3][k % 3] = draw(-1.0, 1.0);
        }
        draw_unit(axis);
        methods_cone_bands(t, bands);
        methods_sh_sum((const double(*)[3])sh, 2, axis, bands, sum);
        cone_irradiance((const double(*)[3])sh, 0, 2, axis, t, quadrature);
        kernel_cone(t, cone); /* as published: c0, c1, c2 with the polynomials of band 2 */
        methods_sh_basis(z, y);
        for (int c = 0; c < 3; ++c) {
            worst = fmax(worst, fabs(sum[c] - quadrature[c]));
        }
        assert_near(cone[0] / PI, bands[0] * y[0], 1e-12);
        assert_near(cone[1] / PI, bands[1] * y[2], 1e-12);
        assert_near(2.0 * cone[2] / PI, bands[2] * y[6], 1e-12);
    }
    double bands[3];
    methods_cone_bands(0.0, bands);
    assert_true(bands[0] == 1.0 && bands[1] == 2.0 / 3.0 && bands[2] == 0.25);
    print_message("cones against quadrature: %.0e\n", worst);
    assert_true(worst <= 1e-12);
}

/* Far light, may be negative: that of a sky minus that of its negative. */
static void signed_far(methods_options o, const double n[3], double ao, const double bent[3], double out[3])
{
    methods_environment env = g_env;
    double              minus[3];
    o.env = &env;
    methods_far(&o, n, n, ao, bent, out);
    for (int k = 0; k < 27; ++k) {
        env.sh[k / 3][k % 3] = -env.sh[k / 3][k % 3];
    }
    methods_far(&o, n, n, ao, bent, minus);
    for (int k = 0; k < 3; ++k) {
        out[k] -= minus[k];
    }
}

/* Visibility is a cone of half-angle a about an axis at the angle tilt from n: its ao, bent vector, and E/pi of the sky. */
static void look_through_cone(double a, double tilt, const double sh[9][3], double *ao, double bent[3], double rgb[3])
{
    const double axis[3] = {sin(tilt), 0.0, cos(tilt)};
    double       e1[3], e2[3], light[3];
    kernel_frame(axis, e1, e2);
    *ao = 0.0;
    memset(bent, 0, 3 * sizeof *bent);
    memset(rgb, 0, 3 * sizeof *rgb);
    for (int i = 0; i < GAUSS * 8; ++i) {
        const double c = cos(a) + (1.0 - cos(a)) * g_node[i / 8], s = sqrt(1.0 - c * c), phi = 2.0 * PI * (i % 8) / 8.0;
        double       w[3];
        for (int k = 0; k < 3; ++k) {
            w[k] = s * cos(phi) * e1[k] + s * sin(phi) * e2[k] + c * axis[k];
        }
        const double part = w[2] * (1.0 - cos(a)) * g_weight[i / 8] * 2.0 / 8.0;
        sky_radiance(sh, 0, 2, w, light);
        *ao += part;
        for (int k = 0; k < 3; ++k) {
            bent[k] += part * w[k];
            rgb[k] += part * light[k];
        }
    }
}

/* Far light by five methods: as the options have them, and with the cone's own axis, as the table of section 8 has it. */
static void far_by_methods(double a, double tilt, double ao, const double bent[3], double out[6][3])
{
    static const int visibility[3] = {METHODS_BENT, METHODS_AO, METHODS_CONE};
    const double     n[3] = {0.0, 0.0, 1.0}, axis[3] = {sin(tilt), 0.0, cos(tilt)};
    const double     t[3] = {sqrt(1.0 - ao), cos(a), 1.0 - ao};
    double           bands[3];
    for (int m = 0; m < 3; ++m) {
        methods_options o = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
        o.environment = METHODS_SH;
        o.far_visibility = visibility[m];
        signed_far(o, n, ao, bent, out[m]);
        methods_cone_bands(t[m], bands);
        methods_sh_sum((const double(*)[3])g_env.sh, 2, axis, bands, out[3 + m]);
    }
}

/* The table "best far field" of section 8: rms error by method, as parts of the rms of E. */
static void bent_far_light_is_the_best_of_its_table(void **state)
{
    static const double cones[4][2] = {{30, 20}, {45, 45}, {60, 30}, {20, 60}};
    static const double table[4][6] = {{.004, .293, 0, .019, .067, .720}, /* 0: not in the table */
                                       {.034, .439, 0, .153, .436, .630},
                                       {.018, .175, 0, .109, .177, .335}, {.015, .520, 0, .041, .996, .939}};
    const double        identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    (void)state;
    memcpy(g_env.to_world, identity, sizeof identity);
    for (int i = 0; i < 4; ++i) {
        const double a = cones[i][0] * PI / 180.0, tilt = cones[i][1] * PI / 180.0;
        double       error[6] = {0.0}, size = 0.0, ao, bent[3], exact[3], got[6][3];
        for (int k = 0; k < 9; ++k) { /* far light is linear: one coefficient at a time is the mean over all random skies */
            memset(g_env.sh, 0, sizeof g_env.sh);
            g_env.sh[k][0] = k < 1 ? 3.0 : k < 4 ? 1.2 : 0.6;
            look_through_cone(a, tilt, (const double(*)[3])g_env.sh, &ao, bent, exact);
            far_by_methods(a, tilt, ao, bent, got);
            for (int m = 0; m < 6; ++m) {
                error[m] += (got[m][0] - exact[0]) * (got[m][0] - exact[0]);
            }
            size += exact[0] * exact[0];
        }
        for (int m = 0; m < 6; ++m) {
            error[m] = sqrt(error[m] / size);
        }
        print_message("cone %2.0f/%2.0f: bent %.4f, cone %.4f, ao %.3f; with its own axis %.3f, cos a %.3f, 1 - ao %.3f\n",
                      cones[i][0], cones[i][1], error[0], error[2], error[1], error[3], error[4], error[5]);
        for (int m = 0; m < 6; ++m) {
            assert_true(table[i][m] == 0.0 || fabs(error[m] - table[i][m]) <= 0.25 * table[i][m]); /* of 200 skies */
            assert_true(error[m] >= (m == 0 || m == 2 ? 1.0 : 2.0) * error[0]);
        }
    }
}

/* Visibility in two rings: overhead and at the surface, hidden between. */
static void two_gaps(fixture *f)
{
    open_fixture(f, 16, 0.9, 1);
    memcpy(f->p.normal, f->p.v, sizeof f->p.normal);
    open_slices(f, 16, 0.3);
    for (int i = 0; i < 2 * 16; ++i) { /* slabs overhead: thin, from 25 to about 70 degrees */
        const double front = cos(25.0 * PI / 180.0);
        put_sample(f, i / 2, i % 2, front, 1.0);
    }
}

static void even_sky(void *user, const double position[3], const double direction[3], double cos_aperture, double rgb[3])
{
    const int prefiltered = cos_aperture < 1.0; /* as a diffuse cube: E/pi of the sky d.z^2 is (1 + d.z^2) / 4 */
    (void)user;
    (void)position;
    rgb[0] = rgb[1] = rgb[2] = prefiltered ? 0.25 * (1.0 + direction[2] * direction[2]) : direction[2] * direction[2];
}

static void free_bits_are_exact_to_order_1_and_see_through_two_gaps(void **state)
{
    methods_options o = plain_options(METHODS_BITMASK, METHODS_THICK);
    methods_result  bits, bent;
    double          worst = 0.0;
    (void)state;
    g_seed = 16;
    for (int i = 0; i < 200; ++i) {
        draw_fixture(&g_fixture, 1 + i % 4, i & 1);
        draw_environment();
        o.environment = METHODS_SH;
        o.sh_order = 1;
        o.far_visibility = METHODS_FREE_BITS;
        methods_light(&o, &g_fixture.p, &bits);
        o.far_visibility = METHODS_BENT;
        methods_light(&o, &g_fixture.p, &bent);
        for (int k = 0; k < 3; ++k) { /* the sectors are a ratio, the bent vector a mean */
            bent.bent[k] *= g_fixture.p.slices / bent.full;
        }
        methods_far(&o, g_fixture.p.position, g_fixture.p.normal, bent.ao, bent.bent, bent.far);
        for (int k = 0; k < 3; ++k) {
            worst = fmax(worst, fabs(bent.far[k] * (1.0 - g_fixture.p.f0[k]) - bits.far[k]));
        }
    }
    print_message("free bits against AO L0 + L1 . B: %.0e\n", worst);
    assert_true(worst <= 1e-12);
    two_gaps(&g_fixture);
    memset(&g_env, 0, sizeof g_env);
    g_env.sh[0][0] = 2.0 * sqrt(PI) / 3.0; /* the sky z^2, order 2 */
    g_env.sh[6][0] = 4.0 / 3.0 * sqrt(PI / 5.0);
    g_env.lookup = even_sky;
    o.thickness = 0.8;
    truth_of(&o, &g_fixture, &g_truth);
    double exact = 0.0;
    for (int i = 0; i < g_truth.count; ++i) {
        const node *n = &g_truth.node[i];
        exact += n->free ? n->w[2] * n->w[2] * n->cosine * n->weight / g_truth.full : 0.0;
    }
    for (int cube = 0; cube < 2; ++cube) {
        o.environment = cube ? METHODS_CUBE : METHODS_SH;
        o.sh_order = 2;
        o.far_visibility = METHODS_FREE_BITS;
        methods_light(&o, &g_fixture.p, &bits);
        o.far_visibility = METHODS_BENT;
        methods_light(&o, &g_fixture.p, &bent);
        print_message("two gaps, ao %.3f, %s: truth %.4f, free bits %.4f, bent %.4f\n", bits.ao, cube ? "cube" : "order 2",
                      exact, bits.far[0], bent.far[0]);
        assert_true(fabs(bits.far[0] - exact) < 0.25 * fabs(bent.far[0] - exact) &&
                    fabs(bits.far[0] - exact) < 0.02 * exact);
    }
}

/* --- specular occlusion, bounces --------------------------------------------------------------------------------- */

static void caps_meet_points_on_the_sphere(void **state)
{
    double worst = 0.0;
    (void)state;
    g_seed = 17;
    for (int i = 0; i < 80; ++i) {
        const double r1 = draw(0.05, 0.5 * PI), r2 = draw(0.05, 0.5 * PI), d = draw(0.0, i & 1 ? PI : fmin(r1 + r2, PI));
        const double axis[3] = {sin(d), 0.0, cos(d)};
        int          inside = 0;
        for (int k = 0; k < POINTS; ++k) {
            double w[3];
            sphere_point(k, w);
            inside += w[2] > cos(r1) && dot(w, axis) > cos(r2);
        }
        worst = fmax(worst, fabs(methods_caps(r1, r2, d) - 4.0 * PI * inside / POINTS));
        assert_near(methods_caps(r1, r2, d), methods_caps(r2, r1, d), 1e-12);
    }
    print_message("caps against points on the sphere: %.4f sr\n", worst);
    assert_true(worst <= 0.01);
    assert_near(methods_caps(0.3, 0.9, 0.6 + 1e-9), 2.0 * PI * (1.0 - cos(0.3)), 1e-4);
    assert_near(methods_caps(0.5 * PI, 0.7, 0.5 * PI), PI * (1.0 - cos(0.7)), 1e-12);
}

/* Open surfaces mirror all; the divisor of the articles would take the part of the lobe away that is below the surface. */
static void specular_occlusion_is_one_when_open_and_ao_when_rough(void **state)
{
    const double n[3] = {0.0, 0.0, 1.0};
    (void)state;
    g_seed = 18;
    for (int i = 0; i < 500; ++i) {
        const double nv = draw(0.001, 1.0), ao = draw(0.0, 1.0), v[3] = {sqrt(1.0 - nv * nv), 0.0, nv};
        double       axis[3];
        draw_unit(axis);
        axis[2] = fabs(axis[2]);
        assert_near(methods_specular_occlusion(n, v, 1.0, n, draw(0.0, 1.0)), 1.0, 1e-12);
        assert_near(methods_specular_occlusion(n, v, ao, axis, draw(0.8, 1.0)), ao, 1e-12);
        assert_true(methods_specular_occlusion(n, v, 0.0, axis, 0.3) == 0.0);
        const double so = methods_specular_occlusion(n, v, ao, axis, draw(0.0, 1.0));
        assert_true(so >= 0.0 && so <= 1.0);
    }
    const double lobe = acos(pow(10.0, -0.36)), whole = 2.0 * PI * (1.0 - cos(lobe));
    const double plain[2] = {methods_caps(0.5 * PI, lobe, acos(0.5)) / whole,
                             methods_caps(0.5 * PI, lobe, acos(0.2)) / whole};
    print_message("open, divided by the whole lobe: %.3f at n.v 0.5, %.3f at 0.2\n", plain[0], plain[1]);
    assert_true(plain[0] < 0.95 && plain[1] < 0.8);
    /* a mirror that looks along the open cone's axis sees all, one that looks aside nothing */
    const double v[3] = {-0.6, 0.0, 0.8}, along[3] = {0.6, 0.0, 0.8}, aside[3] = {-0.96, 0.0, 0.28};
    assert_true(methods_specular_occlusion(n, v, 0.6, along, 0.1) == 1.0);
    assert_true(methods_specular_occlusion(n, v, 0.2, aside, 0.1) == 0.0);
}

static void bounces_meet_the_series_and_the_published_fit(void **state)
{
    (void)state;
    g_seed = 19;
    for (int i = 0; i < 500; ++i) {
        const double ao = draw(0.01, 1.0), albedo = draw(0.0, 0.95);
        double       sum = 0.0, light = ao;
        for (int bounce = 0; bounce < 2000; ++bounce) { /* what is hidden shows surfaces lit like this one */
            sum += light;
            light *= albedo * (1.0 - ao);
        }
        assert_near(methods_multi_bounce(METHODS_CLOSED, ao, albedo), sum, 1e-9);
        assert_true(methods_multi_bounce(METHODS_CUBIC, ao, albedo) >= ao);
    }
    assert_near(methods_multi_bounce(METHODS_CLOSED, 0.1, 1.0), 1.0, 1e-12);
    assert_true(methods_multi_bounce(METHODS_CLOSED, 0.0, 1.0) == 0.0);
    assert_near(methods_multi_bounce(METHODS_CUBIC, 0.5, 1.0), 0.90, 0.005);
    assert_near(methods_multi_bounce(METHODS_CUBIC, 0.1, 1.0), 0.305, 0.001);
    assert_near(methods_multi_bounce(METHODS_CUBIC, 1.0, 0.3), 1.0, 1e-4);
    assert_near(methods_multi_bounce(METHODS_CUBIC, 0.5, 0.0), 0.5, 1e-12); /* 0.464 without the maximum */
    /* 8: the fit exceeds 1, and doubles what cosine visibility has already */
    assert_near(methods_f0_ao(0.983), 1.0061, 1e-4);
    assert_near(methods_f0_ao(0.5) / 0.5, 1.30, 0.005);
    assert_near(methods_f0_ao(0.05) / 0.05, 1.48, 0.005);
}

/* --- options, extremes ------------------------------------------------------------------------------------------- */

enum { AO = 1, UNIFORM = 2, BENT = 4, CONE = 8, NEAR = 16, SH = 32, FAR = 64, IRRADIANCE = 128, SPECULAR = 256,
       BOUNCE = 512, COMPOSITE = 1024 };
enum { LIGHT = NEAR | SH | IRRADIANCE | COMPOSITE, BEHIND = FAR | IRRADIANCE | COMPOSITE, ALL = 2047 };

/* An option of type int or double, set to a value, changes these outputs and no others. */
static const struct change {
    const char *name;
    int         estimator, occluder, environment, visibility;
    size_t      member;
    double      value;
    int         is_int, outputs;
} k_changes[] = {
#define INT(estimator, occluder, environment, visibility, member, value, outputs)                   \
    {#member, METHODS_##estimator, METHODS_##occluder, METHODS_##environment, METHODS_##visibility, \
     offsetof(methods_options, member), value, 1, outputs}
#define REAL(estimator, occluder, environment, visibility, member, value, outputs)                  \
    {#member, METHODS_##estimator, METHODS_##occluder, METHODS_##environment, METHODS_##visibility, \
     offsetof(methods_options, member), value, 0, outputs}
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, occluder, METHODS_HEURISTIC, ALL),
    INT(BITMASK, HEIGHT_FIELD, SH, BENT, occluder, METHODS_THICK, ALL),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, estimator, METHODS_BITMASK, ALL),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, facing, METHODS_FACING_FILTER, LIGHT),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, facing, METHODS_FACING_HALF_SPACE, LIGHT),
    INT(BITMASK, THICK, SH, BENT, facing, METHODS_FACING_HALF_SPACE, LIGHT),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, sh_order, 1, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, environment, METHODS_PROBES, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, far_visibility, METHODS_AO, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, far_visibility, METHODS_DIRECTION, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, far_visibility, METHODS_CONE, BEHIND),
    INT(BITMASK, THICK, SH, BENT, far_visibility, METHODS_FREE_BITS, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, bounce, METHODS_CUBIC, BOUNCE),
    INT(HORIZON, HEURISTIC, SH, BENT, steps, 12, ALL),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, steps, 12, 0),
    INT(HBAO_PLUS, HEIGHT_FIELD, SH, AO, steps, 12, AO | BEHIND | BOUNCE),
    INT(HBAO, HEIGHT_FIELD, SH, AO, attenuation, METHODS_LINEAR, AO | BEHIND | BOUNCE),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, seed_compat, METHODS_SLICE_MEAN, ALL & ~(UNIFORM | BENT)),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, seed_compat, METHODS_CONE_RELATION, CONE | BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, AO, seed_compat, METHODS_F0_AO, BEHIND),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, seed_compat, METHODS_UNIFORM_BENT, BENT | CONE | BEHIND | SPECULAR),
    INT(HORIZON, HEIGHT_FIELD, SH, BENT, seed_compat, METHODS_F0_AO, 0),
    INT(HORIZON, HEIGHT_FIELD, CONSTANT, BENT, seed_compat, METHODS_F0_AO, BEHIND),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, reach, 3.0, ALL),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, falloff, 0.2, ALL),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, bias, 0.5, ALL),
    REAL(BITMASK, THICK, SH, BENT, bias, 0.5, ALL),
    REAL(BITMASK, THICK, SH, BENT, thickness, 0.1, ALL),
    REAL(HORIZON, HEURISTIC, SH, BENT, decay, 0.5, ALL),
    REAL(HBAO, HEIGHT_FIELD, SH, AO, angle_bias, 0.3, AO | BEHIND | BOUNCE),
    REAL(HBAO, HEIGHT_FIELD, SH, AO, multiplier, 2.0, 0),
    REAL(HBAO_PLUS, HEIGHT_FIELD, SH, AO, multiplier, 2.0, AO | BEHIND | BOUNCE),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, firefly, 0.7, LIGHT),
    REAL(BITMASK, THICK, SH, BENT, near_intensity, 2.0, LIGHT),
    REAL(BITMASK, THICK, SH, FREE_BITS, far_intensity, 2.0, BEHIND),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, ao_exponent, 2.0, AO | BENT | CONE | BEHIND | SPECULAR | BOUNCE),
    REAL(BITMASK, THICK, SH, FREE_BITS, ao_exponent, 2.0, AO | BENT | CONE | SPECULAR | BOUNCE),
    REAL(HORIZON, HEIGHT_FIELD, SH, BENT, roughness, 0.3, SPECULAR)};

/* Over several pixels: one alone may not show it. */
static void every_option_changes_its_outputs_and_no_others(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof k_changes / sizeof k_changes[0]; ++i) {
        const struct change *c = &k_changes[i];
        int                  changed = 0;
        g_seed = 20;
        for (int pixel = 0; pixel < 8; ++pixel) {
            methods_options before = plain_options(c->estimator, c->occluder), after;
            methods_result  a, b;
            draw_environment();
            draw_fixture(&g_fixture, 2, 0);
            before.environment = c->environment;
            before.far_visibility = c->visibility;
            before.reach = 5.0;
            before.roughness = 0.55;
            after = before;
            if (c->is_int) {
                *(int *)(void *)((char *)&after + c->member) = (int)c->value;
            } else {
                *(double *)(void *)((char *)&after + c->member) = c->value;
            }
            methods_light(&before, &g_fixture.p, &a);
            methods_light(&after, &g_fixture.p, &b);
            for (int k = 0; k < OUTPUTS; ++k) {
                changed |= difference(&a, &b, k) > 1e-9 ? 1 << k : 0;
            }
        }
        if (changed != c->outputs) {
            fail_msg("%s = %g changes 0x%x, not 0x%x", c->name, c->value, (unsigned)changed, (unsigned)c->outputs);
        }
    }
    print_message("%d options and values, each with the outputs that it changes\n",
                  (int)(sizeof k_changes / sizeof k_changes[0]));
}

static int all_finite(const methods_result *r)
{
    const double *x = (const double *)(const void *)r;
    for (size_t i = 0; i < sizeof *r / sizeof *x; ++i) {
        if (!(fabs(x[i]) < 1e9)) {
            return 0;
        }
    }
    return 1;
}

static void sky_and_closed_pixels_have_their_values(void **state)
{
    methods_result r;
    (void)state;
    g_seed = 21;
    draw_environment();
    for (int i = 0; i < 4; ++i) {
        methods_options o = cosine_options(i);
        o.environment = METHODS_SH;
        o.ao_exponent = 0.5;
        draw_fixture(&g_fixture, 3, 0);
        g_fixture.p.sky = 1;
        methods_light(&o, &g_fixture.p, &r);
        assert_true(r.ao == 1.0 && r.uniform_ao == 1.0 && r.specular_occlusion == 1.0 && r.multi_bounce[2] == 1.0);
        assert_true(r.near[0] == 0.0 && r.far[1] == 0.0 && r.cone[3] == 0.0 && r.sh[0][3] == 0.0 && r.irradiance[0] == 0.0);
        assert_true(r.composite[0] == g_fixture.p.direct[0]);
        open_fixture(&g_fixture, 3, 0.2, 1);
        for (int k = 0; k < 6; ++k) {
            put_sample(&g_fixture, k / 2, k % 2, 1.0, 1.0);
        }
        o.thickness = 1e9;
        methods_light(&o, &g_fixture.p, &r);
        assert_true(all_finite(&r) && r.ao <= 1e-7 && r.specular_occlusion <= 1e-7 && r.multi_bounce[0] <= 1e-6 &&
                    fabs(r.far[0]) <= 1e-6);
        assert_near(r.near[0], 1.0, 1e-12);
        assert_near(r.cone[3], 1.0, 1e-6);
        assert_near(dot(r.cone, r.cone), 1.0, 1e-12);
        for (int k = 0; k < 3 && dot(r.bent, r.bent) < 1e-12; ++k) {
            assert_near(r.cone[k], g_fixture.n[k], 1e-12);
        }
    }
}

/* A normal that looks away, samples at the receiver, on the view ray, below the surface, light that is no number. */
static void hazards_stay_finite(void **state)
{
    static const double least[] = {-1.0, -1e-8, 0.0, 1e-20, 1.0};
    (void)state;
    g_seed = 22;
    draw_environment();
    for (int i = 0; i < 5 * 8; ++i) {
        static const int estimators[4] = {METHODS_HORIZON, METHODS_BITMASK, METHODS_HBAO, METHODS_HBAO_PLUS};
        methods_options  o = plain_options(estimators[i % 4], i % 8 >= 4 && i % 2 ? METHODS_THICK : METHODS_HEIGHT_FIELD);
        methods_result   r;
        double           across[3], other[3];
        draw_fixture(&g_fixture, 3, 0);
        kernel_frame(g_fixture.p.v, across, other);
        const double along = least[i / 8], side = sqrt(1.0 - along * along);
        for (int k = 0; k < 3; ++k) {
            g_fixture.p.normal[k] = along * g_fixture.p.v[k] + side * across[k];
            g_fixture.sample[0][0][0].position[k] = g_fixture.p.position[k];
            g_fixture.sample[1][1][0].position[k] = g_fixture.p.position[k] + g_fixture.p.v[k];
            g_fixture.sample[2][0][0].position[k] = g_fixture.p.position[k] - g_fixture.p.v[k];
            g_fixture.sample[1][0][k].radiance[0] = k == 0 ? (double)NAN : k == 1 ? (double)INFINITY : -1.0;
        }
        o.environment = METHODS_CONSTANT;
        methods_light(&o, &g_fixture.p, &r);
        assert_true(all_finite(&r) && r.ao >= -1e-12 && r.ao <= 1.0 + 1e-12 && r.near[0] >= 0.0 && r.near[0] <= 60000.0);
    }
}

/* --- where samples lie ------------------------------------------------------------------------------------------- */

#define WIDTH 90
#define HEIGHT 60

static float g_depth[WIDTH * HEIGHT], g_normal[3 * WIDTH * HEIGHT], g_radiance[3 * WIDTH * HEIGHT];

/* A tilted plane, seen off-centre, with a hole of sky. */
static bf_scene plane_scene(int orthographic, const double normal[3])
{
    const double pixel = orthographic ? 0.08 : 0.02;
    bf_scene     s = {.camera = {WIDTH, HEIGHT, orthographic, {pixel, -pixel, -0.4 * WIDTH * pixel, 0.6 * HEIGHT * pixel}},
                      .depth = g_depth, .sky_depth = 1e9, .normal = g_normal, .radiance = g_radiance};
    for (int i = 0; i < WIDTH * HEIGHT; ++i) {
        const double x = (i % WIDTH + 0.5) * pixel + s.camera.ray[2], y = (i / WIDTH + 0.5) * -pixel + s.camera.ray[3];
        const double down = normal[2] * -5.0, flat = normal[0] * x + normal[1] * y; /* the plane through (0, 0, -5) */
        g_depth[i] = (float)(orthographic ? (flat - down) / normal[2] : down / (flat - normal[2]));
        if (i % WIDTH > 70 && i / WIDTH > 40) {
            g_depth[i] = 2e9f;
        }
        for (int k = 0; k < 3; ++k) {
            g_normal[3 * i + k] = (float)normal[k];
            g_radiance[3 * i + k] = (float)i;
        }
    }
    return s;
}

/* Pixel position of a point of the passes' space. */
static void project(const bf_camera *cam, const double p[3], double out[2])
{
    for (int k = 0; k < 2; ++k) {
        out[k] = ((cam->orthographic ? p[k] : p[k] / p[2]) - cam->ray[2 + k]) / cam->ray[k];
    }
}

/* The samples of a side: pixel centres beside the line of the slice, each one pixel or more further than the one before. */
static void check_side(const bf_camera *cam, const methods_pixel *p, int slice, int side)
{
    const methods_slice *s = &p->slice[slice];
    const double         sign = side ? -1.0 : 1.0, step = 1e-4;
    double               from[2], to[2], at[2], before = 0.0, ahead[3];
    for (int k = 0; k < 3; ++k) {
        ahead[k] = p->position[k] + step * sign * s->tangent[k];
    }
    project(cam, p->position, from);
    project(cam, ahead, to);
    const double length = hypot(to[0] - from[0], to[1] - from[1]), dx = (to[0] - from[0]) / length;
    const double dy = (to[1] - from[1]) / length;
    for (int i = 0; i < s->count[side]; ++i) {
        if (s->sample[side][i].skip) {
            continue;
        }
        project(cam, s->sample[side][i].position, at);
        const double x = at[0] - from[0], y = at[1] - from[1], far = x * dx + y * dy;
        assert_true(fabs(x * dy - y * dx) <= 0.7072 && far >= before - 0.4143 && far >= 0.29);
        assert_true(fabs(at[0] - floor(at[0]) - 0.5) <= 1e-6 && fabs(at[1] - floor(at[1]) - 0.5) <= 1e-6);
        assert_true(at[0] > 0.0 && at[1] > 0.0 && at[0] < cam->width && at[1] < cam->height);
        assert_near(s->sample[side][i].radiance[0], floor(at[1]) * WIDTH + floor(at[0]), 0.0);
        before = far;
    }
}

static void samples_lie_beside_their_slices(void **state)
{
    const double normal[3] = {2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0};
    methods_work work = {.capacity = 0};
    int          taken = 0, open = 0;
    (void)state;
    for (int i = 0; i < 2 * 2 * 40; ++i) {
        const bf_scene  scene = plane_scene(i & 1, normal);
        methods_options o = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
        methods_pixel   p;
        methods_result  r;
        o.slices = 5;
        o.steps = 20;
        o.reach = i & 2 ? 1.0 : 0.0;
        o.noise = 1 + i % 3;
        assert_true(methods_place(&o, &scene, i * 7 % 70, i * 11 % HEIGHT, &work, &p));
        assert_true(!p.sky && p.slices == 5 && fabs(dot(p.v, p.v) - 1.0) <= 1e-12 && p.v[2] < 0.0);
        for (int k = 0; k < 5; ++k) {
            const double *d = p.slice[k].tangent, *next = p.slice[(k + 1) % 5].tangent;
            assert_true(fabs(dot(d, p.v)) <= 1e-12 && fabs(dot(d, d) - 1.0) <= 1e-12);
            assert_near(fabs(dot(d, next)), cos(PI / 5.0), 1e-12);
            check_side(&scene.camera, &p, k, 0);
            check_side(&scene.camera, &p, k, 1);
            taken += p.slice[k].count[0] + p.slice[k].count[1];
        }
        methods_light(&o, &p, &r);
        open += fabs(r.ao - 1.0) <= 1e-12 && r.near[0] == 0.0; /* nothing stands above a plane */
    }
    const bf_scene scene = plane_scene(0, normal);
    methods_pixel  p;
    const methods_options o = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
    assert_true(methods_place(&o, &scene, 80, 50, &work, &p) && p.sky);
    methods_work_free(&work);
    print_message("placement: %d samples, %d open pixels of 160\n", taken, open);
    assert_true(taken > 5000 && open == 160);
}

/* Distance of a point from the ray through a pixel position. */
static double off_ray(const bf_camera *cam, const double p[3], double px, double py)
{
    const double ray[3] = {px * cam->ray[0] + cam->ray[2], py * cam->ray[1] + cam->ray[3], 1.0};
    const double along = dot(p, ray) / dot(ray, ray);
    const double h[3] = {p[0] - along * ray[0], p[1] - along * ray[1], p[2] - along * ray[2]};
    return cam->orthographic ? hypot(p[0] - ray[0], p[1] - ray[1]) : sqrt(dot(h, h));
}

/* Pixels until the screen or the sphere of the reach ends, by bisection. */
static double room_of(const methods_options *o, const bf_camera *cam, const double p[3], int x, int y, const double d[2])
{
    double low = 0.0, high = 1000.0;
    for (int i = 0; i < 60; ++i) {
        const double t = 0.5 * (low + high), px = x + 0.5 + t * d[0], py = y + 0.5 + t * d[1];
        const int    inside = fmin(px, py) > 0.01 && px < cam->width - 0.01 && py < cam->height - 0.01; /* as hbil_border */
        *(inside && (o->reach == 0.0 || off_ray(cam, p, px, py) < o->reach) ? &low : &high) = t;
    }
    return low;
}

/* Where a side's samples have to be: how many are elsewhere. */
static int misplaced(const methods_options *o, const bf_camera *cam, const methods_pixel *p, int x, int y, int slice,
                     int side)
{
    const methods_slice *s = &p->slice[slice];
    const double         sign = side ? -1.0 : 1.0;
    double               noise[3], from[2], to[2], ahead[3], offset = 0.0;
    int                  wrong = 0;
    for (int k = 0; k < 3; ++k) {
        ahead[k] = p->position[k] + 1e-5 * sign * s->tangent[k];
    }
    methods_noise(o->noise, o->frame_index, x, y, noise);
    project(cam, p->position, from);
    project(cam, ahead, to);
    const double length = hypot(to[0] - from[0], to[1] - from[1]);
    const double d[2] = {(to[0] - from[0]) / length, (to[1] - from[1]) / length};
    const double room = room_of(o, cam, p->position, x, y, d);
    for (int i = 0; i < o->steps; ++i) {
        const double t = (i + noise[1]) / o->steps;
        offset = fmax(o->spacing == METHODS_GEOMETRIC ? pow(fmax(room, 1.0), t) : 1.0 + pow(t, o->exponent) * (room - 1.0),
                      offset + 1.0);
        const int qx = x + (int)floor(offset * d[0] + 0.5), qy = y + (int)floor(offset * d[1] + 0.5), q = qy * WIDTH + qx;
        if (offset > room || qx < 0 || qy < 0 || qx >= WIDTH || qy >= HEIGHT) {
            return wrong + (s->count[side] != i);
        }
        const methods_sample *sample = &s->sample[side][i];
        if (i >= s->count[side] || sample->skip != (g_depth[q] > 1e9f) ||
            (!sample->skip && sample->radiance[0] != (double)q)) {
            ++wrong;
        }
    }
    return wrong + (s->count[side] != o->steps);
}

static void samples_lie_where_spacing_reach_and_noise_put_them(void **state)
{
    const double normal[3] = {2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0};
    methods_work work = {.capacity = 0};
    int          wrong = 0, all = 0;
    (void)state;
    for (int i = 0; i < 240; ++i) {
        const bf_scene  scene = plane_scene(i & 1, normal);
        const int       x = i * 7 % 70, y = i * 11 % HEIGHT;
        methods_options o = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
        methods_pixel   p;
        double          noise[3];
        o.slices = 3;
        o.steps = 12;
        o.reach = i & 2 ? 0.9 : 0.0;
        o.spacing = i & 4 ? METHODS_GEOMETRIC : METHODS_POWER;
        o.exponent = i & 8 ? 3.0 : 2.0;
        o.noise = 1 + i % 3;
        o.frame_index = (uint32_t)i;
        o.pull = 1e-4;
        assert_true(methods_place(&o, &scene, x, y, &work, &p));
        methods_noise(o.noise, o.frame_index, x, y, noise);
        assert_near(p.position[2], (double)g_depth[y * WIDTH + x] * (1.0 - 1e-4), 1e-9);
        for (int k = 0; k < 6; ++k) {
            const methods_slice *s = &p.slice[k / 2];
            const double         turn = noise[2] + 0.61803399 * (k / 2);
            wrong += misplaced(&o, &scene.camera, &p, x, y, k / 2, k % 2);
            all += s->count[k % 2];
            assert_near(s->jitter, turn - floor(turn), 1e-12);
            for (int m = 0; m < 3 && s->count[k % 2] && !s->sample[k % 2][0].skip; ++m) {
                assert_near(s->sample[k % 2][0].normal[m], p.normal[m], 1e-6);
                assert_near(p.normal[m], (m == 2 ? -1.0 : 1.0) * normal[m] / sqrt(dot(normal, normal)), 1e-6);
            }
        }
    }
    methods_work_free(&work);
    print_message("placement: %d of %d samples elsewhere\n", wrong, all);
    assert_true(all > 8000 && wrong <= all / 500); /* a rounding may go either way */
}

/* Seeds' azimuths: uniform on the screen; the same slices in another order. */
static void seeds_turn_their_slices_as_they_say(void **state)
{
    const double    normal[3] = {0.0, 0.0, 1.0};
    const bf_scene  scene = plane_scene(0, normal);
    methods_work    work = {.capacity = 0};
    methods_options o = plain_options(METHODS_HORIZON, METHODS_HEIGHT_FIELD);
    methods_pixel   p;
    double          noise[3], ahead[3], from[2], to[2];
    (void)state;
    o.slices = 4;
    o.seed_compat = METHODS_SCREEN_AZIMUTH;
    assert_true(methods_place(&o, &scene, 85, 5, &work, &p));
    methods_noise(METHODS_NOISE_HILBERT_R2, 0, 85, 5, noise);
    for (int i = 0; i < 4; ++i) {
        const double phi = (i + noise[0]) * PI / 4.0;
        for (int k = 0; k < 3; ++k) {
            ahead[k] = p.position[k] + 1e-6 * p.slice[i].tangent[k];
        }
        project(&scene.camera, p.position, from);
        project(&scene.camera, ahead, to);
        assert_near(atan2(-(to[1] - from[1]), to[0] - from[0]), phi, 1e-6);
        check_side(&scene.camera, &p, i, 0);
    }
    o.seed_compat = METHODS_NOISE_2PI;
    assert_true(methods_place(&o, &scene, 85, 5, &work, &p));
    double e1[3], e2[3];
    kernel_frame(p.v, e1, e2);
    for (int i = 0; i < 4; ++i) {
        const double phi = i * PI / 4.0 + 2.0 * PI * noise[0];
        assert_near(dot(p.slice[i].tangent, e1), cos(phi), 1e-12);
        assert_near(dot(p.slice[i].tangent, e2), sin(phi), 1e-12);
    }
    methods_work_free(&work);
}

static void noise_covers_its_tile_once(void **state)
{
    static unsigned char seen[3][4096];
    double               noise[3], worst = 0.0;
    (void)state;
    for (int i = 0; i < 4096; ++i) { /* 4096 terms of a sequence of low discrepancy: one in each interval, nearly */
        methods_noise(METHODS_NOISE_HILBERT_R2, 0, i % 64, i / 64, noise);
        for (int k = 0; k < 3; ++k) {
            assert_true(noise[k] >= 0.0 && noise[k] < 1.0);
            ++seen[k][(int)(noise[k] * 4096.0)];
        }
        methods_noise(METHODS_NOISE_IGN, 5, i % 64, i / 64, noise);
        assert_true(noise[0] >= 0.0 && noise[0] < 1.0 && noise[1] < 1.0 && noise[2] < 1.0 && noise[2] != noise[0]);
    }
    for (int i = 0; i < 3 * 4096; ++i) {
        worst = fmax(worst, seen[i / 4096][i % 4096]);
    }
    assert_true(worst <= 3.0);
    for (int frame = 0; frame < 5; ++frame) { /* at the start of the curve: the frame alone */
        const uint64_t index = 288u * (uint64_t)frame;
        methods_noise(METHODS_NOISE_HILBERT_R2, (uint32_t)frame, 64, 0, noise);
        assert_near(noise[0], (double)((3242174889u * index + 2147483648u) % 4294967296u / 256u) / 16777216.0, 0.0);
    }
    methods_noise(METHODS_NOISE_NONE, 3, 7, 9, noise);
    assert_true(noise[0] == 0.5 && noise[1] == 0.5 && noise[2] == 0.5);
}

static void enumerators_are_those_of_the_library(void **state)
{
    (void)state;
    assert_true((int)METHODS_HBAO_PLUS == (int)HBIL_ESTIMATOR_HBAO_PLUS &&
                (int)METHODS_BITMASK == (int)HBIL_ESTIMATOR_BITMASK);
    assert_true((int)METHODS_THICK == (int)HBIL_OCCLUDER_THICK && (int)METHODS_HEURISTIC == (int)HBIL_OCCLUDER_HEURISTIC);
    assert_true((int)METHODS_LINEAR == (int)HBIL_ATTENUATION_LINEAR && (int)METHODS_CUBIC == (int)HBIL_BOUNCE_CUBIC);
    assert_true((int)METHODS_FACING_FILTER == (int)HBIL_FACING_FILTER &&
                (int)METHODS_FACING_HALF_SPACE == (int)HBIL_FACING_HALF_SPACE);
    assert_true((int)METHODS_CONSTANT == (int)HBIL_ENVIRONMENT_CONSTANT && (int)METHODS_HOOK == (int)HBIL_ENVIRONMENT_HOOK);
    assert_true((int)METHODS_SH == (int)HBIL_ENVIRONMENT_SH && (int)METHODS_CUBE == (int)HBIL_ENVIRONMENT_CUBE);
    assert_true((int)METHODS_PROBES == (int)HBIL_ENVIRONMENT_PROBES &&
                (int)METHODS_GEOMETRIC == (int)HBIL_SPACING_GEOMETRIC);
    assert_true((int)METHODS_AO == (int)HBIL_FAR_VISIBILITY_AO &&
                (int)METHODS_DIRECTION == (int)HBIL_FAR_VISIBILITY_DIRECTION);
    assert_true((int)METHODS_CONE == (int)HBIL_FAR_VISIBILITY_CONE &&
                (int)METHODS_FREE_BITS == (int)HBIL_FAR_VISIBILITY_FREE_BITS);
    assert_true((int)METHODS_NOISE_IGN == (int)HBIL_NOISE_IGN &&
                (int)METHODS_NOISE_HILBERT_R2 == (int)HBIL_NOISE_HILBERT_R2);
    assert_true((int)METHODS_F0_AO == (int)HBIL_SEED_COMPAT_F0_AO &&
                (int)METHODS_NOISE_2PI == (int)HBIL_SEED_COMPAT_NOISE_2PI);
    assert_true((int)METHODS_SLICE_MEAN == (int)HBIL_SEED_COMPAT_SLICE_MEAN);
    assert_true((int)METHODS_UNIFORM_BENT == (int)HBIL_SEED_COMPAT_UNIFORM_BENT);
    assert_true((int)METHODS_SCREEN_AZIMUTH == (int)HBIL_SEED_COMPAT_SCREEN_AZIMUTH);
    assert_true((int)METHODS_CONE_RELATION == (int)HBIL_SEED_COMPAT_CONE_RELATION);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_output_meets_its_definition_in_every_combination),
        cmocka_unit_test(hbao_and_hbao_plus_meet_their_definitions_in_every_combination),
        cmocka_unit_test(hbao_plus_measures_a_mean_and_stays_within_its_bound),
        cmocka_unit_test(slices_meet_the_reference_vectors),
        cmocka_unit_test(arcs_meet_quadrature),
        cmocka_unit_test(map_of_sectors_meets_quadrature_and_its_other_form_and_goes_back),
        cmocka_unit_test(jittered_sectors_are_unbiased),
        cmocka_unit_test(half_space_mask_meets_a_test_per_direction),
        cmocka_unit_test(white_furnace_stays_white),
        cmocka_unit_test(visibility_in_sh_is_consistent_with_ao),
        cmocka_unit_test(open_plane_is_open_and_bends_to_two_thirds_of_its_normal),
        cmocka_unit_test(bitmask_of_infinite_thickness_meets_the_horizon),
        cmocka_unit_test(heuristic_keeps_energy_and_does_not_count_steps),
        cmocka_unit_test(corner_meets_points_on_the_sphere_and_its_closed_form),
        cmocka_unit_test(spherical_harmonics_are_orthonormal_and_cones_have_their_bands),
        cmocka_unit_test(bent_far_light_is_the_best_of_its_table),
        cmocka_unit_test(free_bits_are_exact_to_order_1_and_see_through_two_gaps),
        cmocka_unit_test(caps_meet_points_on_the_sphere),
        cmocka_unit_test(specular_occlusion_is_one_when_open_and_ao_when_rough),
        cmocka_unit_test(bounces_meet_the_series_and_the_published_fit),
        cmocka_unit_test(every_option_changes_its_outputs_and_no_others),
        cmocka_unit_test(sky_and_closed_pixels_have_their_values),
        cmocka_unit_test(hazards_stay_finite),
        cmocka_unit_test(samples_lie_beside_their_slices),
        cmocka_unit_test(samples_lie_where_spacing_reach_and_noise_put_them),
        cmocka_unit_test(seeds_turn_their_slices_as_they_say),
        cmocka_unit_test(noise_covers_its_tile_once),
        cmocka_unit_test(enumerators_are_those_of_the_library),
    };
    return cmocka_run_group_tests_name("numeric.methods", tests, make_gauss, NULL);
}
