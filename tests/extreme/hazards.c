/* hazards.c - frames in which one hazard of the arithmetic each shows, and the truth about them. */
#include "hazards.h"
