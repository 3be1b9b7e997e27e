/* truths.h - small frames whose light is known, each true only while some guard of the shaders stands: what kills most mutations of
 * tests/mutation. The test mutation_truths runs them with all guards in place. */
#ifndef HBIL_EXTREME_TRUTHS_H
#define HBIL_EXTREME_TRUTHS_H

#include "cases.h"

extern const extreme_case extreme_truths[];
extern const int extreme_truth_count;

#endif
