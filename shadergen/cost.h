/* cost.h - what a pass costs a pixel, counted from its SPIR-V: texture accesses, arithmetic, bytes, registers.
 *
 * Every figure is an upper bound of its own: that of the way through the branches on which it is largest; every loop
 * runs to its end; no read is shared or cached. Trip counts are found by running the induction variable, from a
 * constant through constants and dynamic options (the values of plan->config). Loops whose length only the data knows
 * are counted apart, per step.
 *
 * floats     each component of a vector counts: a dot product of 3 is 5, fma 2, mix 3, a length its dot product and a
 *            root. absolute values and signs are free: they are modifiers.
 * divide     also of integers, unless by a constant.
 * bytes      texels of the plan's formats. Formats of your own: depth 4 (r32f), all others 8 (rgba16f). A filtered read
 *            is one texel; an atomic reads and writes one.
 * registers  most 32-bit values that are alive at once, arrays included, constants left out. What a compiler makes of
 *            it is its own affair: an estimate, to compare configs with. */
#ifndef SHADERGEN_COST_H
#define SHADERGEN_COST_H

#include "build.h"

#include <stdio.h>

#define COST_LOOPS_MAX 16 /* loops of unknown length in one pass */

enum { COST_FETCH, COST_LOAD, COST_STORE, COST_ATOMIC, COST_ACCESSES }; /* sampled; image; image; image */

/* Float: add, multiply. Root: sqrt, inversesqrt. Transcendental: sin, cos, exp, log, pow, acos, atan and kin. Integer:
 * bits too. Convert: rounding, packing too. Compare: min, max, clamp, select, logic too. Branch: conditional ones. */
enum { COST_FLOAT, COST_DIVIDE, COST_ROOT, COST_TRANSCENDENTAL, COST_INTEGER, COST_CONVERT, COST_COMPARE, COST_BRANCH,
       COST_CLASSES };

/* All members are doubles: an invocation of a coarse grid is a part of a pixel. */
typedef struct cost_counts {
    double access[COST_ACCESSES];                     /* of all textures, a hook's too */
    double texture[COST_ACCESSES][HBIL_MAX_TEXTURES]; /* by index into plan->textures */
    double bytes_read, bytes_written;
    double ops[COST_CLASSES];
    double shared;                                    /* loads and stores of shared memory */
    double enters[COST_LOOPS_MAX];                    /* times that a loop of unknown length is entered */
} cost_counts;

/* Of one invocation of a pass. */
typedef struct cost {
    cost_counts fixed;                /* outside of loops of unknown length */
    cost_counts step[COST_LOOPS_MAX]; /* one step of each; the last test counts as one */
    int32_t     loops;                /* of unknown length; outer ones come first */
    int32_t     registers;
    const char *error;                /* NULL; or why the words cannot be counted, static text */
} cost;

/* Of a whole plan per pixel of the frame: a pass on a coarser grid counts its part. */
typedef struct cost_total {
    cost_counts fixed; /* enters is zero: their numbers belong to one pass */
    cost_counts loops; /* one step of each loop of unknown length, each time it is entered */
    int32_t     unknown, registers; /* loops of unknown length; most registers of a pass */
} cost_total;

/* words: of a compute shader, as hbil_glslang_optimize makes them. Others are counted as well, but loops over variables
 * that are not in SSA form are of unknown length. Whatever the words are, nothing outside of them is read. 1 on
 * success, 0: see out->error. plan: of target=vulkan or gl, as the words are. */
int  cost_of_words(const hbil_plan *plan, int32_t pass, const uint32_t *words, size_t count, cost *out);
/* Makes the words and counts them. hook may be NULL. target=gl counts as vulkan. An exit code of build.h; says why on
 * stderr. */
int  cost_of_pass(const hbil_plan *plan, int32_t pass, const hook_file *hook, cost *out);
int  cost_of_plan(const hbil_plan *plan, const hook_file *hook, cost_total *out);
/* The same of many plans: texts that were compiled already are kept. Zero it first; a thread each. hbil_glslang_init has been called. */
typedef struct cost_cache { struct cost_compiled *items; int count; } cost_cache;
int  cost_of_plans(const hbil_plan *plan, cost_cache *cache, cost_total *out);
void cost_cache_free(cost_cache *cache);
/* What a pixel of the pass's grid does; out->enters times the unknown comes on top. A walk of a LINES grid passes
 * each pixel of its layer once: a pixel has one step of it in each layer. */
void cost_per_pixel(const hbil_plan *plan, int32_t pass, const cost *c, cost_counts *out);
/* Adds a pass to what a plan costs. */
void cost_add(const hbil_plan *plan, int32_t pass, const cost *c, cost_total *to);
/* The report: passes, totals, and what each option that is not the default, and each output, adds. An exit code of
 * build.h. */
int  cost_print(FILE *out, const hbil_plan *plan, const hook_file *hook);

#endif
