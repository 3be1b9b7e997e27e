/* damage.h - a plan that was built, then changed by the bytes of an input.
 *
 *   config 0..N-1, { offset, kind, value }...     numbers of 1, 2 or 4 bytes written over the plan
 *   255, plan                                     the struct as it lies in memory */
#ifndef HBIL_FUZZ_DAMAGE_H
#define HBIL_FUZZ_DAMAGE_H

#include "fuzz.h"
#include "../../hbil.h"

#include <string.h>

static inline void damaged_plan(fuzz_reader *r, const char *const *configs, uint32_t count, hbil_plan *out)
{
    const uint32_t which = fuzz_take(r, 1);
    hbil_config c;
    memset(&c, 0, sizeof c);
    memset(out, 0, sizeof *out);
    if (which == 255) {
        const size_t n = r->left < sizeof *out ? r->left : sizeof *out;
        memcpy(out, r->at, n);
        r->at += n;
        r->left -= n;
        return;
    }
    FUZZ_REQUIRE(hbil_config_parse(&c, configs[which % count], strlen(configs[which % count]), NULL) == HBIL_OK);
    FUZZ_REQUIRE(hbil_plan_build(&c, out, NULL) == HBIL_OK);
    while (r->left > 2) {
        const uint32_t offset = fuzz_take(r, 2) % (uint32_t)sizeof *out, kind = fuzz_take(r, 1);
        const size_t bytes = (size_t)1 << kind % 3;
        const uint32_t value = fuzz_take(r, kind & 4 ? 1 : bytes); /* bit 2: a small number */
        memcpy((char *)out + offset, &value, bytes < sizeof *out - offset ? bytes : sizeof *out - offset);
        if (kind == 255) break; /* the rest is for whoever reads on */
    }
}

#endif
