/* compare.h - what the tests that hold one backend against another share. Include after test.h. */
#ifndef HBIL_TEST_COMPARE_H
#define HBIL_TEST_COMPARE_H

#include "inputs.h"
#include "../../examples/frame/runner.h"

static char error[512];

static const char hook[] = "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
                           "    vec3 ground = 0.2 + 0.1 * sin(position);\n"
                           "    return mix(ground, vec3(0.5, 0.7, 1.0), 0.5 + 0.5 * direction.z) * (1.5 - cos_aperture);\n"
                           "}\n";

static hbil_plan plan_of(const char *config, const char *target)
{
    hbil_config c;
    hbil_plan plan;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_config_set(&c, "target", target, NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    return plan;
}

static inline void run(runner *r, const hbil_plan *plan, const capture *cap, image outputs[HBIL_MAX_TEXTURES])
{
    image inputs[HBIL_MAX_TEXTURES];
    hbil_frame frame;
    int i;
    memset(inputs, 0, sizeof inputs);
    if (!inputs_encode(cap, plan, &frame, inputs, error, sizeof error)) fail_msg("%s", error);
    if (!runner_run(r, plan, &frame, inputs, outputs, 1, NULL, error, sizeof error)) fail_msg("%s", error);
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
}

/* Mean difference, at most one pixel in 10,000 beyond 2e-3. */
static void like_image(const char *where, const char *output, const image *a, const image *b, double mean)
{
    double sum = 0;
    int beyond = 0, pixels = a->width * a->height * image_slices(a), p, k;
    assert_int_equal(a->width, b->width);
    assert_int_equal(image_slices(a), image_slices(b));
    assert_int_equal(a->channels, b->channels);
    for (p = 0; p < pixels; ++p) {
        double worst = 0;
        for (k = 0; k < a->channels; ++k) {
            double d = (double)a->data[p * a->channels + k] - (double)b->data[p * a->channels + k];
            if (d < 0) d = -d;
            assert_true(d < 1e30); /* false for NaN */
            if (d > worst) worst = d;
        }
        sum += worst;
        beyond += worst > 2e-3;
    }
    if (pixels > 20000 || mean > 1e-5)
        print_message("%-24s %-18s mean difference %.1e, %d of %d pixels beyond 2e-3\n", where, output, sum / pixels, beyond,
                      pixels);
    if (sum / pixels > mean || beyond * 10000 > pixels)
        fail_msg("%s, %s: mean difference %.1e, %d of %d pixels beyond 2e-3", where, output, sum / pixels, beyond, pixels);
}

static inline void same_image(const char *where, const char *output, const image *a, const image *b)
{
    like_image(where, output, a, b, 1e-5);
}

enum { MOVES = 4 };

/* The built-in scene under a moving camera. */
static void make_film(capture film[MOVES])
{
    int f;
    for (f = 0; f < MOVES; ++f) {
        const float move[3] = { 0.08f * (float)f, 0.0f, 0.1f * (float)f };
        if (!capture_scene_from(&film[f], "cornell", move, 1.5f * (float)f, 97, 61, 0, NULL, error, sizeof error)) fail_msg("%s", error);
        if (f > 0) assert_true(capture_motion(&film[f], &film[f - 1]));
    }
}

/* The last of a few frames under a moving camera. */
static inline void run_moves(runner *r, const hbil_plan *plan, const capture *film, image outputs[HBIL_MAX_TEXTURES])
{
    image inputs[HBIL_MAX_TEXTURES];
    int i, f;
    for (f = 0; f < MOVES; ++f) {
        hbil_frame frame;
        for (i = 0; i < HBIL_MAX_TEXTURES && f > 0; ++i) image_free(&outputs[i]);
        memset(inputs, 0, sizeof inputs);
        if (!inputs_encode(&film[f], plan, &frame, inputs, error, sizeof error)) fail_msg("%s", error);
        if (f > 0) capture_follow(&frame, &film[f - 1]);
        frame.index = (uint32_t)f;
        if (!runner_run(r, plan, &frame, inputs, outputs, 1, NULL, error, sizeof error)) fail_msg("%s", error);
        for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
    }
}

#endif
