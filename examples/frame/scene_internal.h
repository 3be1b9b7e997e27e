/* scene_internal.h - the built-in scenes: each file scene_NAME.c builds the geometry of one, scene.c traces them. */
#ifndef HBIL_FRAME_SCENE_INTERNAL_H
#define HBIL_FRAME_SCENE_INTERNAL_H

#include <math.h>
#include <stdint.h>

#define PI 3.14159265f

typedef struct vec { float x, y, z; } vec; /* world: m, x right, y away from the camera, z up */

static inline vec   vec_make(float x, float y, float z) { vec r = {x, y, z}; return r; }
static inline vec   vec_madd(vec a, vec b, float s) { vec r = {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s}; return r; }
static inline float vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline vec   vec_scale(vec a, float s) { vec r = {a.x * s, a.y * s, a.z * s}; return r; }
static inline vec   vec_unit(vec a) { return vec_scale(a, 1.0f / sqrtf(vec_dot(a, a))); }

static inline vec vec_cross(vec a, vec b)
{
    vec r = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return r;
}

/* Two unit vectors at right angles to the unit vector n and to each other (Duff et al. 2017). */
static inline void vec_basis(vec n, vec *tangent, vec *bitangent)
{
    const float s = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (s + n.z), b = n.x * n.y * a;

    *tangent = vec_make(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    *bitangent = vec_make(b, s + n.y * n.y * a, -n.y);
}

/* ---- numbers -----------------------------------------------------------------------------------------------------
 * From integers, which wrap exactly: every machine makes the same. */

static inline float unit(uint32_t bits) { return (float)(bits >> 8) * (1.0f / 16777216.0f); } /* [0, 1) */

/* PCG's output permutation (O'Neill 2014): neighbouring integers to unrelated ones. */
static inline uint32_t hash(uint32_t x)
{
    uint32_t s = x * 747796405u + 2891336453u;
    s = ((s >> ((s >> 28) + 4u)) ^ s) * 277803737u;
    return (s >> 22) ^ s;
}

typedef struct dice { uint32_t state; } dice; /* random numbers of one part of the scene, from its own seed */

static inline float between(dice *d, float low, float high) { return low + (high - low) * unit(hash(d->state++)); }

/* ---- shapes ------------------------------------------------------------------------------------------------------
 * Surfaces are quads of no thickness with two equal sides; a triangle repeats its last corner. */

typedef struct mesh {
    vec           *corners;   /* four a quad */
    unsigned char *materials; /* one a quad: index into the tables of the scene */
    unsigned       count, room;
    int            failed;    /* out of memory: what came after is left out */
} mesh;

#define SIDES_MAX 96 /* of tubes and what is turned */

void mesh_free(mesh *m);
void mesh_quad(mesh *m, vec a, vec b, vec c, vec d, int material);
/* The body between two polygons of `sides` corners each, convex and plane: both ends and the wall between them. */
void mesh_body(mesh *m, const vec *from, const vec *to, int sides, int material);
/* turn: radians about the upright axis through the centre. */
void mesh_box(mesh *m, vec centre, vec half, float turn, int material);
/* A round bar or cone; r0, r1: radius at each end, m. */
void mesh_tube(mesh *m, vec p, vec q, float r0, float r1, int sides, int material);
/* What an outline of radii (x) and heights (z) sweeps when it turns about the upright axis through `at`. */
void mesh_lathe(mesh *m, vec at, const vec *outline, int count, int sides, int material);
void mesh_ball(mesh *m, vec centre, float radius, int sides, int material);

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

typedef struct scene_gloss { float f0[3], roughness; } scene_gloss; /* of what mirrors; roughness: perceptual */

typedef struct scene_builtin {
    const char        *name;
    void             (*build)(mesh *m);
    const float      (*albedo)[3];   /* by material; 0: the lamp */
    const scene_gloss *gloss;        /* by material; NULL: the frame has no f0 and no roughness */
    vec                eye, target;  /* m */
    float              half_fov;     /* radians, vertical */
    float              light[3];     /* radiance of the lamp; or of the sun, E/pi of a surface that faces it */
    vec                sun;          /* towards it; 0: the lamp is the light */
    vec                lamp[3];      /* a corner and two edges of a level rectangle that shines downwards, m */
    uint32_t           direct_samples; /* shadow rays of a pixel; the same for all: plain surfaces show no noise */
    uint32_t           bounce_samples; /* those where a truth ray lands; random, averaged over the rays of a pixel */
} scene_builtin;

extern const scene_builtin scene_cornell, scene_fence, scene_terrain, scene_metals;

#endif
