/* truth.c - the three truths, and their cache. */
#include "truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "../../tests/numeric/brute_force.h"
#include "metric.h"

#define FIELD_RAYS   1024 /* a pixel: a standard error of at most .016 for ao */
#define FIELD_PIXELS 2048 /* about so many get rays */
#define BOUNCES 6 /* frames after which recursive bounces have converged: albedo .8 leaves a quarter of a percent */

/* ---- cache ------------------------------------------------------------------------------------------------------- */

static uint64_t hash_image(uint64_t hash, const image *img)
{
    return img->data ? hash_bytes(hash, img->data,
                                  (size_t)img->width * (size_t)img->height * (size_t)img->channels * sizeof(float))
                     : hash;
}

/* Of what is lit, and by what. */
static uint64_t hash_frame(const settings *s, const capture *cap)
{
    uint64_t hash = hash_bytes(HASH_BEGIN, s->env, strlen(s->env));

    hash = hash_bytes(hash, cap->projection, sizeof cap->projection);
    hash = hash_bytes(hash, cap->view, sizeof cap->view);
    hash = hash_image(hash, &cap->depth);
    hash = hash_image(hash, &cap->normal);
    hash = hash_image(hash, &cap->direct);
    return hash_image(hash, &cap->f0);
}

static void cache_path(const settings *s, const char *kind, uint64_t hash, char path[2048])
{
    snprintf(path, 2048, "%s/%s-%016llx.exr", s->cache_path, kind, (unsigned long long)hash);
}

static void cache_layers(image_layer layers[OUTS])
{
    static const char *const channels[OUTS] = {"Y", "RGB", "RGB"};
    int k;

    memset(layers, 0, OUTS * sizeof *layers);
    for (k = 0; k < OUTS; k++) {
        layers[k].layer = out_names[k];
        layers[k].channels = channels[k];
    }
}

/* 1: it is there and whole. */
static int cache_read(const char *path, const capture *cap, image out[OUTS])
{
    image_layer layers[OUTS];
    char        error[256];
    int         k, ok;

    cache_layers(layers);
    if (access(path, R_OK) != 0 || !exr_read(path, layers, OUTS, error, sizeof error)) return 0;
    for (k = 0, ok = 1; k < OUTS; k++) {
        out[k] = layers[k].pixels;
        ok &= !out[k].data || (out[k].width == cap->width && out[k].height == cap->height);
    }
    for (k = 0; k < OUTS && !ok; k++) image_free(&out[k]);
    return ok;
}

static int cache_write(settings *s, const char *path, const image out[OUTS])
{
    image_layer layers[OUTS];
    int         k;

    cache_layers(layers);
    for (k = 0; k < OUTS; k++) layers[k].pixels = out[k];
    return exr_write(path, layers, OUTS, s->error, sizeof s->error);
}

/* ---- the height field -------------------------------------------------------------------------------------------- */

static bf_grid field_grid(const capture *cap)
{
    const double pixels = (double)cap->width * cap->height;
    int          stride = (int)(sqrt(pixels / FIELD_PIXELS) + 0.5);

    if (stride < 1) stride = 1;
    return bf_grid_of(cap->width, cap->height, stride / 2, stride);
}

/* Puts the pixels of the grid into the images of a frame; those between have NaN, which the cache keeps. */
static int spread_field(const bf_pixel *rays, bf_grid grid, const capture *cap, image out[OUTS])
{
    int k, i, c;

    for (k = 0; k < OUTS; k++) {
        const size_t count = (size_t)(cap->width * cap->height * (k == OUT_AO ? 1 : 3));
        size_t       n;

        if (!image_make(&out[k], cap->width, cap->height, k == OUT_AO ? 1 : 3)) return 0;
        for (n = 0; n < count; n++) out[k].data[n] = NAN;
    }
    for (i = 0; i < grid.columns * grid.rows; i++) {
        const int at =
            (grid.first + i / grid.columns * grid.stride) * cap->width + grid.first + i % grid.columns * grid.stride;

        if (rays[i].sky > 0.0) continue;
        out[OUT_AO].data[at] = (float)rays[i].ao;
        for (c = 0; c < 3; c++) {
            out[OUT_NEAR].data[3 * at + c] = (float)rays[i].near[c];
            out[OUT_FAR].data[3 * at + c] = (float)rays[i].far[c];
        }
    }
    return 1;
}

static int trace_field(settings *s, const capture *cap, image out[OUTS])
{
    const environment_view    v = {&s->light, cap->view};
    const bf_grid grid = field_grid(cap);
    bf_scene      scene;
    bf_pixel     *rays = malloc((size_t)grid.columns * (size_t)grid.rows * sizeof *rays);
    int           ok = rays != NULL;

    memset(&scene, 0, sizeof scene);
    scene.camera = bf_camera_from(cap->projection, cap->width, cap->height);
    scene.depth = cap->depth.data;
    scene.sky_depth = 1e9;
    scene.normal = cap->normal.data;
    scene.radiance = cap->direct.data;
    scene.sky = environment_view_radiance;
    scene.sky_data = &v;
    if (!s->quiet)
        fprintf(stderr, "hbil-tradeoff: tracing the height field, %d pixels of %d rays\n", grid.columns * grid.rows,
                FIELD_RAYS);
    ok = ok && bf_run(&scene, grid, FIELD_RAYS, rays) && spread_field(rays, grid, cap, out);
    free(rays);
    return ok || frame_error(s->error, sizeof s->error, "out of memory for the height field's rays");
}

/* From the cache or by rays. */
static int make_field(settings *s, const capture *cap, image out[OUTS])
{
    char path[2048];

    cache_path(s, "field", hash_frame(s, cap), path);
    if (cache_read(path, cap, out)) return TRADE_DONE;
    if (!trace_field(s, cap, out)) return TRADE_BACKEND;
    return cache_write(s, path, out) ? TRADE_DONE : TRADE_FILES;
}

/* ---- truths of a frame ------------------------------------------------------------------------------------------- */

static int copy_image(const image *from, image *to)
{
    if (!from->data) return 1;
    if (!image_make(to, from->width, from->height, from->channels)) return 0;
    memcpy(to->data, from->data, (size_t)from->width * (size_t)from->height * (size_t)from->channels * sizeof(float));
    return 1;
}

static int make_masks(const capture *cap, truth *t)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    size_t       i;
    int          k, ok;

    t->surface = malloc(count);
    t->model_mask = malloc(count);
    for (k = 0, ok = t->surface && t->model_mask; k < OUTS; k++) {
        t->field_mask[k] = malloc(count);
        ok = ok && t->field_mask[k];
    }
    for (i = 0; ok && i < count; i++) {
        t->surface[i] = cap->depth.data[i] < 1e9f;
        t->model_mask[i] = (unsigned char)metric_counts(cap, i);
        for (k = 0; k < OUTS; k++) {
            const int whole = k != OUT_FAR && cap->hf_valid.data; /* else only the rays' pixels have numbers */
            const image *f = &t->field[k];

            t->field_mask[k][i] = f->data && (whole ? cap->hf_valid.data[i] > 0.5f
                                                    : isfinite(f->data[(size_t)f->channels * i]) != 0);
        }
    }
    return ok;
}

int truth_make(settings *s, const subject *sub, int far, truth *t)
{
    const capture *cap = subject_judged(sub);
    const int      filed = cap->hf_valid.data != NULL;
    int            code = TRADE_DONE, ok = 1, k;

    memset(t, 0, sizeof *t);
    if (!filed || far) code = make_field(s, cap, t->field);
    if (code == TRADE_DONE && filed) {
        image_free(&t->field[OUT_AO]);
        image_free(&t->field[OUT_NEAR]);
        ok = copy_image(&cap->hf_ao, &t->field[OUT_AO]) && copy_image(&cap->hf_near, &t->field[OUT_NEAR]);
    }
    ok = ok && copy_image(&cap->truth_ao, &t->model[OUT_AO]) && copy_image(&cap->truth_near, &t->model[OUT_NEAR])
         && copy_image(&cap->truth_far, &t->model[OUT_FAR]) && copy_image(&cap->truth_bounce, &t->bounce)
         && make_masks(cap, t);
    for (k = OUT_NEAR; ok && k < OUTS; k++) {
        capture_take_f0(cap, &t->model[k]);
        capture_take_f0(cap, &t->field[k]);
    }
    capture_take_f0(cap, &t->bounce);
    if (!ok) {
        frame_error(s->error, sizeof s->error, "out of memory for the truths of %s", sub->name);
        code = TRADE_BACKEND;
    }
    if (code != TRADE_DONE) truth_free(t);
    return code;
}

void truth_free(truth *t)
{
    int k;

    for (k = 0; k < OUTS; k++) {
        image_free(&t->model[k]);
        image_free(&t->field[k]);
        free(t->field_mask[k]);
    }
    image_free(&t->bounce);
    free(t->surface);
    free(t->model_mask);
    memset(t, 0, sizeof *t);
}

const image *truth_model(const truth *t, const settings *s, const hbil_config *config, int out)
{
    const image *found = &t->model[out];

    if (out == OUT_NEAR && config->bounces == HBIL_BOUNCES_RECURSIVE) found = &t->bounce;
    if (out == OUT_FAR && !s->light.captures_sky) return NULL;
    return found->data ? found : NULL;
}

const image *truth_field(const truth *t, const hbil_config *config, int out)
{
    if (out == OUT_NEAR && config->bounces == HBIL_BOUNCES_RECURSIVE) return NULL; /* it has one bounce */
    return t->field[out].data ? &t->field[out] : NULL;
}

/* ---- the converged estimator ------------------------------------------------------------------------------------- */

void truth_family(const settings *s, const hbil_config *config, hbil_config *out)
{
    const int by_count =
        config->estimator == HBIL_ESTIMATOR_HBAO || config->estimator == HBIL_ESTIMATOR_HBAO_PLUS
        || config->occluder == HBIL_OCCLUDER_HEURISTIC; /* means over samples: where these are is the estimator */
    hbil_config c = *config;

    c.outputs &= HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR | HBIL_OUTPUTS_FAR;
    c.slices = s->converged.slices;
    if (c.march == HBIL_MARCH_SWEEP) { /* its directions are those of every frame: more of them instead */
        c.slices *= s->converged.frames;
        if (c.slices > 64) c.slices = 64;
    }
    c.steps = s->converged.steps;
    if (!by_count) {
        c.spacing = HBIL_SPACING_POWER;
        c.exponent = 1.5f; /* dense nearby, and no far gaps of many pixels */
    }
    if (c.gather != HBIL_GATHER_SIDE) c.gather = 0;
    c.noise = c.mips = c.interleave = c.sweep_stride = 0;
    c.filter = c.filter_passes = c.temporal = c.history = c.rectify = c.downscale = c.arithmetic = c.storage = 0;
    c.dynamic = 0;
    if (hbil_config_resolve(&c, out, NULL) != HBIL_OK) *out = *config;
}

/* The texts of all passes: another version of hbil.h is another estimator. */
static uint64_t hash_texts(uint64_t hash, const hbil_plan *plan)
{
    static char text[HBIL_GLSL_MAX];
    uint32_t    p;

    for (p = 0; p < plan->pass_count; p++)
        if (hbil_emit_glsl(plan, (int32_t)p, text, sizeof text, NULL) == HBIL_OK)
            hash = hash_bytes(hash, text, strlen(text));
    return hash;
}

static void add_images(image sum[OUTS], const image more[OUTS], float factor)
{
    int k;

    for (k = 0; k < OUTS; k++) {
        const size_t count = (size_t)more[k].width * (size_t)more[k].height * (size_t)more[k].channels;
        size_t       i;

        for (i = 0; more[k].data && i < count; i++) sum[k].data[i] += factor * more[k].data[i];
    }
}

/* The mean over frames of noise. With recursive bounces those before them fill the history. */
static int average(settings *s, lit *l, image out[OUTS])
{
    const int frames = l->plan.config.march == HBIL_MARCH_SWEEP ? 1 : s->converged.frames,
              warm = l->history ? BOUNCES : 0;
    image     one[OUTS];
    int       f, k, ok = 1;

    l->frame.reset = 1;
    l->frame.index = UINT32_MAX; /* lit_next counts from 0 on */
    for (f = 0; ok && f < warm + frames; f++) {
        if (!s->quiet)
            fprintf(stderr, "hbil-tradeoff: the converged estimator, frame %d of %d\n", f + 1, warm + frames);
        ok = lit_next(l, one, s->error, sizeof s->error);
        for (k = 0; ok && k < OUTS; k++)
            if (one[k].data && !out[k].data) ok = image_make(&out[k], one[k].width, one[k].height, one[k].channels);
        if (ok && f >= warm) add_images(out, one, 1.0f / (float)frames);
        for (k = 0; k < OUTS; k++) image_free(&one[k]);
    }
    return ok;
}

int truth_converged(settings *s, runner *device, const subject *sub, const hbil_config *config, image out[OUTS])
{
    const capture *cap = subject_judged(sub);
    const subject  still = {"", sub->frames + sub->count - 1, 1};
    hbil_config    family;
    char           path[2048];
    uint64_t       hash;
    lit            l;
    int            k, ok;

    memset(out, 0, OUTS * sizeof *out);
    truth_family(s, config, &family);
    if (!lit_open(&l, device, s, &family, &still, s->error, sizeof s->error)) return TRADE_MISFIT;
    hash = hash_bytes(hash_frame(s, cap), &l.plan.hash, sizeof l.plan.hash);
    hash = hash_bytes(hash_texts(hash, &l.plan), &s->converged, sizeof s->converged);
    cache_path(s, "converged", hash, path);
    if (cache_read(path, cap, out)) {
        lit_close(&l);
        return TRADE_DONE;
    }
    ok = average(s, &l, out);
    lit_close(&l);
    for (k = 0; k < OUTS && !ok; k++) image_free(&out[k]);
    if (!ok) return TRADE_BACKEND;
    return cache_write(s, path, out) ? TRADE_DONE : TRADE_FILES;
}
