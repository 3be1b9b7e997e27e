/* statements.h - what the articles say, as experiments: configs to compare, and the figures that decide. */
#ifndef HBIL_TRADEOFF_STATEMENTS_H
#define HBIL_TRADEOFF_STATEMENTS_H

#include "measure.h"

#define STATEMENT_VARIANTS 9 /* all three: with a last one that is empty */
#define STATEMENT_CLAIMS   8
#define STATEMENT_CONTESTS 5

/* Figures of a config: errors of an output (see errors in measure.h), or its time against the base. */
enum { FIGURE_SAMPLING, FIGURE_NOISE, FIGURE_FIELD, FIGURE_BIAS, FIGURE_MODEL, FIGURE_ERRORS };
#define FIGURE_TIME FIGURE_ERRORS
extern const char *const figure_names[FIGURE_ERRORS];

/* One sentence: the figure of variant `less` is at most `factor` times that of variant `more`, which is the base if
 * the figure is its time; of biases: is below it, factor 0. source: as in options.def, "project" where it is ours. */
typedef struct claim {
    const char *words, *source;
    int         figure, out, less, more;
    double      factor;
} claim;

/* Which of the variants [first, last] has the least error. */
typedef struct contest { const char *words; int figure, out, first, last; } contest;

typedef struct statement {
    const char *name, *words;
    const char *env;                          /* as --env has it; NULL: the command line's */
    const char *common;                       /* options of all configs */
    const char *variants[STATEMENT_VARIANTS]; /* what each adds; the first is the base */
    unsigned    outputs, figures;             /* bits: OUT_, FIGURE_ of the table */
    int         fresnel;                      /* frames without F0 get that of dielectrics; Schlick's term, too */
    claim       claims[STATEMENT_CLAIMS];
    contest     contests[STATEMENT_CONTESTS];
} statement;

extern const statement statements[];
extern const int       statement_count;

int    statement_variants(const statement *st);
void   statement_text(const statement *st, int variant, char text[TEXT_MAX]);
/* A figure from FIGURE_SAMPLING to FIGURE_MODEL; NaN: not known. */
double statement_value(const errors *e, int figure);

/* Over frames. count 0: not known, the rest is NaN. */
typedef struct spread { double middle, low, high; int count; } spread;
/* Of count values, NaN left out: root of the mean square, of biases the mean. */
spread spread_of(int figure, const double *values, int count);
/* less over more, frame by frame: geometric mean; of biases less - more: mean. */
spread spread_change(int figure, const double *less, const double *more, int count);

enum { VERDICT_UNKNOWN, VERDICT_HOLDS, VERDICT_FAILS, VERDICT_NOISE };
extern const char *const verdict_words[];
/* Is it below what is claimed? Noise: the claim lies in its range, or its middle no farther off than its figure is
 * worth: 2 % of a time, 1 % of an error, .001 of a bias. */
int verdict_of(int figure, const spread *s, double claimed);

#endif
