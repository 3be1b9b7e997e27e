/* ablate.c - hbil-tradeoff ablate: what each feature of a config buys on a frame, and what is left when those go that
 * buy nothing. */
#include "commands.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FULL  "estimator=bitmask occluder=thick facing=half_space f0=rgb mips=spread interleave=yes filter=5x5"
#define SLACK 1e-4 /* rmse that never counts as a loss: below what 16-bit floats hold of 1 */

/* A step down: where `option` has one of the values `from`, the options `to` take its place. compat: the feature is the
 * arithmetic that this member of seed_compat takes back. */
typedef struct feature { const char *name, *option, *from, *to; uint32_t compat; } feature;

static const feature features[] = {
    {"Fresnel term per channel", "f0", "rgb", "f0=scalar", 0},
    {"Fresnel term", "f0", "rgb scalar", "f0=none", 0},
    {"facing of the source", "facing", "filter half_space", "facing=none", 0},
    {"thickness", "occluder", "thick", "occluder=height_field", 0},
    {"sinking horizons", "occluder", "heuristic", "occluder=height_field", 0},
    {"sectors", "estimator", "bitmask", "estimator=horizon occluder=height_field", 0},
    {"free sectors for far light", "far_visibility", "free_bits", "far_visibility=bent", 0},
    {"bent vector for far light", "far_visibility", "bent direction cone free_bits", "far_visibility=ao", 0},
    {"second order of SH", "sh_order", "2", "sh_order=1", 0},
    {"environment by direction", "environment", "sh cube probes hook", "environment=constant", 0},
    {"samples nearby", "march", "both", "march=sampled", 0},
    {"bilinear samples", "sampling", "bilinear", "sampling=nearest", 0},
    {"depth mips", "mips", "mean spread weighted nearest", "mips=none", 0},
    {"interleaving", "interleave", "yes", "interleave=no", 0},
    {"noise", "noise", "ign hilbert_r2", "noise=none", 0},
    {"light in full floats", "gather", "rise", "gather=packed", 0},
    {"light at each rise", "gather", "rise packed", "gather=side", 0},
    {"ratio estimator", NULL, NULL, NULL, HBIL_SEED_COMPAT_SLICE_MEAN},
    {"exact azimuth", NULL, NULL, NULL, HBIL_SEED_COMPAT_SCREEN_AZIMUTH},
    {"storage in 32 bits", "storage", "full", "storage=half", 0},
    {"arithmetic in 32 bits", "arithmetic", "full", "arithmetic=half", 0},
    {"filter of 5x5", "filter", "5x5", "filter=3x3", 0},
    {"filter", "filter", "3x3 5x5", "filter=none", 0},
    {"further passes of the filter", "filter_passes", "2 3", "filter_passes=1", 0},
    {"frames before", "temporal", "yes", "temporal=no", 0},
    {"all bounces", "bounces", "recursive", "bounces=one", 0},
    {"motion", "reproject", "gather scatter", "reproject=camera", 0},
    {"full resolution", "downscale", "1", "downscale=2", 0},
    {"half resolution", "downscale", "2", "downscale=4", 0},
};
enum { FEATURES = sizeof features / sizeof *features };

/* A config as it was judged. */
typedef struct verdict {
    hbil_config  config;
    errors       out[OUTS];
    price        cost;
    timing_ratio time;  /* against the one that it was compared with */
    double       ms;
} verdict;

typedef struct ablation {
    settings    s;
    const char *text, *against;
    double      tolerance;
    runner     *device;
    subject     sub;
    truth       t;
    lit         side[2];        /* the config that others are compared with, and the other */
    duel        d;
    verdict     full, without[FEATURES];
    int         used[FEATURES]; /* the feature is in the full config */
} ablation;

void ablate_help(void)
{
    fputs(
        "  ablate  [CONFIG | --preset NAME] [--tolerance T] [--against model|field] frames\n"
        "          switches off one feature of the config at a time, and tells what each buys in error and costs in\n"
        "          time, fetches and bytes; then drops features, the dearest first, while no output's error is above\n"
        "          the least so far by more than the tolerance. Without a config: sectors, thickness, facing, Fresnel\n"
        "          term, mips, filter; ao, near and far light\n"
        "  --tolerance T     relative growth of the rmse, default 0.05\n"
        "  --against model   the path-traced scene, where a frame has it (default); field: the height field\n",
        stdout);
}

static int take(void *user, settings *s, const char *name, const char *value)
{
    ablation *a = user;

    if (!*name || strcmp(name, "--preset") == 0) {
        if (a->text) return frame_error(s->error, sizeof s->error, "%s: a second config; ablate takes one", value);
        a->text = value;
        return *value != 0 || frame_error(s->error, sizeof s->error, "--preset: without its value");
    }
    if (strcmp(name, "--tolerance") == 0)
        return read_double(value, 0.0, 10.0, &a->tolerance)
            || frame_error(s->error, sizeof s->error, "--tolerance %s: must be a number in [0, 10], as in 0.05", value);
    if (strcmp(name, "--against") == 0) {
        a->against = value;
        return strcmp(value, "model") == 0 || strcmp(value, "field") == 0
            || frame_error(s->error, sizeof s->error, "--against %s: must be model or field", value);
    }
    return -1;
}

/* ---- configs ----------------------------------------------------------------------------------------------------- */

/* The value of a choice or a whole number, as text. */
static void option_value(const hbil_config *config, const char *name, char out[32])
{
    const hbil_option *o = hbil_option_at(hbil_option_find(name, strlen(name), NULL));
    const char        *p = o->choices;
    int32_t            value;

    memcpy(&value, (const char *)config + o->offset, sizeof value);
    if (o->kind == HBIL_KIND_INT) {
        snprintf(out, 32, "%d", (int)value);
        return;
    }
    for (; value > 1 && *p; value--) p += strcspn(p, " ") + (p[strcspn(p, " ")] != 0);
    snprintf(out, 32, "%.*s", (int)strcspn(p, " "), p);
}

static int has_word(const char *list, const char *word)
{
    const size_t length = strlen(word);

    for (; *list; list += strcspn(list, " "), list += *list == ' ')
        if (strcspn(list, " ") == length && strncmp(list, word, length) == 0) return 1;
    return 0;
}

/* The config without the feature. 0: it has not got it, or cannot do without. */
static int drop(const hbil_config *config, const feature *f, hbil_config *out)
{
    hbil_config c = *config;
    char        value[32];

    if (f->compat) c.seed_compat |= f->compat;
    else {
        option_value(config, f->option, value);
        if (!has_word(f->from, value) || hbil_config_parse(&c, f->to, strlen(f->to), NULL) != HBIL_OK) return 0;
    }
    return hbil_config_resolve(&c, out, NULL) == HBIL_OK && hbil_config_hash(out) != hbil_config_hash(config);
}

/* ---- judging ----------------------------------------------------------------------------------------------------- */

/* The rmse that counts for an output; NaN: it has no truth. */
static double error_of(const ablation *a, const errors *e)
{
    const int model = strcmp(a->against, "model") == 0;

    if (!e->present) return (double)NAN;
    return model && isfinite(e->rmse_model) ? e->rmse_model : e->rmse_field;
}

/* Runs the config in turns with the one that lies in side 0; stays open in side 1. */
static int judge(ablation *a, const hbil_config *config, verdict *v)
{
    lit *l = &a->side[1];
    int  code;

    lit_close(l);
    v->config = *config;
    if (!lit_open(l, a->device, &a->s, config, &a->sub, a->s.error, sizeof a->s.error)) return TRADE_MISFIT;
    code = measure_errors(&a->s, l, &a->t, &a->full.config, NULL, 0, v->out);
    if (code == TRADE_DONE) code = measure_cost(&a->s, l, &v->cost);
    if (code == TRADE_DONE) code = duel_run(&a->s, &a->side[0], &a->side[1], &a->d);
    if (code != TRADE_DONE) return code;
    v->time = timing_compare(a->d.turn[0], a->d.turn[1], a->d.turns);
    v->ms = timing_median(a->d.ms[1], a->d.runs);
    return TRADE_DONE;
}

/* Side 0 becomes this config. */
static int set_rival(ablation *a, const hbil_config *config)
{
    image images[OUTS];
    int   k, ok;

    lit_close(&a->side[0]);
    if (!lit_open(&a->side[0], a->device, &a->s, config, &a->sub, a->s.error, sizeof a->s.error)) return TRADE_MISFIT;
    ok = lit_images(&a->side[0], 0, images, a->s.error, sizeof a->s.error); /* fills its history */
    for (k = 0; k < OUTS; k++) image_free(&images[k]);
    return ok ? TRADE_DONE : TRADE_BACKEND;
}

static double bytes_of(const verdict *v) { return v->cost.bytes_read + v->cost.bytes_written; }

/* Has no output lost more than the tolerance against another config? */
static int is_as_good(const ablation *a, const verdict *v, const verdict *as, double tolerance)
{
    int k;

    for (k = 0; k < OUTS; k++) {
        const double other = error_of(a, &as->out[k]), now = error_of(a, &v->out[k]);

        if (isfinite(other) && !(now <= other * (1.0 + tolerance) + SLACK)) return 0;
    }
    return 1;
}

/* Faster; or as fast, with less to read and write; or, without an option, as fast and as good. */
static int is_smaller(const ablation *a, const verdict *v, const verdict *than, const feature *f)
{
    const double saved = than->cost.fetches + bytes_of(than) - v->cost.fetches - bytes_of(v);

    if (!v->time.within_noise) return v->time.median < 1.0;
    return saved > 0.0 || (saved >= 0.0 && !f->compat && is_as_good(a, v, than, 0.0));
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

/* Columns, and the full config's row. */
static void print_head(const ablation *a)
{
    const verdict *f = &a->full;
    int            k;

    printf("| without | ms | fetches | bytes |");
    for (k = 0; k < OUTS; k++)
        if (f->out[k].present)
            printf(" rmse %s, %s |", out_names[k],
                   error_of(a, &f->out[k]) == f->out[k].rmse_model ? "scene" : "height field");
    printf("\n|---|---|---:|---:|");
    for (k = 0; k < OUTS; k++) fputs(f->out[k].present ? "---:|" : "", stdout);
    printf("\n| (full) | %.3f | %.1f | %.1f |", f->ms, f->cost.fetches, bytes_of(f));
    for (k = 0; k < OUTS; k++)
        if (f->out[k].present) printf(" %.4f |", error_of(a, &f->out[k]));
    putchar('\n');
}

/* Differences from the full config. */
static void print_row(const ablation *a, const char *name, const char *to, const verdict *v)
{
    char words[96];
    int  k;

    duel_words(&v->time, words, sizeof words);
    printf("| %s: `%s` | %s | %+.1f | %+.1f |", name, to, words, v->cost.fetches - a->full.cost.fetches,
           bytes_of(v) - bytes_of(&a->full));
    for (k = 0; k < OUTS; k++)
        if (a->full.out[k].present)
            printf(" %+.1f %% |", 100.0 * (error_of(a, &v->out[k]) / error_of(a, &a->full.out[k]) - 1.0));
    putchar('\n');
    fflush(stdout);
}

static const char *to_of(const feature *f)
{
    if (f->to) return f->to;
    return f->compat == HBIL_SEED_COMPAT_SLICE_MEAN ? "seed_compat=slice_mean" : "seed_compat=screen_azimuth";
}

static void print_unused(const ablation *a)
{
    int i, first = 1;

    for (i = 0; i < FEATURES; i++) {
        if (a->used[i]) continue;
        printf("%s%s", first ? "\nnot in the config, or not to be done without: " : ", ", features[i].name);
        first = 0;
    }
    puts(first ? "" : ".");
}

/* ---- work -------------------------------------------------------------------------------------------------------- */

/* The full config against itself, then each feature away. */
static int drop_each(ablation *a)
{
    hbil_config c;
    char        text[TEXT_MAX];
    int         i, code = set_rival(a, &a->full.config);

    if (code == TRADE_DONE) code = judge(a, &a->full.config, &a->full);
    if (code != TRADE_DONE) return code;
    config_text(&a->full.config, ' ', text);
    printf("### %s, %dx%d\n\nfull: `%s`\n\n", a->sub.name, subject_judged(&a->sub)->width,
           subject_judged(&a->sub)->height, text);
    print_head(a);
    for (i = 0; code == TRADE_DONE && i < FEATURES; i++) {
        a->used[i] = drop(&a->full.config, &features[i], &c);
        if (!a->used[i]) continue;
        progress_show(&a->s, 0.5 * i / FEATURES, features[i].name);
        code = judge(a, &c, &a->without[i]);
        if (code == TRADE_DONE) print_row(a, features[i].name, to_of(&features[i]), &a->without[i]);
    }
    return code;
}

static const ablation *sorting; /* for qsort, whose callback carries no pointer */

/* What only does harm on this scene comes first: with it, every later loss would look small. Then the dearest. */
static int by_saving(const void *x, const void *y)
{
    const verdict *v = &sorting->without[*(const int *)x], *w = &sorting->without[*(const int *)y];
    const int      harm = is_as_good(sorting, w, &sorting->full, 0.0) - is_as_good(sorting, v, &sorting->full, 0.0);

    return harm ? harm : (v->time.median > w->time.median) - (v->time.median < w->time.median);
}

/* The least errors so far: what is held against them cannot use up what an earlier drop has gained. */
static void keep_least(const ablation *a, verdict *least, const verdict *v)
{
    int k;

    for (k = 0; k < OUTS; k++)
        if (error_of(a, &v->out[k]) < error_of(a, &least->out[k])) least->out[k] = v->out[k];
}

/* Drops one feature after the other; each is tried once against the config that is left by then. */
static int drop_greedily(ablation *a, verdict *best)
{
    int         order[FEATURES], count = 0, i, code = TRADE_DONE;
    hbil_config c;
    verdict     v, least = a->full;

    *best = a->full;
    for (i = 0; i < FEATURES; i++)
        if (a->used[i]) order[count++] = i;
    sorting = a;
    if (count) qsort(order, (size_t)count, sizeof *order, by_saving);
    for (i = 0; code == TRADE_DONE && i < count; i++) {
        if (!drop(&best->config, &features[order[i]], &c)) continue;
        progress_show(&a->s, 0.5 + 0.5 * i / count, features[order[i]].name);
        code = judge(a, &c, &v);
        if (code != TRADE_DONE || !is_as_good(a, &v, &least, a->tolerance)
            || !is_smaller(a, &v, best, &features[order[i]])) continue;
        *best = v;
        keep_least(a, &least, &v);
        printf("- without %s\n", features[order[i]].name);
        code = set_rival(a, &best->config);
    }
    return code;
}

/* The smallest config against the full one. */
static int print_smallest(ablation *a, verdict *best)
{
    char text[TEXT_MAX];
    int  code = set_rival(a, &a->full.config);

    if (code == TRADE_DONE) code = judge(a, &best->config, best);
    if (code != TRADE_DONE) return code;
    config_text(&best->config, ' ', text);
    printf("\nsmallest within %.0f %% of the least errors on the way:\n\n", 100.0 * a->tolerance);
    print_head(a);
    print_row(a, "all of these", text, best);
    config_text(&best->config, ',', text);
    printf("\n    shadergen%s%s\n\n", *text ? " --set " : "", text);
    return TRADE_DONE;
}

static int run_subject(ablation *a)
{
    verdict best;
    int     code;

    if (!config_make(&a->s, a->text, 1, subject_judged(&a->sub), &a->full.config, a->s.error, sizeof a->s.error))
        return TRADE_REFUSED;
    code = truth_make(&a->s, &a->sub, (a->full.config.outputs & HBIL_OUTPUTS_FAR) != 0, &a->t);
    if (code != TRADE_DONE) return code;
    code = drop_each(a);
    if (code == TRADE_DONE) {
        print_unused(a);
        printf("\ndropped where the error allows it, first what only does harm, then the dearest:\n\n");
        code = drop_greedily(a, &best);
    }
    if (code == TRADE_DONE) code = print_smallest(a, &best);
    progress_end(&a->s);
    lit_close(&a->side[0]);
    lit_close(&a->side[1]);
    truth_free(&a->t);
    return code;
}

static int run(ablation *a)
{
    static subject_list list;
    int                 i, code;

    code = subject_find(&a->s, &list);
    if (code != TRADE_DONE) return code;
    a->device = runner_open(a->s.backend, 0, a->s.error, sizeof a->s.error);
    if (!a->device) return TRADE_BACKEND;
    printf("%s: %s\n\n", runner_about(a->device)->backend, runner_about(a->device)->device);
    for (i = 0; code == TRADE_DONE && i < list.count; i++) {
        code = subject_load(&a->s, &list.items[i], &a->sub);
        if (code != TRADE_DONE) break;
        code = run_subject(a);
        subject_free(&a->sub);
    }
    return code;
}

int ablate_main(int argc, char **argv)
{
    static ablation a;
    int             code;

    settings_default(&a.s);
    a.s.repeat = 9;
    a.tolerance = 0.05;
    a.against = "model";
    if (command_line(&a.s, argc, argv, ablate_help, take, &a, &code)) {
        if (!a.text) a.text = FULL;
        code = run(&a);
        if (code != TRADE_DONE) command_fail(&a.s, code);
    }
    runner_close(a.device);
    settings_free(&a.s);
    return code;
}
