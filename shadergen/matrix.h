/* matrix.h - shadergen matrix: all combinations of lists of values, built in bulk. */
#ifndef SHADERGEN_MATRIX_H
#define SHADERGEN_MATRIX_H

#include "build.h"

#include <pthread.h>
#include <stdio.h>

/* The command; argv[0] is its name. An exit code. */
int matrix(int argc, char **argv);

/* ---- between its files */

#define VARIANT_PASSES (HBIL_MAX_PASSES + 1) /* stage=fragment has a vertex shader, too */
#define STATE_FILE     "matrix.state"
#define MANIFEST_FILE  "manifest.json"

/* Whole numbers by hash. Zero it first. */
typedef struct map { uint64_t *keys; int32_t *values; int32_t count, room; } map;
int      map_find(const map *m, uint64_t key);               /* -1: absent */
int      map_put(map *m, uint64_t key, int32_t value);       /* 0: out of memory */
void     map_free(map *m);
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size); /* FNV-1a; begin with HASH */
#define HASH 14695981039346656037u

/* A text and the file that holds its words. Texts are equal if their code is, whatever the comments at their head say;
 * with --format glsl the file holds the text, and all of it counts. */
typedef enum slot_status { SLOT_NEW, SLOT_LISTED, SLOT_BUSY, SLOT_GOOD } slot_status;
typedef struct slot {
    uint64_t    key;        /* of the text */
    uint64_t    bytes;
    char        file[64];   /* "spirv/march-<hash of its bytes>.spv" */
    slot_status status;     /* LISTED: the state says so, nobody has looked yet */
} slot;

typedef struct variant {
    uint64_t    hash;       /* hbil_config_hash; 0: refused */
    hbil_config config;     /* as asked for if refused, else resolved */
    char       *refused;    /* NULL, or why, a line each */
    char       *facts;      /* what the manifest says of it beside its files, JSON members; kept in the state */
    int32_t     count, slots[VARIANT_PASSES]; /* in the order of the plan */
} variant;

typedef struct variants { variant *items; int32_t count, room; } variants;
variant *variants_add(variants *list); /* zeroed; NULL: out of memory */
void     variants_free(variants *list);

typedef struct matrix_counts { int32_t variants, refused, passes, files; uint64_t bytes; } matrix_counts;

typedef struct matrix_job {
    const char *file, *folder;            /* folder ends with / */
    int         spirv, c, check, quiet, verbose, threads;
    int32_t     combinations, equal;      /* equal: as an earlier combination after resolving */
    matrix_counts counts;                 /* once all are made */
    variants    list;
    /* what an earlier run left */
    uint64_t    key;                      /* of all that decides what is made, but the config */
    variants    old;
    map         old_index;                /* config hash -> old */
    char       *state, *manifest;         /* their texts name every file that an earlier run made */
    /* shared by the workers, under lock */
    pthread_mutex_t lock;
    pthread_cond_t  changed;
    slot       *slots;
    int32_t     slot_count, slot_room;
    map         slot_index;               /* text key -> slot */
    int32_t     next, done, compiled, stale, removed, running;
    int         code;                     /* first failure; stops all */
    FILE       *journal;
} matrix_job;

double seconds(void);                     /* of a clock that never steps */
/* matrix_list.c */
int    list_read(matrix_job *m);          /* the file to variants, refused ones too. An exit code, as what follows */
char  *reasons(const hbil_diags *diags);  /* the errors, a line each; NULL: out of memory */
/* matrix_state.c: what was made here before */
int    state_read(matrix_job *m);
int    state_append(matrix_job *m, const variant *v); /* a variant is whole; under lock */
int    state_print(const matrix_job *m, file *f);
int    state_clean(matrix_job *m);        /* removes temporary files of a run that was killed */
int    state_remove_old(matrix_job *m);   /* removes files that state or manifest list and no variant has */
/* matrix_build.c */
int    build_all(matrix_job *m);          /* on all threads */
int32_t slot_of(matrix_job *m, uint64_t key); /* found or made; -1: out of memory. Under lock */
void   progress(const matrix_job *m, const char *what, int32_t done, int32_t all);
void   say_stale(matrix_job *m, const char *name, const char *what); /* of --check; under lock */
int    name_of(const slot *s);            /* letters of the pass's name, which begin at slot_name */
const char *slot_name(const slot *s);
/* matrix_output.c */
int    output_manifest(matrix_job *m, file *f);
int    output_c(const matrix_job *m, file *header, file *source);

#endif
