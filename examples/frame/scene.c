/* scene.c - the built-in scenes, traced on the CPU: frames with truth for machines that have no captures. */
#include "capture.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <embree3/rtcore.h>

#define PI 3.14159265f
#define SKY_DEPTH 1e10f       /* m */
#define OFFSET 1e-4f          /* m, of ray origins along the normal; float rounding in these scenes is about 1e-6 m */
#define NEAR_Z 0.1f           /* m */
#define FAR_Z 100.0f          /* m */
#define RAYS_MAX 65536
#define THREADS_MAX 16

enum {
    WHITE, RED, GREEN, LAMP,
    PAVING, STONE, PAINT, STEEL, WOOD, CLAY, SOIL, STEM, LEAF, YOUNG_LEAF, GRASS,
    MATERIALS
};
static const float reflectance[MATERIALS][3] = {
    {0.725f, 0.71f, 0.68f}, {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}, {0.0f, 0.0f, 0.0f},  /* Cornell's */
    {0.40f, 0.36f, 0.31f}, {0.50f, 0.48f, 0.45f}, {0.80f, 0.79f, 0.75f},
    {0.13f, 0.19f, 0.17f}, {0.46f, 0.32f, 0.19f}, {0.58f, 0.25f, 0.14f}, {0.14f, 0.10f, 0.07f},
    {0.22f, 0.17f, 0.09f}, {0.15f, 0.32f, 0.06f}, {0.27f, 0.44f, 0.10f}, {0.24f, 0.36f, 0.09f},
};

/* The sky of the captures: radiance mix(ground, zenith, 0.5 + 0.5 z) from the unit direction of height z. */
static const float sky_ground[3] = {0.30f, 0.22f, 0.14f}, sky_zenith[3] = {0.45f, 0.75f, 1.30f};

typedef struct vec { float x, y, z; } vec; /* world: m, x right, y away from the camera, z up */

static vec   vec_make(float x, float y, float z) { vec r = {x, y, z}; return r; }
static vec   vec_madd(vec a, vec b, float s) { vec r = {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s}; return r; }
static float vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec   vec_scale(vec a, float s) { vec r = {a.x * s, a.y * s, a.z * s}; return r; }
static vec   vec_unit(vec a) { return vec_scale(a, 1.0f / sqrtf(vec_dot(a, a))); }

static vec vec_cross(vec a, vec b)
{
    vec r = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return r;
}

/* Two unit vectors at right angles to the unit vector n and to each other (Duff et al. 2017). */
static void find_basis(vec n, vec *tangent, vec *bitangent)
{
    const float s = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (s + n.z), b = n.x * n.y * a;

    *tangent = vec_make(1.0f + s * n.x * n.x * a, s * b, -s * n.x);
    *bitangent = vec_make(b, s + n.y * n.y * a, -n.y);
}

/* ---- numbers -----------------------------------------------------------------------------------------------------
 * The R2 sequence (Roberts 2018) in 0.32 fixed point: integers wrap exactly, so every machine makes the same points. */

#define R2_U 3242174889u
#define R2_V 2447445414u

static float unit(uint32_t bits) { return (float)(bits >> 8) * (1.0f / 16777216.0f); } /* [0, 1) */

/* PCG's output permutation (O'Neill 2014): neighbouring integers to unrelated ones. */
static uint32_t hash(uint32_t x)
{
    uint32_t s = x * 747796405u + 2891336453u;
    s = ((s >> ((s >> 28) + 4u)) ^ s) * 277803737u;
    return (s >> 22) ^ s;
}

/* ---- shapes ------------------------------------------------------------------------------------------------------
 * Surfaces are quads of no thickness with two equal sides; a triangle repeats its last corner. */

typedef struct mesh {
    vec           *corners;   /* four a quad */
    unsigned char *materials; /* one a quad */
    unsigned       count, room;
    int            failed;    /* out of memory: what came after is left out */
} mesh;

static void mesh_free(mesh *m)
{
    free(m->corners);
    free(m->materials);
    memset(m, 0, sizeof *m);
}

static void add_quad(mesh *m, vec a, vec b, vec c, vec d, int material)
{
    if (m->count == m->room && !m->failed) {
        const unsigned room = m->room ? 2 * m->room : 1024;
        vec           *corners = realloc(m->corners, 4 * room * sizeof *corners);
        unsigned char *materials = realloc(m->materials, room);

        if (corners) m->corners = corners;
        if (materials) m->materials = materials;
        m->failed = !corners || !materials;
        if (!m->failed) m->room = room;
    }
    if (m->failed) return;
    m->corners[4 * m->count + 0] = a;
    m->corners[4 * m->count + 1] = b;
    m->corners[4 * m->count + 2] = c;
    m->corners[4 * m->count + 3] = d;
    m->materials[m->count++] = (unsigned char)material;
}

/* The body between two polygons of `sides` corners each, convex and plane: both ends and the wall between them. */
static void add_body(mesh *m, const vec *from, const vec *to, int sides, int material)
{
    int i;

    for (i = 0; i < sides; i++) add_quad(m, from[i], from[(i + 1) % sides], to[(i + 1) % sides], to[i], material);
    for (i = 2; i < sides; i++) {
        add_quad(m, from[0], from[i - 1], from[i], from[i], material);
        add_quad(m, to[0], to[i - 1], to[i], to[i], material);
    }
}

/* turn: radians about the upright axis through the centre. */
static void add_box(mesh *m, vec centre, vec half, float turn, int material)
{
    const vec u = {half.x * cosf(turn), half.x * sinf(turn), 0.0f}, v = {-half.y * sinf(turn), half.y * cosf(turn), 0.0f};
    const vec bottom = {centre.x, centre.y, centre.z - half.z};
    vec       from[4], to[4];
    int       i;

    for (i = 0; i < 4; i++) {
        from[i] = vec_madd(vec_madd(bottom, u, i == 1 || i == 2 ? 1.0f : -1.0f), v, i >= 2 ? 1.0f : -1.0f);
        to[i] = vec_make(from[i].x, from[i].y, centre.z + half.z);
    }
    add_body(m, from, to, 4, material);
}

#define TUBE_SIDES_MAX 24

/* A round bar or cone; r0, r1: radius at each end, m. */
static void add_tube(mesh *m, vec p, vec q, float r0, float r1, int sides, int material)
{
    vec from[TUBE_SIDES_MAX], to[TUBE_SIDES_MAX], u, v;
    int i;

    find_basis(vec_unit(vec_madd(q, p, -1.0f)), &u, &v);
    for (i = 0; i < sides; i++) {
        const float turn = 2.0f * PI * ((float)i + 0.5f) / (float)sides;
        const vec   rim = vec_madd(vec_scale(u, cosf(turn)), v, sinf(turn));
        from[i] = vec_madd(p, rim, r0);
        to[i] = vec_madd(q, rim, r1);
    }
    add_body(m, from, to, sides, material);
}

/* ---- cornell -----------------------------------------------------------------------------------------------------
 * Cornell University's measured box: a unit is read as a centimetre here, so that the room is 5.5 m wide. x to the left as
 * the camera sees it, y up, z away from it. The lamp hangs 1 mm below the ceiling. */
static const float lamp_x[2] = {213.0f, 343.0f}, lamp_y = 548.7f, lamp_z[2] = {227.0f, 332.0f};
static const float camera_at[3] = {278.0f, 273.0f, -800.0f};

static const struct { float corner[4][3]; int material; } quads[] = {
    {{{552.8f, 0.0f, 0.0f}, {0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 559.2f}, {549.6f, 0.0f, 559.2f}}, WHITE},              /* floor */
    {{{556.0f, 548.8f, 0.0f}, {556.0f, 548.8f, 559.2f}, {0.0f, 548.8f, 559.2f}, {0.0f, 548.8f, 0.0f}}, WHITE},      /* ceiling */
    {{{549.6f, 0.0f, 559.2f}, {0.0f, 0.0f, 559.2f}, {0.0f, 548.8f, 559.2f}, {556.0f, 548.8f, 559.2f}}, WHITE},      /* back */
    {{{0.0f, 0.0f, 559.2f}, {0.0f, 0.0f, 0.0f}, {0.0f, 548.8f, 0.0f}, {0.0f, 548.8f, 559.2f}}, GREEN},              /* right */
    {{{552.8f, 0.0f, 0.0f}, {549.6f, 0.0f, 559.2f}, {556.0f, 548.8f, 559.2f}, {556.0f, 548.8f, 0.0f}}, RED},        /* left */
    {{{213.0f, 548.7f, 227.0f}, {343.0f, 548.7f, 227.0f}, {343.0f, 548.7f, 332.0f}, {213.0f, 548.7f, 332.0f}}, LAMP},
    /* short block */
    {{{130.0f, 165.0f, 65.0f}, {82.0f, 165.0f, 225.0f}, {240.0f, 165.0f, 272.0f}, {290.0f, 165.0f, 114.0f}}, WHITE},
    {{{290.0f, 0.0f, 114.0f}, {290.0f, 165.0f, 114.0f}, {240.0f, 165.0f, 272.0f}, {240.0f, 0.0f, 272.0f}}, WHITE},
    {{{130.0f, 0.0f, 65.0f}, {130.0f, 165.0f, 65.0f}, {290.0f, 165.0f, 114.0f}, {290.0f, 0.0f, 114.0f}}, WHITE},
    {{{82.0f, 0.0f, 225.0f}, {82.0f, 165.0f, 225.0f}, {130.0f, 165.0f, 65.0f}, {130.0f, 0.0f, 65.0f}}, WHITE},
    {{{240.0f, 0.0f, 272.0f}, {240.0f, 165.0f, 272.0f}, {82.0f, 165.0f, 225.0f}, {82.0f, 0.0f, 225.0f}}, WHITE},
    /* tall block */
    {{{423.0f, 330.0f, 247.0f}, {265.0f, 330.0f, 296.0f}, {314.0f, 330.0f, 456.0f}, {472.0f, 330.0f, 406.0f}}, WHITE},
    {{{423.0f, 0.0f, 247.0f}, {423.0f, 330.0f, 247.0f}, {472.0f, 330.0f, 406.0f}, {472.0f, 0.0f, 406.0f}}, WHITE},
    {{{472.0f, 0.0f, 406.0f}, {472.0f, 330.0f, 406.0f}, {314.0f, 330.0f, 456.0f}, {314.0f, 0.0f, 456.0f}}, WHITE},
    {{{314.0f, 0.0f, 456.0f}, {314.0f, 330.0f, 456.0f}, {265.0f, 330.0f, 296.0f}, {265.0f, 0.0f, 296.0f}}, WHITE},
    {{{265.0f, 0.0f, 296.0f}, {265.0f, 330.0f, 296.0f}, {423.0f, 330.0f, 247.0f}, {423.0f, 0.0f, 247.0f}}, WHITE},
};

/* Cornell units to the world, its origin below the camera's axis at the front of the box. */
static vec to_world(float x, float y, float z)
{
    vec r = {(camera_at[0] - x) * 0.01f, z * 0.01f, y * 0.01f};
    return r;
}

static void build_cornell(mesh *m)
{
    unsigned i, c;
    vec      p[4];

    for (i = 0; i < sizeof quads / sizeof *quads; i++) {
        for (c = 0; c < 4; c++) p[c] = to_world(quads[i].corner[c][0], quads[i].corner[c][1], quads[i].corner[c][2]);
        add_quad(m, p[0], p[1], p[2], p[3], quads[i].material);
    }
}

/* ---- fence -------------------------------------------------------------------------------------------------------
 * Thin things over open ground, seen from above under the sky and a low sun: a fence, half pickets, half steel rods; bean canes
 * and a young tree whose leaves hang free in the air; a thick pot for contrast. A depth buffer shows the fronts alone, and a height
 * field lets each of them hide all that is behind it. So that this decides, and not what a screen cannot know, the camera looks down:
 * the ground that these things see and stand over fills the picture and goes on past its border, without a sky.
 * True thickness, m: leaves and grass 0, stems and branches to 0.02, pickets, rods and canes 0.02, rails 0.03, trunk 0.05, posts 0.06
 * and 0.09; stones and soil rise 0.02 above the ground. So 0.1 is the option thickness of this scene: all but ground and pot is thinner. With less,
 * light leaks through the ground between the steps of the march. */

typedef struct dice { uint32_t state; } dice; /* random numbers of one part of the scene, from its own seed */

static float between(dice *d, float low, float high) { return low + (high - low) * unit(hash(d->state++)); }

/* v, each component moved by up to `by`. One draw a statement: C leaves the order within an initialiser open. */
static vec roughly(dice *d, vec v, float by)
{
    v.x += between(d, -by, by);
    v.y += between(d, -by, by);
    v.z += between(d, -by, by);
    return v;
}

/* An upright board with a pointed top, facing y: x, y its middle, lean its slope to the right. */
static void add_picket(mesh *m, float x, float y, float height, float lean, int material)
{
    static const float half_width = 0.025f, half_depth = 0.01f, point = 0.04f, foot = 0.05f; /* m; foot: above the ground */
    const float across[5] = {-half_width, half_width, half_width, 0.0f, -half_width};
    const float up[5] = {foot, foot, height - point, height, height - point};
    vec         from[5], to[5];
    int         i;

    for (i = 0; i < 5; i++) {
        from[i] = vec_make(x + across[i] + lean * up[i], y - half_depth, up[i]);
        to[i] = vec_make(from[i].x, y + half_depth, up[i]);
    }
    add_body(m, from, to, 5, material);
}

static void build_pickets(mesh *m, float left, float right)
{
    static const float pitch = 0.105f; /* m: half is gap */
    const float middle = 0.5f * (left + right), half = 0.5f * (right - left);
    dice        d = {1000};
    float       x;

    add_box(m, vec_make(middle, 0.025f, 0.27f), vec_make(half, 0.015f, 0.03f), 0.0f, PAINT);
    add_box(m, vec_make(middle, 0.025f, 0.80f), vec_make(half, 0.015f, 0.03f), 0.0f, PAINT);
    for (x = right; x > left - 0.1f; x -= 1.8f) {
        add_box(m, vec_make(x, 0.085f, 0.53f), vec_make(0.045f, 0.045f, 0.55f), 0.0f, PAINT);
        add_box(m, vec_make(x, 0.085f, 1.09f), vec_make(0.06f, 0.06f, 0.012f), 0.0f, PAINT);
    }
    for (x = left + 0.05f; x < right; x += pitch) {
        const float shift = between(&d, -0.006f, 0.006f), height = between(&d, 0.988f, 1.012f);
        add_picket(m, x + shift, 0.0f, height, between(&d, -0.012f, 0.012f), PAINT);
    }
}

static void build_rods(mesh *m, float left, float right)
{
    static const float height[] = {0.12f, 0.30f, 0.48f, 0.66f, 0.84f, 1.02f};
    float  x;
    size_t i;

    for (i = 0; i < sizeof height / sizeof *height; i++)
        add_tube(m, vec_make(left, 0.085f, height[i]), vec_make(right, 0.085f, height[i]), 0.01f, 0.01f, 8, STEEL);
    for (x = left + 0.06f; x < right; x += 0.12f)
        add_tube(m, vec_make(x, 0.065f, 0.03f), vec_make(x, 0.065f, 1.08f), 0.01f, 0.01f, 8, STEEL);
    for (x = left + 1.8f; x <= right; x += 1.8f)
        add_tube(m, vec_make(x, 0.085f, -0.02f), vec_make(x, 0.085f, 1.14f), 0.03f, 0.03f, 16, STEEL);
}

/* A blade of two halves that rise from the middle rib, each of two triangles and a quad, bent down towards its tip. */
static void add_leaf(mesh *m, dice *d, vec base, vec along, float length, float width, int material)
{
    const vec   roll = roughly(d, vec_make(0.0f, 0.0f, 1.0f), 0.6f);
    const vec   side = vec_unit(vec_cross(along, roll)), up = vec_cross(side, along);
    const float droop = between(d, 0.1f, 0.5f) * length, fold = between(d, 0.1f, 0.6f);
    static const float at[3] = {0.3f, 0.65f, 1.0f}, wide[3] = {1.0f, 0.8f, 0.0f};
    vec rib[3], edge[2];
    int i, s;

    for (i = 0; i < 3; i++) {
        rib[i] = vec_madd(base, along, at[i] * length);
        rib[i].z -= droop * at[i] * at[i];
    }
    for (s = -1; s <= 1; s += 2) {
        for (i = 0; i < 2; i++) {
            const float half = 0.5f * width * wide[i];
            edge[i] = vec_madd(vec_madd(rib[i], side, (float)s * half), up, fold * half);
        }
        add_quad(m, base, rib[0], edge[0], edge[0], material);
        add_quad(m, rib[0], rib[1], edge[1], edge[0], material);
        add_quad(m, rib[1], rib[2], edge[1], edge[1], material);
    }
}

static int pick_green(dice *d) { return between(d, 0.0f, 1.0f) < 0.33f ? YOUNG_LEAF : LEAF; }

/* A branch that sags and tapers. level 0: a twig with leaves alternating at its sides; 1: twigs instead. */
static void add_twig(mesh *m, dice *d, vec p, vec along, float length, int level)
{
    enum { NODES = 6 };
    const float step = length / NODES, radius = level ? 0.011f : 0.0045f;
    int         k;

    for (k = 1; k <= NODES; k++) {
        const vec   q = roughly(d, vec_madd(p, along, step), 0.02f * length);
        const float r = radius * (1.0f - 0.8f * (float)k / NODES), turn = (k % 2 ? 1.0f : -1.0f) * between(d, 0.6f, 1.2f);
        const vec   out = {along.x * cosf(turn) - along.y * sinf(turn), along.x * sinf(turn) + along.y * cosf(turn),
                           along.z + between(d, -0.3f, 0.3f)};

        add_tube(m, p, q, r + 0.13f * radius, r, 5, STEM);
        p = q;
        along.z -= 0.08f;
        if (level) {
            add_twig(m, d, p, vec_unit(out), between(d, 0.3f, 0.5f) * length, 0);
        } else if (k > 1) {
            const float size = between(d, 0.075f, 0.125f);
            add_leaf(m, d, p, vec_unit(out), size, 0.5f * size, pick_green(d));
        }
    }
}

/* A young tree: a trunk 5 cm thick, branches that spread from it. */
static void add_tree(mesh *m, dice *d, vec foot, float height, int branches)
{
    static const vec trunk = {0.02f, 0.0f, 1.0f};
    int i;

    add_tube(m, foot, vec_madd(foot, trunk, height), 0.025f, 0.012f, 10, STEM);
    for (i = 0; i < branches; i++) {
        const float turn = 2.39996f * (float)i, up = 0.5f + 0.5f * ((float)i + 0.5f) / (float)branches;
        const vec   along = vec_unit(vec_make(cosf(turn), sinf(turn), between(d, 0.1f, 0.5f)));
        add_twig(m, d, vec_madd(foot, trunk, up * height), along, between(d, 0.7f, 1.0f), 1);
    }
}

/* Stems that climb the fence from its foot, leaves on both sides of it. */
static void add_climber(mesh *m, dice *d, float x, float reach, int stems)
{
    int i, k;

    for (i = 0; i < stems; i++) {
        const float slope = between(d, -reach, reach);
        vec         p = roughly(d, vec_make(x, 0.015f, -0.05f), 0.05f);

        for (k = 0; k < 14; k++) {
            const float side = k % 2 ? 0.045f : -0.025f; /* in and out between the bars */
            const vec   q = roughly(d, vec_make(p.x + 0.09f * slope, side, p.z + 0.07f), 0.02f);
            const float swing = between(d, 0.0f, 6.28f), length = between(d, 0.07f, 0.12f);
            const vec   along = {cosf(swing), sinf(swing) * 0.8f, between(d, -0.5f, 0.4f)};
            add_tube(m, p, q, 0.004f, 0.004f, 4, STEM);
            add_leaf(m, d, q, vec_unit(along), length, 0.75f * length, pick_green(d));
            p = q;
        }
    }
}

/* Blades 9 mm wide between two points on the ground. */
static void add_grass(mesh *m, dice *d, vec from, vec to, int blades)
{
    int i;

    for (i = 0; i < blades; i++) {
        const float at = between(d, 0.0f, 1.0f), spread = between(d, -1.0f, 1.0f); /* along the line, and off it */
        const vec   line = vec_madd(from, vec_madd(to, from, -1.0f), at), base = {line.x, line.y + 0.07f * spread, 0.0f};
        const vec   along = vec_unit(roughly(d, vec_make(0.0f, 0.0f, 1.0f), 0.45f));
        add_leaf(m, d, base, along, between(d, 0.08f, 0.24f), 0.009f, GRASS);
    }
}

static void add_pot(mesh *m, float x, float y)
{
    add_tube(m, vec_make(x, y, 0.0f), vec_make(x, y, 0.26f), 0.12f, 0.17f, 24, CLAY);
    add_tube(m, vec_make(x, y, 0.26f), vec_make(x, y, 0.32f), 0.19f, 0.195f, 24, CLAY);
    add_tube(m, vec_make(x, y, 0.31f), vec_make(x, y, 0.325f), 0.17f, 0.17f, 24, SOIL);
}

/* Canes 2 cm thick that lean together, a bean winding up each with a leaf at every other node. */
static void add_canes(mesh *m, dice *d, float x, float y, float height, int canes)
{
    enum { NODES = 22 };
    int i, k;

    for (i = 0; i < canes; i++) {
        const float angle = 2.0f * PI * ((float)i + 0.3f) / (float)canes, size = between(d, 0.6f, 1.0f);
        const vec   out = {cosf(angle), sinf(angle), 0.0f};
        const vec   foot = vec_madd(vec_make(x, y, 0.0f), out, 0.4f), top = vec_madd(vec_make(x, y, height), out, -0.06f);
        vec         p = foot;

        add_tube(m, foot, top, 0.01f, 0.009f, 8, WOOD);
        for (k = 1; k <= NODES; k++) {
            const float turn = 1.3f * (float)k;
            const vec   on = vec_madd(foot, vec_madd(top, foot, -1.0f), size * (float)k / NODES);
            const vec   aside = {cosf(turn), sinf(turn), between(d, -0.6f, 0.3f)};
            const vec   q = vec_madd(on, vec_make(aside.x, aside.y, 0.0f), 0.018f);
            const float length = between(d, 0.07f, 0.12f);

            add_tube(m, p, q, 0.003f, 0.003f, 4, STEM);
            if (k % 2) add_leaf(m, d, q, vec_unit(aside), length, 0.75f * length, pick_green(d));
            p = q;
        }
    }
}

/* Twigs that spread from the foot. */
static void add_sprout(mesh *m, dice *d, vec foot, int twigs, float length)
{
    int i;

    for (i = 0; i < twigs; i++) {
        const float turn = 2.39996f * (float)i, up = between(d, 0.7f, 1.8f);
        add_twig(m, d, foot, vec_unit(vec_make(cosf(turn), sinf(turn), up)), between(d, 0.7f, 1.1f) * length, 0);
    }
}

/* The ground, stepping stones in a curve before the fence and a bed of soil behind it. */
static void build_yard(mesh *m)
{
    static const float edge = 50.0f; /* m */
    dice d = {2000};
    int  i;

    add_box(m, vec_make(0.0f, 0.0f, -0.5f), vec_make(edge, edge, 0.5f), 0.0f, PAVING);
    add_box(m, vec_make(0.1f, 1.45f, 0.0f), vec_make(2.6f, 0.55f, 0.02f), 0.0f, SOIL);
    for (i = 0; i < 14; i++) {
        const float x = -2.8f + 0.43f * (float)i, bow = x - 0.3f;
        const vec   at = roughly(&d, vec_make(x, -1.35f + 0.1f * bow * bow, 0.0f), 0.04f);
        add_box(m, vec_make(at.x, at.y, 0.0f), vec_make(0.15f, 0.2f, 0.012f), 0.2f * bow, STONE);
    }
}

static void build_fence(mesh *m)
{
    dice d = {1};

    build_yard(m);
    build_pickets(m, -5.2f, 0.2f);
    build_rods(m, 0.2f, 5.6f);
    add_climber(m, &d, 1.6f, 0.8f, 5);
    add_tree(m, &d, vec_make(-0.95f, -0.5f, 0.0f), 1.6f, 9);
    add_canes(m, &d, -1.6f, 1.45f, 1.6f, 6);
    add_canes(m, &d, -0.2f, 1.5f, 1.5f, 6);
    add_canes(m, &d, 1.2f, 1.4f, 1.6f, 6);
    add_pot(m, 0.75f, -0.6f);
    add_sprout(m, &d, vec_make(0.75f, -0.6f, 0.32f), 7, 0.5f);
    add_grass(m, &d, vec_make(-5.2f, -0.02f, 0.0f), vec_make(5.6f, 0.0f, 0.0f), 900);
}

/* ---- the scenes -------------------------------------------------------------------------------------------------- */

typedef struct builtin {
    const char *name;
    void      (*build)(mesh *m);
    vec         eye, target;      /* m */
    float       half_fov;         /* radians, vertical */
    float       light[3];         /* radiance of the lamp; or of the sun, E/pi of a surface that faces it */
    vec         sun;              /* towards it; 0: the lamp of Cornell's box is the light */
    uint32_t    direct_samples;   /* shadow rays of a pixel's direct light; the same for all: plain surfaces show no noise */
    uint32_t    bounce_samples;   /* shadow rays where a truth ray lands; random, averaged over the rays of a pixel */
} builtin;

static const builtin builtins[] = {
    {"cornell", build_cornell, {0.0f, -8.0f, 2.73f}, {0.0f, -7.0f, 2.73f}, 0.34906585f,
     {17.0f, 12.0f, 4.0f}, {0.0f, 0.0f, 0.0f}, 256, 4},
    {"fence", build_fence, {0.9f, -4.2f, 3.4f}, {0.1f, 0.2f, 0.5f}, 0.30f,
     {2.9f, 2.45f, 1.85f}, {-0.55f, -0.72f, 0.55f}, 16, 1},
};
#define BUILTINS ((int)(sizeof builtins / sizeof *builtins))
#define SUN_RADIUS 0.00465f /* tangent of the angle between its centre and rim */

/* A scene ready to be traced. */
typedef struct world {
    const builtin *what;
    mesh           shapes;
    RTCScene       tree;
    vec            eye, right, forward, up;  /* of the camera */
    vec            sun, sun_u, sun_v;   /* unit, towards it and across */
} world;

static void sky_radiance(vec unit_direction, float out[3])
{
    const float up = 0.5f + 0.5f * unit_direction.z;
    int         c;

    for (c = 0; c < 3; c++) out[c] = sky_ground[c] + (sky_zenith[c] - sky_ground[c]) * up;
}

/* ---- rays -------------------------------------------------------------------------------------------------------- */

typedef struct surface {
    vec   position, normal; /* normal: unit, towards where the ray came from */
    float t;
    int   material;
} surface;

/* 1: something is hit. direction need not have unit length: t counts in its lengths. */
static int trace(const world *w, vec origin, vec direction, surface *hit)
{
    struct RTCIntersectContext context;
    struct RTCRayHit           r;
    float                      length;

    rtcInitIntersectContext(&context);
    memset(&r, 0, sizeof r);
    r.ray.org_x = origin.x, r.ray.org_y = origin.y, r.ray.org_z = origin.z;
    r.ray.dir_x = direction.x, r.ray.dir_y = direction.y, r.ray.dir_z = direction.z;
    r.ray.tfar = INFINITY;
    r.ray.mask = ~0u;
    r.hit.geomID = r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(w->tree, &context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0;
    hit->t = r.ray.tfar;
    hit->position = vec_madd(origin, direction, hit->t);
    hit->normal.x = r.hit.Ng_x, hit->normal.y = r.hit.Ng_y, hit->normal.z = r.hit.Ng_z;
    length = sqrtf(vec_dot(hit->normal, hit->normal));
    hit->normal = vec_scale(hit->normal, (vec_dot(hit->normal, direction) > 0.0f ? -1.0f : 1.0f) / length);
    hit->material = w->shapes.materials[r.hit.primID];
    return 1;
}

/* 1: nothing lies between origin and origin + path, ends left out. */
static int is_clear(const world *w, vec origin, vec path)
{
    struct RTCIntersectContext context;
    struct RTCRay              r;

    rtcInitIntersectContext(&context);
    memset(&r, 0, sizeof r);
    r.org_x = origin.x, r.org_y = origin.y, r.org_z = origin.z;
    r.dir_x = path.x, r.dir_y = path.y, r.dir_z = path.z;
    r.tfar = 1.0f - OFFSET;
    r.mask = ~0u;
    rtcOccluded1(w->tree, &context, &r);
    return r.tfar >= 0.0f; /* Embree sets it to -inf on a hit */
}

/* Form factor of the lamp, shadows included: E_direct = pi * lamp radiance * this. The lamp shines downwards only.
 * samples points of R2 on it, shifted by (shift_u, shift_v). */
static float lamp_view(const world *w, const surface *at, uint32_t samples, uint32_t shift_u, uint32_t shift_v)
{
    const float area = (lamp_x[1] - lamp_x[0]) * (lamp_z[1] - lamp_z[0]) * 1e-4f; /* m^2 */
    const vec   origin = vec_madd(at->position, at->normal, OFFSET);
    float       sum = 0.0f;
    uint32_t    i;

    for (i = 0; i < samples; i++) {
        float u = unit(shift_u + i * R2_U), v = unit(shift_v + i * R2_V);
        vec   p = to_world(lamp_x[0] + (lamp_x[1] - lamp_x[0]) * u, lamp_y, lamp_z[0] + (lamp_z[1] - lamp_z[0]) * v);
        vec   path = vec_madd(p, origin, -1.0f);
        float facing = vec_dot(path, at->normal), r2 = vec_dot(path, path);

        if (facing > 0.0f && path.z > 0.0f && is_clear(w, origin, path)) sum += facing * path.z / (r2 * r2);
    }
    return sum * area / (PI * (float)samples);
}

/* The visible part of the sun times the cosine to it, sampled like the lamp. */
static float sun_view(const world *w, const surface *at, uint32_t samples, uint32_t shift_u, uint32_t shift_v)
{
    const vec origin = vec_madd(at->position, at->normal, OFFSET);
    float     sum = 0.0f;
    uint32_t  i;

    if (vec_dot(at->normal, w->sun) <= -SUN_RADIUS) return 0.0f;
    for (i = 0; i < samples; i++) {
        const float r = SUN_RADIUS * sqrtf(unit(shift_u + i * R2_U)), turn = 2.0f * PI * unit(shift_v + i * R2_V);
        const vec   direction = vec_madd(vec_madd(w->sun, w->sun_u, r * cosf(turn)), w->sun_v, r * sinf(turn));
        const float facing = vec_dot(direction, at->normal);

        if (facing > 0.0f && is_clear(w, origin, vec_scale(direction, FAR_Z))) sum += facing;
    }
    return sum / (float)samples;
}

/* E_direct = pi * light[] * this. */
static float light_view(const world *w, const surface *at, uint32_t samples, uint32_t shift_u, uint32_t shift_v)
{
    return (w->what->sun.z > 0.0f ? sun_view : lamp_view)(w, at, samples, shift_u, shift_v);
}

/* ---- one pixel --------------------------------------------------------------------------------------------------- */

/* Direction number i of a cosine-weighted set around the unit normal n. */
static vec cosine_direction(vec n, uint32_t i, uint32_t shift_u, uint32_t shift_v)
{
    const float u = unit(shift_u + i * R2_U), phi = 2.0f * PI * unit(shift_v + i * R2_V);
    const float x = sqrtf(u) * cosf(phi), y = sqrtf(u) * sinf(phi), z = sqrtf(1.0f - u);
    vec         tangent, bitangent;

    find_basis(n, &tangent, &bitangent);
    return vec_madd(vec_madd(vec_scale(n, z), tangent, x), bitangent, y);
}

/* Fills pixel i of the truth images: cosine visibility; E/pi of the direct light that the seen surfaces reflect; E/pi of
 * the sky. Means over cosine-weighted rays. */
static void trace_truth(const world *w, const surface *at, capture *cap, size_t i, int rays)
{
    const uint32_t shift_u = hash(2u * (uint32_t)i), shift_v = hash(2u * (uint32_t)i + 1u);
    const vec      origin = vec_madd(at->position, at->normal, OFFSET);
    double         open = 0.0, near[3] = {0.0, 0.0, 0.0}, far[3] = {0.0, 0.0, 0.0};
    float          sky[3];
    surface        seen;
    int            k, c;

    for (k = 0; k < rays; k++) {
        const vec direction = cosine_direction(at->normal, (uint32_t)k, shift_u, shift_v);

        if (!trace(w, origin, direction, &seen)) {
            sky_radiance(direction, sky);
            for (c = 0; c < 3; c++) far[c] += (double)sky[c];
            open += 1.0;
        } else if (seen.material != LAMP) {
            const uint32_t shift = hash(shift_u + (uint32_t)k);
            const float    view = light_view(w, &seen, w->what->bounce_samples, shift, hash(shift));
            for (c = 0; c < 3; c++) near[c] += (double)(reflectance[seen.material][c] * w->what->light[c] * view);
        }
    }
    cap->truth_ao.data[i] = (float)(open / rays);
    for (c = 0; c < 3; c++) {
        cap->truth_near.data[3 * i + (size_t)c] = (float)(near[c] / rays);
        cap->truth_far.data[3 * i + (size_t)c] = (float)(far[c] / rays);
    }
}

static void trace_pixel(const world *w, capture *cap, int x, int y, int rays)
{
    const size_t i = (size_t)y * (size_t)cap->width + (size_t)x;
    const float  ndc_x = 2.0f * ((float)x + 0.5f) / (float)cap->width - 1.0f;
    const float  ndc_y = 2.0f * ((float)y + 0.5f) / (float)cap->height - 1.0f; /* row 0, the top, is -1 */
    /* One metre along the axis of view, so that t is the linear depth. */
    const vec    row = vec_madd(w->forward, w->up, ndc_y / cap->projection[5]);
    const vec    direction = vec_madd(row, w->right, ndc_x / cap->projection[0]);
    surface      at;
    float        view;
    int          c;

    cap->depth.data[i] = SKY_DEPTH; /* every other image is 0 there */
    if (!trace(w, w->eye, direction, &at)) return;
    cap->depth.data[i] = at.t;
    cap->normal.data[3 * i + 0] = vec_dot(w->right, at.normal);
    cap->normal.data[3 * i + 1] = vec_dot(w->up, at.normal);
    cap->normal.data[3 * i + 2] = -vec_dot(w->forward, at.normal);
    if (at.material == LAMP) {
        memcpy(cap->emission.data + 3 * i, w->what->light, sizeof w->what->light);
        return;
    }
    view = light_view(w, &at, w->what->direct_samples, 0, 0);
    for (c = 0; c < 3; c++) {
        cap->albedo.data[3 * i + (size_t)c] = reflectance[at.material][c];
        cap->direct.data[3 * i + (size_t)c] = reflectance[at.material][c] * w->what->light[c] * view;
    }
    if (rays > 0) trace_truth(w, &at, cap, i, rays);
}

/* ---- the whole picture ------------------------------------------------------------------------------------------- */

typedef struct job {
    const world    *scene;
    capture        *cap;
    int             rays;
    int             next_row; /* guarded by lock, as is the call of progress */
    pthread_mutex_t lock;
    void          (*progress)(double);
} job;

/* Take rows until none is left. A pixel depends on its own number alone, so who traces it does not matter. */
static void *trace_rows(void *argument)
{
    job *j = argument;
    int  x, y;

    for (;;) {
        pthread_mutex_lock(&j->lock);
        y = j->next_row++;
        if (j->progress && y <= j->cap->height) j->progress((double)y / j->cap->height);
        pthread_mutex_unlock(&j->lock);
        if (y >= j->cap->height) return NULL;
        for (x = 0; x < j->cap->width; x++) trace_pixel(j->scene, j->cap, x, y, j->rays);
    }
}

static void trace_all(const world *w, capture *cap, int rays, void (*progress)(double))
{
    pthread_t threads[THREADS_MAX];
    long      cores = sysconf(_SC_NPROCESSORS_ONLN);
    int       count = 0;
    job       j;

    j.scene = w, j.cap = cap, j.rays = rays, j.next_row = 0, j.progress = progress;
    pthread_mutex_init(&j.lock, NULL);
    while (count < THREADS_MAX && count + 1 < cores && pthread_create(&threads[count], NULL, trace_rows, &j) == 0) count++;
    trace_rows(&j); /* this thread works too: with no other, it does it all */
    while (count > 0) pthread_join(threads[--count], NULL);
    pthread_mutex_destroy(&j.lock);
}

/* NULL: no device or no memory. Retains what it needs of the device. */
static RTCScene build_tree(RTCDevice device, const mesh *m)
{
    RTCScene    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    vec        *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec),
                                                  4 * m->count);
    unsigned   *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned),
                                                  m->count);
    unsigned    i;

    for (i = 0; corners && indices && i < 4 * m->count; i++) {
        corners[i] = m->corners[i];
        indices[i] = i;
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST); /* no ray slips between two quads */
    rtcCommitScene(scene);
    if (rtcGetDeviceError(device) == RTC_ERROR_NONE) return scene;
    rtcReleaseScene(scene);
    return NULL;
}

/* Everything but the tree, of a world that is all 0. 0: out of memory. */
static int build_world(world *w, const builtin *what)
{
    w->what = what;
    w->forward = vec_unit(vec_madd(what->target, what->eye, -1.0f));
    w->right = vec_unit(vec_cross(w->forward, vec_make(0.0f, 0.0f, 1.0f)));
    w->up = vec_cross(w->right, w->forward);
    w->eye = what->eye;
    if (what->sun.z > 0.0f) {
        w->sun = vec_unit(what->sun);
        find_basis(w->sun, &w->sun_u, &w->sun_v);
    }
    what->build(&w->shapes);
    return !w->shapes.failed;
}

/* move: m along right, up and forward. turn: radians to the left about up, after the move. */
static void move_camera(world *w, const float move[3], float turn)
{
    const vec right = w->right, forward = w->forward;

    w->eye = vec_madd(vec_madd(vec_madd(w->eye, right, move[0]), w->up, move[1]), forward, move[2]);
    w->forward = vec_madd(vec_scale(forward, cosf(turn)), right, -sinf(turn));
    w->right = vec_madd(vec_scale(right, cosf(turn)), forward, sinf(turn));
}

static void set_camera(const world *w, capture *cap)
{
    const float scale = 1.0f / tanf(w->what->half_fov);
    const vec   back = vec_scale(w->forward, -1.0f), axes[3] = {w->right, w->up, back};
    float      *p = cap->projection, *v = cap->view;
    int         r;

    cap->near_z = NEAR_Z;
    cap->far_z = FAR_Z;
    p[0] = scale * (float)cap->height / (float)cap->width;
    p[5] = -scale; /* row 0 is the top */
    p[10] = -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z);
    p[11] = -1.0f;
    p[14] = -2.0f * FAR_Z * NEAR_Z / (FAR_Z - NEAR_Z);
    for (r = 0; r < 3; r++) {
        v[r] = axes[r].x;
        v[4 + r] = axes[r].y;
        v[8 + r] = axes[r].z;
        v[12 + r] = -vec_dot(axes[r], w->eye);
    }
    v[15] = 1.0f;
}

static int make_images(capture *cap, int width, int height, int truth)
{
    cap->width = width;
    cap->height = height;
    return image_make(&cap->depth, width, height, 1) && image_make(&cap->normal, width, height, 3)
        && image_make(&cap->albedo, width, height, 3) && image_make(&cap->direct, width, height, 3)
        && image_make(&cap->emission, width, height, 3)
        && (!truth || (image_make(&cap->truth_ao, width, height, 1) && image_make(&cap->truth_near, width, height, 3)
                       && image_make(&cap->truth_far, width, height, 3)));
}

const char *capture_scene_name(int index)
{
    return index >= 0 && index < BUILTINS ? builtins[index].name : NULL;
}

/* NULL: there is none of that name, and error[] lists those that there are. */
static const builtin *find_builtin(const char *name, char *error, size_t error_size)
{
    char   list[256] = "";
    size_t used = 0;
    int    i;

    for (i = 0; i < BUILTINS; i++) {
        if (strcmp(name, builtins[i].name) == 0) return &builtins[i];
        if (used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", builtins[i].name);
    }
    frame_error(error, error_size, "no built-in scene %s. There is: %s", name, list);
    return NULL;
}

int capture_scene(capture *out, const char *name, int width, int height, int rays, void (*progress)(double),
                  char *error, size_t error_size)
{
    static const float still[3] = {0.0f, 0.0f, 0.0f};

    return capture_scene_from(out, name, still, 0.0f, width, height, rays, progress, error, error_size);
}

int capture_scene_from(capture *out, const char *name, const float move[3], float turn, int width, int height, int rays,
                       void (*progress)(double), char *error, size_t error_size)
{
    const builtin *what = find_builtin(name, error, error_size);
    RTCDevice      device;
    world          w;
    int            ok;

    memset(out, 0, sizeof *out);
    memset(&w, 0, sizeof w);
    if (!what) return 0;
    if (width < 1 || width > 16384 || height < 1 || height > 16384 || rays < 0 || rays > RAYS_MAX)
        return frame_error(error, error_size, "scene of %dx%d with %d rays: sizes must be in [1, 16384], rays in [0, %d]", width,
                           height, rays, RAYS_MAX);
    if (!make_images(out, width, height, rays > 0) || !build_world(&w, what)) {
        capture_free(out);
        mesh_free(&w.shapes);
        return frame_error(error, error_size, "scene of %dx%d: out of memory. Ask for a smaller one", width, height);
    }
    device = rtcNewDevice("threads=1"); /* threads of the build, not of the rays: one builds the same tree every time */
    w.tree = device ? build_tree(device, &w.shapes) : NULL;
    ok = w.tree != NULL;
    if (ok) {
        move_camera(&w, move, turn * PI / 180.0f);
        set_camera(&w, out);
        trace_all(&w, out, rays, progress);
        rtcReleaseScene(w.tree);
    } else {
        capture_free(out);
        frame_error(error, error_size, "Embree cannot start. Check that libembree3 fits this CPU, or give a frame file");
    }
    if (device) rtcReleaseDevice(device);
    mesh_free(&w.shapes);
    return ok;
}

int capture_scene_mesh(scene_mesh *out, const char *name, char *error, size_t error_size)
{
    const builtin *what = find_builtin(name, error, error_size);
    mesh           m;
    unsigned       q, t, c;

    memset(out, 0, sizeof *out);
    memset(&m, 0, sizeof m);
    if (!what) return 0;
    what->build(&m);
    out->corners = malloc(2 * m.count * 9 * sizeof *out->corners);
    out->albedo = malloc(2 * m.count * 3 * sizeof *out->albedo);
    out->emission = calloc(2 * m.count, 3 * sizeof *out->emission);
    if (m.failed || !out->corners || !out->albedo || !out->emission) {
        mesh_free(&m);
        scene_mesh_free(out);
        return frame_error(error, error_size, "scene %s: out of memory", name);
    }
    for (q = 0; q < m.count; q++)
        for (t = 0; t < 2; t++) { /* corners 0 1 2, then 0 2 3, unless 3 repeats 2 */
            const vec *p = m.corners + 4 * q;
            if (t == 1 && memcmp(&p[2], &p[3], sizeof *p) == 0) continue;
            for (c = 0; c < 3; c++) memcpy(out->corners + 9 * out->count + 3 * c, &p[c ? t + c : 0], sizeof *p);
            memcpy(out->albedo + 3 * out->count, reflectance[m.materials[q]], 3 * sizeof(float));
            if (m.materials[q] == LAMP) memcpy(out->emission + 3 * out->count, what->light, sizeof what->light);
            out->count++;
        }
    mesh_free(&m);
    return 1;
}

void scene_mesh_free(scene_mesh *m)
{
    free(m->corners);
    free(m->albedo);
    free(m->emission);
    memset(m, 0, sizeof *m);
}
