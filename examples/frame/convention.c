/* convention.c - a capture in the depth, clip and normal conventions of a config, as an engine would hand it over. */
#include "capture.h"

#include <string.h>

#define SKY_FROM 1e9f /* m; linear depth from which on a capture's pixel is sky */

/* Third row of the projection matrix, a and b in clip z = a * view z + b, for view z = -depth; float, as in the matrix,
 * because the depth buffer of a renderer comes from that matrix, its rounding included. w is depth or, orthographic, 1. */
typedef struct depth_row { float a, b; } depth_row;

static depth_row make_depth_row(const capture *cap, const hbil_config *config)
{
    const double n = (double)cap->near_z, f = (double)cap->far_z;
    const int    reversed = config->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    double       a, b; /* for ndc z in [0, 1] */
    depth_row    row;

    if (cap->orthographic) {
        a = reversed ? 1.0 / (f - n) : -1.0 / (f - n);
        b = reversed ? f / (f - n) : -n / (f - n);
    } else if (config->depth_far == HBIL_DEPTH_FAR_INFINITE) {
        a = reversed ? 0.0 : -1.0;
        b = reversed ? n : -n;
    } else {
        a = reversed ? n / (f - n) : -f / (f - n);
        b = reversed ? f * n / (f - n) : -f * n / (f - n);
    }
    if (config->clip == HBIL_CLIP_GL) { /* ndc z in [-1, 1]: 2 * clip z - w, with w = -view z or 1 */
        a = cap->orthographic ? 2.0 * a : 2.0 * a + 1.0;
        b = cap->orthographic ? 2.0 * b - 1.0 : 2.0 * b;
    }
    row.a = (float)a;
    row.b = (float)b;
    return row;
}

/* Linear depth (m) to the depth buffer's value in [0, 1]; sky, and what lies beyond the far plane, is the clear value. */
static float device_depth(float linear, depth_row row, const capture *cap, const hbil_config *config)
{
    const double z = (double)linear;
    double       d;

    if (linear >= SKY_FROM) return config->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED ? 0.0f : 1.0f;
    d = ((double)row.b - (double)row.a * z) / (cap->orthographic ? 1.0 : z);
    if (config->clip == HBIL_CLIP_GL) d = 0.5 * d + 0.5; /* glDepthRange(0, 1) */
    return d < 0.0 ? 0.0f : d > 1.0 ? 1.0f : (float)d;   /* NaN stays NaN */
}

static void encode_depth(const capture *cap, const hbil_config *config, depth_row row, image *out)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    size_t       i;

    for (i = 0; i < count; i++)
        out->data[i] = device_depth(cap->depth.data[i], row, cap, config);
}

/* View to world: the transpose of the rotation in view, which is column-major. */
static void encode_normals(const capture *cap, image *out)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    const float *m = cap->view;
    size_t       i;
    int          c;

    for (i = 0; i < count; i++) {
        const float *n = cap->normal.data + 3 * i;
        for (c = 0; c < 3; c++) out->data[3 * i + (size_t)c] = m[4 * c] * n[0] + m[4 * c + 1] * n[1] + m[4 * c + 2] * n[2];
    }
}

/* The capture's image for an input of the plan, by the input's name; NULL: there is none. */
static const image *source_of(const capture *cap, const char *name)
{
    if (strcmp(name, "depth") == 0) return &cap->depth;
    if (strcmp(name, "normal") == 0) return &cap->normal;
    if (strcmp(name, "albedo") == 0) return &cap->albedo;
    if (strcmp(name, "radiance") == 0 || strcmp(name, "direct") == 0) return &cap->direct;
    return NULL;
}

static int encode_inputs(const capture *cap, const hbil_plan *plan, depth_row row, image *inputs, char *error, size_t error_size)
{
    uint32_t i;

    for (i = 0; i < plan->texture_count; i++) {
        const char  *name = plan->textures[i].name;
        const image *source = source_of(cap, name);

        if (plan->textures[i].life != HBIL_LIFE_INPUT) continue;
        if (!source || !source->data)
            return frame_error(error, error_size,
                               "the config needs the input %s, which no capture has. Change the option that asks for it", name);
        if (!image_make(&inputs[i], cap->width, cap->height, source->channels))
            return frame_error(error, error_size, "out of memory for the input %s of %dx%d. Use a smaller frame", name,
                               cap->width, cap->height);
        memcpy(inputs[i].data, source->data, (size_t)cap->width * (size_t)cap->height * (size_t)source->channels * sizeof(float));
        if (source == &cap->depth && plan->config.depth == HBIL_DEPTH_DEVICE) encode_depth(cap, &plan->config, row, &inputs[i]);
        if (source == &cap->normal && plan->config.normals == HBIL_NORMALS_WORLD) encode_normals(cap, &inputs[i]);
    }
    return 1;
}

static int check_fit(const capture *cap, const hbil_config *config, char *error, size_t error_size)
{
    const int orthographic = config->projection == HBIL_PROJECTION_ORTHOGRAPHIC;

    if (orthographic != cap->orthographic)
        return frame_error(error, error_size, "option projection: %s, but the frame's camera is %s. Set projection=%s",
                           orthographic ? "orthographic" : "perspective", cap->orthographic ? "orthographic" : "perspective",
                           cap->orthographic ? "orthographic" : "perspective");
    if (config->width != 0 && (config->width != cap->width || config->height != cap->height))
        return frame_error(error, error_size,
                           "options width, height: %dx%d baked, but the frame is %dx%d. Set width=%d height=%d, or 0 for any size",
                           (int)config->width, (int)config->height, cap->width, cap->height, cap->width, cap->height);
    return 1;
}

int capture_encode(const capture *cap, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES],
                   char *error, size_t error_size)
{
    const depth_row row = make_depth_row(cap, &plan->config);
    uint32_t        i;

    memset(frame, 0, sizeof *frame);
    memset(inputs, 0, HBIL_MAX_TEXTURES * sizeof *inputs);
    if (!check_fit(cap, &plan->config, error, error_size)) return 0;
    frame->width = (uint32_t)cap->width;
    frame->height = (uint32_t)cap->height;
    memcpy(frame->projection, cap->projection, sizeof frame->projection);
    memcpy(frame->view, cap->view, sizeof frame->view);
    frame->projection[10] = row.a;
    frame->projection[14] = row.b;
    if (encode_inputs(cap, plan, row, inputs, error, error_size)) return 1;
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
    return 0;
}
