/* fuzz.h - what the harnesses share: their entry point, claims that must hold, files to hand over by name. */
#ifndef HBIL_FUZZ_H
#define HBIL_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* A harness: hands one input to the code under test. Called any number of times; returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A fault that no sanitizer sees: prints it and aborts. */
#define FUZZ_REQUIRE(condition) ((condition) ? (void)0 : fuzz_fail(__FILE__, __LINE__, #condition))
void fuzz_fail(const char *file, int line, const char *condition);

extern int fuzz_errors; /* the descriptor to which it prints */

/* A temporary folder, which becomes the working directory and is removed with all that is in it at the end. Standard input
 * is empty from here on. */
void fuzz_enter_folder(void);
/* Removes what is in it. */
void fuzz_empty_folder(void);
/* A file in it. */
void fuzz_write(const char *name, const void *data, size_t size);

/* Reads an input from its begin; 0 behind its end. */
typedef struct fuzz_reader { const uint8_t *at; size_t left; } fuzz_reader;
uint32_t fuzz_take(fuzz_reader *r, size_t bytes); /* little-endian, at most 4 */

#endif
