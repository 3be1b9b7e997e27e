/* grid.h - lists and ranges of options, and the configs that they make. */
#ifndef HBIL_TRADEOFF_GRID_H
#define HBIL_TRADEOFF_GRID_H

#include <stddef.h>
#include <stdint.h>

#define GRID_AXES_MAX   64
#define GRID_VALUES_MAX 64

typedef struct grid_axis {
    char name[32];
    char values[GRID_VALUES_MAX][48];
    int  count;
} grid_axis;

typedef struct grid { grid_axis axes[GRID_AXES_MAX]; int count; } grid;

/* "slices=1,2,4 steps=2..16*2 exponent=1..3+.5 preset=none,fast": axes with blanks or line ends between them, # starts
 * a comment. A value, or a range A..B by factor (*K, above 1), by step (+K, above 0) or by 1. An axis twice is a fault.
 * The axis preset tells where a config begins. Names of options are known, values are not checked here. 1, or 0:
 * error[] says what is wrong. */
int      grid_parse(grid *g, const char *text, char *error, size_t error_size);
/* How many configs; 0: more than 1e9. No axis: one, the default. */
uint64_t grid_size(const grid *g);
/* Config `index` as text, the axis preset in front. 1, or 0: longer than size. */
int      grid_text(const grid *g, uint64_t index, char *text, size_t size);
/* `count` of `total` indices, at random and in ascending order; the same seed gives the same ones. 1, or 0: count >
 * total. */
int      grid_choose(uint64_t total, uint64_t count, uint64_t seed, uint64_t *out);
/* The next of a generator's numbers (splitmix64). */
uint64_t grid_random(uint64_t *state);

#endif
