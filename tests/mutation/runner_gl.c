/* runner_gl.c - examples/frame/runner_gl.c with mutation_emit. */
#include "emit.h"
#define hbil_emit_glsl_hook mutation_emit
#include "../../examples/frame/runner_gl.c"
