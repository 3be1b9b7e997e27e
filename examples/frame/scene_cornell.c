/* scene_cornell.c - Cornell University's measured box. A unit is read as a centimetre here, so that the room is 5.5 m wide.
 * x to the left as the camera sees it, y up, z away from it. The lamp hangs 1 mm below the ceiling. */
#include "scene_internal.h"

enum { WHITE, RED, GREEN, LAMP };
static const float albedo[][3] = {
    {0.725f, 0.71f, 0.68f}, {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}, {0.0f, 0.0f, 0.0f},
};

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

/* To the world, whose origin lies below the camera's axis at the front of the box. */
static vec to_world(const float p[3]) { return vec_make((278.0f - p[0]) * 0.01f, p[2] * 0.01f, p[1] * 0.01f); }

static void build(mesh *m)
{
    unsigned i;

    for (i = 0; i < sizeof quads / sizeof *quads; i++) {
        const float (*p)[3] = quads[i].corner;
        mesh_quad(m, to_world(p[0]), to_world(p[1]), to_world(p[2]), to_world(p[3]), quads[i].material);
    }
}

const scene_builtin scene_cornell = {
    .name = "cornell", .build = build, .albedo = albedo,
    .eye = {0.0f, -8.0f, 2.73f}, .target = {0.0f, -7.0f, 2.73f}, .half_fov = 0.34906585f,
    .light = {17.0f, 12.0f, 4.0f}, .lamp = {{0.65f, 2.27f, 5.487f}, {-1.30f, 0.0f, 0.0f}, {0.0f, 1.05f, 0.0f}},
    .direct_samples = 256, .bounce_samples = 4,
};
