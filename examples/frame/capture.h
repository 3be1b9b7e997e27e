/* capture.h - one frame of a renderer: G-buffer, camera and, where known, path-traced truth. */
#ifndef HBIL_FRAME_CAPTURE_H
#define HBIL_FRAME_CAPTURE_H

#include "../../hbil.h"
#include "image.h"

typedef struct capture {
    int   width, height;
    int   orthographic;
    float near_z, far_z;    /* m, of the projection */
    /* Column-major. projection: view (right-handed, -Z forward) to GL clip (z in [-1, 1]), with texel row 0 at ndc y = -1:
     * the y row of the file's matrix is negated on loading, since captures store rows top to bottom. */
    float projection[16], view[16];
    image depth;            /* 1: linear view depth, m; sky >= 1e9 */
    image normal;           /* 3: view space */
    image albedo, direct, emission;              /* 3 each; emission may be absent */
    image truth_ao;         /* 1: cosine visibility. The truth images may be absent */
    image truth_near;       /* 3: E/pi of one bounce of direct */
    image truth_far;        /* 3: E/pi of the captures' sky, through what is visible */
    image truth_bounce;     /* 3: E/pi of all bounces */
    image hf_valid, hf_ao, hf_near; /* 1, 1, 3: truth of the depth buffer as a solid height field, where hf_valid is 1 */
    image f0;               /* 1 or 3: specular reflectance. It and roughness may be absent */
    image roughness;        /* 1: perceptual */
    image motion;           /* 2: pixel of the surface point in the last frame minus here, +y down. May be absent, see capture_motion */
    int   emissive;         /* for capture_encode: 1: emission is added to the input radiance */
    int   misfit;           /* after a capture_load that failed: 1 if each file is sound but camera and frame do not fit */
} capture;

/* Read F.exr and its camera JSON; with frame-X.exr also the height-field truth hf-X.exr, if there is one beside it.
 * 1 on success; 0: error[] names the file, the fault and the fix. */
int  capture_load(capture *out, const char *exr, const char *camera_json, char *error, size_t error_size);
/* Built-in scenes: "cornell", the box with a lamp; under sun and sky "fence", thin bars and leaves, "terrain", open country,
 * and "metals", gold to steel beside coloured walls, with f0 and roughness. G-buffer at pixel centres, direct light, truth_ao,
 * truth_near and truth_far traced with `rays` rays per pixel (at most 65536) through the whole scene (0: no truth). All light
 * is diffuse, as in the captures: what metals mirror is in none of the images. Same arguments, same bytes. progress may be NULL;
 * called with [0, 1]. */
int  capture_scene(capture *out, const char *name, int width, int height, int rays, void (*progress)(double),
                   char *error, size_t error_size);
/* The same from another place: move, m along the camera's right, up and forward axis; turn, degrees to the left about its up axis. */
int  capture_scene_from(capture *out, const char *name, const float move[3], float turn, int width, int height, int rays,
                        void (*progress)(double), char *error, size_t error_size);
/* Motion of a frame that has none, from both cameras and its depth, as if nothing moved but the camera. 1, or 0: out of memory. */
int  capture_motion(capture *cap, const capture *last);
/* Names of the built-in scenes by index, NULL outside. */
const char *capture_scene_name(int index);

/* The surfaces of a built-in scene, two-sided triangles. World: m, x right, y away from the camera, z up. */
typedef struct scene_mesh {
    unsigned count;         /* triangles */
    float   *corners;       /* 9 a triangle */
    float   *albedo;        /* 3 a triangle */
    float   *emission;      /* 3 a triangle: radiance */
} scene_mesh;
/* 1 on success; 0: error[] says why. */
int  capture_scene_mesh(scene_mesh *out, const char *name, char *error, size_t error_size);
void scene_mesh_free(scene_mesh *m);
void capture_free(capture *cap);

/* Makes a truth of near or far light that of the option f0: times 1 - f0 of the frame. Either may be absent. */
void capture_take_f0(const capture *cap, image *light);

/* The capture in the conventions that a resolved config asks for: depth linear or device, forward or reversed, finite or infinite far,
 * GL or Vulkan clip; normals in view or world space, in any encoding. Fills frame (size, projection, view) and one image per
 * INPUT texture of the plan, indexed by plan texture; sky and probes are left to environment_encode, other entries stay absent.
 * Free each with image_free. The frame is one without a last one (reset), and motion 0 where it is absent: see capture_follow. */
int  capture_encode(const capture *cap, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES],
                    char *error, size_t error_size);
/* Make an encoded frame the one after `last`. */
void capture_follow(hbil_frame *frame, const capture *last);

#endif
