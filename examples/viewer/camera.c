/* camera.c - see camera.h. */
#include "camera.h"

#include <math.h>
#include <string.h>

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

void matrix_multiply(const float a[16], const float b[16], float out[16])
{
    int c, r, k;

    for (c = 0; c < 4; c++)
        for (r = 0; r < 4; r++) {
            out[4 * c + r] = 0.0f;
            for (k = 0; k < 4; k++) out[4 * c + r] += a[4 * k + r] * b[4 * c + k];
        }
}

void camera_start(camera *c, const model *m, float turn)
{
    const float x = m->eye[0] - m->pivot[0], y = m->eye[1] - m->pivot[1], z = m->eye[2] - m->pivot[2];

    c->eye[0] = m->pivot[0] + cosf(turn) * x - sinf(turn) * y;
    c->eye[1] = m->pivot[1] + sinf(turn) * x + cosf(turn) * y;
    c->eye[2] = m->eye[2];
    c->yaw = atan2f(x, -y) + turn;
    c->pitch = atan2f(-z, sqrtf(x * x + y * y));
    c->half_fov = m->half_fov;
    c->near_z = m->near_z;
    c->far_z = m->far_z;
}

/* Unit axes of view space in the world. */
static void axes(const camera *c, float right[3], float up[3], float back[3])
{
    const float cy = cosf(c->yaw), sy = sinf(c->yaw), cp = cosf(c->pitch), sp = sinf(c->pitch);

    right[0] = cy, right[1] = sy, right[2] = 0.0f;
    up[0] = sy * sp, up[1] = -cy * sp, up[2] = cp;
    back[0] = sy * cp, back[1] = -cy * cp, back[2] = -sp;
}

void camera_move(camera *c, const float move[3])
{
    float right[3], up[3], back[3];
    int   i;

    axes(c, right, up, back);
    for (i = 0; i < 3; i++) c->eye[i] += right[i] * move[0] - back[i] * move[1];
    c->eye[2] += move[2];
}

/* World to the space of three axes and an origin. */
static void look(const float right[3], const float up[3], const float back[3], const float origin[3], float out[16])
{
    const float *rows[3] = {right, up, back};
    int          r, k;

    memset(out, 0, 16 * sizeof *out);
    for (r = 0; r < 3; r++) {
        for (k = 0; k < 3; k++) out[4 * k + r] = rows[r][k];
        out[12 + r] = -dot(rows[r], origin);
    }
    out[15] = 1.0f;
}

void camera_view(const camera *c, float view[16])
{
    float right[3], up[3], back[3];

    axes(c, right, up, back);
    look(right, up, back, c->eye, view);
}

void camera_projection(const camera *c, int width, int height, int gl, float projection[16])
{
    const float scale = 1.0f / tanf(c->half_fov), range = c->far_z - c->near_z;

    memset(projection, 0, 16 * sizeof *projection);
    projection[0] = scale * (float)height / (float)width;
    projection[5] = -scale;
    projection[10] = gl ? -(c->far_z + c->near_z) / range : -c->far_z / range;
    projection[11] = -1.0f;
    projection[14] = (gl ? -2.0f : -1.0f) * c->far_z * c->near_z / range;
}

/* The sun's parallel rays through a ball of the model's radius around its pivot; what casts shadows into it may
 * stand farther off. */
static void sun_matrices(const model *m, int gl, float clip[16], float texture[16])
{
    static const float reach = 4.0f; /* radii towards the sun and away from it */
    const float depth = reach * m->radius;
    float       right[3], up[3], view[16], project[16], to_texture[16];
    const float flat = sqrtf(m->sun[0] * m->sun[0] + m->sun[1] * m->sun[1]);

    right[0] = flat > 1e-3f ? -m->sun[1] / flat : 1.0f; /* right = up of the world x sun */
    right[1] = flat > 1e-3f ? m->sun[0] / flat : 0.0f;
    right[2] = 0.0f;
    up[0] = m->sun[1] * right[2] - m->sun[2] * right[1];
    up[1] = m->sun[2] * right[0] - m->sun[0] * right[2];
    up[2] = m->sun[0] * right[1] - m->sun[1] * right[0];
    look(right, up, m->sun, m->pivot, view); /* z towards the sun: in [-depth, depth] */
    memset(project, 0, sizeof project);
    memset(to_texture, 0, sizeof to_texture);
    project[0] = project[5] = 1.0f / m->radius;
    project[10] = gl ? -1.0f / depth : -0.5f / depth;
    project[14] = gl ? 0.0f : 0.5f;
    project[15] = 1.0f;
    to_texture[0] = to_texture[5] = to_texture[12] = to_texture[13] = 0.5f;
    to_texture[10] = gl ? 0.5f : 1.0f;
    to_texture[14] = gl ? 0.5f : 0.0f;
    to_texture[15] = 1.0f;
    matrix_multiply(project, view, clip);
    matrix_multiply(to_texture, clip, texture);
}

void camera_uniforms(const camera *c, const model *m, int gl, const float view[16], const float projection[16],
                     gpu_uniforms *out)
{
    float right[3], up[3], back[3];
    int   i;

    axes(c, right, up, back);
    matrix_multiply(projection, view, out->clip);
    sun_matrices(m, gl, out->sun_clip, out->sun_texture);
    for (i = 0; i < 3; i++) {
        out->ray[0][i] = right[i] / projection[0];
        out->ray[1][i] = up[i] / projection[5];
        out->ray[2][i] = -back[i];
        out->eye[i] = c->eye[i];
        out->sun[i] = m->sun[i];
        out->sun_light[i] = m->sun_light[i];
        out->sky[0][i] = 0.5f * (m->sky_zenith[i] + m->sky_ground[i]);
        out->sky[1][i] = 0.5f * (m->sky_zenith[i] - m->sky_ground[i]);
    }
    out->sun[3] = 2.0f * m->radius / SHADOW_SIZE;
}
