/* test_statements.c - the articles' statements: every config is one, verdicts on figures made by hand, Schlick's
 * term. */
#include <math.h>
#include <unistd.h>

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "fresnel.h"
#include "statements.h"

#define COUNT(a) (sizeof(a) / sizeof *(a))
#define NEAR(a, b, within) assert_true(fabs((double)(a) - (double)(b)) <= (within))

static char error[ERROR_MAX];

/* ---- the table */

/* Settings under the statement's light, as the command has them. */
static settings under(const statement *st)
{
    settings s;

    settings_default(&s);
    if (st->env) s.env = st->env;
    if (!environment_parse(&s.light, s.env, error, sizeof error)) fail_msg("%s: %s", st->name, error);
    return s;
}

static void every_config_resolves_and_differs(void **state)
{
    float     f0 = 0.04f;
    capture   cap;
    char      text[TEXT_MAX];
    int       i, v, k;

    (void)state;
    memset(&cap, 0, sizeof cap);
    cap.f0.data = &f0;
    for (i = 0; i < statement_count; i++) {
        const statement *st = &statements[i];
        settings         s = under(st);
        uint64_t         hashes[STATEMENT_VARIANTS];

        assert_in_range(statement_variants(st), 2, STATEMENT_VARIANTS - 1);
        for (v = 0; v < statement_variants(st); v++) {
            hbil_config c;

            statement_text(st, v, text);
            if (!config_make(&s, text, (st->outputs & 1u << OUT_FAR) != 0, &cap, &c, error, sizeof error))
                fail_msg("%s: %s", st->name, error);
            hashes[v] = hbil_config_hash(&c);
            for (k = 0; k < v; k++)
                if (hashes[k] == hashes[v]) fail_msg("%s: %s is what another one is", st->name, text);
        }
        environment_free(&s.light);
    }
}

static void every_claim_has_figures_and_a_source(void **state)
{
    int i, k;

    (void)state;
    for (i = 0; i < statement_count; i++) {
        const statement *st = &statements[i];
        const int        count = statement_variants(st);

        assert_non_null(st->claims[0].words);
        assert_null(st->claims[STATEMENT_CLAIMS - 1].words); /* an empty one ends the list */
        assert_null(st->contests[STATEMENT_CONTESTS - 1].words);
        for (k = 0; k < STATEMENT_CLAIMS && st->claims[k].words; k++) {
            const claim *c = &st->claims[k];

            assert_true(c->source && *c->source);
            assert_true(c->less >= 0 && c->less < count && c->more >= 0 && c->more < count && c->less != c->more);
            assert_true((c->figure == FIGURE_BIAS) == (c->factor == 0.0));
            if (c->figure == FIGURE_TIME) assert_int_equal(c->more, 0);
            else assert_true(st->outputs & 1u << c->out);
            if (c->figure == FIGURE_SAMPLING || c->figure == FIGURE_NOISE)
                assert_true(st->figures & 1u << c->figure); /* else it is not measured */
        }
        for (k = 0; k < STATEMENT_CONTESTS && st->contests[k].words; k++) {
            assert_true(st->contests[k].first < st->contests[k].last && st->contests[k].last < count);
            assert_true(st->outputs & 1u << st->contests[k].out);
        }
    }
}

/* (1/2 + 1/2 cos)^2: 1 towards the light, 1/4 across it, 0 behind. */
static void the_light_from_one_side_is_what_it_is_called(void **state)
{
    static const double directions[][4] = {{0.8, 0.0, 0.6, 1.0}, {0.0, 1.0, 0.0, 0.25}, {-0.8, 0.0, -0.6, 0.0}};
    double rgb[3];
    size_t i;
    int    k, found = 0;

    (void)state;
    for (k = 0; k < statement_count; k++) {
        settings s;

        if (strcmp(statements[k].name, "bent-sharp") != 0) continue;
        s = under(&statements[k]);
        for (i = 0; i < COUNT(directions); i++) {
            environment_radiance(&s.light, directions[i], rgb);
            NEAR(rgb[0], directions[i][3], 1e-4);
            assert_true(rgb[0] == rgb[1] && rgb[1] == rgb[2]);
        }
        assert_false(s.light.captures_sky);
        environment_free(&s.light);
        found++;
    }
    assert_int_equal(found, 1);
}

/* ---- verdicts */

static int verdict(int figure, double low, double middle, double high, double claimed)
{
    const spread s = {middle, low, high, 3};

    return verdict_of(figure, &s, claimed);
}

static void verdicts_follow_from_the_figures(void **state)
{
    const spread none = {(double)NAN, (double)NAN, (double)NAN, 0};

    (void)state;
    assert_int_equal(verdict(FIGURE_NOISE, 0.7, 0.8, 0.9, 1.0), VERDICT_HOLDS);
    assert_int_equal(verdict(FIGURE_NOISE, 1.1, 1.2, 1.3, 1.0), VERDICT_FAILS);
    assert_int_equal(verdict(FIGURE_NOISE, 1.1, 1.2, 1.3, 1.5), VERDICT_HOLDS);
    assert_int_equal(verdict(FIGURE_NOISE, 0.5, 0.8, 1.1, 1.0), VERDICT_NOISE); /* the frames disagree */
    assert_int_equal(verdict(FIGURE_FIELD, 0.994, 0.995, 0.996, 1.0), VERDICT_NOISE);
    assert_int_equal(verdict(FIGURE_FIELD, 0.984, 0.985, 0.986, 1.0), VERDICT_HOLDS);
    assert_int_equal(verdict(FIGURE_TIME, 0.984, 0.985, 0.986, 1.0), VERDICT_NOISE); /* no clock is that good */
    assert_int_equal(verdict(FIGURE_TIME, 0.39, 0.40, 0.41, 0.4118), VERDICT_HOLDS);
    assert_int_equal(verdict(FIGURE_TIME, 0.60, 0.61, 0.62, 0.4118), VERDICT_FAILS);
    assert_int_equal(verdict(FIGURE_BIAS, -0.02, -0.01, -0.005, 0.0), VERDICT_HOLDS);
    assert_int_equal(verdict(FIGURE_BIAS, 0.005, 0.01, 0.02, 0.0), VERDICT_FAILS);
    assert_int_equal(verdict(FIGURE_BIAS, -0.0009, -0.0008, -0.0007, 0.0), VERDICT_NOISE);
    assert_int_equal(verdict_of(FIGURE_FIELD, &none, 1.0), VERDICT_UNKNOWN);
    assert_string_equal(verdict_words[VERDICT_FAILS], "does not hold");
}

static void means_over_frames_match_numbers_worked_out_by_hand(void **state)
{
    const double less[] = {0.1, (double)NAN, 0.4}, more[] = {0.2, 0.3, 0.2}, nothing[] = {(double)NAN, (double)NAN};
    spread       s = spread_of(FIGURE_FIELD, less, 3);

    (void)state;
    assert_int_equal(s.count, 2);
    NEAR(s.middle, sqrt(0.17 / 2.0), 1e-12);
    assert_true(s.low == 0.1 && s.high == 0.4);
    NEAR(spread_of(FIGURE_BIAS, less, 3).middle, 0.25, 1e-12);
    s = spread_change(FIGURE_FIELD, less, more, 3); /* a half and the double */
    assert_int_equal(s.count, 2);
    NEAR(s.middle, 1.0, 1e-12);
    NEAR(s.low, 0.5, 1e-12);
    NEAR(s.high, 2.0, 1e-12);
    s = spread_change(FIGURE_BIAS, less, more, 3);
    NEAR(s.middle, 0.05, 1e-12);
    NEAR(s.low, -0.1, 1e-12);
    s = spread_of(FIGURE_FIELD, nothing, 2);
    assert_true(s.count == 0 && isnan(s.middle) && isnan(s.low));
}

/* ---- Schlick's term */

/* Percent, as a sum over both angles gave it. At n.V = 1: twice the integral of (1 - c)^5 sin cos over a quarter,
 * c = cos(t / 2). */
static void the_term_that_is_left_out(void **state)
{
    static const double known[][2] = {{1.0, 0.008}, {0.95, 0.021}, {0.9, 0.039}, {0.8, 0.094}, {0.7, 0.18},
                                      {0.5, 0.50},  {0.3, 1.1},    {0.1, 2.1},   {0.0, 2.8}};
    double sum = 0.0;
    size_t i;
    int    k;

    (void)state;
    for (i = 0; i < COUNT(known); i++) {
        const double percent = 100.0 * fresnel_dropped(known[i][0]);

        NEAR(percent, known[i][1], known[i][1] >= 1.0 ? 0.05 : known[i][1] >= 0.1 ? 0.005 : 0.0006);
        if (i > 0) assert_true(percent > 100.0 * fresnel_dropped(known[i - 1][0])); /* it grows as n.V falls */
    }
    for (k = 0; k < 10000; k++) {
        const double t = (k + 0.5) * 1.5707963267948966 / 10000.0;

        sum += 2.0 * pow(1.0 - cos(0.5 * t), 5.0) * sin(t) * cos(t) * 1.5707963267948966 / 10000.0;
    }
    NEAR(fresnel_dropped(1.0), sum, 1e-8);
    NEAR(fresnel_bound(0.0003), 0.92, 0.005);
    NEAR(fresnel_dropped(fresnel_bound(0.01)), 0.01, 1e-5);
    assert_true(fresnel_bound(0.1) == 0.0 && fresnel_bound(0.0) == 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_config_resolves_and_differs),
        cmocka_unit_test(every_claim_has_figures_and_a_source),
        cmocka_unit_test(the_light_from_one_side_is_what_it_is_called),
        cmocka_unit_test(verdicts_follow_from_the_figures),
        cmocka_unit_test(means_over_frames_match_numbers_worked_out_by_hand),
        cmocka_unit_test(the_term_that_is_left_out),
    };

    return cmocka_run_group_tests_name("statements", tests, NULL, NULL);
}
