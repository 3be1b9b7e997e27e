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

int duel_run(settings *s, duel *d)
{
    double warm[2], begun;
    int    side, stable;

    d->stable = 1;
    for (side = 0; side < 2; side++) {
        if (!timing_warm(lit_run, &d->side[side], 0.25 * s->seconds, &warm[side], &stable, s->error, sizeof s->error))
            return TRADE_BACKEND;
        d->stable &= stable;
    }
    begun = seconds_now();
    for (d->runs = 0; d->runs < s->repeat && (d->runs < 3 || seconds_now() - begun < s->seconds); d->runs++)
        for (side = 0; side < 2; side++)
            if (!lit_run(&d->side[side], 1, &d->ms[side][d->runs], s->error, sizeof s->error)) return TRADE_BACKEND;
    return TRADE_DONE;
}

void duel_words(const timing_ratio *r, char *out, size_t size)
{
    const double low = 100.0 * (r->range.low - 1.0), high = 100.0 * (r->range.high - 1.0);

    snprintf(out, size, "%+.1f %% [%+.1f, %+.1f]%s", 100.0 * (r->median - 1.0), low, high, r->within_noise ? ", within noise" : "");
}
