/* runner_internal.h - what runner.c asks of a backend. One table each in runner_vk.c and runner_gl.c. */
#ifndef HBIL_FRAME_RUNNER_INTERNAL_H
#define HBIL_FRAME_RUNNER_INTERNAL_H

#include "runner.h"

/* As the functions of runner.h, which check arguments common to all backends first: inputs present, repeat >= 1, outputs
 * cleared. size: of all textures that lie on the screen; the frame may be smaller. open fills about whole and returns the device, NULL on failure. run makes the outputs; on failure runner.c frees
 * those already made. set_hook and set_text are called when their text has changed: it, and the name of the pass, stay where
 * they are until the next call; NULL: none. set_words: NULL where there is no such thing. */
typedef struct runner_ops {
    void *(*open)(int validate, runner_info *about, char *error, size_t error_size);
    void  (*close)(void *device);
    int   (*messages)(const void *device);
    void  (*set_hook)(void *device, const char *text);
    void  (*set_text)(void *device, const char *pass, const char *text);
    void  (*set_words)(void *device, const runner_spirv *spirv);
    int   (*run)(void *device, const hbil_plan *plan, const hbil_frame *frame, const uint32_t size[2],
                 const image inputs[HBIL_MAX_TEXTURES], image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size);
} runner_ops;

extern const runner_ops runner_vulkan, runner_gl, runner_gles;

#endif
