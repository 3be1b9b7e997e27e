/* hazards.h - frames in which one hazard of the arithmetic each shows, and the truth about them. */
#ifndef HBIL_EXTREME_HAZARDS_H
#define HBIL_EXTREME_HAZARDS_H

#include "cases.h"

#endif
