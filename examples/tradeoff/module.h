/* module.h - a SPIR-V module as a pass of a plan that is made by hand. */
#ifndef HBIL_TRADEOFF_MODULE_H
#define HBIL_TRADEOFF_MODULE_H

#include "external.h"

/* What the command line says of one pass. */
typedef struct module_key { char name[20]; int set, binding; /* set -1: push constants */ } module_key;
typedef struct module_text {
    const char *path, *entry;           /* entry: NULL: the only one */
    module_key  keys[HBIL_MAX_BINDINGS + 1];
    int         count;
} module_text;

/* Reads the file and appends its pass, textures and words to *e. Bindings become those that hbil_vk.h counts on: set 0,
 * in the order of the pass; push constants become the uniform block, as 224 bytes are more than the 128 that every
 * device pushes. An exit code; s->error says what to mend. */
int module_append(external *e, const module_text *text, settings *s);

#endif
