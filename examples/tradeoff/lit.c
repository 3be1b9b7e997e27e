/* lit.c - runs a config on a frame. */
#include "lit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "output.h"

/* Frames of a still camera after which a history counts as filled: the default of the option history. */
#define STILL 16

static void free_images(image images[HBIL_MAX_TEXTURES])
{
    int i;

    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&images[i]);
}

/* Inputs of one frame, in place of those that were there. */
static int encode(lit *l, const capture *cap, char *error, size_t error_size)
{
    const environment *light = config_light(l->s, &l->plan.config, error, error_size);

    free_images(l->in);
    return light && capture_encode(cap, &l->plan, &l->frame, l->in, error, error_size)
        && environment_encode(light, &l->plan, &l->frame, l->in, error, error_size);
}

static void begin(lit *l, runner *device, const settings *s, const subject *sub)
{
    memset(l, 0, sizeof *l);
    l->device = device;
    l->sub = sub;
    l->s = s;
}

int lit_open(lit *l, runner *device, const settings *s, const hbil_config *config, const subject *sub, char *error,
             size_t error_size)
{
    hbil_diag  item;
    hbil_diags diags = {&item, 1, 0};
    uint32_t   i;

    begin(l, device, s, sub);
    if (hbil_plan_build(config, &l->plan, &diags) != HBIL_OK)
        return frame_error(error, error_size, "%s", diags.count ? item.text : "the config is refused");
    for (i = 0; i < l->plan.texture_count; i++) l->history |= l->plan.textures[i].life == HBIL_LIFE_HISTORY;
    if (encode(l, subject_judged(sub), error, error_size)) return 1;
    lit_close(l);
    return 0;
}

int lit_open_external(lit *l, runner *device, const settings *s, const external *e, const subject *sub, char *error,
                      size_t error_size)
{
    const capture *cap = subject_judged(sub);

    begin(l, device, s, sub);
    l->own = e;
    l->plan = e->plan;
    l->plan.config.projection = cap->orthographic ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    return encode(l, cap, error, error_size);
}

void lit_close(lit *l) { free_images(l->in); }

/* As runner_run, with the words of an external and its block of this frame. */
static int execute(lit *l, image textures[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    external_block block;
    runner_spirv   spirv;
    int            ok;

    if (l->own) {
        external_fill(&l->frame, &block);
        spirv = l->own->spirv;
        spirv.block = &block;
    }
    if (!runner_words(l->device, l->own ? &spirv : NULL))
        return frame_error(error, error_size, "SPIR-V runs with --backend vulkan alone");
    ok = runner_run(l->device, &l->plan, &l->frame, l->in, textures, repeat, ms, error, error_size);
    runner_words(l->device, NULL);
    return ok;
}

/* One frame; out may be NULL. */
static int run(lit *l, image out[OUTS], char *error, size_t error_size)
{
    static const int kinds[OUTS] = {OUTPUT_AO, OUTPUT_NEAR, OUTPUT_FAR};
    image textures[HBIL_MAX_TEXTURES];
    int   ok, k;

    if (!execute(l, textures, 1, NULL, error, error_size)) return 0;
    for (k = 0, ok = 1; out && ok && k < OUTS; k++) {
        const int32_t at = hbil_plan_texture(&l->plan, out_names[k]);

        memset(&out[k], 0, sizeof out[k]);
        if (at < 0 || l->plan.textures[at].life != HBIL_LIFE_OUTPUT) continue;
        ok = output_take(&out[k], kinds[k], &textures[at])
             || frame_error(error, error_size, "out of memory for the outputs");
    }
    free_images(textures);
    return ok;
}

int lit_images(lit *l, uint32_t index, image out[OUTS], char *error, size_t error_size)
{
    const subject *sub = l->sub;
    const int      frames = !l->history ? 1 : sub->count > 1 ? sub->count : STILL;
    int            k;

    memset(out, 0, OUTS * sizeof *out);
    for (k = 0; k < frames; k++) {
        if (l->history && sub->count > 1 && !encode(l, &sub->frames[k], error, error_size)) return 0;
        if (k > 0) capture_follow(&l->frame, sub->count > 1 ? &sub->frames[k - 1] : subject_judged(sub));
        else l->frame.reset = 1;
        l->frame.index = index + (uint32_t)k;
        if (!run(l, k + 1 == frames ? out : NULL, error, error_size)) return 0;
    }
    return 1;
}

int lit_next(lit *l, image out[OUTS], char *error, size_t error_size)
{
    if (l->history) capture_follow(&l->frame, subject_judged(l->sub));
    l->frame.index++;
    return run(l, out, error, error_size);
}

/* Runs `repeat` times in one call; ms (may be NULL) as runner_run has it, *wall: all of it in milliseconds. */
static int repeat_run(lit *l, int repeat, double *ms, double *wall, char *error, size_t error_size)
{
    const double begun = seconds_now();
    image        textures[HBIL_MAX_TEXTURES];

    if (!execute(l, textures, repeat, ms, error, error_size)) return 0;
    *wall = 1e3 * (seconds_now() - begun);
    free_images(textures);
    return 1;
}

/* Uploads and downloads are in the wall's time of one run as in that of five: the difference is four runs. */
static int run_by_wall(lit *l, int count, double *ms, char *error, size_t error_size)
{
    double one, five;
    int    i;

    for (i = 0; i < count; i++) {
        if (!repeat_run(l, 1, NULL, &one, error, error_size) || !repeat_run(l, 5, NULL, &five, error, error_size))
            return 0;
        ms[i] = fmax(0.25 * (five - one), 0.0);
    }
    return 1;
}

int lit_run(void *user, int count, double *ms, char *error, size_t error_size)
{
    lit      *l = user;
    const int passes = (int)l->plan.pass_count;
    double   *all = malloc((size_t)(count * passes) * sizeof *all), wall, sum = 0.0;
    int       i, k, ok = all != NULL;

    if (!ok) return frame_error(error, error_size, "out of memory");
    ok = repeat_run(l, count, all, &wall, error, error_size);
    for (i = 0; ok && i < count; i++)
        for (k = 0, ms[i] = 0.0; k < passes; k++) {
            ms[i] += all[i * passes + k];
            sum += all[i * passes + k];
        }
    free(all);
    return ok && sum <= 0.0 ? run_by_wall(l, count, ms, error, error_size) : ok;
}
