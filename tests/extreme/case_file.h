/* case_file.h - a config and its frames as a text that people read and that keeps every bit: "nan", "inf", hex where decimals would not do. */
#ifndef HBIL_EXTREME_CASE_FILE_H
#define HBIL_EXTREME_CASE_FILE_H

#include "random_frame.h"

/* note: lines of comment for the head, each ends in a line break. Temporary file, then renamed. 0: error[] says why. */
int case_write(const char *path, const test_case *c, const char *note, char *error, size_t error_size);
/* 0: error[] names the line, the fault and the fix; *out is empty. */
int case_read(const char *path, test_case *out, char *error, size_t error_size);

#endif
