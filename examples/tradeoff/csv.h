/* csv.h - what a sweep has measured: a line for each config, frame and output. */
#ifndef HBIL_TRADEOFF_CSV_H
#define HBIL_TRADEOFF_CSV_H

#include <stddef.h>

/* Outputs that have a truth, in the order of OUT_ of common.h; and what the config of a shader that is not hbil.h's
 * begins with. */
#define CSV_OUTPUT_NAMES {"ao", "near", "far"}
#define CSV_OUTPUTS      3
#define CSV_EXTERNAL     "external:"

/* What a column may hold, and how it is averaged over frames. */
enum {
    CSV_PLAIN,
    CSV_MUST,   /* a file without it is none of a sweep */
    CSV_SIGNED, /* may be below 0 */
    CSV_SQUARE  /* averaged as the root mean square */
};

/* Every column in the order of the file: TEXT or NUMBER(name, CSV_..., what rows.c writes there). Files are read by the
 * names in their first line: columns may be missing, and others stand between them. */
#define CSV_COLUMNS(TEXT, NUMBER)                                                                                      \
    TEXT(version, PLAIN, of->version) TEXT(config_hash, MUST, of->hash) TEXT(config, MUST, of->config)                 \
    TEXT(preset, MUST, of->preset) TEXT(device, MUST, of->device) TEXT(driver, PLAIN, of->driver)                      \
    TEXT(backend, MUST, of->backend) TEXT(frame, MUST, of->frame) NUMBER(width, PLAIN, of->width)                      \
    NUMBER(height, PLAIN, of->height) TEXT(output, MUST, out_names[output]) NUMBER(ms_min, PLAIN, m->time.min)         \
    NUMBER(ms_median, MUST, m->time.median) NUMBER(ms_max, PLAIN, m->time.max) NUMBER(runs, PLAIN, m->time.runs)       \
    NUMBER(fetches, PLAIN, m->cost.fetches) NUMBER(bytes_read, PLAIN, m->cost.bytes_read)                              \
    NUMBER(bytes_written, PLAIN, m->cost.bytes_written) NUMBER(registers, PLAIN, m->cost.registers)                    \
    NUMBER(rmse_sampling, SQUARE, e->rmse_sampling) NUMBER(rmse_estimator, SQUARE, e->rmse_estimator)                  \
    NUMBER(rmse_model, SQUARE, e->rmse_model) NUMBER(bias_model, SIGNED, e->bias_model)                                \
    NUMBER(p95_model, PLAIN, e->p95_model) NUMBER(rmse_hf, SQUARE, e->rmse_field)                                      \
    NUMBER(bias_hf, SIGNED, e->bias_field) NUMBER(relative, PLAIN, e->relative) NUMBER(psnr, SIGNED, e->psnr)          \
    NUMBER(edge_rmse, SQUARE, e->edge_rmse) NUMBER(flip, PLAIN, e->flip) NUMBER(ring1_hf, SQUARE, e->ring_field[0])    \
    NUMBER(ring2_hf, SQUARE, e->ring_field[1]) NUMBER(ring3_hf, SQUARE, e->ring_field[2])                              \
    NUMBER(ring4_hf, SQUARE, e->ring_field[3]) NUMBER(ring5_hf, SQUARE, e->ring_field[4])                              \
    NUMBER(ring1_model, SQUARE, e->ring_model[0]) NUMBER(ring2_model, SQUARE, e->ring_model[1])                        \
    NUMBER(ring3_model, SQUARE, e->ring_model[2]) NUMBER(ring4_model, SQUARE, e->ring_model[3])                        \
    NUMBER(ring5_model, SQUARE, e->ring_model[4]) NUMBER(flicker, PLAIN, e->flicker) TEXT(commit, PLAIN, of->commit)   \
    NUMBER(noise, PLAIN, m->time.noisy)

#define CSV_ENUM(name, trait, source) CSV_##name,
#define CSV_NONE(name, trait, source)
enum { CSV_COLUMNS(CSV_ENUM, CSV_NONE) CSV_TEXT_COUNT };
enum { CSV_COLUMNS(CSV_NONE, CSV_ENUM) CSV_NUMBER_COUNT };
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
/* CSV_PLAIN to CSV_SQUARE. */
int         csv_number_trait(int index);

#endif
