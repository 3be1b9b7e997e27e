/* twin.h - runs a plan on the CPU by the emitted text itself, compiled as C++ through glsl.hpp, in float or in double: what runner.h does on a
 * device. Link with hbil_twin (CMake); include hbil.h with its implementation in one file of the program. One thread at a time.
 *
 * The text is compiled when a plan is first seen, by the compiler of the build, into a library that is kept in the build folder under the hash
 * of its source. What Vulkan leaves undefined is counted, see twin_faults. */
#ifndef HBIL_TWIN_H
#define HBIL_TWIN_H

#include "../../hbil.h"
#ifdef __cplusplus
extern "C" {
#endif
#include "../../examples/frame/image.h"
#include "twin_abi.h"

enum { TWIN_FLOAT, TWIN_DOUBLE };
enum {
    TWIN_SANITIZE = 1, /* UndefinedBehaviorSanitizer in the shader: shifts, overflow of int, divisions by zero, conversions. Ends the program */
    TWIN_STICKY = 2,   /* min and max give NaN if one of their operands is: GLSL leaves it open */
    TWIN_LOOSE = 4     /* results are as far off as Vulkan's table of precision allows, denormals are 0, products fused with sums */
};
typedef struct twin twin;

/* NULL: out of memory. */
twin *twin_open(int precision, int flags);
void  twin_close(twin *t);
/* As runner_hook and runner_text. 1, or 0: out of memory. */
int   twin_hook(twin *t, const char *text);
int   twin_text(twin *t, const char *pass, const char *text);
/* Compile the texts of a plan, if there is no library of them yet. 1, or 0: error[] has what the compiler says. */
int   twin_compile(twin *t, const hbil_plan *plan, char *error, size_t error_size);
/* As runner_run. Textures begin as NaN and 0xffffffff, transients in every frame; texels of an output that no pass wrote are NaN. */
int   twin_run(twin *t, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
               image outputs[HBIL_MAX_TEXTURES], char *error, size_t error_size);
/* A history texture becomes NaN (unsigned: all ones), as if a fault had got into it. */
void  twin_spoil(twin *t, int32_t texture);
/* Outputs of the last run before they were rounded to float, in the layout of its images; NULL: none. */
const double *twin_output(const twin *t, int32_t texture);
/* Work of a pass in the last run. */
twin_counts twin_counted(const twin *t, uint32_t pass);
/* Faults since twin_open or the last twin_forgive. */
const twin_faults *twin_faulted(const twin *t);
void  twin_forgive(twin *t);
/* 1: nothing has been counted; 0: why[] names the first of each kind. */
int   twin_faultless(const twin *t, char *why, size_t size);

#ifdef __cplusplus
}
#endif
#endif
