/* measure.c - errors, times and cost of a config on a frame. */
#include "measure.h"

#include <math.h>
#include <string.h>
#include <time.h>

#include "../../backends/hbil_glslang.h"
#include "../../shadergen/cost.h"
#include "metrics.h"

#define FLICKER_FRAMES 6
#define NOISY          0.1
#define BURST          3

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

static void compare(const image *out, const image *converged, const image *model, const image *field, const truth *t,
                    int k, errors *e)
{
    e->present = 1;
    if (converged && converged->data) e->rmse_sampling = metric_rmse(out, converged, t->surface);
    if (field) {
        e->rmse_field = metric_rmse(out, field, t->field_mask[k]);
        e->bias_field = metric_bias(out, field, t->field_mask[k]);
        if (converged && converged->data) e->rmse_estimator = metric_rmse(converged, field, t->field_mask[k]);
    }
    if (model) {
        e->rmse_model = metric_rmse(out, model, t->model_mask);
        e->bias_model = metric_bias(out, model, t->model_mask);
        e->p95_model = metric_percentile(out, model, t->model_mask, 0.95);
    }
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

int measure_errors(settings *s, lit *l, const truth *t, const hbil_config *as, const image *converged, int flicker,
                   errors out[OUTS])
{
    image images[OUTS];
    int   k;

    for (k = 0; k < OUTS; k++) {
        errors *e = &out[k];

        e->present = 0;
        e->rmse_sampling = e->rmse_estimator = e->rmse_model = e->bias_model = e->p95_model = e->rmse_field =
            e->bias_field = e->flicker = NAN;
    }
    if (!lit_images(l, 0, images, s->error, sizeof s->error)) return TRADE_BACKEND;
    for (k = 0; k < OUTS; k++) {
        if (images[k].data)
            compare(&images[k], converged ? &converged[k] : NULL, truth_model(t, s, as, k), truth_field(t, as, k), t, k,
                    &out[k]);
        image_free(&images[k]);
    }
    return !flicker || measure_flicker(s, l, t, out) ? TRADE_DONE : TRADE_BACKEND;
}

int measure_all(settings *s, lit *l, const truth *t, const image *converged, measured *m)
{
    int code = measure_errors(s, l, t, &l->plan.config, converged, 1, m->out);

    if (code == TRADE_DONE) code = measure_time(s, l, &m->time);
    if (code == TRADE_DONE) code = measure_cost(s, l, &m->cost);
    return code;
}
