/* truths.h - small frames whose light is known, each true only while some guard of the shaders stands: what kills most mutations of
 * tests/mutation. The test mutation_truths runs them with all guards in place. */
#ifndef HBIL_EXTREME_TRUTHS_H
#define HBIL_EXTREME_TRUTHS_H

#include "cases.h"

/* Of outputs: truths.c; scenes that show one rule each: truths_scenes.c. */
extern const extreme_case extreme_truths[], extreme_scenes[];
extern const int extreme_truth_count, extreme_scene_count;
/* Of what lies between the passes: their expect functions read textures that are TRANSIENT in the plan they get. */
extern const extreme_case extreme_inside[];
extern const int extreme_inside_count;
/* Of what only the CPU shows, counted.c: work, devices that are inexact, histories that are spoiled, what fragments leave inside. */
extern const extreme_case extreme_counted[];
extern const int extreme_counted_count;
/* What a pass of a case may do at most, per pixel of the frame. */
typedef struct extreme_limit { const char *name, *pass; double reads, writes, roots; } extreme_limit;
extern const extreme_limit extreme_limits[];
extern const int extreme_limit_count;

/* What the files of truths share. An output by name; NULL: the plan has none of it. */
const image *truth_output(const hbil_plan *plan, const image *outputs, const char *name);
int  truth_is_sky(const extreme_frame *f, const hbil_plan *plan, int p);
/* An output's first channel lies in [low, high] at every pixel with a surface. */
int  truth_within(const hbil_plan *plan, const extreme_frame *f, const image *outputs, const char *name, double low, double high, char *why,
                  size_t size);
/* The same radiance everywhere. */
void truth_light(const hbil_plan *plan, extreme_frame *out, float value);
/* Of a white world near and ao are 1 together, something is occluded, and the sky has its own values. */
extreme_expect truth_white;
/* A floor and a wall, seen into their corner: half of each is hidden. White. */
void truth_corner(const hbil_plan *plan, int index, extreme_frame *out);

#endif
