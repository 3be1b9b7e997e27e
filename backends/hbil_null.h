/* hbil_null.h - executes nothing, proves a plan.
 *
 * Walks a plan as an executor would, over several frames, and reports every fault. Use it on plans that you edit, reorder
 * or merge into a render graph of your own.
 *
 * [x] every texture is written before it is read, in the frame or by an older copy
 * [x] no texture is read and written by one pass
 * [x] barriers are complete: every hazard between two passes has one
 * [x] barriers are minimal: each one orders at least one hazard that no other orders
 * [x] slots are unique in their name space and start where the target wants them
 * [x] grids cover their domain, or the lines of a sweep, and are not a group too large; roles that fit access and age
 * [x] shapes: only inputs are multisampled, cubes or 3D; what is written is 2D or 2D_ARRAY; layers fit the shape
 * [x] ages below copies, mips below mips, indices in range, outputs written, no texture unused
 * [ ] aliasing of transient memory: needs lifetimes, a later version
 *
 * OWNERSHIP  the plan and the diagnostics: yours. No memory is taken.
 *
 * INTEGRATION
 *   1. In one file: #define HBIL_NULL_IMPLEMENTATION, then include this file. hbil.h is found beside it or comes first.
 *   2. hbil_plan_build(&config, &plan, NULL).
 *   3. hbil_diag items[16]; hbil_diags diags = { items, 16, 0 };
 *   4. int faults = hbil_null_check(&plan, width, height, &diags);
 *   5. 0: run it. Else print items[i].text.
 *
 * CHANGELOG
 *   2026-11-25  NEW lines, roles.
 *   2026-11-24  NEW shapes.
 *   2026-11     NEW first version. */
#ifndef HBIL_NULL_H
#define HBIL_NULL_H

#ifndef HBIL_H
#include "hbil.h"
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Number of faults at render size width x height, each added to diags (may be NULL). */
int hbil_null_check(const hbil_plan *plan, uint32_t width, uint32_t height, hbil_diags *diags);

#ifdef __cplusplus
}
#endif
#endif /* HBIL_NULL_H */

#ifdef HBIL_NULL_IMPLEMENTATION
#ifndef HBIL_NULL_IMPLEMENTED
#define HBIL_NULL_IMPLEMENTED

#include <stdio.h>
#include <string.h>

#define HBIL_NULL__FRAMES 4 /* the last one has met every copy of a two-copy history in every role */
#define HBIL_NULL__EVENTS (HBIL_NULL__FRAMES * HBIL_MAX_PASSES * HBIL_MAX_BINDINGS)

/* One access of one pass of one frame to one copy of a texture. time counts passes over all frames. */
typedef struct hbil_null__event { int time, texture, copy, write; } hbil_null__event;

typedef struct hbil_null__walk {
    const hbil_plan *plan;
    hbil_diags      *diags;
    int              faults, event_count;
    hbil_null__event events[HBIL_NULL__EVENTS];
    uint8_t          useful[HBIL_MAX_PASSES][HBIL_MAX_BINDINGS]; /* barriers that order a hazard of the last frame */
} hbil_null__walk;

static void hbil_null__fault(hbil_null__walk *w, int pass, int texture, const char *what)
{
    const hbil_plan *p = w->plan;
    ++w->faults;
    if (!w->diags) return;
    if (w->diags->count < w->diags->capacity) {
        hbil_diag *d = &w->diags->items[w->diags->count];
        d->severity = HBIL_ERROR;
        d->option = -1;
        snprintf(d->text, sizeof d->text, "%.19s%s%.19s: %s", pass >= 0 ? p->passes[pass].name : "plan", texture >= 0 ? " " : "",
                 texture >= 0 ? p->textures[texture].name : "", what);
    }
    ++w->diags->count;
}

static void hbil_null__check_shape(hbil_null__walk *w, int texture)
{
    const hbil_texture *t = &w->plan->textures[texture];
    if (!t->copies || !t->mips || !t->div) hbil_null__fault(w, -1, texture, "copies, mips and div must be at least 1");
    if (t->dim < HBIL_DIM_2D || t->dim > HBIL_DIM_3D) hbil_null__fault(w, -1, texture, "dim is no hbil_dim");
    if (!t->layers) hbil_null__fault(w, -1, texture, "layers must be at least 1");
    if (t->layers > 1 && t->dim != HBIL_DIM_2D_ARRAY) hbil_null__fault(w, -1, texture, "layers, but dim is not 2D_ARRAY");
    if (t->mips > 1 && t->dim == HBIL_DIM_2D_MULTISAMPLE) hbil_null__fault(w, -1, texture, "a multisampled texture has no mips");
    if (t->life != HBIL_LIFE_INPUT && t->dim != HBIL_DIM_2D && t->dim != HBIL_DIM_2D_ARRAY)
        hbil_null__fault(w, -1, texture, "only an input may be multisampled, a cube or 3D");
}

/* Counts and indices, so that everything after may trust them. */
static int hbil_null__check_tables(hbil_null__walk *w)
{
    const hbil_plan *p = w->plan;
    uint32_t i, b, t;
    if (p->pass_count > HBIL_MAX_PASSES || p->texture_count > HBIL_MAX_TEXTURES || p->constant_count > HBIL_MAX_CONSTANTS) {
        hbil_null__fault(w, -1, -1, "a count is larger than its table");
        return 0;
    }
    for (i = 0; i < p->pass_count; ++i)
        if (p->passes[i].grid == HBIL_GRID_LINES && (p->config.sweep_stride < 1 || p->config.sweep_stride > 16384)) {
            hbil_null__fault(w, (int)i, -1, "grid of lines, but config.sweep_stride is out of range");
            return 0;
        }
    for (t = 0; t < p->texture_count; ++t) hbil_null__check_shape(w, (int)t);
    for (i = 0; i < p->pass_count; ++i) {
        const hbil_pass *pass = &p->passes[i];
        if (pass->binding_count > HBIL_MAX_BINDINGS || pass->barrier_count > HBIL_MAX_BINDINGS ||
            pass->domain >= p->texture_count || !pass->group[0] || !pass->group[1]) {
            hbil_null__fault(w, (int)i, -1, "binding or barrier count, domain or group out of range");
            return 0;
        }
        for (b = 0; b < pass->binding_count; ++b)
            if (pass->bindings[b].texture >= p->texture_count) hbil_null__fault(w, (int)i, -1, "binding to a texture that does not exist");
        for (b = 0; b < pass->barrier_count; ++b)
            if (pass->barriers[b].texture >= p->texture_count) hbil_null__fault(w, (int)i, -1, "barrier on a texture that does not exist");
    }
    return w->faults == 0;
}

/* Shapes against what the passes do with them. */
static void hbil_null__check_pass(hbil_null__walk *w, int pass)
{
    const hbil_plan *p = w->plan;
    const hbil_pass *a = &p->passes[pass];
    uint16_t domain = p->textures[a->domain].dim, dim;
    uint32_t i;
    if (domain == HBIL_DIM_CUBE || domain == HBIL_DIM_3D)
        hbil_null__fault(w, pass, a->domain, "the domain has a size of your own, the grid goes by the frame's");
    if (a->hook && p->config.environment != HBIL_ENVIRONMENT_HOOK) hbil_null__fault(w, pass, -1, "hook, but environment is not hook");
    for (i = 0; i < a->binding_count; ++i) {
        dim = p->textures[a->bindings[i].texture].dim;
        if (a->bindings[i].access == HBIL_ACCESS_WRITE && dim != HBIL_DIM_2D && dim != HBIL_DIM_2D_ARRAY)
            hbil_null__fault(w, pass, a->bindings[i].texture, "written, but neither 2D nor 2D_ARRAY");
    }
}

/* What a fragment shader draws: as large as the pass, in targets of its own. */
static void hbil_null__check_target(hbil_null__walk *w, int pass, const hbil_binding *x, uint32_t targets)
{
    const hbil_plan *p = w->plan;
    const hbil_pass *a = &p->passes[pass];
    const hbil_binding *y;
    if (p->textures[x->texture].div != p->textures[a->domain].div) hbil_null__fault(w, pass, x->texture, "target of another size than the domain");
    if (x->role == HBIL_ROLE_UPDATE) hbil_null__fault(w, pass, x->texture, "drawn and read by one pass");
    if ((uint32_t)x->slot + p->textures[x->texture].layers > targets) hbil_null__fault(w, pass, x->texture, "more targets than every device has");
    for (y = a->bindings; y < x; ++y)
        if (y->access == HBIL_ACCESS_WRITE && x->slot < y->slot + p->textures[y->texture].layers && y->slot < x->slot + p->textures[x->texture].layers)
            hbil_null__fault(w, pass, x->texture, "target used twice");
}

static void hbil_null__check_slots(hbil_null__walk *w, int pass)
{
    const hbil_plan *p = w->plan;
    const hbil_pass *a = &p->passes[pass];
    int gl = p->config.target != HBIL_TARGET_VULKAN, draws = p->config.stage == HBIL_STAGE_FRAGMENT;
    uint32_t i, j, targets = p->config.target == HBIL_TARGET_GLES ? 4 : 8; /* that every device has */
    for (i = 0; i < a->binding_count; ++i) {
        const hbil_binding *x = &a->bindings[i];
        if (!gl && a->constants && x->slot == p->constants_slot) hbil_null__fault(w, pass, x->texture, "slot of the uniform block");
        if (gl && x->slot >= (x->access == HBIL_ACCESS_WRITE ? 8 : 16)) hbil_null__fault(w, pass, x->texture, "more units than GL 4.3 promises");
        if (draws && x->access == HBIL_ACCESS_WRITE) hbil_null__check_target(w, pass, x, targets);
        if (x->role < HBIL_ROLE_SAMPLE || x->role >= HBIL_ROLE_COUNT) hbil_null__fault(w, pass, x->texture, "role is no hbil_role");
        if (x->role == HBIL_ROLE_UPDATE && x->access != HBIL_ACCESS_WRITE) hbil_null__fault(w, pass, x->texture, "update, but not written");
        if ((x->role == HBIL_ROLE_LAST) != (x->age > 0)) hbil_null__fault(w, pass, x->texture, "last frame's, but its age is not 1");
        if (x->age >= p->textures[x->texture].copies) hbil_null__fault(w, pass, x->texture, "age is not below copies");
        if (x->mip >= p->textures[x->texture].mips) hbil_null__fault(w, pass, x->texture, "mip is not below mips");
        for (j = 0; j < i; ++j) {
            const hbil_binding *y = &a->bindings[j];
            if (x->slot == y->slot && (!gl || x->access == y->access)) hbil_null__fault(w, pass, x->texture, "slot used twice");
            if (x->texture == y->texture && x->age == y->age && x->access != y->access)
                hbil_null__fault(w, pass, x->texture, "read and written by one pass");
        }
    }
}

static void hbil_null__check_grid(hbil_null__walk *w, int pass, const hbil_dispatch *grid, uint32_t width, uint32_t height)
{
    const hbil_pass *a = &w->plan->passes[pass];
    uint32_t wh[2], k;
    if (hbil_plan_extent(w->plan, a->domain, width, height, wh) != HBIL_OK) return; /* reported by hbil_null_check */
    if (a->grid == HBIL_GRID_LINES) { /* a stride's last lines may begin outside */
        uint32_t stride = (uint32_t)w->plan->config.sweep_stride;
        wh[0] = ((wh[0] > wh[1] ? wh[0] : wh[1]) + stride - 1) / stride * stride;
        wh[1] = w->plan->textures[a->domain].layers;
    }
    for (k = 0; k < 2; ++k) {
        if (grid->groups[k] * a->group[k] < wh[k]) hbil_null__fault(w, pass, a->domain, "grid does not cover the domain");
        if (grid->groups[k] == 0 || (grid->groups[k] - 1) * a->group[k] >= wh[k])
            hbil_null__fault(w, pass, a->domain, "grid is a group too large");
    }
}

/* All accesses of all frames in order; reads of nothing. */
static void hbil_null__run(hbil_null__walk *w)
{
    const hbil_plan *p = w->plan;
    int f, i, e;
    uint32_t b;
    for (f = 0; f < HBIL_NULL__FRAMES; ++f)
        for (i = 0; i < (int)p->pass_count; ++i)
            for (b = 0; b < p->passes[i].binding_count; ++b) {
                const hbil_binding *bind = &p->passes[i].bindings[b];
                const hbil_texture *t = &p->textures[bind->texture];
                hbil_null__event *now = &w->events[w->event_count];
                int first = f * (int)p->pass_count, written = t->life == HBIL_LIFE_INPUT;
                now->time = first + i;
                now->texture = bind->texture;
                now->copy = (f + t->copies - bind->age % t->copies) % t->copies;
                now->write = bind->access == HBIL_ACCESS_WRITE;
                for (e = 0; e < w->event_count; ++e) /* a transient's contents do not survive its frame */
                    if (w->events[e].texture == now->texture && w->events[e].copy == now->copy && w->events[e].write &&
                        (w->events[e].time >= first || t->life == HBIL_LIFE_HISTORY)) written = 1;
                if (!now->write && !written && f == HBIL_NULL__FRAMES - 1)
                    hbil_null__fault(w, i, bind->texture, "read before it is written");
                if (now->write && t->life == HBIL_LIFE_INPUT) hbil_null__fault(w, i, bind->texture, "an input is written");
                ++w->event_count;
            }
}

/* Is there a barrier after event a, up to and including the pass of event b? Marks the first that is. */
static int hbil_null__ordered(hbil_null__walk *w, const hbil_null__event *a, const hbil_null__event *b)
{
    const hbil_plan *p = w->plan;
    int time, found = 0, count = (int)p->pass_count;
    uint32_t k;
    for (time = a->time + 1; time <= b->time && !found; ++time)
        for (k = 0; k < p->passes[time % count].barrier_count; ++k) {
            const hbil_barrier *bar = &p->passes[time % count].barriers[k];
            if (bar->texture != a->texture || bar->before != (a->write ? HBIL_ACCESS_WRITE : HBIL_ACCESS_SAMPLE) ||
                bar->after != (b->write ? HBIL_ACCESS_WRITE : HBIL_ACCESS_SAMPLE)) continue;
            w->useful[time % count][k] = 1; /* of any frame: all have the same barriers */
            found = 1;
            break;
        }
    return found;
}

/* Every hazard of the last frame: a read after the last write; a write after the reads since the last write, or, where
 * there were none, after that write. Your own textures: hazards within the frame only. */
static void hbil_null__check_barriers(hbil_null__walk *w)
{
    const hbil_plan *p = w->plan;
    int i, j, count = (int)p->pass_count, last = (HBIL_NULL__FRAMES - 1) * count;
    uint32_t k;
    for (i = 0; i < w->event_count; ++i) {
        const hbil_null__event *b = &w->events[i];
        int yours = p->textures[b->texture].life <= HBIL_LIFE_OUTPUT, reads = 0;
        if (b->time < last) continue;
        for (j = i - 1; j >= 0; --j) {
            const hbil_null__event *a = &w->events[j];
            if (a->texture != b->texture || a->copy != b->copy || a->time == b->time || (yours && a->time < last)) continue;
            if (!a->write && !b->write) continue;
            if (!a->write) ++reads;
            if ((!a->write || !b->write || !reads) && !hbil_null__ordered(w, a, b))
                hbil_null__fault(w, b->time % count, b->texture, !b->write ? "no barrier between write and read" :
                                 a->write ? "no barrier between two writes" : "no barrier between read and write");
            if (a->write) break;
        }
    }
    for (i = 0; i < count; ++i)
        for (k = 0; k < p->passes[i].barrier_count; ++k)
            if (!w->useful[i][k]) hbil_null__fault(w, i, p->passes[i].barriers[k].texture, "barrier without need");
}

static void hbil_null__check_use(hbil_null__walk *w)
{
    uint32_t t;
    int e;
    for (t = 0; t < w->plan->texture_count; ++t) {
        int used = 0, written = 0;
        for (e = 0; e < w->event_count; ++e)
            if (w->events[e].texture == (int)t) used = 1, written |= w->events[e].write;
        if (!used) hbil_null__fault(w, -1, (int)t, "no pass uses it");
        else if (!written && w->plan->textures[t].life != HBIL_LIFE_INPUT) hbil_null__fault(w, -1, (int)t, "never written");
    }
}

int hbil_null_check(const hbil_plan *plan, uint32_t width, uint32_t height, hbil_diags *diags)
{
    hbil_null__walk w;
    hbil_dispatch grid[HBIL_MAX_PASSES];
    hbil_frame frame;
    int i;
    memset(&w, 0, sizeof w);
    memset(&frame, 0, sizeof frame);
    w.plan = plan;
    w.diags = diags;
    frame.width = width;
    frame.height = height;
    if (!hbil_null__check_tables(&w)) return w.faults;
    if (hbil_plan_frame(plan, &frame, grid) != HBIL_OK) {
        hbil_null__fault(&w, -1, -1, "width and height must be in [1, 16384]");
        return w.faults;
    }
    for (i = 0; i < (int)plan->pass_count; ++i) {
        hbil_null__check_pass(&w, i);
        hbil_null__check_slots(&w, i);
        hbil_null__check_grid(&w, i, &grid[i], width, height);
    }
    hbil_null__run(&w);
    hbil_null__check_barriers(&w);
    hbil_null__check_use(&w);
    return w.faults;
}

#endif /* HBIL_NULL_IMPLEMENTED */
#endif /* HBIL_NULL_IMPLEMENTATION */
