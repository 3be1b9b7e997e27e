/* runner.c - picks the backend and checks what both of them need. */
#include "runner_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct runner {
    const runner_ops *ops;
    void             *device;
    runner_info       about;
};

runner *runner_open(const char *backend, int validate, char *error, size_t error_size)
{
    const runner_ops *ops = strcmp(backend, "vulkan") == 0 ? &runner_vulkan : strcmp(backend, "gl") == 0 ? &runner_gl : NULL;
    if (ops == NULL) {
        snprintf(error, error_size, "no backend '%s': use vulkan or gl", backend);
        return NULL;
    }
    runner *r = (runner *)calloc(1, sizeof *r);
    if (r == NULL) {
        snprintf(error, error_size, "out of memory");
        return NULL;
    }
    r->ops = ops;
    r->device = ops->open(validate, &r->about, error, error_size);
    if (r->device != NULL) return r;
    free(r);
    return NULL;
}

void runner_close(runner *r)
{
    if (r == NULL) return;
    r->ops->close(r->device);
    free(r);
}

const runner_info *runner_about(const runner *r)    { return &r->about; }
int                runner_messages(const runner *r) { return r->ops->messages(r->device); }

/* A texel that is not there reads as anything, so every input must cover the frame. */
static int check_inputs(const hbil_plan *plan, const hbil_frame *frame, const image *inputs, char *error, size_t error_size)
{
    const uint32_t width = frame->width != 0 ? frame->width : (uint32_t)plan->config.width;
    const uint32_t height = frame->height != 0 ? frame->height : (uint32_t)plan->config.height;
    for (uint32_t t = 0; t < plan->texture_count; ++t) {
        const hbil_texture *tex = &plan->textures[t];
        uint32_t extent[2];
        if (tex->life != HBIL_LIFE_INPUT) continue;
        if (hbil_plan_extent(plan, (int32_t)t, width, height, extent) != HBIL_OK) {
            snprintf(error, error_size, "frame size %ux%u is not in [1, 16384]", width, height);
            return 0;
        }
        if (inputs[t].data == NULL || inputs[t].width < (int)extent[0] || inputs[t].height < (int)extent[1]) {
            snprintf(error, error_size, "input %s is %s: the plan needs %ux%u texels of it", tex->name,
                     inputs[t].data == NULL ? "missing" : "too small", extent[0], extent[1]);
            return 0;
        }
    }
    return 1;
}

int runner_run(runner *r, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
               image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    memset(outputs, 0, HBIL_MAX_TEXTURES * sizeof *outputs);
    if (repeat < 1) {
        snprintf(error, error_size, "repeat is %d: at least 1", repeat);
        return 0;
    }
    if (!check_inputs(plan, frame, inputs, error, error_size)) return 0;
    if (r->ops->run(r->device, plan, frame, inputs, outputs, repeat, ms, error, error_size)) return 1;
    for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&outputs[t]);
    return 0;
}
