/* csv.h - what a sweep has measured: a line for each config, frame and output. */
#ifndef HBIL_TRADEOFF_CSV_H
#define HBIL_TRADEOFF_CSV_H

#include <stddef.h>

/* Columns, found by the names in the file's first line; others may stand between them. X(name, 1: it must be there) */
#define CSV_TEXTS(X)                                                                                                   \
    X(version, 0) X(config_hash, 1) X(config, 1) X(preset, 1) X(device, 1) X(driver, 0) X(backend, 1) X(frame, 1)      \
    X(output, 1)
#define CSV_NUMBERS(X)                                                                                                 \
    X(width, 0) X(height, 0) X(ms_min, 0) X(ms_median, 1) X(ms_max, 0) X(runs, 0) X(fetches, 0) X(bytes_read, 0)       \
    X(bytes_written, 0) X(registers, 0) X(rmse_sampling, 0) X(rmse_estimator, 0) X(rmse_model, 0) X(bias_model, 0)     \
    X(p95_model, 0) X(rmse_hf, 0) X(bias_hf, 0) X(flicker, 0) X(noise, 0)

#define CSV_ENUM(name, must) CSV_##name,
enum { CSV_TEXTS(CSV_ENUM) CSV_TEXT_COUNT };
enum { CSV_NUMBERS(CSV_ENUM) CSV_NUMBER_COUNT };
#undef CSV_ENUM

typedef struct csv_row {
    const char *text[CSV_TEXT_COUNT];     /* "" where the column is absent */
    double      number[CSV_NUMBER_COUNT]; /* NaN: empty or absent */
    int         line;
} csv_row;

typedef struct csv {
    char    *bytes;      /* all texts point into it */
    csv_row *rows;
    int      count;
    char     note[512];  /* "", or that the last line is torn and was left out */
} csv;

/* 1; 0: error[] has FILE:LINE, the fault and the fix, and *out is empty. Quoted fields, and the first line once more
 * (joined files), are read; a line of another shape, a number that is none, a time or error below 0, an unknown output
 * are faults. */
int         csv_read(csv *out, const char *path, char *error, size_t error_size);
void        csv_free(csv *table);
/* Index of a column of numbers, -1: there is none of this name. */
int         csv_number(const char *name);
const char *csv_number_name(int index);

#endif
