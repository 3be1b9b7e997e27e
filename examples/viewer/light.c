/* light.c - configs, presets and views. */
#include "light.h"

#include <stdio.h>
#include <string.h>

#include "../frame/image.h"

/* What this renderer's images and matrices are. */
static const char given[] = "depth=device depth_direction=forward depth_far=finite projection=perspective "
                            "normals=world normal_encoding=xyz multisample=no";

/* An option by name, as a member of a config. */
static uint32_t *member(hbil_config *config, const char *name)
{
    const hbil_option *option = hbil_option_at(hbil_option_find(name, strlen(name), NULL));
    return (uint32_t *)(void *)((char *)config + option->offset); /* 4 bytes whatever the kind */
}

/* Copies the first finding of that severity, and about that option unless -1, to message; 0: there is none. */
static int tell(const hbil_diags *diags, hbil_severity severity, int32_t option, char *message, size_t message_size)
{
    int i;

    for (i = 0; i < diags->count && i < diags->capacity; i++) {
        if (diags->items[i].severity != severity || (option >= 0 && diags->items[i].option != option)) continue;
        snprintf(message, message_size, "%s", diags->items[i].text);
        return 1;
    }
    return 0;
}

/* ---- presets and options ----------------------------------------------------------------------------------------- */

int light_preset(light *l, const char *name, char *message, size_t message_size)
{
    hbil_config config;
    hbil_diag   diag;
    hbil_diags  diags = {&diag, 1, 0};

    if (hbil_config_preset(name, &config, &diags) != HBIL_OK)
        return frame_error(message, message_size, "%s", diag.text);
    l->wanted = config;
    l->own_outputs = 0;
    snprintf(l->preset, sizeof l->preset, "%s", name);
    return 1;
}

int light_set(light *l, const char *text, char *message, size_t message_size)
{
    static const char *const ours[] = {"target", "depth", "depth_direction", "depth_far", "clip", "projection",
                                       "normals", "normal_encoding", "multisample", "width", "height"};
    hbil_config config = l->wanted;
    hbil_diag   diag;
    hbil_diags  diags = {&diag, 1, 0};
    size_t      i;

    config.outputs = 0;
    if (hbil_config_parse(&config, text, strlen(text), &diags) != HBIL_OK)
        return frame_error(message, message_size, "%s", diag.text);
    for (i = 0; i < sizeof ours / sizeof *ours; i++)
        if (*member(&config, ours[i]))
            return frame_error(message, message_size, "%s follows from this renderer's images: leave it out", ours[i]);
    if (config.environment > HBIL_ENVIRONMENT_SH)
        return frame_error(message, message_size, "environment: this renderer has no cube map, probes or hook. "
                           "Take none, constant or sh");
    if (config.outputs) l->own_outputs = 1;
    else config.outputs = l->wanted.outputs;
    l->wanted = config;
    return 1;
}

int light_step(light *l, const char *option, const char *values, int by, int ends, char *message, size_t message_size)
{
    const hbil_option *row = hbil_option_at(hbil_option_find(option, strlen(option), NULL));
    const uint32_t     now = *member(&l->plan.config, option);
    char               value[16][16];
    hbil_config        trial;
    int                count = 0, at = 0, next;
    size_t             length;

    for (; *values && count < 16; values += length + (values[length] == ' '), count++) {
        length = strcspn(values, " ");
        snprintf(value[count], sizeof value[count], "%.*s", (int)length, values);
        memset(&trial, 0, sizeof trial);
        hbil_config_set(&trial, option, value[count], NULL);
        /* a number that is none of the values counts as the next lower one */
        if (row->kind == HBIL_KIND_INT ? *member(&trial, option) <= now : *member(&trial, option) == now) at = count;
    }
    next = ends ? at + by : (at + by % count + count) % count;
    if (next < 0 || next >= count)
        return frame_error(message, message_size, "%s: the keys end at %s", option, value[at]);
    hbil_config_set(&l->wanted, option, value[next], NULL);
    snprintf(message, message_size, "%s=%s", option, value[next]);
    return 1;
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* What the views show, one by one: what a method cannot give is left out. */
static void add_outputs(hbil_config *config)
{
    static const uint32_t views[] = {HBIL_OUTPUTS_AO, HBIL_OUTPUTS_COMPOSITE, HBIL_OUTPUTS_NEAR, HBIL_OUTPUTS_FAR,
                                     HBIL_OUTPUTS_BENT};
    hbil_config trial, resolved;
    size_t      i;

    for (i = 0; i < sizeof views / sizeof *views; i++) {
        trial = *config;
        trial.outputs |= views[i];
        if (hbil_config_resolve(&trial, &resolved, NULL) == HBIL_OK) config->outputs = trial.outputs;
    }
}

int light_build(light *l, int gl, const char *about, char *message, size_t message_size)
{
    enum { FINDINGS = 32 };
    hbil_config config = l->wanted;
    hbil_diag   findings[FINDINGS];
    hbil_diags  diags = {findings, FINDINGS, 0};
    hbil_plan   plan;

    hbil_config_parse(&config, given, strlen(given), NULL);
    config.target = gl ? HBIL_TARGET_GL : HBIL_TARGET_VULKAN;
    config.clip = gl ? HBIL_CLIP_GL : HBIL_CLIP_VULKAN; /* GL's own ndc z is [-1, 1], unless glClipControl changes it */
    if (config.environment == 0) config.environment = HBIL_ENVIRONMENT_SH;
    if (config.estimator > HBIL_ESTIMATOR_BITMASK && config.far_visibility == 0)
        config.far_visibility = HBIL_FAR_VISIBILITY_AO; /* hbao and hbao_plus have no bent vector */
    if (!l->own_outputs) add_outputs(&config);
    if (hbil_plan_build(&config, &plan, &diags) != HBIL_OK) {
        if (!tell(&diags, HBIL_ERROR, -1, message, message_size)) snprintf(message, message_size, "config refused");
        return 0;
    }
    if (about) tell(&diags, HBIL_NOTE, hbil_option_find(about, strlen(about), NULL), message, message_size);
    l->plan = plan;
    return 1;
}

/* ---- the sky ----------------------------------------------------------------------------------------------------- */

/* Radiance mean + slope * z is spherical harmonics of order 1, exactly: mean = .282095 Y00, slope z = .488603 z Y10. */
void light_sky(const gpu_uniforms *scene, hbil_frame *frame)
{
    int c;

    for (c = 0; c < 3; c++) {
        frame->far_color[c] = scene->sky[0][c];
        frame->far_sh[0][c] = scene->sky[0][c] / 0.282095f;
        frame->far_sh[2][c] = scene->sky[1][c] / 0.488603f;
    }
}

/* ---- views ------------------------------------------------------------------------------------------------------- */

static const light_view views[] = {
    {"composite", "the lit picture", "composite", MODE_RADIANCE},
    {"split", "the same, left of the mouse the direct light alone", "composite", MODE_RADIANCE},
    {"direct", "before: sun, lamps and sky as the G-buffer holds them", NULL, MODE_DIRECT},
    {"ao", "ambient occlusion", "ao", MODE_GREY},
    {"near", "light from what the screen shows, E/pi", "near", MODE_RADIANCE},
    {"far", "light of the sky through what is open, E/pi", "far", MODE_RADIANCE},
    {"bent", "mean open direction in view space", "bent", MODE_VECTOR},
};

const light_view *light_view_at(int index)
{
    return index >= 0 && index < (int)(sizeof views / sizeof *views) ? &views[index] : NULL;
}

int light_show(const hbil_plan *plan, const light_view *view, int32_t *texture, gpu_mode *mode)
{
    /* what stands in for composite, the best first: the sum of near and far, ao of all bounces, ao */
    static const struct { const char *output; gpu_mode mode; } composed[] = {
        {"composite", MODE_RADIANCE}, {"irradiance", MODE_IRRADIANCE}, {"multi_bounce", MODE_VISIBILITY},
        {"ao", MODE_AO}};
    size_t i;

    *texture = -1;
    *mode = MODE_DIRECT;
    if (view->mode == MODE_DIRECT) return 1;
    if (strcmp(view->output, "composite") != 0) {
        const int32_t found = hbil_plan_texture(plan, view->output);
        if (found < 0 || plan->textures[found].life != HBIL_LIFE_OUTPUT) return 0;
        *texture = found;
        *mode = view->mode;
        return 1;
    }
    for (i = 0; i < sizeof composed / sizeof *composed; i++) {
        const int32_t found = hbil_plan_texture(plan, composed[i].output);
        if (found < 0 || plan->textures[found].life != HBIL_LIFE_OUTPUT) continue;
        *texture = found;
        *mode = composed[i].mode;
        return 1;
    }
    return 0;
}
