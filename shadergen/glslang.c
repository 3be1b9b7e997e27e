/* glslang.c - the implementation of hbil_glslang.h, once for every program of this tree. */
#define HBIL_GLSLANG_IMPLEMENTATION
#include "../backends/hbil_glslang.h"
