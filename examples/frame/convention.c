/* convention.c - a capture in the depth, clip and normal conventions of a config, as an engine would hand it over. */
#include "capture.h"

#include <math.h>
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
static void to_world(const float m[16], const float n[3], float out[3])
{
    int c;

    for (c = 0; c < 3; c++) out[c] = m[4 * c] * n[0] + m[4 * c + 1] * n[1] + m[4 * c + 2] * n[2];
}

/* Octahedral map of a unit vector, +z in the middle, in [-1, 1] (Meyer 2010). The zero vector of a sky pixel is the middle. */
static void fold(const float n[3], float out[2])
{
    const float l1 = fmaxf(fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]), 1e-20f), x = n[0] / l1, y = n[1] / l1;

    out[0] = n[2] < 0.0f ? (1.0f - fabsf(y)) * (x < 0.0f ? -1.0f : 1.0f) : x;
    out[1] = n[2] < 0.0f ? (1.0f - fabsf(x)) * (y < 0.0f ? -1.0f : 1.0f) : y;
}

/* 12 bits each of an octahedral map in three 8-bit channels: low bytes of x and y, then the high bits of x below those of y. */
static void pack_888(const float o[2], float out[3])
{
    const unsigned x = (unsigned)(fminf(fmaxf(o[0] * 0.5f + 0.5f, 0.0f), 1.0f) * 4095.0f + 0.5f);
    const unsigned y = (unsigned)(fminf(fmaxf(o[1] * 0.5f + 0.5f, 0.0f), 1.0f) * 4095.0f + 0.5f);

    out[0] = (float)(x & 255u) / 255.0f;
    out[1] = (float)(y & 255u) / 255.0f;
    out[2] = (float)(x >> 8 | y >> 8 << 4) / 255.0f;
}

/* Channels that an encoding has. */
static int normal_channels(int encoding)
{
    return encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL || encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM
        || encoding == HBIL_NORMAL_ENCODING_XY || encoding == HBIL_NORMAL_ENCODING_XY_UNORM ? 2 : 3;
}

static void encode_normal(const float n[3], int encoding, float *out)
{
    const int unorm = encoding == HBIL_NORMAL_ENCODING_XYZ_UNORM || encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM
                   || encoding == HBIL_NORMAL_ENCODING_XY_UNORM;
    const int channels = normal_channels(encoding);
    float     o[2];
    int       c;

    fold(n, o);
    if (encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_888) {
        pack_888(o, out);
    } else {
        const int octahedral = encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL || encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM;
        for (c = 0; c < channels; c++) out[c] = (octahedral ? o[c] : n[c]) * (unorm ? 0.5f : 1.0f) + (unorm ? 0.5f : 0.0f);
    }
}

static void encode_normals(const capture *cap, const hbil_config *config, image *out)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    float        n[3];
    size_t       i;

    for (i = 0; i < count; i++) {
        memcpy(n, cap->normal.data + 3 * i, sizeof n);
        if (config->normals == HBIL_NORMALS_WORLD) to_world(cap->view, cap->normal.data + 3 * i, n);
        encode_normal(n, config->normal_encoding, out->data + (size_t)out->channels * i);
    }
}

/* Reflectance as the config reads it: of rgb one number by luminance (Rec. 709), of one number the same three times. */
static void encode_f0(const image *source, image *out)
{
    const size_t count = (size_t)source->width * (size_t)source->height;
    size_t       i;

    for (i = 0; i < count; i++) {
        const float *from = source->data + (size_t)source->channels * i;
        float       *to = out->data + (size_t)out->channels * i;

        if (out->channels == source->channels) memcpy(to, from, (size_t)out->channels * sizeof *to);
        else if (out->channels == 1) to[0] = 0.2126f * from[0] + 0.7152f * from[1] + 0.0722f * from[2];
        else to[0] = to[1] = to[2] = from[0];
    }
}

static void add_emission(const capture *cap, image *out)
{
    const size_t count = 3 * (size_t)cap->width * (size_t)cap->height;
    size_t       i;

    for (i = 0; i < count; i++) out->data[i] += cap->emission.data[i];
}

/* The capture's image for an input of the plan, by the input's name; NULL: no capture has such a thing. */
static const image *source_of(const capture *cap, const char *name)
{
    if (strcmp(name, "depth") == 0) return &cap->depth;
    if (strcmp(name, "normal") == 0) return &cap->normal;
    if (strcmp(name, "albedo") == 0) return &cap->albedo;
    if (strcmp(name, "radiance") == 0 || strcmp(name, "direct") == 0) return &cap->direct;
    if (strcmp(name, "f0") == 0) return &cap->f0;
    if (strcmp(name, "roughness") == 0) return &cap->roughness;
    if (strcmp(name, "motion") == 0) return &cap->motion;
    return NULL;
}

static int missing_input(const capture *cap, const char *name, char *error, size_t error_size)
{
    if (source_of(cap, name) == &cap->f0)
        return frame_error(error, error_size, "the config needs the input f0, which the frame does not have. Write f0.Y or f0.RGB "
                           "into it, or set f0=none");
    if (source_of(cap, name) == &cap->roughness)
        return frame_error(error, error_size, "the config needs the input roughness, which the frame does not have. Write "
                           "roughness.Y into it, or set one for every surface, as in roughness=0.4");
    return frame_error(error, error_size, "the config needs the input %s, which no capture has. Change the option that asks "
                       "for it", name);
}

static int encode_input(const capture *cap, const hbil_config *config, depth_row row, const char *name, image *out, char *error,
                        size_t error_size)
{
    const image *source = source_of(cap, name);
    int          channels;

    if (!source || (!source->data && source != &cap->motion)) return missing_input(cap, name, error, error_size);
    channels = source == &cap->motion ? 2 : source == &cap->normal ? normal_channels(config->normal_encoding)
             : source == &cap->f0 ? (config->f0 == HBIL_F0_RGB ? 3 : 1) : source->channels;
    if (!image_make(out, cap->width, cap->height, channels))
        return frame_error(error, error_size, "out of memory for the input %s of %dx%d. Use a smaller frame", name, cap->width,
                           cap->height);
    if (source == &cap->normal) encode_normals(cap, config, out);
    else if (source == &cap->f0) encode_f0(source, out);
    else if (source == &cap->depth && config->depth == HBIL_DEPTH_DEVICE) encode_depth(cap, config, row, out);
    else if (source->data) memcpy(out->data, source->data, (size_t)cap->width * (size_t)cap->height * (size_t)channels * sizeof(float));
    if (cap->emissive && strcmp(name, "radiance") == 0) {
        if (!cap->emission.data)
            return frame_error(error, error_size, "--emissive, but the frame has no emission.RGB. Write it, or leave --emissive "
                               "out");
        add_emission(cap, out);
    }
    return 1;
}

static int encode_inputs(const capture *cap, const hbil_plan *plan, depth_row row, image *inputs, char *error, size_t error_size)
{
    uint32_t i;

    for (i = 0; i < plan->texture_count; i++) {
        const char *name = plan->textures[i].name;

        if (plan->textures[i].life != HBIL_LIFE_INPUT || strcmp(name, "sky") == 0 || strcmp(name, "probes") == 0) continue;
        if (!encode_input(cap, &plan->config, row, name, &inputs[i], error, error_size)) return 0;
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
    frame->reset = 1;
    if (encode_inputs(cap, plan, row, inputs, error, error_size)) return 1;
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&inputs[i]);
    return 0;
}

void capture_follow(hbil_frame *frame, const capture *last)
{
    memcpy(frame->last_projection, last->projection, sizeof frame->last_projection);
    memcpy(frame->last_view, last->view, sizeof frame->last_view);
    frame->last_width = (uint32_t)last->width;
    frame->last_height = (uint32_t)last->height;
    frame->reset = 0;
}

/* Where last frame's camera saw a point of the world; pixels. */
static void see(const capture *last, const double world[3], double pixel[2])
{
    const float *p = last->projection, *v = last->view;
    double       at[3], w;
    int          i;

    for (i = 0; i < 3; i++)
        at[i] = (double)v[i] * world[0] + (double)v[4 + i] * world[1] + (double)v[8 + i] * world[2] + (double)v[12 + i];
    w = (double)p[11] * at[2] + (double)p[15];
    pixel[0] = 0.5 * last->width * (((double)p[0] * at[0] + (double)p[8] * at[2] + (double)p[12]) / w + 1.0);
    pixel[1] = 0.5 * last->height * (((double)p[5] * at[1] + (double)p[9] * at[2] + (double)p[13]) / w + 1.0);
}

int capture_motion(capture *cap, const capture *last)
{
    const float *p = cap->projection, *v = cap->view;
    int          x, y, i;

    if (!image_make(&cap->motion, cap->width, cap->height, 2)) return 0;
    for (y = 0; y < cap->height; y++)
        for (x = 0; x < cap->width; x++) {
            const size_t k = (size_t)(y * cap->width + x);
            const double z = -(double)cap->depth.data[k], w = (double)p[11] * z + (double)p[15];
            const double ndc[2] = {2.0 * (x + 0.5) / cap->width - 1.0, 2.0 * (y + 0.5) / cap->height - 1.0};
            const double at[3] = {(ndc[0] * w - (double)p[8] * z - (double)p[12]) / (double)p[0],
                                  (ndc[1] * w - (double)p[9] * z - (double)p[13]) / (double)p[5], z};
            double       world[3], pixel[2];

            for (i = 0; i < 3; i++)
                world[i] = (double)v[4 * i] * (at[0] - (double)v[12]) + (double)v[4 * i + 1] * (at[1] - (double)v[13])
                         + (double)v[4 * i + 2] * (at[2] - (double)v[14]);
            see(last, world, pixel);
            cap->motion.data[2 * k] = (float)(pixel[0] - x - 0.5);
            cap->motion.data[2 * k + 1] = (float)(pixel[1] - y - 0.5);
        }
    return 1;
}
