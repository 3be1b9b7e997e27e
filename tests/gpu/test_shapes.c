/* test_shapes.c - textures that are not plain 2D, and the hook, through both backends: what goes into a cube
 * map, a grid of probes, one sample of a multisampled texture comes out where it should; layers come out in order. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include <math.h>

#include "inputs.h"
#include "../../examples/frame/runner.h"

enum { WIDTH = 29, HEIGHT = 18, PIXELS = WIDTH * HEIGHT, CUBE = 8, BACKENDS = 2 };
static const char *const names[BACKENDS] = { "vulkan", "gl" };
static runner           *runners[BACKENDS];
static int               expected_messages; /* of GL, about shaders that are broken on purpose */
static char              error[1024];

/* Hardware filters linearly with weights of 8 bits. */
#define FILTER 4e-3

/* ---------------------------------------------------------------------------------------------------------- helpers */

/* A plan with its frame and inputs. */
typedef struct job {
    hbil_plan  plan;
    hbil_frame frame;
    image      in[HBIL_MAX_TEXTURES], out[HBIL_MAX_TEXTURES];
} job;

static image *input(job *j, const char *name)
{
    int32_t t = hbil_plan_texture(&j->plan, name);
    assert_true(t >= 0);
    return &j->in[t < 0 ? 0 : t];
}

static const image *output(const job *j, const char *name)
{
    int32_t t = hbil_plan_texture(&j->plan, name);
    assert_true(t >= 0);
    assert_non_null(j->out[t].data);
    return &j->out[t];
}

/* The plane n.p = -4 m in view space, seen by a camera that looks along -z. wobble: how far normals stray from it. */
static void fill_surface(job *j, const float plane[3], float wobble)
{
    image *depth = input(j, "depth"), *normal = input(j, "normal");
    int p, k;
    assert_true(image_make(depth, WIDTH, HEIGHT, 1) && image_make(normal, WIDTH, HEIGHT, 3));
    for (p = 0; p < PIXELS; ++p) {
        float x = (2.0f * ((float)(p % WIDTH) + 0.5f) / WIDTH - 1.0f) / j->frame.projection[0], length = 0.0f;
        float y = (2.0f * ((float)(p / WIDTH) + 0.5f) / HEIGHT - 1.0f) / j->frame.projection[5], *n = &normal->data[3 * p];
        depth->data[p] = 4.0f / (plane[2] - plane[0] * x - plane[1] * y);
        for (k = 0; k < 3; ++k) n[k] = plane[k] + wobble * (inputs_random((uint32_t)p, (uint32_t)k) - 0.5f);
        for (k = 0; k < 3; ++k) length += n[k] * n[k];
        for (k = 0; k < 3; ++k) n[k] /= sqrtf(length);
    }
}

static void open_job(job *j, int backend, const char *config, const float plane[3], float wobble)
{
    hbil_config c;
    uint32_t t;
    memset(j, 0, sizeof *j);
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_config_set(&c, "target", names[backend], NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &j->plan, NULL), HBIL_OK);
    j->frame = test_frame(&j->plan.config, WIDTH, HEIGHT);
    inputs_far_light(&j->frame);
    fill_surface(j, plane, wobble);
    for (t = 0; t < j->plan.texture_count; ++t) {
        const char *name = j->plan.textures[t].name;
        if (strcmp(name, "radiance") == 0) inputs_noise(&j->in[t], WIDTH, HEIGHT, 1, 3, 0.0f, 1.0f);
        if (strcmp(name, "sky") == 0) inputs_noise(&j->in[t], CUBE, CUBE, 6, 3, 0.0f, 1.0f);
    }
}

static void free_images(image images[HBIL_MAX_TEXTURES])
{
    int t;
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&images[t]);
}

static void run_job(job *j, int backend)
{
    free_images(j->out);
    if (!runner_run(runners[backend], &j->plan, &j->frame, j->in, j->out, 1, NULL, error, sizeof error))
        fail_msg("%s: %s", names[backend], error);
}

static void close_job(job *j)
{
    free_images(j->in);
    free_images(j->out);
}

static void expect_error(job *j, int backend, const char *part)
{
    free_images(j->out);
    if (runner_run(runners[backend], &j->plan, &j->frame, j->in, j->out, 1, NULL, error, sizeof error))
        fail_msg("%s: no error \"%s\"", names[backend], part);
    if (!strstr(error, part)) fail_msg("%s: \"%s\" does not name \"%s\"", names[backend], error, part);
}

/* World space of a vector of the view space: the transpose of view. */
static void to_world(const hbil_frame *f, const float v[3], double out[3])
{
    int i, k;
    for (i = 0; i < 3; ++i)
        for (out[i] = 0, k = 0; k < 3; ++k) out[i] += (double)f->view[4 * i + k] * (double)v[k];
}

/* Six views that look along the axes, each turned a little, eye away from the origin. */
static void set_view(hbil_frame *f, int which)
{
    static const double axes[6][3] = { { 1, 0, 0 }, { -1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 }, { 0, 0, -1 } };
    static const double eye[3] = { 0.5, -0.25, 1.5 };
    double z[3], x[3], y[3], length, row[3][3];
    int i, k;
    for (i = 0; i < 3; ++i) z[i] = axes[which][i] + 0.1 * (i + 1); /* back of the camera */
    length = sqrt(z[0] * z[0] + z[1] * z[1] + z[2] * z[2]);
    for (i = 0; i < 3; ++i) z[i] /= length;
    x[0] = z[1] + z[2]; /* some vector across */
    x[1] = x[2] = -z[0];
    length = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
    for (i = 0; i < 3; ++i) x[i] /= length;
    for (i = 0; i < 3; ++i) y[i] = z[(i + 1) % 3] * x[(i + 2) % 3] - z[(i + 2) % 3] * x[(i + 1) % 3];
    memcpy(row[0], x, sizeof x);
    memcpy(row[1], y, sizeof y);
    memcpy(row[2], z, sizeof z);
    for (i = 0; i < 3; ++i) {
        double shift = 0;
        for (k = 0; k < 3; ++k) {
            f->view[4 * k + i] = (float)row[i][k];
            shift -= row[i][k] * eye[k];
        }
        f->view[12 + i] = (float)shift;
    }
}

static const float facing[3] = { 0, 0, 1 };

/* ------------------------------------------------------------------------------------------------------------- cube */

/* Face and coordinates in [-1, 1] of a direction, as Vulkan and GL both have it. */
static int face_of(const double d[3], double *s, double *t)
{
    double ax = fabs(d[0]), ay = fabs(d[1]), az = fabs(d[2]);
    if (ax >= ay && ax >= az) {
        *s = (d[0] > 0 ? -d[2] : d[2]) / ax;
        *t = -d[1] / ax;
        return d[0] > 0 ? 0 : 1;
    }
    if (ay >= az) {
        *s = d[0] / ay;
        *t = (d[1] > 0 ? d[2] : -d[2]) / ay;
        return d[1] > 0 ? 2 : 3;
    }
    *s = (d[2] > 0 ? d[0] : -d[0]) / az;
    *t = -d[1] / az;
    return d[2] > 0 ? 4 : 5;
}

/* Texel (x, y) of a face, or of the neighbour that it lies on when one of them is outside. */
static const float *cube_texel(const image *cube, int face, int x, int y)
{
    double s = (2.0 * x + 1.0) / CUBE - 1.0, t = (2.0 * y + 1.0) / CUBE - 1.0, d[3] = { 0, 0, 0 };
    switch (face) {
    case 0:  d[0] = 1;  d[1] = -t; d[2] = -s; break;
    case 1:  d[0] = -1; d[1] = -t; d[2] = s;  break;
    case 2:  d[0] = s;  d[1] = 1;  d[2] = t;  break;
    case 3:  d[0] = s;  d[1] = -1; d[2] = -t; break;
    case 4:  d[0] = s;  d[1] = -t; d[2] = 1;  break;
    default: d[0] = -s; d[1] = -t; d[2] = -1; break;
    }
    face = face_of(d, &s, &t);
    x = (int)floor((s + 1.0) / 2.0 * CUBE);
    y = (int)floor((t + 1.0) / 2.0 * CUBE);
    return &cube->data[((face * CUBE + y) * CUBE + x) * 3];
}

/* Bilinear, over edges too. 0 within half a texel of a corner, where three texels meet and devices differ. */
static int sample_cube(const image *cube, const double d[3], double rgb[3])
{
    double s, t;
    int face = face_of(d, &s, &t), x, y, k;
    s = (s + 1.0) / 2.0 * CUBE - 0.5;
    t = (t + 1.0) / 2.0 * CUBE - 0.5;
    x = (int)floor(s);
    y = (int)floor(t);
    if ((x < 0 || x > CUBE - 2) && (y < 0 || y > CUBE - 2)) return 0;
    s -= x;
    t -= y;
    for (k = 0; k < 3; ++k)
        rgb[k] = (1 - t) * ((1 - s) * (double)cube_texel(cube, face, x, y)[k] + s * (double)cube_texel(cube, face, x + 1, y)[k]) +
                 t * ((1 - s) * (double)cube_texel(cube, face, x, y + 1)[k] + s * (double)cube_texel(cube, face, x + 1, y + 1)[k]);
    return 1;
}

static void cube_maps_are_filtered_over_their_edges(void **state)
{
    job j;
    int backend, view, p, k, checked = 0, faces = 0;
    double worst = 0;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend) {
        open_job(&j, backend, "outputs=ao+bent+far environment=cube", facing, 1.2f);
        for (view = 0; view < 6; ++view) {
            const image *ao, *bent, *far_light;
            set_view(&j.frame, view);
            run_job(&j, backend);
            ao = output(&j, "ao");
            bent = output(&j, "bent");
            far_light = output(&j, "far");
            for (p = 0; p < PIXELS; ++p) {
                double d[3], rgb[3], s, t;
                to_world(&j.frame, &bent->data[4 * p], d);
                faces |= 1 << face_of(d, &s, &t);
                if (!sample_cube(input(&j, "sky"), d, rgb)) continue;
                for (k = 0; k < 3; ++k)
                    worst = fmax(worst, fabs((double)ao->data[p] * rgb[k] - (double)far_light->data[4 * p + k]));
                ++checked;
            }
        }
        close_job(&j);
    }
    print_message("cube: %d pixels, worst %.1e\n", checked, worst);
    assert_int_equal(faces, 63);
    assert_true(checked > BACKENDS * 6 * PIXELS * 8 / 10);
    assert_true(worst < FILTER);
}

/* --------------------------------------------------------------------------------------------------------------- 3D */

enum { NX = 4, NY = 3, NZ = 2 };

/* A coefficient that grows linearly over the grid, so that trilinear reading is exact. */
static double grown(int coefficient, int channel, const double cell[3])
{
    return (coefficient ? 0.1 : 2.0) * (channel + 1) + 0.3 * cell[0] + 0.2 * cell[1] + 0.1 * cell[2];
}

static void fill_probes(image *probes, int coefficients)
{
    int k, x, y, z, c;
    assert_true(image_make_slices(probes, NX, NY, NZ * coefficients, 3));
    for (k = 0; k < 4; k += 3) /* Y00 and Y11, all others stay 0: a neighbouring slab that bleeds in shows */
        for (z = 0; z < NZ; ++z)
            for (y = 0; y < NY; ++y)
                for (x = 0; x < NX; ++x)
                    for (c = 0; c < 3; ++c) {
                        double cell[3] = { x, y, z };
                        probes->data[(((k * NZ + z) * NY + y) * NX + x) * 3 + c] = (float)grown(k, c, cell);
                    }
}

/* Where a pixel's surface is in the grid, clamped to it. Returns 1 if it was outside. */
static int cell_of(const job *j, int p, double cell[3])
{
    static const int size[3] = { NX, NY, NZ };
    float z = j->in[hbil_plan_texture(&j->plan, "depth")].data[p], v[3];
    int i, outside = 0;
    v[0] = (2.0f * ((float)(p % WIDTH) + 0.5f) / WIDTH - 1.0f) / j->frame.projection[0] * z - j->frame.view[12];
    v[1] = (2.0f * ((float)(p / WIDTH) + 0.5f) / HEIGHT - 1.0f) / j->frame.projection[5] * z - j->frame.view[13];
    v[2] = -z - j->frame.view[14];
    to_world(&j->frame, v, cell);
    for (i = 0; i < 3; ++i) {
        cell[i] = (cell[i] - (double)j->frame.probe_origin[i]) / (double)j->frame.probe_step[i];
        outside |= cell[i] < 0 || cell[i] > size[i] - 1;
        cell[i] = fmin(fmax(cell[i], 0.0), size[i] - 1.0);
    }
    return outside;
}

static double probes_worst(const job *j, int *inside)
{
    const image *ao = output(j, "ao"), *bent = output(j, "bent"), *far_light = output(j, "far");
    double worst = 0;
    int p, c;
    for (p = 0; p < PIXELS; ++p) {
        double cell[3], d[3];
        *inside += !cell_of(j, p, cell);
        to_world(&j->frame, &bent->data[4 * p], d);
        for (c = 0; c < 3; ++c) {
            double want = 0.282095 * (double)ao->data[p] * grown(0, c, cell) + 0.488603 * d[0] * grown(3, c, cell);
            worst = fmax(worst, fabs(want - (double)far_light->data[4 * p + c]));
        }
    }
    return worst;
}

static void probes_are_filtered_and_go_on_beyond_the_grid(void **state)
{
    static const char *const configs[] = { "outputs=ao+bent+far environment=probes sh_order=1",
                                           "outputs=ao+bent+far environment=probes" };
    static const float origin[3] = { -4.0f, -3.0f, -5.0f }, step[3] = { 2.5f, 3.0f, 8.0f };
    job j;
    int backend, k, view, inside = 0;
    double worst = 0;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend)
        for (k = 0; k < 2; ++k) {
            open_job(&j, backend, configs[k], facing, 0.6f);
            memcpy(j.frame.probe_origin, origin, sizeof origin);
            memcpy(j.frame.probe_step, step, sizeof step);
            fill_probes(input(&j, "probes"), k ? 9 : 4);
            for (view = 0; view < 6; ++view) {
                set_view(&j.frame, view);
                run_job(&j, backend);
                worst = fmax(worst, probes_worst(&j, &inside));
            }
            close_job(&j);
        }
    print_message("probes: %d pixels inside the grid, %d outside, worst %.1e\n", inside, BACKENDS * 12 * PIXELS - inside, worst);
    assert_in_range(inside, BACKENDS * PIXELS, BACKENDS * 11 * PIXELS);
    assert_true(worst < FILTER);
}

/* ------------------------------------------------------------------------------------------------------------ array */

/* An open tilted plane: a is the integral of Y over the hemisphere of its normal, 2 pi Y00 and pi Y1(n); no light arrives. */
static void layers_of_an_array_come_in_order(void **state)
{
    static const float tilted[3] = { 0.3f, -0.2f, 0.932738f };
    static const double want[4] = { 1.772454, 1.534990 * -0.2, 1.534990 * 0.932738, 1.534990 * 0.3 };
    static const char *const configs[] = { "outputs=sh slices=16", "outputs=sh+ao estimator=bitmask slices=16" };
    job j;
    int backend, k, layer, p;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend)
        for (k = 0; k < 2; ++k) {
            const image *sh;
            open_job(&j, backend, configs[k], tilted, 0.0f);
            run_job(&j, backend);
            sh = output(&j, "sh");
            assert_int_equal(sh->depth, 4);
            for (layer = 0; layer < 4; ++layer) {
                double sum = 0;
                for (p = 0; p < PIXELS; ++p) sum += (double)sh->data[(layer * PIXELS + p) * 4 + 3];
                if (fabs(sum / PIXELS - want[layer]) > 0.02)
                    fail_msg("%s, %s: layer %d is %g, not %g", names[backend], configs[k], layer, sum / PIXELS, want[layer]);
            }
            close_job(&j);
        }
}

/* ------------------------------------------------------------------------------------------------------ multisample */

static void the_chosen_sample_is_read_and_no_other(void **state)
{
    static const char *const outputs = "outputs=ao+near+bent";
    job plain, j;
    char config[128];
    int backend, sample;
    size_t bytes = (size_t)PIXELS * 4 * sizeof(float);
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend) {
        open_job(&plain, backend, outputs, facing, 0.8f);
        run_job(&plain, backend);
        for (sample = 0; sample < 5; ++sample) {
            snprintf(config, sizeof config, "%s multisample=yes sample=%d", outputs, sample);
            open_job(&j, backend, config, facing, 0.8f);
            assert_int_equal(j.plan.textures[hbil_plan_texture(&j.plan, "depth")].dim, HBIL_DIM_2D_MULTISAMPLE);
            if (sample < RUNNER_SAMPLES) {
                run_job(&j, backend);
                assert_memory_equal(output(&j, "ao")->data, output(&plain, "ao")->data, bytes / 4);
                assert_memory_equal(output(&j, "near")->data, output(&plain, "near")->data, bytes);
                assert_memory_equal(output(&j, "bent")->data, output(&plain, "bent")->data, bytes);
            } else {
                expect_error(&j, backend, "sample 4 is asked for, but this program makes textures of 4 samples");
            }
            close_job(&j);
        }
        close_job(&plain);
    }
}

/* ------------------------------------------------------------------------------------------------------------- hook */

#define HOOK_HEAD "\nconst float half_ = 0.5; // ours\nvec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"

static void a_hook_runs_and_may_change(void **state)
{
    job j;
    int backend, p, k, pass;
    double worst = 0;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend) {
        open_job(&j, backend, "outputs=ao+bent+far environment=hook", facing, 1.0f);
        set_view(&j.frame, 3);
        for (pass = 0; pass < 3; ++pass) { /* one text, another, the first again */
            const image *ao, *bent, *far_light;
            assert_true(runner_hook(runners[backend], pass == 1 ? HOOK_HEAD "    return vec3(cos_aperture);\n}\n"
                                                                : HOOK_HEAD "    return half_ + half_ * direction;\n}"));
            run_job(&j, backend);
            ao = output(&j, "ao");
            bent = output(&j, "bent");
            far_light = output(&j, "far");
            for (p = 0; p < PIXELS; ++p) {
                double d[3], a = (double)ao->data[p], length;
                to_world(&j.frame, &bent->data[4 * p], d);
                length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
                for (k = 0; k < 3; ++k) {
                    double want = pass == 1 ? a * sqrt(1 - fmin(a, 1.0)) : a * (0.5 + 0.5 * d[k] / length);
                    worst = fmax(worst, fabs(want - (double)far_light->data[4 * p + k]));
                }
            }
        }
        close_job(&j);
        runner_hook(runners[backend], NULL);
    }
    print_message("hook: worst %.1e\n", worst);
    assert_true(worst < 1e-5);
}

/* Mesa's GL calls the source of some messages 0, with the right line; at least one says 1. */
static void a_broken_hook_is_reported_at_its_own_line(void **state)
{
    job j;
    int backend, before = runner_messages(runners[1]);
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend) {
        open_job(&j, backend, "outputs=far environment=hook", facing, 0.0f);
        expect_error(&j, backend, "no text given");
        runner_hook(runners[backend], "vec3 another_function(vec3 d) { return d; }\n");
        expect_error(&j, backend, "no function vec3 hbil_far_hook");
        runner_hook(runners[backend], HOOK_HEAD "    return vec3(unheard_of);\n}\n");
        expect_error(&j, backend, "1:4");
        expect_error(&j, backend, "unheard_of");
        expected_messages = runner_messages(runners[1]) - before;
        runner_hook(runners[backend], HOOK_HEAD "    return direction;\n}\n");
        run_job(&j, backend);
        runner_hook(runners[backend], NULL);
        expect_error(&j, backend, "no text given");
        close_job(&j);
    }
}

/* ----------------------------------------------------------------------------------------------------------- shapes */

static void wrong_shapes_are_named(void **state)
{
    job j;
    int backend;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend) {
        open_job(&j, backend, "outputs=far environment=cube", facing, 0.0f);
        input(&j, "sky")->depth = 5;
        expect_error(&j, backend, "input sky is a cube map");
        input(&j, "sky")->depth = 6;
        input(&j, "sky")->height = CUBE / 2;
        expect_error(&j, backend, "input sky is a cube map");
        input(&j, "sky")->height = CUBE;
        input(&j, "depth")->height = HEIGHT - 1;
        expect_error(&j, backend, "input depth is too small: the plan needs 29x18 texels");
        input(&j, "depth")->height = HEIGHT;
        run_job(&j, backend);
        image_free(input(&j, "sky"));
        expect_error(&j, backend, "input sky is missing");
        close_job(&j);
    }
}

/* No plan keeps an array to itself yet, so plans are bent to do so. */
static void arrays_may_be_the_backends_own(void **state)
{
    job j;
    int backend, copies;
    (void)state;
    for (backend = 0; backend < BACKENDS; ++backend)
        for (copies = 1; copies <= 2; ++copies) {
            hbil_texture *sh;
            open_job(&j, backend, "outputs=ao+sh", facing, 0.0f);
            sh = &j.plan.textures[hbil_plan_texture(&j.plan, "sh")];
            sh->life = copies == 1 ? HBIL_LIFE_TRANSIENT : HBIL_LIFE_HISTORY;
            sh->copies = (uint16_t)copies;
            run_job(&j, backend);
            j.frame.index = 1;
            run_job(&j, backend);
            sh->layers = 0;
            expect_error(&j, backend, "texture sh has dim 3 and 0 layers");
            close_job(&j);
        }
}

static void no_message_came(void **state)
{
    (void)state;
    assert_int_equal(runner_messages(runners[0]), 0);
    assert_int_equal(runner_messages(runners[1]), expected_messages);
}

static int set_up(void **state)
{
    int i;
    (void)state;
    for (i = 0; i < BACKENDS; ++i) {
        runners[i] = runner_open(names[i], 1, error, sizeof error);
        if (!runners[i]) print_error("%s\n", error);
    }
    return runners[0] && runners[1] ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    runner_close(runners[0]);
    runner_close(runners[1]);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cube_maps_are_filtered_over_their_edges),
        cmocka_unit_test(probes_are_filtered_and_go_on_beyond_the_grid),
        cmocka_unit_test(layers_of_an_array_come_in_order),
        cmocka_unit_test(the_chosen_sample_is_read_and_no_other),
        cmocka_unit_test(a_hook_runs_and_may_change),
        cmocka_unit_test(a_broken_hook_is_reported_at_its_own_line),
        cmocka_unit_test(wrong_shapes_are_named),
        cmocka_unit_test(arrays_may_be_the_backends_own),
        cmocka_unit_test(no_message_came),
    };
    return cmocka_run_group_tests_name("shapes", tests, set_up, tear_down);
}
