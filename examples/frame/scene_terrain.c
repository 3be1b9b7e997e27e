/* scene_terrain.c - open country under the sky and a low sun: turf with boulders, ridges of rock 20 to 90 m away.
 * All of it is thick and faces up: a depth buffer shows nearly all that there is. */
#include "scene_internal.h"

#define REACH  94.0f  /* m, radius of the ground */
#define CELL   0.05f  /* m, of the ground's grid at the origin */
#define GROWTH 0.013f /* what a cell gains with each metre of distance, m */

enum { TURF, MEADOW, HEATH, SOIL, ROCK, SCREE };
static const float albedo[][3] = {
    {0.19f, 0.27f, 0.08f}, {0.25f, 0.31f, 0.10f}, {0.30f, 0.25f, 0.12f}, {0.26f, 0.19f, 0.12f}, {0.38f, 0.34f, 0.30f},
    {0.47f, 0.43f, 0.37f},
};

/* In [0, 1): random values at whole coordinates, between them Perlin's smooth blend (2002). */
static float noise(vec p)
{
    const float at[3] = {p.x, p.y, p.z};
    uint32_t    cell[3];
    float       t[3], sum = 0.0f;
    uint32_t    corner, c;

    for (c = 0; c < 3; c++) {
        const float whole = floorf(at[c]), x = at[c] - whole;
        cell[c] = (uint32_t)(int32_t)whole;
        t[c] = x * x * x * (x * (6.0f * x - 15.0f) + 10.0f);
    }
    for (corner = 0; corner < 8; corner++) {
        uint32_t key = 0;
        float    weight = 1.0f;

        for (c = 0; c < 3; c++) {
            const uint32_t far = corner >> c & 1u;
            key = hash(key + cell[c] + far);
            weight *= far ? t[c] : 1.0f - t[c];
        }
        sum += weight * unit(key);
    }
    return sum;
}

/* Musgrave's ridged multifractal (1994), rough where it is high, smooth in valleys; waves of longest to shortest m. */
static float relief(vec p, float longest, float shortest)
{
    float wave, sum = 0.0f, weight = 1.0f;

    for (wave = longest; wave > shortest; wave *= 0.5f) {
        const float ridge = 1.0f - fabsf(2.0f * noise(vec_scale(p, 1.0f / wave)) - 1.0f);
        const float fade = fminf(wave / shortest - 1.0f, 1.0f); /* no edge where the next wave begins */

        sum += fade * weight * ridge * ridge * wave;
        weight = fminf(2.0f * weight * ridge, 1.0f);
        p = vec_make(0.8f * p.x - 0.6f * p.y + 37.0f, 0.6f * p.x + 0.8f * p.y + 17.0f, p.z); /* no lattice shows */
    }
    return sum;
}

/* The point of the ground there: at height 0 below the camera, higher with the distance. */
static vec ground(float x, float y)
{
    const float r2 = x * x + y * y, rise = r2 / (r2 + 1600.0f);
    const float shortest = 3.0f * (CELL + GROWTH * sqrtf(r2));

    return vec_make(x, y, rise * (0.5f * relief(vec_make(x, y, 3.0f), 32.0f, shortest) - 5.0f));
}

/* What grows or lies on a piece of ground: by its slope and height, in ragged patches. */
static int pick_cover(vec a, vec b, vec c)
{
    const vec   n = vec_unit(vec_cross(vec_madd(b, a, -1.0f), vec_madd(c, a, -1.0f)));
    const float patch = noise(vec_scale(a, 0.3f)) + 0.5f * noise(vec_scale(a, 1.7f)) - 0.75f;
    const float steep = 1.0f - fabsf(n.z) + 0.05f * patch, high = a.z + 4.0f * patch;

    if (steep > 0.22f) return high > 8.0f ? SCREE : ROCK;
    if (steep > 0.15f) return SOIL;
    if (high > 4.0f) return HEATH;
    return patch > 0.1f ? MEADOW : TURF;
}

/* Rings about the camera, finest where it looks. */
static void build_ground(mesh *m)
{
    enum { FRONT = 240, BACK = 60, SPOKES = FRONT + BACK };
    const float half = 0.8f; /* radians to either side of +y that are FRONT */
    float       r, wide;
    int         i;

    for (r = 0.0f; r < REACH; r = wide) {
        wide = r + CELL + GROWTH * r;
        for (i = 0; i < SPOKES; i++) {
            vec corner[4];
            int c;

            for (c = 0; c < 4; c++) { /* both of the inner ring last: at r = 0 they are one */
                const int   k = (i + (c == 1 || c == 2)) % SPOKES;
                const float turn = k < FRONT ? half * (2.0f * (float)k / FRONT - 1.0f)
                                             : half + (2.0f * PI - 2.0f * half) * (float)(k - FRONT) / BACK;
                const float at = c < 2 ? wide : r;
                corner[c] = ground(at * sinf(turn), at * cosf(turn));
            }
            mesh_quad(m, corner[0], corner[1], corner[2], corner[3], pick_cover(corner[0], corner[1], corner[2]));
        }
    }
}

/* A ball dented by noise, a third of it in the ground. */
static void add_boulder(mesh *m, vec foot, float radius, int material)
{
    const vec centre = vec_madd(foot, vec_make(0.0f, 0.0f, 1.0f), 0.3f * radius);
    unsigned  i = 4 * m->count;

    mesh_ball(m, centre, 1.0f, 36, material);
    for (; i < 4 * m->count; i++) {
        const vec   out = vec_madd(m->corners[i], centre, -1.0f);
        const float size = radius * (0.55f + 0.5f * relief(vec_madd(out, centre, 1.0f), 1.0f, 0.1f));
        m->corners[i] = vec_madd(centre, vec_make(out.x, out.y, 0.8f * out.z), size);
    }
}

static void build(mesh *m)
{
    dice d = {2};
    int  i;

    build_ground(m);
    for (i = 0; i < 60; i++) {
        const float turn = between(&d, -0.75f, 0.75f), at = between(&d, 0.0f, 1.0f), distance = 4.5f + 55.0f * at * at;
        const float radius = between(&d, 0.12f, 0.3f) * (1.0f + 0.05f * distance);
        add_boulder(m, ground(distance * sinf(turn), distance * cosf(turn)), radius, i % 3 ? ROCK : SCREE);
    }
}

const scene_builtin scene_terrain = {
    .name = "terrain", .build = build, .albedo = albedo,
    .eye = {0.0f, 0.0f, 2.4f}, .target = {0.0f, 20.0f, 1.6f}, .half_fov = 0.33f,
    .light = {2.9f, 2.45f, 1.85f}, .sun = {-0.80f, -0.15f, 0.45f}, .direct_samples = 16, .bounce_samples = 1,
};
