/* ours.c - see ours.h */
#include "ours.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../../backends/hbil_gl.h"
#include "gl.h"

struct ours {
    hbil_plan  plan;
    hbil_frame frame;
    hbil_gl    backend;
    unsigned   textures[HBIL_MAX_TEXTURES];
    char       scratch[HBIL_GLSL_MAX];
};

static int make_plan(ours *o, const char *preset, const char *more, char *error, size_t error_size)
{
    char        options[256];
    hbil_diag   items[4];
    hbil_diags  diags = {items, 4, 0};
    hbil_config config;

    snprintf(options, sizeof options, "outputs=ao target=gl depth=device temporal=no %s", more);
    if (hbil_config_preset(preset, &config, &diags) == HBIL_OK
        && hbil_config_parse(&config, options, strlen(options), &diags) == HBIL_OK
        && hbil_plan_build(&config, &o->plan, &diags) == HBIL_OK)
        return 1;
    return frame_error(error, error_size, "preset %s, %s: %s", preset, options,
                       diags.count ? items[0].text : "refused");
}

static int make_textures(ours *o, const capture *cap, char *error, size_t error_size)
{
    static const GLenum pixels[] = {GL_RED, GL_RG, GL_RGB, GL_RGBA};
    image               inputs[HBIL_MAX_TEXTURES];
    uint32_t            i;

    if (!capture_encode(cap, &o->plan, &o->frame, inputs, error, error_size)) return 0;
    for (i = 0; i < o->plan.texture_count; ++i) {
        const hbil_texture *t = &o->plan.textures[i];
        const image        *in = &inputs[i];

        if (t->life == HBIL_LIFE_INPUT && in->data)
            o->textures[i] = gl_texture(in->channels == 1 ? GL_R32F : GL_RGBA32F, in->width, in->height,
                                        pixels[in->channels - 1], GL_FLOAT, in->data);
        else if (t->life == HBIL_LIFE_OUTPUT)
            o->textures[i] = gl_texture(hbil_gl_format((hbil_format)t->format), cap->width, cap->height, 0, 0, NULL);
    }
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
    return 1;
}

ours *ours_open(void *device, const char *preset, const char *options, const capture *cap, char *error,
                size_t error_size)
{
    hbil_gl_info info;
    ours        *o = calloc(1, sizeof *o);

    if (!o || !make_plan(o, preset, options, error, error_size) || !make_textures(o, cap, error, error_size)) {
        if (!o) frame_error(error, error_size, "out of memory");
        ours_free(o);
        return NULL;
    }
    memset(&info, 0, sizeof info);
    info.plan = &o->plan;
    info.get_proc = runner_gl_proc;
    info.user = device;
    info.scratch = o->scratch;
    info.scratch_size = sizeof o->scratch;
    if (hbil_gl_init(&info, &o->backend) == HBIL_GL_OK
        && hbil_gl_resize(&o->backend, (uint32_t)cap->width, (uint32_t)cap->height, o->textures) == HBIL_GL_OK)
        return o;
    frame_error(error, error_size, "preset %s: %s", preset, o->backend.message);
    ours_free(o);
    return NULL;
}

void ours_free(ours *o)
{
    if (!o) return;
    hbil_gl_shutdown(&o->backend);
    gl.DeleteTextures(HBIL_MAX_TEXTURES, o->textures);
    free(o);
}

int ours_taps(const ours *o)
{
    const hbil_config *c = &o->plan.config;
    return 2 * c->slices * (c->march == HBIL_MARCH_SWEEP ? 1 : c->steps);
}

int ours_run(ours *o, double *ms, char *error, size_t error_size)
{
    const double begin = gl_now();

    if (hbil_gl_run(&o->backend, &o->frame) != HBIL_GL_OK)
        return frame_error(error, error_size, "%s", o->backend.message);
    if (ms) *ms = gl_now() - begin;
    return 1;
}

int ours_read(const ours *o, image *ao)
{
    return gl_read(o->textures[hbil_plan_texture(&o->plan, "ao")], (int)o->frame.width, (int)o->frame.height, 0, ao);
}
