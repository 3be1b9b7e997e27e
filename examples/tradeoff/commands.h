/* commands.h - the subcommands. argv[0] is the first word behind the name of the subcommand. Each returns an exit code
 * of common.h and has said on stderr what was wrong. */
#ifndef HBIL_TRADEOFF_COMMANDS_H
#define HBIL_TRADEOFF_COMMANDS_H

#include "measure.h"

int  sweep_main(int argc, char **argv);
int  pair_main(int argc, char **argv);
int  ablate_main(int argc, char **argv);
int  growth_main(int argc, char **argv);
int  statements_main(int argc, char **argv);
void sweep_help(void);
void pair_help(void);
void ablate_help(void);
void growth_help(void);
void statements_help(void);

/* "hbil-tradeoff: " and s->error on stderr; returns code. */
int  command_fail(const settings *s, int code);
/* A command line: --help prints `help`, settings are taken; what is left goes to `take` (1: taken, 0: s->error, -1:
 * unknown), a word without -- with the name "". 1: go on; 0: *code is the exit code. */
int  command_line(settings *s, int argc, char **argv, void (*help)(void),
                  int (*take)(void *user, settings *s, const char *name, const char *value), void *user, int *code);

#define DUEL_BLOCK 3 /* runs of one side, before the other has its turn */

/* Two configs in turns, A B A B, on one device: what another one, or a later minute, makes of the same shader is often
 * more than what two configs differ by. Each turn begins with shaders and textures made anew. */
typedef struct duel {
    double ms[2][TIMING_RUNS_MAX];    /* of all runs */
    double turn[2][TIMING_RUNS_MAX];  /* their medians */
    int    runs, turns, stable;       /* of each side */
} duel;
/* s->repeat turns of each, or what fits into s->seconds, at least 3. An exit code. */
int  duel_run(settings *s, lit *a, lit *b, duel *d);
/* The same of anything that can be timed. */
int  duel_turns(settings *s, timing_run *run, void *a, void *b, duel *d);
/* A line of words for a ratio: "-12.3 % [-13.0, -11.5]", or "within noise". */
void duel_words(const timing_ratio *r, char *out, size_t size);

#endif
