/* cases.h - frames at the limits of what a program can hand over: every hazard and every extreme input, as plain data that each device,
 * the mutation check and the random search run alike. */
#ifndef HBIL_EXTREME_CASES_H
#define HBIL_EXTREME_CASES_H

#include "../../hbil.h"
#include "../../examples/frame/image.h"

typedef struct extreme_frame {
    hbil_frame  frame;
    image       inputs[HBIL_MAX_TEXTURES]; /* by plan texture, one for every INPUT */
    hbil_config live;                      /* what frame.live points to, where it is not NULL */
} extreme_frame;

enum {
    EXTREME_LEGAL = 1,  /* all of its inputs have a meaning by hbil.h's manual: backends must agree */
    EXTREME_LONG = 2,   /* minutes on a CPU: run with HBIL_LONG=1 */
    EXTREME_TIES = 8,   /* depths so far apart that cosines round to 1: see test_extreme.c */
    EXTREME_EXACT = 16, /* `expect` holds where functions are as exact as on real devices, not as bad as Vulkan allows: not judged on "loose" */
    EXTREME_TWIN = 32,     /* of tests/mutation: on "loose" alone */
    EXTREME_SPOILED = 64,  /* with it: before frame 1 what history has of light becomes NaN, before frame 2 depths, too */
    EXTREME_REFUSED = 4 /* hbil_pack_constants must refuse its frames, with a diagnostic */
};

/* Inputs of frame `index`; out is all zero before. Out of memory ends the program. */
typedef void extreme_fill(const hbil_plan *plan, int index, extreme_frame *out);
/* What must hold of frame `index` beyond the contract. 0: why[] says what does not. */
typedef int extreme_expect(const hbil_plan *plan, int index, const extreme_frame *f, const image outputs[HBIL_MAX_TEXTURES],
                           char *why, size_t size);

typedef struct extreme_case {
    const char     *name;   /* of the test; neighbours in the table of the same name are one test */
    const char     *config; /* without target */
    int             frames; /* executed in order on one device; history goes from one to the next, frame 0 has reset=1 */
    extreme_fill   *fill;
    extreme_expect *expect; /* NULL: nothing more */
    unsigned        flags;
} extreme_case;

extern const extreme_case extreme_cases[];
extern const int extreme_case_count;

/* The plan of a case for a target; 0: its config is at fault, error[] says why. */
int  extreme_plan(const extreme_case *c, const char *target, hbil_plan *plan, char *error, size_t size);
void extreme_free(extreme_frame *f);

#endif
