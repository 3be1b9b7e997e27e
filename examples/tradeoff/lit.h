/* lit.h - one config, or external, on one frame: its plan, its inputs, the device that runs it. */
#ifndef HBIL_TRADEOFF_LIT_H
#define HBIL_TRADEOFF_LIT_H

#include "external.h"
#include "runner.h"
#include "subject.h"
#include "timing.h"

typedef struct lit {
    hbil_plan       plan;
    hbil_frame      frame;
    image           in[HBIL_MAX_TEXTURES];
    runner         *device;     /* these three are the caller's */
    const settings *s;
    const subject  *sub;
    const external *own;        /* whose plan it is, instead of a config's. NULL: a config's */
    int             history;    /* 1: the plan keeps something from frame to frame */
} lit;

/* config: as config_make makes it. 1; 0: error[] says why, and nothing is held. */
int  lit_open(lit *l, runner *device, const settings *s, const hbil_config *config, const subject *sub, char *error,
              size_t error_size);
/* The same with the plan of an external, which stays where it is. */
int  lit_open_external(lit *l, runner *device, const settings *s, const external *e, const subject *sub, char *error,
                       size_t error_size);
void lit_close(lit *l);
/* The outputs ao, near and far of the judged frame, absent where the plan has none: with all of its history, or, of a
 * single frame, after 16 with a still camera. Without history the noise is that of frame `index`. Free each. */
int  lit_images(lit *l, uint32_t index, image out[OUTS], char *error, size_t error_size);
/* The next frame of a still camera, after lit_images. */
int  lit_next(lit *l, image out[OUTS], char *error, size_t error_size);
/* A timing_run: milliseconds of all passes, by the device's clock; where that stands still, by the wall's around
 * finished work. */
int  lit_run(void *lit, int count, double *ms, char *error, size_t error_size);

#endif
