/* commands.h - the subcommands. argv[0] is the first word behind the name of the subcommand. Each returns an exit code of common.h
 * and has said on stderr what was wrong. */
#ifndef HBIL_TRADEOFF_COMMANDS_H
#define HBIL_TRADEOFF_COMMANDS_H

#include "measure.h"

int  sweep_main(int argc, char **argv);
int  pair_main(int argc, char **argv);
int  ablate_main(int argc, char **argv);
void sweep_help(void);
void pair_help(void);
void ablate_help(void);

/* "hbil-tradeoff: " and s->error on stderr; returns code. */
int  command_fail(const settings *s, int code);
/* A command line: --help prints `help`, settings are taken; what is left goes to `take` (1: taken, 0: s->error, -1: unknown), a word
 * without -- with the name "". 1: go on; 0: *code is the exit code. */
int  command_line(settings *s, int argc, char **argv, void (*help)(void),
                  int (*take)(void *user, settings *s, const char *name, const char *value), void *user, int *code);

/* Two configs on one frame, each with a device of its own, so that both keep their shaders. */
typedef struct duel { lit side[2]; double ms[2][TIMING_RUNS_MAX]; int runs, stable; } duel;
/* The times of two opened ones, in turns: A B A B. An exit code. */
int  duel_run(settings *s, duel *d);
/* A line of words for a ratio: "-12.3 % [-13.0, -11.5]", or "within noise". */
void duel_words(const timing_ratio *r, char *out, size_t size);

#endif
