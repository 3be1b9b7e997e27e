/* model.h - what is shown: a built-in scene or a file, as triangles, with a camera, a sun and a sky. World: m, z up. */
#ifndef HBIL_VIEWER_MODEL_H
#define HBIL_VIEWER_MODEL_H

#include "gpu.h"

typedef struct model {
    gpu_vertex *vertices;   /* three a triangle */
    size_t      count;      /* of vertices */
    float       eye[3], pivot[3]; /* where the camera begins, and what it looks at and turns about */
    float       half_fov;   /* radians, vertical */
    float       near_z, far_z;
    float       sun[3];     /* unit, towards it */
    float       sun_light[3]; /* E/pi of a surface that faces it */
    float       sky_ground[3], sky_zenith[3]; /* radiance from below and above, linear in z between */
    float       radius;     /* of what the shadow map covers, around the pivot. m */
    float       exposure;
} model;

/* Names of the built-in scenes by index, NULL outside. */
const char *model_scene_name(int index);
/* 1 on success; 0: error[] says why. The names are those of examples/frame/scene.c. */
int  model_scene(model *out, const char *name, char *error, size_t error_size);
/* glTF, OBJ and what else assimp reads: triangles with base colour, emission, metallic and roughness of their
 * material; textures are not read. The first camera of the file, else one that sees all of it. +Y up in the file. */
int  model_file(model *out, const char *path, char *error, size_t error_size);
void model_free(model *m);

#endif
