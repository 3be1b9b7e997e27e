/* build.h - one pass of a plan in one language. */
#ifndef SHADERGEN_BUILD_H
#define SHADERGEN_BUILD_H

#include "../hbil.h"
#include "files.h"

/* Exit codes of the program; functions that return one have said why on stderr. */
enum { DONE = 0, CONFIG = 1, USAGE = 2, IO = 3, COMPILER = 4, STALE = 5 };

/* The function of environment=hook: its file and what is in it, both NULL without --hook. */
typedef struct hook_file { const char *path; char *text; } hook_file;

/* Text of a pass, malloc'd; size without its terminator. NULL: diags say why, or out of memory if they say nothing. */
char *build_glsl(const hbil_plan *plan, int32_t pass, const char *hook, size_t *size, hbil_diags *diags);
/* Text or words of a pass into f->data. An exit code. */
int   build_pass(const hbil_plan *plan, int32_t pass, int spirv, const hook_file *hook, file *f);
/* The plan as JSON into f->data. An exit code. */
int   build_manifest(const hbil_plan *plan, file *f);
/* Findings to stderr, each "shadergen: where: text"; notes only if verbose. */
void  print_diags(const hbil_diags *diags, const char *where, int verbose);

#endif
