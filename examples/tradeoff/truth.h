/* truth.h - what an output is held against, each for itself:
 *   model      the path-traced channels of the frame: light of the scene
 *   field      rays through the depth buffer as a solid height field: the best that the frame's depth can give a height
 * field converged  the config's own estimator with so many samples that no noise is left: what its samples can buy Near
 * and far light of frames with f0 are held against truths times 1 - F0. Fields and converged images are kept as EXR in
 * the cache folder, under a hash of all that they depend on. */
#ifndef HBIL_TRADEOFF_TRUTH_H
#define HBIL_TRADEOFF_TRUTH_H

#include "lit.h"

typedef struct truth {
    image          model[OUTS], bounce;     /* absent where the frame has none; bounce: near light of all bounces */
    image          field[OUTS];
    unsigned char *surface;                 /* pixels that are no sky: for the converged estimator */
    unsigned char *model_mask, *field_mask[OUTS]; /* one byte a pixel */
} truth;

/* far != 0: the field of far light, too. An exit code; s->error says why. */
int          truth_make(settings *s, const subject *sub, int far, truth *out);
void         truth_free(truth *t);
/* Truth of an output for a config: of as many bounces, of the captures' sky. NULL: there is none. */
const image *truth_model(const truth *t, const settings *s, const hbil_config *config, int out);
const image *truth_field(const truth *t, const hbil_config *config, int out);
/* The config whose samples have converged: only what tells estimators apart is left of `config`. */
void         truth_family(const settings *s, const hbil_config *config, hbil_config *out);
/* Its images. An exit code. */
int truth_converged(settings *s, runner *device, const subject *sub, const hbil_config *config, image out[OUTS]);

#endif
