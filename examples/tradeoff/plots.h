/* plots.h - pictures through gnuplot, each as STEM.svg and STEM.png, replaced whole or not at all. */
#ifndef HBIL_TRADEOFF_PLOTS_H
#define HBIL_TRADEOFF_PLOTS_H

#include "marginals.h"

/* All: 1, or 0: error[] says why and how to mend it. title: below the picture's own. */

/* Error over time, both logarithmic: every config, the Pareto front, presets by name. */
int plot_front(const points *p, const selection *s, const char *stem, const char *title, char *error,
               size_t error_size);
/* A panel an option: factors of error and time. */
int plot_marginals(const marginal *list, int count, const char *stem, const char *title, char *error,
                   size_t error_size);
/* Error and time of slices x steps. */
int plot_grid(const grid *g, const selection *s, const char *stem, const char *title, char *error, size_t error_size);

#endif
