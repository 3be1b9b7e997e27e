/* variants.h - the settings that the peers are run with, and the call of extract.mjs that makes recipes of them. */
#ifndef HBIL_PEERS_VARIANTS_H
#define HBIL_PEERS_VARIANTS_H

#include "../../frame/capture.h"

enum { PEER_THREE, PEER_N8AO, PEERS };
extern const char *const peer_names[PEERS];

/* How a peer is set. Neither has an infinite radius, which is what the truths are of. */
enum { AS_SHIPPED, AS_LARGE, AS_BEST, CONVENTIONS };
extern const char *const convention_names[CONVENTIONS];

#define RUNGS_MAX 8

/* Sample counts by the package's own option, few to many; 0 ends them. 16 is the default of both. */
extern const int peer_rungs[PEERS][RUNGS_MAX];

/* Settings that AS_BEST chooses from with the truth in hand: points of a grid, and powers of the result, by the uniform
 * power_names[] of the package (three.js takes it before it denoises, n8ao after that). */
int   variant_grid(int peer);
#define POWERS 7
extern const float       powers[POWERS];
extern const char *const power_names[PEERS];

/* Name of a recipe, of a convention or, AS_BEST, of a point of the grid. */
void  variant_name(int peer, int convention, int rung, int point, char out[64]);
/* What it sets besides the number of samples, for people. large: m, see variant_large. */
void  variant_text(int peer, int convention, int point, float large, char out[160]);
/* A radius as large as what is seen: the diagonal of the visible points' box in view space, m. */
float variant_large(const capture *cap);

/* Has node write FOLDER/NAME.json for every name above. 1; 0: error[], and *missing says if node, npm or the registry
 * are not there. */
int   variants_extract(const char *script, const char *cache, const char *folder, const capture *cap, int *missing,
                       char *error, size_t error_size);

#endif
