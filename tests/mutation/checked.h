/* checked.h - the shaders' text with every operation looked at that GLSL leaves undefined: what a driver may forgive is a fault here. */
#ifndef HBIL_MUTATION_CHECKED_H
#define HBIL_MUTATION_CHECKED_H

#include "../../hbil.h"
#include "../../examples/frame/image.h"

enum { CHECKED_TEXT_MAX = 4 * HBIL_GLSL_MAX };

/* The plan with one output more, "faults", a layer for each pass. For Vulkan, stage=compute. */
void checked_plan(const hbil_plan *plan, hbil_plan *out);
/* And back. Returns 1 if it was such a plan. */
int  checked_strip(const hbil_plan *plan, hbil_plan *out);
/* The text of a pass as emitted, to one that looks at itself. */
void checked_text(const hbil_plan *checked, int32_t pass, const char *text, char out[CHECKED_TEXT_MAX]);
/* No fault in any pass? 0: why[] names pass, kind and pixel. faults: the output of that name. */
int  checked_holds(const hbil_plan *checked, const image *faults, char *why, size_t size);

#endif
