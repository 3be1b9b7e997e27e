/* rig.c - see rig.h */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HBIL_IMPLEMENTATION
#include "../captures.h"
#include "rig.h"

#define RAYS   0 /* of the built-in scenes: their truth is not needed here */
#define SCENES 2 /* the first of them: each costs a quarter of a minute */

static runner *g_runner;
static int     g_gl;

int rig_open(void **state)
{
    const char *backend = getenv("HBIL_BACKEND");
    char        error[512] = "";
    (void)state;
    if (!backend || !*backend) backend = "vulkan";
    g_gl = strcmp(backend, "gl") == 0;
    g_runner = runner_open(backend, 0, error, sizeof error);
    if (!g_runner) print_error("%s\n", error);
    else print_message("%s: %s\n", runner_about(g_runner)->backend, runner_about(g_runner)->device);
    return g_runner ? 0 : 1;
}

int rig_close(void **state)
{
    (void)state;
    runner_close(g_runner);
    g_runner = NULL;
    return 0;
}

environment rig_environment(const char *text)
{
    environment env;
    char        error[512] = "";
    if (!environment_parse(&env, text, error, sizeof error)) fail_msg("%s", error);
    return env;
}

const char *rig_hook(int radiance)
{
    static const char diffuse[] =
        "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
        "    const vec3 ground = vec3(0.30, 0.22, 0.14);\n"
        "    const vec3 zenith = vec3(0.45, 0.75, 1.30);\n"
        "    return mix(ground, zenith, 0.5 + direction.z / 3.0) + 0.0 * position.x * cos_aperture;\n"
        "}\n";
    static const char sharp[] =
        "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
        "    const vec3 ground = vec3(0.30, 0.22, 0.14);\n"
        "    const vec3 zenith = vec3(0.45, 0.75, 1.30);\n"
        "    return mix(ground, zenith, 0.5 + 0.5 * direction.z) + 0.0 * position.x * cos_aperture;\n"
        "}\n";
    return radiance ? sharp : diffuse;
}

static void make_up(capture *cap)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    if (!cap->f0.data) {
        assert_true(image_make(&cap->f0, cap->width, cap->height, 3));
        for (size_t i = 0; i < 3 * count; ++i) cap->f0.data[i] = 0.04f + 0.5f * cap->albedo.data[i];
    }
    if (!cap->roughness.data) {
        assert_true(image_make(&cap->roughness, cap->width, cap->height, 1));
        for (size_t i = 0; i < count; ++i) cap->roughness.data[i] = 0.05f + 0.9f * cap->albedo.data[3 * i];
    }
}

const char *rig_load(capture *cap, int index)
{
    static capture_names names;
    const char *name = index >= 0 && index < SCENES ? capture_scene_name(index) : NULL;
    char        error[512] = "";
    int         ok;
    if (name) {
        ok = capture_scene(cap, name, 320, 180, RAYS, NULL, error, sizeof error);
    } else {
        if (!names.count) names = captures_list();
        if (index - SCENES >= names.count) return NULL;
        name = names.name[index - SCENES];
        ok = captures_load(name, 0, cap, error, sizeof error);
    }
    if (!ok) fail_msg("%s", error);
    make_up(cap);
    return name;
}

void rig_whiten(capture *cap)
{
    const size_t count = 3 * (size_t)cap->width * (size_t)cap->height;
    for (size_t i = 0; i < count; ++i) cap->direct.data[i] = 1.0f;
    cap->emissive = 0;
}

void rig_run(const char *config, const capture *cap, const environment *env, rig_light *out)
{
    hbil_diag   items[8];
    hbil_diags  diags = {items, 8, 0};
    hbil_config c;
    image       inputs[HBIL_MAX_TEXTURES];
    char        error[512] = "";
    int         ok;
    memset(out, 0, sizeof *out);
    memset(&c, 0, sizeof c);
    memset(inputs, 0, sizeof inputs);
    c.target = g_gl ? HBIL_TARGET_GL : HBIL_TARGET_VULKAN;
    if (cap->orthographic) c.projection = HBIL_PROJECTION_ORTHOGRAPHIC;
    ok = hbil_config_parse(&c, config, strlen(config), &diags) == HBIL_OK && hbil_plan_build(&c, &out->plan, &diags) == HBIL_OK;
    if (!ok) fail_msg("%s: %s", config, diags.count ? items[0].text : "?");
    if (!capture_encode(cap, &out->plan, &out->frame, inputs, error, sizeof error)) fail_msg("%s: %s", config, error);
    if (env && !environment_encode(env, &out->plan, &out->frame, inputs, error, sizeof error)) fail_msg("%s: %s", config, error);
    assert_true(runner_hook(g_runner, rig_hook(out->plan.config.far_visibility == HBIL_FAR_VISIBILITY_FREE_BITS)));
    ok = runner_run(g_runner, &out->plan, &out->frame, inputs, out->out, 1, NULL, error, sizeof error);
    for (int i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
    if (!ok) fail_msg("%s: %s", config, error);
    assert_int_equal(runner_messages(g_runner), 0);
}

const image *rig_image(const rig_light *light, const char *name)
{
    const int32_t i = hbil_plan_texture(&light->plan, name);
    return i >= 0 && light->out[i].data ? &light->out[i] : NULL;
}

void rig_free(rig_light *light)
{
    for (int i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&light->out[i]);
}

bf_scene rig_scene(const capture *cap)
{
    bf_scene s;
    memset(&s, 0, sizeof s);
    s.camera = bf_camera_from(cap->projection, cap->width, cap->height);
    s.camera.orthographic = cap->orthographic;
    s.depth = cap->depth.data;
    s.sky_depth = 1e9;
    s.normal = cap->normal.data;
    s.radiance = cap->direct.data;
    return s;
}

void rig_project(const bf_camera *camera, float out[16])
{
    const double sx = 2.0 / (camera->width * camera->ray[0]), sy = 2.0 / (camera->height * camera->ray[1]);
    memset(out, 0, 16 * sizeof *out);
    out[0] = (float)sx;
    out[5] = (float)sy;
    out[8] = (float)(1.0 + sx * camera->ray[2]);
    out[9] = (float)(1.0 + sy * camera->ray[3]);
    out[10] = out[11] = -1.0f;
    out[14] = -1.0f;
}
