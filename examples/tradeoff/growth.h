/* growth.h - times against the number of pixels, slices and steps. */
#ifndef HBIL_TRADEOFF_GROWTH_H
#define HBIL_TRADEOFF_GROWTH_H

enum { GROWTH_TERMS = 4 };

/* A config that was timed. steps: 0 where there are none. */
typedef struct growth_point { double pixels, slices, steps, ms, predicted; } growth_point;

/* ms = pixels * (factor[0] + factor[1] * slices * steps + factor[2] * slices) + factor[3]; without steps
 * pixels * (factor[0] + factor[1] * slices) + factor[2]. The first `terms` count: the factors are those with the least
 * sum of squared relative deviations. Fills predicted. The largest |predicted / ms - 1|; infinite: the points do not
 * tell the terms apart. */
double growth_fit(growth_point *points, int count, int terms, double factor[GROWTH_TERMS]);

#endif
