/* statements.c - the statements, and what figures say of them. */
#include "statements.h"

#include <math.h>
#include <stdio.h>

#define GTAO    "HBAO + GTAO article, GTAO: Noise"
#define SCREEN  "YPipeline HBIL article, Range of influence"
#define HALF    "YPipeline HBIL article, Results: Half Resolution"
#define FARS    "YPipeline HBIL article, Far-Field"
#define BIT(i)  (1u << (i))
#define AO_NEAR (BIT(OUT_AO) | BIT(OUT_NEAR))
#define ERRORS  (BIT(FIGURE_FIELD) | BIT(FIGURE_MODEL))
#define NOISES  (BIT(FIGURE_SAMPLING) | BIT(FIGURE_NOISE) | BIT(FIGURE_FIELD) | BIT(FIGURE_BIAS))

/* (1/2 + 1/2 cos)^2 about a light 37 degrees above the horizon: SH of order 2 are all of it */
#define LOBE                                                                                                           \
    "sh:1.18164,1.18164,1.18164,0,0,0,0.61400,0.61400,0.61400,0.81866,0.81866,0.81866,0,0,0,0,0,0,0.01057,0.01057,"   \
    "0.01057,0.21967,0.21967,0.21967,0.14645,0.14645,0.14645"

/* Of both environments; by a sweep, so that no missed horizon hides what the far light does with ao. The second article
 * reads its probes along the bent normal, times ao: far_visibility=direction. */
#define FAR_CONFIGS                                                                                                    \
    "outputs=ao+far environment=sh march=sweep slices=16 f0=rgb",                                                      \
    {"far_visibility=ao", "far_visibility=direction", "far_visibility=cone",                                           \
     "far_visibility=cone seed_compat=uniform_bent+cone_relation", "far_visibility=ao seed_compat=f0_ao",              \
     "far_visibility=bent"}
#define FAR_CLAIMS                                                                                                     \
    {{"the bent normal is better than the normal", "Mayaux 2018 sec. 2.2.1", FIGURE_FIELD, OUT_FAR, 1, 0, 1.0},        \
     {"the bent normal is better against the scene, too", "Mayaux 2018 sec. 2.2.1", FIGURE_MODEL, OUT_FAR, 1, 0, 1.0}, \
     {"a cone of that article's aperture is better than the bent normal times ao", "Mayaux 2018 sec. 2.2.4",           \
      FIGURE_FIELD, OUT_FAR, 3, 1, 1.0},                                                                               \
     {"a cone with cos aperture = sqrt(1 - ao) is better than that, too", FARS, FIGURE_FIELD, OUT_FAR, 2, 1, 1.0},     \
     {"the cone is hardly needed: without it no more than 1.1 of its error", FARS, FIGURE_FIELD, OUT_FAR, 1, 2, 1.1},  \
     {"F0(ao) gives back the energy that ao as a factor loses", "Mayaux 2018 sec. 2.2.3", FIGURE_FIELD, OUT_FAR, 4, 0, \
      1.0},                                                                                                            \
     {"the bent vector with its length is better than the cone", "project", FIGURE_FIELD, OUT_FAR, 5, 2, 1.0}}
#define FAR_CONTESTS {{"", FIGURE_FIELD, OUT_FAR, 0, 5}, {"", FIGURE_MODEL, OUT_FAR, 0, 5}}

const statement statements[] = {
    {"slices", "Noise falls with slices rather than with steps.", NULL, "f0=rgb",
     {"slices=4 steps=4", "slices=1 steps=16", "slices=2 steps=8", "slices=8 steps=2", "slices=2 steps=16",
      "slices=4 steps=8", "slices=8 steps=4", "slices=16 steps=2"},
     AO_NEAR, NOISES, 0,
     {{"4 slices of 4 steps have less noise in ao than 2 of 8", GTAO, FIGURE_NOISE, OUT_AO, 0, 2, 1.0},
      {"they have less in near light, too", GTAO, FIGURE_NOISE, OUT_NEAR, 0, 2, 1.0},
      {"half the steps add no noise: no more than 1.05 of it", GTAO, FIGURE_NOISE, OUT_AO, 0, 5, 1.05},
      {"fewer steps are paler: 2 slices of 8 are darker than 4 of 4", GTAO, FIGURE_BIAS, OUT_AO, 2, 0, 0.0},
      {"noise and bias together, 4 of 4 are better", "project", FIGURE_SAMPLING, OUT_AO, 0, 2, 1.0}},
     {{" of 16 samples a side", FIGURE_FIELD, OUT_AO, 0, 3}, {" of 16 samples a side", FIGURE_FIELD, OUT_NEAR, 0, 3},
      {" of 32", FIGURE_FIELD, OUT_AO, 4, 7}, {" of 32", FIGURE_FIELD, OUT_NEAR, 4, 7}}},
    {"fresnel", "1 - F0 outside of the integral stands for the whole Fresnel term, at next to no price.", NULL, "",
     {"f0=none", "f0=scalar", "f0=rgb"}, BIT(OUT_NEAR) | BIT(OUT_FAR), ERRORS, 1,
     {{"near light is better with it", "Mayaux 2018 sec. 2.3.3", FIGURE_FIELD, OUT_NEAR, 2, 0, 1.0},
      {"far light is better with it", "Mayaux 2018 sec. 2.3.3", FIGURE_FIELD, OUT_FAR, 2, 0, 1.0},
      {"it takes no more than 1.05 of the time", "project", FIGURE_TIME, 0, 2, 0, 1.05}}, {{0}}},
    {"exponent", "With the whole screen in reach, samples must crowd around the pixel.", NULL,
     "slices=3 steps=6 f0=rgb",
     {"exponent=1", "exponent=1.5", "exponent=2", "exponent=3", "exponent=4", "spacing=geometric"},
     AO_NEAR, BIT(FIGURE_SAMPLING) | BIT(FIGURE_FIELD) | BIT(FIGURE_BIAS), 0,
     {{"exponent 1.5 is better than 1 for ao", SCREEN, FIGURE_FIELD, OUT_AO, 1, 0, 1.0},
      {"1.5 is better than 1 for near light", SCREEN, FIGURE_FIELD, OUT_NEAR, 1, 0, 1.0},
      {"2 is better than 1.5 for ao", "project", FIGURE_FIELD, OUT_AO, 2, 1, 1.0},
      {"2 is better than 1.5 for near light", "project", FIGURE_FIELD, OUT_NEAR, 2, 1, 1.0},
      {"2 is better than geometric for ao", "project", FIGURE_FIELD, OUT_AO, 2, 5, 1.0},
      {"2 is better than geometric for near light", "project", FIGURE_FIELD, OUT_NEAR, 2, 5, 1.0}},
     {{"", FIGURE_FIELD, OUT_AO, 0, 5}, {"", FIGURE_FIELD, OUT_NEAR, 0, 5}}},
    {"half", "Half resolution takes a part of the time, and loses little.", NULL, "slices=3 steps=6 f0=rgb",
     {"", "downscale=2", "downscale=4", "filter=3x3", "filter=3x3 downscale=2", "filter=5x5",
      "filter=5x5 downscale=2", "filter=5x5 downscale=4"},
     AO_NEAR, ERRORS, 0,
     {{"no more than 2.8 of 6.8 ms, as in the Cornell box at 4K", HALF, FIGURE_TIME, 0, 1, 0, 2.8 / 6.8},
      {"no more than 4.8 - 3.4 of 11.2 - 3.4 ms, as in Sponza at 4K", HALF, FIGURE_TIME, 0, 1, 0, 1.4 / 7.8},
      {"filtered, ao keeps to 1.1 of the error", "project", FIGURE_FIELD, OUT_AO, 6, 5, 1.1},
      {"filtered, near light keeps to 1.1 of the error", "project", FIGURE_FIELD, OUT_NEAR, 6, 5, 1.1},
      {"filtered, ao keeps to 1.1 of the error against the scene", "project", FIGURE_MODEL, OUT_AO, 6, 5, 1.1},
      {"near light, too", "project", FIGURE_MODEL, OUT_NEAR, 6, 5, 1.1}}, {{0}}},
    {"bent", "The environment is best read along the bent normal. Here under the captures' sky, SH of order 1.", "sky",
     FAR_CONFIGS, BIT(OUT_FAR), ERRORS, 0, FAR_CLAIMS, FAR_CONTESTS},
    {"bent-sharp", "The same under light from one side, SH of order 2. No scene was traced under it.", LOBE,
     FAR_CONFIGS, BIT(OUT_FAR), BIT(FIGURE_FIELD), 0, FAR_CLAIMS, FAR_CONTESTS},
    {"interleave", "Interleaving is what makes it fast, and a block of 4x4 pixels adds up to 32 slices. CPUs have no\n"
                   "waves: times on a GPU will differ.", NULL, "slices=2 steps=8 f0=rgb",
     {"", "interleave=yes", "filter=5x5", "filter=5x5 interleave=yes", "mips=spread", "mips=spread interleave=yes",
      "mips=spread filter=5x5", "mips=spread filter=5x5 interleave=yes"},
     AO_NEAR, BIT(FIGURE_SAMPLING) | BIT(FIGURE_FIELD), 0,
     {{"pixels of equal noise side by side are faster", "Mayaux 2018 sec. 3.3", FIGURE_TIME, 0, 1, 0, 1.0},
      {"filtered, one noise for each place in the block leaves less error in ao", "Mayaux 2018 sec. 3.3",
       FIGURE_SAMPLING, OUT_AO, 3, 2, 1.0},
      {"filtered, it leaves less error in near light", "Mayaux 2018 sec. 3.3", FIGURE_SAMPLING, OUT_NEAR, 3, 2, 1.0},
      {"mips are faster, too", "project", FIGURE_TIME, 0, 4, 0, 1.0}}, {{0}}},
};
const int statement_count = sizeof statements / sizeof *statements;

/* ---- figures ----------------------------------------------------------------------------------------------------- */

const char *const figure_names[FIGURE_ERRORS] = {"sampling", "noise", "height field", "bias", "scene"};
const char *const verdict_words[] = {"not measured", "holds", "does not hold", "within noise"};

int statement_variants(const statement *st)
{
    int count = 0;

    while (count < STATEMENT_VARIANTS && st->variants[count]) count++;
    return count;
}

void statement_text(const statement *st, int variant, char text[TEXT_MAX])
{
    snprintf(text, TEXT_MAX, "%s%s%s", st->common, *st->common && *st->variants[variant] ? " " : "",
             st->variants[variant]);
}

double statement_value(const errors *e, int figure)
{
    const double values[FIGURE_ERRORS] = {e->rmse_sampling, e->flicker, e->rmse_field, e->bias_field, e->rmse_model};

    return e->present ? values[figure] : (double)NAN;
}

/* A mean that is taken in other units, and extremes. */
static spread gather(const double *values, int count, double (*to)(double), double (*from)(double))
{
    spread s = {0.0, (double)INFINITY, -(double)INFINITY, 0};
    int    i;

    for (i = 0; i < count; i++) {
        if (!isfinite(values[i])) continue;
        s.middle += to ? to(values[i]) : values[i];
        s.low = fmin(s.low, values[i]);
        s.high = fmax(s.high, values[i]);
        s.count++;
    }
    if (s.count == 0) s.low = s.high = (double)NAN;
    s.middle /= s.count; /* NaN where there is none */
    if (from) s.middle = from(s.middle);
    return s;
}

static double square(double x) { return x * x; }

spread spread_of(int figure, const double *values, int count)
{
    return figure == FIGURE_BIAS ? gather(values, count, NULL, NULL) : gather(values, count, square, sqrt);
}

spread spread_change(int figure, const double *less, const double *more, int count)
{
    double change[SUBJECTS_MAX];
    int    i;

    for (i = 0; i < count; i++) change[i] = figure == FIGURE_BIAS ? less[i] - more[i] : less[i] / more[i];
    return figure == FIGURE_BIAS ? gather(change, count, NULL, NULL) : gather(change, count, log, exp);
}

int verdict_of(int figure, const spread *s, double claimed)
{
    const double worth = figure == FIGURE_TIME ? 0.02 * claimed : figure == FIGURE_BIAS ? 0.001 : 0.01 * claimed;

    if (s->count == 0) return VERDICT_UNKNOWN;
    if ((s->low <= claimed && s->high >= claimed) || fabs(s->middle - claimed) <= worth) return VERDICT_NOISE;
    return s->middle < claimed ? VERDICT_HOLDS : VERDICT_FAILS;
}
