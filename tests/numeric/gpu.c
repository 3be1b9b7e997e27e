/* gpu.c - see gpu.h */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <time.h>

#define HBIL_IMPLEMENTATION
#include "gpu.h"

#include "../../examples/frame/runner.h"

static runner  *g_runners[2], *g_runner; /* the latter: one of them */
static int32_t  g_target; /* hbil_target */

double gpu_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* 1, or 0: there is no such backend here. */
static int open_view(int index)
{
    const char *backend = getenv("HBIL_BACKEND");
    char        error[512] = "";
    if (!backend || !*backend) {
        backend = "vulkan";
    }
    g_target = runner_target(backend);
    g_runners[index] = runner_open(backend, 0, error, sizeof error);
    if (!g_runners[index]) {
        print_error("%s\n", error);
    }
    return g_runners[index] != NULL;
}

void gpu_view(int index)
{
    assert_true(g_runners[index] || open_view(index));
    g_runner = g_runners[index];
}

int gpu_open(void **state)
{
    (void)state;
    if (!open_view(0)) {
        return 1;
    }
    g_runner = g_runners[0];
    print_message("%s: %s\n", runner_about(g_runner)->backend, runner_about(g_runner)->device);
    return 0;
}

int gpu_close(void **state)
{
    (void)state;
    for (int i = 0; i < 2; ++i) {
        runner_close(g_runners[i]);
        g_runners[i] = NULL;
    }
    return 0;
}

void gpu_projection(const bf_camera *camera, float out[16])
{
    const double sx = 2.0 / (camera->width * camera->ray[0]), sy = 2.0 / (camera->height * camera->ray[1]);
    const double ox = -1.0 - sx * camera->ray[2], oy = -1.0 - sy * camera->ray[3];
    memset(out, 0, 16 * sizeof *out);
    out[0] = (float)sx;
    out[5] = (float)sy;
    out[10] = -1.0f;
    if (camera->orthographic) {
        out[12] = (float)ox;
        out[13] = (float)oy;
        out[15] = 1.0f;
    } else {
        out[8] = (float)-ox;
        out[9] = (float)-oy;
        out[11] = -1.0f;
        out[14] = -1.0f;
    }
}

hbil_frame gpu_frame(const bf_camera *camera)
{
    hbil_frame f;
    memset(&f, 0, sizeof f);
    f.width = (uint32_t)camera->width;
    f.height = (uint32_t)camera->height;
    gpu_projection(camera, f.projection);
    f.view[0] = f.view[5] = f.view[10] = f.view[15] = 1.0f;
    return f;
}

gpu_input gpu_input_of(const capture *cap)
{
    gpu_input in;
    memset(&in, 0, sizeof in);
    in.frame.width = (uint32_t)cap->width;
    in.frame.height = (uint32_t)cap->height;
    memcpy(in.frame.projection, cap->projection, sizeof in.frame.projection);
    memcpy(in.frame.view, cap->view, sizeof in.frame.view);
    capture_follow(&in.frame, cap);
    in.depth = cap->depth;
    in.normal = cap->normal;
    in.radiance = cap->direct;
    in.albedo = cap->albedo;
    in.motion = cap->motion;
    return in;
}

void gpu_plan(const hbil_config *config, hbil_plan *plan)
{
    hbil_diag   items[8];
    hbil_diags  diags = {items, 8, 0};
    hbil_config shared = *config;
    shared.target = g_target;
    if (shared.dynamic & HBIL_DYNAMIC_SLICES) {
        shared.slices = 0;
    }
    if (shared.dynamic & HBIL_DYNAMIC_STEPS) {
        shared.steps = 0;
    }
    if (hbil_plan_build(&shared, plan, &diags) != HBIL_OK) {
        fail_msg("config rejected: %s", diags.count ? items[0].text : "?");
    }
}

void gpu_run(const hbil_config *config, const gpu_input *in, gpu_output *out)
{
    const struct { const char *name; const image *from; } sources[] = {
        {"depth", &in->depth}, {"normal", &in->normal}, {"radiance", &in->radiance}, {"albedo", &in->albedo}, {"motion", &in->motion}};
    struct { const char *name; image *to; } sinks[] = {{"ao", &out->ao}, {"near", &out->near}, {"bent", &out->bent}};
    hbil_plan  plan;
    hbil_frame frame = in->frame;
    image      inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    char       error[512] = "";
    memset(inputs, 0, sizeof inputs);
    memset(out, 0, sizeof *out);
    gpu_plan(config, &plan);
    for (size_t i = 0; i < sizeof sources / sizeof *sources; ++i) {
        const int32_t texture = hbil_plan_texture(&plan, sources[i].name);
        if (texture >= 0) {
            inputs[texture] = *sources[i].from;
        }
    }
    frame.live = config;
    if (!runner_run(g_runner, &plan, &frame, inputs, outputs, 1, NULL, error, sizeof error)) {
        fail_msg("%s", error);
    }
    for (int i = 0; i < 3; ++i) {
        const int32_t texture = hbil_plan_texture(&plan, sinks[i].name);
        if (texture >= 0) {
            *sinks[i].to = outputs[texture];
        }
    }
    assert_int_equal(runner_messages(g_runner), 0);
}

void gpu_free(gpu_output *out)
{
    image_free(&out->ao);
    image_free(&out->near);
    image_free(&out->bent);
}

void gpu_text(const char *pass, const char *text)
{
    assert_true(runner_text(g_runner, pass, text));
}
