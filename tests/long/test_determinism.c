/* test_determinism.c - the same frames, config and device give the same bytes: in ten runs with hostile frames between them, on
 * one thread and on two; and from the second run on nothing more is allocated.
 *
 * Mesa reads LP_NUM_THREADS when it starts, so the frames run in processes of their own: this program, called with the name of
 * a backend. Each prints a line for each config, which must be the same in all of them. */
#include <malloc.h>
#include <math.h>
#include <stdlib.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../gpu/inputs.h"

#include "../../examples/frame/runner.h"

#define FRAMES 4
#define RUNS 10
#define WIDTH 72
#define HEIGHT 41 /* no multiple of a group; above 64, for all levels of push */

/* Between them they have every pass, see every_pass_is_tried. The last one only where there is GL. */
static const char *const k_configs[] = {
    "outputs=ao+bent+near+far+irradiance+composite slices=2 steps=4 environment=constant temporal=yes bounces=recursive "
    "reproject=scatter filter=3x3 filter_passes=3",
    "outputs=ao+near+composite march=sweep slices=2 sweep_stride=3 filter=5x5 downscale=2 temporal=yes bounces=recursive "
    "reproject=scatter storage=half",
    "outputs=ao+near+sh+specular_occlusion roughness=.3 march=both slices=1 steps=4 estimator=bitmask occluder=thick reach=1 "
    "environment=sh temporal=yes reproject=gather rectify=range",
    "outputs=ao+near slices=2 steps=6 mips=spread interleave=yes noise=ign gather=packed facing=half_space temporal=yes "
    "bounces=recursive",
    "target=gl stage=fragment outputs=ao+near slices=2 steps=4 downscale=2 filter=3x3 temporal=yes bounces=recursive"};
#define CONFIGS (sizeof k_configs / sizeof *k_configs)

static const char *const k_backends[] = {"vulkan", "gl"};

static const char *g_self; /* this program */
static char        error[512];

static int plan_of(size_t config, const char *backend, hbil_plan *plan)
{
    hbil_config c;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, k_configs[config], strlen(k_configs[config]), NULL), HBIL_OK);
    if (c.stage == HBIL_STAGE_FRAGMENT && strcmp(backend, "gl") != 0) return 0;
    c.target = runner_target(backend);
    assert_int_equal(hbil_plan_build(&c, plan, NULL), HBIL_OK);
    return 1;
}

/* --- the frames, in the process of a backend ------------------------------------------------------------------------ */

/* A camera that jumps back from the scene and forth: many pixels of a frame fall on one of the next. */
static int make_film(capture film[FRAMES], int hostile)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY, 0.0f, -1.0f, 1e-40f, 1e30f, 65504.0f};
    for (int f = 0; f < FRAMES; ++f) {
        const float move[3] = {0.05f * (float)f, 0.02f * (float)f, f % 2 ? -6.0f : -0.1f * (float)f};
        if (!capture_scene_from(&film[f], "cornell", move, 3.0f * (float)f, WIDTH, HEIGHT, 0, NULL, error, sizeof error)) return 0;
        for (int k = 0; hostile && k < WIDTH * HEIGHT; ++k) {
            const uint32_t dice = (uint32_t)(inputs_random((uint32_t)k, (uint32_t)f) * 4096.0f);
            if ((k % WIDTH + k / WIDTH + f) % 2 == 0 && k % WIDTH > WIDTH / 2) film[f].depth.data[k] *= 0.25f; /* checkerboard */
            if (dice % 4 == 0) film[f].depth.data[k] = bad[dice / 4 % 8];
            if (dice % 5 == 0) film[f].normal.data[3 * k + (int)(dice % 3)] = bad[dice / 8 % 8];
            if (dice % 6 == 0) film[f].direct.data[3 * k + (int)(dice % 3)] = bad[dice / 16 % 8];
            if (dice % 7 == 0) film[f].albedo.data[3 * k + (int)(dice % 3)] = bad[dice / 32 % 8];
        }
        if (f > 0 && !capture_motion(&film[f], &film[f - 1])) return 0;
    }
    return 1;
}

static uint64_t hash(uint64_t h, const image *o)
{
    const size_t bytes = sizeof(float) * (size_t)o->width * (size_t)o->height * (size_t)image_slices(o) * (size_t)o->channels;
    for (size_t k = 0; o->data && k < bytes; ++k) h = (h ^ ((const unsigned char *)o->data)[k]) * 1099511628211u;
    return h;
}

/* Hash of all outputs of all frames of a film, whose first frame has number `index`. 0: error says why. */
static uint64_t run_film(runner *r, const hbil_plan *plan, const capture film[FRAMES], uint32_t index)
{
    image    inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    uint64_t h = 14695981039346656037u;
    for (int f = 0; f < FRAMES && h; ++f) {
        hbil_frame frame;
        if (!inputs_encode(&film[f], plan, &frame, inputs, error, sizeof error)) return 0;
        if (f > 0) capture_follow(&frame, &film[f - 1]);
        frame.index = index + (uint32_t)f;
        if (!runner_run(r, plan, &frame, inputs, outputs, 1, NULL, error, sizeof error)) h = 0;
        for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) {
            if (h && outputs[t].data) h = hash(h, &outputs[t]);
            image_free(&outputs[t]);
            image_free(&inputs[t]);
        }
    }
    return h;
}

static size_t heap(void)
{
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33)
    return mallinfo2().uordblks; /* 0 under sanitizers */
#else
    return 0;
#endif
}

/* Ten runs of both films in turns. Prints a line; 0: runs differ, or what is allocated grows. */
static int run_config(runner *r, size_t config, const hbil_plan *plan, capture films[2][FRAMES])
{
    uint64_t first[2] = {0, 0};
    size_t   warm = 0;
    for (int i = 0; i < 2 * RUNS; ++i) {
        const uint64_t h = run_film(r, plan, films[i % 2], 7);
        if (h == 0) return fprintf(stderr, "config %zu: %s\n", config, error), 0;
        if (i < 2) first[i] = h;
        if (i == 5) warm = heap();
        if (h != first[i % 2]) return fprintf(stderr, "config %zu: run %d of the %s film has other bytes\n", config, i / 2 + 1,
                                           i % 2 ? "hostile" : "plain"), 0;
    }
    if (heap() > warm + 16384)
        return fprintf(stderr, "config %zu: %zu bytes more after %d runs than after 3\n", config, heap() - warm, RUNS), 0;
    if (run_film(r, plan, films[0], 8) == first[0])
        return fprintf(stderr, "config %zu: the noise of other frames gave the same hash\n", config), 0;
    printf("%zu %016llx %016llx\n", config, (unsigned long long)first[0], (unsigned long long)first[1]);
    return 1;
}

/* Exit code of the process of a backend. */
static int run_backend(const char *backend)
{
    static capture films[2][FRAMES];
    hbil_plan      plan;
    runner        *r = runner_open(backend, 0, error, sizeof error);
    int            ok = 1;
    if (!r) return fprintf(stderr, "%s\n", error), 77;
    ok = make_film(films[0], 0) && make_film(films[1], 1);
    for (size_t i = 0; i < CONFIGS && ok; ++i)
        if (plan_of(i, backend, &plan)) ok = run_config(r, i, &plan, films);
    for (int f = 0; f < 2 * FRAMES; ++f) capture_free(&films[f / FRAMES][f % FRAMES]);
    runner_close(r);
    return !ok;
}

/* --- the tests ------------------------------------------------------------------------------------------------------ */

static void every_pass_is_tried(void **state)
{
    (void)state;
    for (int32_t known = 0; known < (int32_t)HBIL__COUNT(hbil__passes); ++known) {
        int tried = 0;
        for (size_t i = 0; i < CONFIGS; ++i) {
            hbil_plan plan;
            assert_true(plan_of(i, "gl", &plan));
            tried += hbil_plan_pass(&plan, hbil__passes[known].name) >= 0;
        }
        if (!tried) fail_msg("no config has the pass %s", hbil__passes[known].name);
    }
}

typedef struct process { FILE *pipe; char text[2048]; int code; } process;

static void start(process *p, const char *backend, const char *threads)
{
    char command[4200];
    assert_true((size_t)snprintf(command, sizeof command, "LP_NUM_THREADS=%s exec '%s' %s", threads, g_self, backend) < sizeof command);
    p->pipe = popen(command, "r");
    assert_non_null(p->pipe);
}

static void finish(process *p)
{
    p->text[fread(p->text, 1, sizeof p->text - 1, p->pipe)] = 0;
    p->code = pclose(p->pipe) / 256;
}

/* With one thread and with two, at the same time. */
static void same_bytes(const char *backend)
{
    static const char *const threads[] = {"1", "2"};
    static process p[2];
    for (int i = 0; i < 2; ++i) start(&p[i], backend, threads[i]);
    for (int i = 0; i < 2; ++i) finish(&p[i]);
    if (p[0].code == 77) skip();
    print_message("%s, hashes of each config's two films:\n%s", backend, p[0].text);
    for (int i = 0; i < 2; ++i) {
        assert_int_equal(p[i].code, 0);
        assert_string_equal(p[i].text, p[0].text);
    }
}

static void same_bytes_in_ten_runs_on_one_and_two_threads_vulkan(void **state) { (void)state; same_bytes(k_backends[0]); }
static void same_bytes_in_ten_runs_on_one_and_two_threads_gl(void **state)     { (void)state; same_bytes(k_backends[1]); }

int main(int count, char **words)
{
    static const struct CMUnitTest tests[] = {cmocka_unit_test(every_pass_is_tried),
                                              cmocka_unit_test(same_bytes_in_ten_runs_on_one_and_two_threads_vulkan),
                                              cmocka_unit_test(same_bytes_in_ten_runs_on_one_and_two_threads_gl)};
    g_self = words[0];
    if (count > 1) return run_backend(words[1]);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
