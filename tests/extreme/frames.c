/* frames.c - cameras, planes and inputs of the extreme cases. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "frames.h"

#define PI 3.14159265358979323846

/* [0, 1) from two numbers, as good as random. */
float frames_random(uint32_t a, uint32_t b)
{
    uint32_t x = a * 0x9e3779b9u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return (float)((x ^ x >> 16) >> 8) / 16777216.0f;
}

image *frames_input(const hbil_plan *plan, extreme_frame *out, const char *name)
{
    const int32_t t = hbil_plan_texture(plan, name);
    return t < 0 || plan->textures[t].life != HBIL_LIFE_INPUT ? NULL : &out->inputs[t];
}

static size_t values(const image *img)
{
    return (size_t)img->width * (size_t)img->height * (size_t)image_slices(img) * (size_t)img->channels;
}

void frames_fill(image *img, float value)
{
    size_t i;
    if (img)
        for (i = 0; i < values(img); ++i) img->data[i] = value;
}

static void make(image *img, int width, int height, int depth, int channels, float low, float span)
{
    size_t i;
    if (!(depth ? image_make_slices(img, width, height, depth, channels) : image_make(img, width, height, channels))) {
        fprintf(stderr, "extreme cases: out of memory for %d x %d x %d\n", width, height, depth);
        abort();
    }
    for (i = 0; i < values(img); ++i) img->data[i] = low + span * frames_random((uint32_t)i, (uint32_t)(channels + depth));
}

/* Rows 0 and 1 of a projection, and row 2 in the convention of the config: see hbil_frame and test_frame. */
static void project(const hbil_config *k, const camera *c, float m[16])
{
    const double low = k->clip == HBIL_CLIP_GL ? -1 : 0, stretch = c->stretch > 0 ? c->stretch : 1;
    const int reversed = k->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    const double ndc_near = reversed ? 1 : low, ndc_far = reversed ? low : 1;
    const int ortho = k->projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    const double tangent = ortho ? c->fov / 2 : tan(c->fov * PI / 360);
    memset(m, 0, 16 * sizeof *m);
    m[0] = (float)(c->height / (tangent * stretch * c->width));
    m[5] = (float)(-1 / tangent);
    if (ortho) { /* ndc = a z + b, z = -depth */
        const double a = (ndc_far - ndc_near) / (c->near_z - c->far_z);
        m[10] = (float)a;
        m[12] = (float)c->shift[0];
        m[13] = (float)c->shift[1];
        m[14] = (float)(ndc_near + a * c->near_z);
        m[15] = 1;
        return;
    }
    m[8] = (float)-c->shift[0];
    m[9] = (float)-c->shift[1];
    m[11] = -1;
    if (k->depth_far == HBIL_DEPTH_FAR_INFINITE) { /* ndc = -a + b / depth */
        m[10] = (float)-ndc_far;
        m[14] = (float)((ndc_near - ndc_far) * c->near_z);
    } else {
        const double b = (ndc_near - ndc_far) / (1 / c->near_z - 1 / c->far_z);
        m[10] = (float)(b / c->far_z - ndc_far);
        m[14] = (float)b;
    }
}

static void environment(hbil_frame *f)
{
    static const float color[3] = { 0.5f, 0.7f, 1.0f };
    int i, k;
    memcpy(f->far_color, color, sizeof color);
    for (k = 0; k < 3; ++k) f->probe_origin[k] = -1.5f, f->probe_step[k] = 1.25f;
    for (i = 0; i < 9; ++i)
        for (k = 0; k < 3; ++k) f->far_sh[i][k] = i ? frames_random((uint32_t)i, (uint32_t)k) - 0.5f : 2.0f + (float)k;
}

/* What raw depth says "sky". */
static float clear_value(const hbil_config *k)
{
    if (k->depth == HBIL_DEPTH_LINEAR) return k->projection == HBIL_PROJECTION_ORTHOGRAPHIC ? 1e30f : 0.0f;
    return k->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED ? 0.0f : 1.0f;
}

void frames_begin(const hbil_plan *plan, extreme_frame *out, const camera *c, int index)
{
    const int coefficients = plan->config.sh_order == 1 ? 4 : 9;
    hbil_frame *f = &out->frame;
    uint32_t t;
    f->width = (uint32_t)c->width;
    f->height = (uint32_t)c->height;
    f->index = (uint32_t)index;
    f->reset = index == 0;
    project(&plan->config, c, f->projection);
    f->view[0] = f->view[5] = f->view[10] = f->view[15] = 1;
    f->view[12] = (float)-c->eye_x;
    memcpy(f->last_projection, f->projection, sizeof f->projection);
    memcpy(f->last_view, f->view, sizeof f->view);
    environment(f);
    for (t = 0; t < plan->texture_count; ++t) {
        const char *name = plan->textures[t].name;
        image *img = &out->inputs[t];
        if (plan->textures[t].life != HBIL_LIFE_INPUT) continue;
        if (strcmp(name, "sky") == 0) make(img, 8, 8, 6, 3, 0.2f, 1.5f);
        else if (strcmp(name, "probes") == 0) make(img, 4, 3, 5 * coefficients, 3, -0.3f, 1.5f);
        else if (strcmp(name, "depth") == 0) make(img, c->width, c->height, 0, 1, clear_value(&plan->config), 0);
        else if (strcmp(name, "motion") == 0) make(img, c->width, c->height, 0, 2, 0, 0);
        else if (strcmp(name, "roughness") == 0) make(img, c->width, c->height, 0, 1, 0, 1);
        else if (strcmp(name, "normal") == 0) make(img, c->width, c->height, 0, 3, 0, 0);
        else make(img, c->width, c->height, 0, 3, 0, 1);
    }
}

static double raw_depth(const hbil_config *k, const hbil_frame *f, double z)
{
    const double low = k->clip == HBIL_CLIP_GL ? -1 : 0;
    double ndc;
    if (k->depth == HBIL_DEPTH_LINEAR) return z;
    ndc = k->projection == HBIL_PROJECTION_ORTHOGRAPHIC ? -(double)f->projection[10] * z + (double)f->projection[14]
                                                        : -(double)f->projection[10] + (double)f->projection[14] / z;
    return (ndc - low) / (1 - low);
}

/* A vector to its place on the octahedral map. */
static void unfold(float n[3])
{
    const float l = fabsf(n[0]) + fabsf(n[1]) + fabsf(n[2]), x = n[0] / l, y = n[1] / l;
    n[0] = n[2] >= 0 ? x : (1 - fabsf(y)) * (x < 0 ? -1.0f : 1.0f);
    n[1] = n[2] >= 0 ? y : (1 - fabsf(x)) * (y < 0 ? -1.0f : 1.0f);
    n[2] = 0;
}

void frames_put(const hbil_plan *plan, extreme_frame *out, int x, int y, double z, const double n[3])
{
    image *depth = frames_input(plan, out, "depth"), *normal = frames_input(plan, out, "normal");
    const size_t p = (size_t)y * (size_t)depth->width + (size_t)x;
    int i, k;
    depth->data[p] = (float)raw_depth(&plan->config, &out->frame, z);
    if (!normal) return;
    for (i = 0; i < 3; ++i) {
        double v = n[i];
        if (plan->config.normals == HBIL_NORMALS_WORLD) /* the transpose of the view's rotation */
            for (k = 0, v = 0; k < 3; ++k) v += (double)out->frame.view[4 * i + k] * n[k];
        normal->data[3 * p + (size_t)i] = (float)v;
    }
    if (plan->config.normal_encoding == HBIL_NORMAL_ENCODING_OCTAHEDRAL) unfold(&normal->data[3 * p]);
}

void frames_ray(const hbil_plan *plan, const hbil_frame *f, double x, double y, double ray[2])
{
    const int ortho = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    const double u = 2 * x / f->width - 1, v = 2 * y / f->height - 1;
    ray[0] = (u + (double)(ortho ? -f->projection[12] : f->projection[8])) / (double)f->projection[0];
    ray[1] = (v + (double)(ortho ? -f->projection[13] : f->projection[9])) / (double)f->projection[5];
}

static double hit(const hbil_plan *plan, const plane *q, const double ray[2])
{
    const int ortho = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC;
    const double side = q->n[0] * ray[0] + q->n[1] * ray[1];
    const double z = ortho ? (side - q->d) / q->n[2] : q->d / (side - q->n[2]);
    double p[3];
    int k;
    if (!(z > 0) || z > 1e14) return 0;
    p[0] = ortho ? ray[0] : ray[0] * z;
    p[1] = ortho ? ray[1] : ray[1] * z;
    p[2] = -z;
    for (k = 0; k < 3; ++k)
        if (q->high[k] > q->low[k] && (p[k] < q->low[k] || p[k] > q->high[k])) return 0;
    return z;
}

void frames_planes(const hbil_plan *plan, extreme_frame *out, const plane *planes, int count)
{
    const image *depth = frames_input(plan, out, "depth");
    int x, y, i;
    for (y = 0; y < depth->height; ++y)
        for (x = 0; x < depth->width; ++x) {
            double ray[2], best = 0;
            int which = 0;
            frames_ray(plan, &out->frame, x + 0.5, y + 0.5, ray);
            for (i = 0; i < count; ++i) {
                const double z = hit(plan, &planes[i], ray);
                if (z > 0 && (best <= 0 || z < best)) best = z, which = i;
            }
            if (best > 0) frames_put(plan, out, x, y, best, planes[which].n);
        }
}

void frames_room_by(const hbil_plan *plan, extreme_frame *out, const camera *c, int index)
{
    const double x = c->eye_x, step = 0.03;
    const plane planes[] = {
        { { 0, 0, 1 }, -6, { -99, -99, -99 }, { 99, 1.5, 0 } },
        { { 0, 1, 0 }, -1, { 0, 0, 0 }, { 0, 0, 0 } },
        { { 0, 0, 1 }, -3, { -0.7 - x, -2, -99 }, { 0.5 - x, 0.6, 0 } },
        { { -0.8, 0, 0.6 }, -2.6, { 1.2 - x, -2, -99 }, { 9, 0.1, 0 } },
    };
    image *motion;
    frames_begin(plan, out, c, index);
    frames_planes(plan, out, planes, (int)(sizeof planes / sizeof *planes));
    if (index == 0) return;
    out->frame.last_view[12] = (float)(step - x);
    motion = frames_input(plan, out, "motion");
    if (motion) { /* of still things: the eye went right by `step` */
        int p;
        const double pixels = step * (double)out->frame.projection[0] * c->width / 2;
        const int ortho = plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC;
        for (p = 0; p < c->width * c->height; ++p) {
            const float z = frames_input(plan, out, "depth")->data[p];
            motion->data[2 * p] = ortho ? (float)pixels : z > 0 ? (float)(pixels / (double)z) : 0.0f;
        }
    }
}

void frames_room(const hbil_plan *plan, extreme_frame *out, int width, int height, int index)
{
    const camera c = { width, height, plan->config.projection == HBIL_PROJECTION_ORTHOGRAPHIC ? 5 : 60, 0.1, 100, 1, { 0, 0 },
                       0.03 * index };
    frames_room_by(plan, out, &c, index);
}

void extreme_free(extreme_frame *f)
{
    int i;
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&f->inputs[i]);
}
