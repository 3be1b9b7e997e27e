/* external.h - compute shaders that are not hbil.h's, each as a plan: SPIR-V files, and what stands at which binding.
 *
 *     spv=FILE[,entry=NAME],KEY=BINDING,...[,spv=FILE,...][,name=NAME][,depth_format=linear|device|reversed]
 *
 * BINDING: its number, or set.number. Each spv= begins a pass over the whole frame, which all bindings up to the next
 * one belong to. What a resource is, its format and the local size are read from the SPIR-V. KEY:
 *   depth normal radiance albedo   inputs: sampled images, or storage images of format r32f (depth) and rgba32f.
 *                                  Depth in metres along the view axis, sky 1e9 or more, or as depth_format says a
 *                                  depth buffer's [0, 1], forward or reversed; normals in view space, 0 where sky;
 *                                  radiance: direct light
 *   ao near                        outputs: storage images of format rgba32f, ao r32f, too. At least one
 *   uniforms                       an external_block; uniforms=push: declared as push constants
 *   any other name                 an image between passes, written as a storage image (r32f, rgba32f, rgba16f, r32ui)
 * Samplers of their own, as in HLSL, need no key: every sampler is nearest and clamps. */
#ifndef HBIL_TRADEOFF_EXTERNAL_H
#define HBIL_TRADEOFF_EXTERNAL_H

#include "common.h"
#include "runner.h"

#define EXTERNALS_MAX 8

/* The uniform block, std140. Matrices column-major; the projection takes view space (right-handed, -z forward) to ndc
 * z in [0, 1], reversed where depth_format says so, and to ndc y = -1 at the upper edge of texel row 0. */
typedef struct external_block {
    int32_t  size[2];                /* ivec2, pixels */
    float    texel[2];               /* vec2, 1 / size */
    float    projection[16], inverse_projection[16];
    float    view[16];               /* world to view */
    uint32_t frame;                  /* advances noise: 0 where errors are taken */
    uint32_t unused[3];
} external_block;

typedef struct external {
    const char  *text;               /* of the command line */
    char         name[64];           /* "external:NAME"; NAME: said, or that of the first file */
    hbil_plan    plan;               /* its hash is of all that is run, and of the name */
    runner_spirv spirv;              /* without a block */
    uint32_t    *words[HBIL_MAX_PASSES];
    char         entries[HBIL_MAX_PASSES][64];
    int          crowded;            /* a module has several entry points */
} external;

struct cost_total; /* of shadergen/cost.h */

/* Zero it first. */
typedef struct externals { external list[EXTERNALS_MAX]; int count; } externals;

/* One --external of a command line; it is kept. 1, or 0: s->error. */
int             externals_add(externals *x, settings *s, const char *text);
/* Reads them all, after the command line. An exit code; s->error says what to mend. */
int             externals_open(externals *x, settings *s);
void            externals_free(externals *x);
/* By "external:NAME". NULL: `name` is no such name. */
const external *externals_find(const externals *x, const char *name);
/* The part of help that tells --external. */
void            externals_help(void);

void external_fill(const hbil_frame *frame, external_block *out);
/* 0: it has loops of unknown length, whose steps nobody can count, or cannot be read. */
int  external_cost(const external *e, struct cost_total *out);

#endif
