/* bout.h - one frame, all methods on it: rows of errors and times, and what is written of them. */
#ifndef HBIL_PEERS_BOUT_H
#define HBIL_PEERS_BOUT_H

#include <stdio.h>

#include "../../frame/capture.h"
#include "ours.h"
#include "peers.h"
#include "variants.h"

#define REPEATS_MAX 64
#define ROWS_MAX    96

enum { SCENE, HEIGHT_FIELD, TRUTHS };
enum { EQUAL_TAPS, EQUAL_TIME, TERMS };
enum { EXIT_USAGE = 2, EXIT_FRAME = 3, EXIT_NO_PEERS = 4, EXIT_RUN = 5 };
enum { PRESETS = 5, OURS = -1 };

extern const char *const truth_names[TRUTHS];
extern const char *const presets[PRESETS];

typedef struct errors { int known; double rmse, bias, correlation; } errors;

/* One method with its settings on one frame. */
typedef struct row {
    int        peer, preset;    /* peer OURS: preset counts */
    int        convention;
    int        judge;           /* of AS_BEST: the truth that chose the settings */
    char       settings[192];
    ours      *o;               /* the one or the other */
    peer_pass *p;
    int        taps;
    double     ms[REPEATS_MAX]; /* sorted */
    double     median;
    errors     e[TRUTHS];
} row;

typedef struct bout {
    const char *name;
    capture     cap;            /* with a height-field truth */
    void       *device;
    peers      *peers;
    char        folder[1100];   /* of the recipes */
    int         repeats;
    const char *png;            /* folder for pictures, or NULL */
    row         rows[ROWS_MAX];
    int         row_count;
} bout;

/* Frames on which ours had the lower error, of those where the terms could be met. */
typedef struct tally {
    int won[PRESETS][TRUTHS][PEERS][TERMS][CONVENTIONS];
    int asked[PRESETS][TRUTHS][PEERS][TERMS][CONVENTIONS];
} tally;

/* Message and exit. */
#if defined(__GNUC__)
__attribute__((noreturn, format(printf, 2, 3)))
#endif
void die(int code, const char *format, ...);

/* bout.c: takes the capture; fills everything below repeats and png. */
void bout_run(bout *b);
void bout_free(bout *b);

/* report.c */
void report_head(const char *device, const char *driver);
void report_bout(const bout *b, tally *t);
void report_summary(const tally *t);
void report_csv_head(FILE *csv);
void report_csv(FILE *csv, const bout *b, const char *device);

#endif
