/* scene_metals.c - metals beside coloured walls, under sun and sky. What a surface mirrors it does not scatter: near
 * light that colours the walls means little on metals, and on gold another part of it is left than on steel. */
#include <stddef.h>

#include "scene_internal.h"

enum { FLOOR, BACK_WALL, SIDE_WALL, PLINTH, GLAZE, LACQUER, GOLD, COPPER, BRASS, STEEL, SILVER };

/* f0: of pure metals, linear Rec. 709; of all else that of glass and lacquer. Metals are cast, with a rough skin. */
#define MATT(roughness) {{0.04f, 0.04f, 0.04f}, roughness}
static const scene_gloss gloss[] = {
    MATT(0.9f), MATT(0.9f), MATT(0.9f), MATT(0.8f), MATT(0.15f), MATT(0.25f),
    {{1.00f, 0.78f, 0.34f}, 0.85f}, {{0.96f, 0.64f, 0.54f}, 0.85f}, {{0.91f, 0.78f, 0.42f}, 0.85f},
    {{0.56f, 0.57f, 0.58f}, 0.85f}, {{0.97f, 0.96f, 0.92f}, 0.85f},
};
/* Of metals: the little that the facets of a rough skin scatter among each other, 0.16 f0^2. */
static const float albedo[][3] = {
    {0.48f, 0.45f, 0.41f}, {0.10f, 0.36f, 0.42f}, {0.62f, 0.16f, 0.08f}, {0.66f, 0.63f, 0.58f},
    {0.80f, 0.78f, 0.72f}, {0.55f, 0.05f, 0.04f},
    {0.160f, 0.097f, 0.018f}, {0.147f, 0.066f, 0.047f}, {0.132f, 0.097f, 0.028f}, {0.050f, 0.052f, 0.054f},
    {0.151f, 0.147f, 0.135f},
};

static void build_room(mesh *m)
{
    mesh_box(m, vec_make(0.0f, 0.0f, -0.5f), vec_make(20.0f, 20.0f, 0.5f), 0.0f, FLOOR);
    mesh_box(m, vec_make(0.2f, 1.7f, 1.2f), vec_make(2.6f, 0.1f, 1.2f), 0.0f, BACK_WALL);
    mesh_box(m, vec_make(-2.3f, 0.2f, 1.2f), vec_make(0.1f, 1.4f, 1.2f), 0.0f, SIDE_WALL);
    mesh_box(m, vec_make(0.0f, 0.7f, 0.2f), vec_make(1.5f, 0.6f, 0.2f), 0.0f, PLINTH);
    mesh_box(m, vec_make(-0.7f, 1.0f, 0.5f), vec_make(0.6f, 0.3f, 0.1f), 0.0f, PLINTH);
}

/* A vase or a bowl: its radius is a stretch of a sine, from one angle to another. */
static void add_vessel(mesh *m, vec at, float height, float radius, float swell, float from, float to, int material)
{
    enum { LAST = 32 };
    vec outline[LAST + 1];
    int k;

    for (k = 0; k <= LAST; k++) {
        const float up = (float)k / LAST;
        outline[k] = vec_make(k ? radius + swell * sinf(from + (to - from) * up) : 0.0f, 0.0f, height * up);
    }
    mesh_lathe(m, at, outline, LAST + 1, 72, material);
}

static void build_stacks(mesh *m)
{
    int i, row;

    for (row = 0; row < 3; row++) /* ingots */
        for (i = 0; i < 3 - row; i++)
            mesh_box(m, vec_make(-0.55f + 0.22f * ((float)i + 0.5f * (float)row), -0.2f, 0.06f + 0.12f * (float)row),
                     vec_make(0.09f, 0.22f, 0.06f), 0.0f, BRASS);
    for (i = 0; i < 7; i++) { /* pipes that lean on the wall */
        const float x = 1.55f + 0.12f * (float)i, length = 1.2f + 0.1f * (float)(i * 5 % 7);
        mesh_tube(m, vec_make(x, 1.15f, 0.0f), vec_make(x + 0.1f, 1.54f, length), 0.045f, 0.045f, 24,
                  i % 3 == 1 ? COPPER : STEEL);
    }
}

static void build(mesh *m)
{
    static const struct { vec centre; float radius; int material; } balls[] = {
        {{0.15f, 0.55f, 0.72f}, 0.32f, GOLD},     {{-0.55f, 0.35f, 0.57f}, 0.17f, GLAZE},
        {{0.85f, 0.35f, 0.52f}, 0.12f, LACQUER},  {{-0.35f, 0.95f, 0.70f}, 0.10f, LACQUER},
        {{-1.15f, -0.25f, 0.16f}, 0.16f, STEEL},  {{0.55f, -0.35f, 0.11f}, 0.11f, COPPER},
    };
    size_t i;

    build_room(m);
    build_stacks(m);
    for (i = 0; i < sizeof balls / sizeof *balls; i++)
        mesh_ball(m, balls[i].centre, balls[i].radius, SIDES_MAX, balls[i].material);
    add_vessel(m, vec_make(-0.85f, 1.0f, 0.6f), 0.62f, 0.13f, 0.06f, -0.8f, 5.8f, COPPER);
    add_vessel(m, vec_make(1.05f, 0.75f, 0.4f), 0.20f, 0.08f, 0.20f, 0.0f, 1.5f, SILVER);
}

const scene_builtin scene_metals = {
    .name = "metals", .build = build, .albedo = albedo, .gloss = gloss,
    .eye = {0.5f, -3.6f, 1.65f}, .target = {0.05f, 0.5f, 0.62f}, .half_fov = 0.30f,
    .light = {2.9f, 2.45f, 1.85f}, .sun = {0.55f, -0.62f, 0.60f}, .direct_samples = 16, .bounce_samples = 1,
};
