/* recommend.h - the best config that was measured for a budget, and what to expect of it on a frame that was not. */
#ifndef HBIL_TRADEOFF_RECOMMEND_H
#define HBIL_TRADEOFF_RECOMMEND_H

#include "front.h"

typedef struct wish { double budget_ms, max_rmse; } wish; /* 0: not asked for */

/* On the front: the least error within the budget; with max_rmse the fastest within both. NULL: nothing fits. */
const point *recommend_choose(const points *p, const wish *w);
/* The next point of the front, faster (-1) or more accurate (1); NULL: there is none. */
const point *recommend_neighbour(const points *p, const point *from, int direction);

/* Of the anchors, names by commas, the one that is most like best: of its estimator if there is one, then with the
 * nearest sampling error. Never best itself. NULL: one of them is not in p, or none is left. */
const point *recommend_anchor(const points *p, const char *names, const point *best, int error);
/* Error (column `error`) to be expected of `best` on a frame that is not among those of p. Without an anchor its error
 * over the frames of p. With one, a config that was measured there, too (its row: there): scenes differ more than
 * configs. Its sampling error there is scaled by the geometric mean over the frames of p of best's over the anchor's;
 * what else its error holds is taken as it is where both have the same estimator, else scaled as on the frames of p. */
double       recommend_predict(const points *p, const point *best, const point *anchor, const csv_row *there, int error);

/* What `shadergen` takes: blanks of the config become commas. Caller frees; NULL: no memory. */
char        *recommend_command(const char *config);

#endif
