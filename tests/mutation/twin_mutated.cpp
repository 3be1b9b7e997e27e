/* twin_mutated.cpp - tests/twin/twin.cpp with mutation_emit. */
extern "C" {
#include "emit.h"
}
#define hbil_emit_glsl_hook mutation_emit
#define hbil_emit_glsl(plan, pass, buf, cap, need) mutation_emit(plan, pass, nullptr, buf, cap, need, nullptr)
#include "../twin/twin.cpp"
