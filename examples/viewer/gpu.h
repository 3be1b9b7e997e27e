/* gpu.h - what the viewer asks of a graphics API. One table each in gpu_vk.c and gpu_gl.c; both draw with
 * shaders/, both follow the conventions of hbil.h: row 0 of every image is ndc y = -1, and the projection turns
 * that into the top of the picture. */
#ifndef HBIL_VIEWER_GPU_H
#define HBIL_VIEWER_GPU_H

#include <stddef.h>
#include <stdint.h>

#include "../../hbil.h"

struct GLFWwindow;

/* Images of the G-buffer. What hbil.h reads of them is in gpu_input_of. */
enum {
    TARGET_DEPTH,     /* device depth, 32-bit float, 1 is sky */
    TARGET_NORMAL,    /* world space, xyz, half floats */
    TARGET_ALBEDO,    /* diffuse reflectance, 8 bits sRGB */
    TARGET_DIRECT,    /* radiance without indirect light, half floats: sun, what glows, the sky where nothing is */
    TARGET_MOTION,    /* pixel in the last frame minus here, half floats */
    TARGET_SPECULAR,  /* rgb: reflectance at normal incidence, a: roughness, 8 bits */
    TARGETS,
    TARGET_ROUGHNESS = TARGETS, /* a second view of TARGET_SPECULAR, whose red is its alpha */
    GPU_VIEWS
};

#define SHADOW_SIZE    2048   /* texels of the sun's shadow map, each way */
#define TEXT_CORNERS   32768  /* of the overlay's triangles, at most */
#define GPU_TIMES      (HBIL_MAX_PASSES + 3)

typedef struct gpu_vertex {
    float position[3], normal[3], albedo[3], emission[3], metallic, roughness;
} gpu_vertex;
#define GPU_ATTRIBUTES {{0, 3}, {3, 3}, {6, 3}, {9, 3}, {12, 2}} /* of a vertex: first float, count */

/* How screen.frag shows u_shown; the numbers are in shaders/screen.frag, too. */
typedef enum gpu_mode {
    MODE_RADIANCE,    /* as it is: composite, near, far */
    MODE_IRRADIANCE,  /* direct + albedo * it */
    MODE_VISIBILITY,  /* direct + albedo * sky * it, as rgb */
    MODE_AO,          /* the same of its red channel */
    MODE_GREY,        /* red, as it is */
    MODE_VECTOR,      /* [-1, 1] to [0, 1] */
    MODE_DIRECT       /* the direct light instead of it */
} gpu_mode;

/* The uniform block `scene` of shaders/, std140. Matrices column-major. */
typedef struct gpu_uniforms {
    float   clip[16], last_clip[16]; /* world to clip, this frame's and last frame's */
    float   sun_clip[16];            /* world to the shadow map */
    float   sun_texture[16];         /* world to its texture coordinates and depth, each in [0, 1] */
    float   ray[3][4];               /* world direction of a pixel: ray[0] * ndc.x + ray[1] * ndc.y + ray[2] */
    float   eye[4];
    float   sun[4];                  /* unit, towards it; w: world size of a texel of the shadow map, m */
    float   sun_light[4];            /* E/pi of a surface that faces it */
    float   sky[2][4];               /* radiance: mean, and what z of the direction times adds */
    float   size[2];                 /* of the picture */
    float   exposure, split;         /* split: pixels to the left of it show the direct light alone */
    int32_t mode, pad[3];            /* gpu_mode */
} gpu_uniforms;

typedef struct gpu_frame {
    gpu_uniforms   scene;
    hbil_frame     light;
    int32_t        shown;            /* plan texture for u_shown; -1: none */
    const float   *text;             /* of corners of triangles: x y in pixels, grey */
    int            text_corners;
    unsigned char *pixels;           /* NULL, or where to put the picture: rgba, width * height, top row first */
} gpu_frame;

typedef struct gpu_time { char name[20]; double ms; } gpu_time;

typedef struct gpu_setup {
    struct GLFWwindow *window;       /* NULL: none, pictures are only read back */
    int    validate;                 /* messages of validation layer or GL debug output are printed and counted */
    char  *error;                    /* of any call that fails: why, and what to do. Stays with the device */
    size_t error_size;
} gpu_setup;

/* All that return int: 1, or 0 with error[] filled. */
typedef struct gpu_ops {
    const char *name;
    void *(*open)(const gpu_setup *setup, char device[128]); /* NULL on failure */
    void  (*close)(void *gpu);
    int   (*messages)(const void *gpu);                      /* of validation, so far */
    int   (*model)(void *gpu, const gpu_vertex *vertices, size_t count); /* triangles; copied */
    int   (*plan)(void *gpu, const hbil_plan *plan);         /* on failure the plan before stays in use */
    int   (*resize)(void *gpu, int width, int height);       /* before the first frame, after model and plan, too */
    int   (*frame)(void *gpu, const gpu_frame *frame);       /* draws, lights, shows; waits until that is done */
    int   (*times)(void *gpu, gpu_time times[GPU_TIMES]);    /* of the last frame's passes; their number */
} gpu_ops;

extern const gpu_ops gpu_vulkan, gpu_gl;

/* The view that a plan's INPUT reads, TARGET_ROUGHNESS included; -1: this program has none (cube map, probes). */
int gpu_input_of(const char *plan_texture);

#endif
