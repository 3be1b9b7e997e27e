/* hbil.c - the implementation of hbil.h and hbil_null.h, once for all harnesses. */
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#define HBIL_NULL_IMPLEMENTATION
#include "../../backends/hbil_null.h"
