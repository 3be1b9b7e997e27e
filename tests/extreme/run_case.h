/* run_case.h - runs a case on a device and says what of the contract it breaks. */
#ifndef HBIL_EXTREME_RUN_CASE_H
#define HBIL_EXTREME_RUN_CASE_H

#include "random_frame.h"

/* Something that executes plans: "vulkan", "gl", "gles", "twin". NULL: error[] says what is missing. */
typedef struct subject subject;
subject    *subject_open(const char *name, char *error, size_t error_size);
void        subject_close(subject *s);
const char *subject_name(const subject *s);
int32_t     subject_target(const subject *s);
/* From now on `to` stands for `from` in the text of the last pass that has it: a fault, to see whether it is found. Not copied. */
void        subject_plant(subject *s, const char *from, const char *to);

typedef enum run_result { RUN_HOLDS, RUN_FAILS, RUN_REFUSED } run_result;

/* kind: output and broken rule, "near: not finite"; the same fault has the same kind. why: with pixel and value. */
typedef struct verdict { char kind[64], why[320]; int frame; } verdict;

/* All frames, one after the other, each checked: contract.h; sky pixels are open and dark; near + ao = 1 where all radiance is 1. twice: the
 * whole sequence again, which must give the same bytes. REFUSED: the library refuses config or frame, why says how. */
run_result case_run(subject *s, const test_case *c, int twice, verdict *out);

#endif
