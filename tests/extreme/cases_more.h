/* cases_more.h - cases that the mutation check found lacking: truths that hold only while a guard stands. */
#ifndef HBIL_EXTREME_CASES_MORE_H
#define HBIL_EXTREME_CASES_MORE_H

#include "cases.h"

extern const extreme_case extreme_more[];
extern const int extreme_more_count;

#endif
