/* faults.h - what the tests of faults share: small plans, inputs, a few frames, which faults are of the slice. Include behind
 * test.h. */
#ifndef HBIL_TEST_FAULTS_H
#define HBIL_TEST_FAULTS_H

#include <math.h>

#include "../../examples/frame/runner.h"

enum { WIDTH = 19, HEIGHT = 11, FRAMES = 2, TEXELS = 48 * 48 };

static char     error[1024];
static int      injected; /* faults */
static uint32_t seed = 1;

static uint32_t random_below(uint32_t n)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % n;
}

/* Is this place one of the slice? */
static int in_slice(uint32_t one_of) { return getenv("HBIL_LONG") || random_below(one_of) == 0; }

#define SMALL "outputs=ao slices=1 steps=1 noise=none normals=depth "

static hbil_plan plan_of(const char *config, const char *target)
{
    hbil_config c;
    hbil_plan plan;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_set(&c, "target", target, NULL), HBIL_OK);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    return plan;
}

/* A wavy surface for depth, and something for all else. */
static void make_inputs(const hbil_plan *plan, int width, int height, image inputs[HBIL_MAX_TEXTURES])
{
    uint32_t t;
    int i;
    memset(inputs, 0, HBIL_MAX_TEXTURES * sizeof *inputs);
    for (t = 0; t < plan->texture_count; ++t) {
        const int depth = strcmp(plan->textures[t].name, "depth") == 0, channels = depth ? 1 : 3;
        if (plan->textures[t].life != HBIL_LIFE_INPUT) continue;
        assert_true(image_make(&inputs[t], width, height, channels));
        for (i = 0; i < width * height * channels; ++i)
            inputs[t].data[i] = depth ? 4.0f + 0.1f * (float)((i * 7 + i / width) % 5) : 0.25f * (float)(i % 3);
    }
}

static void free_images(image images[HBIL_MAX_TEXTURES])
{
    int t;
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&images[t]);
}

/* The ao of the last of a few frames. 0: error[] says why. */
static inline int run_frames(runner *r, const hbil_plan *plan, int width, int height, float ao[TEXELS])
{
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    double ms[HBIL_MAX_PASSES];
    int f, ok = 1;
    make_inputs(plan, width, height, inputs);
    memset(ao, 0, TEXELS * sizeof *ao);
    for (f = 0; f < FRAMES && ok; ++f) {
        hbil_frame frame = test_frame(&plan->config, (uint32_t)width, (uint32_t)height);
        frame.index = (uint32_t)f;
        frame.reset = f == 0;
        ok = runner_run(r, plan, &frame, inputs, outputs, 1, ms, error, sizeof error);
        if (ok) memcpy(ao, outputs[hbil_plan_texture(plan, "ao")].data, (size_t)(width * height) * sizeof *ao);
        free_images(outputs);
    }
    free_images(inputs);
    return ok;
}

/* The ao and near of one frame, as bytes. */
static void run_one(runner *r, const hbil_plan *plan, const int size[2], uint32_t index, image outputs[HBIL_MAX_TEXTURES])
{
    image inputs[HBIL_MAX_TEXTURES];
    hbil_frame frame = test_frame(&plan->config, (uint32_t)size[0], (uint32_t)size[1]);
    frame.index = index;
    make_inputs(plan, size[0], size[1], inputs);
    if (!runner_run(r, plan, &frame, inputs, outputs, 1, NULL, error, sizeof error)) fail_msg("%s", error);
    free_images(inputs);
}

static int count_of(const image *img) { return img->width * img->height * img->channels * image_slices(img); }

/* With history, by size: finite, and after each change the same as a new start. */
static inline void change_sizes(const char *backend)
{
    static const int sizes[][2] = { { 19, 11 }, { 48, 31 }, { 48, 31 }, { 7, 5 }, { 1, 1 }, { 1, 1 }, { 2, 48 }, { 19, 11 }, { 19, 11 } };
    const hbil_plan plan = plan_of("outputs=ao+near slices=1 steps=4 temporal=yes bounces=recursive filter=3x3 downscale=2", backend);
    runner *r;
    size_t i;
    r = runner_open(backend, 1, error, sizeof error);
    assert_non_null(r);
    for (i = 0; i < sizeof sizes / sizeof *sizes; ++i) {
        const int same = i > 0 && memcmp(sizes[i], sizes[i - 1], sizeof sizes[i]) == 0;
        image a[HBIL_MAX_TEXTURES], b[HBIL_MAX_TEXTURES];
        runner *fresh = same ? NULL : runner_open(backend, 0, error, sizeof error);
        int t, k;
        memset(b, 0, sizeof b);
        run_one(r, &plan, sizes[i], (uint32_t)i, a);
        if (fresh) run_one(fresh, &plan, sizes[i], (uint32_t)i, b);
        for (t = 0; t < HBIL_MAX_TEXTURES; ++t) {
            for (k = 0; a[t].data && k < count_of(&a[t]); ++k) assert_true(isfinite(a[t].data[k]));
            if (fresh && a[t].data) assert_memory_equal(a[t].data, b[t].data, (size_t)count_of(&a[t]) * sizeof(float));
        }
        free_images(a);
        free_images(b);
        runner_close(fresh);
    }
    assert_int_equal(runner_messages(r), 0);
    runner_close(r);
}

#endif
