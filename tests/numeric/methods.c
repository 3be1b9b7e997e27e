/* methods.c - see methods.h. Verdicts and formulas: MATH.md, the section is named where one is used. */
#include "methods.h"

#include <math.h>
#include <stdlib.h>

/* --- small things ------------------------------------------------------------------------------------------------ */

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double clamp(double x, double low, double high)
{
    return x < low ? low : x > high ? high : x;
}

static double smooth(double low, double high, double x)
{
    const double t = clamp((x - low) / (high - low), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

/* Unit vector along a. */
static void direction(const double a[3], const double other[3], double out[3])
{
    double l2 = 0.0;
    for (int k = 0; k < 3; ++k) {
        out[k] = a[k] + 2e-5 * other[k]; /* where little is left of a bent vector, it is the normal more and more */
        l2 += out[k] * out[k];
    }
    for (int k = 0; k < 3; ++k) {
        out[k] /= sqrt(l2);
    }
}

/* A visible surface does not look away from the eye; a shading normal may. (4) */
static void face(const double n[3], const double v[3], double out[3])
{
    const double lack = METHODS_FACING - dot(n, v);
    double       length = 1.0;
    for (int k = 0; k < 3; ++k) {
        out[k] = n[k] + (lack > 0.0 ? lack * v[k] : 0.0);
    }
    if (lack > 0.0) {
        length = sqrt(dot(out, out));
    }
    for (int k = 0; k < 3; ++k) {
        out[k] /= length;
    }
}

static double or_default(double value, double other)
{
    return value == 0.0 ? other : value;
}

static methods_options resolve(const methods_options *options)
{
    methods_options o = *options;
    int *const      choices[] = {&o.estimator, &o.occluder, &o.attenuation, &o.facing, &o.environment, &o.far_visibility,
                                 &o.bounce, &o.spacing};
    for (size_t i = 0; i < sizeof choices / sizeof choices[0]; ++i) {
        *choices[i] = *choices[i] ? *choices[i] : 1;
    }
    o.noise = o.noise ? o.noise : METHODS_NOISE_HILBERT_R2;
    o.sh_order = o.sh_order ? o.sh_order : 2;
    o.slices = o.slices ? o.slices : 3;
    o.steps = o.steps ? o.steps : 6;
    o.exponent = or_default(o.exponent, 2.0);
    o.falloff = or_default(o.falloff, 0.6);
    o.bias = or_default(o.bias, 0.001);
    o.angle_bias = or_default(o.angle_bias, 0.1);
    o.multiplier = or_default(o.multiplier, 1.0);
    o.thickness = or_default(o.thickness, 0.5);
    o.decay = or_default(o.decay, 0.1);
    o.pull = or_default(o.pull, 1e-5);
    o.near_intensity = or_default(o.near_intensity, 1.0);
    o.far_intensity = or_default(o.far_intensity, 1.0);
    o.ao_exponent = or_default(o.ao_exponent, 1.0);
    return o;
}

/* --- arcs of a slice --------------------------------------------------------------------------------------------- */

/* From V to t, |t| <= pi. */
static methods_moments arc_to(double t)
{
    const double    side = t < 0.0 ? -1.0 : 1.0, u = fabs(t), s = sin(u), c = cos(u);
    methods_moments m;
    m.solid = side * 2.0 * sin(0.5 * u) * sin(0.5 * u); /* 1 - c without its cancellation */
    m.x = 0.5 * (u - s * c);
    m.y = side * 0.5 * s * s;
    m.xx = side * (2.0 - c * (3.0 - c * c)) / 3.0;
    m.xy = s * s * s / 3.0;
    m.yy = side * (1.0 - c * c * c) / 3.0;
    return m;
}

methods_moments methods_arc(double t0, double t1)
{
    const methods_moments a = arc_to(t0), b = arc_to(t1);
    const methods_moments m = {b.solid - a.solid, b.x - a.x, b.y - a.y, b.xx - a.xx, b.xy - a.xy, b.yy - a.yy};
    return m;
}

double methods_energy(double nx, double ny, const methods_moments *arc)
{
    return nx * arc->x + ny * arc->y;
}

void methods_bent(double nx, double ny, const methods_moments *arc, double out[2])
{
    out[0] = nx * arc->xx + ny * arc->xy;
    out[1] = nx * arc->xy + ny * arc->yy;
}

/* (5), for ny >= 0 */
double methods_full(double nx, double ny)
{
    return fabs(ny) + fabs(nx) * atan2(fabs(nx), fabs(ny));
}

/* The hemisphere of n in its slice: gamma -+ pi/2. */
static double hemisphere_start(double nx, double ny)
{
    return atan2(nx, ny) - 0.5 * METHODS_PI;
}

double methods_cdf(double nx, double ny, double t)
{
    const double start = hemisphere_start(nx, ny), end = start + METHODS_PI;
    if (t <= start + 1e-9) { /* ends of the hemisphere that rounding moved stay ends */
        return 0.0;
    }
    if (t >= end - 1e-9) {
        return 1.0;
    }
    const methods_moments arc = methods_arc(start, t);
    return clamp(methods_energy(nx, ny, &arc) / methods_full(nx, ny), 0.0, 1.0);
}

double methods_cdf_inverse(double nx, double ny, double u)
{
    double low = hemisphere_start(nx, ny), high = low + METHODS_PI;
    if (u <= 0.0 || u >= 1.0) {
        return u <= 0.0 ? low : high;
    }
    for (int i = 0; i < 52; ++i) {
        const double middle = 0.5 * (low + high);
        if (methods_cdf(nx, ny, middle) < u) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return 0.5 * (low + high);
}

uint32_t methods_sectors(double u0, double u1, double jitter)
{
    const int low = (int)clamp(floor(METHODS_SECTORS * u0 + jitter), 0.0, METHODS_SECTORS);
    const int high = (int)clamp(floor(METHODS_SECTORS * u1 + jitter), 0.0, METHODS_SECTORS);
    uint32_t  bits = 0;
    for (int k = low; k < high; ++k) {
        bits |= UINT32_C(1) << k;
    }
    return bits;
}

/* Part of the arc from where the front of a source can be seen: w . s < 0, half of the circle. */
static void clip_lit(double sx, double sy, double *t0, double *t1)
{
    const double middle = atan2(-sx, -sy), from = *t0, to = *t1;
    double       low = to, high = to;
    for (int turn = -1; turn <= 1; ++turn) { /* arcs of half a circle at most overlap once */
        const double a = fmax(from, middle + 2.0 * METHODS_PI * turn - 0.5 * METHODS_PI);
        const double b = fmin(to, middle + 2.0 * METHODS_PI * turn + 0.5 * METHODS_PI);
        if (b - a > high - low) {
            low = a;
            high = b;
        }
    }
    *t0 = low;
    *t1 = high;
}

uint32_t methods_lit_sectors(double nx, double ny, double sx, double sy, double jitter)
{
    double t0 = hemisphere_start(nx, ny), t1 = t0 + METHODS_PI;
    clip_lit(sx, sy, &t0, &t1);
    return t1 > t0 ? methods_sectors(methods_cdf(nx, ny, t0), methods_cdf(nx, ny, t1), jitter) : 0;
}

/* --- weights ----------------------------------------------------------------------------------------------------- */

double methods_falloff(const methods_options *o, double distance)
{
    return o->reach > 0.0 ? clamp((1.0 - distance / o->reach) / or_default(o->falloff, 0.6), 0.0, 1.0) : 1.0;
}

double methods_attenuation(const methods_options *o, double distance)
{
    if (o->reach <= 0.0) {
        return 1.0;
    }
    const double r = distance / o->reach;
    return clamp(o->attenuation == METHODS_LINEAR ? 1.0 - r : 1.0 - r * r, 0.0, 1.0);
}

/* A fit from uniform visibility, here only because two articles use it on cosine visibility. (8) */
double methods_f0_ao(double ao)
{
    return ao * (1.0 + 0.5 * pow(fmax(1.0 - ao, 0.0), 0.75));
}

double methods_cone_cosine(const methods_options *o, double ao)
{
    const double hidden = clamp(1.0 - ao, 0.0, 1.0);
    return o->seed_compat & METHODS_CONE_RELATION ? hidden : sqrt(hidden);
}

double methods_multi_bounce(int bounce, double ao, double albedo)
{
    if (bounce == METHODS_CUBIC) {
        const double a = 2.0404 * albedo - 0.3324, b = -4.7951 * albedo + 0.6417, c = 2.7552 * albedo + 0.6903;
        return fmax(ao, ((a * ao + b) * ao + c) * ao);
    }
    return ao > 0.0 ? ao / (1.0 - albedo * (1.0 - ao)) : 0.0;
}

/* --- environment ------------------------------------------------------------------------------------------------- */

void methods_sh_basis(const double d[3], double out[9])
{
    const double x = d[0], y = d[1], z = d[2];
    const double k0 = 0.5 * sqrt(1.0 / METHODS_PI), k1 = sqrt(3.0 / (4.0 * METHODS_PI)), k2 = 0.5 * sqrt(15.0 / METHODS_PI);
    out[0] = k0;
    out[1] = k1 * y;
    out[2] = k1 * z;
    out[3] = k1 * x;
    out[4] = k2 * x * y;
    out[5] = k2 * y * z;
    out[6] = 0.25 * sqrt(5.0 / METHODS_PI) * (3.0 * z * z - 1.0);
    out[7] = k2 * x * z;
    out[8] = 0.5 * k2 * (x * x - y * y);
}

void methods_sh_sum(const double sh[9][3], int order, const double d[3], const double bands[3], double rgb[3])
{
    double y[9];
    methods_sh_basis(d, y);
    for (int c = 0; c < 3; ++c) {
        rgb[c] = 0.0;
        for (int k = 0; k < (order + 1) * (order + 1); ++k) {
            rgb[c] += bands[k < 1 ? 0 : k < 4 ? 1 : 2] * y[k] * sh[k][c];
        }
    }
}

/* Funk-Hecke, divided by pi. (8) */
void methods_cone_bands(double t, double out[3])
{
    out[0] = 1.0 - t * t;
    out[1] = 2.0 / 3.0 * (1.0 - t * t * t);
    out[2] = 0.25 * (1.0 - t * t) * (1.0 + 3.0 * t * t);
}

static void rotate_to_world(const methods_environment *env, const double d[3], double out[3])
{
    double any = 0.0;
    for (int k = 0; k < 9; ++k) {
        any += fabs(env->to_world[k]);
    }
    for (int k = 0; k < 3; ++k) {
        out[k] = any > 0.0 ? dot(env->to_world + 3 * k, d) : d[k];
    }
}

/* Position of x between grid points: lower point and part of the way to the next. */
static int cell_of(double x, int count, double *part)
{
    const double clamped = clamp(x, 0.0, count - 1);
    const int    low = (int)fmin(floor(clamped), fmax(count - 2, 0));
    *part = clamped - low;
    return low;
}

static void probe_sh(const methods_probes *g, const double position[3], double out[9][3])
{
    int    low[3];
    double part[3];
    for (int a = 0; a < 3; ++a) {
        low[a] = cell_of((position[a] - g->origin[a]) / g->step[a], g->count[a], &part[a]);
    }
    for (int k = 0; k < 27; ++k) {
        out[k / 3][k % 3] = 0.0;
    }
    for (int corner = 0; corner < 8; ++corner) {
        int    at[3];
        double weight = 1.0;
        for (int a = 0; a < 3; ++a) {
            const int up = corner >> a & 1;
            at[a] = low[a] + up < g->count[a] ? low[a] + up : low[a];
            weight *= up ? part[a] : 1.0 - part[a];
        }
        for (int k = 0; k < 27; ++k) {
            out[k / 3][k % 3] += weight * g->sh[at[0] + g->count[0] * (at[1] + g->count[1] * at[2])][k / 3][k % 3];
        }
    }
}

/* What the environment is at a receiver: its SH where it has some, else a function to ask. */
typedef struct surround {
    const methods_options *o;
    double                 sh[9][3];
    double                 position[3]; /* world */
} surround;

static void surround_of(const methods_options *o, const double position[3], surround *s)
{
    s->o = o;
    rotate_to_world(o->env, position, s->position);
    for (int k = 0; k < 3; ++k) {
        s->position[k] += o->env->eye[k];
    }
    if (o->environment == METHODS_PROBES) {
        probe_sh(o->env->probes, s->position, s->sh);
        return;
    }
    for (int k = 0; k < 27; ++k) {
        s->sh[k / 3][k % 3] = o->env->sh[k / 3][k % 3];
    }
}

static int has_sh(const methods_options *o)
{
    return o->environment == METHODS_SH || o->environment == METHODS_PROBES;
}

/* Bands 0, 1, 2 of the environment: of a scalar, a vector and a scalar times Y2 at a direction; all in the passes' space. */
static void sh_through(const surround *s, double band_0, const double band_1[3], double band_2, const double d[3],
                       double rgb[3])
{
    const double k0 = 0.5 / sqrt(METHODS_PI), k1 = sqrt(3.0 / (4.0 * METHODS_PI)), only_2[3] = {0.0, 0.0, band_2};
    double       b[3], world[3];
    rotate_to_world(s->o->env, band_1, b);
    rotate_to_world(s->o->env, d, world);
    methods_sh_sum((const double(*)[3])s->sh, s->o->sh_order, world, only_2, rgb);
    for (int c = 0; c < 3; ++c) {
        rgb[c] += k0 * band_0 * s->sh[0][c] + k1 * (b[1] * s->sh[1][c] + b[2] * s->sh[2][c] + b[0] * s->sh[3][c]);
    }
}

static void far_sh(const surround *s, const double n[3], double ao, const double bent[3], double rgb[3])
{
    const methods_options *o = s->o;
    const double           t = methods_cone_cosine(o, ao);
    double                 d[3], axis[3], bands[3], band_1[3], share = ao;
    direction(bent, n, axis);
    methods_cone_bands(o->far_visibility == METHODS_BENT || o->far_visibility == METHODS_CONE ? t : 0.0, bands);
    for (int k = 0; k < 3; ++k) {
        d[k] = o->far_visibility == METHODS_AO ? n[k] : axis[k];
    }
    if (o->far_visibility == METHODS_BENT) {
        sh_through(s, ao, bent, bands[2], d, rgb);
        return;
    }
    if (o->far_visibility == METHODS_CONE) {
        share = 1.0; /* the aperture holds it */
    } else if (o->seed_compat & METHODS_F0_AO) {
        share = methods_f0_ao(ao);
    }
    for (int k = 0; k < 3; ++k) {
        band_1[k] = share * bands[1] * d[k];
    }
    sh_through(s, share * bands[0], band_1, share * bands[2], d, rgb);
}

void methods_far(const methods_options *options, const double position[3], const double n[3], double ao,
                 const double bent[3], double rgb[3])
{
    const methods_options o = resolve(options);
    const int             fitted = (o.seed_compat & METHODS_F0_AO) != 0;
    const double          share = fitted ? methods_f0_ao(ao) : ao;
    surround              s;
    double                axis[3], world[3];
    if (o.environment == METHODS_CONSTANT) {
        for (int c = 0; c < 3; ++c) {
            rgb[c] = fmax(share * o.env->color[c], 0.0);
        }
        return;
    }
    surround_of(&o, position, &s);
    if (has_sh(&o)) {
        far_sh(&s, n, ao, bent, rgb);
    } else {
        direction(bent, n, axis);
        rotate_to_world(o.env, o.far_visibility == METHODS_AO ? n : axis, world);
        o.env->lookup(o.env->user, s.position, world, methods_cone_cosine(&o, ao), rgb);
        for (int c = 0; c < 3; ++c) {
            rgb[c] *= o.far_visibility == METHODS_BENT ? ao : share;
        }
    }
    for (int c = 0; c < 3; ++c) {
        rgb[c] = fmax(rgb[c], 0.0);
    }
}

/* --- specular occlusion (11.4) ----------------------------------------------------------------------------------- */

double methods_caps(double r1, double r2, double d)
{
    if (d >= r1 + r2) {
        return 0.0;
    }
    if (d <= fabs(r1 - r2)) {
        const double half = sin(0.5 * fmin(r1, r2));
        return 4.0 * METHODS_PI * half * half;
    }
    const double c1 = cos(r1), c2 = cos(r2), cd = cos(d), s1 = sin(r1), s2 = sin(r2), sd = sin(d);
    return 2.0 * (METHODS_PI - acos(clamp((cd - c1 * c2) / (s1 * s2), -1.0, 1.0)) -
                  c1 * acos(clamp((c2 - cd * c1) / (sd * s1), -1.0, 1.0)) -
                  c2 * acos(clamp((c1 - cd * c2) / (sd * s2), -1.0, 1.0)));
}

static double angle_between(const double a[3], const double b[3])
{
    const double cross[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
    return atan2(sqrt(dot(cross, cross)), dot(a, b));
}

double methods_specular_occlusion(const double n[3], const double v[3], double ao, const double axis[3], double roughness)
{
    const double r = fmax(roughness, 0.02), lobe = acos(pow(10.0, -r * r));
    const double seen_half = acos(sqrt(clamp(1.0 - ao, 0.0, 1.0)));
    double       mirror[3];
    for (int k = 0; k < 3; ++k) {
        mirror[k] = 2.0 * dot(n, v) * n[k] - v[k];
    }
    const double seen = methods_caps(seen_half, lobe, angle_between(axis, mirror));
    const double open = methods_caps(0.5 * METHODS_PI, lobe, angle_between(n, mirror));
    const double gtso = open > 0.0 ? clamp(seen / open, 0.0, 1.0) : 0.0, rough = smooth(0.5, 0.8, roughness);
    return (1.0 - rough) * gtso + rough * ao;
}

/* --- one slice --------------------------------------------------------------------------------------------------- */

/* Sums over the slices. */
typedef struct sums {
    double full, open, hidden, solid, bent[3], near[3], far[3];
    double sh_solid[4], sh_vector[3][4]; /* rgb light, a visibility */
} sums;

typedef struct plane {
    const methods_options *o;
    const methods_pixel   *p;
    const double          *n;      /* turned to the eye */
    const double          *tangent;
    double                 nx, ny, full, jitter;
    sums                  *sum;
} plane;

/* A sample as its slice sees it. */
typedef struct view {
    double along[3], distance, c, above; /* c: cosine to V, above: sine of the elevation over the tangent plane */
} view;

static view view_of(const plane *s, const double position[3])
{
    view   at;
    double h[3];
    for (int k = 0; k < 3; ++k) {
        h[k] = position[k] - s->p->position[k];
    }
    at.distance = sqrt(fmax(dot(h, h), 1e-30));
    for (int k = 0; k < 3; ++k) {
        at.along[k] = h[k] / at.distance;
    }
    at.c = clamp(dot(at.along, s->p->v), -1.0, 1.0);
    at.above = dot(at.along, s->n);
    return at;
}

/* Signed angle of a horizon. side 0: +D, 1: -D. */
static double angle_of(int side, double c)
{
    return side ? -acos(c) : acos(c);
}

/* Horizon of the tangent plane on a side. */
static double tangent_horizon(const plane *s, int side)
{
    return clamp((side ? s->nx : -s->nx) / sqrt(fmax(s->nx * s->nx + s->ny * s->ny, 1e-20)), -1.0, 1.0);
}

/* The arc of a side between the horizons c and higher, in rising t. */
static void arc_of(int side, double c, double higher, double *t0, double *t1)
{
    *t0 = side ? angle_of(side, c) : angle_of(side, higher);
    *t1 = side ? angle_of(side, higher) : angle_of(side, c);
}

static double side_energy(const plane *s, int side, double c, double higher)
{
    double t0, t1;
    arc_of(side, c, higher, &t0, &t1);
    const methods_moments arc = methods_arc(t0, t1);
    return methods_energy(s->nx, s->ny, &arc);
}

static void add_vector(const plane *s, double x, double y, double out[3])
{
    for (int k = 0; k < 3; ++k) {
        out[k] += x * s->tangent[k] + y * s->p->v[k];
    }
}

static void add_sh(const plane *s, const methods_moments *arc, int channel, double value)
{
    double w[3] = {0.0, 0.0, 0.0};
    add_vector(s, arc->x, arc->y, w);
    s->sum->sh_solid[channel] += value * arc->solid;
    for (int k = 0; k < 3; ++k) {
        s->sum->sh_vector[k][channel] += value * w[k];
    }
}

static void add_free(const plane *s, double t0, double t1)
{
    const methods_moments arc = methods_arc(t0, t1);
    double                bent[2];
    methods_bent(s->nx, s->ny, &arc, bent);
    if (s->o->seed_compat & METHODS_UNIFORM_BENT && s->o->estimator == METHODS_HORIZON) {
        bent[0] = arc.x; /* length 1 where all is open */
        bent[1] = arc.y;
    }
    s->sum->open += methods_energy(s->nx, s->ny, &arc);
    s->sum->solid += arc.solid;
    add_vector(s, bent[0], bent[1], s->sum->bent);
    add_sh(s, &arc, 3, 1.0);
}

static void add_lit(const plane *s, double t0, double t1, const double light[3])
{
    const methods_moments arc = methods_arc(t0, t1);
    for (int c = 0; c < 3; ++c) {
        s->sum->near[c] += methods_energy(s->nx, s->ny, &arc) * light[c];
        add_sh(s, &arc, c, light[c]);
    }
}

/* Radiance that a sample gives the receiver; accepted: what the facing filter falls back to. */
static void source_light(const plane *s, const methods_sample *sample, const view *at, double accepted[3], double out[3])
{
    double top = 0.0, scale = 1.0, part = 1.0;
    for (int c = 0; c < 3; ++c) {
        out[c] = sample->radiance[c] > 0.0 ? fmin(sample->radiance[c], 60000.0) : 0.0;
        top = fmax(top, out[c]);
    }
    if (s->o->firefly > 0.0 && top > s->o->firefly) {
        scale = s->o->firefly / top;
    }
    if (s->o->facing == METHODS_FACING_FILTER) {
        part = smooth(METHODS_FILTER_LOW, METHODS_FILTER_HIGH, -dot(sample->normal, at->along));
    }
    for (int c = 0; c < 3; ++c) {
        accepted[c] = (1.0 - part) * accepted[c] + part * scale * out[c];
        out[c] = accepted[c];
    }
}

/* --- horizon ----------------------------------------------------------------------------------------------------- */

/* Light of a side whose horizon may sink again: sum E and weight W of all that is in front, (11.1). */
typedef struct sinking { double light[3], weight; } sinking;

static void rise_to(const plane *s, int side, double c, double higher, const methods_sample *sample, const view *at,
                    double accepted[3], sinking *sink)
{
    double light[3], t0, t1;
    source_light(s, sample, at, accepted, light);
    arc_of(side, c, higher, &t0, &t1);
    if (s->o->facing == METHODS_FACING_HALF_SPACE) {
        clip_lit(dot(sample->normal, s->tangent), dot(sample->normal, s->p->v), &t0, &t1);
    }
    if (s->o->occluder != METHODS_HEURISTIC) {
        add_lit(s, t0, t1, light);
        return;
    }
    const methods_moments arc = methods_arc(t0, t1);
    for (int k = 0; k < 3; ++k) {
        sink->light[k] += methods_energy(s->nx, s->ny, &arc) * light[k];
    }
    sink->weight += side_energy(s, side, c, higher);
}

/* Lower the horizon from c: light and weight shrink alike. */
static double sink_to(const plane *s, int side, double c0, double c, double sample, sinking *sink)
{
    const double k = 1.0 - pow(1.0 - s->o->decay, METHODS_DECAY_STEPS / s->o->steps);
    const double lower = fmax(c0, c + k * (fmin(c, sample) - c)), before = side_energy(s, side, c0, c);
    const double part = before > 1e-300 ? side_energy(s, side, c0, lower) / before : 0.0;
    sink->weight *= part;
    for (int i = 0; i < 3; ++i) {
        sink->light[i] *= part;
    }
    return lower;
}

static double run_horizon(const plane *s, int side, const methods_slice *slice)
{
    const double c0 = tangent_horizon(s, side);
    double       c = c0, accepted[3] = {0.0, 0.0, 0.0}, t0, t1;
    sinking      sink = {{0.0, 0.0, 0.0}, 0.0};
    for (int i = 0; i < slice->count[side]; ++i) {
        const methods_sample *sample = &slice->sample[side][i];
        if (sample->skip) {
            continue;
        }
        const view   at = view_of(s, sample->position);
        const double higher = c0 + methods_falloff(s->o, at.distance) * (at.c - c0);
        if (higher > c && at.above > s->o->bias) {
            rise_to(s, side, c, higher, sample, &at, accepted, &sink);
            c = higher;
        } else if (s->o->occluder == METHODS_HEURISTIC) {
            c = sink_to(s, side, c0, c, higher, &sink);
        }
    }
    if (s->o->occluder == METHODS_HEURISTIC) {
        arc_of(side, c0, c, &t0, &t1);
        const methods_moments arc = methods_arc(t0, t1);
        for (int k = 0; k < 3; ++k) {
            s->sum->near[k] += sink.light[k];
            add_sh(s, &arc, k, sink.weight > 1e-300 ? sink.light[k] / sink.weight : 0.0);
        }
    }
    return c;
}

static void slice_horizon(const plane *s, const methods_slice *slice)
{
    const double front = run_horizon(s, 0, slice), back = run_horizon(s, 1, slice);
    add_free(s, angle_of(1, back), angle_of(0, front));
}

/* --- bitmask (11.5) ---------------------------------------------------------------------------------------------- */

/* Angles of sector edges, each found once. */
typedef struct edges { double t[METHODS_SECTORS + 1]; int known[METHODS_SECTORS + 1]; } edges;

static double edge_angle(const plane *s, edges *e, int k)
{
    if (!e->known[k]) {
        e->t[k] = methods_cdf_inverse(s->nx, s->ny, (double)k / METHODS_SECTORS);
        e->known[k] = 1;
    }
    return e->t[k];
}

/* Next run of set bits from *low on: [*low, *high). 0: none. */
static int next_run(uint32_t bits, int *low, int *high)
{
    while (*low < METHODS_SECTORS && !(bits >> *low & 1)) {
        ++*low;
    }
    *high = *low;
    while (*high < METHODS_SECTORS && bits >> *high & 1) {
        ++*high;
    }
    return *high > *low;
}

/* Horizon at which the occluder behind a sample ends. */
static double low_end(const plane *s, int side, const methods_sample *sample)
{
    const double c0 = tangent_horizon(s, side), length = sqrt(dot(sample->position, sample->position));
    double       back[3];
    if (s->o->occluder != METHODS_THICK) {
        return c0;
    }
    for (int k = 0; k < 3; ++k) { /* along the sample's own view ray */
        back[k] = sample->position[k] + s->o->thickness * (s->p->orthographic ? -s->p->v[k] : sample->position[k] / length);
    }
    return fmax(view_of(s, back).c, c0);
}

static void fill_side(const plane *s, int side, const methods_slice *slice, edges *e, uint32_t *hidden)
{
    double accepted[3] = {0.0, 0.0, 0.0}, light[3], t0, t1;
    for (int i = 0; i < slice->count[side]; ++i) {
        const methods_sample *sample = &slice->sample[side][i];
        if (sample->skip) {
            continue;
        }
        const view   at = view_of(s, sample->position);
        const double low = low_end(s, side, sample), high = low + methods_falloff(s->o, at.distance) * (at.c - low);
        if (high <= low || at.above <= s->o->bias) {
            continue;
        }
        arc_of(side, low, high, &t0, &t1);
        const uint32_t bits = methods_sectors(methods_cdf(s->nx, s->ny, t0), methods_cdf(s->nx, s->ny, t1), s->jitter);
        uint32_t       fresh = bits & ~*hidden;
        *hidden |= bits;
        if (!fresh) {
            continue;
        }
        source_light(s, sample, &at, accepted, light);
        if (s->o->facing == METHODS_FACING_HALF_SPACE) {
            fresh &= methods_lit_sectors(s->nx, s->ny, dot(sample->normal, s->tangent), dot(sample->normal, s->p->v),
                                         s->jitter);
        }
        for (int from = 0, to = 0; next_run(fresh, &from, &to); from = to) {
            add_lit(s, edge_angle(s, e, from), edge_angle(s, e, to), light);
        }
    }
}

/* Environment through a group of free sectors: radiance in their mean direction; bands 0 and 1 exactly. */
static void far_group(const plane *s, edges *e, uint32_t bits)
{
    surround at;
    double   energy = 0.0, bent[3] = {0.0, 0.0, 0.0}, axis[3], world[3], rgb[3];
    for (int from = 0, to = 0; next_run(bits, &from, &to); from = to) {
        const methods_moments arc = methods_arc(edge_angle(s, e, from), edge_angle(s, e, to));
        double                b[2];
        methods_bent(s->nx, s->ny, &arc, b);
        energy += methods_energy(s->nx, s->ny, &arc);
        add_vector(s, b[0], b[1], bent);
    }
    for (int k = 0; k < 3; ++k) {
        world[k] = bent[k] / energy;
    }
    direction(world, s->n, axis);
    surround_of(s->o, s->p->position, &at);
    if (has_sh(s->o)) {
        sh_through(&at, energy, bent, energy, axis, rgb);
    } else {
        rotate_to_world(s->o->env, axis, world);
        s->o->env->lookup(s->o->env->user, at.position, world, 1.0, rgb);
        for (int c = 0; c < 3; ++c) {
            rgb[c] *= energy;
        }
    }
    for (int c = 0; c < 3; ++c) {
        s->sum->far[c] += rgb[c];
    }
}

static int samples_environment(const methods_options *o)
{
    return o->far_visibility == METHODS_FREE_BITS && o->estimator == METHODS_BITMASK && o->environment > METHODS_CONSTANT;
}

static void slice_bitmask(const plane *s, const methods_slice *slice)
{
    edges    e = {{0.0}, {0}};
    uint32_t hidden = 0;
    fill_side(s, 0, slice, &e, &hidden);
    fill_side(s, 1, slice, &e, &hidden);
    for (int from = 0, to = 0; next_run(~hidden, &from, &to); from = to) {
        add_free(s, edge_angle(s, &e, from), edge_angle(s, &e, to));
    }
    for (int group = 0; group < METHODS_SECTORS && samples_environment(s->o); group += 8) {
        const uint32_t bits = ~hidden & UINT32_C(0xff) << group;
        if (bits) {
            far_group(s, &e, bits);
        }
    }
}

/* --- hbao, hbao_plus (13) ---------------------------------------------------------------------------------------- */

static void slice_hbao(const plane *s, const methods_slice *slice)
{
    for (int side = 0; side < 2; ++side) {
        double c = fmin(tangent_horizon(s, side) + s->o->angle_bias, 1.0);
        for (int i = 0; i < slice->count[side]; ++i) {
            if (slice->sample[side][i].skip) {
                continue;
            }
            const view at = view_of(s, slice->sample[side][i].position);
            if (at.c > c) {
                s->sum->hidden += 0.5 * methods_attenuation(s->o, at.distance) * (at.c - c);
                c = at.c;
            }
        }
    }
}

static void slice_hbao_plus(const plane *s, const methods_slice *slice)
{
    for (int side = 0; side < 2; ++side) {
        for (int i = 0; i < slice->count[side]; ++i) {
            if (slice->sample[side][i].skip) {
                continue;
            }
            const view at = view_of(s, slice->sample[side][i].position);
            s->sum->hidden += s->o->multiplier / s->o->steps * clamp(at.above - s->o->angle_bias, 0.0, 1.0) *
                              methods_attenuation(s->o, at.distance);
        }
    }
}

/* --- a pixel ----------------------------------------------------------------------------------------------------- */

static void march(const methods_options *o, const methods_pixel *p, const double n[3], sums *sum)
{
    for (int i = 0; i < p->slices; ++i) {
        const methods_slice *slice = &p->slice[i];
        plane                s = {.o = o, .p = p, .n = n, .tangent = slice->tangent, .jitter = slice->jitter, .sum = sum};
        s.nx = dot(n, slice->tangent);
        s.ny = dot(n, p->v);
        s.full = methods_full(s.nx, s.ny);
        sum->full += s.full;
        if (o->estimator == METHODS_HORIZON) {
            slice_horizon(&s, slice);
        } else if (o->estimator == METHODS_BITMASK) {
            slice_bitmask(&s, slice);
        } else if (o->estimator == METHODS_HBAO) {
            slice_hbao(&s, slice);
        } else {
            slice_hbao_plus(&s, slice);
        }
    }
}

static void store_sh(const sums *sum, double slices, double ratio, double near_intensity, double out[4][4])
{
    static const int axis[4] = {0, 1, 2, 0}; /* of layers 1 to 3: y, z, x */
    const double     k0 = 0.5 / sqrt(METHODS_PI), k1 = sqrt(3.0 / (4.0 * METHODS_PI));
    for (int c = 0; c < 4; ++c) {
        const double factor = METHODS_PI * (c < 3 ? near_intensity : 1.0);
        out[0][c] = k0 * factor / slices * sum->sh_solid[c];
        for (int k = 1; k < 4; ++k) {
            out[k][c] = k1 * factor / ratio * sum->sh_vector[axis[k]][c];
        }
    }
}

/* Outputs that are sums over slices. */
static void store_sums(const methods_options *o, const methods_pixel *p, const sums *sum, methods_result *r)
{
    const double slices = p->slices, ratio = o->seed_compat & METHODS_SLICE_MEAN ? slices : sum->full;
    r->full = sum->full;
    r->open = sum->open;
    if (o->estimator == METHODS_HBAO || o->estimator == METHODS_HBAO_PLUS) {
        r->ao = pow(clamp(1.0 - sum->hidden / slices, 0.0, 1.0), o->ao_exponent);
        return;
    }
    const double ao = clamp(sum->open / ratio, 0.0, 1.0), lift = ao > 0.0 ? pow(ao, o->ao_exponent - 1.0) : 0.0;
    r->ao = ao * lift;
    r->uniform_ao = 0.5 * sum->solid / slices;
    store_sh(sum, slices, ratio, o->near_intensity, r->sh);
    for (int k = 0; k < 3; ++k) {
        r->bent[k] = lift * sum->bent[k] / slices; /* the mean: exact on an open surface, which the ratio is not */
        r->near[k] = sum->near[k] / ratio * o->near_intensity * (1.0 - clamp(p->f0[k], 0.0, 1.0));
        r->far[k] = fmax(sum->far[k], 0.0) / ratio * o->far_intensity * (1.0 - clamp(p->f0[k], 0.0, 1.0));
    }
}

/* Outputs that follow from those. */
static void store_light(const methods_options *o, const methods_pixel *p, const double n[3], methods_result *r)
{
    const int cosine = o->estimator == METHODS_HORIZON || o->estimator == METHODS_BITMASK;
    double    axis[3], far[3];
    direction(r->bent, n, axis);
    if (cosine) {
        for (int k = 0; k < 3; ++k) {
            r->cone[k] = axis[k];
        }
        r->cone[3] = methods_cone_cosine(o, r->ao);
        r->specular_occlusion = methods_specular_occlusion(n, p->v, r->ao, axis,
                                                           o->roughness > 0.0 ? o->roughness : p->roughness);
    }
    if (o->environment != METHODS_ENVIRONMENT_NONE && !samples_environment(o)) {
        methods_far(o, p->position, n, r->ao, r->bent, far);
        for (int k = 0; k < 3; ++k) {
            r->far[k] = far[k] * o->far_intensity * (1.0 - clamp(p->f0[k], 0.0, 1.0));
        }
    }
    for (int k = 0; k < 3; ++k) {
        const double albedo = clamp(p->albedo[k], 0.0, 1.0);
        r->multi_bounce[k] = methods_multi_bounce(o->bounce, r->ao, albedo);
        r->irradiance[k] = r->near[k] + r->far[k];
        r->composite[k] = p->direct[k] + albedo * r->irradiance[k];
    }
}

void methods_light(const methods_options *options, const methods_pixel *pixel, methods_result *result)
{
    const methods_options o = resolve(options);
    const methods_result  none = {0};
    sums                  sum = {0};
    double                n[3];
    *result = none;
    if (pixel->sky) {
        result->ao = result->uniform_ao = result->specular_occlusion = 1.0;
        for (int k = 0; k < 3; ++k) {
            result->multi_bounce[k] = 1.0;
            result->composite[k] = pixel->direct[k];
        }
        return;
    }
    face(pixel->normal, pixel->v, n);
    march(&o, pixel, n, &sum);
    store_sums(&o, pixel, &sum, result);
    store_light(&o, pixel, n, result);
}

/* --- slices and samples as the march takes them ------------------------------------------------------------------ */

static uint32_t hilbert(uint32_t x, uint32_t y)
{
    uint32_t index = 0;
    for (uint32_t side = 32; side > 0; side >>= 1) {
        const uint32_t rx = (x & side) != 0, ry = (y & side) != 0;
        index += side * side * ((3 * rx) ^ ry);
        if (!ry) {
            const uint32_t old = rx ? 63 - x : x;
            x = rx ? 63 - y : y;
            y = old;
        }
    }
    return index;
}

/* In floats, as on the device: the factor makes a different number of every rounding. */
static double gradient(float x, float y)
{
    const float inner = 0.06711056f * x + 0.00583715f * y, outer = 52.9829189f * (inner - floorf(inner));
    return (double)(outer - floorf(outer));
}

void methods_noise(int noise, uint32_t frame_index, int x, int y, double out[3])
{
    static const uint32_t factor[3] = {3242174889u, 2447445414u, 2654435769u};
    const uint32_t        index = hilbert((uint32_t)x & 63, (uint32_t)y & 63) + 288 * frame_index;
    const float           shift = 5.588238f * (float)(frame_index & 63), fx = (float)x + shift, fy = (float)y + shift;
    for (int k = 0; k < 3; ++k) {
        out[k] = noise == METHODS_NOISE_NONE ? 0.5 : (double)((factor[k] * index + 2147483648u) >> 8) / 16777216.0;
    }
    if (noise == METHODS_NOISE_IGN) {
        out[0] = gradient(fx, fy);
        out[1] = gradient(fy + 47.0f, fx + 17.0f);
        out[2] = gradient(fx + 31.0f, fy + 83.0f);
    }
}

/* Camera, receiver and noise of a pixel while its slices are made. */
typedef struct placing {
    const methods_options *o;
    const bf_scene        *scene;
    const methods_pixel   *p;
    int                    x, y;
    double                 depth; /* of the receiver, pulled */
} placing;

static void position_at(const bf_camera *cam, double px, double py, double z, double out[3])
{
    const double scale = cam->orthographic ? 1.0 : z;
    out[0] = (px * cam->ray[0] + cam->ray[2]) * scale;
    out[1] = (py * cam->ray[1] + cam->ray[3]) * scale;
    out[2] = z;
}

static int is_sky(const bf_scene *s, double z)
{
    return !(z < s->sky_depth) || (!s->camera.orthographic && z <= 0.0);
}

/* Direction on the screen, per pixel, in which the slice's tangent leaves the receiver. */
static void screen_direction(const placing *a, const double tangent[3], double out[2])
{
    const bf_camera *cam = &a->scene->camera;
    const double    *v = a->p->v;
    for (int k = 0; k < 2; ++k) {
        out[k] = (cam->orthographic ? tangent[k] : v[k] * tangent[2] - tangent[k] * v[2]) / cam->ray[k];
    }
    const double length = sqrt(out[0] * out[0] + out[1] * out[1]);
    out[0] /= length;
    out[1] /= length;
}

/* Pixels up to where the sphere of the reach ends as seen from the eye, in the slice. */
static double reach_px(const placing *a, const double tangent[3])
{
    const bf_camera *cam = &a->scene->camera;
    const double    *p = a->p->position, *v = a->p->v, s = fmin(a->o->reach / sqrt(dot(p, p)), 1.0);
    if (cam->orthographic) {
        return hypot(a->o->reach * tangent[0] / cam->ray[0], a->o->reach * tangent[1] / cam->ray[1]);
    }
    const double across = sqrt(1.0 - s * s), z = tangent[2] * s - v[2] * across;
    if (s >= 1.0 || z <= 1e-4) {
        return 1e6;
    }
    return hypot(((tangent[0] * s - v[0] * across) / z - p[0] / p[2]) / cam->ray[0],
                 ((tangent[1] * s - v[1] * across) / z - p[1] / p[2]) / cam->ray[1]);
}

static double border_px(const placing *a, const double d[2])
{
    const bf_camera *cam = &a->scene->camera;
    const double     room_x = (d[0] > 0.0 ? cam->width - 1 - a->x : a->x) + 0.49;
    const double     room_y = (d[1] > 0.0 ? cam->height - 1 - a->y : a->y) + 0.49;
    return fmin(room_x / fmax(fabs(d[0]), 1e-6), room_y / fmax(fabs(d[1]), 1e-6));
}

static double offset_px(const methods_options *o, double t, double reach)
{
    if (o->spacing == METHODS_GEOMETRIC) {
        return pow(fmax(reach, 1.0), t);
    }
    return 1.0 + pow(t, o->exponent) * (reach - 1.0);
}

static void sample_at(const placing *a, int x, int y, methods_sample *out)
{
    const bf_scene      *s = a->scene;
    const int            pixel = y * s->camera.width + x;
    const double         z = (double)s->depth[pixel];
    const methods_sample none = {.skip = 1};
    *out = none;
    if (is_sky(s, z)) {
        return;
    }
    out->skip = 0;
    position_at(&s->camera, x + 0.5, y + 0.5, z, out->position);
    for (int k = 0; k < 3; ++k) {
        out->normal[k] = s->normal ? (double)s->normal[3 * pixel + k] * (k == 2 ? -1.0 : 1.0) : 0.0;
        out->radiance[k] = s->radiance ? (double)s->radiance[3 * pixel + k] : 0.0;
    }
}

/* Samples of the side along the unit screen direction d. */
static int place_side(const placing *a, const double tangent[3], const double d[2], double jitter, methods_sample *out)
{
    const bf_camera *cam = &a->scene->camera;
    double           reach = border_px(a, d), offset = 0.0;
    if (a->o->reach > 0.0) {
        reach = fmin(reach, reach_px(a, tangent));
    }
    for (int i = 0; i < a->o->steps; ++i) {
        offset = fmax(offset_px(a->o, (i + jitter) / a->o->steps, reach), offset + 1.0);
        const int x = a->x + (int)floor(offset * d[0] + 0.5), y = a->y + (int)floor(offset * d[1] + 0.5);
        if (offset > reach || x < 0 || y < 0 || x >= cam->width || y >= cam->height) {
            return i;
        }
        sample_at(a, x, y, &out[i]);
    }
    return a->o->steps;
}

/* Tangent of the slice at angle phi, and its direction on the screen. */
static void place_tangent(const placing *a, double phi, double tangent[3], double d[2])
{
    const bf_camera *cam = &a->scene->camera;
    const double    *v = a->p->v, c = cos(phi), s = sin(phi);
    if (a->o->seed_compat & METHODS_SCREEN_AZIMUTH) {
        const double along = c * v[0] + s * v[1], length = sqrt(1.0 - along * along);
        const double turn[3] = {c, s, 0.0}, across = hypot(c / cam->ray[0], s / cam->ray[1]);
        for (int k = 0; k < 3; ++k) {
            tangent[k] = (turn[k] - along * v[k]) / length;
        }
        d[0] = c / cam->ray[0] / across;
        d[1] = s / cam->ray[1] / across;
        return;
    }
    const double b = 1.0 / (1.0 - v[2]);
    const double e1[3] = {1.0 - v[0] * v[0] * b, -v[0] * v[1] * b, v[0]};
    const double e2[3] = {v[0] * v[1] * b, v[1] * v[1] * b - 1.0, -v[1]};
    for (int k = 0; k < 3; ++k) {
        tangent[k] = c * e1[k] + s * e2[k];
    }
    screen_direction(a, tangent, d);
}

static void place_receiver(placing *a, methods_pixel *p)
{
    const bf_scene *s = a->scene;
    const int       pixel = a->y * s->camera.width + a->x;
    double          ray[3], length = 0.0;
    const double    z = (double)s->depth[pixel];
    a->depth = z - a->o->pull * fabs(z);
    position_at(&s->camera, a->x + 0.5, a->y + 0.5, a->depth, p->position);
    position_at(&s->camera, a->x + 0.5, a->y + 0.5, 1.0, ray);
    p->orthographic = s->camera.orthographic;
    for (int k = 0; k < 3; ++k) {
        ray[k] = p->orthographic ? (k == 2) : ray[k];
        p->normal[k] = (double)s->normal[3 * pixel + k] * (k == 2 ? -1.0 : 1.0);
        length += p->normal[k] * p->normal[k];
    }
    for (int k = 0; k < 3; ++k) {
        p->v[k] = -ray[k] / sqrt(dot(ray, ray));
        p->normal[k] /= sqrt(length);
    }
}

static int reserve(methods_work *w, int samples)
{
    if (samples > w->capacity) {
        methods_sample *more = realloc(w->sample, (size_t)samples * sizeof *more);
        if (!more) {
            return 0;
        }
        w->sample = more;
        w->capacity = samples;
    }
    return 1;
}

int methods_place(const methods_options *options, const bf_scene *scene, int x, int y, methods_work *work,
                  methods_pixel *pixel)
{
    const methods_options o = resolve(options);
    const methods_pixel   empty = {0};
    placing               a = {.o = &o, .scene = scene, .p = pixel, .x = x, .y = y};
    double                noise[3];
    *pixel = empty;
    pixel->sky = is_sky(scene, (double)scene->depth[y * scene->camera.width + x]);
    if (pixel->sky) {
        return 1;
    }
    if (o.slices > METHODS_MAX_SLICES || !reserve(work, 2 * o.slices * o.steps)) {
        return 0;
    }
    place_receiver(&a, pixel);
    methods_noise(o.noise, o.frame_index, x, y, noise);
    for (int i = 0; i < o.slices; ++i) {
        methods_slice *slice = &work->slice[i];
        const double   phi = o.seed_compat & METHODS_NOISE_2PI ? i * METHODS_PI / o.slices + noise[0] * 2.0 * METHODS_PI :
                                                                 (i + noise[0]) * METHODS_PI / o.slices;
        const double   turn = noise[2] + i * 0.61803399;
        double         d[2];
        place_tangent(&a, phi, slice->tangent, d);
        slice->jitter = turn - floor(turn);
        for (int side = 0; side < 2; ++side) {
            methods_sample *samples = work->sample + (2 * i + side) * o.steps;
            const double    sign = side ? -1.0 : 1.0, towards[2] = {sign * d[0], sign * d[1]};
            const double    along[3] = {sign * slice->tangent[0], sign * slice->tangent[1], sign * slice->tangent[2]};
            slice->count[side] = place_side(&a, along, towards, noise[1], samples);
            slice->sample[side] = samples;
        }
    }
    pixel->slice = work->slice;
    pixel->slices = o.slices;
    return 1;
}

void methods_work_free(methods_work *work)
{
    free(work->sample);
    work->sample = NULL;
    work->capacity = 0;
}
