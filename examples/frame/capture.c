/* capture.c - read a frame (EXR) and its camera (JSON), and check that they make sense. */
#include "capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "blender.h"
#include "json.h"

#define CAMERA_BYTES_MAX (1 << 20)
#define TOLERANCE 1e-4 /* of entries that must be 0 or 1: float files of other programs round at about 1e-6 */

void capture_free(capture *cap)
{
    image_free(&cap->depth);
    image_free(&cap->normal);
    image_free(&cap->albedo);
    image_free(&cap->direct);
    image_free(&cap->emission);
    image_free(&cap->truth_ao);
    image_free(&cap->truth_near);
    image_free(&cap->truth_far);
    image_free(&cap->truth_bounce);
    image_free(&cap->f0);
    image_free(&cap->roughness);
    image_free(&cap->motion);
    image_free(&cap->hf_valid);
    image_free(&cap->hf_ao);
    image_free(&cap->hf_near);
    memset(cap, 0, sizeof *cap);
}

void capture_take_f0(const capture *cap, image *light)
{
    const size_t count = (size_t)light->width * (size_t)light->height;
    size_t       i;
    int          c;

    for (i = 0; cap->f0.data && light->data && i < count; i++)
        for (c = 0; c < 3; c++)
            light->data[3 * i + (size_t)c] *= 1.0f - cap->f0.data[cap->f0.channels == 3 ? 3 * i + (size_t)c : i];
}

/* The camera file as it is written, before it is checked. Matrices are [row][column]. */
typedef struct camera {
    double width, height, near_z, far_z;
    double projection[4][4], view[4][4];
} camera;

static int get_matrix(const cJSON *root, const char *name, double out[4][4], const char *path, char *error, size_t error_size)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, name);
    int r, c;

    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 4)
        return frame_error(error, error_size, "%s: \"%s\" is %s. It must be an array of 4 rows", path, name,
                           item ? "not one" : "missing");
    for (r = 0; r < 4; r++) {
        const cJSON *row = cJSON_GetArrayItem(item, r);

        if (!cJSON_IsArray(row) || cJSON_GetArraySize(row) != 4)
            return frame_error(error, error_size, "%s: row %d of \"%s\" must be an array of 4 numbers", path, r, name);
        for (c = 0; c < 4; c++) {
            const cJSON *number = cJSON_GetArrayItem(row, c);

            if (!cJSON_IsNumber(number) || !isfinite(number->valuedouble))
                return frame_error(error, error_size, "%s: row %d, column %d of \"%s\" must be a finite number", path, r, c, name);
            out[r][c] = number->valuedouble;
        }
    }
    return 1;
}

static int read_camera(const char *path, camera *cam, char *error, size_t error_size)
{
    cJSON *root = json_read(path, CAMERA_BYTES_MAX, "the camera's JSON", error, error_size);
    int    ok;

    ok = root && json_number(root, "width", &cam->width, path, error, error_size)
              && json_number(root, "height", &cam->height, path, error, error_size)
              && json_number(root, "near", &cam->near_z, path, error, error_size)
              && json_number(root, "far", &cam->far_z, path, error, error_size)
              && get_matrix(root, "projection_rows", cam->projection, path, error, error_size)
              && get_matrix(root, "view_rows", cam->view, path, error, error_size);
    cJSON_Delete(root);
    return ok;
}

static int is_row(const double row[4], double x, double y, double z, double w)
{
    return fabs(row[0] - x) < TOLERANCE && fabs(row[1] - y) < TOLERANCE && fabs(row[2] - z) < TOLERANCE
    && fabs(row[3] - w) < TOLERANCE;
}

/* GL clip: perspective  [x 0 ox 0] [0 y oy 0] [0 0 a b] [0 0 -1 0], a = -(f+n)/(f-n), b = -2fn/(f-n)
 *          orthographic [x 0 0 ox] [0 y 0 oy] [0 0 a b] [0 0  0 1], a = -2/(f-n),     b = -(f+n)/(f-n) */
static int check_projection(const camera *cam, int *orthographic, const char *path, char *error, size_t error_size)
{
    const double (*m)[4] = cam->projection;
    const double  n = cam->near_z, f = cam->far_z, a = m[2][2], b = m[2][3];
    double want_a, want_b;
    int    shape;

    *orthographic = is_row(m[3], 0, 0, 0, 1);
    if (!*orthographic && !is_row(m[3], 0, 0, -1, 0))
        return frame_error(error, error_size,
                           "%s: \"projection_rows\" is neither perspective (last row 0 0 -1 0) nor orthographic (0 0 0 1). "
                           "Write a right-handed OpenGL matrix, row by row", path);
    shape = is_row(m[0], m[0][0], 0, *orthographic ? 0 : m[0][2], *orthographic ? m[0][3] : 0)
         && is_row(m[1], 0, m[1][1], *orthographic ? 0 : m[1][2], *orthographic ? m[1][3] : 0) && is_row(m[2], 0, 0, a, b);
    if (!shape || m[0][0] <= 0.0 || m[1][1] <= 0.0)
        return frame_error(error, error_size, "%s: \"projection_rows\" has a shear, a mirror or a zero scale. "
                           "Write an OpenGL matrix with positive x and y scale", path);
    if (!(n < f) || (!*orthographic && !(n > 0.0)))
        return frame_error(error, error_size, "%s: \"near\" %g and \"far\" %g must be %snear < far, in metres", path, n, f,
                           *orthographic ? "" : "0 < ");
    want_a = *orthographic ? -2.0 / (f - n) : -(f + n) / (f - n);
    want_b = *orthographic ? -(f + n) / (f - n) : -2.0 * f * n / (f - n);
    if (fabs(a - want_a) > TOLERANCE * fabs(want_a) || fabs(b - want_b) > TOLERANCE * (fabs(want_b) + fabs(want_a)))
        return frame_error(error, error_size,
                           "%s: third row of \"projection_rows\" does not map \"near\" %g and \"far\" %g to -1 and 1. "
                           "Write the OpenGL matrix of that range", path, n, f);
    return 1;
}

/* Rotation and translation only: rows of unit length, at right angles, not mirrored. */
static int check_view(const camera *cam, const char *path, char *error, size_t error_size)
{
    const double (*m)[4] = cam->view;
    double det;
    int    i, j, rigid = is_row(m[3], 0, 0, 0, 1);

    for (i = 0; i < 3; i++) {
        for (j = i; j < 3; j++) {
            double dot = m[i][0] * m[j][0] + m[i][1] * m[j][1] + m[i][2] * m[j][2];
            if (!(fabs(dot - (i == j)) < TOLERANCE)) rigid = 0;
        }
    }
    det = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    if (!rigid || det < 0.0)
        return frame_error(error, error_size,
                           "%s: \"view_rows\" is not rigid. Write world to view without scale, shear or mirror, row by row", path);
    return 1;
}

static void take_camera(capture *out, const camera *cam)
{
    int r, c;

    out->near_z = (float)cam->near_z;
    out->far_z = (float)cam->far_z;
    for (c = 0; c < 4; c++) {
        for (r = 0; r < 4; r++) {
            /* y up on the screen becomes y down in memory: the top row of the file is texel row 0, ndc y = -1 */
            out->projection[c * 4 + r] = (float)(r == 1 ? -cam->projection[r][c] : cam->projection[r][c]);
            out->view[c * 4 + r] = (float)cam->view[r][c];
        }
    }
}

static int read_layers(capture *out, const char *path, char *error, size_t error_size)
{
    const struct { const char *layer, *channels; image *target; int required; } rows[] = {
        {"depth", "Z", &out->depth, 1},           {"normal", "XYZ", &out->normal, 1},
        {"albedo", "RGB", &out->albedo, 1},       {"direct", "RGB", &out->direct, 1},
        {"emission", "RGB", &out->emission, 0},   {"roughness", "Y", &out->roughness, 0},
        {"f0", "RGB", &out->f0, 0},               {"f0", "Y", &out->f0, 0},
        {"truth_ao", "Y", &out->truth_ao, 0},     {"truth_near", "RGB", &out->truth_near, 0},
        {"truth_far", "RGB", &out->truth_far, 0}, {"truth_bounce", "RGB", &out->truth_bounce, 0},
        {"motion", "XY", &out->motion, 0},
    };
    enum { ROWS = sizeof rows / sizeof *rows };
    image_layer layers[ROWS];
    int         i;

    for (i = 0; i < ROWS; i++) {
        layers[i].layer = rows[i].layer;
        layers[i].channels = rows[i].channels;
        layers[i].required = rows[i].required;
    }
    if (!exr_read(path, layers, ROWS, error, error_size)) return 0;
    for (i = 0; i < ROWS; i++) {
        if (rows[i].target->data) image_free(&layers[i].pixels); /* f0.Y beside f0.RGB */
        else *rows[i].target = layers[i].pixels;
    }
    return 1;
}

static int read_frame(capture *out, const char *path, char *error, size_t error_size)
{
    const int blender = blender_read(out, path, error, error_size);

    if (blender == BLENDER_FAULT || (blender == BLENDER_NOT && !read_layers(out, path, error, error_size))) return 0;
    out->width = out->depth.width;
    out->height = out->depth.height;
    return 1;
}

/* hf-NNN.exr beside frame-NNN.exr: the height-field truth, if there is such a file. */
static int read_height_field(capture *out, const char *frame, char *error, size_t error_size)
{
    image_layer layers[] = {{"hf_valid", "Y", {0, 0, 0, NULL}, 1}, {"hf_ao", "Y", {0, 0, 0, NULL}, 1},
                            {"hf_near", "RGB", {0, 0, 0, NULL}, 1}};
    const char *slash = strrchr(frame, '/'), *name = slash ? slash + 1 : frame;
    const int   folder = (int)(name - frame);
    char        path[4096];

    if (strncmp(name, "frame-", 6) != 0) return 1;
    if (snprintf(path, sizeof path, "%.*shf-%s", folder, frame, name + 6) >= (int)sizeof path) return 1;
    if (access(path, F_OK) != 0) return 1;
    if (!exr_read(path, layers, 3, error, error_size)) return 0;
    out->hf_valid = layers[0].pixels;
    out->hf_ao = layers[1].pixels;
    out->hf_near = layers[2].pixels;
    if (out->hf_ao.width == out->width && out->hf_ao.height == out->height) return 1;
    return frame_error(error, error_size, "%s: size %dx%d, the frame beside it is %dx%d. Remove it, or make it for that frame",
                       path, out->hf_ao.width, out->hf_ao.height, out->width, out->height);
}

int capture_load(capture *out, const char *exr, const char *camera_json, char *error, size_t error_size)
{
    camera cam;

    memset(out, 0, sizeof *out);
    if (!read_camera(camera_json, &cam, error, error_size)
        || !check_projection(&cam, &out->orthographic, camera_json, error, error_size)
        || !check_view(&cam, camera_json, error, error_size)) return 0;
    take_camera(out, &cam);
    if (!read_frame(out, exr, error, error_size) || !read_height_field(out, exr, error, error_size)) {
        capture_free(out);
        return 0;
    }
    if (cam.width != (double)out->width || cam.height != (double)out->height) {
        frame_error(error, error_size, "%s: camera is for %gx%g, the frame %s is %dx%d. Give the camera of this frame", camera_json,
                    cam.width, cam.height, exr, out->width, out->height);
        capture_free(out);
        out->misfit = 1;
        return 0;
    }
    return 1;
}
