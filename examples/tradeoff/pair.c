/* pair.c - hbil-tradeoff pair: two configs, or externals, in turns, and whether their difference says anything. */
#include "commands.h"
#include "csv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct pair {
    settings    s;
    const char *text[2];
    int         count;
    externals   own;
    runner     *device;
} pair;

void pair_help(void)
{
    fputs(
        "  pair    A B frames\n"
        "          two configs, each a preset's name or \"[preset=NAME] option=value ...\", in turns A B A B of three\n"
        "          runs. Tells medians, the interval (99 %, bootstrap) of their ratio, whether it is within noise\n"
        "  --external E      as in sweep: A or B can be external:NAME\n",
        stdout);
}

static int take(void *user, settings *s, const char *name, const char *value)
{
    pair *p = user;

    if (strcmp(name, "--external") == 0) return externals_add(&p->own, s, value);
    if (*name) return -1;
    if (p->count == 2) return frame_error(s->error, sizeof s->error, "%s: a third config; pair compares two", value);
    p->text[p->count++] = value;
    return 1;
}

static void print_side(const pair *p, int side, const lit *l, const times *t, const price *cost)
{
    char text[TEXT_MAX];

    config_text(&l->plan.config, ' ', text);
    printf("%c  %s\n   %s\n", "AB"[side], p->text[side], l->own ? l->own->text : *text ? text : "defaults");
    printf("   %.3f ms [%.3f, %.3f]; ", t->median, t->range.low, t->range.high);
    if (isnan(cost->fetches)) puts("costs unknown: loops of unknown length. Compile it with -Os");
    else
        printf("per pixel %.1f fetches, %.1f bytes read, %.1f written; %.0f registers\n", cost->fetches,
               cost->bytes_read, cost->bytes_written, cost->registers);
}

static void print_errors(const errors a[OUTS], const errors b[OUTS])
{
    int k;

    printf("%-8s %9s %9s %9s %9s %9s %9s\n", "rmse", "model A", "B", "field A", "B", "sampl. A", "B");
    for (k = 0; k < OUTS; k++)
        if (a[k].present || b[k].present) {
            const double values[] = {a[k].rmse_model, b[k].rmse_model,    a[k].rmse_field,
                                     b[k].rmse_field, a[k].rmse_sampling, b[k].rmse_sampling};
            size_t       i;

            printf("%-8s", out_names[k]);
            for (i = 0; i < sizeof values / sizeof *values; i++)
                printf(isfinite(values[i]) ? " %9.4f" : "         -", values[i]);
            putchar('\n');
        }
}

/* Errors of one side; its images come before the times. */
static int judge(pair *p, lit *l, const truth *t, errors out[OUTS])
{
    const hbil_config *config = &l->plan.config;
    image              converged[OUTS];
    int                k, code;

    if (l->own) return measure_errors(&p->s, l, t, config, NULL, 0, out);
    code = truth_converged(&p->s, p->device, l->sub, config, converged);
    if (code == TRADE_DONE) code = measure_errors(&p->s, l, t, config, converged, 0, out);
    for (k = 0; k < OUTS; k++) image_free(&converged[k]);
    return code;
}

static void print_times(const pair *p, const duel *d, const lit sides[2], const price cost[2])
{
    static times t;
    timing_ratio ratio = timing_compare(d->turn[0], d->turn[1], d->turns);
    char         words[96];
    int          side;

    for (side = 0; side < 2; side++) {
        memcpy(t.ms, d->ms[side], (size_t)d->runs * sizeof *t.ms);
        t.runs = d->runs;
        times_sum_up(&t);
        print_side(p, side, &sides[side], &t, &cost[side]);
    }
    duel_words(&ratio, words, sizeof words);
    printf("time of B against A: %s; %d turns of %d runs each%s\n", words, d->turns, DUEL_BLOCK,
           d->stable ? "" : "; the warm-up found no rest");
}

/* Opens both sides; *opened: how many of them. An exit code. */
static int open_sides(pair *p, const subject *sub, lit sides[2], int *opened)
{
    settings   *s = &p->s;
    hbil_config config;

    for (*opened = 0; *opened < 2; ++*opened) {
        const char     *text = p->text[*opened];
        const external *own = externals_find(&p->own, text);
        lit            *l = &sides[*opened];

        if (!own && strncmp(text, CSV_EXTERNAL, strlen(CSV_EXTERNAL)) == 0) {
            frame_error(s->error, sizeof s->error, "%s: no --external has this name", text);
            return TRADE_USAGE;
        }
        if (!own && !config_make(s, text, 0, subject_judged(sub), &config, s->error, sizeof s->error))
            return TRADE_REFUSED;
        if (!(own ? lit_open_external(l, p->device, s, own, sub, s->error, sizeof s->error)
                  : lit_open(l, p->device, s, &config, sub, s->error, sizeof s->error)))
            return TRADE_MISFIT;
    }
    return TRADE_DONE;
}

static int run_subject(pair *p, const subject *sub)
{
    static duel d;
    static lit  sides[2];
    errors      out[2][OUTS];
    price       cost[2];
    truth       t;
    int         side, opened, code = open_sides(p, sub, sides, &opened);
    unsigned    outputs = 0;

    memset(&t, 0, sizeof t);
    for (side = 0; side < opened; side++) outputs |= sides[side].plan.config.outputs;
    if (code == TRADE_DONE) code = truth_make(&p->s, sub, (outputs & HBIL_OUTPUTS_FAR) != 0, &t);
    for (side = 0; code == TRADE_DONE && side < 2; side++) {
        code = judge(p, &sides[side], &t, out[side]);
        if (code == TRADE_DONE) code = measure_cost(&p->s, &sides[side], &cost[side]);
    }
    if (code == TRADE_DONE) code = duel_run(&p->s, &sides[0], &sides[1], &d);
    if (code == TRADE_DONE) {
        printf("%s, %dx%d\n", sub->name, subject_judged(sub)->width, subject_judged(sub)->height);
        print_times(p, &d, sides, cost);
        print_errors(out[0], out[1]);
    }
    while (opened > 0) lit_close(&sides[--opened]);
    truth_free(&t);
    return code;
}

static int run(pair *p)
{
    static subject_list list;
    subject             sub;
    int                 i, code;

    if (p->count < 2) {
        frame_error(p->s.error, sizeof p->s.error, "pair wants two configs, as in: pair fast balanced --scene cornell");
        return TRADE_USAGE;
    }
    code = externals_open(&p->own, &p->s);
    if (code == TRADE_DONE) code = subject_find(&p->s, &list);
    if (code != TRADE_DONE) return code;
    p->device = runner_open(p->s.backend, 0, p->s.error, sizeof p->s.error);
    if (!p->device) return TRADE_BACKEND;
    printf("%s: %s, %s\n", runner_about(p->device)->backend, runner_about(p->device)->device,
           runner_about(p->device)->timing);
    for (i = 0; code == TRADE_DONE && i < list.count; i++) {
        code = subject_load(&p->s, &list.items[i], &sub);
        if (code == TRADE_DONE) code = run_subject(p, &sub);
        if (code == TRADE_DONE) subject_free(&sub);
    }
    return code;
}

int pair_main(int argc, char **argv)
{
    static pair p;
    int         code;

    settings_default(&p.s);
    p.s.repeat = 15;
    if (command_line(&p.s, argc, argv, pair_help, take, &p, &code)) {
        code = run(&p);
        if (code != TRADE_DONE) command_fail(&p.s, code);
    }
    runner_close(p.device);
    settings_free(&p.s);
    externals_free(&p.own);
    return code;
}
