/* shrink.c - delta debugging over config, frames, screen and inputs. */
#include <string.h>
#include <time.h>

#include "shrink.h"

typedef struct shrinker { test_case *c; shrink_fails fails; void *user; double until; int tried; } shrinker;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Takes what `next` has if it still fails, and drops it otherwise. */
static int take(shrinker *s, test_case *next)
{
    int better = 0;
    case_link(next);
    if (now() < s->until) {
        ++s->tried;
        better = s->fails(s->user, next);
    }
    if (better) {
        test_case old = *s->c;
        *s->c = *next;
        case_link(s->c);
        case_free(&old);
    } else {
        case_free(next);
    }
    return better;
}

/* -------------------------------------------------------------------------------------------------------------- frames */

static int drop_frames(shrinker *s)
{
    int i, k, any = 0;
    for (i = s->c->frames - 1; i >= 0 && s->c->frames > 1; --i) {
        test_case next;
        if (!case_copy(&next, s->c)) return any;
        for (k = 0; k < CASE_INPUTS; ++k) image_free(&next.input[i][k]);
        for (k = i; k + 1 < next.frames; ++k) {
            next.frame[k] = next.frame[k + 1];
            next.live[k] = next.live[k + 1];
            memcpy(next.input[k], next.input[k + 1], sizeof next.input[k]);
        }
        --next.frames;
        memset(next.input[next.frames], 0, sizeof next.input[0]);
        any |= take(s, &next);
    }
    return any;
}

/* --------------------------------------------------------------------------------------------------------------- screen */

static int is_on_screen(int input) { return input != CASE_SKY && input != CASE_PROBES; }

static int crop_image(image *img, int x0, int y0, int width, int height)
{
    image out;
    int y;
    if (!img->data) return 1;
    if (!image_make(&out, width, height, img->channels)) return 0;
    for (y = 0; y < height; ++y)
        memcpy(out.data + y * width * img->channels, img->data + ((y + y0) * img->width + x0) * img->channels,
               (size_t)(width * img->channels) * sizeof(float));
    image_free(img);
    *img = out;
    return 1;
}

/* The rays of the pixels that stay, as they are: one row of the projection. */
static void crop_projection(float *p, int row, int size, int first, int cut_size)
{
    const double scale = (double)size / cut_size, shift = (double)(size - 2 * first) / cut_size - 1;
    int k;
    for (k = 0; k < 4; ++k) p[4 * k + row] = (float)(scale * (double)p[4 * k + row] + shift * (double)p[4 * k + 3]);
}

static int clamp_size(int v, int most) { return v < 1 ? 1 : v > most ? most : v; }

/* sides: pixels off left, right, bottom, top. */
static int crop(shrinker *s, const int sides[4])
{
    const image *depth = &s->c->input[0][CASE_DEPTH];
    const int width = depth->width - sides[0] - sides[1], height = depth->height - sides[2] - sides[3];
    test_case next;
    int i, k, ok = 1;
    if (width < 1 || height < 1 || !case_copy(&next, s->c)) return 0;
    for (i = 0; i < next.frames; ++i) {
        hbil_frame *f = &next.frame[i];
        const int w = clamp_size((int)f->width - sides[0], width), h = clamp_size((int)f->height - sides[2], height);
        crop_projection(f->projection, 0, (int)f->width, sides[0], w);
        crop_projection(f->projection, 1, (int)f->height, sides[2], h);
        f->width = (uint32_t)w;
        f->height = (uint32_t)h;
        for (k = 0; k < CASE_INPUTS; ++k)
            if (is_on_screen(k)) ok = ok && crop_image(&next.input[i][k], sides[0], sides[2], width, height);
    }
    if (next.config.width) next.config.width = width, next.config.height = height;
    if (ok) return take(s, &next);
    case_free(&next);
    return 0;
}

static int crop_all(shrinker *s)
{
    int any = 0, side, step;
    for (side = 0; side < 4; ++side) {
        const image *depth = &s->c->input[0][CASE_DEPTH];
        for (step = (side < 2 ? depth->width : depth->height) / 2; step >= 1; step /= 2)
            for (;;) {
                int sides[4] = { 0, 0, 0, 0 };
                sides[side] = step;
                if (!crop(s, sides)) break;
                any = 1;
            }
    }
    return any;
}

/* -------------------------------------------------------------------------------------------------------------- config */

/* Options [first, first + count) to their defaults; dynamic ones too. */
static int reset_options(shrinker *s, int first, int count)
{
    hbil_config c = s->c->config, resolved;
    test_case next;
    int i;
    for (i = first; i < first + count; ++i) {
        const hbil_option *o = hbil_option_at(i);
        memset((char *)&c + o->offset, 0, 4);
        if (strcmp(o->name, "dynamic")) c.dynamic &= ~o->dynamic;
    }
    c.target = s->c->config.target;
    if (!s->c->config.width != !c.width || !s->c->config.height != !c.height) c.width = c.height = 0;
    if (hbil_config_resolve(&c, &resolved, NULL) != HBIL_OK) return 0;
    if (memcmp(&resolved, &s->c->config, sizeof resolved) == 0) return 0;
    if (!case_copy(&next, s->c)) return 0;
    if (resolved.depth != next.config.depth || resolved.normal_encoding != next.config.normal_encoding)
        for (i = 0; i < next.frames; ++i) image_free(&next.input[i][CASE_NORMAL]); /* made plain in the other encoding */
    next.config = resolved;
    return take(s, &next);
}

/* The values of uniforms as literals. */
static int bake(shrinker *s, uint32_t dynamic)
{
    test_case next;
    int32_t i;
    int frame;
    if (!(s->c->config.dynamic & dynamic) || !case_copy(&next, s->c)) return 0;
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        uint32_t v;
        if (!(next.config.dynamic & dynamic & o->dynamic)) continue;
        memcpy(&v, (char *)&next.live[next.frames - 1] + o->offset, 4);
        if (v) memcpy((char *)&next.config + o->offset, &v, 4);
        for (frame = 0; frame < next.frames; ++frame) memset((char *)&next.live[frame] + o->offset, 0, 4);
    }
    next.config.dynamic &= ~dynamic;
    if (hbil_config_resolve(&next.config, &next.config, NULL) == HBIL_OK) return take(s, &next);
    case_free(&next);
    return 0;
}

/* Numbers of loops: as few as possible. */
static int least(shrinker *s, int32_t option)
{
    const hbil_option *o = hbil_option_at(option);
    test_case next;
    int32_t v;
    int any = 0;
    for (;;) {
        memcpy(&v, (const char *)&s->c->config + o->offset, 4);
        if (v <= 1 || !case_copy(&next, s->c)) return any;
        v = v > 3 ? v / 2 : v - 1;
        memcpy((char *)&next.config + o->offset, &v, 4);
        if (hbil_config_resolve(&next.config, &next.config, NULL) != HBIL_OK) return case_free(&next), any;
        if (!take(s, &next)) return any;
        any = 1;
    }
}

/* Halves, quarters, and so on down to single options. */
static int reset_config(shrinker *s)
{
    const int n = hbil_option_count();
    int size, first, bit, any = bake(s, ~0u);
    for (bit = 0; bit < 32; ++bit) any |= bake(s, 1u << bit);
    for (size = n; size >= 1; size = size > 1 ? (size + 1) / 2 : 0)
        for (first = 0; first < n; first += size) any |= reset_options(s, first, first + size > n ? n - first : size);
    any |= least(s, hbil_option_find("slices", 6, NULL));
    any |= least(s, hbil_option_find("steps", 5, NULL));
    return any;
}

/* --------------------------------------------------------------------------------------------------------------- camera */

static void plain_camera(shrinker *s)
{
    int i, k, field;
    for (field = 0; field < 4; ++field) {
        test_case next;
        if (!case_copy(&next, s->c)) return;
        for (i = 0; i < next.frames; ++i) {
            hbil_frame *f = &next.frame[i];
            if (field == 0) f->index = (uint32_t)i;
            if (field == 1) memset(f->view, 0, sizeof f->view), f->view[0] = f->view[5] = f->view[10] = f->view[15] = 1;
            if (field == 2) {
                memset(f->far_sh, 0, sizeof f->far_sh);
                memset(f->probe_origin, 0, sizeof f->probe_origin);
                for (k = 0; k < 3; ++k) f->far_color[k] = f->probe_step[k] = 1;
            }
            if (field == 3) f->projection[8] = f->projection[9] = f->projection[12] = f->projection[13] = 0;
        }
        take(s, &next);
    }
}

/* --------------------------------------------------------------------------------------------------------------- inputs */

/* Pixels [first, first + count) of an input as `plain` has them. */
static int plain_range(shrinker *s, int frame, int input, const image *plain, int first, int count)
{
    const image *img = &s->c->input[frame][input];
    const size_t bytes = (size_t)(count * img->channels) * sizeof(float);
    const int at = first * img->channels;
    test_case next;
    if (plain->channels != img->channels || memcmp(img->data + at, plain->data + at, bytes) == 0) return 0;
    if (!case_copy(&next, s->c)) return 0;
    memcpy(next.input[frame][input].data + at, plain->data + at, bytes);
    return take(s, &next);
}

static int plain_by_halves(shrinker *s, int frame, int input, const image *plain, int first, int count)
{
    if (now() >= s->until) return 0;
    if (plain_range(s, frame, input, plain, first, count)) return 1;
    if (count < 2) return 0;
    return plain_by_halves(s, frame, input, plain, first, count / 2) |
           plain_by_halves(s, frame, input, plain, first + count / 2, count - count / 2);
}

/* whole: only all of it at once. */
static int plain_inputs(shrinker *s, int whole)
{
    int any = 0, i, k;
    for (i = 0; i < s->c->frames; ++i)
        for (k = CASE_INPUTS - 1; k >= 0; --k) {
            const image *img = &s->c->input[i][k];
            const int n = img->width * img->height * image_slices(img);
            image plain = { 0, 0, 0, NULL, 0 };
            if (!img->data || !case_plain(&s->c->config, &s->c->frame[i], k, img->width, img->height, &plain)) continue;
            if (plain.width == img->width && plain.height == img->height && image_slices(&plain) == image_slices(img))
                any |= whole ? plain_range(s, i, k, &plain, 0, n) : plain_by_halves(s, i, k, &plain, 0, n);
            image_free(&plain);
        }
    return any;
}

/* Inputs that the plan does not read any more, or for which plain ones do as well. */
static void drop_unread(shrinker *s)
{
    hbil_plan plan;
    int i, k;
    if (hbil_plan_build(&s->c->config, &plan, NULL) != HBIL_OK) return;
    for (i = 0; i < s->c->frames; ++i)
        for (k = CASE_DEPTH + 1; k < CASE_INPUTS; ++k) {
            const int32_t t = hbil_plan_texture(&plan, case_inputs[k]);
            if (t < 0 || plan.textures[t].life != HBIL_LIFE_INPUT) image_free(&s->c->input[i][k]);
        }
    for (i = 0; i < s->c->frames; ++i)
        for (k = CASE_INPUTS - 1; k > CASE_DEPTH; --k) {
            test_case next;
            if (!s->c->input[i][k].data || !case_copy(&next, s->c)) continue;
            image_free(&next.input[i][k]);
            take(s, &next);
        }
}

int shrink(test_case *c, shrink_fails fails, void *user, double seconds)
{
    shrinker s;
    int round, any = 1;
    s.c = c;
    s.fails = fails;
    s.user = user;
    s.until = now() + seconds;
    s.tried = 0;
    reset_options(&s, hbil_option_find("width", 5, NULL), 2); /* a baked size is another shader for each crop */
    for (round = 0; round < 8 && any; ++round) { /* what costs no new shaders first */
        any = drop_frames(&s);
        any |= crop_all(&s);
        any |= plain_inputs(&s, 1);
        any |= reset_config(&s);
        any |= crop_all(&s);
        plain_camera(&s);
        any |= plain_inputs(&s, 0);
    }
    drop_unread(&s);
    return s.tried;
}
