/* environment.h - the light behind what is visible, as --env names it: one colour, spherical harmonics, a cube map or probes. */
#ifndef HBIL_FRAME_ENVIRONMENT_H
#define HBIL_FRAME_ENVIRONMENT_H

#include "../../hbil.h"
#include "image.h"

#define ENVIRONMENT_CUBE_SIZE 16 /* texels a side of a cube map that is blurred into E/pi */

/* Zeroed: absent. World space is that of the frame's view matrix. */
typedef struct environment {
    int   kind;             /* hbil_environment: CONSTANT, SH, CUBE or PROBES; 0: absent */
    int   order;            /* SH, PROBES: the highest that is given, 0 to 2 */
    int   captures_sky;     /* 1: the sky that truth_far of the captures was made with */
    int   misuse;           /* after an environment_parse that failed: 1 if the text itself is wrong, 0 if a file is */
    float color[3];         /* CONSTANT: radiance */
    float sh[9][3];         /* SH: radiance by [l*l+l+m], as hbil_frame.far_sh; 0 above the order */
    image cube;             /* CUBE: radiance, 3 channels, 6 slices; row 0 of a face is t = 0 of GL and Vulkan, on top in a file */
    int   size[3];          /* PROBES: nx ny nz */
    float origin[3], step[3]; /* PROBES: as in hbil_frame. m */
    image probes;           /* PROBES: SH radiance, nx * ny, 9 * nz slices: coefficient k from slice k * nz on; 0 above order */
} environment;

/* From the text of --env:
 *   sky                    the captures' sky: order-1 SH, world +Z up, ground (0.30 0.22 0.14), zenith (0.45 0.75 1.30)
 *   sky:R,G,B,R,G,B        the same with other ground and zenith
 *   color:R,G,B            one radiance everywhere
 *   sh:NUMBERS, sh:FILE    3, 12 or 27 numbers: rgb per coefficient, order 0, 1 or 2, separated by commas or blanks
 *   CUBE.exr               channels R G B, radiance: six square faces +X -X +Y -Y +Z -Z side by side or on top of each other,
 *                          looked up with the world direction as GL and Vulkan do
 *   PROBES.json            {"size": [nx,ny,nz], "origin": [x,y,z], "step": [x,y,z], "order": 0 to 2,
 *                           "coefficients": [ [ [r,g,b] ... (order+1)^2 times ] ... nx*ny*nz times, x fastest ]}, metres, world
 * 1 on success; 0: error[] names text or file, the fault and the fix, and *out is absent but for misuse. */
int  environment_parse(environment *out, const char *text, char *error, size_t error_size);
void environment_free(environment *env);
/* What the plan reads of it, added to what capture_encode made: colour, SH and grid in the frame, images of the inputs sky and
 * probes. A cube map is handed over as it is where the plan reads radiance (far_visibility=free_bits), else blurred into E/pi. */
int  environment_encode(const environment *env, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES],
                        char *error, size_t error_size);

/* In double, for comparisons. Probes are read at a position: environment_at gives the SH there, trilinear, beyond the grid its
 * border; of all other kinds a copy that shares the images: do not free it. Without a position PROBES give 0. */
environment environment_at(const environment *env, const double position[3]);
/* Radiance from a world direction of any length. A cube map is read bilinear within its face. */
void environment_radiance(const environment *env, const double direction[3], double rgb[3]);
/* The same from a view direction, as ray tracers of a depth buffer ask for it: data is an environment_view. view: column-major, rigid. */
typedef struct environment_view { const environment *light; const float *view; } environment_view;
void environment_view_radiance(const void *data, const double direction[3], double rgb[3]);
/* E/pi of an open surface with this unit normal. A cube map is summed over all of its texels: slow. */
void environment_irradiance(const environment *env, const double normal[3], double rgb[3]);

#endif
