/* trial.h - runs the extreme cases with one guard taken out, until a check fails. */
#ifndef HBIL_MUTATION_TRIAL_H
#define HBIL_MUTATION_TRIAL_H

#include "../extreme/cases.h"
#include "guards.h"

/* All cases: those of tests/extreme, some of them twice, and the truths. */
int                 trial_count(void);
const extreme_case *trial_case(int index);
/* Its name in the table, which says if it runs on "loose": 128 characters. */
const char         *trial_label(int index, char out[128]);
/* Cases of one config and device have the same number, and stand together. */
int                 trial_group(int index);
/* Plans and texts of all cases, once. 1, or 0: error[] says which config is at fault. */
int                 trial_prepare(char *error, size_t size);
/* Does the guard stand in a text of the case? */
int                 trial_has(int index, const guard *g);
/* Run a case without the guard (NULL: as it is). 1: all checks hold; 0: why[] says which does not; -1: it cannot be run, why[] says
 * why. Opens the devices when first needed, in this process. */
int                 trial_run(int index, const guard *g, char *why, size_t size);

#endif
