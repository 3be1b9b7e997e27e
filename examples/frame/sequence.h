/* sequence.h - the files of a sequence: names with the number of the frame in them. */
#ifndef HBIL_FRAME_SEQUENCE_H
#define HBIL_FRAME_SEQUENCE_H

#include <stddef.h>

/* Conversions %d or %03d in a pattern; %% is a percent sign. -1: there is another one, or a % at the end. */
int sequence_conversions(const char *pattern);
/* The pattern with the number in the place of its conversion. 1, or 0: longer than size. The pattern has at most one. */
int sequence_name(char *out, size_t size, const char *pattern, int number);
/* "A:B" with 0 <= A <= B <= 99999. 1, or 0 */
int sequence_range(const char *text, int *first, int *last);

#endif
