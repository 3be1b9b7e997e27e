/* brute_force.h - the reference, from the definition: cosine-distributed rays followed through the depth buffer as a height field.
 * Double precision, no slices, no horizons: it shares no formula with the shaders that it judges.
 *
 * Space: x right, y up, the camera looks down -z (the space of a capture). Rows run as in the images.
 *
 * Surface: h = 1/depth (perspective) or -depth (orthographic) is bilinear between pixel centres, so that planes are exact. It is
 * infinitely thick: a ray that once lies behind it is blocked. A cell with a corner in the sky has no surface. The surface ends at
 * the outermost pixel centres: beyond them, as in the sky, nothing was seen.
 * Receiver: pixel centres, pulled towards the camera by 1e-5 of their depth. */
#ifndef HBIL_TESTS_BRUTE_FORCE_H
#define HBIL_TESTS_BRUTE_FORCE_H

/* Pixel to view: xy at depth 1 (perspective) or at any depth, in m (orthographic) = pixel * ray[0..1] + ray[2..3], centres at .5 */
typedef struct bf_camera {
    int    width, height;
    int    orthographic;
    double ray[4];
} bf_camera;

/* Radiance that comes in from a unit direction of view space. data: bf_scene.sky_data. Called from two threads. */
typedef void bf_sky(const void *data, const double direction[3], double rgb[3]);

typedef struct bf_scene {
    bf_camera    camera;
    const float *depth;     /* m, along the view axis */
    double       sky_depth; /* m, from which on a pixel is sky */
    const float *normal;    /* 3 floats a pixel: unit shading normals */
    const float *radiance;  /* 3 floats a pixel, or NULL: near stays 0 */
    bf_sky      *sky;       /* what a ray that nothing blocks arrives at, or NULL: far stays 0 */
    const void  *sky_data;
} bf_scene;

/* Every stride-th pixel of every stride-th row, from (first, first) on. */
typedef struct bf_grid {
    int first, stride;
    int columns, rows;
} bf_grid;

typedef struct bf_pixel {
    double sky;                 /* 1: no surface here, the rest is 0 */
    double ao, ao_se;           /* visible share, standard error */
    double near[3], near_se[3]; /* E/pi */
    double far[3], far_se[3];   /* E/pi */
    double bent[3];             /* mean open direction, length 2/3 where all is open */
} bf_pixel;

/* Camera of a column-major projection from the space above to clip, whose texel row 0 is ndc y = -1. */
bf_camera bf_camera_from(const float projection[16], int width, int height);
/* View-space point at a pixel position and depth. */
void      bf_point(const bf_camera *camera, double px, double py, double depth, double out[3]);
bf_grid   bf_grid_of(int width, int height, int first, int stride);
/* out has columns * rows entries. rays: per pixel, a multiple of 8. Two threads; the same arguments give the same bits.
 * 1 on success, 0 when out of memory. */
int       bf_run(const bf_scene *scene, bf_grid grid, int rays, bf_pixel *out);

#endif
