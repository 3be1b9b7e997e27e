/* runner.h - run a plan on a whole device of our own: makes the device, uploads inputs, executes, reads outputs back.
 * What an engine already has, in two hundred lines a backend, around backends/hbil_vk.h and hbil_gl.h. */
#ifndef HBIL_FRAME_RUNNER_H
#define HBIL_FRAME_RUNNER_H

#include "../../hbil.h"
#include "image.h"

typedef struct runner runner;

#define RUNNER_SAMPLES 4 /* of a multisampled input: what every device has */

typedef struct runner_info {
    char backend[16];       /* "vulkan", "gl", "gles" */
    char device[128];       /* "llvmpipe (LLVM 15.0.6, 256 bits)" */
    char driver[128];       /* name and version */
    char timing[64];        /* how milliseconds are measured */
} runner_info;

/* hbil_target of a backend's name, "vulkan", "gl" or "gles"; 0: there is none. */
int32_t            runner_target(const char *backend);

/* backend: see runner_target. validate != 0: Khronos validation layer (Vulkan, with synchronisation checks and best practices; those
 * messages that runner_vk.c excuses, one by one with the reason, are left out) or KHR_debug (GL); every other message counts, see
 * runner_messages. NULL: error[] says what is missing and how to get it. One thread at a time opens and closes. */
runner            *runner_open(const char *backend, int validate, char *error, size_t error_size);
void               runner_close(runner *r);
const runner_info *runner_about(const runner *r);
/* Messages of the validation layer or of GL debug output (errors and warnings) so far; they are printed to stderr too. */
int                runner_messages(const runner *r);

/* The function of environment=hook, GLSL text as hbil_emit_glsl_hook takes it, for every run from now on; NULL: none. Copied.
 * The text can use what hbil.h passes it and nothing else: the runner binds no resources for it. 1, or 0: out of memory. */
int                runner_hook(runner *r, const char *text);
/* GLSL text that takes the place of hbil_emit_glsl's for the pass of that name, in every run from now on; NULL: none. Copied.
 * One pass at a time. The text keeps to the bindings of the plan. 1, or 0: out of memory. */
int                runner_text(runner *r, const char *pass, const char *text);

/* Shaders that are not made of text: for a plan of the caller's own, whose hash tells it from all others. block: instead of what
 * hbil_pack_constants packs. */
typedef struct runner_spirv {
    const uint32_t *words[HBIL_MAX_PASSES];
    size_t          counts[HBIL_MAX_PASSES];
    const char     *entries[HBIL_MAX_PASSES];
    const void     *block;                  /* plan.constants_size bytes */
} runner_spirv;
/* For every run from now on; NULL: none. Not copied. 1, or 0: this backend takes text alone. */
int                runner_words(runner *r, const runner_spirv *spirv);

/* Run the plan on one frame. inputs: indexed by plan texture, present for every INPUT. outputs: indexed by plan texture; made
 * here for every OUTPUT (channels as the format has: r32f 1, rgba32f 4; a is kept), freed by the caller.
 * History stays from call to call while the plan and the size of the inputs do. Inputs larger than the frame: it is the corner of
 * larger textures, and its size may change without a loss of history.
 * Shapes, see hbil_dim. Inputs: 2D of at least the frame's size; CUBE 6 square slices; 3D any size. 2D_MULTISAMPLE a plain
 * image, which becomes sample plan.config.sample of RUNNER_SAMPLES; the others are filled with 7e7, so that a shader which
 * reads a wrong one shows. Outputs: 2D_ARRAY has its layers as slices.
 * repeat >= 1 executions with the same frame; ms (may be NULL) gets repeat * pass_count milliseconds, [run][pass].
 * Pipelines are kept while the plan (memcmp), the hook and the text stay the same. 1 on success, 0: error[] says why; the next run
 * then begins anew, without history. One whose device is lost runs no more: close it and open another one.
 * A runner, one thread at a time; several, on a thread each. */
int runner_run(runner *r, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
               image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size);

#endif
