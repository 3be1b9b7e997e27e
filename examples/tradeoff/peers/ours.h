/* ours.h - a preset of hbil.h on the same context, timed in the same way as the peers. */
#ifndef HBIL_PEERS_OURS_H
#define HBIL_PEERS_OURS_H

#include "../../frame/capture.h"

typedef struct ours ours;

/* The preset with more options, or "". ao alone, of one frame: temporal=no. depth is what the peers get, the depth
 * buffer's value. NULL: error[] says why. */
ours *ours_open(void *device, const char *preset, const char *options, const capture *cap, char *error,
                size_t error_size);
void  ours_free(ours *o);
/* Depth samples a pixel if no side ends early; of a sweep, its horizons. */
int   ours_taps(const ours *o);
int   ours_run(ours *o, double *ms, char *error, size_t error_size);
int   ours_read(const ours *o, image *ao);

#endif
