/* json.h - JSON files, with errors that name the file, the member and the fix. */
#ifndef HBIL_FRAME_JSON_H
#define HBIL_FRAME_JSON_H

#include <stddef.h>

#include <cJSON.h>

/* The whole file of at most `most` bytes; cJSON_Delete it. what: what should be in it, "the camera's JSON". NULL: error[]. */
cJSON *json_read(const char *path, size_t most, const char *what, char *error, size_t error_size);
/* Member `name` of root: a finite number. 1, or 0: error[]. */
int    json_number(const cJSON *root, const char *name, double *out, const char *path, char *error, size_t error_size);
/* An array of exactly `count` finite numbers? Fills out if so, which may be half filled if not. No message. */
int    json_numbers(const cJSON *array, int count, double *out);

#endif
