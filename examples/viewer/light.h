/* light.h - from what the user asks for to a plan of hbil.h that this renderer can feed. */
#ifndef HBIL_VIEWER_LIGHT_H
#define HBIL_VIEWER_LIGHT_H

#include "gpu.h"

typedef struct light {
    hbil_config wanted;      /* the preset and every option that was set since */
    int         own_outputs; /* 1: outputs were set, and stay as they are */
    char        preset[24];
    hbil_plan   plan;        /* of the last light_build */
} light;

/* All: 1, or 0 with *l as it was and message[] saying why. To change one in use, change a copy and keep it if that
 * worked. */
int light_preset(light *l, const char *name, char *message, size_t message_size);
/* "slices=2,temporal=yes". Options that follow from this renderer are refused. */
int light_set(light *l, const char *text, char *message, size_t message_size);
/* Set the option to the next (by 1) or the last (by -1) of `values`, blank-separated, from where the plan is.
 * ends: do not go round. */
int light_step(light *l, const char *option, const char *values, int by, int ends, char *message, size_t message_size);
/* The plan for one API (gl: 1). Adds an environment and the outputs that the views show, as far as they were left
 * open and the config allows them. about: NULL, or an option of which message[] gets what hbil.h notes, as that it
 * has no effect. */
int light_build(light *l, int gl, const char *about, char *message, size_t message_size);

/* The sky as what environment=constant and sh read. */
void light_sky(const gpu_uniforms *scene, hbil_frame *frame);

/* A debug view: what of the plan to show and how. */
typedef struct light_view { const char *name, *what; const char *output; gpu_mode mode; } light_view;
/* By index, NULL outside. */
const light_view *light_view_at(int index);
/* Plan texture to show, -1: none, and how to show it. 0: the plan has no such output, *mode is MODE_DIRECT. */
int light_show(const hbil_plan *plan, const light_view *view, int32_t *texture, gpu_mode *mode);

#endif
