/* output.c - what is written of each output of a plan: layers of an EXR, and pictures that a person can read. */
#include "output.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "metric.h"

#define PATH_BYTES 4096

const output_kind output_kinds[OUTPUT_KINDS] = {
    {"ao", "Y", 1},   {"uniform_ao", "Y", 1}, {"bent", "XYZ", 0},       {"cone", "XYZA", 0},        {"near", "RGB", 1},
    {"sh", "RGBA", 0}, {"far", "RGB", 1},     {"irradiance", "RGB", 1}, {"specular_occlusion", "Y", 1},
    {"multi_bounce", "RGB", 1}, {"composite", "RGB", 1},
};

static size_t texel_count(const image *img)
{
    return (size_t)img->width * (size_t)img->height * (size_t)image_slices(img);
}

int output_take(image *out, int kind, const image *texture)
{
    const size_t from = (size_t)texture->channels, to = strlen(output_kinds[kind].channels), count = texel_count(texture);
    size_t       i, c;

    if (!image_make_slices(out, texture->width, texture->height, image_slices(texture), (int)to)) return 0;
    for (i = 0; i < count; i++)
        for (c = 0; c < to; c++) out->data[i * to + c] = texture->data[i * from + c];
    return 1;
}

/* One slice as an image that shares the memory. */
static image slice_of(const image *img, int slice)
{
    image out = *img;

    out.depth = 1;
    out.data += (size_t)slice * (size_t)img->width * (size_t)img->height * (size_t)img->channels;
    return out;
}

int output_layers(const image outputs[OUTPUT_KINDS], image_layer layers[OUTPUT_LAYERS_MAX])
{
    static const char *const sh[4] = {"sh0", "sh1", "sh2", "sh3"};
    int k, slice, count = 0;

    for (k = 0; k < OUTPUT_KINDS; k++) {
        for (slice = 0; outputs[k].data && slice < (k == OUTPUT_SH ? 4 : 1); slice++, count++) {
            layers[count].layer = k == OUTPUT_SH ? sh[slice] : output_kinds[k].name;
            layers[count].channels = output_kinds[k].channels;
            layers[count].pixels = slice_of(&outputs[k], slice);
            layers[count].required = 0;
        }
    }
    return count;
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static int compare_floats(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;

    return (x > y) - (x < y);
}

/* The factor that takes the 95th percentile of the brightest channel to 0.8; lamps and sky do not count. 1 for a black frame. */
static float find_exposure(const capture *cap)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    float       *values = malloc(count * sizeof *values), level = 0.0f;
    size_t       i, used = 0;

    for (i = 0; values && i < count; i++) {
        const float *d = cap->direct.data + 3 * i;
        const float  v = fmaxf(d[0], fmaxf(d[1], d[2]));
        if (metric_counts(cap, i) && isfinite(v)) values[used++] = v;
    }
    if (used > 0) {
        qsort(values, used, sizeof *values, compare_floats);
        level = values[used * 95 / 100];
    }
    free(values);
    return level > 0.0f ? 0.8f / level : 1.0f;
}

/* What is seen besides reflected light: emission, and the environment behind all, where the frame itself has no sky. */
static int make_glow(const capture *cap, const environment *env, image *glow)
{
    const environment_view view = {env, cap->view};
    const float           *p = cap->projection;
    int                    x, y, c;

    if (!image_make(glow, cap->width, cap->height, 3)) return 0;
    if (cap->emission.data) memcpy(glow->data, cap->emission.data, 3 * texel_count(glow) * sizeof *glow->data);
    for (y = 0; env->kind && y < cap->height; y++) {
        for (x = 0; x < cap->width; x++) {
            const int    i = y * cap->width + x, at_eye = !cap->orthographic; /* rays meet there */
            const float *direct = cap->direct.data + 3 * i;
            const double direction[3] = {at_eye * ((2.0 * x + 1.0) / cap->width - 1.0) / (double)p[0],
                                         at_eye * ((2.0 * y + 1.0) / cap->height - 1.0) / (double)p[5], -1.0};
            double       sky[3];

            if (cap->depth.data[i] < 1e9f || direct[0] > 0.0f || direct[1] > 0.0f || direct[2] > 0.0f) continue;
            environment_view_radiance(&view, direction, sky);
            for (c = 0; c < 3; c++) glow->data[3 * i + c] += (float)sky[c];
        }
    }
    return 1;
}

/* Light, exposed, and rolled off above 0.8 so that highlights keep their shape instead of turning into flat white. glow is added
 * first; it may be absent. */
static void show_light(image *out, const image *light, const image *glow, float exposure)
{
    const size_t count = 3 * texel_count(out);
    size_t       i;

    for (i = 0; i < count; i++) {
        const float v = (light->data[i] + (glow->data ? glow->data[i] : 0.0f)) * exposure;
        out->data[i] = v > 0.8f ? 1.0f - 0.2f * expf((0.8f - v) / 0.2f) : v;
    }
}

/* Directions in view space as colours: right is red, up is green, towards the camera is blue; none is grey. */
static void show_directions(image *out, const image *vectors)
{
    const size_t count = texel_count(out);
    size_t       i;
    int          c;

    for (i = 0; i < count; i++) {
        const float *v = vectors->data + (size_t)vectors->channels * i;
        const float  length = sqrtf(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (c = 0; c < 3; c++) out->data[3 * i + (size_t)c] = 0.5f + (length > 0.0f ? 0.5f * v[c] / length : 0.0f);
    }
}

/* Half angle of the visible cone: black is closed, white 90 degrees. */
static void show_angles(image *out, const image *cone)
{
    const size_t count = texel_count(out);
    size_t       i;

    for (i = 0; i < count; i++) out->data[i] = acosf(fminf(fmaxf(cone->data[4 * i + 3], 0.0f), 1.0f)) / 1.57079633f;
}

/* What the coefficients say at the normal: rgb of near light E/pi, to compare with near; a of visibility, to compare with ao. */
static void show_sh(image *out, const image *sh, const capture *cap)
{
    const size_t count = texel_count(out), channels = (size_t)out->channels, stride = 4 * count;
    size_t       i, c;

    for (i = 0; i < count; i++) {
        const float *n = cap->normal.data + 3 * i;
        for (c = 0; c < channels; c++) {
            const float *k = sh->data + 4 * i + (channels == 1 ? 3 : c);
            const float  band1 = n[1] * k[stride] + n[2] * k[2 * stride] + n[0] * k[3 * stride];
            out->data[channels * i + c] = fmaxf(0.282095f * k[0] + 0.325735f * band1, 0.0f); /* bands times 1 and 2/3 */
        }
    }
}

/* Everything that pictures are made of. */
typedef struct album {
    const char    *folder;
    const capture *cap;
    image          glow;
    float          exposure;
    char          *error;
    size_t         error_size;
} album;

static int write_picture(const album *a, const char *name, const image *picture, int linear)
{
    char path[PATH_BYTES];

    if (snprintf(path, sizeof path, "%s/%s.png", a->folder, name) >= (int)sizeof path)
        return frame_error(a->error, a->error_size, "--png: path of more than %d bytes. Choose a shorter one", PATH_BYTES);
    return png_write(path, picture, linear, a->error, a->error_size);
}

static int no_memory(const album *a)
{
    return frame_error(a->error, a->error_size, "%s: out of memory for pictures", a->folder);
}

static int write_light(const album *a, const char *name, const image *light, const image *glow)
{
    image picture;
    int   ok;

    if (!image_make(&picture, a->cap->width, a->cap->height, 3)) return no_memory(a);
    show_light(&picture, light, glow, a->exposure);
    ok = write_picture(a, name, &picture, 1);
    image_free(&picture);
    return ok;
}

static int write_vectors(const album *a, const char *name, const image *vectors)
{
    image picture;
    int   ok;

    if (!image_make(&picture, a->cap->width, a->cap->height, 3)) return no_memory(a);
    show_directions(&picture, vectors);
    ok = write_picture(a, name, &picture, 0);
    image_free(&picture);
    return ok;
}

static int write_angles(const album *a, const image *cone)
{
    image picture;
    int   ok;

    if (!image_make(&picture, a->cap->width, a->cap->height, 1)) return no_memory(a);
    show_angles(&picture, cone);
    ok = write_picture(a, "cone_angle", &picture, 0);
    image_free(&picture);
    return ok;
}

static int write_sh(const album *a, const image *sh)
{
    static const image none = {0, 0, 0, NULL};
    image light, visible = {0, 0, 0, NULL};
    int   ok;

    if (!image_make(&light, a->cap->width, a->cap->height, 3) || !image_make(&visible, a->cap->width, a->cap->height, 1)) {
        image_free(&light);
        return no_memory(a);
    }
    show_sh(&light, sh, a->cap);
    show_sh(&visible, sh, a->cap);
    ok = write_light(a, "sh", &light, &none) && write_picture(a, "sh_visibility", &visible, 0);
    image_free(&light);
    image_free(&visible);
    return ok;
}

static int write_output(const album *a, int kind, const image *output)
{
    static const image none = {0, 0, 0, NULL};

    switch (kind) {
    case OUTPUT_BENT:      return write_vectors(a, "bent", output);
    case OUTPUT_CONE:      return write_vectors(a, "cone", output) && write_angles(a, output);
    case OUTPUT_SH:        return write_sh(a, output);
    case OUTPUT_COMPOSITE: return write_light(a, "after", output, &a->glow);
    case OUTPUT_NEAR:
    case OUTPUT_FAR:
    case OUTPUT_IRRADIANCE: return write_light(a, output_kinds[kind].name, output, &none);
    default:               return write_picture(a, output_kinds[kind].name, output, 0); /* a share: as it is */
    }
}

int output_pictures(const char *folder, const capture *cap, const environment *env, const image outputs[OUTPUT_KINDS],
                    char *error, size_t error_size)
{
    album a;
    int   k, ok;

    a.folder = folder;
    a.cap = cap;
    a.exposure = find_exposure(cap);
    a.error = error;
    a.error_size = error_size;
    if (mkdir(folder, 0777) != 0 && access(folder, W_OK) != 0)
        return frame_error(error, error_size, "%s: cannot be made. Choose a folder that can be written", folder);
    if (!make_glow(cap, env, &a.glow)) return no_memory(&a);
    ok = write_light(&a, "before", &cap->direct, &a.glow);
    for (k = 0; ok && k < OUTPUT_KINDS; k++)
        if (outputs[k].data) ok = write_output(&a, k, &outputs[k]);
    image_free(&a.glow);
    return ok;
}
