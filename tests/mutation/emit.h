/* emit.h - takes hbil_emit_glsl_hook's place inside the runners of examples/frame: texts without a guard, or checked ones. */
#ifndef HBIL_MUTATION_EMIT_H
#define HBIL_MUTATION_EMIT_H

#include "../../hbil.h"

hbil_result mutation_emit(const hbil_plan *plan, int32_t pass, const char *hook, char *buf, size_t cap, size_t *need, hbil_diags *diags);

#endif
