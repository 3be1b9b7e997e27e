/* camera.h - where the picture is taken from, and the matrices that follow. World: z up; view space: x right, y
 * up, -z forward. */
#ifndef HBIL_VIEWER_CAMERA_H
#define HBIL_VIEWER_CAMERA_H

#include "model.h"

typedef struct camera {
    float eye[3];
    float yaw, pitch;       /* radians: to the left of +y, up */
    float half_fov, near_z, far_z;
} camera;

/* From the eye of the model to its pivot, turned about the pivot by `turn` radians to the left. */
void camera_start(camera *c, const model *m, float turn);
/* m along right, forward and up of the world. */
void camera_move(camera *c, const float move[3]);
/* World to view, column-major. */
void camera_view(const camera *c, float view[16]);
/* View to clip. gl: z in [-1, 1], else [0, 1]. y is turned over: row 0 of the images, ndc y = -1, is the top. */
void camera_projection(const camera *c, int width, int height, int gl, float projection[16]);

void matrix_multiply(const float a[16], const float b[16], float out[16]); /* out = a * b; out may be neither */

/* All that shaders/ read of camera, sun and sky but last_clip, exposure, split and mode. */
void camera_uniforms(const camera *c, const model *m, int gl, const float view[16], const float projection[16],
                     gpu_uniforms *out);

#endif
