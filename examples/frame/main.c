/* hbil-frame - light one frame of a renderer, say how long it took and how far it is from the truth. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cJSON.h>

#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#include "capture.h"
#include "environment.h"
#include "metric.h"
#include "output.h"
#include "runner.h"
#include "sequence.h"

enum { DONE = 0, REFUSED = 1, USAGE = 2, FILES = 3, MISFIT = 4, BACKEND = 5 };

#define DIAGS_MAX 32
#define PATH_BYTES 4096
#define HOOK_BYTES_MAX 65536

typedef struct arguments {
    const char  *frame, *camera, *scene, *backend, *preset, *env, *hook, *out, *png, *report;
    const char **sets; /* texts of all --set, in order */
    int          set_count, width, height, rays, repeat, emissive, validate, quiet;
    int          sequence, first, last, cut; /* --frames: 1, and its ends; cut: frame that begins anew, -1: none */
    float        move[3], turn;              /* of the camera from frame to frame: m, degrees */
} arguments;

/* Files of one frame of a sequence, or of the only frame. */
typedef struct files { char frame[PATH_BYTES], camera[PATH_BYTES], out[PATH_BYTES], png[PATH_BYTES]; } files;

typedef struct timing { double min, median, max; } timing; /* ms */

/* Everything of one run of the program. */
typedef struct session {
    arguments   args;
    hbil_config config;
    int         set_environment, set_sh_order; /* 1: a --set says so */
    hbil_plan   plan;
    files       files;
    int         number;                 /* of the frame; 0 without --frames */
    capture     cap;
    capture     last;                   /* camera and size of the frame before; width 0: there is none */
    environment env;                    /* absent: no --env */
    char       *hook;                   /* text of --hook, or NULL */
    hbil_frame  frame;
    image       inputs[HBIL_MAX_TEXTURES];
    runner     *runner;
    image       outputs[OUTPUT_KINDS];  /* absent: not asked for */
    metric      metrics[OUTPUT_KINDS];
    timing      times[HBIL_MAX_PASSES + 1]; /* the last that is used: all passes together */
    cJSON      *frames;                 /* of the report of a sequence */
    char        error[1024];
} session;

static int fail(const session *s, int code)
{
    fprintf(stderr, "hbil-frame: %s\n", s->error);
    return code;
}

/* ---- progress ---------------------------------------------------------------------------------------------------- */

/* State of the progress line. Global, as capture_scene's callback carries no pointer; calls never overlap. */
static struct { const char *what; int off, tty; double begun, shown; } progress;

static double seconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void progress_begin(const char *what, int off)
{
    progress.what = what;
    progress.off = off;
    progress.tty = isatty(STDERR_FILENO);
    progress.begun = seconds();
    progress.shown = progress.begun;
}

/* On a terminal one line, rewritten five times a second; in a log a line every two seconds. */
static void progress_show(double done)
{
    double now = seconds();

    if (progress.off || done >= 1.0 || now - progress.shown < (progress.tty ? 0.2 : 2.0)) return;
    progress.shown = now;
    fprintf(stderr, progress.tty ? "\r%s %3.0f %%" : "%s %3.0f %%\n", progress.what, 100.0 * done);
}

static void progress_end(void)
{
    if (!progress.off && progress.tty && progress.shown > progress.begun) fputs("\r\033[K", stderr);
}

/* ---- command line ------------------------------------------------------------------------------------------------ */

static void print_help(void)
{
    const hbil_option *o;
    int32_t i;

    fputs("usage: hbil-frame (--frame F.exr --camera C.json | --scene NAME) [options]\n"
          "Lights one frame by a config of hbil.h, and reports times and errors.\n\n"
          "  --frame F.exr     layers depth.Z normal.XYZ albedo.RGB direct.RGB; optional emission.RGB, f0.Y or f0.RGB,\n"
          "                    roughness.Y, truth_ao.Y truth_near.RGB truth_far.RGB. With frame-X.exr the height-field truth is\n"
          "                    read, too, if hf-X.exr lies beside it. Or a multilayer EXR of Blender with the passes Z, Normal,\n"
          "                    Diffuse Color and Direct; optional Emission, Vector: see examples/blender\n"
          "  --camera C.json   width, height, near, far, projection_rows (OpenGL clip), view_rows\n"
          "  --scene NAME      a built-in scene instead of a file: ", stdout);
    for (i = 0; capture_scene_name(i); i++) printf("%s%s", i ? ", " : "", capture_scene_name(i));
    fputs("\n  --size WxH        its size in pixels, default 640x360\n"
          "  --rays N          its rays per pixel for the truth, default 64; 0: no truth\n"
          "  --backend B       vulkan (default), gl or gles; with --set stage=fragment gl and gles draw instead of computing\n"
          "  --preset P        where the config begins; default: every option at its default\n"
          "  --set A=B,C=D+E   options of the config; may be repeated. projection and target are taken from frame and backend\n"
          "  --env E           the light behind what is visible, world space; sets environment, and sh_order if --set does not:\n"
          "                      sky                  the sky of the captures, +Z up: what truth_far was made with\n"
          "                      sky:R,G,B,R,G,B      the same with other radiance of ground and zenith\n"
          "                      color:R,G,B          one radiance everywhere\n"
          "                      sh:NUMBERS, sh:FILE  3, 12 or 27 numbers: radiance as rgb of each real, orthonormal spherical\n"
          "                                           harmonic up to order 0, 1 or 2: Y00, Y1-1 Y10 Y11, Y2-2 Y2-1 Y20 Y21 Y22\n"
          "                      CUBE.exr             channels R G B, radiance: six square faces +X -X +Y -Y +Z -Z, side by side\n"
          "                                           or on top of each other, each as GL and Vulkan look it up, row 0 on top.\n"
          "                                           Blurred into E/pi, but for far_visibility=free_bits, which reads radiance\n"
          "                      PROBES.json          {\"size\": [nx,ny,nz], \"origin\": [x,y,z], \"step\": [x,y,z], \"order\": 2,\n"
          "                                           \"coefficients\": [ [ [r,g,b] ... 9 times ] ... per probe, x fastest ]}\n"
          "  --hook H.glsl     your own: text with vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture),\n"
          "                    see hbil_emit_glsl_hook in hbil.h; sets environment=hook\n"
          "  --emissive        emission.RGB bounces, too: it is added to the input radiance\n"
          "  --out O.exr       write the outputs, as far as asked for: ao.Y uniform_ao.Y bent.XYZ cone.XYZA near.RGB\n"
          "                    sh0.RGBA to sh3.RGBA far.RGB irradiance.RGB specular_occlusion.Y multi_bounce.RGB composite.RGB\n"
          "  --png DIR         write before.png, after.png and pictures of each output; DIR is made if need be\n"
          "  --report R.json   write times, errors and the config\n"
          "  --frames A:B      a sequence: frames A to B with what each leaves to the next (temporal=yes, bounces=recursive).\n"
          "                    --frame, --camera and --out then hold one %d or %03d for the number, --png gets a folder for each\n"
          "                    frame. motion.XY in a frame: pixel of the surface in the frame before minus here, +y down;\n"
          "                    without it nothing moves but the camera\n"
          "  --move X,Y,Z      of a scene's camera from frame to frame: m to its right, up and forward\n"
          "  --turn DEGREES    the same: to the left\n"
          "  --cut N           frame N begins anew, as after a camera cut\n"
          "  --repeat N        N timed runs after one that is not timed; default: the first run is timed, compiling included\n"
          "  --validate        with the validation layer (Vulkan) or debug output (GL); a message is a failure\n"
          "  -q                print nothing but warnings and errors\n"
          "  --help, --version\n\n"
          "errors: ao, near and far (with --env sky) against truth_ao, truth_near and truth_far, irradiance against their sum,\n"
          "        with bounces=recursive near against truth_bounce, with f0 all of them times 1 - f0,\n"
          "        composite against direct + albedo * sum; hf: against the height-field truth. uniform_ao is held against\n"
          "        truth_ao for reference: that one is cosine-weighted\n"
          "exit: 0 done; 1 config refused; 2 usage; 3 a file cannot be read or written, or is malformed;\n"
          "      4 frame, camera and config do not fit each other; 5 backend or driver missing or failed\n\n"
          "presets:\n", stdout);
    for (i = 0; hbil_preset_name(i); i++) printf("  %-17s %s\n", hbil_preset_name(i), hbil_preset_meaning(i));
    puts("\noptions for --set:");
    for (i = 0; i < hbil_option_count(); i++) {
        o = hbil_option_at(i);
        if (o->choices[0]) printf("  %-17s %s. {%s}\n", o->name, o->meaning, o->choices);
        else printf("  %-17s %s. [%g, %g] %s, default %g\n", o->name, o->meaning, o->min, o->max, o->unit, o->def);
    }
}

/* Whole number in [min, max] and nothing behind it. */
static int read_int(const char *text, int min, int max, int *out)
{
    char *end;
    long  value = strtol(text, &end, 10);

    if (end == text || *end || value < min || value > max) return 0;
    *out = (int)value;
    return 1;
}

static int read_size(const char *text, int *width, int *height)
{
    char  first[8];
    const char *x = strchr(text, 'x');

    if (!x || x - text >= (int)sizeof first) return 0;
    memcpy(first, text, (size_t)(x - text));
    first[x - text] = 0;
    return read_int(first, 1, 16384, width) && read_int(x + 1, 1, 16384, height);
}

/* So many finite numbers with commas between, and nothing behind them. */
static int read_numbers(const char *text, int count, float *out)
{
    char *end;
    int   i;

    for (i = 0; i < count; i++, text = end + 1) {
        out[i] = strtof(text, &end);
        if (end == text || !(out[i] - out[i] == 0.0f) || *end != (i + 1 < count ? ',' : 0)) return 0;
    }
    return 1;
}

/* One option that takes a value. */
static int read_argument(session *s, const char *name, const char *value)
{
    arguments *a = &s->args;
    const struct { const char *name; const char **target; } texts[] = {
        {"--frame", &a->frame},   {"--camera", &a->camera}, {"--scene", &a->scene}, {"--backend", &a->backend},
        {"--preset", &a->preset}, {"--env", &a->env},       {"--hook", &a->hook},   {"--out", &a->out},
        {"--png", &a->png},       {"--report", &a->report},
    };
    size_t i;

    if (!*value || strncmp(value, "--", 2) == 0)
        return frame_error(s->error, sizeof s->error, "%s: unknown, or without its value; hbil-frame --help lists all", name);
    for (i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (strcmp(name, texts[i].name) != 0) continue;
        *texts[i].target = value;
        return 1;
    }
    if (strcmp(name, "--set") == 0) return a->sets[a->set_count++] = value, 1;
    if (strcmp(name, "--size") == 0)
        return read_size(value, &a->width, &a->height)
            || frame_error(s->error, sizeof s->error, "--size %s: must be WxH, each in [1, 16384], as in 640x360", value);
    if (strcmp(name, "--rays") == 0)
        return read_int(value, 0, 65536, &a->rays)
            || frame_error(s->error, sizeof s->error, "--rays %s: must be a whole number in [0, 65536]", value);
    if (strcmp(name, "--repeat") == 0)
        return read_int(value, 1, 100000, &a->repeat)
            || frame_error(s->error, sizeof s->error, "--repeat %s: must be a whole number in [1, 100000]", value);
    if (strcmp(name, "--frames") == 0)
        return (a->sequence = sequence_range(value, &a->first, &a->last))
            || frame_error(s->error, sizeof s->error, "--frames %s: must be A:B with whole numbers 0 <= A <= B <= 99999, as in 0:11",
                           value);
    if (strcmp(name, "--cut") == 0)
        return read_int(value, 0, 99999, &a->cut)
            || frame_error(s->error, sizeof s->error, "--cut %s: must be a whole number in [0, 99999]", value);
    if (strcmp(name, "--move") == 0)
        return read_numbers(value, 3, a->move)
            || frame_error(s->error, sizeof s->error, "--move %s: must be X,Y,Z in metres, as in 0.1,0,0", value);
    if (strcmp(name, "--turn") == 0)
        return read_numbers(value, 1, &a->turn)
            || frame_error(s->error, sizeof s->error, "--turn %s: must be a number of degrees", value);
    return frame_error(s->error, sizeof s->error, "%s: unknown; hbil-frame --help lists all", name);
}

/* Is there such a scene? Else the message lists them. */
static int check_scene(session *s)
{
    size_t used;
    int    i;

    for (i = 0; capture_scene_name(i); i++)
        if (strcmp(s->args.scene, capture_scene_name(i)) == 0) return 1;
    frame_error(s->error, sizeof s->error, "--scene %s: must be", s->args.scene);
    for (i = 0; capture_scene_name(i); i++) {
        used = strlen(s->error);
        snprintf(s->error + used, sizeof s->error - used, "%s %s", i ? " or" : "", capture_scene_name(i));
    }
    return 0;
}

/* Does what a sequence needs fit? Each of its files has a number. */
static int check_sequence(session *s)
{
    const arguments *a = &s->args;
    const struct { const char *name, *pattern; } patterns[] = {{"--frame", a->frame}, {"--camera", a->camera}, {"--out", a->out}};
    size_t i;

    if (!a->sequence) {
        if (a->cut >= 0 || a->turn != 0.0f || a->move[0] != 0.0f || a->move[1] != 0.0f || a->move[2] != 0.0f)
            return frame_error(s->error, sizeof s->error, "--cut, --move and --turn belong to a sequence: add --frames A:B");
        return 1;
    }
    for (i = 0; i < sizeof patterns / sizeof *patterns; i++)
        if (patterns[i].pattern && sequence_conversions(patterns[i].pattern) != 1)
            return frame_error(s->error, sizeof s->error, "%s %s: with --frames it must hold the number of the frame once, as in "
                               "dir/frame-%%03d.exr. A percent sign is %%%%", patterns[i].name, patterns[i].pattern);
    if (a->repeat > 1)
        return frame_error(s->error, sizeof s->error, "--repeat %d: a sequence runs each frame once. Leave it out", a->repeat);
    if (a->frame && (a->turn != 0.0f || a->move[0] != 0.0f || a->move[1] != 0.0f || a->move[2] != 0.0f))
        return frame_error(s->error, sizeof s->error, "--move and --turn belong to --scene; frames have their own cameras. Leave "
                           "them out");
    if (a->cut >= 0 && (a->cut < a->first || a->cut > a->last))
        return frame_error(s->error, sizeof s->error, "--cut %d: is not one of the frames %d to %d", a->cut, a->first, a->last);
    return 1;
}

/* Paths of frame `number`. */
static int name_files(session *s, int number)
{
    const arguments *a = &s->args;
    const struct { const char *pattern; char *out; } paths[] = {{a->frame, s->files.frame}, {a->camera, s->files.camera},
                                                                {a->out, s->files.out}};
    size_t i;

    s->number = number;
    for (i = 0; i < sizeof paths / sizeof *paths; i++) {
        paths[i].out[0] = 0;
        if (!paths[i].pattern) continue;
        if (a->sequence ? !sequence_name(paths[i].out, PATH_BYTES, paths[i].pattern, number)
                        : snprintf(paths[i].out, PATH_BYTES, "%s", paths[i].pattern) >= PATH_BYTES)
            return frame_error(s->error, sizeof s->error, "%.40s...: path of more than %d bytes. Choose a shorter one",
                               paths[i].pattern, PATH_BYTES);
    }
    if (a->out && a->report && strcmp(s->files.out, a->report) == 0)
        return frame_error(s->error, sizeof s->error, "--out and --report name the same file %s in frame %d. Rename one", a->report,
                           number);
    if (a->png && snprintf(s->files.png, PATH_BYTES, a->sequence ? "%s/%03d" : "%s", a->png, number) >= PATH_BYTES)
        return frame_error(s->error, sizeof s->error, "%.40s...: path of more than %d bytes. Choose a shorter one", a->png,
                           PATH_BYTES);
    return 1;
}

static int check_arguments(session *s)
{
    arguments *a = &s->args;

    if (!a->frame == !a->scene)
        return frame_error(s->error, sizeof s->error, "give either --frame F.exr --camera C.json, or --scene NAME");
    if (a->frame && !a->camera) return frame_error(s->error, sizeof s->error,
                                                   "--frame needs the camera of that frame: --camera C.json");
    if (a->scene && !check_scene(s)) return 0;
    if (a->scene && a->camera) return frame_error(s->error, sizeof s->error,
                                                  "--camera belongs to --frame; a scene has its own. Leave one out");
    if (a->frame && (a->width || a->rays >= 0))
        return frame_error(s->error, sizeof s->error, "--size and --rays belong to --scene; a frame has its own. Leave them out");
    if (!check_sequence(s)) return 0;
    if (a->env && a->hook)
        return frame_error(s->error, sizeof s->error, "--env %s and --hook %s: there is one environment. Leave one out", a->env,
                           a->hook);
    if (a->out && a->report && strcmp(a->out, a->report) == 0)
        return frame_error(s->error, sizeof s->error, "--out and --report name the same file %s", a->out);
    if (!a->backend) a->backend = "vulkan";
    if (!runner_target(a->backend))
        return frame_error(s->error, sizeof s->error, "--backend %s: must be vulkan, gl or gles", a->backend);
    if (!a->width) a->width = 640, a->height = 360;
    if (a->rays < 0) a->rays = 64;
    return 1;
}

/* 1: go on. 0: done, *code is the exit code. */
static int read_command_line(session *s, int argc, char **argv, int *code)
{
    int i;

    *code = USAGE;
    s->args.rays = s->args.cut = -1;
    s->args.repeat = 1;
    for (i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "--version") == 0) {
            if (argv[i][2] == 'h') print_help();
            else printf("hbil-frame %d.%d.%d\n", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
            *code = DONE;
            return 0;
        }
        if (strcmp(argv[i], "-q") == 0) s->args.quiet = 1;
        else if (strcmp(argv[i], "--validate") == 0) s->args.validate = 1;
        else if (strcmp(argv[i], "--emissive") == 0) s->args.emissive = 1;
        else if (!read_argument(s, argv[i], i + 1 < argc ? argv[i + 1] : "")) return fail(s, 0);
        else i++;
    }
    return check_arguments(s) ? 1 : fail(s, 0);
}

/* ---- config and plan --------------------------------------------------------------------------------------------- */

static void print_diags(const session *s, const hbil_diags *diags)
{
    static const char *const words[] = {"", "note: ", "warning: ", ""};
    int32_t i;

    for (i = 0; i < diags->count && i < diags->capacity; i++)
        if (diags->items[i].severity != HBIL_NOTE || !s->args.quiet)
            fprintf(stderr, "hbil-frame: %s%s\n", words[diags->items[i].severity], diags->items[i].text);
    if (diags->count > diags->capacity) fprintf(stderr, "hbil-frame: and %d more\n", (int)(diags->count - diags->capacity));
}

/* Environment and hook: files that the config depends on. */
static int read_environment(session *s)
{
    if (s->args.env && !environment_parse(&s->env, s->args.env, s->error, sizeof s->error))
        return fail(s, s->env.misuse ? USAGE : FILES);
    if (!s->args.hook) return DONE;
    s->hook = text_read(s->args.hook, HOOK_BYTES_MAX, "GLSL text", s->error, sizeof s->error);
    return s->hook ? DONE : fail(s, FILES);
}

/* name=value pairs of one --set. Every fault is collected; 0 if there was one. */
static int apply_set(session *s, const char *text, hbil_diags *diags)
{
    char  *pairs = malloc(strlen(text) + 1), *pair, *value, *next;
    int   ok = pairs != NULL;

    if (pairs) strcpy(pairs, text);
    for (pair = pairs; pair && *pair; pair = next) {
        next = pair + strcspn(pair, ",");
        if (*next) *next++ = 0;
        value = strchr(pair, '=');
        if (value) *value++ = 0;
        /* Without '=': the text "" is no value of any option, so the fault names the option and its range. */
        if (hbil_config_set(&s->config, pair, value ? value : "", diags) != HBIL_OK) ok = 0;
        if (strcmp(pair, "environment") == 0) s->set_environment = s->config.environment != 0;
        if (strcmp(pair, "sh_order") == 0) s->set_sh_order = s->config.sh_order != 0;
    }
    free(pairs);
    return ok;
}

/* The name of a choice of the option environment. */
static const char *environment_name(int32_t choice, char name[16])
{
    static const char option[] = "environment";
    const char *p = hbil_option_at(hbil_option_find(option, sizeof option - 1, NULL))->choices;

    for (; choice > 1 && *p; choice--) p += strcspn(p, " ") + (p[strcspn(p, " ")] != 0);
    snprintf(name, 16, "%.*s", (int)strcspn(p, " "), p);
    return name;
}

/* What --env and --hook say about the config, unless --set says it. */
static int apply_environment(session *s)
{
    const arguments *a = &s->args;
    const int        kind = s->hook ? HBIL_ENVIRONMENT_HOOK : s->env.kind;
    hbil_config      resolved;
    char             given[16], set[16];

    if (kind == 0) return 1;
    if (s->set_environment && s->config.environment != kind)
        return frame_error(s->error, sizeof s->error, "%s %s is environment=%s, but --set says environment=%s. Leave one out",
                           s->hook ? "--hook" : "--env", s->hook ? a->hook : a->env, environment_name(kind, given),
                           environment_name(s->config.environment, set));
    s->config.environment = kind;
    if (s->set_sh_order || (kind != HBIL_ENVIRONMENT_SH && kind != HBIL_ENVIRONMENT_PROBES)) return 1;
    /* where no output reads the environment, one note about it is enough */
    if (hbil_config_resolve(&s->config, &resolved, NULL) == HBIL_OK && resolved.environment == HBIL_ENVIRONMENT_NONE) return 1;
    s->config.sh_order = s->env.order == 2 ? 2 : 1;
    return 1;
}

/* Does the config ask for an environment that nobody gave? */
static int check_environment(session *s, const hbil_config *resolved)
{
    static const char *const fixes[] = {"", "", "--env color:R,G,B", "--env sky or --env sh:NUMBERS", "--env CUBE.exr",
                                        "--env PROBES.json", "--hook H.glsl"};
    char name[16];

    if (resolved->environment == HBIL_ENVIRONMENT_NONE || s->env.kind != 0 || s->hook) return 1;
    return frame_error(s->error, sizeof s->error, "environment=%s%s%s, but its light is not given. Add %s, or set "
                       "environment=none where the outputs go without", environment_name(resolved->environment, name),
                       s->set_environment ? "" : " of preset ", s->set_environment ? "" : s->args.preset,
                       fixes[resolved->environment]);
}

/* Preset, options, target. What a frame decides is still open; all else is checked before any work begins. */
static int make_config(session *s)
{
    hbil_diag   items[DIAGS_MAX];
    hbil_diags  diags = {items, DIAGS_MAX, 0};
    hbil_config resolved;
    const int   target = runner_target(s->args.backend);
    int         i, ok = !s->args.preset || hbil_config_preset(s->args.preset, &s->config, &diags) == HBIL_OK;

    for (i = 0; i < s->args.set_count; i++) ok &= apply_set(s, s->args.sets[i], &diags);
    if (s->config.target != 0 && s->config.target != target) {
        frame_error(s->error, sizeof s->error,
                    "option target: does not match --backend %s. Leave target out, or choose the other backend",
                    s->args.backend);
        return fail(s, REFUSED);
    }
    s->config.target = target;
    if (ok && !apply_environment(s)) return fail(s, REFUSED);
    if (ok) ok = hbil_config_resolve(&s->config, &resolved, &diags) == HBIL_OK;
    if (!ok) {
        print_diags(s, &diags);
        return REFUSED;
    }
    return check_environment(s, &resolved) ? DONE : fail(s, REFUSED);
}

/* Whether the text has the function is known before a driver sees it. */
static int check_hook(session *s)
{
    hbil_diag  items[DIAGS_MAX];
    hbil_diags diags = {items, DIAGS_MAX, 0};
    uint32_t   p;
    size_t     need;

    for (p = 0; p < s->plan.pass_count; p++) {
        if (hbil_emit_glsl_hook(&s->plan, (int32_t)p, s->hook, NULL, 0, &need, &diags) != HBIL_E_HOOK) continue;
        print_diags(s, &diags);
        frame_error(s->error, sizeof s->error, "%s: cannot be used as environment=hook, see above", s->args.hook);
        return fail(s, FILES);
    }
    return DONE;
}

/* The plan, for the camera of the frame. */
static int make_plan(session *s)
{
    hbil_diag  items[DIAGS_MAX];
    hbil_diags diags = {items, DIAGS_MAX, 0};
    int        ok;

    if (s->config.projection == 0)
        s->config.projection = s->cap.orthographic ? HBIL_PROJECTION_ORTHOGRAPHIC : HBIL_PROJECTION_PERSPECTIVE;
    ok = hbil_plan_build(&s->config, &s->plan, &diags) == HBIL_OK;
    print_diags(s, &diags);
    if (!ok) return REFUSED;
    return check_hook(s);
}

/* The frame in the conventions of the plan, behind the one before. */
static int encode(session *s)
{
    const int follows = s->last.width > 0 && s->number != s->args.cut;

    s->cap.emissive = s->args.emissive;
    if (follows && !s->cap.motion.data && !capture_motion(&s->cap, &s->last)) {
        frame_error(s->error, sizeof s->error, "out of memory for the motion of frame %d. Use smaller frames", s->number);
        return fail(s, MISFIT);
    }
    if (!capture_encode(&s->cap, &s->plan, &s->frame, s->inputs, s->error, sizeof s->error)
        || !environment_encode(&s->env, &s->plan, &s->frame, s->inputs, s->error, sizeof s->error)) return fail(s, MISFIT);
    if (follows) capture_follow(&s->frame, &s->last);
    s->frame.index = (uint32_t)s->number;
    return DONE;
}

/* ---- work -------------------------------------------------------------------------------------------------------- */

static int open_runner(session *s)
{
    s->runner = runner_open(s->args.backend, s->args.validate, s->error, sizeof s->error);
    return s->runner ? DONE : fail(s, BACKEND);
}

static int make_capture(session *s)
{
    const arguments *a = &s->args;
    const float n = (float)s->number, move[3] = {n * a->move[0], n * a->move[1], n * a->move[2]};
    char what[64];
    int  code, ok;

    if (a->frame) {
        if (capture_load(&s->cap, s->files.frame, s->files.camera, s->error, sizeof s->error)) return DONE;
        return fail(s, s->cap.misfit ? MISFIT : FILES);
    }
    code = s->runner ? DONE : open_runner(s); /* before the scene: a missing driver should not cost the time of tracing */
    if (code != DONE) return code;
    snprintf(what, sizeof what, a->sequence ? "frame %d of %d to %d: tracing" : "tracing the scene", s->number, a->first, a->last);
    progress_begin(what, a->quiet);
    ok = capture_scene_from(&s->cap, a->scene, move, n * a->turn, a->width, a->height, a->rays, progress_show, s->error,
                            sizeof s->error);
    progress_end();
    return ok ? DONE : fail(s, BACKEND); /* the arguments are checked: what failed is Embree or memory */
}

static int compare_doubles(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

/* Sorts values. */
static timing timing_of(double *values, int count)
{
    timing t;

    qsort(values, (size_t)count, sizeof *values, compare_doubles);
    t.min = values[0];
    t.median = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
    t.max = values[count - 1];
    return t;
}

/* Keep the outputs that were asked for. */
static int take_outputs(session *s, const image textures[HBIL_MAX_TEXTURES])
{
    int k, index;

    for (k = 0; k < OUTPUT_KINDS; k++) {
        index = hbil_plan_texture(&s->plan, output_kinds[k].name);
        if (index < 0 || s->plan.textures[index].life != HBIL_LIFE_OUTPUT) continue;
        if (!output_take(&s->outputs[k], k, &textures[index]))
            return frame_error(s->error, sizeof s->error, "out of memory for the outputs. Use a smaller frame");
    }
    return 1;
}

/* A compiler's message counts the lines of a hook as the hook's own: say whose they are. */
static void name_hook(session *s)
{
    size_t used = strlen(s->error);

    if (!s->hook || !strstr(s->error, "does not compile")) return;
    while (used > 0 && s->error[used - 1] == '\n') s->error[--used] = 0;
    snprintf(s->error + used, sizeof s->error - used, "\n%s: lines of source 1 are those of this file. Mend it", s->args.hook);
}

/* All runs; outputs of the last. */
static int run_plan(session *s)
{
    const int passes = (int)s->plan.pass_count, repeat = s->args.repeat, warm = repeat > 1;
    double    row[HBIL_MAX_PASSES], *ms = calloc((size_t)(passes + 1) * (size_t)repeat, sizeof *ms); /* [pass][run] */
    image     textures[HBIL_MAX_TEXTURES];
    int       i, p, ok = ms != NULL;

    memset(textures, 0, sizeof textures);
    if (!ok) frame_error(s->error, sizeof s->error, "out of memory for %d times. Use a smaller --repeat", repeat);
    if (ok && !runner_hook(s->runner, s->hook)) ok = frame_error(s->error, sizeof s->error, "out of memory for the hook");
    progress_begin("running", s->args.quiet || s->args.sequence); /* a sequence prints its frames */
    for (i = -warm; ok && i < repeat; i++) {
        for (p = 0; p < HBIL_MAX_TEXTURES; p++) image_free(&textures[p]);
        ok = runner_run(s->runner, &s->plan, &s->frame, s->inputs, textures, 1, row, s->error, sizeof s->error);
        for (p = 0; ok && i >= 0 && p < passes; p++) {
            ms[p * repeat + i] = row[p];
            ms[passes * repeat + i] += row[p];
        }
        progress_show((double)(i + 1 + warm) / (repeat + warm));
    }
    progress_end();
    if (!ok) name_hook(s);
    for (p = 0; ok && p <= passes; p++) s->times[p] = timing_of(ms + p * repeat, repeat);
    ok = ok && take_outputs(s, textures);
    for (p = 0; p < HBIL_MAX_TEXTURES; p++) image_free(&textures[p]);
    free(ms);
    if (ok && s->args.validate && runner_messages(s->runner) > 0)
        ok = frame_error(s->error, sizeof s->error, "--validate: %d messages, printed above. Nothing of this frame was written",
                         runner_messages(s->runner));
    return ok ? DONE : fail(s, BACKEND);
}

/* Truth of near light: of as many bounces as the config has. */
static const image *truth_near(const session *s)
{
    return s->plan.config.bounces == HBIL_BOUNCES_RECURSIVE ? &s->cap.truth_bounce : &s->cap.truth_near;
}

/* Truth of near and far light together, as far as the plan adds them up; with `over`, direct + albedo * that. Absent: a part of
 * it is not known. */
static void make_sum(const session *s, int over, image *out)
{
    const capture *cap = &s->cap;
    const int      near_in = s->plan.config.estimator <= HBIL_ESTIMATOR_BITMASK; /* the others gather no near light */
    const int      far_in = s->plan.config.environment != HBIL_ENVIRONMENT_NONE;
    const size_t   count = 3 * (size_t)cap->width * (size_t)cap->height;
    size_t         i;

    memset(out, 0, sizeof *out);
    if ((near_in && !truth_near(s)->data) || (far_in && (!cap->truth_far.data || !s->env.captures_sky))) return;
    if (!image_make(out, cap->width, cap->height, 3)) return;
    for (i = 0; i < count; i++) {
        const float sum = (near_in ? truth_near(s)->data[i] : 0.0f) + (far_in ? cap->truth_far.data[i] : 0.0f);
        out->data[i] = over ? cap->direct.data[i] + cap->albedo.data[i] * sum : sum;
    }
}

static void measure(session *s)
{
    const image *truths[OUTPUT_KINDS] = {NULL}, *fields[OUTPUT_KINDS] = {NULL};
    image        sum, composite;
    int          k;

    if (s->plan.config.f0 != HBIL_F0_NONE) {
        capture_take_f0(&s->cap, &s->cap.truth_far);
        capture_take_f0(&s->cap, &s->cap.truth_near);
        capture_take_f0(&s->cap, &s->cap.truth_bounce);
        capture_take_f0(&s->cap, &s->cap.hf_near);
    }
    make_sum(s, 0, &sum);
    make_sum(s, 1, &composite);
    truths[OUTPUT_AO] = truths[OUTPUT_UNIFORM_AO] = &s->cap.truth_ao;
    truths[OUTPUT_NEAR] = truth_near(s);
    truths[OUTPUT_FAR] = s->env.captures_sky ? &s->cap.truth_far : NULL;
    truths[OUTPUT_IRRADIANCE] = &sum;
    truths[OUTPUT_COMPOSITE] = &composite;
    fields[OUTPUT_AO] = &s->cap.hf_ao;
    if (truth_near(s) == &s->cap.truth_near) fields[OUTPUT_NEAR] = &s->cap.hf_near; /* which is of one bounce */
    for (k = 0; k < OUTPUT_KINDS; k++) {
        if (!s->outputs[k].data) continue;
        s->metrics[k] = metric_measure(&s->outputs[k], truths[k], &s->cap);
        metric_height_field(&s->metrics[k], &s->outputs[k], fields[k], &s->cap);
    }
    image_free(&sum);
    image_free(&composite);
}

/* ---- report ------------------------------------------------------------------------------------------------------ */

/* The resolved config as text; every option if all != 0. Caller frees. */
static char *config_text(const hbil_config *config, int all)
{
    size_t need = 0;
    char  *text;

    hbil_config_print(config, all, NULL, 0, &need);
    text = malloc(need);
    if (text) hbil_config_print(config, all, text, need, NULL);
    return text;
}

/* "a=1 b=gl" to {"a": 1, "b": "gl"}. */
static cJSON *config_object(const char *text)
{
    cJSON *object = cJSON_CreateObject();
    char   name[64], value[256], *end;
    int    used;

    while (sscanf(text, " %63[^= ]=%255s%n", name, value, &used) == 2) {
        double number = strtod(value, &end);
        if (*end) cJSON_AddStringToObject(object, name, value);
        else cJSON_AddNumberToObject(object, name, number);
        text += used;
    }
    return object;
}

static void add_timing(cJSON *array, const char *name, timing t)
{
    cJSON *item = cJSON_CreateObject();

    if (name) cJSON_AddStringToObject(item, "name", name);
    cJSON_AddNumberToObject(item, "min", t.min);
    cJSON_AddNumberToObject(item, "median", t.median);
    cJSON_AddNumberToObject(item, "max", t.max);
    cJSON_AddItemToArray(array, item);
}

static cJSON *output_object(const metric *m)
{
    cJSON *item = cJSON_CreateObject();

    cJSON_AddNumberToObject(item, "nan", (double)m->nan);
    cJSON_AddNumberToObject(item, "inf", (double)m->inf);
    cJSON_AddNumberToObject(item, "negative", (double)m->negative);
    cJSON_AddNumberToObject(item, "min", m->min);
    cJSON_AddNumberToObject(item, "mean", m->mean);
    cJSON_AddNumberToObject(item, "max", m->max);
    if (m->compared > 0) {
        cJSON_AddNumberToObject(item, "rmse", m->rmse);
        cJSON_AddNumberToObject(item, "bias", m->bias);
        cJSON_AddNumberToObject(item, "compared_pixels", (double)m->compared);
    }
    if (m->hf_compared > 0) {
        cJSON_AddNumberToObject(item, "hf_rmse", m->hf_rmse);
        cJSON_AddNumberToObject(item, "hf_bias", m->hf_bias);
        cJSON_AddNumberToObject(item, "hf_compared_pixels", (double)m->hf_compared);
    }
    return item;
}

/* Times and outputs of the frame into a JSON object. */
static void add_results(const session *s, cJSON *object)
{
    cJSON *passes = cJSON_AddArrayToObject(object, "passes_ms"), *outputs = cJSON_AddObjectToObject(object, "outputs");
    int    k;

    for (k = 0; k < (int)s->plan.pass_count; k++) add_timing(passes, s->plan.passes[k].name, s->times[k]);
    add_timing(passes, "total", s->times[k]);
    for (k = 0; k < OUTPUT_KINDS; k++)
        if (s->outputs[k].data) cJSON_AddItemToObject(outputs, output_kinds[k].name, output_object(&s->metrics[k]));
}

/* The frame into the report of a sequence. */
static void note_frame(session *s)
{
    cJSON *item = cJSON_CreateObject();

    if (!s->frames) s->frames = cJSON_CreateArray();
    cJSON_AddNumberToObject(item, "frame", s->number);
    add_results(s, item);
    cJSON_AddItemToArray(s->frames, item);
}

static int write_report(session *s)
{
    const runner_info *about = runner_about(s->runner);
    cJSON *root = cJSON_CreateObject();
    char  *all = config_text(&s->plan.config, 1), *text, hash[20];
    int    ok;

    snprintf(hash, sizeof hash, "%016llx", (unsigned long long)s->plan.hash);
    cJSON_AddStringToObject(root, "backend", about->backend);
    cJSON_AddStringToObject(root, "device", about->device);
    cJSON_AddStringToObject(root, "driver", about->driver);
    cJSON_AddStringToObject(root, "timing", about->timing);
    cJSON_AddStringToObject(root, "frame", s->args.frame ? s->args.frame : s->args.scene);
    if (s->args.env) cJSON_AddStringToObject(root, "env", s->args.env);
    if (s->args.hook) cJSON_AddStringToObject(root, "hook", s->args.hook);
    cJSON_AddNumberToObject(root, "width", s->cap.width);
    cJSON_AddNumberToObject(root, "height", s->cap.height);
    cJSON_AddStringToObject(root, "config_text", all ? all : "");
    cJSON_AddItemToObject(root, "config", config_object(all ? all : ""));
    cJSON_AddStringToObject(root, "config_hash", hash);
    cJSON_AddNumberToObject(root, "texture_bytes", (double)hbil_plan_memory(&s->plan, s->frame.width, s->frame.height));
    cJSON_AddNumberToObject(root, "runs", s->args.repeat);
    if (s->frames) cJSON_AddItemReferenceToObject(root, "frames", s->frames);
    else add_results(s, root);
    text = cJSON_Print(root);
    ok = text && all ? text_write(s->args.report, text, s->error, sizeof s->error)
                     : frame_error(s->error, sizeof s->error, "%s: out of memory for the report", s->args.report);
    cJSON_free(text);
    cJSON_Delete(root);
    free(all);
    return ok;
}

static void print_error(size_t compared, double rmse, double bias)
{
    if (compared > 0) printf(" %9.4f %+9.4f", rmse, bias);
    else printf(" %9s %9s", "-", "-");
}

/* What each output holds, and how far it is from each truth that there is. */
static void print_errors(const session *s)
{
    const int field = s->cap.hf_valid.data != NULL;
    int       k;

    printf("\n%-18s %9s %9s %9s %9s %9s", "output", "min", "mean", "max", "rmse", "bias");
    printf(field ? " %9s %9s   against truth and height field\n" : "%s%s   against the truth\n", field ? "hf rmse" : "",
           field ? "hf bias" : "");
    for (k = 0; k < OUTPUT_KINDS; k++) {
        const metric *m = &s->metrics[k];
        if (!s->outputs[k].data) continue;
        printf("%-18s %9.4f %9.4f %9.4f", output_kinds[k].name, m->min, m->mean, m->max);
        print_error(m->compared, m->rmse, m->bias);
        if (field) print_error(m->hf_compared, m->hf_rmse, m->hf_bias);
        putchar('\n');
    }
}

static void print_summary(const session *s)
{
    const runner_info *about = runner_about(s->runner);
    char *text = config_text(&s->plan.config, 0);
    int   k;

    if (s->args.sequence) printf("\nthe last of these frames:\n");
    printf("backend    %s: %s\n", about->backend, about->device);
    printf("driver     %s\n", about->driver);
    printf("frame      %s, %dx%d\n", s->args.frame ? s->files.frame : s->args.scene, s->cap.width, s->cap.height);
    if (s->args.env || s->args.hook) printf("far light  %s\n", s->args.env ? s->args.env : s->args.hook);
    printf("config     %016llx %s\n", (unsigned long long)s->plan.hash, text && *text ? text : "defaults");
    printf("textures   %.1f MiB of its own\n", (double)hbil_plan_memory(&s->plan, s->frame.width, s->frame.height) / 1048576.0);
    printf("\n%-10s %9s %9s %9s   ms, %d run%s, %s\n", "pass", "min", "median", "max", s->args.repeat,
           s->args.repeat > 1 ? "s" : "", about->timing);
    for (k = 0; k <= (int)s->plan.pass_count && strncmp(about->timing, "none", 4); k++)
        printf("%-10s %9.3f %9.3f %9.3f\n", k < (int)s->plan.pass_count ? s->plan.passes[k].name : "total",
               s->times[k].min, s->times[k].median, s->times[k].max);
    print_errors(s);
    free(text);
}

/* Faults of the light itself: printed even with -q, since a picture may hide them. */
static void print_warnings(const session *s)
{
    int k;

    for (k = 0; k < OUTPUT_KINDS; k++) {
        const metric *m = &s->metrics[k];
        const size_t  negative = output_kinds[k].light ? m->negative : 0;
        if (m->nan + m->inf + negative > 0)
            fprintf(stderr, "hbil-frame: warning: %s holds %lu NaN, %lu infinite and %lu negative values\n", output_kinds[k].name,
                    (unsigned long)m->nan, (unsigned long)m->inf, (unsigned long)negative);
    }
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

/* Can `path` be written, as far as can be known without touching it? Asked before the work, not after it. */
static int check_writable(session *s, const char *path, int folder)
{
    struct stat info;
    char        parent[PATH_BYTES], *slash;
    size_t      length;

    if (!path) return 1;
    if (strlen(path) >= sizeof parent)
        return frame_error(s->error, sizeof s->error, "%.40s...: path of more than %d bytes. Choose a shorter one", path,
                           PATH_BYTES);
    if (stat(path, &info) == 0 && !S_ISDIR(info.st_mode) != !folder)
        return frame_error(s->error, sizeof s->error, "%s: is %s. Choose another path", path,
                           folder ? "a file, not a folder" : "a folder");
    strcpy(parent, path);
    for (length = strlen(path); length > 1 && parent[length - 1] == '/'; length--) parent[length - 1] = 0;
    slash = strrchr(parent, '/');
    if (!slash) strcpy(parent, ".");
    else slash[slash == parent] = 0; /* keep the root's own slash */
    if (folder && stat(path, &info) == 0) strcpy(parent, path);
    if (stat(parent, &info) != 0 || !S_ISDIR(info.st_mode) || access(parent, W_OK) != 0)
        return frame_error(s->error, sizeof s->error,
                           "%s: folder %s is missing or cannot be written. Make it, or choose another path", path, parent);
    return 1;
}

static int check_files(session *s)
{
    const arguments *a = &s->args;

    return check_writable(s, a->out ? s->files.out : NULL, 0) && check_writable(s, a->report, 0) && check_writable(s, a->png, 1)
        ? DONE : fail(s, FILES);
}

static int make_folder(session *s, const char *path)
{
    struct stat info;

    return mkdir(path, 0777) == 0 || (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        || frame_error(s->error, sizeof s->error, "%s: cannot be made. Choose another folder for --png", path);
}

/* Of one frame. */
static int write_files(session *s)
{
    image_layer layers[OUTPUT_LAYERS_MAX];
    int         ok = 1;

    if (s->args.out) ok = exr_write(s->files.out, layers, output_layers(s->outputs, layers), s->error, sizeof s->error);
    if (s->args.png && s->args.sequence) ok = ok && make_folder(s, s->args.png);
    if (s->args.png)
        ok = ok && output_pictures(s->files.png, &s->cap, &s->env, s->outputs, s->error, sizeof s->error);
    return ok ? DONE : fail(s, FILES);
}

/* ------------------------------------------------------------------------------------------------------------------ */

/* What belongs to one frame; of its capture the camera is kept for the next. */
static void end_frame(session *s)
{
    int i;

    for (i = 0; i < HBIL_MAX_TEXTURES; i++) image_free(&s->inputs[i]);
    for (i = 0; i < OUTPUT_KINDS; i++) image_free(&s->outputs[i]);
    memset(s->metrics, 0, sizeof s->metrics);
    memset(&s->last, 0, sizeof s->last);
    memcpy(s->last.projection, s->cap.projection, sizeof s->last.projection);
    memcpy(s->last.view, s->cap.view, sizeof s->last.view);
    s->last.width = s->cap.width;
    s->last.height = s->cap.height;
    capture_free(&s->cap);
}

static void session_close(session *s)
{
    end_frame(s);
    cJSON_Delete(s->frames);
    environment_free(&s->env);
    free(s->hook);
    if (s->runner) runner_close(s->runner);
    free(s->args.sets);
    free(s);
}

/* A line for a frame of a sequence: its time, and how far what has a truth is from it. A line of names before the first one. */
static void print_frame(const session *s)
{
    int k;

    if (s->args.quiet) return;
    if (s->number == s->args.first) puts("frame         ms   rmse against the truth, as far as a frame has one");
    printf("%5d %10.3f", s->number, s->times[s->plan.pass_count].median);
    for (k = 0; k < OUTPUT_KINDS; k++)
        if (s->metrics[k].compared > 0) printf("   %s %.4f", output_kinds[k].name, s->metrics[k].rmse);
    putchar('\n');
    fflush(stdout);
}

/* Are the files of all frames there, and their names fit for use? Asked before the first one is lit. */
static int check_frames(session *s)
{
    int n, k;

    for (n = s->args.first; n <= s->args.last; n++) {
        const char *const paths[2] = {s->files.frame, s->files.camera};

        if (!name_files(s, n)) return fail(s, FILES);
        for (k = 0; s->args.frame && k < 2; k++) {
            if (access(paths[k], R_OK) == 0) continue;
            frame_error(s->error, sizeof s->error, "%s: is missing or cannot be read. Write it, or change --frames %d:%d", paths[k],
                        s->args.first, s->args.last);
            return fail(s, FILES);
        }
    }
    return DONE;
}

/* One frame, from its files to its files. The plan is that of the first. */
static int work_frame(session *s)
{
    int code = check_files(s);

    if (code == DONE) code = make_capture(s);
    if (code == DONE && s->plan.pass_count == 0) code = make_plan(s);
    if (code == DONE) code = encode(s);
    if (code == DONE && !s->runner) code = open_runner(s);
    if (code == DONE) code = run_plan(s);
    if (code != DONE) return code;
    measure(s);
    return write_files(s);
}

/* Cheap checks first, files last. */
static int work(session *s)
{
    const int first = s->args.first, last = s->args.last; /* 0 and 0 without --frames */
    int       code = read_environment(s), n;

    if (code == DONE) code = make_config(s);
    if (code == DONE && s->args.sequence) code = check_frames(s);
    for (n = first; code == DONE && n <= last; n++) {
        if (n > first) end_frame(s);
        if (!name_files(s, n)) return fail(s, FILES);
        code = work_frame(s);
        if (code != DONE) return code;
        if (s->args.sequence) {
            if (s->args.report) note_frame(s);
            print_frame(s);
        }
        print_warnings(s);
    }
    if (code == DONE && s->args.report && !write_report(s)) code = fail(s, FILES);
    if (code == DONE && !s->args.quiet) print_summary(s);
    return code;
}

int main(int argc, char **argv)
{
    session *s = calloc(1, sizeof *s); /* tens of kilobytes: too much for some stacks */
    int      code;

    if (s) s->args.sets = calloc((size_t)argc, sizeof *s->args.sets);
    if (!s || !s->args.sets) {
        fputs("hbil-frame: out of memory\n", stderr);
        free(s);
        return BACKEND;
    }
    if (read_command_line(s, argc, argv, &code)) code = work(s);
    session_close(s);
    if (code == DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        fputs("hbil-frame: cannot write standard output. Make room, or redirect it elsewhere\n", stderr);
        code = FILES;
    }
    return code;
}
