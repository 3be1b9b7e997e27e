/* runner.c - picks the backend and checks what both of them need. */
#include "runner_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct runner {
    const runner_ops *ops;
    void             *device;
    runner_info       about;
    char             *hook, *pass, *text; /* copies of the caller's */
};

int32_t runner_target(const char *backend)
{
    return strcmp(backend, "vulkan") == 0 ? HBIL_TARGET_VULKAN : strcmp(backend, "gl") == 0 ? HBIL_TARGET_GL
         : strcmp(backend, "gles") == 0 ? HBIL_TARGET_GLES : 0;
}

runner *runner_open(const char *backend, int validate, char *error, size_t error_size)
{
    static const runner_ops *const all[] = { NULL, &runner_vulkan, &runner_gl, &runner_gles }; /* by hbil_target */
    const runner_ops *ops = all[runner_target(backend)];
    if (ops == NULL) {
        snprintf(error, error_size, "no backend '%s': use vulkan, gl or gles", backend);
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
    free(r->hook);
    free(r->pass);
    free(r->text);
    free(r);
}

const runner_info *runner_about(const runner *r)    { return &r->about; }
int                runner_messages(const runner *r) { return r->ops->messages(r->device); }

static int same(const char *a, const char *b)
{
    return a == NULL || b == NULL ? a == b : strcmp(a, b) == 0;
}

/* 0: out of memory. */
static int copy(char **to, const char *text)
{
    *to = NULL;
    if (text == NULL) return 1;
    *to = (char *)malloc(strlen(text) + 1);
    if (*to == NULL) return 0;
    memcpy(*to, text, strlen(text) + 1);
    return 1;
}

int runner_hook(runner *r, const char *text)
{
    char *hook;
    if (same(text, r->hook)) return 1;
    if (!copy(&hook, text)) return 0;
    r->ops->set_hook(r->device, hook); /* the old text is in use until here */
    free(r->hook);
    r->hook = hook;
    return 1;
}

int runner_text(runner *r, const char *pass, const char *text)
{
    char *new_pass, *new_text;
    if (text == NULL) pass = NULL;
    if (same(pass, r->pass) && same(text, r->text)) return 1;
    if (!copy(&new_pass, pass)) return 0;
    if (!copy(&new_text, text)) {
        free(new_pass);
        return 0;
    }
    r->ops->set_text(r->device, new_pass, new_text);
    free(r->pass);
    free(r->text);
    r->pass = new_pass;
    r->text = new_text;
    return 1;
}

int runner_words(runner *r, const runner_spirv *spirv)
{
    if (r->ops->set_words == NULL) return spirv == NULL;
    r->ops->set_words(r->device, spirv);
    return 1;
}

/* What is wrong with the shape of an input, NULL: nothing. needed: room for a text of its own. A texel that is not there reads
 * as anything, so every input that lies on the screen must cover the frame. */
static const char *shape_fault(const hbil_plan *plan, uint32_t t, const image *in, const uint32_t extent[2], char needed[64])
{
    const uint16_t dim = plan->textures[t].dim;
    if (in->data == NULL) return "is missing";
    if (in->width < 1 || in->height < 1 || in->channels < 1 || in->channels > 4) return "is empty, or has not 1 to 4 channels";
    if (dim == HBIL_DIM_3D) return NULL;
    if (dim == HBIL_DIM_CUBE)
        return in->width == in->height && image_slices(in) == 6 ? NULL : "is a cube map: it takes 6 slices, each of them square";
    if (image_slices(in) != 1) return "is a plain 2D texture: it takes one slice";
    if (in->width >= (int)extent[0] && in->height >= (int)extent[1]) return NULL;
    snprintf(needed, 64, "is too small: the plan needs %ux%u texels of it", extent[0], extent[1]);
    return needed;
}

static int check_inputs(const hbil_plan *plan, const hbil_frame *frame, const image *inputs, char *error, size_t error_size)
{
    const uint32_t width = frame->width != 0 ? frame->width : (uint32_t)plan->config.width;
    const uint32_t height = frame->height != 0 ? frame->height : (uint32_t)plan->config.height;
    for (uint32_t t = 0; t < plan->texture_count; ++t) {
        const hbil_texture *tex = &plan->textures[t];
        uint32_t extent[2];
        char needed[64];
        if (tex->life != HBIL_LIFE_INPUT) continue;
        if (hbil_plan_extent(plan, (int32_t)t, width, height, extent) != HBIL_OK)
            return frame_error(error, error_size, "frame size %ux%u is not in [1, 16384]", width, height);
        const char *fault = shape_fault(plan, t, &inputs[t], extent, needed);
        if (fault != NULL) return frame_error(error, error_size, "input %s %s", tex->name, fault);
        if (tex->dim == HBIL_DIM_2D_MULTISAMPLE && plan->config.sample >= RUNNER_SAMPLES)
            return frame_error(error, error_size, "input %s: sample %d is asked for, but this program makes textures of %d "
                               "samples. Set sample to %d or less", tex->name, (int)plan->config.sample, RUNNER_SAMPLES,
                               RUNNER_SAMPLES - 1);
    }
    return 1;
}

/* What all textures that lie on the screen have room for: more than the frame where the inputs do. */
static void room_of(const hbil_plan *plan, const image *inputs, const uint32_t frame[2], uint32_t room[2])
{
    room[0] = room[1] = UINT32_MAX;
    for (uint32_t t = 0; t < plan->texture_count; ++t) {
        const uint16_t dim = plan->textures[t].dim;
        if (plan->textures[t].life != HBIL_LIFE_INPUT || dim == HBIL_DIM_CUBE || dim == HBIL_DIM_3D) continue;
        if ((uint32_t)inputs[t].width < room[0]) room[0] = (uint32_t)inputs[t].width;
        if ((uint32_t)inputs[t].height < room[1]) room[1] = (uint32_t)inputs[t].height;
    }
    if (plan->config.width != 0 || room[0] == UINT32_MAX) memcpy(room, frame, 2 * sizeof *room); /* baked, or no inputs */
}

/* Keep the first width x height pixels of every slice. In place: rows only move towards the start. */
static void crop(image *img, uint32_t width, uint32_t height)
{
    const size_t row = (size_t)width * (size_t)img->channels, stride = (size_t)img->width * (size_t)img->channels;
    if (img->data == NULL || (uint32_t)img->width < width || (uint32_t)img->height < height) return; /* a coarser grid's */
    if ((uint32_t)img->width == width && (uint32_t)img->height == height) return;
    for (size_t s = 0; s < (size_t)image_slices(img); ++s)
        for (size_t y = 0; y < height; ++y)
            memmove(img->data + (s * height + y) * row, img->data + (s * (size_t)img->height + y) * stride, row * sizeof *img->data);
    img->width = (int)width;
    img->height = (int)height;
}

int runner_run(runner *r, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
               image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    uint32_t size[2], room[2];
    memset(outputs, 0, HBIL_MAX_TEXTURES * sizeof *outputs);
    if (repeat < 1) {
        snprintf(error, error_size, "repeat is %d: at least 1", repeat);
        return 0;
    }
    if (!check_inputs(plan, frame, inputs, error, error_size)) return 0;
    size[0] = frame->width != 0 ? frame->width : (uint32_t)plan->config.width;
    size[1] = frame->height != 0 ? frame->height : (uint32_t)plan->config.height;
    room_of(plan, inputs, size, room);
    if (r->ops->run(r->device, plan, frame, room, inputs, outputs, repeat, ms, error, error_size)) {
        for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) crop(&outputs[t], size[0], size[1]);
        return 1;
    }
    for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&outputs[t]);
    return 0;
}
