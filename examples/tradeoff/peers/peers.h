/* peers.h - draws the recipes of extract.mjs: passes of another library, on a capture.
 * Their side of the conventions: texture row 0 is the bottom of the picture, depth is the depth buffer's value of an
 * OpenGL projection, normals are of view space, stored as 0.5 n + 0.5. */
#ifndef HBIL_PEERS_H
#define HBIL_PEERS_H

#include "../../frame/capture.h"

typedef struct peers peers;
typedef struct peer_pass peer_pass;

/* On the current context, that of runner_gl's device. NULL: error[] says why. */
peers *peers_open(void *device, char *error, size_t error_size);
void   peers_close(peers *p);
/* Uploads depth and normals of the frame that all recipes from now on are drawn on. Perspective only. */
int    peers_frame(peers *p, const capture *cap, char *error, size_t error_size);

/* The recipe FOLDER/NAME.json, made for that frame. NULL: error[]. */
peer_pass *peer_load(peers *p, const char *folder, const char *name, char *error, size_t error_size);
void   peer_free(peer_pass *q);
/* Depth samples a pixel, as the recipe says. */
int    peer_taps(const peer_pass *q);
/* Sets a scalar uniform of all passes that have it. How many do. */
int    peer_set(peer_pass *q, const char *uniform, float value);
/* Draws all passes. ms: of those that count, from finished to finished work; may be NULL. */
int    peer_run(peer_pass *q, double *ms, char *error, size_t error_size);
/* The ao of the last run, rows top to bottom. */
int    peer_read(const peer_pass *q, image *ao);

#endif
