/* command.c - what the subcommands have in common: their command lines, and two configs in turns. */
#include "commands.h"

#include <stdio.h>
#include <string.h>

int command_fail(const settings *s, int code)
{
    fprintf(stderr, "hbil-tradeoff: %s\n", s->error);
    return code;
}

int command_line(settings *s, int argc, char **argv, void (*help)(void),
                 int (*take)(void *user, settings *s, const char *name, const char *value), void *user, int *code)
{
    int i, taken;

    *code = TRADE_USAGE;
    for (i = 0; i < argc; i++) {
        const char *value = i + 1 < argc && strncmp(argv[i + 1], "--", 2) != 0 ? argv[i + 1] : "";

        if (strcmp(argv[i], "--help") == 0) {
            fputs("usage: hbil-tradeoff\n", stdout);
            help();
            fputs("\nframes and runs:\n", stdout);
            settings_help();
            *code = TRADE_DONE;
            return 0;
        }
        if (strcmp(argv[i], "-q") == 0) {
            s->quiet = 1;
            continue;
        }
        if (argv[i][0] != '-') taken = take(user, s, "", argv[i]);
        else {
            taken = settings_argument(s, argv[i], value);
            if (taken < 0) taken = take(user, s, argv[i], value);
        }
        if (taken < 0) frame_error(s->error, sizeof s->error, "%s: unknown; hbil-tradeoff --help lists all", argv[i]);
        if (taken <= 0) return command_fail(s, 0);
        i += argv[i][0] == '-'; /* its value */
    }
    *code = settings_finish(s);
    if (*code != TRADE_DONE) command_fail(s, *code);
    return *code == TRADE_DONE;
}

/* Compiles, fills the history, and runs a block. */
static int take_turn(settings *s, timing_run *run, void *user, duel *d, int side)
{
    double *ms = d->ms[side] + d->runs, first[2];

    if (!run(user, 2, first, s->error, sizeof s->error) || !run(user, DUEL_BLOCK, ms, s->error, sizeof s->error))
        return 0;
    d->turn[side][d->turns] = timing_median(ms, DUEL_BLOCK);
    return 1;
}

int duel_run(settings *s, lit *a, lit *b, duel *d) { return duel_turns(s, lit_run, a, b, d); }

int duel_turns(settings *s, timing_run *run, void *a, void *b, duel *d)
{
    double begun, ms;
    int    stable[2];

    d->runs = d->turns = 0;
    if (!timing_warm(run, a, 0.25 * s->seconds, &ms, &stable[0], s->error, sizeof s->error)
        || !timing_warm(run, b, 0.25 * s->seconds, &ms, &stable[1], s->error, sizeof s->error))
        return TRADE_BACKEND;
    d->stable = stable[0] && stable[1];
    begun = seconds_now();
    for (; d->turns < s->repeat && d->runs + DUEL_BLOCK <= TIMING_RUNS_MAX; d->turns++, d->runs += DUEL_BLOCK) {
        if (d->turns >= 3 && seconds_now() - begun > s->seconds) break;
        if (!take_turn(s, run, a, d, 0) || !take_turn(s, run, b, d, 1)) return TRADE_BACKEND;
    }
    return TRADE_DONE;
}

void duel_words(const timing_ratio *r, char *out, size_t size)
{
    const double low = 100.0 * (r->range.low - 1.0), high = 100.0 * (r->range.high - 1.0);

    snprintf(out, size, "%+.1f %% [%+.1f, %+.1f]%s", 100.0 * (r->median - 1.0), low, high,
             r->within_noise ? ", within noise" : "");
}
