/* shrink.h - from a case that fails to a small one that fails in the same way. */
#ifndef HBIL_EXTREME_SHRINK_H
#define HBIL_EXTREME_SHRINK_H

#include "random_frame.h"

/* Does this case still fail, in the same way? */
typedef int (*shrink_fails)(void *user, const test_case *c);

/* Options to their defaults, frames away, the screen cropped, inputs made plain, whole, by halves and pixel by pixel: whatever leaves the
 * failure as it is. Ends when nothing more goes, or after so many seconds. Returns the number of cases tried. */
int shrink(test_case *c, shrink_fails fails, void *user, double seconds);

#endif
