/* analysis.h - what a sweep's CSV says: reports, recommendations, comparisons. */
#ifndef HBIL_TRADEOFF_ANALYSIS_H
#define HBIL_TRADEOFF_ANALYSIS_H

/* A program's main: argv[1] is report, recommend, compare or --help. Exit code: 0 done, 1 nothing fits, a held-out
 * prediction is off by more than 25 %, or two runs are not the same, 2 usage, 3 files. */
int analysis_main(int argc, char **argv);
/* 1: analysis_main knows this word. */
int analysis_knows(const char *word);

#endif
