/* plots.h - pictures through gnuplot, each as STEM.svg and STEM.png, replaced whole or not at all. */
#ifndef HBIL_TRADEOFF_PLOTS_H
#define HBIL_TRADEOFF_PLOTS_H

#include "marginals.h"

/* All: 1, or 0: error[] says why and how to mend it. title: below the picture's own. */

/* Error over time, both logarithmic: every config, the Pareto front, presets by name. */
int plot_front(const points *p, const selection *s, const char *stem, const char *title, char *error,
               size_t error_size);
/* Error by distance from the image's centre, against the height field and beside it against the scene: a line for each
 * preset and for the ends of the front. */
int plot_rings(const points *p, const char *stem, const char *title, char *error, size_t error_size);
/* 1: some of it is measured. */
int plot_rings_known(const points *p);
/* A panel an option: factors of error and time. */
int plot_marginals(const marginal *list, int count, const char *stem, const char *title, char *error,
                   size_t error_size);
/* Error and time of slices x steps. */
int plot_grid(const grid *g, const selection *s, const char *stem, const char *title, char *error, size_t error_size);

#endif
