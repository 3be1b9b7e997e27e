/* devices.h - where extreme cases run: a table of everything that executes a plan. */
#ifndef HBIL_EXTREME_DEVICES_H
#define HBIL_EXTREME_DEVICES_H

#include "../../hbil.h"
#include "../../examples/frame/image.h"

typedef struct device device;

/* Their names. twin: the shaders' text compiled for the CPU, where min and max of NaN give NaN. loose: the same, as inaccurate as Vulkan's
 * table of precision allows, denormals flushed, products fused with sums where the processor can. */
#define DEVICES "vulkan, gl, gles, twin or loose"
int         device_known(const char *name);
/* NULL: error[] says what is missing. */
device     *device_open(const char *name, char *error, size_t error_size);
void        device_close(device *d);
const char *device_name(const device *d);
/* The config's target for its plans. */
const char *device_target(const device *d);
/* As runner_run: inputs and outputs by plan texture, outputs are made here and freed by the caller. */
int         device_run(device *d, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
                       image outputs[HBIL_MAX_TEXTURES], char *error, size_t error_size);
/* As runner_text: this text takes the place of hbil_emit_glsl's for a pass, from now on; NULL: none. 1, or 0: out of memory. */
int         device_text(device *d, const char *pass, const char *text);
/* As runner_hook: the function of environment=hook; NULL: none. 1, or 0: out of memory. */
int         device_hook(device *d, const char *text);

#endif
