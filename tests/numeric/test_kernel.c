/* test_kernel.c - the mathematics of the march, one slice at a time, against reference vectors, closed forms and invariants. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "kernel.h"

/* cmocka 1.1.5 compares floats only */
#define assert_near(a, b, tolerance) assert_true(fabs((a) - (b)) <= (tolerance))

static uint32_t g_seed; /* set by every test that draws numbers, so that tests do not depend on their order */

static double draw(double low, double high)
{
    g_seed = g_seed * 1664525u + 1013904223u;
    return low + (high - low) * (double)(g_seed >> 8) / 16777216.0;
}

static void draw_unit(double v[3])
{
    const double z = draw(-1.0, 1.0), phi = draw(0.0, 2.0 * KERNEL_PI), r = sqrt(1.0 - z * z);
    v[0] = r * cos(phi);
    v[1] = r * sin(phi);
    v[2] = z;
}

/* nx, ny of slice i of count, and D. */
static void slice_at(const double n[3], const double v[3], int i, int count, double d[3], double *nx, double *ny)
{
    const double phi = (i + 0.5) * KERNEL_PI / count;
    double       e1[3], e2[3];
    kernel_frame(v, e1, e2);
    for (int k = 0; k < 3; ++k) {
        d[k] = cos(phi) * e1[k] + sin(phi) * e2[k];
    }
    *nx = kernel_dot(n, d);
    *ny = kernel_dot(n, v);
}

/* One column a name: section 16 of the formula sheet. */
typedef struct slice_vector {
    double nx, ny, cB0, full, cB, cF, open, near, uniform[2], cosine[2];
} slice_vector;

static const slice_vector k_slices[] = {
    {0, 1, 0, 1.000000000, 0, 0, 1.000000000, 0.000000000, {0.000000000, 1.000000000}, {0.000000000, 0.666666667}},
    {0, 1, 0, 1.000000000, .5, .25, 0.843750000, 0.156250000, {0.230934882, 0.843750000}, {0.086070473, 0.619791667}},
    {.6, .8, 0.600000000, 1.186100665, .6, -.6, 1.186100665, 0.000000000, {1.123501109, 0.640000000}, {0.800000000, 0.533333333}},
    {.6, .8, 0.600000000, 1.186100665, .7, .1, 0.922689397, 0.263411269, {0.537815661, 0.750000000}, {0.554353257, 0.565764943}},
    {-.5, .3, -0.857492926, 0.815188413, .2, .9, 0.451188330, 0.364000083, {-0.557376660, 0.575000000}, {-0.325278498, 0.269264164}},
    {.9, .05, 0.998460353, 1.413768039, .9985, -.2, 0.909676702, 0.504091337, {0.984001954, 0.481498875}, {0.793276023, 0.299006866}},
    {-.8, .1, -0.992277877, 1.257153066, -.5, .995, 1.048695405, 0.208457661, {-1.263370819, 0.379987500}, {-0.921637393, 0.210936918}}};

static void slice_integrals_meet_the_reference_vectors(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof k_slices / sizeof k_slices[0]; ++i) {
        const slice_vector *s = &k_slices[i];
        const double        cF0 = kernel_horizon(s->nx, s->ny), cB0 = -cF0;
        double              uniform[2], cosine[2];
        assert_near(cB0, s->cB0, 1e-9);
        assert_near(kernel_full(s->nx, s->ny, kernel_g), s->full, 1e-9);
        assert_near(kernel_open(s->nx, s->ny, s->cB, s->cF, kernel_g), s->open, 1e-9);
        assert_near(kernel_rise(s->nx, s->ny, cF0, s->cF, kernel_g) + kernel_rise(-s->nx, s->ny, cB0, s->cB, kernel_g), s->near, 1e-9);
        kernel_bent_uniform(s->cB, s->cF, uniform);
        kernel_bent_cosine(s->nx, s->ny, s->cB, s->cF, cosine);
        for (int k = 0; k < 2; ++k) {
            assert_near(uniform[k], s->uniform[k], 1e-9);
            assert_near(cosine[k], s->cosine[k], 1e-9);
        }
    }
}

static void primitive_meets_the_reference_vectors(void **state)
{
    static const double g[][2] = {{-1, 3.141592654}, {-.8, 2.978091545}, {-.5, 2.527407804}, {0, 1.570796327}, {.25, 1.076054613},
                                  {.5, 0.614184849}, {.9, 0.058725907}, {.99, 0.001882787}};
    (void)state;
    for (size_t i = 0; i < sizeof g / sizeof g[0]; ++i) {
        assert_near(kernel_g(g[i][0]), g[i][1], 1e-9);
    }
}

static void signed_arcs_meet_the_reference_vectors(void **state)
{
    (void)state;
    assert_near(kernel_arc(.6, .8, -.5, 1), 0.514994940, 1e-9);
    assert_near(kernel_arc(.6, -.3, .3, 1.2), 0.136172194, 1e-9);
    assert_near(kernel_arc(.6, .2, -1.2, -.3), -0.175240427, 1e-9);
    assert_near(kernel_arc(-.4, .7, -2, 2.5), 0.294534573, 1e-9);
}

static void jacobian_meets_the_reference_vectors(void **state)
{
    const double length = sqrt(.5 * .5 + .25 * .25 + 1), v[3] = {-.5 / length, -.25 / length, -1 / length};
    (void)state;
    assert_near(kernel_jacobian(v, 0), 1.078253105, 1e-9);
    assert_near(kernel_jacobian(v, 0.5), 1.145171213, 1e-9);
    assert_near(kernel_jacobian(v, 1.2), 1.004116017, 1e-9);
    assert_near(kernel_jacobian(v, 2.5), 0.916865598, 1e-9);
}

/* Invariants 1 and 2: open + lost = full after any history of horizons, and no step is negative. */
static void open_and_near_make_the_full_slice(void **state)
{
    static const kernel_primitive primitives[] = {kernel_g, kernel_g_polynomial};
    double                        worst = 0.0, least[2] = {0.0, 0.0};
    (void)state;
    g_seed = 1;
    for (int i = 0; i < 20000; ++i) {
        const kernel_primitive g = primitives[i & 1];
        const double           angle = draw(0.0, 2.0 * KERNEL_PI), r = draw(0.01, 1.0), nx = r * cos(angle), ny = fabs(r * sin(angle));
        double                 c[2], lost = 0.0;
        c[0] = kernel_horizon(nx, ny);
        c[1] = -c[0];
        for (int step = 0; step < 12; ++step) {
            const int    side = draw(0.0, 1.0) < 0.5;
            const double low = step < 4 ? c[side] : -1.0, sample = low + draw(0.0, 1.0) * draw(0.0, 1.0) * (1.0 - low);
            if (sample > c[side]) {
                const double rise = kernel_rise(side ? -nx : nx, ny, c[side], sample, g);
                least[i & 1] = fmin(least[i & 1], rise);
                lost += rise;
                c[side] = sample;
            }
        }
        worst = fmax(worst, fabs(kernel_open(nx, ny, c[1], c[0], g) + lost - kernel_full(nx, ny, g)));
    }
    print_message("open + near - full: worst %.1e; least step: exact primitive %.1e, polynomial %.1e\n", worst, least[0], least[1]);
    assert_true(worst <= 1e-12);
    assert_true(least[0] >= -1e-12); /* rounding */
    assert_true(least[1] >= -1e-7);  /* beside the tangent plane a step is smaller than the polynomial's error */
}

/* Invariant 3, and that the cosine forms are the signed arcs. */
static void arcs_add_and_mirror_and_equal_the_cosine_form(void **state)
{
    (void)state;
    g_seed = 2;
    for (int i = 0; i < 20000; ++i) {
        const double nx = draw(-1.0, 1.0), ny = draw(-1.0, 1.0);
        const double a = draw(-3.1, 3.1), b = draw(-3.1, 3.1), c = draw(-3.1, 3.1), cF = draw(-1.0, 1.0), cB = draw(-1.0, 1.0);
        assert_near(kernel_arc(nx, ny, a, b) + kernel_arc(nx, ny, b, c), kernel_arc(nx, ny, a, c), 1e-12);
        assert_near(kernel_arc(nx, ny, a, b), kernel_arc(-nx, ny, -b, -a), 1e-12);
        assert_near(kernel_open(nx, ny, cB, cF, kernel_g), kernel_arc(nx, ny, -acos(cB), acos(cF)), 1e-12);
    }
}

/* Invariant 4: without the ratio, 64 slices make the open scene 1 within 1e-3 down to n.V = 0.02. */
static void full_slices_have_the_mean_one(void **state)
{
    double worst = 0.0;
    (void)state;
    g_seed = 3;
    for (int i = 0; i < 2000; ++i) {
        double n[3], v[3], d[3], nx, ny, sum = 0.0;
        draw_unit(n);
        draw_unit(v);
        kernel_face_camera(n, v, 0.021);
        for (int k = 0; k < 64; ++k) {
            slice_at(n, v, k, 64, d, &nx, &ny);
            sum += kernel_full(nx, ny, kernel_g) / 64.0;
        }
        worst = fmax(worst, fabs(sum - 1.0));
    }
    print_message("mean of the full slices - 1: worst %.1e\n", worst);
    assert_true(worst <= 1e-3);
}

/* Invariant 5 */
static void uniform_bent_vector_times_normal_is_the_open_light(void **state)
{
    (void)state;
    g_seed = 4;
    for (int i = 0; i < 2000; ++i) {
        const double nx = draw(-1.0, 1.0), ny = draw(0.0, 1.0), cF = draw(-1.0, 1.0), cB = draw(-1.0, 1.0);
        double       b[2];
        kernel_bent_uniform(cB, cF, b);
        assert_near(nx * b[0] + ny * b[1], kernel_open(nx, ny, cB, cF, kernel_g), 1e-12);
    }
}

/* Invariant 6: uniform n, cosine 2/3 n. */
static void open_scene_bends_towards_the_normal(void **state)
{
    (void)state;
    g_seed = 5;
    for (int i = 0; i < 200; ++i) {
        double n[3], v[3], d[3], nx, ny, uniform[3] = {0}, cosine[3] = {0};
        draw_unit(n);
        draw_unit(v);
        kernel_face_camera(n, v, 0.1);
        for (int k = 0; k < 512; ++k) {
            double u[2], c[2];
            slice_at(n, v, k, 512, d, &nx, &ny);
            kernel_bent_uniform(-kernel_horizon(nx, ny), kernel_horizon(nx, ny), u);
            kernel_bent_cosine(nx, ny, -kernel_horizon(nx, ny), kernel_horizon(nx, ny), c);
            for (int m = 0; m < 3; ++m) {
                uniform[m] += (u[0] * d[m] + u[1] * v[m]) / 512.0;
                cosine[m] += (c[0] * d[m] + c[1] * v[m]) / 512.0;
            }
        }
        for (int m = 0; m < 3; ++m) {
            assert_near(uniform[m], n[m], 1e-4);
            assert_near(cosine[m], 2.0 / 3.0 * n[m], 1e-4);
        }
    }
}

/* Invariant 7: cosine visibility (1 + n.m) / 2, uniform visibility 1 - angle / pi, wherever the camera is. */
static void corner_of_two_planes_has_its_closed_form_from_every_view(void **state)
{
    enum { SLICES = 4096 };
    int seen = 0;
    (void)state;
    g_seed = 6;
    for (int i = 0; i < 400; ++i) {
        double n[3], m[3], v[3], d[3], nx, ny, open = 0.0, uniform = 0.0;
        draw_unit(n);
        draw_unit(m);
        draw_unit(v);
        if (kernel_dot(n, v) < 0.05 || kernel_dot(m, v) < 0.05) {
            continue; /* the camera sees neither plane's back */
        }
        for (int k = 0; k < SLICES; ++k) {
            slice_at(n, v, k, SLICES, d, &nx, &ny);
            const double own = kernel_horizon(nx, ny), other = kernel_horizon(kernel_dot(m, d), kernel_dot(m, v));
            const double cF = fmax(own, other), cB = fmax(-own, -other);
            open += kernel_open(nx, ny, cB, cF, kernel_g) / SLICES;
            uniform += 0.5 * (2.0 - cF - cB) / SLICES;
        }
        assert_near(open, 0.5 * (1.0 + kernel_dot(n, m)), 1e-5);
        assert_near(uniform, 1.0 - acos(kernel_dot(n, m)) / KERNEL_PI, 1e-5);
        ++seen;
    }
    assert_true(seen >= 50);
}

/* Invariant 8: the open hemisphere's factors, and the zonal integrals of any cone. */
static void cone_factors_equal_quadrature(void **state)
{
    double c[3];
    (void)state;
    kernel_cone(0.0, c);
    assert_near(c[0], 0.886227, 1e-6);
    assert_near(c[1], 1.023327, 1e-6);
    assert_near(c[2], 0.247708, 1e-6);
    for (double t = -0.9; t < 1.0; t += 0.1) {
        double sum[3] = {0};
        for (int i = 0; i < 20000; ++i) {
            const double x = t + (1.0 - t) * (i + 0.5) / 20000.0, weight = 2.0 * KERNEL_PI * x * (1.0 - t) / 20000.0;
            sum[0] += weight * 0.5 / sqrt(KERNEL_PI);
            sum[1] += weight * x * sqrt(3.0 / (4.0 * KERNEL_PI));
            sum[2] += weight * (3.0 * x * x - 1.0) * 0.25 * sqrt(5.0 / KERNEL_PI);
        }
        kernel_cone(t, c);
        assert_near(c[0], sum[0], 1e-8);
        assert_near(c[1], sum[1], 1e-8);
        assert_near(2.0 * c[2], sum[2], 1e-8); /* order 2 carries half: its polynomial is written 3 x^2 - 1 */
    }
}

/* Invariant 9, and that D and its screen direction belong together. */
static void slices_map_to_the_screen(void **state)
{
    (void)state;
    g_seed = 7;
    for (int i = 0; i < 200; ++i) {
        const double x = draw(-3.0, 3.0), y = draw(-3.0, 3.0), length = sqrt(x * x + y * y + 1.0);
        const double v[3] = {-x / length, -y / length, -1.0 / length}; /* the pixel at (x, y) of the plane at depth 1 */
        double       d[3], nx, ny, to[2], mean = 0.0;
        slice_at(v, v, i, 200, d, &nx, &ny);
        kernel_screen(v, d, to);
        const double step = 1e-6, px = (x + step * d[0]) / (1.0 + step * d[2]) - x, py = (y + step * d[1]) / (1.0 + step * d[2]) - y;
        assert_near((to[0] * py - to[1] * px) / hypot(px, py) / hypot(to[0], to[1]), 0.0, 1e-5);
        assert_true(to[0] * px + to[1] * py > 0.0);
        assert_near(nx, 0.0, 1e-12);
        assert_near(kernel_dot(d, d), 1.0, 1e-12);
        for (int k = 0; k < 4096; ++k) {
            mean += kernel_jacobian(v, k * KERNEL_PI / 4096.0) / 4096.0;
        }
        assert_near(mean, 1.0, 1e-9);
    }
}

/* Invariant 10, and the error of the polynomial that the shader uses. */
static void primitive_is_odd_about_its_middle_and_falls(void **state)
{
    static const kernel_primitive primitives[] = {kernel_g, kernel_g_polynomial};
    double                        worst = 0.0;
    (void)state;
    for (int p = 0; p < 2; ++p) {
        const kernel_primitive g = primitives[p];
        assert_near(g(0.0), 0.5 * KERNEL_PI, 1e-15);
        assert_near(g(1.0), 0.0, 1e-15);
        for (int i = -10000; i < 10000; ++i) {
            const double c = i / 10000.0;
            assert_near(g(c) + g(-c), KERNEL_PI, 1e-14);
            assert_true(g(c) > g((i + 1) / 10000.0));
            worst = fmax(worst, fabs(g(c) - kernel_g(c)));
        }
    }
    print_message("polynomial primitive: worst error %.2e\n", worst);
    assert_true(worst <= 7.8e-5);
}

/* The numerical hazards of the initial horizon: finite, in [-1, 1], and an open scene stays open after the normal is turned. */
static void horizon_is_finite_for_every_normal(void **state)
{
    static const double facing[] = {-1.0, -1e-8, 0.0, 1e-20, 1.0};
    (void)state;
    g_seed = 8;
    for (int i = 0; i < 2000; ++i) {
        const double across = draw(-1.0, 1.0), ny = facing[i % 5], nx = across * sqrt(1.0 - ny * ny), c = kernel_horizon(nx, ny);
        double       v[3], side[3], unused[3], n[3], d[3], mx, my;
        assert_true(isfinite(c) && fabs(c) <= 1.0);
        draw_unit(v);
        kernel_frame(v, side, unused);
        for (int k = 0; k < 3; ++k) {
            n[k] = ny * v[k] + sqrt(1.0 - ny * ny) * side[k];
        }
        kernel_face_camera(n, v, 0.05);
        slice_at(n, v, i % 64, 64, d, &mx, &my);
        assert_true(my >= 0.0499 && isfinite(kernel_full(mx, my, kernel_g)) && kernel_full(mx, my, kernel_g) >= 0.0);
        assert_near(kernel_dot(n, n), 1.0, 1e-12);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(primitive_meets_the_reference_vectors),
        cmocka_unit_test(slice_integrals_meet_the_reference_vectors),
        cmocka_unit_test(signed_arcs_meet_the_reference_vectors),
        cmocka_unit_test(jacobian_meets_the_reference_vectors),
        cmocka_unit_test(open_and_near_make_the_full_slice),
        cmocka_unit_test(arcs_add_and_mirror_and_equal_the_cosine_form),
        cmocka_unit_test(full_slices_have_the_mean_one),
        cmocka_unit_test(uniform_bent_vector_times_normal_is_the_open_light),
        cmocka_unit_test(open_scene_bends_towards_the_normal),
        cmocka_unit_test(corner_of_two_planes_has_its_closed_form_from_every_view),
        cmocka_unit_test(cone_factors_equal_quadrature),
        cmocka_unit_test(slices_map_to_the_screen),
        cmocka_unit_test(primitive_is_odd_about_its_middle_and_falls),
        cmocka_unit_test(horizon_is_finite_for_every_normal),
    };
    return cmocka_run_group_tests_name("numeric.kernel", tests, NULL, NULL);
}
