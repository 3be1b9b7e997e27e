/* sweep.h - the swept march from its definition, in double precision: each pixel looks at all pixels of its line, one by one. No hull, no
 * stack: it shares no algorithm with the shader that it judges.
 *
 * Lines: direction i of slices * stride has the angle ((i + turn) / count - 1/4) pi on the screen (x to larger columns, y to larger rows)
 * and steps along columns while (i + turn) / count < 1/2, else along rows. Space and surface as in brute_force.h, at pixel centres only.
 * Light: the mean radiance of what a line shows from the horizon on, each pixel by how far it rises over the one before it, plus what a
 * surface seen at 45 degrees rises.
 *
 * Of two pixels that stand equally high the nearer one is the horizon. On planes many do: so that rounding does not decide for the shader
 * otherwise than for this, nearness is rounded to a float here too. */
#ifndef HBIL_TESTS_SWEEP_H
#define HBIL_TESTS_SWEEP_H

#include "brute_force.h"

#define SWEEP_MAX_SLICES 64

/* Options of hbil_config by name; all must be set. turn: 0.5 with noise=none. */
typedef struct sweep_options {
    int    slices, stride;
    double turn, pull, bias;
} sweep_options;

/* One side of a slice. */
typedef struct sweep_side {
    int    reach;        /* steps to the pixel that makes the horizon, 0: there is none */
    int    taken;        /* it stands above the tangent plane */
    double c0, c;        /* cosine of the tangent plane's horizon; of the pixel, as it is */
    double elevation;    /* sine above the tangent plane */
    double weight;       /* cosine-weighted light of the arc between them, 0 if not taken */
    double light[3];     /* mean radiance of it */
} sweep_side;

typedef struct sweep_pixel {
    int    sky; /* no surface: ao 1, near 0 */
    double ao, near[3];
} sweep_pixel;

typedef struct sweep {
    sweep_options   options;
    const bf_scene *scene;
    int            *shift;    /* [direction][step]: places across from where a line begins */
    double         *nearness; /* 1 / depth, or -depth, as a float has it; -infinity on the sky */
} sweep;

/* The scene is borrowed. 0: out of memory. */
int  sweep_open(sweep *s, const sweep_options *options, const bf_scene *scene);
void sweep_close(sweep *s);
/* sides: NULL, or [slices][2], the side of larger steps first. */
void sweep_at(const sweep *s, int x, int y, sweep_pixel *out, sweep_side (*sides)[2]);
/* All pixels of a grid, on two threads. */
void sweep_run(const sweep *s, bf_grid grid, sweep_pixel *out);

#endif
