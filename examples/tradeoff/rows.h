/* rows.h - the results file: one row per config, frame and output, its columns those of csv.h, appended
 * whole, read again when a sweep goes on. */
#ifndef HBIL_TRADEOFF_ROWS_H
#define HBIL_TRADEOFF_ROWS_H

#include "measure.h"

typedef struct rows {
    int    file;            /* descriptor, locked against a second sweep */
    char **keys;            /* of the rows that were there, sorted */
    int    count, repaired; /* repaired: bytes of a torn last line that were cut off */
    const char *commit;     /* the caller's, set after rows_open: what new rows say of the code; NULL: nothing */
} rows;

/* Opens or makes the file; a last line without its end is cut off. 1, or 0: error[] says what is wrong with it. */
int  rows_open(rows *r, const char *path, char *error, size_t error_size);
void rows_close(rows *r);
/* What a row is the result of, as text: commas of a device's name become semicolons. */
void rows_key(char *out, size_t size, const runner_info *about, uint64_t hash, const char *frame, int width,
              int height, int output);
/* Was it there when the file was opened? */
int  rows_has(const rows *r, const char *key);
/* Appends a row for each output that is present and that `wanted` holds, in one write. hash, words: the config's, or an
 * external's and its name. 1, or 0: error[] says why. */
int rows_add(rows *r, const runner_info *about, uint64_t hash, const char *words, const char *preset, const char *frame,
             int width, int height, const measured *m, unsigned wanted, char *error, size_t error_size);

#endif
