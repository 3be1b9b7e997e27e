/* random_frame.c - draws configs from the option table, cameras of all conventions, and inputs region by region. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "random_frame.h"

const char *const case_inputs[CASE_INPUTS] = { "depth", "normal", "radiance", "motion", "direct", "albedo", "f0", "roughness",
                                               "sky", "probes" };

const char case_hook[] =
    "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
    "    if (direction.x > 0.8) return vec3(uintBitsToFloat(0x7fc00000u), uintBitsToFloat(0x7f800000u), -1.0);\n"
    "    if (direction.y > 0.8) return position * 1e30;\n"
    "    return vec3(0.5 + 0.5 * direction.z * cos_aperture);\n"
    "}\n";

uint64_t rng_next(rng *r) /* splitmix64 */
{
    uint64_t z = r->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

int    rng_below(rng *r, int n) { return (int)(rng_next(r) % (uint64_t)n); }
double rng_unit(rng *r)         { return (double)(rng_next(r) >> 11) / 9007199254740992.0; }
double rng_log(rng *r, double low, double high) { return low * exp(rng_unit(r) * log(high / low)); }

/* ------------------------------------------------------------------------------------------------------------- configs */

static void set_member(hbil_config *c, const hbil_option *o, const void *value)
{
    memcpy((char *)c + o->offset, value, 4);
}

/* The ends as often as all between. */
static double random_number(rng *r, const hbil_option *o)
{
    const int kind = rng_below(r, 6);
    const double v = rng_log(r, o->min, o->max);
    return kind == 0 ? o->min : kind == 1 ? o->max : v < o->min ? o->min : v > o->max ? o->max : v;
}

static void random_value(rng *r, const hbil_option *o, hbil_config *c)
{
    uint32_t set = (uint32_t)rng_next(r) & (rng_below(r, 2) ? (uint32_t)rng_next(r) & (uint32_t)rng_next(r) : ~0u) & (uint32_t)o->max;
    int32_t whole;
    float number;
    switch (o->kind) {
    case HBIL_KIND_SET:
        if (rng_below(r, 8) == 0) set = (uint32_t)o->max;
        set_member(c, o, &set);
        break;
    case HBIL_KIND_FLOAT:
        number = (float)random_number(r, o);
        set_member(c, o, &number);
        break;
    default:
        whole = o->kind == HBIL_KIND_CHOICE ? (int32_t)o->min + rng_below(r, (int)(o->max - o->min) + 1) : (int32_t)random_number(r, o);
        set_member(c, o, &whole);
    }
}

/* Combinations that the library refuses are moved to legal ones, by the fixes that its errors name. */
static int repair(hbil_config *c, hbil_config *out)
{
    hbil_diag items[16];
    int round, i;
    if (c->reach == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_REACH; /* 0 stands for a shader without it */
    if (c->firefly == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_FIREFLY;
    if (c->roughness == 0) c->dynamic &= ~(uint32_t)HBIL_DYNAMIC_ROUGHNESS;
    for (round = 0; round < 16; ++round) {
        hbil_diags diags = { items, 16, 0 };
        if (hbil_config_resolve(c, out, &diags) == HBIL_OK) return 1;
        for (i = 0; i < diags.count && i < diags.capacity; ++i) {
            const char *fix = strstr(items[i].text, "; set ");
            if (items[i].severity != HBIL_ERROR) continue;
            if (!fix || hbil_config_parse(c, fix + 6, strlen(fix + 6), NULL) != HBIL_OK) return 0;
            break;
        }
    }
    return 0;
}

/* Costs without an end in sight: the loops of the march, which Mesa stops after 65535 iterations. */
static void bound_cost(rng *r, hbil_config *c)
{
    if (rng_below(r, 4) && c->slices > 4) c->slices = 1 + rng_below(r, 4);
    if (rng_below(r, 4) && c->steps > 12) c->steps = 1 + rng_below(r, 12);
    while ((c->slices ? c->slices : 16) * (c->steps ? c->steps : 6) > 16000) c->steps /= 2; /* 16: a sweep's default */
}

int random_config(rng *r, int32_t target, hbil_config *out)
{
    static const int densities[] = { 10, 25, 50, 100 };
    const int percent = densities[rng_below(r, 4)];
    hbil_config c;
    int32_t i;
    memset(&c, 0, sizeof c);
    for (i = 0; i < hbil_option_count(); ++i)
        if (rng_below(r, 100) < percent) random_value(r, hbil_option_at(i), &c);
    if (rng_below(r, 2)) c.dynamic = 0;
    if (c.width || c.height) {
        c.width = 1 + rng_below(r, rng_below(r, 2) ? 200 : 8);
        c.height = 1 + rng_below(r, rng_below(r, 2) ? 120 : 8);
    }
    c.target = target;
    if (c.sample) c.sample = 1 + rng_below(r, 3); /* RUNNER_SAMPLES */
    if (target == HBIL_TARGET_VULKAN) c.stage = 0;
    if (target == HBIL_TARGET_GLES) c.multisample = c.sample = 0; /* the runner cannot fill them */
    bound_cost(r, &c);
    if (!repair(&c, out)) return 0;
    return out->target == target;
}

/* Values of the options that are uniforms. */
static void random_live(rng *r, const hbil_config *config, hbil_config *live)
{
    int32_t i;
    memset(live, 0, sizeof *live);
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        if (config->dynamic & o->dynamic && rng_below(r, 4)) random_value(r, o, live);
    }
    if (live->slices > 8 && rng_below(r, 4)) live->slices = 1 + rng_below(r, 8);
    if (live->steps > 16 && rng_below(r, 4)) live->steps = 1 + rng_below(r, 16);
    while ((live->slices || live->steps) && (live->slices ? live->slices : config->slices) * (live->steps ? live->steps : config->steps) > 16000)
        *(live->steps ? &live->steps : &live->slices) /= 2;
}

/* ------------------------------------------------------------------------------------------------------------- cameras */

/* What the inputs need of a camera. near_z, far_z: of the scene too. */
typedef struct camera { double near_z, far_z, view_z; const hbil_config *config; const hbil_frame *frame; } camera;

static void random_rotation(rng *r, double m[9])
{
    double q[4], l = 0;
    int i;
    for (i = 0; i < 4; ++i) q[i] = rng_unit(r) - 0.5, l += q[i] * q[i];
    for (i = 0; i < 4; ++i) q[i] /= sqrt(l + 1e-12);
    m[0] = 1 - 2 * (q[1] * q[1] + q[2] * q[2]); m[1] = 2 * (q[0] * q[1] - q[2] * q[3]); m[2] = 2 * (q[0] * q[2] + q[1] * q[3]);
    m[3] = 2 * (q[0] * q[1] + q[2] * q[3]); m[4] = 1 - 2 * (q[0] * q[0] + q[2] * q[2]); m[5] = 2 * (q[1] * q[2] - q[0] * q[3]);
    m[6] = 2 * (q[0] * q[2] - q[1] * q[3]); m[7] = 2 * (q[1] * q[2] + q[0] * q[3]); m[8] = 1 - 2 * (q[0] * q[0] + q[1] * q[1]);
}

static void random_view(rng *r, float view[16])
{
    const double far_away = rng_log(r, 1e-3, 1e7);
    double m[9];
    int i, k;
    memset(view, 0, 16 * sizeof *view);
    view[0] = view[5] = view[10] = view[15] = 1;
    if (rng_below(r, 4) == 0) return;
    random_rotation(r, m);
    for (i = 0; i < 3; ++i)
        for (k = 0; k < 3; ++k) view[4 * k + i] = (float)m[3 * i + k];
    for (i = 0; i < 3; ++i) view[12 + i] = (float)((2 * rng_unit(r) - 1) * far_away);
}

/* Row 2: ndc z of the depth, with w = depth or 1. */
static void depth_row(const hbil_config *c, const camera *cam, float *p)
{
    const double low = c->clip == HBIL_CLIP_GL ? -1 : 0, n = cam->near_z, f = cam->far_z;
    const int reversed = c->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    const double ndc_near = reversed ? 1 : low, ndc_far = reversed ? low : 1;
    if (c->projection == HBIL_PROJECTION_ORTHOGRAPHIC) {
        const double a = (ndc_far - ndc_near) / (f - n);
        p[10] = (float)(a * cam->view_z);
        p[14] = (float)(ndc_near - a * n);
    } else {
        const double b = c->depth_far == HBIL_DEPTH_FAR_INFINITE ? (ndc_near - ndc_far) * n : (ndc_near - ndc_far) / (1 / n - 1 / f);
        p[10] = (float)((ndc_far - (c->depth_far == HBIL_DEPTH_FAR_INFINITE ? 0 : b / f)) * cam->view_z);
        p[14] = (float)b;
    }
}

static void random_projection(rng *r, const hbil_config *c, const camera *cam, hbil_frame *f)
{
    static const double fovs[] = { 1, 10, 60, 90, 120, 170 };
    const double fov = rng_below(r, 2) ? fovs[rng_below(r, 6)] : rng_log(r, 1, 170);
    const double y = 1 / tan(fov * 0.00872664626), x = y * (rng_below(r, 4) ? (double)f->height / f->width : rng_log(r, 0.1, 10));
    const double shift = rng_below(r, 3) == 0 ? 1 : rng_below(r, 2) ? 1.0 / f->width : 0, size = rng_log(r, 1e-2, 1e3);
    float *p = f->projection;
    memset(p, 0, 16 * sizeof *p);
    if (c->projection == HBIL_PROJECTION_ORTHOGRAPHIC) {
        p[0] = (float)(x / size);
        p[5] = (float)(y / size);
        p[12] = (float)(shift * (2 * rng_unit(r) - 1));
        p[13] = (float)(shift * (2 * rng_unit(r) - 1));
        p[15] = 1;
    } else {
        p[0] = (float)x;
        p[5] = (float)y;
        p[8] = (float)(shift * (2 * rng_unit(r) - 1));
        p[9] = (float)(shift * (2 * rng_unit(r) - 1));
        p[11] = (float)cam->view_z;
    }
    if (rng_below(r, 2)) p[5] = -p[5];
    depth_row(c, cam, p);
}

/* Far light: finite numbers only, others are refused. */
static void random_environment(rng *r, hbil_frame *f)
{
    static const float odd[] = { 0, 1, -1, 65504, 1e30f, FLT_MAX, -FLT_MAX, 1e-40f };
    const double size = rng_log(r, 1e-3, 1e6);
    int i, k;
    for (k = 0; k < 3; ++k) {
        f->far_color[k] = rng_below(r, 4) ? (float)rng_unit(r) : odd[rng_below(r, 8)];
        f->probe_origin[k] = (float)((rng_unit(r) - 0.5) * size);
        f->probe_step[k] = (float)rng_log(r, 1e-5, 1e5);
        for (i = 0; i < 9; ++i) f->far_sh[i][k] = rng_below(r, 8) ? (float)(rng_unit(r) - 0.3) : odd[rng_below(r, 8)];
    }
}

/* xy of the ray through a pixel centre at depth 1, or at any depth, in view space. */
static void ray_at(const camera *cam, double x, double y, double out[2])
{
    const float *p = cam->frame->projection;
    const int perspective = cam->config->projection == HBIL_PROJECTION_PERSPECTIVE;
    const double nx = 2 * (x + 0.5) / cam->frame->width - 1, ny = 2 * (y + 0.5) / cam->frame->height - 1;
    out[0] = (nx - (perspective ? cam->view_z * (double)p[8] : (double)p[12])) / (double)p[0];
    out[1] = (ny - (perspective ? cam->view_z * (double)p[9] : (double)p[13])) / (double)p[5];
}

/* View space, z into the screen. */
static void point_at(const camera *cam, double x, double y, double z, double out[3])
{
    double ray[2];
    ray_at(cam, x, y, ray);
    out[0] = cam->config->projection == HBIL_PROJECTION_PERSPECTIVE ? ray[0] * z : ray[0];
    out[1] = cam->config->projection == HBIL_PROJECTION_PERSPECTIVE ? ray[1] * z : ray[1];
    out[2] = z;
}

/* What a renderer's depth buffer has for a depth, float arithmetic of the matrix included. */
static float raw_depth(const camera *cam, double z)
{
    const float *p = cam->frame->projection;
    double v;
    if (cam->config->depth == HBIL_DEPTH_LINEAR) return (float)z;
    v = (double)p[10] * cam->view_z * z + (double)p[14];
    if (cam->config->projection == HBIL_PROJECTION_PERSPECTIVE) v /= z;
    if (cam->config->clip == HBIL_CLIP_GL) v = 0.5 * v + 0.5;
    return v < 0 ? 0.0f : v > 1 ? 1.0f : (float)v;
}

/* -------------------------------------------------------------------------------------------------------------- depth */

/* What a region of the screen looks like. */
typedef struct region { int x0, y0, x1, y1, pattern, block; double a, b, c; uint64_t salt; } region;

static region random_region(rng *r, int width, int height, int first, int patterns)
{
    region g;
    memset(&g, 0, sizeof g);
    g.x1 = width;
    g.y1 = height;
    if (!first) {
        g.x0 = rng_below(r, width);
        g.y0 = rng_below(r, height);
        g.x1 = g.x0 + 1 + rng_below(r, width - g.x0);
        g.y1 = g.y0 + 1 + rng_below(r, height - g.y0);
    }
    g.pattern = rng_below(r, patterns);
    g.block = 1 << rng_below(r, 5);
    g.a = rng_unit(r);
    g.b = rng_unit(r);
    g.c = rng_unit(r);
    g.salt = rng_next(r);
    return g;
}

/* The last region that covers a pixel. */
static const region *region_at(const region *g, int n, int x, int y)
{
    while (--n > 0 && !(x >= g[n].x0 && x < g[n].x1 && y >= g[n].y0 && y < g[n].y1)) { }
    return &g[n];
}

/* [0, 1) of a place, the same every time. */
static double hashed(const region *g, int x, int y)
{
    rng r = { g->salt ^ (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu };
    return rng_unit(&r);
}

static const float odd_depths[] = { 0, 1, 1e-40f, FLT_MIN, -1, -1e30f, INFINITY, -INFINITY, NAN, FLT_MAX, 1e15f, 9.99e14f, 1e9f,
                                    0.99999994f, 5.9604645e-8f, 0.5f, 1e-20f, 2, -1e-40f };

static float odd_depth(double u)
{
    return odd_depths[(int)(u * (sizeof odd_depths / sizeof *odd_depths))];
}

/* 11 patterns; m, of the surface at a pixel. */
static double depth_of(const camera *cam, const region *g, int x, int y)
{
    const double n = cam->near_z * 1.01, f = fmin(cam->far_z, 1e14), z0 = n * pow(f / n, g->a * g->a), u = 2 * g->b - 1, v = 2 * g->c - 1;
    const double sx = (2.0 * x + 1) / cam->frame->width - 1, sy = (2.0 * y + 1) / cam->frame->height - 1;
    switch (g->pattern) {
    case 0: return z0;
    case 1: return z0 / fmax(1 + u * sx + v * sy, 1e-6);                       /* a plane */
    case 2: return z0 * (1 + 1e3 * u * u * u * sx + v * sy);                   /* steep, and behind the eye */
    case 3: return z0 * exp(pow(10, 6 * g->b - 6) * (hashed(g, x, y) - 0.5));  /* noise: of rounding to wild */
    case 4: return n * pow(f / n, hashed(g, x / g->block, y / g->block));      /* cliffs */
    case 5: return (x / g->block + y / g->block) & 1 ? z0 : n * pow(f / n, g->b);
    case 6: return hashed(g, x, y) < 0.03 ? n * pow(f / n, g->b) : z0;         /* spikes */
    case 7: return z0 * exp(10 * u * sy);                                      /* grazing */
    case 8: {                                                                  /* a ball before a wall */
        const double d2 = (sx - u) * (sx - u) + (sy - v) * (sy - v);
        return d2 < 0.5 ? z0 * (1 - 0.9 * sqrt(0.5 - d2)) : z0 * 2;
    }
    case 9: return z0 * (1 + 1e-7 * x);                                        /* one ulp a pixel */
    default: return n + (f - n) * hashed(g, x, y);
    }
}

enum { DEPTHS = 11, REGIONS = 4 };

/* z: the same in metres, for normals that fit. */
static void fill_depth(rng *r, const camera *cam, image *out, double *z)
{
    region g[REGIONS];
    const int n = 1 + rng_below(r, REGIONS), odd = rng_below(r, 3);
    int i, x, y;
    for (i = 0; i < n; ++i) {
        g[i] = random_region(r, out->width, out->height, i == 0, DEPTHS);
        if (odd && rng_below(r, 4) == 0) g[i].pattern = DEPTHS + rng_below(r, 2);
    }
    for (y = 0; y < out->height; ++y)
        for (x = 0; x < out->width; ++x) {
            const region *at = region_at(g, n, x, y);
            float *to = &out->data[y * out->width + x];
            z[y * out->width + x] = depth_of(cam, at, x, y);
            *to = at->pattern < DEPTHS ? raw_depth(cam, z[y * out->width + x]) : odd_depth(at->pattern == DEPTHS ? at->a : hashed(at, x, y));
            if (odd == 2 && rng_below(r, 64) == 0) *to = odd_depth(rng_unit(r));
        }
}

/* ------------------------------------------------------------------------------------------------------------- normals */

static void fold(const double n[3], double out[2])
{
    const double l1 = fmax(fabs(n[0]) + fabs(n[1]) + fabs(n[2]), 1e-20), x = n[0] / l1, y = n[1] / l1;
    out[0] = n[2] < 0 ? (1 - fabs(y)) * (x < 0 ? -1 : 1) : x;
    out[1] = n[2] < 0 ? (1 - fabs(x)) * (y < 0 ? -1 : 1) : y;
}

static int normal_channels(int32_t encoding)
{
    return encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL || encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM ||
           encoding == HBIL_NORMAL_ENCODING_XY || encoding == HBIL_NORMAL_ENCODING_XY_UNORM ? 2 : 3;
}

static void encode(const double n[3], int32_t encoding, float *out)
{
    const int unorm = encoding == HBIL_NORMAL_ENCODING_XYZ_UNORM || encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM ||
                      encoding == HBIL_NORMAL_ENCODING_XY_UNORM;
    const int octahedral = encoding >= HBIL_NORMAL_ENCODING_OCTAHEDRAL && encoding <= HBIL_NORMAL_ENCODING_OCTAHEDRAL_888;
    double o[3] = { n[0], n[1], n[2] };
    int k;
    if (octahedral) fold(n, o);
    if (encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL_888) {
        const double sx = fmin(fmax(o[0] * 0.5 + 0.5, 0), 1), sy = fmin(fmax(o[1] * 0.5 + 0.5, 0), 1); /* NaN is 0 */
        const unsigned x = (unsigned)(sx * 4095 + 0.5), y = (unsigned)(sy * 4095 + 0.5);
        out[0] = (float)(x & 255u) / 255.0f;
        out[1] = (float)(y & 255u) / 255.0f;
        out[2] = (float)(x >> 8 | y >> 8 << 4) / 255.0f;
        return;
    }
    for (k = 0; k < normal_channels(encoding); ++k) out[k] = (float)(unorm ? o[k] * 0.5 + 0.5 : o[k]);
}

/* z into the screen to the space that the config wants, encoded. */
static void store_normal(const camera *cam, const double n[3], float *out)
{
    const float *m = cam->frame->view;
    double v[3] = { n[0], n[1], n[2] * cam->view_z }, w[3];
    int k;
    for (k = 0; k < 3; ++k) w[k] = (double)m[4 * k] * v[0] + (double)m[4 * k + 1] * v[1] + (double)m[4 * k + 2] * v[2];
    encode(cam->config->normals == HBIL_NORMALS_WORLD ? w : v, cam->config->normal_encoding, out);
}

static void normal_of_depth(const camera *cam, const image *out, const double *z, int x, int y, double n[3])
{
    const int x1 = x + 1 < out->width ? x + 1 : x - 1, y1 = y + 1 < out->height ? y + 1 : y - 1;
    double p[3], a[3], b[3], l;
    int k;
    n[0] = n[1] = 0;
    n[2] = -1;
    if (x1 < 0 || y1 < 0) return;
    point_at(cam, x, y, z[y * out->width + x], p);
    point_at(cam, x1, y, z[y * out->width + x1], a);
    point_at(cam, x, y1, z[y1 * out->width + x], b);
    for (k = 0; k < 3; ++k) a[k] -= p[k], b[k] -= p[k];
    for (k = 0; k < 3; ++k) n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    l = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) * (n[0] * p[0] + n[1] * p[1] + n[2] * p[2] > 0 ? -1 : 1);
    for (k = 0; k < 3; ++k) n[k] = l != 0 ? n[k] / l : k == 2 ? -1 : 0;
}

enum { NORMALS = 10 };

/* Of a region, z into the screen. */
static void normal_of(rng *r, const camera *cam, const region *g, const image *out, const double *z, int x, int y, double n[3])
{
    static const double odd[] = { 0, NAN, INFINITY, -INFINITY, 1e30, 1e-20, 1e-40, -1, 1 };
    double p[3], l, t;
    int k;
    normal_of_depth(cam, out, z, x, y, n);
    point_at(cam, x, y, 1, p);
    l = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (k = 0; k < 3; ++k) p[k] = cam->config->projection == HBIL_PROJECTION_PERSPECTIVE ? p[k] / l : k == 2;
    if (g->pattern >= 1 && g->pattern <= 3)
        for (k = 0; k < 3; ++k) n[k] = rng_unit(r) - 0.5;
    t = g->pattern == 3 ? n[0] * p[0] + n[1] * p[1] + n[2] * p[2] : 0; /* at right angles to the view vector */
    for (k = 0; k < 3; ++k) {
        if (g->pattern == 3) n[k] -= t * p[k];
        if (g->pattern == 4) n[k] = -p[k];
        if (g->pattern == 5) n[k] = p[k];
        if (g->pattern == 6) n[k] = -n[k];
        if (g->pattern == 7) n[k] = odd[(int)(g->a * 9)];
        if (g->pattern == 8) n[k] = odd[rng_below(r, 9)];
        if (g->pattern == 9) n[k] *= pow(10, 80 * g->b - 40);
    }
    l = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (g->pattern < 7 && g->pattern != 2) for (k = 0; k < 3; ++k) n[k] /= fmax(l, 1e-30);
}

static void fill_normal(rng *r, const camera *cam, image *out, const double *z)
{
    region g[REGIONS];
    const int n = 1 + rng_below(r, REGIONS), odd = rng_below(r, 2), bits = rng_below(r, 3) ? 0 : 1 << (4 + rng_below(r, 7));
    int i, k, x, y;
    for (i = 0; i < n; ++i) g[i] = random_region(r, out->width, out->height, i == 0, odd ? NORMALS : 7);
    for (y = 0; y < out->height; ++y)
        for (x = 0; x < out->width; ++x) {
            float *to = &out->data[(y * out->width + x) * out->channels];
            double v[3];
            normal_of(r, cam, region_at(g, n, x, y), out, z, x, y, v);
            store_normal(cam, v, to);
            for (k = 0; k < out->channels && bits; ++k) to[k] = (float)floor((double)to[k] * bits + 0.5) / (float)bits;
            if (odd && rng_below(r, 128) == 0) to[rng_below(r, out->channels)] = odd_depth(rng_unit(r));
        }
}

/* -------------------------------------------------------------------------------------------------------------- colours */

static const float odd_colours[] = { 0, 1, 65504, 1e30f, INFINITY, -INFINITY, -1, NAN, 60000, 60001, 1e-40f, 1e-30f, FLT_MAX, -FLT_MAX, 0.5f,
                                     100 };

static float odd_colour(double u)
{
    return odd_colours[(int)(u * (sizeof odd_colours / sizeof *odd_colours))];
}

/* Anything with channels in [0, 1] or [0, inf). */
static void fill_colour(rng *r, image *out)
{
    region g[REGIONS];
    const int n = 1 + rng_below(r, REGIONS), odd = rng_below(r, 3), rows = out->height * image_slices(out);
    int i, k, x, y;
    for (i = 0; i < n; ++i) g[i] = random_region(r, out->width, rows, i == 0, odd ? 7 : 5);
    for (y = 0; y < rows; ++y)
        for (x = 0; x < out->width; ++x) {
            const region *at = region_at(g, n, x, y);
            float *to = &out->data[(y * out->width + x) * out->channels];
            for (k = 0; k < out->channels; ++k) {
                to[k] = at->pattern == 0 ? 1.0f : at->pattern == 1 ? (float)rng_unit(r) : at->pattern == 2 ? (float)(10 * at->b * at->b)
                      : at->pattern == 3 ? (float)rng_log(r, 1e-6, 1e5) : at->pattern == 4 ? (float)(hashed(at, x / at->block, y / at->block))
                      : at->pattern == 5 ? odd_colour(at->a) : odd_colour(rng_unit(r));
                if (odd == 2 && rng_below(r, 64) == 0) to[k] = odd_colour(rng_unit(r));
            }
        }
    if (rng_below(r, 4) == 0) { /* one bright pixel */
        float *to = &out->data[(rng_below(r, rows) * out->width + rng_below(r, out->width)) * out->channels];
        for (k = 0; k < out->channels; ++k) to[k] = rng_below(r, 2) ? 1e30f : 60000.0f;
    }
}

static void fill_motion(rng *r, image *out)
{
    const int kind = rng_below(r, 4), n = out->width * out->height * 2;
    const double size = kind == 1 ? 1 : kind == 2 ? 3e2 : 1e5;
    int i;
    for (i = 0; i < n; ++i) {
        out->data[i] = kind == 0 ? 0.0f : (float)((rng_unit(r) - 0.5) * size);
        if (kind == 3 && rng_below(r, 16) == 0) out->data[i] = odd_depth(rng_unit(r));
    }
}

/* -------------------------------------------------------------------------------------------------------------- a case */

/* Radiance 1 everywhere, for near + ao = 1. */
static void fill_one(image *out)
{
    int i;
    for (i = 0; i < out->width * out->height * out->channels; ++i) out->data[i] = 1;
}

/* The shape of an input: 0: out of memory. */
static int make_input(rng *r, const hbil_config *c, int input, int width, int height, image *out)
{
    static const int channels[CASE_INPUTS] = { 1, 3, 3, 2, 3, 3, 3, 1, 3, 3 };
    const int k = input == CASE_NORMAL ? normal_channels(c->normal_encoding) : input == CASE_F0 && c->f0 == HBIL_F0_SCALAR ? 1 : channels[input];
    const int side = r ? 1 << rng_below(r, 4) : 1, coefficients = c->sh_order == 1 ? 4 : 9;
    if (input == CASE_SKY) return image_make_slices(out, side, side, 6, k);
    if (input == CASE_PROBES && r)
        return image_make_slices(out, 1 + rng_below(r, 4), 1 + rng_below(r, 4), (1 + rng_below(r, 4)) * coefficients, k);
    if (input == CASE_PROBES) return image_make_slices(out, 1, 1, coefficients, k);
    return image_make(out, width, height, k);
}

static int fill_inputs(rng *r, const hbil_plan *plan, const camera *cam, int one, image *inputs, int width, int height)
{
    double *z = (double *)calloc((size_t)width * (size_t)height, sizeof *z);
    int i, ok = z != NULL;
    for (i = 0; i < CASE_INPUTS && ok; ++i) {
        const int32_t t = hbil_plan_texture(plan, case_inputs[i]);
        image *in = &inputs[i];
        if (t < 0 || plan->textures[t].life != HBIL_LIFE_INPUT) continue;
        ok = make_input(r, &plan->config, i, width, height, in);
        if (!ok) break;
        if (i == CASE_DEPTH) fill_depth(r, cam, in, z);
        else if (i == CASE_NORMAL) fill_normal(r, cam, in, z);
        else if (i == CASE_MOTION) fill_motion(r, in);
        else if (i == CASE_RADIANCE && one) fill_one(in);
        else fill_colour(r, in);
    }
    free(z);
    return ok;
}

static void random_size(rng *r, const hbil_config *c, long pixels, int *width, int *height)
{
    const int kind = rng_below(r, 10);
    *width = kind == 0 ? 1 : kind < 4 ? 1 + rng_below(r, 16) : 1 + rng_below(r, 200);
    *height = kind == 1 ? 1 : kind < 4 ? 1 + rng_below(r, 16) : 1 + rng_below(r, 120);
    if (kind == 0 && rng_below(r, 2)) *height = 1 + rng_below(r, 4096);
    if (kind == 1 && rng_below(r, 2)) *width = 1 + rng_below(r, 4096);
    while ((long)*width * *height > pixels && *width * *height > 1) *(*width > *height ? width : height) /= 2;
    if (c->width) *width = (int)c->width, *height = (int)c->height;
}

static void random_frame(rng *r, const hbil_config *c, int width, int height, int i, test_case *out, camera *cam)
{
    hbil_frame *f = &out->frame[i];
    f->width = (uint32_t)(i && !c->width && rng_below(r, 3) == 0 ? 1 + rng_below(r, width) : width);
    f->height = (uint32_t)(i && !c->width && rng_below(r, 3) == 0 ? 1 + rng_below(r, height) : height);
    f->index = rng_below(r, 2) ? (uint32_t)i : rng_below(r, 8) ? (uint32_t)rng_below(r, 1000) : (uint32_t)rng_next(r);
    f->reset = i == 0 || rng_below(r, 8) == 0;
    random_environment(r, f);
    random_live(r, c, &out->live[i]);
    cam->config = c;
    cam->frame = f;
    if (i == 0 || rng_below(r, 2)) {
        cam->near_z = rng_below(r, 2) ? rng_log(r, 1e-4, 10) : 0.1;
        cam->far_z = cam->near_z * (rng_below(r, 2) ? rng_log(r, 2, 1e9) : 1000);
        cam->view_z = rng_below(r, 4) ? -1 : 1;
        random_projection(r, c, cam, f);
        random_view(r, f->view);
    } else { /* it moves a little */
        int k;
        memcpy(f->projection, out->frame[i - 1].projection, sizeof f->projection);
        memcpy(f->view, out->frame[i - 1].view, sizeof f->view);
        for (k = 12; k < 15; ++k) f->view[k] += (float)((rng_unit(r) - 0.5) * rng_log(r, 1e-4, 1));
    }
}

int random_frames(rng *r, const hbil_plan *plan, int pixels, test_case *out)
{
    const hbil_config *c = &plan->config;
    const int history = c->temporal == HBIL_TEMPORAL_YES || c->bounces == HBIL_BOUNCES_RECURSIVE, one = rng_below(r, 4) == 0;
    int width, height, i;
    camera cam;
    memset(out, 0, sizeof *out);
    memset(&cam, 0, sizeof cam);
    out->config = *c;
    out->frames = history ? 1 + rng_below(r, CASE_FRAMES) : 1;
    random_size(r, c, pixels / out->frames, &width, &height);
    for (i = 0; i < out->frames; ++i) {
        random_frame(r, c, width, height, i, out, &cam);
        if (!fill_inputs(r, plan, &cam, one, out->input[i], width, height)) {
            case_free(out);
            return 0;
        }
    }
    case_link(out);
    return 1;
}

void case_link(test_case *c)
{
    int i;
    for (i = 0; i < c->frames; ++i) {
        const hbil_frame *last = &c->frame[i ? i - 1 : 0];
        hbil_frame *f = &c->frame[i];
        f->live = &c->live[i];
        memcpy(f->last_projection, last->projection, sizeof f->last_projection);
        memcpy(f->last_view, last->view, sizeof f->last_view);
        f->last_width = last->width;
        f->last_height = last->height;
    }
    c->frame[0].reset = 1;
}

int case_plain(const hbil_config *config, const hbil_frame *frame, int input, int width, int height, image *out)
{
    const float *p = frame->projection;
    const double facing[3] = { 0, 0, -1 };
    camera cam = { 0 };
    int i, n;
    if (!make_input(NULL, config, input, width, height, out)) return 0;
    cam.config = config;
    cam.frame = frame;
    cam.view_z = config->projection == HBIL_PROJECTION_PERSPECTIVE && p[11] > 0 ? 1 : -1;
    n = out->width * out->height * image_slices(out);
    for (i = 0; i < n * out->channels; ++i) out->data[i] = input == CASE_MOTION ? 0.0f : input == CASE_RADIANCE ? 1.0f : 0.5f;
    for (i = 0; i < n && input == CASE_DEPTH; ++i) out->data[i] = config->depth == HBIL_DEPTH_LINEAR ? 1.0f : raw_depth(&cam, 1);
    for (i = 0; i < n && input == CASE_NORMAL; ++i) store_normal(&cam, facing, &out->data[i * out->channels]);
    return 1;
}

int case_copy(test_case *out, const test_case *in)
{
    int i, k;
    *out = *in;
    memset(out->input, 0, sizeof out->input);
    for (i = 0; i < in->frames; ++i)
        for (k = 0; k < CASE_INPUTS; ++k) {
            const image *from = &in->input[i][k];
            image *to = &out->input[i][k];
            if (!from->data) continue;
            if (!image_make_slices(to, from->width, from->height, image_slices(from), from->channels)) {
                case_free(out);
                return 0;
            }
            memcpy(to->data, from->data, (size_t)(from->width * from->height * image_slices(from) * from->channels) * sizeof(float));
        }
    case_link(out);
    return 1;
}

void case_free(test_case *c)
{
    int i, k;
    for (i = 0; i < CASE_FRAMES; ++i)
        for (k = 0; k < CASE_INPUTS; ++k) image_free(&c->input[i][k]);
    memset(c, 0, sizeof *c);
}

long case_pixels(const test_case *c)
{
    long n = 0;
    int i;
    for (i = 0; i < c->frames; ++i) n += (long)c->frame[i].width * (long)c->frame[i].height;
    return n;
}
