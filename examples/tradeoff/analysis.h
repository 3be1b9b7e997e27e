/* analysis.h - what a sweep's CSV says: reports and recommendations. */
#ifndef HBIL_TRADEOFF_ANALYSIS_H
#define HBIL_TRADEOFF_ANALYSIS_H

/* A program's main: argv[1] is report, recommend or --help. Exit code: 0 done, 1 nothing fits or a held-out prediction
 * is off by more than 25 %, 2 usage, 3 files. */
int analysis_main(int argc, char **argv);
/* 1: analysis_main knows this word. */
int analysis_knows(const char *word);

#endif
