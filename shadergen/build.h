/* build.h - one pass of a plan in one language, in memory. */
#ifndef SHADERGEN_BUILD_H
#define SHADERGEN_BUILD_H

#include "../hbil.h"
#include "files.h"

/* Exit codes of the program; functions that return one have said why on stderr. */
enum { DONE = 0, CONFIG = 1, USAGE = 2, IO = 3, COMPILER = 4, STALE = 5 };

/* GLSL is whatever dialect target and stage ask for. */
typedef enum language { GLSL, SPIRV, HLSL_5, HLSL_6, MSL } language;

/* The function of environment=hook: its file and what is in it, both NULL without --hook. */
typedef struct hook_file { const char *path; char *text; } hook_file;

/* Says so on stderr. IO */
int   no_memory(void);
/* Text of a pass, malloc'd; size without its terminator. NULL: diags say why, or out of memory if they say nothing. */
char *build_glsl(const hbil_plan *plan, int32_t pass, const char *hook, size_t *size, hbil_diags *diags);
/* A pass in a language into f->data. glslang must run (hbil_glslang_init) for all but GLSL. An exit code. */
int   build_pass(const hbil_plan *plan, int32_t pass, language l, const hook_file *hook, file *f);
/* The vertex shader of stage=fragment. */
int   build_vertex(const hbil_plan *plan, file *f);
/* The plan as JSON. */
int   build_manifest(const hbil_plan *plan, file *f);
/* All passes, or one if `only` is not negative, as a C header that compiles alone. name: of the file, for guard and prefix. */
int   build_c(const hbil_plan *plan, int32_t only, const char *name, const hook_file *hook, file *f);
/* HLSL and MSL of a pass from the words of its SPIR-V, with the registers of hbil_plan_register. NULL: said on stderr. */
char *build_cross(const hbil_plan *plan, int32_t pass, language l, const uint32_t *words, size_t count, size_t *size);

/* Name of a language for files: ".comp", ".frag", ".spv", ".hlsl", ".metal". */
const char *language_suffix(const hbil_plan *plan, language l);

#endif
