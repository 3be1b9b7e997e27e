/* common.h - what the subcommands of hbil-tradeoff share: exit codes, command line, configs, progress. */
#ifndef HBIL_TRADEOFF_COMMON_H
#define HBIL_TRADEOFF_COMMON_H

#include "../../hbil.h"
#include "capture.h"
#include "environment.h"

enum { TRADE_DONE = 0, TRADE_REFUSED = 1, TRADE_USAGE = 2, TRADE_FILES = 3, TRADE_MISFIT = 4, TRADE_BACKEND = 5 };

/* The outputs that have a truth. */
enum { OUT_AO, OUT_NEAR, OUT_FAR, OUTS };
extern const char *const out_names[OUTS];

#define SETS_MAX  16
#define TEXT_MAX  1024 /* bytes of a config as text */
#define ERROR_MAX 1024

/* How the converged estimator is made. */
typedef struct effort { int slices, steps, frames; } effort;

/* What a command line says to every subcommand. Zero, then settings_default. */
typedef struct settings {
    const char *frames, *scenes, *backend, *env, *cache;
    const char *sets[SETS_MAX];     /* --set, for all configs */
    int         set_count;
    int         width, height, rays; /* of built-in scenes */
    int         repeat, quiet;
    double      seconds;            /* at most, for the timed runs of one config */
    effort      converged;
    environment light;              /* of env */
    environment flat;               /* its mean over all directions, for environment=constant */
    char        cache_path[1024];
    char        error[ERROR_MAX];
} settings;

void settings_default(settings *s);
/* One option with its value. 1: taken; 0: s->error says what is wrong; -1: not one of these. */
int  settings_argument(settings *s, const char *name, const char *value);
/* After the command line: environment, cache folder, contradictions. An exit code; s->error says why. */
int  settings_finish(settings *s);
void settings_free(settings *s);
void settings_help(void);

/* A config from text: options, in front of them preset=NAME, or a preset's name alone. `--set` comes on top. Filled in:
 * target, projection of the capture, f0=none where it has none, and outputs where nobody says: ao and near light, as
 * far as the estimator has them, with far != 0 far light under the environment, too. out is resolved. 0: error[] says
 * why it is refused. */
int config_make(const settings *s, const char *text, int far, const capture *cap, hbil_config *out, char *error,
                size_t error_size);
/* The environment that the config reads; NULL: it was not given, and error[] says so. */
const environment *config_light(const settings *s, const hbil_config *config, char *error, size_t error_size);
/* What differs from the defaults, as text for a config or, with commas, for --set. */
void config_text(const hbil_config *config, char separator, char text[TEXT_MAX]);
/* Is it `text` as config_make makes it? The name of the preset that it equals, "" if there is none. */
const char *config_preset_of(const settings *s, const hbil_config *config, int far, const capture *cap);

/* Whole number in [min, max] and nothing behind it. */
int  read_int(const char *text, int min, int max, int *out);
/* The same for a decimal number, '.' as its mark. */
int  read_double(const char *text, double min, double max, double *out);

/* FNV-1a, 64 bits. hash: HASH_BEGIN, or that of what comes before. */
#define HASH_BEGIN 14695981039346656037u
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);

double seconds_now(void);
/* A line on stderr: on a terminal rewritten, in a log every two seconds. done in [0, 1]. */
void progress_show(const settings *s, double done, const char *what);
void progress_end(const settings *s);

#endif
