/* report.h - what a sweep says: a page of Markdown with tables, and its pictures. */
#ifndef HBIL_TRADEOFF_REPORT_H
#define HBIL_TRADEOFF_REPORT_H

#include "front.h"

/* Writes folder/report.md and folder/OUTPUT-front, -rings, -options and -grid as .svg and .png; makes the folder.
 * s->error -1: of each output the first there is of rmse_hf, rmse_model, rmse_sampling; s->output NULL: all. pictures
 * 0: none. A line on stderr per picture. 1, or 0: error[] says why; then *nothing is 1 if no line of the CSV was asked
 * for, 0 if a file is at fault. */
int report_write(const char *folder, const csv *table, const selection *s, int pictures, int *nothing, char *error,
                 size_t error_size);

#endif
