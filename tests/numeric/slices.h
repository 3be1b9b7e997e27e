/* slices.h - the march in double precision, by the slices, horizons and increments of kernel.h, for perspective cameras.
 *
 * Two ways to look at the depth buffer link the rays and the shader: on the surface of the brute force, between the pixel centres
 * too, it has to give what the rays give; at the pixel centres that the shader looks at, it has to give what the shader gives. What
 * is then left between the rays and the shader is that choice of samples. */
#ifndef HBIL_TESTS_SLICES_H
#define HBIL_TESTS_SLICES_H

#include "brute_force.h"

#define SLICES_FACING 0.001 /* normals are turned until n.V is no smaller: the constant of hbil_receive in march.glsl */

/* ao and near of a pixel with a surface. turn: rotation of the slices, [0, 1). steps: samples a side as the shader takes them (power
 * spacing, exponent 2, jitter 0.5, whole screen), or 0: the surface of the brute force. */
void slices_run(const bf_scene *scene, int x, int y, int slices, int steps, double turn, bf_pixel *out);

#endif
