/* analysis.h - the subcommands report and recommend. */
#ifndef HBIL_TRADEOFF_ANALYSIS_H
#define HBIL_TRADEOFF_ANALYSIS_H

/* argv[0] is the name of the subcommand. An exit code. Weak: the program links without it. */
int analysis_main(int argc, char **argv) __attribute__((weak));

#endif
