/* scene_fence.c - thin things over open ground, seen from above under the sky and a low sun: a fence, half pickets, half steel
 * rods; bean canes and a young tree whose leaves hang free in the air; a thick pot for contrast. A depth buffer shows the fronts
 * alone, and a height field lets each of them hide all that is behind it. So that this decides, and not what a screen cannot
 * know, the camera looks down: the ground that these things see and stand over fills the picture and goes on past its border,
 * without a sky.
 * True thickness, m: leaves and grass 0, stems and branches to 0.02, pickets, rods and canes 0.02, rails 0.03, trunk 0.05, posts
 * 0.06 and 0.09; stones and soil rise 0.02 above the ground. So 0.1 is the option thickness of this scene: all but ground and
 * pot is thinner. With less, light leaks through the ground between the steps of the march. */

#include <stddef.h>

#include "scene_internal.h"

enum { PAVING, STONE, PAINT, STEEL, WOOD, CLAY, SOIL, STEM, LEAF, YOUNG_LEAF, GRASS };
static const float albedo[][3] = {
    {0.40f, 0.36f, 0.31f}, {0.50f, 0.48f, 0.45f}, {0.80f, 0.79f, 0.75f}, {0.13f, 0.19f, 0.17f}, {0.46f, 0.32f, 0.19f},
    {0.58f, 0.25f, 0.14f}, {0.14f, 0.10f, 0.07f}, {0.22f, 0.17f, 0.09f}, {0.15f, 0.32f, 0.06f}, {0.27f, 0.44f, 0.10f},
    {0.24f, 0.36f, 0.09f},
};

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
    mesh_body(m, from, to, 5, material);
}

static void build_pickets(mesh *m, float left, float right)
{
    static const float pitch = 0.105f; /* m: half is gap */
    const float middle = 0.5f * (left + right), half = 0.5f * (right - left);
    dice        d = {1000};
    float       x;

    mesh_box(m, vec_make(middle, 0.025f, 0.27f), vec_make(half, 0.015f, 0.03f), 0.0f, PAINT);
    mesh_box(m, vec_make(middle, 0.025f, 0.80f), vec_make(half, 0.015f, 0.03f), 0.0f, PAINT);
    for (x = right; x > left - 0.1f; x -= 1.8f) {
        mesh_box(m, vec_make(x, 0.085f, 0.53f), vec_make(0.045f, 0.045f, 0.55f), 0.0f, PAINT);
        mesh_box(m, vec_make(x, 0.085f, 1.09f), vec_make(0.06f, 0.06f, 0.012f), 0.0f, PAINT);
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
        mesh_tube(m, vec_make(left, 0.085f, height[i]), vec_make(right, 0.085f, height[i]), 0.01f, 0.01f, 8, STEEL);
    for (x = left + 0.06f; x < right; x += 0.12f)
        mesh_tube(m, vec_make(x, 0.065f, 0.03f), vec_make(x, 0.065f, 1.08f), 0.01f, 0.01f, 8, STEEL);
    for (x = left + 1.8f; x <= right; x += 1.8f)
        mesh_tube(m, vec_make(x, 0.085f, -0.02f), vec_make(x, 0.085f, 1.14f), 0.03f, 0.03f, 16, STEEL);
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
        mesh_quad(m, base, rib[0], edge[0], edge[0], material);
        mesh_quad(m, rib[0], rib[1], edge[1], edge[0], material);
        mesh_quad(m, rib[1], rib[2], edge[1], edge[1], material);
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

        mesh_tube(m, p, q, r + 0.13f * radius, r, 5, STEM);
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

    mesh_tube(m, foot, vec_madd(foot, trunk, height), 0.025f, 0.012f, 10, STEM);
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
            mesh_tube(m, p, q, 0.004f, 0.004f, 4, STEM);
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
    mesh_tube(m, vec_make(x, y, 0.0f), vec_make(x, y, 0.26f), 0.12f, 0.17f, 24, CLAY);
    mesh_tube(m, vec_make(x, y, 0.26f), vec_make(x, y, 0.32f), 0.19f, 0.195f, 24, CLAY);
    mesh_tube(m, vec_make(x, y, 0.31f), vec_make(x, y, 0.325f), 0.17f, 0.17f, 24, SOIL);
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

        mesh_tube(m, foot, top, 0.01f, 0.009f, 8, WOOD);
        for (k = 1; k <= NODES; k++) {
            const float turn = 1.3f * (float)k;
            const vec   on = vec_madd(foot, vec_madd(top, foot, -1.0f), size * (float)k / NODES);
            const vec   aside = {cosf(turn), sinf(turn), between(d, -0.6f, 0.3f)};
            const vec   q = vec_madd(on, vec_make(aside.x, aside.y, 0.0f), 0.018f);
            const float length = between(d, 0.07f, 0.12f);

            mesh_tube(m, p, q, 0.003f, 0.003f, 4, STEM);
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

    mesh_box(m, vec_make(0.0f, 0.0f, -0.5f), vec_make(edge, edge, 0.5f), 0.0f, PAVING);
    mesh_box(m, vec_make(0.1f, 1.45f, 0.0f), vec_make(2.6f, 0.55f, 0.02f), 0.0f, SOIL);
    for (i = 0; i < 14; i++) {
        const float x = -2.8f + 0.43f * (float)i, bow = x - 0.3f;
        const vec   at = roughly(&d, vec_make(x, -1.35f + 0.1f * bow * bow, 0.0f), 0.04f);
        mesh_box(m, vec_make(at.x, at.y, 0.0f), vec_make(0.15f, 0.2f, 0.012f), 0.2f * bow, STONE);
    }
}

static void build(mesh *m)
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

const scene_builtin scene_fence = {
    .name = "fence", .build = build, .albedo = albedo,
    .eye = {0.9f, -4.2f, 3.4f}, .target = {0.1f, 0.2f, 0.5f}, .half_fov = 0.30f,
    .light = {2.9f, 2.45f, 1.85f}, .sun = {-0.55f, -0.72f, 0.55f}, .direct_samples = 16, .bounce_samples = 1,
};
