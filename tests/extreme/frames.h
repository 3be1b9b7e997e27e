/* frames.h - to build the frames of the cases: a camera at any limit, planes seen by it, inputs for every texture of a plan. View space is
 * right-handed: x right, y up, z towards the eye. */
#ifndef HBIL_EXTREME_FRAMES_H
#define HBIL_EXTREME_FRAMES_H

#include "cases.h"

typedef struct camera {
    int    width, height;
    double fov;           /* vertical, degrees; orthographic: height of the screen, m */
    double near_z, far_z;
    double stretch;       /* width of a pixel / its height; 0 is 1 */
    double shift[2];      /* off-centre: ndc of the view axis */
    double eye_x;         /* where the eye stands, in the world. m */
} camera;

/* n . p = d, seen where the point lies in the box low..high (both 0: everywhere). */
typedef struct plane { double n[3], d, low[3], high[3]; } plane;

/* Frame and all inputs: sky everywhere; radiance, albedo and the rest legal and of some pattern. */
void   frames_begin(const hbil_plan *plan, extreme_frame *out, const camera *c, int index);
/* A surface at view depth z. m, in front of the eye */
void   frames_put(const hbil_plan *plan, extreme_frame *out, int x, int y, double z, const double n[3]);
/* The planes as the camera sees them, each pixel the nearest. */
void   frames_planes(const hbil_plan *plan, extreme_frame *out, const plane *planes, int count);
/* A room with a floor, a wall, a pillar and some sky, seen by a camera that moves from frame to frame. */
void   frames_room(const hbil_plan *plan, extreme_frame *out, int width, int height, int index);
/* The same through a camera of one's own. */
void   frames_room_by(const hbil_plan *plan, extreme_frame *out, const camera *c, int index);
/* An input by name; NULL: the plan has none. */
image *frames_input(const hbil_plan *plan, extreme_frame *out, const char *name);
void   frames_fill(image *img, float value);
/* Ray of a pixel position (centres at .5): view xy at depth 1, or at any depth. */
void   frames_ray(const hbil_plan *plan, const hbil_frame *f, double x, double y, double ray[2]);
float  frames_random(uint32_t a, uint32_t b);

#endif
