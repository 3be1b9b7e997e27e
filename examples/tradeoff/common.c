/* common.c - command line, configs and progress of hbil-tradeoff. */
#include "common.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "csv.h"
#include "runner.h"

const char *const out_names[OUTS] = CSV_OUTPUT_NAMES;

/* ---- command line ------------------------------------------------------------------------------------------------ */

int read_int(const char *text, int min, int max, int *out)
{
    char *end;
    long  value = strtol(text, &end, 10);

    if (end == text || *end || value < min || value > max) return 0;
    *out = (int)value;
    return 1;
}

int read_double(const char *text, double min, double max, double *out)
{
    char  *end;
    double value = strtod(text, &end);

    if (end == text || *end || !(value >= min && value <= max)) return 0;
    *out = value;
    return 1;
}

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *p = data;
    size_t               i;

    for (i = 0; i < size; i++) hash = (hash ^ p[i]) * 1099511628211u;
    return hash;
}

/* "AxB" or "AxBxC" into out[count]. */
static int read_sizes(const char *text, int count, int max, int *out)
{
    char part[16];
    int  i;

    for (i = 0; i < count; i++) {
        const size_t length = strcspn(text, "x");

        if (length >= sizeof part || (text[length] == 0) != (i + 1 == count)) return 0;
        memcpy(part, text, length);
        part[length] = 0;
        if (!read_int(part, 1, max, out + i)) return 0;
        text += length + 1;
    }
    return 1;
}

void settings_default(settings *s)
{
    memset(s, 0, sizeof *s);
    s->backend = "vulkan";
    s->env = "sky";
    s->width = 640;
    s->height = 360;
    s->rays = 128;
    s->repeat = 9;
    s->seconds = 10.0;
    s->converged.slices = 16;
    s->converged.steps = 256;
    s->converged.frames = 2;
}

void settings_help(void)
{
    int i;

    fputs(
        "  --frames DIR      a folder with frame-NNN.exr and camera-NNN.json, or a folder of such folders; several\n"
        "                    numbers in a folder are a sequence, judged at its last frame. hf-NNN.exr is read, too\n"
        "  --scene A,B       built-in scenes: ",
        stdout);
    for (i = 0; capture_scene_name(i); i++) printf("%s%s", i ? ", " : "", capture_scene_name(i));
    fputs(
        "\n  --size WxH        their size, default 640x360\n"
        "  --rays N          their rays per pixel for the truth, default 128\n"
        "  --backend B       vulkan (default), gl or gles\n"
        "  --set A=B,C=D     options for every config\n"
        "  --env E           light behind what is visible, as hbil-frame has it, default sky;\n"
        "                    environment=constant gets its mean\n"
        "  --repeat N        timed runs of a config, default 9; pair and ablate: turns of three runs of each,\n"
        "                    default 15 and 9\n"
        "  --seconds S       but no more than fit into S seconds, default 10; at least 3, or 1 run where it\n"
        "                    takes longer than that\n"
        "  --converged LxTxF the converged estimator: slices, steps, frames of noise; default 16x256x2\n"
        "  --cache DIR       where truths are kept, default $XDG_CACHE_HOME/hbil-tradeoff or ~/.cache/hbil-tradeoff\n"
        "  -q                no progress\n",
        stdout);
}

static int number_argument(settings *s, const char *name, const char *value)
{
    if (strcmp(name, "--size") == 0) {
        int size[2];

        if (!read_sizes(value, 2, 16384, size))
            return frame_error(s->error, sizeof s->error, "--size %s: must be WxH, each in [1, 16384], as in 640x360",
                               value);
        s->width = size[0];
        s->height = size[1];
        return 1;
    }
    if (strcmp(name, "--converged") == 0) {
        int n[3];

        if (!read_sizes(value, 3, 1024, n) || n[0] > 64)
            return frame_error(s->error, sizeof s->error,
                               "--converged %s: must be slices x steps x frames in [1, 64], [1, 1024], "
                               "[1, 1024], as in 16x256x2",
                               value);
        s->converged.slices = n[0];
        s->converged.steps = n[1];
        s->converged.frames = n[2];
        return 1;
    }
    if (strcmp(name, "--rays") == 0)
        return read_int(value, 0, 65536, &s->rays)
            || frame_error(s->error, sizeof s->error, "--rays %s: must be a whole number in [0, 65536]", value);
    if (strcmp(name, "--repeat") == 0)
        return read_int(value, 3, 1000, &s->repeat)
            || frame_error(s->error, sizeof s->error, "--repeat %s: must be a whole number in [3, 1000]", value);
    if (strcmp(name, "--seconds") == 0)
        return read_double(value, 0.0, 3600.0, &s->seconds)
            || frame_error(s->error, sizeof s->error, "--seconds %s: must be a number in [0, 3600]", value);
    return -1;
}

int settings_argument(settings *s, const char *name, const char *value)
{
    const struct { const char *name, **target; } texts[] = {
        {"--frames", &s->frames}, {"--scene", &s->scenes}, {"--backend", &s->backend},
        {"--env", &s->env},       {"--cache", &s->cache},
    };
    size_t i;

    for (i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        if (!*value) return frame_error(s->error, sizeof s->error, "%s: without its value", name);
        *texts[i].target = value;
        return 1;
    }
    if (strcmp(name, "--set") == 0) {
        if (!*value)
            return frame_error(s->error, sizeof s->error, "--set: without options, as in --set outputs=ao,steps=4");
        if (s->set_count == SETS_MAX)
            return frame_error(s->error, sizeof s->error, "--set: more than %d. Join some with commas", SETS_MAX);
        s->sets[s->set_count++] = value;
        return 1;
    }
    return number_argument(s, name, value);
}

/* The mean radiance over all directions, on a Fibonacci sphere: exact enough for a constant. */
static void flatten(settings *s)
{
    enum { DIRECTIONS = 2048 };
    double sum[3] = {0.0, 0.0, 0.0}, rgb[3];
    int    i, c;

    for (i = 0; i < DIRECTIONS; i++) {
        const double z = 1.0 - (2.0 * i + 1.0) / DIRECTIONS, a = i * 2.399963229728653, r = sqrt(1.0 - z * z);
        const double direction[3] = {r * cos(a), r * sin(a), z};

        environment_radiance(&s->light, direction, rgb);
        for (c = 0; c < 3; c++) sum[c] += rgb[c] / DIRECTIONS;
    }
    s->flat.kind = HBIL_ENVIRONMENT_CONSTANT;
    for (c = 0; c < 3; c++) s->flat.color[c] = (float)sum[c];
}

/* The folders of a path, as mkdir -p. */
static int make_folders(const char *path)
{
    char        part[1024];
    size_t      i;
    struct stat info;

    for (i = 1; path[i - 1]; i++) {
        if (path[i] != '/' && path[i] != 0) continue;
        snprintf(part, sizeof part, "%.*s", (int)i, path);
        if (mkdir(part, 0777) != 0 && (stat(part, &info) != 0 || !S_ISDIR(info.st_mode))) return 0;
    }
    return 1;
}

static int make_cache(settings *s)
{
    const char *xdg = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
    int         length;

    if (s->cache) length = snprintf(s->cache_path, sizeof s->cache_path, "%s", s->cache);
    else if (xdg && *xdg) length = snprintf(s->cache_path, sizeof s->cache_path, "%s/hbil-tradeoff", xdg);
    else length = snprintf(s->cache_path, sizeof s->cache_path, "%s/.cache/hbil-tradeoff", home ? home : ".");
    if (length < (int)sizeof s->cache_path && make_folders(s->cache_path) && access(s->cache_path, W_OK) == 0)
        return TRADE_DONE;
    frame_error(s->error, sizeof s->error, "%.200s: cannot be made or written. Choose another folder with --cache",
                s->cache_path);
    return TRADE_FILES;
}

int settings_finish(settings *s)
{
    if (!s->frames && !s->scenes) {
        frame_error(s->error, sizeof s->error, "no frame to light: add --frames DIR or --scene NAME");
        return TRADE_USAGE;
    }
    if (!runner_target(s->backend)) {
        frame_error(s->error, sizeof s->error, "--backend %s: must be vulkan, gl or gles", s->backend);
        return TRADE_USAGE;
    }
    if (!environment_parse(&s->light, s->env, s->error, sizeof s->error))
        return s->light.misuse ? TRADE_USAGE : TRADE_FILES;
    flatten(s);
    return make_cache(s);
}

void settings_free(settings *s) { environment_free(&s->light); }

/* ---- configs ----------------------------------------------------------------------------------------------------- */

/* The first error, not a note. */
static int refuse(const hbil_diags *diags, const char *text, char *error, size_t error_size)
{
    int i = 0;

    while (i < diags->count && i < diags->capacity && diags->items[i].severity != HBIL_ERROR) i++;
    return frame_error(error, error_size, "%s: %s", text,
                       i < diags->count && i < diags->capacity ? diags->items[i].text : "refused");
}

/* Preset and options of `text`, then every --set. */
static int parse(const settings *s, const char *text, hbil_config *c, char *error, size_t error_size)
{
    hbil_diag   items[16];
    hbil_diags  diags = {items, 16, 0};
    const char *options = text, *name = NULL;
    char        preset[64] = "";
    int         i;

    if (strncmp(text, "preset=", 7) == 0) name = text + 7;
    else if (*text && !strchr(text, '=')) name = text;
    memset(c, 0, sizeof *c);
    if (name) {
        options = name + strcspn(name, " ,\n");
        snprintf(preset, sizeof preset, "%.*s", (int)(options - name), name);
        if (strcmp(preset, "none") != 0 && hbil_config_preset(preset, c, &diags) != HBIL_OK)
            return refuse(&diags, text, error, error_size);
    }
    if (hbil_config_parse(c, options, strlen(options), &diags) != HBIL_OK)
        return refuse(&diags, text, error, error_size);
    for (i = 0; i < s->set_count; i++)
        if (hbil_config_parse(c, s->sets[i], strlen(s->sets[i]), &diags) != HBIL_OK)
            return refuse(&diags, s->sets[i], error, error_size);
    return 1;
}

/* Does the text of a config, or a --set, name the outputs? */
static int names_outputs(const settings *s, const char *text)
{
    int i, found = strstr(text, "outputs=") != NULL;

    for (i = 0; i < s->set_count; i++) found |= strstr(s->sets[i], "outputs=") != NULL;
    return found;
}

int config_make(const settings *s, const char *text, int far, const capture *cap, hbil_config *out, char *error,
                size_t error_size)
{
    hbil_diag   items[32];
    hbil_diags  diags = {items, 32, 0};
    hbil_config c;
    int         cosine;

    if (!parse(s, text, &c, error, error_size)) return 0;
    cosine = c.estimator == 0 || c.estimator == HBIL_ESTIMATOR_HORIZON || c.estimator == HBIL_ESTIMATOR_BITMASK;
    c.target = runner_target(s->backend);
    c.projection = cap->orthographic ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    if (!cap->f0.data) c.f0 = HBIL_F0_NONE;
    if (!names_outputs(s, text)) {
        c.outputs = HBIL_OUTPUTS_AO | (cosine ? HBIL_OUTPUTS_NEAR : 0u) | (far ? HBIL_OUTPUTS_FAR : 0u);
        if (far && c.environment == 0) c.environment = s->light.kind;
        if (far && !cosine) c.far_visibility = HBIL_FAR_VISIBILITY_AO;
    }
    if (hbil_config_resolve(&c, out, &diags) != HBIL_OK) return refuse(&diags, text, error, error_size);
    return config_light(s, out, error, error_size) != NULL;
}

const environment *config_light(const settings *s, const hbil_config *config, char *error, size_t error_size)
{
    if (config->environment == HBIL_ENVIRONMENT_CONSTANT) return &s->flat;
    if (config->environment == HBIL_ENVIRONMENT_NONE || config->environment == s->light.kind) return &s->light;
    frame_error(error, error_size, "the config's environment is of another kind than --env %s. Choose one that fits",
                s->env);
    return NULL;
}

void config_text(const hbil_config *config, char separator, char text[TEXT_MAX])
{
    hbil_config c = *config;
    char       *blank;

    c.target = 0; /* those of backend and frame */
    c.projection = 0;
    if (hbil_config_print(&c, 0, text, TEXT_MAX, NULL) != HBIL_OK) text[0] = 0;
    for (blank = text; (blank = strchr(blank, ' ')) != NULL; blank++) *blank = separator;
}

const char *config_preset_of(const settings *s, const hbil_config *config, int far, const capture *cap)
{
    const uint64_t hash = hbil_config_hash(config);
    const char    *name;
    hbil_config    other;
    char           error[ERROR_MAX];
    int32_t        i;

    for (i = 0; (name = hbil_preset_name(i)) != NULL; i++)
        if (config_make(s, name, far, cap, &other, error, sizeof error) && hbil_config_hash(&other) == hash)
            return name;
    return "";
}

/* ---- progress ---------------------------------------------------------------------------------------------------- */

/* Of the only line on stderr. from: what was done when it began. */
static struct { double begun, from, shown; } progress;

double seconds_now(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_show(const settings *s, double done, const char *what)
{
    enum { WIDTH = 24 };
    const int    tty = isatty(STDERR_FILENO);
    const double now = seconds_now();
    const int    filled = (int)(done * WIDTH);
    char         left[32] = "";
    int          i;

    if (progress.begun <= 0.0) {
        progress.begun = progress.shown = now;
        progress.from = done;
    }
    if (s->quiet || now - progress.shown < (tty ? 0.2 : 2.0)) return;
    progress.shown = now;
    if (done > progress.from)
        snprintf(left, sizeof left, ", %.0f s left", (now - progress.begun) * (1.0 - done) / (done - progress.from));
    fputs(tty ? "\r\033[K[" : "[", stderr);
    for (i = 0; i < WIDTH; i++) fputc(i < filled ? '#' : '.', stderr);
    fprintf(stderr, "] %3.0f %%%s  %.60s%s", 100.0 * done, left, what, tty ? "" : "\n");
}

void progress_end(const settings *s)
{
    if (!s->quiet && isatty(STDERR_FILENO) && progress.shown > progress.begun) fputs("\r\033[K", stderr);
    progress.begun = 0.0;
}
