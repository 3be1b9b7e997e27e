/* test_reference.c - the brute force itself: against closed forms, and against another program's rays through the same captures. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "../captures.h"
#include "analytic.h"
#include "brute_force.h"
#include "slices.h"

#define WIDTH  129 /* odd: an edge in the middle column lies on pixel centres, where the bilinear surface bends as the planes do */
#define HEIGHT 97
#define SKY    1e9

static const double k_pi = 3.14159265358979323846;

typedef struct synthetic { bf_scene scene; float *depth, *normal, *radiance; } synthetic;

/* Vertical field of view in rad, or height of the screen in m; the centre shifted by parts of the screen. */
static bf_camera make_camera(int orthographic, double extent, double shift_x, double shift_y)
{
    const double half = orthographic ? 0.5 * extent : tan(0.5 * extent), pixel = 2.0 * half / HEIGHT;
    bf_camera    c = {WIDTH, HEIGHT, orthographic, {pixel, -pixel, 0.0, 0.0}};
    c.ray[2] = -(0.5 + shift_x) * WIDTH * pixel;
    c.ray[3] = (0.5 + shift_y) * HEIGHT * pixel;
    return c;
}

/* The same view in pixels of a ninth. */
static bf_camera refine(bf_camera c)
{
    c.width *= 9;
    c.height *= 9;
    c.ray[0] /= 9.0;
    c.ray[1] /= 9.0;
    return c;
}

static synthetic make_synthetic(const wedge *w, bf_camera camera, const float grey[2])
{
    const size_t pixels = (size_t)camera.width * (size_t)camera.height;
    synthetic    s = {.depth = malloc(pixels * sizeof(float)), .normal = malloc(3 * pixels * sizeof(float)),
                      .radiance = malloc(3 * pixels * sizeof(float))};
    assert_true(s.depth && s.normal && s.radiance);
    wedge_render(w, &camera, (float)SKY, grey, s.depth, s.normal, s.radiance);
    s.scene.camera = camera;
    s.scene.depth = s.depth;
    s.scene.sky_depth = SKY;
    s.scene.normal = s.normal;
    s.scene.radiance = s.radiance;
    return s;
}

static void free_synthetic(synthetic *s)
{
    free(s->depth);
    free(s->normal);
    free(s->radiance);
}

static bf_pixel *run(const bf_scene *scene, bf_grid grid, int rays)
{
    bf_pixel *out = malloc((size_t)grid.columns * (size_t)grid.rows * sizeof *out);
    assert_non_null(out);
    assert_true(bf_run(scene, grid, rays, out));
    return out;
}

/* --- closed forms ------------------------------------------------------------------------------------------------ */

static void check_open_plane(bf_camera camera, double tilt, double azimuth, double worst[2])
{
    const double    point[3] = {0.0, 0.0, -3.0}, normal[3] = {sin(tilt) * cos(azimuth), sin(tilt) * sin(azimuth), cos(tilt)};
    const float     grey[2] = {1.0f, 1.0f};
    const wedge     w = wedge_plane(point, normal);
    synthetic       s = make_synthetic(&w, camera, grey);
    const bf_grid   grid = bf_grid_of(WIDTH, HEIGHT, 0, 12);
    bf_pixel       *out = run(&s.scene, grid, 256);
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        if (out[i].sky == 0.0) {
            worst[0] = fmax(worst[0], fabs(out[i].ao - 1.0) + out[i].near[0]);
            for (int k = 0; k < 3; ++k) {
                worst[1] = fmax(worst[1], fabs(out[i].bent[k] - 2.0 / 3.0 * normal[k]));
            }
        }
    }
    free(out);
    free_synthetic(&s);
}

static void open_plane_is_open_and_bends_to_two_thirds_of_its_normal(void **state)
{
    double worst[2] = {0.0, 0.0};
    (void)state;
    for (int tilt = 0; tilt <= 80; tilt += 20) {
        for (int azimuth = 0; azimuth < 4; ++azimuth) {
            check_open_plane(make_camera(0, 1.2, 0.0, 0.0), tilt * k_pi / 180.0, azimuth * 1.7, worst);
            check_open_plane(make_camera(0, 2.1, 0.3, -0.2), tilt * k_pi / 180.0, azimuth * 1.7, worst);
            check_open_plane(make_camera(1, 5.0, 0.3, -0.2), tilt * k_pi / 180.0, azimuth * 1.7, worst);
        }
    }
    print_message("open plane: ao and near off by at most %.1e, bent by %.1e\n", worst[0], worst[1]);
    assert_true(worst[0] <= 1e-12);
    assert_true(worst[1] <= 0.03); /* 256 rays */
}

/* Corner whose edge is the middle column. A receiver beside the edge sees the whole other plane, but for what the screen cuts off:
 * about the ratio of the distances to the edge and to the border, 1 / 400 here. */
static void corner_seen_from_beside_its_edge_is_one_plus_cosine_over_two(void **state)
{
    const float grey[2] = {1.0f, 1.0f};
    double      worst = 0.0;
    (void)state;
    for (int opening = 70; opening <= 160; opening += 30) {
        const double    point[3] = {0.0, 0.0, -3.0}, along[3] = {0.0, 1.0, 0.0}, angle = opening * k_pi / 180.0;
        const wedge     w = wedge_make(point, along, angle, 0.0);
        const bf_camera camera = refine(make_camera(0, 1.6, 0.0, 0.0));
        synthetic       s = make_synthetic(&w, camera, grey);
        const bf_grid   grid = {camera.width / 2 - 1, 2, 2, 1}; /* one pixel to either side */
        bf_pixel       *out = run(&s.scene, grid, 32768);
        for (int i = 0; i < 2; ++i) {
            worst = fmax(worst, fabs(out[i].ao - 0.5 * (1.0 - cos(angle))));
        }
        free(out);
        free_synthetic(&s);
    }
    print_message("corner beside its edge: ao off by at most %.1e\n", worst);
    assert_true(worst <= 5e-3);
}

/* The same corner from everywhere: 1 minus the form factor of what the screen shows of the other plane; near is its grey. */
static void check_corner(bf_camera camera, double opening, double turn, double worst[3])
{
    const float   grey[2] = {0.5f, 2.0f};
    const double  point[3] = {0.0, 0.0, -20.0}, along[3] = {0.0, 1.0, 0.0};
    const wedge   w = wedge_make(point, along, opening, turn);
    synthetic     s = make_synthetic(&w, camera, grey);
    const bf_grid grid = bf_grid_of(WIDTH, HEIGHT, 4, 24);
    bf_pixel     *out = run(&s.scene, grid, 16384);
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        const int x = grid.first + i % grid.columns * grid.stride, y = grid.first + i / grid.columns * grid.stride;
        int       plane;
        wedge_depth(&w, &camera, x + 0.5, y + 0.5, &plane);
        if (out[i].sky == 0.0) {
            worst[0] = fmax(worst[0], fabs(out[i].ao - wedge_visible(&w, &camera, x, y, plane)));
            worst[1] = fmax(worst[1], fabs(out[i].near[1] - (1.0 - out[i].ao) * (double)grey[1 - plane]));
            worst[2] = fmax(worst[2], out[i].ao_se);
        }
    }
    free(out);
    free_synthetic(&s);
}

static void corner_on_the_screen_has_its_form_factor(void **state)
{
    double worst[3] = {0.0, 0.0, 0.0};
    (void)state;
    for (int opening = 40; opening <= 160; opening += 40) {
        for (int turn = -1; turn <= 1; ++turn) {
            const double angle = opening * k_pi / 180.0;
            check_corner(make_camera(0, 1.2, 0.0, 0.0), angle, turn * 0.2 * angle, worst);
            check_corner(make_camera(0, 2.1, 0.0, 0.2), angle, turn * 0.2 * angle, worst);
            check_corner(make_camera(1, 5.0, 0.0, -0.2), angle, turn * 0.2 * angle, worst);
        }
    }
    print_message("corner: ao off by at most %.1e (largest standard error %.1e), near by %.1e\n", worst[0], worst[2], worst[1]);
    assert_true(worst[0] <= 3e-3);
    assert_true(worst[1] <= 2e-3); /* the edge's own pixels carry the grey of one of the planes */
}

static void roof_hides_nothing(void **state)
{
    const double  point[3] = {0.0, 0.0, -3.0}, along[3] = {0.0, 1.0, 0.0};
    const float   grey[2] = {1.0f, 1.0f};
    const wedge   w = wedge_make(point, along, 1.4 * k_pi, 0.0);
    synthetic     s = make_synthetic(&w, make_camera(0, 1.2, 0.0, 0.0), grey);
    const bf_grid grid = bf_grid_of(WIDTH, HEIGHT, 0, 16);
    bf_pixel     *out = run(&s.scene, grid, 256);
    (void)state;
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        assert_true(out[i].sky == 0.0 && out[i].ao >= 1.0 - 1e-12);
    }
    free(out);
    free_synthetic(&s);
}

/* --- far light: the same closed forms, with a sky behind ----------------------------------------------------------- */

static const float k_black[2] = {0.0f, 0.0f};

/* A sky of orders 0 to 2: radiance = level + slope . d + (d . axis)^2 - 1/3, each channel with other weights; never negative. */
typedef struct sky_bands { double level[3], slope[3][3], band2[3], axis[3]; } sky_bands;

static const sky_bands k_sky = {{1.2, 1.5, 1.0}, {{0.4, -0.3, 0.2}, {0.0, 0.6, 0.5}, {-0.2, 0.1, -0.7}}, {0.3, -0.2, 0.0},
                                {0.48, 0.6, 0.64}};

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Integral of the sky times anything whose bands keep their shape: factors of the bands at d. */
static void sky_at(const sky_bands *sky, const double d[3], double band1, double band2, double rgb[3])
{
    const double high = dot3(d, sky->axis);
    for (int c = 0; c < 3; ++c) {
        rgb[c] = sky->level[c] + band1 * dot3(sky->slope[c], d) + band2 * sky->band2[c] * (high * high - 1.0 / 3.0);
    }
}

static void sky_radiance(const void *data, const double direction[3], double rgb[3])
{
    sky_at(data, direction, 1.0, 1.0, rgb);
}

static void sky_over_an_open_plane_has_its_bands_times_two_thirds_and_a_quarter(void **state)
{
    double worst = 0.0;
    (void)state;
    for (int i = 0; i < 15; ++i) {
        const double    tilt = i % 5 * 20.0 * k_pi / 180.0, azimuth = i * 1.7;
        const double    point[3] = {0.0, 0.0, -3.0}, normal[3] = {sin(tilt) * cos(azimuth), sin(tilt) * sin(azimuth), cos(tilt)};
        const wedge     w = wedge_plane(point, normal);
        const bf_camera camera = i < 10 ? make_camera(0, 1.2, 0.2, 0.0) : make_camera(1, 5.0, 0.3, -0.2);
        const bf_grid   grid = bf_grid_of(WIDTH, HEIGHT, 6, 24);
        synthetic       s = make_synthetic(&w, camera, k_black);
        s.scene.sky = sky_radiance;
        s.scene.sky_data = &k_sky;
        bf_pixel *out = run(&s.scene, grid, 4096);
        double    expected[3];
        sky_at(&k_sky, normal, 2.0 / 3.0, 0.25, expected);
        for (int k = 0; k < 3 * grid.columns * grid.rows; ++k) {
            const bf_pixel *p = &out[k / 3];
            worst = p->sky == 0.0 ? fmax(worst, fabs(p->far[k % 3] - expected[k % 3])) : worst;
        }
        free(out);
        free_synthetic(&s);
    }
    print_message("sky over an open plane: far off by at most %.1e of about 1.2\n", worst);
    assert_true(worst > 0.0 && worst <= 3e-3);
}

/* Orders 0 and 1 through the opening of a corner, from beside its edge: directions at angles 0 to `opening` from the own plane.
 * With w = sin b (cos a away + sin a n) + cos b edge, the bent vector is 4 / (3 pi) times the integral of sin a (cos a, sin a) da. */
static void check_sky_in_a_corner(int opening_degrees, double *worst)
{
    const double    point[3] = {0.0, 0.0, -3.0}, along[3] = {0.0, 1.0, 0.0}, angle = opening_degrees * k_pi / 180.0;
    const wedge     w = wedge_make(point, along, angle, 0.0);
    const bf_camera camera = refine(make_camera(0, 1.6, 0.0, 0.0));
    synthetic       s = make_synthetic(&w, camera, k_black);
    const bf_grid   grid = {camera.width / 2 - 1, 2, 2, 1}; /* one pixel to either side */
    sky_bands       sky = k_sky;
    sky.band2[0] = sky.band2[1] = 0.0;
    s.scene.sky = sky_radiance;
    s.scene.sky_data = &sky;
    bf_pixel *out = run(&s.scene, grid, 32768);
    for (int i = 0; i < 2; ++i) {
        int plane;
        wedge_depth(&w, &camera, grid.first + 2 * i + 0.5, grid.first + 0.5, &plane);
        const double *n = w.n[plane], *other = w.n[1 - plane], across = dot3(n, other), part = sqrt(1.0 - across * across);
        const double  ao = 0.5 * (1.0 - cos(angle)), b_away = 2.0 / (3.0 * k_pi) * sin(angle) * sin(angle);
        const double  b_n = 4.0 / (3.0 * k_pi) * (0.5 * angle - 0.25 * sin(2.0 * angle));
        for (int c = 0; c < 3; ++c) {
            double expected = sky.level[c] * ao;
            for (int k = 0; k < 3; ++k) { /* away from the edge, in the own plane: what the other normal has beside the own one */
                expected += sky.slope[c][k] * (b_n * n[k] + b_away * (other[k] - across * n[k]) / part);
            }
            *worst = fmax(*worst, fabs(out[i].far[c] - expected));
            assert_true(out[i].far_se[c] > 0.0 && out[i].far_se[c] < 0.01);
        }
    }
    free(out);
    free_synthetic(&s);
}

static void sky_in_a_corner_is_level_times_ao_and_slope_times_bent(void **state)
{
    double worst = 0.0;
    (void)state;
    for (int opening = 70; opening <= 160; opening += 30) {
        check_sky_in_a_corner(opening, &worst);
    }
    print_message("sky in a corner, beside its edge: far off by at most %.1e of about 1\n", worst);
    assert_true(worst <= 1e-2); /* the screen cuts off as much as for ao, times a radiance of 1 to 2 */
}

/* --- repeated ------------------------------------------------------------------------------------------------------ */

static void same_arguments_give_the_same_bits(void **state)
{
    const double  point[3] = {0.0, 0.0, -3.0}, along[3] = {0.6, 0.8, 0.0};
    const float   grey[2] = {0.5f, 2.0f};
    const wedge   w = wedge_make(point, along, 1.5, 0.1);
    synthetic     s = make_synthetic(&w, make_camera(0, 1.2, 0.1, 0.0), grey);
    const bf_grid grid = bf_grid_of(WIDTH, HEIGHT, 3, 10);
    bf_pixel     *a = run(&s.scene, grid, 64), *b = run(&s.scene, grid, 64);
    (void)state;
    assert_memory_equal(a, b, (size_t)grid.columns * (size_t)grid.rows * sizeof *a);
    free(a);
    free(b);
    free_synthetic(&s);
}

/* --- against the rays of another program ------------------------------------------------------------------------- */

typedef struct height_truth { image_layer layer[5]; } height_truth; /* valid, ao, its error, near, its error */

/* 0: this capture came without. */
static int load_truth(const char *name, capture *cap, height_truth *truth)
{
    const height_truth empty = {{{"hf_valid", "Y", {0, 0, 0, NULL}, 1}, {"hf_ao", "Y", {0, 0, 0, NULL}, 1},
                                 {"hf_ao_se", "Y", {0, 0, 0, NULL}, 1}, {"hf_near", "RGB", {0, 0, 0, NULL}, 1},
                                 {"hf_near_se", "Y", {0, 0, 0, NULL}, 1}}};
    char path[1024], error[512] = "";
    *truth = empty;
    snprintf(path, sizeof path, "%s/%s/hf-000.exr", getenv("HBIL_CAPTURES"), name);
    FILE *file = fopen(path, "rb");
    if (!file) {
        return 0;
    }
    fclose(file);
    if (!captures_load(name, 0, cap, error, sizeof error) || !exr_read(path, truth->layer, 5, error, sizeof error)) {
        fail_msg("%s", error);
    }
    return 1;
}

/* Sums over pixels: count, |difference| of ao, the |difference| that the standard errors explain, difference; the same three for
 * the mean of near's channels; near itself. */
typedef struct comparison { double count, ao[3], near[3], near_mean; } comparison;

static void compare_pixel(const bf_pixel *ours, const height_truth *truth, int pixel, comparison *sum)
{
    const float *near = truth->layer[3].pixels.data + 3 * pixel;
    const double theirs = ((double)near[0] + (double)near[1] + (double)near[2]) / 3.0;
    const double mine = (ours->near[0] + ours->near[1] + ours->near[2]) / 3.0;
    const double mine_se = (ours->near_se[0] + ours->near_se[1] + ours->near_se[2]) / 3.0;
    const double ao = ours->ao - (double)truth->layer[1].pixels.data[pixel];
    const double explain = sqrt(2.0 / k_pi); /* mean |x| of a normal distribution of variance 1 */
    sum->count += 1.0;
    sum->ao[0] += fabs(ao);
    sum->ao[1] += explain * hypot(ours->ao_se, (double)truth->layer[2].pixels.data[pixel]);
    sum->ao[2] += ao;
    sum->near[0] += fabs(mine - theirs);
    sum->near[1] += explain * hypot(mine_se, (double)truth->layer[4].pixels.data[pixel]);
    sum->near[2] += mine - theirs;
    sum->near_mean += theirs;
}

static void check_capture(const char *name)
{
    capture      cap;
    height_truth truth;
    comparison   sum = {0};
    if (!load_truth(name, &cap, &truth)) {
        print_message("%s came without other rays\n", name);
        return;
    }
    const bf_scene scene = {bf_camera_from(cap.projection, cap.width, cap.height), cap.depth.data, SKY, cap.normal.data, cap.direct.data};
    const bf_grid  grid = bf_grid_of(cap.width, cap.height, 1, 8);
    bf_pixel      *out = run(&scene, grid, 1024);
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        const int pixel = (grid.first + i / grid.columns * grid.stride) * cap.width + grid.first + i % grid.columns * grid.stride;
        if (out[i].sky == 0.0 && truth.layer[0].pixels.data[pixel] > 0.5f) {
            compare_pixel(&out[i], &truth, pixel, &sum);
        }
    }
    print_message("%s: %.0f pixels, ao differs by %.5f (noise explains %.5f), mean by %+.5f; near by %.2f %% (noise explains %.2f %%), "
                  "mean by %+.2f %%\n", name, sum.count, sum.ao[0] / sum.count, sum.ao[1] / sum.count, sum.ao[2] / sum.count,
                  100.0 * sum.near[0] / sum.near_mean, 100.0 * sum.near[1] / sum.near_mean, 100.0 * sum.near[2] / sum.near_mean);
    assert_true(sum.count >= 1000.0);
    assert_true(sum.ao[0] <= 1.1 * sum.ao[1] + 5e-4 * sum.count);
    assert_true(fabs(sum.ao[2]) <= 5e-4 * sum.count);
    assert_true(sum.near[0] <= 1.1 * sum.near[1] + 0.005 * sum.near_mean);
    assert_true(fabs(sum.near[2]) <= 0.005 * sum.near_mean);
    free(out);
    for (int i = 0; i < 5; ++i) {
        image_free(&truth.layer[i].pixels);
    }
    capture_free(&cap);
}

static void for_all(void (*check)(const char *name))
{
    const capture_names list = captures_list();
    if (!list.count) {
        print_message("skipped: HBIL_CAPTURES is not set, or holds no frame\n");
        skip();
    }
    for (int i = 0; i < list.count; ++i) {
        check(list.name[i]);
    }
}

static void other_rays_meet_ours_in_every_capture(void **state)
{
    (void)state;
    for_all(check_capture);
}

/* --- against slices ---------------------------------------------------------------------------------------------- */

/* The method of the shader over the same surface: what the rays say, without the shader's sampling. */
static void check_slices(const char *name)
{
    capture cap;
    char    error[512] = "";
    double  count = 0.0, ao[2] = {0.0, 0.0}, near[2] = {0.0, 0.0}, near_mean = 0.0;
    if (!captures_load(name, 0, &cap, error, sizeof error)) {
        fail_msg("%s", error);
    }
    const bf_scene scene = {bf_camera_from(cap.projection, cap.width, cap.height), cap.depth.data, SKY, cap.normal.data, cap.direct.data};
    const bf_grid  grid = bf_grid_of(cap.width, cap.height, 3, 31);
    bf_pixel      *out = run(&scene, grid, 4096);
    for (int i = 0; i < grid.columns * grid.rows; ++i) {
        bf_pixel sliced;
        if (out[i].sky != 0.0) {
            continue;
        }
        slices_run(&scene, grid.first + i % grid.columns * grid.stride, grid.first + i / grid.columns * grid.stride, 64, 0,
                   (i * 7 % 16 + 0.5) / 16.0, &sliced);
        count += 1.0;
        ao[0] += fabs(sliced.ao - out[i].ao);
        ao[1] += sliced.ao - out[i].ao;
        for (int k = 0; k < 3; ++k) {
            near[0] += fabs(sliced.near[k] - out[i].near[k]);
            near[1] += sliced.near[k] - out[i].near[k];
            near_mean += out[i].near[k];
        }
    }
    print_message("%s, slices against rays, %.0f pixels: ao %.4f (mean %+.4f), near %.2f %% (mean %+.2f %%)\n", name, count, ao[0] / count,
                  ao[1] / count, 100.0 * near[0] / near_mean, 100.0 * near[1] / near_mean);
    free(out);
    capture_free(&cap);
    assert_true(count >= 100.0);
    assert_true(ao[0] <= 0.01 * count && fabs(ao[1]) <= 0.003 * count);
    assert_true(near[0] <= 0.03 * near_mean && fabs(near[1]) <= 0.01 * near_mean);
}

static void slices_meet_the_rays_in_every_capture(void **state)
{
    (void)state;
    for_all(check_slices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_plane_is_open_and_bends_to_two_thirds_of_its_normal),
        cmocka_unit_test(corner_seen_from_beside_its_edge_is_one_plus_cosine_over_two),
        cmocka_unit_test(corner_on_the_screen_has_its_form_factor),
        cmocka_unit_test(roof_hides_nothing),
        cmocka_unit_test(sky_over_an_open_plane_has_its_bands_times_two_thirds_and_a_quarter),
        cmocka_unit_test(sky_in_a_corner_is_level_times_ao_and_slope_times_bent),
        cmocka_unit_test(same_arguments_give_the_same_bits),
        cmocka_unit_test(other_rays_meet_ours_in_every_capture),
        cmocka_unit_test(slices_meet_the_rays_in_every_capture),
    };
    return cmocka_run_group_tests_name("numeric.reference", tests, NULL, NULL);
}
