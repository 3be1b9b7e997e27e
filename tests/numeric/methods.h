/* methods.h - every estimator and every output of one pixel in double precision, from their definitions: what the emitted
 * shaders are held to. Exact acos, signed angles, exact inverse of the sectors' map by bisection; no formula is shared with
 * the GLSL.
 *
 * Space: that of the passes, x right, y up, z into the screen, metres, eye at the origin. Views that look down -z, and world
 * space, are the caller's. A slice is the plane of V (unit, to the eye) and D (unit, across V); a direction in it is
 * sin(t) D + cos(t) V with t in (-pi, pi], and its solid angle |sin t| dt dazimuth. nx = n.D, ny = n.V. Units as in hbil.h:
 * irradiance is E/pi.
 *
 *     methods_options o = {.estimator = METHODS_BITMASK, .occluder = METHODS_THICK, .slices = 4, .steps = 16};
 *     methods_work    w = {0};
 *     methods_pixel   p;
 *     methods_result  r;
 *     methods_place(&o, &scene, x, y, &w, &p);   // or slices and samples of your own
 *     methods_light(&o, &p, &r);                 // r.ao, r.near, ...; vectors in the space above */
#ifndef HBIL_TESTS_METHODS_H
#define HBIL_TESTS_METHODS_H

#include <stdint.h>

#include "brute_force.h"

#define METHODS_PI 3.14159265358979323846
#define METHODS_MAX_SLICES 64
#define METHODS_SECTORS 32
#define METHODS_DECAY_STEPS 8.0 /* steps per side that `decay` is meant for */
#define METHODS_FILTER_LOW -0.1 /* facing filter: cosines at the source; the paper gives none */
#define METHODS_FILTER_HIGH 0.1
#define METHODS_FACING 0.001    /* normals are turned until n.V is no smaller */

/* The enumerators have the values of their namesakes in hbil.h. Zero is the first. */
enum { METHODS_HORIZON = 1, METHODS_BITMASK, METHODS_HBAO, METHODS_HBAO_PLUS };
enum { METHODS_HEIGHT_FIELD = 1, METHODS_THICK, METHODS_HEURISTIC };
enum { METHODS_QUADRATIC = 1, METHODS_LINEAR };
enum { METHODS_FACING_NONE = 1, METHODS_FACING_FILTER, METHODS_FACING_HALF_SPACE };
enum { METHODS_ENVIRONMENT_NONE = 1, METHODS_CONSTANT, METHODS_SH, METHODS_CUBE, METHODS_PROBES, METHODS_HOOK };
enum { METHODS_BENT = 1, METHODS_AO, METHODS_DIRECTION, METHODS_CONE, METHODS_FREE_BITS };
enum { METHODS_CLOSED = 1, METHODS_CUBIC };
enum { METHODS_NOISE_NONE = 1, METHODS_NOISE_IGN, METHODS_NOISE_HILBERT_R2 };
enum { METHODS_POWER = 1, METHODS_GEOMETRIC };
enum { METHODS_SCREEN_AZIMUTH = 1, METHODS_SLICE_MEAN = 2, METHODS_NOISE_2PI = 4, METHODS_UNIFORM_BENT = 8,
       METHODS_CONE_RELATION = 16, METHODS_F0_AO = 32 };

/* cube: E/pi (free_bits: radiance) in a direction; hook: hbil_far_hook. World space. */
typedef void (*methods_lookup)(void *user, const double position[3], const double direction[3], double cos_aperture,
                               double rgb[3]);

/* Trilinear grid; point (i, j, k) is at origin + step * (i, j, k). Beyond it its border goes on. */
typedef struct methods_probes {
    int           count[3];
    double        origin[3], step[3]; /* world, m */
    const double (*sh)[9][3];         /* [i + count[0] * (j + count[1] * k)] */
} methods_probes;

typedef struct methods_environment {
    double                color[3];    /* constant */
    double                sh[9][3];    /* radiance, world space, index l * l + l + m */
    const methods_probes *probes;
    methods_lookup        lookup;      /* cube, hook */
    void                 *user;
    double                to_world[9]; /* row-major rotation from the space above; all zero: identity */
    double                eye[3];      /* world, m */
} methods_environment;

/* Options of hbil_config by name; zero is the default of options.def. */
typedef struct methods_options {
    int    estimator, occluder, attenuation, facing, environment, far_visibility, sh_order, bounce, noise, spacing;
    int    slices, steps; /* steps: also what hbao_plus and the heuristic divide by, whatever was skipped */
    double exponent, reach, falloff, bias, angle_bias, multiplier, thickness, decay, pull;
    double firefly, near_intensity, far_intensity, ao_exponent, roughness;
    unsigned seed_compat;
    uint32_t frame_index;
    const methods_environment *env;
} methods_options;

typedef struct methods_sample {
    int    skip; /* sky, off the screen */
    double position[3], normal[3], radiance[3];
} methods_sample;

typedef struct methods_slice {
    double                tangent[3];
    double                jitter;    /* [0, 1), common to all sector edges */
    const methods_sample *sample[2]; /* side of +D, of -D; near to far */
    int                   count[2];
} methods_slice;

typedef struct methods_pixel {
    int    sky, orthographic; /* orthographic: view rays are parallel to V */
    double position[3], v[3], normal[3];
    double albedo[3], direct[3], f0[3], roughness; /* f0: 0 without */
    const methods_slice *slice;
    int                  slices;
} methods_pixel;

typedef struct methods_result {
    double ao, uniform_ao, bent[3], cone[4], near[3], sh[4][4], far[3], irradiance[3], specular_occlusion, multi_bounce[3];
    double composite[3];
    double full, open; /* sums over the slices: light of an open sky, what is left of it */
} methods_result;

/* All outputs; those that the estimator does not have are 0. */
void methods_light(const methods_options *options, const methods_pixel *pixel, methods_result *result);

/* --- slices and samples of a pixel as the march takes them (sampling nearest) ------------------------------------ */

/* Storage of one pixel's slices. Zero it first; reused from pixel to pixel. */
typedef struct methods_work {
    methods_slice   slice[METHODS_MAX_SLICES];
    methods_sample *sample;
    int             capacity;
} methods_work;

/* Fills position, v, normal, slices of pixel; the rest is 0. scene: as brute_force.h has it, normals included.
 * 0: out of memory, or too many slices. */
int  methods_place(const methods_options *options, const bf_scene *scene, int x, int y, methods_work *work,
                   methods_pixel *pixel);
void methods_work_free(methods_work *work);
/* [0, 1): rotation of the slices, jitter of the steps, of the sectors. */
void methods_noise(int noise, uint32_t frame_index, int x, int y, double out[3]);

/* --- the parts --------------------------------------------------------------------------------------------------- */

/* Integrals over an arc t0 <= t1 of |sin t| times 1, sin, cos, sin sin, sin cos, cos cos. */
typedef struct methods_moments { double solid, x, y, xx, xy, yy; } methods_moments;

methods_moments methods_arc(double t0, double t1);
double   methods_energy(double nx, double ny, const methods_moments *arc);               /* int (n.w) |sin| */
/* int w (n.w) |sin|, along D and V */
void     methods_bent(double nx, double ny, const methods_moments *arc, double out[2]);
double   methods_full(double nx, double ny);                                             /* energy of the open slice */
double   methods_cdf(double nx, double ny, double t);                                    /* share of it below t, [0, 1] */
double   methods_cdf_inverse(double nx, double ny, double u);
uint32_t methods_sectors(double u0, double u1, double jitter);                           /* bits of an occluder */
/* w . s < 0; s: source normal along D, V */
uint32_t methods_lit_sectors(double nx, double ny, double sx, double sy, double jitter);
double   methods_falloff(const methods_options *options, double distance);               /* horizon, bitmask: what is left */
double   methods_attenuation(const methods_options *options, double distance);           /* hbao, hbao_plus: weight */
double   methods_f0_ao(double ao);
double   methods_cone_cosine(const methods_options *options, double ao);
void     methods_sh_basis(const double d[3], double out[9]);
/* Bands at the unit direction d, times a factor each. order 1: without the third. */
void     methods_sh_sum(const double sh[9][3], int order, const double d[3], const double bands[3], double rgb[3]);
/* E/pi factors of the bands through a cone about the normal with t = cos(half angle). */
void     methods_cone_bands(double t, double out[3]);
/* Solid angle of two caps of half angles r1, r2 <= pi/2, d between their axes. */
double   methods_caps(double r1, double r2, double d);
double   methods_specular_occlusion(const double n[3], const double v[3], double ao, const double axis[3], double roughness);
double   methods_multi_bounce(int bounce, double ao, double albedo);
/* Far light E/pi of everything but free_bits, before intensity and F0. n, bent in the space above, bent not normalised. */
void     methods_far(const methods_options *options, const double position[3], const double n[3], double ao,
                     const double bent[3], double rgb[3]);

#endif
