/* contract.h - what every output of every frame must hold, whatever the inputs are: the sentence "outputs are finite, ao is in [0, 1], near
 * light is not negative and not above the brightest radiance, bent vectors are not longer than 1" as a function. */
#ifndef HBIL_EXTREME_CONTRACT_H
#define HBIL_EXTREME_CONTRACT_H

#include "../../hbil.h"
#include "../../examples/frame/image.h"

/* The largest radiance that a frame can send to a receiver: largest channel of the input `radiance` as the shader reads it, with firefly and
 * near_intensity. With bounces=recursive 60000 times that: history may be of a brighter frame. 0 where the plan reads none. */
double contract_brightest(const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES]);

/* Values checked so far by contract_holds, of all outputs. */
extern unsigned long long contract_values;

/* Do the outputs of a run keep the contract? inputs, outputs: by plan texture, as runner_run has them. 0: why[] names the output, the pixel,
 * the value and the bound. */
int contract_holds(const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
                   const image outputs[HBIL_MAX_TEXTURES], char *why, size_t size);

#endif
