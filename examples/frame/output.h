/* output.h - what is written of each output of a plan: layers of an EXR, and pictures that a person can read. */
#ifndef HBIL_FRAME_OUTPUT_H
#define HBIL_FRAME_OUTPUT_H

#include "capture.h"
#include "environment.h"

enum { OUTPUT_AO, OUTPUT_UNIFORM_AO, OUTPUT_BENT, OUTPUT_CONE, OUTPUT_NEAR, OUTPUT_SH, OUTPUT_FAR, OUTPUT_IRRADIANCE,
       OUTPUT_SPECULAR_OCCLUSION, OUTPUT_MULTI_BOUNCE, OUTPUT_COMPOSITE, OUTPUT_KINDS };

#define OUTPUT_LAYERS_MAX (OUTPUT_KINDS + 3) /* sh has four layers: sh0 to sh3 */

typedef struct output_kind {
    const char *name;       /* of the plan's texture */
    const char *channels;   /* letters in the EXR; those behind them are constant and left out */
    int         light;      /* 1: a value below 0 is a fault */
} output_kind;

extern const output_kind output_kinds[OUTPUT_KINDS];

/* The output as it is written, from the plan's texture. 1, or 0: out of memory. */
int output_take(image *out, int kind, const image *texture);
/* Layers of all outputs that are present, for exr_write; they share the images. How many. */
int output_layers(const image outputs[OUTPUT_KINDS], image_layer layers[OUTPUT_LAYERS_MAX]);
/* before.png (direct light and emission), after.png (composite and emission), both before env where there is one, and pictures of
 * every output that is present. Light has one exposure in all of them. The folder is made if need be. 1, or 0: error[] says why. */
int output_pictures(const char *folder, const capture *cap, const environment *env, const image outputs[OUTPUT_KINDS],
                    char *error, size_t error_size);

#endif
