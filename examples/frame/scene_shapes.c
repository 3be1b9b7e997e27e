/* scene_shapes.c - shapes of the built-in scenes; see scene_internal.h */
#include <stdlib.h>
#include <string.h>

#include "scene_internal.h"

void mesh_free(mesh *m)
{
    free(m->corners);
    free(m->materials);
    memset(m, 0, sizeof *m);
}

void mesh_quad(mesh *m, vec a, vec b, vec c, vec d, int material)
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

void mesh_body(mesh *m, const vec *from, const vec *to, int sides, int material)
{
    int i;

    for (i = 0; i < sides; i++) mesh_quad(m, from[i], from[(i + 1) % sides], to[(i + 1) % sides], to[i], material);
    for (i = 2; i < sides; i++) {
        mesh_quad(m, from[0], from[i - 1], from[i], from[i], material);
        mesh_quad(m, to[0], to[i - 1], to[i], to[i], material);
    }
}

void mesh_box(mesh *m, vec centre, vec half, float turn, int material)
{
    const vec u = {half.x * cosf(turn), half.x * sinf(turn), 0.0f}, v = {-half.y * sinf(turn), half.y * cosf(turn), 0.0f};
    const vec bottom = {centre.x, centre.y, centre.z - half.z};
    vec       from[4], to[4];
    int       i;

    for (i = 0; i < 4; i++) {
        from[i] = vec_madd(vec_madd(bottom, u, i == 1 || i == 2 ? 1.0f : -1.0f), v, i >= 2 ? 1.0f : -1.0f);
        to[i] = vec_make(from[i].x, from[i].y, centre.z + half.z);
    }
    mesh_body(m, from, to, 4, material);
}

void mesh_tube(mesh *m, vec p, vec q, float r0, float r1, int sides, int material)
{
    vec from[SIDES_MAX], to[SIDES_MAX], u, v;
    int i;

    vec_basis(vec_unit(vec_madd(q, p, -1.0f)), &u, &v);
    for (i = 0; i < sides; i++) {
        const float turn = 2.0f * PI * ((float)i + 0.5f) / (float)sides;
        const vec   rim = vec_madd(vec_scale(u, cosf(turn)), v, sinf(turn));
        from[i] = vec_madd(p, rim, r0);
        to[i] = vec_madd(q, rim, r1);
    }
    mesh_body(m, from, to, sides, material);
}

void mesh_lathe(mesh *m, vec at, const vec *outline, int count, int sides, int material)
{
    vec ring[2][SIDES_MAX];
    int k, i;

    for (k = 0; k < count; k++) {
        const vec *to = ring[k % 2], *from = ring[(k + 1) % 2];

        for (i = 0; i < sides; i++) {
            const float turn = 2.0f * PI * (float)i / (float)sides, r = outline[k].x;
            ring[k % 2][i] = vec_madd(at, vec_make(r * cosf(turn), r * sinf(turn), outline[k].z), 1.0f);
        }
        if (outline[k].x > 0.0f) to = ring[(k + 1) % 2], from = ring[k % 2]; /* a ring that is a point comes last */
        for (i = 0; k > 0 && i < sides; i++)
            mesh_quad(m, from[i], from[(i + 1) % sides], to[(i + 1) % sides], to[i], material);
    }
}

void mesh_ball(mesh *m, vec centre, float radius, int sides, int material)
{
    vec       outline[SIDES_MAX / 2 + 1];
    const int last = sides / 2;
    int       k;

    for (k = 0; k <= last; k++) {
        const float turn = PI * (float)k / (float)last;
        outline[k] = vec_make(k % last ? radius * sinf(turn) : 0.0f, 0.0f, -radius * cosf(turn));
    }
    mesh_lathe(m, centre, outline, last + 1, sides, material);
}
