/* front.h - error against time of every config over all frames, and who is on the Pareto front. */
#ifndef HBIL_TRADEOFF_FRONT_H
#define HBIL_TRADEOFF_FRONT_H

#include "csv.h"

typedef struct selection {
    const char *output;        /* ao, near or far */
    int         error;         /* column, CSV_rmse_... */
    const char *backend, *device; /* NULL: the only one there is */
    const char *except, *only; /* frame; NULL: all */
    int         ours;          /* 1: no externals */
} selection;

/* A config. */
typedef struct point {
    const csv_row *row;                  /* one of its rows: hash, config, preset */
    double         ms, ms_low, ms_high;  /* median times: geometric mean over frames, and extremes */
    double         error, low, high;     /* root mean square over frames, and extremes */
    double         mean[CSV_NUMBER_COUNT]; /* of all columns over the frames that have them, see csv_number_trait */
    const csv_row *const *rows;          /* of each frame */
    int            on_front;
} point;

/* Sorted by time. Of several lines for the same config and frame the last one counts. */
typedef struct points {
    point       *list;
    int          count;
    const csv_row **frames; /* a row of each frame, by frame_count */
    int          frame_count;
    int          left_out;  /* configs that lack a frame: they cannot be compared */
    const csv_row **rows;   /* storage */
} points;

/* "external:NAME" in the column config: a shader that is not hbil.h's. */
int          row_is_external(const csv_row *row);
/* What a row is called: its preset, or an external's name; "": neither. */
const char  *row_name(const csv_row *row);

/* 1; 0: error[] says what there is instead. The table must outlive the points. */
int          points_make(points *out, const csv *table, const selection *s, char *error, size_t error_size);
void         points_free(points *p);
/* s->error, or if that is -1 the first of rmse_hf, rmse_model, rmse_sampling, if points can be made of it; -1: they
 * cannot. */
int          points_error(const csv *table, const selection *s);
/* Leaves only the configs that are in `also`, too; the front is theirs then. */
void         points_keep(points *p, const points *also);
/* The fastest point with this config hash, preset, or config text; NULL: there is none. */
const point *points_find(const points *p, const char *name);
/* Has a point a mean of this column? */
int          points_know(const points *p, int column);

/* By how much one other config, which is in all of these sets and neither slower nor worse in any, betters this one: .1
 * if it takes 1/1.1 of the time or of an error. 0: nobody does. The sets are of one table and one device, an output or
 * error each. by: NULL, or who. */
double       front_dominated(const points *sets, int set_count, const char *config_hash, const point **by);

#endif
