/* random_frame.h - whole configs and frames out of a seed: every option, every convention, inputs that no engine should send. */
#ifndef HBIL_EXTREME_RANDOM_FRAME_H
#define HBIL_EXTREME_RANDOM_FRAME_H

#include "../../hbil.h"
#include "../../examples/frame/image.h"

#define CASE_FRAMES 4
#define CASE_INPUTS 10

/* Names of the inputs that a plan may have, as passes.def says. */
extern const char *const case_inputs[CASE_INPUTS];
enum { CASE_DEPTH, CASE_NORMAL, CASE_RADIANCE, CASE_MOTION, CASE_DIRECT, CASE_ALBEDO, CASE_F0, CASE_ROUGHNESS, CASE_SKY, CASE_PROBES };

/* The function of environment=hook, for every case: NaN, infinite, negative or huge in some directions. */
extern const char case_hook[];

/* A config and the frames that it runs on, one after the other. frame[i].live points to live[i]; last_* are those of frame i - 1. */
typedef struct test_case {
    hbil_config config;                             /* resolved */
    int         frames;
    hbil_frame  frame[CASE_FRAMES];
    hbil_config live[CASE_FRAMES];                  /* 0: as in the plan */
    image       input[CASE_FRAMES][CASE_INPUTS];    /* all of the same size, at least that of the frame; absent: plain */
} test_case;

typedef struct rng { uint64_t state; } rng;
uint64_t rng_next(rng *r);
int      rng_below(rng *r, int n);                  /* [0, n) */
double   rng_unit(rng *r);                          /* [0, 1) */
double   rng_log(rng *r, double low, double high);  /* uniform in the logarithm; low > 0 */

/* A legal config for a target, resolved. 0: what was drawn is refused, and none of the fixes that the errors name helps. */
int  random_config(rng *r, int32_t target, hbil_config *out);
/* Frames and inputs for the plan of out->config, of at most `pixels` pixels all together. 0: out of memory. */
int  random_frames(rng *r, const hbil_plan *plan, int pixels, test_case *out);
/* Writes where frame[i] finds its live values and its last frame: after every change of frames. */
void case_link(test_case *c);
/* A plain image of that input: a plane that faces the camera at 1 m, radiance 1. 0: out of memory. */
int  case_plain(const hbil_config *config, const hbil_frame *frame, int input, int width, int height, image *out);
int  case_copy(test_case *out, const test_case *in);
void case_free(test_case *c);
/* Pixels of all its frames. */
long case_pixels(const test_case *c);

#endif
