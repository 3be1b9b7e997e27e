/* kernel.h - the formulas of the march shader in double precision, one function each, for one slice.
 *
 * A slice is the plane of V (unit, from the surface to the camera) and D (unit, across V). n is the shading normal, nx = n.D,
 * ny = n.V >= 0 (not normalised). A horizon is the cosine of its angle to V: cF on the +D side (front), cB on the -D side (back); a
 * larger cosine is a higher horizon. The azimuth of D runs over [0, pi), so one slice stands for both sides. */
#ifndef HBIL_TESTS_KERNEL_H
#define HBIL_TESTS_KERNEL_H

#include <math.h>

#define KERNEL_PI 3.14159265358979323846

typedef double (*kernel_primitive)(double c);

/* G(c) = 2 int_0^acos(c) sin^2: the only transcendental that the light needs. */
static inline double kernel_g(double c)
{
    return acos(c) - c * sqrt(1.0 - c * c);
}

/* G within 7.8e-5 by one square root, monotone. */
static inline double kernel_g_polynomial(double c)
{
    const double a = fabs(c), o = 1.0 - a;
    const double g = ((-0.042259066 * a + 0.354230314) * a + 0.5 * KERNEL_PI) * o * sqrt(o);
    return c >= 0.0 ? g : KERNEL_PI - g;
}

/* Horizon of the normal's own plane on the front side; the back side has the opposite sign. No division by ny. */
static inline double kernel_horizon(double nx, double ny)
{
    return -nx / sqrt(fmax(nx * nx + ny * ny, 1e-20));
}

/* Light of the whole slice, open: int max(0, n.w) |sin| over the slice. Its mean over all slices is 1. */
static inline double kernel_full(double nx, double ny, kernel_primitive g)
{
    return nx * (g(kernel_horizon(nx, ny)) - 0.5 * KERNEL_PI) + ny * ny * ny / fmax(nx * nx + ny * ny, 1e-20);
}

/* Light above both horizons. */
static inline double kernel_open(double nx, double ny, double cB, double cF, kernel_primitive g)
{
    return 0.5 * (nx * (g(cF) - g(cB)) + ny * ((1.0 - cF * cF) + (1.0 - cB * cB)));
}

/* Light that is lost when one side's horizon rises from c to higher; nx changes sign on the back side. */
static inline double kernel_rise(double nx, double ny, double c, double higher, kernel_primitive g)
{
    return 0.5 * (nx * (g(c) - g(higher)) + ny * (higher - c) * (higher + c));
}

/* Signed primitives, right for any angles from V, in (-pi, pi]: light between t0 <= t1. The truth that the cosine forms are held to. */
static inline double kernel_arc(double nx, double ny, double t0, double t1)
{
    const double x = fabs(t1) - sin(fabs(t1)) * cos(t1) - fabs(t0) + sin(fabs(t0)) * cos(t0);
    const double y = copysign(sin(t1) * sin(t1), t1) - copysign(sin(t0) * sin(t0), t0);
    return 0.5 * (nx * x + ny * y);
}

/* Open directions of the slice in (D, V), every direction counting alike. */
static inline void kernel_bent_uniform(double cB, double cF, double out[2])
{
    out[0] = 0.5 * (kernel_g(cF) - kernel_g(cB));
    out[1] = 0.5 * (2.0 - cF * cF - cB * cB);
}

/* The same weighted by the cosine to n: what the output `bent` adds up. No acos. */
static inline void kernel_bent_cosine(double nx, double ny, double cB, double cF, double out[2])
{
    const double sF = sqrt(1.0 - cF * cF), sB = sqrt(1.0 - cB * cB), cross = sF * sF * sF - sB * sB * sB;
    out[0] = (nx * (cF * cF * cF + cB * cB * cB - 3.0 * (cF + cB) + 4.0) + ny * cross) / 3.0;
    out[1] = (nx * cross + ny * (2.0 - cF * cF * cF - cB * cB * cB)) / 3.0;
}

static inline double kernel_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Turn n towards V until n.V >= eps: a shading normal may look away from the camera, a visible surface does not. */
static inline void kernel_face_camera(double n[3], const double v[3], double eps)
{
    const double lack = eps - kernel_dot(n, v);
    if (lack > 0.0) {
        const double m[3] = {n[0] + lack * v[0], n[1] + lack * v[1], n[2] + lack * v[2]}, length = sqrt(kernel_dot(m, m));
        for (int k = 0; k < 3; ++k) {
            n[k] = m[k] / length;
        }
    }
}

/* Frame about V without a singular direction; D = cos(phi) e1 + sin(phi) e2. */
static inline void kernel_frame(const double v[3], double e1[3], double e2[3])
{
    const double s = v[2] >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + v[2]), b = v[0] * v[1] * a;
    e1[0] = 1.0 + s * v[0] * v[0] * a; e1[1] = s * b; e1[2] = -s * v[0];
    e2[0] = b; e2[1] = s + v[1] * v[1] * a; e2[2] = -v[1];
}

/* Screen direction of D at the pixel whose V this is, at unit focal length: linear in D. */
static inline void kernel_screen(const double v[3], const double d[3], double out[2])
{
    const double s = v[2] >= 0.0 ? 1.0 : -1.0;
    out[0] = s * (d[0] * v[2] - v[0] * d[2]);
    out[1] = s * (d[1] * v[2] - v[1] * d[2]);
}

/* d azimuth about V / d angle on the screen at screen angle alpha: what slices uniform on the screen would have to be weighted with. */
static inline double kernel_jacobian(const double v[3], double alpha)
{
    const double uv = cos(alpha) * v[0] + sin(alpha) * v[1];
    return fabs(v[2]) / (1.0 - uv * uv);
}

/* Order 0, 1, 2 factors of spherical-harmonics irradiance through a cone about n with t = cos(half angle). */
static inline void kernel_cone(double t, double out[3])
{
    out[0] = 0.5 * sqrt(KERNEL_PI) * (1.0 - t * t);
    out[1] = sqrt(3.0 * KERNEL_PI) / 3.0 * (1.0 - t * t * t);
    out[2] = sqrt(5.0 * KERNEL_PI) / 16.0 * (1.0 - t * t) * (1.0 + 3.0 * t * t);
}

#endif
