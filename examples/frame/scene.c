/* scene.c - the Cornell box, traced on the CPU: a frame with truth for machines that have no captures. */
#include "capture.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <embree3/rtcore.h>

#define PI 3.14159265f
#define SKY_DEPTH 1e10f       /* m */
#define OFFSET 1e-4f          /* m, of ray origins along the normal; float rounding in this scene is about 1e-6 m */
#define NEAR_Z 0.1f           /* m */
#define FAR_Z 100.0f          /* m */
#define HALF_FOV 0.34906585f  /* 20 degrees: half the vertical angle of view */
#define DIRECT_SAMPLES 256    /* shadow rays of a pixel's direct light; the same for all, so that plain surfaces show no noise */
#define BOUNCE_SAMPLES 4      /* shadow rays where a truth ray lands; random, averaged over the rays of a pixel */
#define RAYS_MAX 65536
#define THREADS_MAX 16

/* Cornell University's measured box: a unit is read as a centimetre here, so that the room is 5.5 m wide. x to the left as
 * the camera sees it, y up, z away from it. The lamp hangs 1 mm below the ceiling. */
enum { WHITE, RED, GREEN, LAMP };
static const float reflectance[4][3] = {{0.725f, 0.71f, 0.68f}, {0.63f, 0.065f, 0.05f}, {0.14f, 0.45f, 0.091f}, {0.0f, 0.0f, 0.0f}};
static const float lamp_radiance[3] = {17.0f, 12.0f, 4.0f};
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
#define QUADS ((unsigned)(sizeof quads / sizeof *quads))

typedef struct vec { float x, y, z; } vec;

static vec   vec_madd(vec a, vec b, float s) { vec r = {a.x + b.x * s, a.y + b.y * s, a.z + b.z * s}; return r; }
static float vec_dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec   vec_scale(vec a, float s) { vec r = {a.x * s, a.y * s, a.z * s}; return r; }

/* Cornell units to the world: metres, x right, y away from the camera, z up, origin below the camera's axis at the front. */
static vec to_world(float x, float y, float z)
{
    vec r = {(camera_at[0] - x) * 0.01f, z * 0.01f, y * 0.01f};
    return r;
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

/* ---- rays ------------------------------------------------------------------------------------------------------- */

typedef struct surface {
    vec   position, normal; /* normal: unit, towards where the ray came from */
    float t;
    int   material;
} surface;

/* 1: something is hit. direction need not have unit length: t counts in its lengths. */
static int trace(RTCScene scene, vec origin, vec direction, surface *hit)
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
    rtcIntersect1(scene, &context, &r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return 0;
    hit->t = r.ray.tfar;
    hit->position = vec_madd(origin, direction, hit->t);
    hit->normal.x = r.hit.Ng_x, hit->normal.y = r.hit.Ng_y, hit->normal.z = r.hit.Ng_z;
    length = sqrtf(vec_dot(hit->normal, hit->normal));
    hit->normal = vec_scale(hit->normal, (vec_dot(hit->normal, direction) > 0.0f ? -1.0f : 1.0f) / length);
    hit->material = quads[r.hit.primID].material;
    return 1;
}

/* 1: nothing lies between origin and origin + path, ends left out. */
static int is_clear(RTCScene scene, vec origin, vec path)
{
    struct RTCIntersectContext context;
    struct RTCRay              r;

    rtcInitIntersectContext(&context);
    memset(&r, 0, sizeof r);
    r.org_x = origin.x, r.org_y = origin.y, r.org_z = origin.z;
    r.dir_x = path.x, r.dir_y = path.y, r.dir_z = path.z;
    r.tfar = 1.0f - OFFSET;
    r.mask = ~0u;
    rtcOccluded1(scene, &context, &r);
    return r.tfar >= 0.0f; /* Embree sets it to -inf on a hit */
}

/* Form factor of the lamp, shadows included: E_direct = pi * lamp radiance * this. The lamp shines downwards only.
 * samples points of R2 on it, shifted by (shift_u, shift_v). */
static float lamp_view(RTCScene scene, const surface *at, uint32_t samples, uint32_t shift_u, uint32_t shift_v)
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

        if (facing > 0.0f && path.z > 0.0f && is_clear(scene, origin, path)) sum += facing * path.z / (r2 * r2);
    }
    return sum * area / (PI * (float)samples);
}

/* ---- one pixel -------------------------------------------------------------------------------------------------- */

/* Direction number i of a cosine-weighted set around the unit normal n. Basis: Duff et al. 2017. */
static vec cosine_direction(vec n, uint32_t i, uint32_t shift_u, uint32_t shift_v)
{
    const float u = unit(shift_u + i * R2_U), phi = 2.0f * PI * unit(shift_v + i * R2_V);
    const float x = sqrtf(u) * cosf(phi), y = sqrtf(u) * sinf(phi), z = sqrtf(1.0f - u);
    const float s = n.z < 0.0f ? -1.0f : 1.0f, a = -1.0f / (s + n.z), b = n.x * n.y * a;
    const vec   tangent = {1.0f + s * n.x * n.x * a, s * b, -s * n.x}, bitangent = {b, s + n.y * n.y * a, -n.y};

    return vec_madd(vec_madd(vec_scale(n, z), tangent, x), bitangent, y);
}

/* Cosine visibility, and E/pi of the direct light that the seen surfaces reflect: means over cosine-weighted rays. */
static void trace_truth(RTCScene scene, const surface *at, uint32_t pixel, int rays, float *ao, float near[3])
{
    const uint32_t shift_u = hash(2u * pixel), shift_v = hash(2u * pixel + 1u);
    const vec      origin = vec_madd(at->position, at->normal, OFFSET);
    double         open = 0.0, sum[3] = {0.0, 0.0, 0.0};
    surface        seen;
    int            i, c;

    for (i = 0; i < rays; i++) {
        if (!trace(scene, origin, cosine_direction(at->normal, (uint32_t)i, shift_u, shift_v), &seen)) {
            open += 1.0;
        } else if (seen.material != LAMP) {
            uint32_t shift = hash(shift_u + (uint32_t)i);
            float    view = lamp_view(scene, &seen, BOUNCE_SAMPLES, shift, hash(shift));
            for (c = 0; c < 3; c++) sum[c] += (double)(reflectance[seen.material][c] * lamp_radiance[c] * view);
        }
    }
    *ao = (float)(open / rays);
    for (c = 0; c < 3; c++) near[c] = (float)(sum[c] / rays);
}

static void trace_pixel(RTCScene scene, capture *cap, int x, int y, int rays)
{
    const size_t i = (size_t)y * (size_t)cap->width + (size_t)x;
    const float  ndc_x = 2.0f * ((float)x + 0.5f) / (float)cap->width - 1.0f;
    const float  ndc_y = 2.0f * ((float)y + 0.5f) / (float)cap->height - 1.0f; /* row 0, the top, is -1 */
    /* One metre along the axis of view, so that t is the linear depth. */
    const vec    direction = {ndc_x / cap->projection[0], 1.0f, ndc_y / cap->projection[5]};
    surface      at;
    float        view;
    int          c;

    cap->depth.data[i] = SKY_DEPTH; /* every other image is 0 there */
    if (!trace(scene, to_world(camera_at[0], camera_at[1], camera_at[2]), direction, &at)) return;
    cap->depth.data[i] = at.t;
    cap->normal.data[3 * i + 0] = at.normal.x;
    cap->normal.data[3 * i + 1] = at.normal.z;
    cap->normal.data[3 * i + 2] = -at.normal.y;
    if (at.material == LAMP) {
        memcpy(cap->emission.data + 3 * i, lamp_radiance, sizeof lamp_radiance);
        return;
    }
    view = lamp_view(scene, &at, DIRECT_SAMPLES, 0, 0);
    for (c = 0; c < 3; c++) {
        cap->albedo.data[3 * i + (size_t)c] = reflectance[at.material][c];
        cap->direct.data[3 * i + (size_t)c] = reflectance[at.material][c] * lamp_radiance[c] * view;
    }
    if (rays > 0) trace_truth(scene, &at, (uint32_t)i, rays, &cap->truth_ao.data[i], &cap->truth_near.data[3 * i]);
}

/* ---- the whole picture ------------------------------------------------------------------------------------------ */

typedef struct job {
    RTCScene        scene;
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

static void trace_all(RTCScene scene, capture *cap, int rays, void (*progress)(double))
{
    pthread_t threads[THREADS_MAX];
    long      cores = sysconf(_SC_NPROCESSORS_ONLN);
    int       count = 0;
    job       j;

    j.scene = scene, j.cap = cap, j.rays = rays, j.next_row = 0, j.progress = progress;
    pthread_mutex_init(&j.lock, NULL);
    while (count < THREADS_MAX && count + 1 < cores && pthread_create(&threads[count], NULL, trace_rows, &j) == 0) count++;
    trace_rows(&j); /* this thread works too: with no other, it does it all */
    while (count > 0) pthread_join(threads[--count], NULL);
    pthread_mutex_destroy(&j.lock);
}

/* NULL: no device or no memory. Retains what it needs of the device. */
static RTCScene build_scene(RTCDevice device)
{
    RTCScene    scene = rtcNewScene(device);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    vec        *corners = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(vec), 4 * QUADS);
    unsigned   *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(unsigned),
                                                  QUADS);
    unsigned    i;

    for (i = 0; corners && indices && i < 4 * QUADS; i++) {
        const float *p = quads[i / 4].corner[i % 4];
        corners[i] = to_world(p[0], p[1], p[2]);
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

static void set_camera(capture *cap)
{
    const float  scale = 1.0f / tanf(HALF_FOV);
    const vec    eye = to_world(camera_at[0], camera_at[1], camera_at[2]);
    float       *p = cap->projection, *v = cap->view;

    cap->near_z = NEAR_Z;
    cap->far_z = FAR_Z;
    p[0] = scale * (float)cap->height / (float)cap->width;
    p[5] = -scale; /* row 0 is the top */
    p[10] = -(FAR_Z + NEAR_Z) / (FAR_Z - NEAR_Z);
    p[11] = -1.0f;
    p[14] = -2.0f * FAR_Z * NEAR_Z / (FAR_Z - NEAR_Z);
    v[0] = 1.0f;  /* view x = world x */
    v[9] = 1.0f;  /* view y = world z */
    v[6] = -1.0f; /* view z = -world y */
    v[12] = -eye.x;
    v[13] = -eye.z;
    v[14] = eye.y;
    v[15] = 1.0f;
}

static int make_images(capture *cap, int width, int height, int truth)
{
    cap->width = width;
    cap->height = height;
    return image_make(&cap->depth, width, height, 1) && image_make(&cap->normal, width, height, 3)
        && image_make(&cap->albedo, width, height, 3) && image_make(&cap->direct, width, height, 3)
        && image_make(&cap->emission, width, height, 3)
        && (!truth || (image_make(&cap->truth_ao, width, height, 1) && image_make(&cap->truth_near, width, height, 3)));
}

const char *capture_scene_name(int index)
{
    return index == 0 ? "cornell" : NULL;
}

int capture_scene(capture *out, const char *name, int width, int height, int rays, void (*progress)(double),
                  char *error, size_t error_size)
{
    RTCDevice device;
    RTCScene  scene;

    memset(out, 0, sizeof *out);
    if (strcmp(name, capture_scene_name(0)) != 0)
        return frame_error(error, error_size, "no built-in scene %s. There is: %s", name, capture_scene_name(0));
    if (width < 1 || width > 16384 || height < 1 || height > 16384 || rays < 0 || rays > RAYS_MAX)
        return frame_error(error, error_size, "scene of %dx%d with %d rays: sizes must be in [1, 16384], rays in [0, %d]", width,
                           height, rays, RAYS_MAX);
    if (!make_images(out, width, height, rays > 0)) {
        capture_free(out);
        return frame_error(error, error_size, "scene of %dx%d: out of memory. Ask for a smaller one", width, height);
    }
    device = rtcNewDevice("threads=1"); /* threads of the build, not of the rays: one builds the same tree every time */
    scene = device ? build_scene(device) : NULL;
    if (scene) {
        set_camera(out);
        trace_all(scene, out, rays, progress);
        rtcReleaseScene(scene);
    } else {
        capture_free(out);
        frame_error(error, error_size, "Embree cannot start. Check that libembree3 fits this CPU, or give a frame file");
    }
    if (device) rtcReleaseDevice(device);
    return scene != NULL;
}
