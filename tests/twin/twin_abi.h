/* twin_abi.h - what twin.cpp and the libraries that it makes of shaders tell each other. C, and C++. */
#ifndef HBIL_TWIN_ABI_H
#define HBIL_TWIN_ABI_H

/* What undefined behaviour is counted as. */
enum { TWIN_FETCH, TWIN_STORE, TWIN_UNWRITTEN, TWIN_CONVERSION, TWIN_DIVISION, TWIN_INDEX, TWIN_FAULT_KINDS };
typedef struct twin_faults {
    unsigned long count[TWIN_FAULT_KINDS];
    char          first[TWIN_FAULT_KINDS][160]; /* pass, place and invocation; "" while there is none */
} twin_faults;

typedef struct twin_texture {
    char           name[24];
    int            width, height, depth;    /* of the memory; depth: layers, faces or slices */
    int            bound[2];                /* texels in x and y that may be touched */
    int            channels;                /* 1 or 4 floats (doubles); 0: one uint */
    int            half, sample;            /* half: rounded to half floats. sample: the one of a multisampled texture that is there */
    void          *texels;
    unsigned char *written;                 /* per texel: 1 since it was written */
} twin_texture;

/* Work of a pass: texels read and written, an atomic operation is one of each; square roots, also inverse ones. */
typedef struct twin_counts { unsigned long reads, writes, roots; } twin_counts;

typedef struct twin_state {
    twin_faults *faults;
    twin_counts *counts;
    const char  *pass;
    int          at[2];                     /* invocation */
} twin_state;

/* One pass: its grid (groups, with stage=fragment pixels), its bindings in the order of the plan, the uniform block. */
typedef struct twin_work {
    int                  groups[2];
    twin_texture *const *bindings;
    const unsigned char *block;
} twin_work;
typedef void twin_pass(twin_state *state, const twin_work *work);

#endif
