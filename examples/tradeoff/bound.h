/* bound.h - a pass without its arithmetic: what its memory accesses alone cost.
 *
 * The text is the pass's own. Every read adds what it read to a sum, and every store stores that sum, so that a
 * compiler leaves out whatever served other values: what stays are reads, stores, loops and the computation of
 * addresses. Where the values of samples decide whether a texel is read (radiance, of a sample that rises), the
 * decisions of the whole pass are recorded in one run, and replayed from a texture: one read a pixel more. Where a read
 * says where the next one lies, as in the hull of a sweep, what follows from it is computation of addresses, and
 * stays. */
#ifndef HBIL_TRADEOFF_BOUND_H
#define HBIL_TRADEOFF_BOUND_H

#include "lit.h"

/* RECORD: the pass itself, which writes down its decisions. BARE and PROOF: without arithmetic. RECORD and PROOF also
 * hash the coordinates of all that is read. Bits. */
enum { BOUND_RECORD = 1, BOUND_BARE = 2, BOUND_PROOF = 4 };

/* The text, which the caller frees, and the plan with the textures that it reads and writes besides. NULL: error[] says
 * why, such as a seam that the pass's text has no more. */
char *bound_text(const hbil_plan *plan, const char *pass, int kind, hbil_plan *out, char *error, size_t error_size);

typedef struct bound {
    hbil_plan   plan;
    const char *pass;
    char       *text;
    image       record; /* decisions; absent where there are none */
    double      reads;  /* of texels, per pixel of the frame, as counted on the device */
} bound;

/* Records, and proves that the text without arithmetic reads the same texels: at each pixel, or along each line of a
 * sweep, equal hashes and numbers. An exit code of common.h; error[] says why. */
int  bound_make(const lit *l, const char *pass, bound *out, char *error, size_t error_size);
void bound_free(bound *b);

/* Some passes of a lit frame, a timing_run each. */
typedef struct part {
    lit         *l;
    const bound *b;     /* NULL: the plan's own texts */
    unsigned     passes; /* bits: those whose time counts */
} part;
int      part_run(void *part, int count, double *ms, char *error, size_t error_size);
/* Bit of a pass, 0: the plan has none of this name. */
unsigned part_bit(const hbil_plan *plan, const char *pass);

#endif
