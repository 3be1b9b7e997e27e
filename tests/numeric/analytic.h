/* analytic.h - two planes that meet: a scene whose visibility is known in closed form, whatever part of it the screen shows.
 * Space and surface as in brute_force.h. */
#ifndef HBIL_TESTS_ANALYTIC_H
#define HBIL_TESTS_ANALYTIC_H

#include "brute_force.h"

/* Planes n.X = d with n towards the open side and d < 0, so that the camera at the origin is on the open side of both. */
typedef struct wedge {
    double n[2][3];
    double d[2];    /* m */
    int    concave; /* 1: open where both planes are in front of you (a room's corner); 0: where either is (a roof's edge) */
} wedge;

/* The edge runs through the point on the edge, along the unit vector along. opening: angle between the planes on the open side, rad,
 * below pi for a concave wedge; turn: rotation of both planes about the edge, rad, from the pose in which they face the camera
 * evenly; the camera has to stay in front of both. */
wedge  wedge_make(const double point[3], const double along[3], double opening, double turn);
/* One plane through a point. */
wedge  wedge_plane(const double point[3], const double normal[3]);
/* Depth at a pixel position, m; 0: sky. *plane (may be NULL) gets the index of the plane seen. */
double wedge_depth(const wedge *w, const bf_camera *camera, double px, double py, int *plane);
/* Depth (sky: `sky`), normals and radiance (one grey per plane) of the whole screen, 1, 3 and 3 floats a pixel; any may be NULL. */
void   wedge_render(const wedge *w, const bf_camera *camera, float sky, const float grey[2], float *depth, float *normal,
                    float *radiance);
/* Visible share at pixel (x, y), which shows plane `plane`: 1 minus the form factor of what the screen shows of the other
 * (Lambert's contour integral). */
double wedge_visible(const wedge *w, const bf_camera *camera, int x, int y, int plane);

#endif
