/* measure.c - errors, times and cost of a config on a frame. */
#include "measure.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "../../backends/hbil_glslang.h"
#include "../../shadergen/cost.h"

#define FLICKER_FRAMES 6
#define NOISY          0.1
#define BURST          3
#define GREY           0.18

int measure_cost(settings *s, const lit *l, price *out)
{
    static cost_cache counted; /* of the whole run: configs share most of their passes */
    cost_total        total;
    int               ok;

    out->fetches = out->bytes_read = out->bytes_written = out->registers = (double)NAN;
    if (l->own && !external_cost(l->own, &total)) return TRADE_DONE;
    ok = l->own || hbil_glslang_init();
    if (ok && !l->own) {
        ok = cost_of_plans(&l->plan, &counted, &total) == DONE;
        hbil_glslang_shutdown();
    }
    if (!ok)
        return frame_error(s->error, sizeof s->error, "the cost cannot be counted, see above"), TRADE_BACKEND;
    out->fetches = total.fixed.access[COST_FETCH] + total.fixed.access[COST_LOAD] + total.loops.access[COST_FETCH]
                  + total.loops.access[COST_LOAD];
    out->bytes_read = total.fixed.bytes_read + total.loops.bytes_read;
    out->bytes_written = total.fixed.bytes_written + total.loops.bytes_written;
    out->registers = total.registers;
    return TRADE_DONE;
}

void times_sum_up(times *t)
{
    int i;

    t->min = t->max = t->ms[0];
    for (i = 1; i < t->runs; i++) {
        t->min = fmin(t->min, t->ms[i]);
        t->max = fmax(t->max, t->ms[i]);
    }
    t->median = timing_median(t->ms, t->runs);
    t->range = timing_bootstrap(t->ms, t->runs, 0.95);
    t->noisy = t->runs < 3 || t->range.high - t->range.low > NOISY * t->median;
}

int measure_time(settings *s, lit *l, times *t)
{
    static const struct timespec pause = {0, 30000000};
    double ms;
    int    i;

    memset(t, 0, sizeof *t);
    if (!timing_warm(lit_run, l, 0.5 * s->seconds, &ms, &t->stable, s->error, sizeof s->error)) return TRADE_BACKEND;
    t->runs = s->repeat;
    while (t->runs > 3 && t->runs * ms > 500.0 * s->seconds) t->runs--;
    if (ms > 1000.0 * s->seconds) t->runs = 1;
    for (i = 0; i < t->runs; i += BURST) { /* with pauses: a busy moment of the machine shows as a wide interval */
        if (i > 0) nanosleep(&pause, NULL);
        if (!lit_run(l, t->runs - i < BURST ? t->runs - i : BURST, t->ms + i, s->error, sizeof s->error))
            return TRADE_BACKEND;
    }
    times_sum_up(t);
    return TRADE_DONE;
}

/* ---- errors ------------------------------------------------------------------------------------------------------ */

/* What is white where the mean is grey; of ao, 1. 0: nothing is. */
static double white_of(const image *img, const unsigned char *mask, int k)
{
    const metric_sums sums = metric_compare(img, img, mask);

    return k == OUT_AO ? 1.0 : sums.values > 0 ? sums.truth / (double)sums.values / GREY : 0.0;
}

/* What an eye would see of an output; where the mask is 0, the truth's. */
static int compose(const capture *cap, const image *light, const image *model, const unsigned char *mask, int k,
                   image *picture)
{
    const size_t count = (size_t)cap->width * (size_t)cap->height;
    size_t       i;

    if (!image_make(picture, cap->width, cap->height, 3)) return 0;
    for (i = 0; i < 3 * count; i++) {
        const image *from = mask[i / 3] ? light : model;

        picture->data[i] = k == OUT_AO ? from->data[i / 3] : cap->albedo.data[i] * from->data[i];
        if (k != OUT_NEAR) continue;
        picture->data[i] += cap->direct.data[i] + (cap->emission.data ? cap->emission.data[i] : 0.0f);
    }
    return 1;
}

double measure_flip(const capture *cap, const image *out, const image *model, const unsigned char *mask, int k)
{
    const size_t count = 3 * (size_t)cap->width * (size_t)cap->height;
    image        seen, meant;
    double       white, result = (double)NAN;
    size_t       i;

    memset(&seen, 0, sizeof seen);
    memset(&meant, 0, sizeof meant);
    if (compose(cap, out, model, mask, k, &seen) && compose(cap, model, model, mask, k, &meant)) {
        white = white_of(&meant, mask, k);
        for (i = 0; i < count; i++) {
            seen.data[i] = (float)((double)seen.data[i] / white);
            meant.data[i] = (float)((double)meant.data[i] / white);
        }
        if (white > 0.0) result = metric_flip(&meant, &seen, mask, METRIC_FLIP_PPD, NULL);
    }
    image_free(&seen);
    image_free(&meant);
    return result;
}

void measure_image(const settings *s, const capture *cap, const truth *t, const hbil_config *as, int k,
                   const image *out, const image *converged, errors *e)
{
    const image         *model = truth_model(t, s, as, k), *field = truth_field(t, as, k);
    const unsigned char *mask = t->model_mask, *field_mask = t->field_mask[k];

    e->present = out->data != NULL;
    e->rmse_sampling = metric_rmse(out, converged, t->surface);
    e->rmse_estimator = metric_rmse(converged, field, field_mask);
    e->rmse_field = metric_rmse(out, field, field_mask);
    e->bias_field = metric_bias(out, field, field_mask);
    metric_rings(out, field, field_mask, e->ring_field);
    e->rmse_model = metric_rmse(out, model, mask);
    e->bias_model = metric_bias(out, model, mask);
    e->p95_model = metric_percentile(out, model, mask, 0.95);
    e->relative = metric_relative(out, model, mask);
    e->psnr = metric_psnr(out, model, mask, white_of(model, mask, k));
    e->edge_rmse = metric_edge_rmse(out, model, mask, &cap->depth);
    metric_rings(out, model, mask, e->ring_model);
    e->flip = e->flicker = (double)NAN;
}

/* The frames after the one that was judged, with a still camera; none where the first of them takes too long. */
static int measure_flicker(settings *s, lit *l, const truth *t, errors out[OUTS])
{
    const double begun = seconds_now();
    image        frames[FLICKER_FRAMES][OUTS], row[FLICKER_FRAMES];
    int          f, k, ok = 1, slow = 0;

    memset(frames, 0, sizeof frames);
    for (f = 0; ok && !slow && f < FLICKER_FRAMES; f++) {
        ok = lit_next(l, frames[f], s->error, sizeof s->error);
        slow = f == 0 && seconds_now() - begun > s->seconds;
    }
    for (k = 0; k < OUTS; k++) {
        for (f = 0; f < FLICKER_FRAMES; f++) row[f] = frames[f][k];
        if (ok && !slow && out[k].present) out[k].flicker = metric_flicker(row, FLICKER_FRAMES, t->surface);
        for (f = 0; f < FLICKER_FRAMES; f++) image_free(&row[f]);
    }
    return ok;
}

int measure_errors(settings *s, lit *l, const truth *t, const hbil_config *as, const image *converged, int slow,
                   errors out[OUTS])
{
    image images[OUTS];
    int   k;

    if (!lit_images(l, 0, images, s->error, sizeof s->error)) return TRADE_BACKEND;
    for (k = 0; k < OUTS; k++) {
        const capture *cap = subject_judged(l->sub);
        const image   *model = truth_model(t, s, as, k);

        measure_image(s, cap, t, as, k, &images[k], converged ? &converged[k] : NULL, &out[k]);
        if (slow && model && images[k].data) out[k].flip = measure_flip(cap, &images[k], model, t->model_mask, k);
        image_free(&images[k]);
    }
    return !slow || measure_flicker(s, l, t, out) ? TRADE_DONE : TRADE_BACKEND;
}

int measure_all(settings *s, lit *l, const truth *t, const image *converged, measured *m)
{
    int code = measure_errors(s, l, t, &l->plan.config, converged, 1, m->out);

    if (code == TRADE_DONE) code = measure_time(s, l, &m->time);
    if (code == TRADE_DONE) code = measure_cost(s, l, &m->cost);
    return code;
}
