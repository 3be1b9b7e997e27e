/* scene.c - the built-in scenes, traced on the CPU: frames with truth for machines that have no captures. */
#include "capture.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <embree3/rtcore.h>

#include "scene_internal.h"

#define SKY_DEPTH 1e10f       /* m */
#define OFFSET 1e-4f          /* m, of ray origins along the normal; float rounding in these scenes is at most 1e-5 m */
#define NEAR_Z 0.1f           /* m */
#define FAR_Z 100.0f          /* m */
#define SUN_RADIUS 0.00465f   /* tangent of the angle between its centre and rim */

/* The R2 sequence (Roberts 2018) in 0.32 fixed point. */
#define R2_U 3242174889u
#define R2_V 2447445414u

#define RAYS_MAX 65536
#define THREADS_MAX 16

/* The sky of the captures: radiance mix(ground, zenith, 0.5 + 0.5 z) from the unit direction of height z. */
static const float sky_ground[3] = {0.30f, 0.22f, 0.14f}, sky_zenith[3] = {0.45f, 0.75f, 1.30f};

static const scene_builtin *const builtins[] = {&scene_cornell, &scene_fence, &scene_terrain, &scene_metals};
#define BUILTINS ((int)(sizeof builtins / sizeof *builtins))

/* A scene ready to be traced. */
typedef struct world {
    const scene_builtin *what;
    mesh                 shapes;
    RTCScene             tree;
    vec                  eye, right, forward, up; /* of the camera */
    vec                  sun, sun_u, sun_v;       /* unit, towards it and across */
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

static int is_lamp(const scene_builtin *what, int material) { return what->albedo[material][0] <= 0.0f; }

/* Form factor of the lamp, shadows included: E_direct = pi * lamp radiance * this. The lamp shines downwards only.
 * samples points of R2 on it, shifted by (shift_u, shift_v). */
static float lamp_view(const world *w, const surface *at, uint32_t samples, uint32_t shift_u, uint32_t shift_v)
{
    const vec  *lamp = w->what->lamp, across = vec_cross(lamp[1], lamp[2]);
    const float area = sqrtf(vec_dot(across, across)); /* m^2 */
    const vec   origin = vec_madd(at->position, at->normal, OFFSET);
    float       sum = 0.0f;
    uint32_t    i;

    for (i = 0; i < samples; i++) {
        float u = unit(shift_u + i * R2_U), v = unit(shift_v + i * R2_V);
        vec   p = vec_madd(vec_madd(lamp[0], lamp[1], u), lamp[2], v);
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

    vec_basis(n, &tangent, &bitangent);
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
        } else if (!is_lamp(w->what, seen.material)) {
            const uint32_t shift = hash(shift_u + (uint32_t)k);
            const float    view = light_view(w, &seen, w->what->bounce_samples, shift, hash(shift));
            const float *albedo = w->what->albedo[seen.material];
            for (c = 0; c < 3; c++) near[c] += (double)(albedo[c] * w->what->light[c] * view);
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
    const float *albedo;
    surface      at;
    float        view;
    int          c;

    cap->depth.data[i] = SKY_DEPTH; /* every other image is 0 there */
    if (!trace(w, w->eye, direction, &at)) return;
    cap->depth.data[i] = at.t;
    cap->normal.data[3 * i + 0] = vec_dot(w->right, at.normal);
    cap->normal.data[3 * i + 1] = vec_dot(w->up, at.normal);
    cap->normal.data[3 * i + 2] = -vec_dot(w->forward, at.normal);
    if (w->what->gloss) {
        memcpy(cap->f0.data + 3 * i, w->what->gloss[at.material].f0, 3 * sizeof(float));
        cap->roughness.data[i] = w->what->gloss[at.material].roughness;
    }
    if (is_lamp(w->what, at.material)) {
        memcpy(cap->emission.data + 3 * i, w->what->light, sizeof w->what->light);
        return;
    }
    albedo = w->what->albedo[at.material];
    view = light_view(w, &at, w->what->direct_samples, 0, 0);
    for (c = 0; c < 3; c++) {
        cap->albedo.data[3 * i + (size_t)c] = albedo[c];
        cap->direct.data[3 * i + (size_t)c] = albedo[c] * w->what->light[c] * view;
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
static int build_world(world *w, const scene_builtin *what)
{
    w->what = what;
    w->forward = vec_unit(vec_madd(what->target, what->eye, -1.0f));
    w->right = vec_unit(vec_cross(w->forward, vec_make(0.0f, 0.0f, 1.0f)));
    w->up = vec_cross(w->right, w->forward);
    w->eye = what->eye;
    if (what->sun.z > 0.0f) {
        w->sun = vec_unit(what->sun);
        vec_basis(w->sun, &w->sun_u, &w->sun_v);
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

static int make_images(capture *cap, int width, int height, int gloss, int truth)
{
    cap->width = width;
    cap->height = height;
    return image_make(&cap->depth, width, height, 1) && image_make(&cap->normal, width, height, 3)
        && image_make(&cap->albedo, width, height, 3) && image_make(&cap->direct, width, height, 3)
        && image_make(&cap->emission, width, height, 3)
        && (!gloss || (image_make(&cap->f0, width, height, 3) && image_make(&cap->roughness, width, height, 1)))
        && (!truth || (image_make(&cap->truth_ao, width, height, 1) && image_make(&cap->truth_near, width, height, 3)
                       && image_make(&cap->truth_far, width, height, 3)));
}

const char *capture_scene_name(int index)
{
    return index >= 0 && index < BUILTINS ? builtins[index]->name : NULL;
}

/* NULL: there is none of that name, and error[] lists those that there are. */
static const scene_builtin *find_builtin(const char *name, char *error, size_t error_size)
{
    char   list[256] = "";
    size_t used = 0;
    int    i;

    for (i = 0; i < BUILTINS; i++) {
        if (strcmp(name, builtins[i]->name) == 0) return builtins[i];
        if (used < sizeof list)
            used += (size_t)snprintf(list + used, sizeof list - used, "%s%s", i ? ", " : "", builtins[i]->name);
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
    const scene_builtin *what = find_builtin(name, error, error_size);
    RTCDevice      device;
    world          w;
    int            ok;

    memset(out, 0, sizeof *out);
    memset(&w, 0, sizeof w);
    if (!what) return 0;
    if (width < 1 || width > 16384 || height < 1 || height > 16384 || rays < 0 || rays > RAYS_MAX)
        return frame_error(error, error_size, "scene of %dx%d with %d rays: sizes must be in [1, 16384], rays in [0, %d]", width,
                           height, rays, RAYS_MAX);
    if (!make_images(out, width, height, what->gloss != NULL, rays > 0) || !build_world(&w, what)) {
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
    const scene_builtin *what = find_builtin(name, error, error_size);
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
            memcpy(out->albedo + 3 * out->count, what->albedo[m.materials[q]], 3 * sizeof(float));
            if (is_lamp(what, m.materials[q])) memcpy(out->emission + 3 * out->count, what->light, sizeof what->light);
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
