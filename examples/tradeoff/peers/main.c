/* hbil-peers - ambient occlusion of three.js (GTAOPass) and of n8ao beside presets of hbil.h: same frames, same device,
 * same run. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define HBIL_IMPLEMENTATION
#include "../../../hbil.h"
#include "../../../tests/captures.h"
#include "../../frame/runner_internal.h"
#include "bout.h"

typedef struct job {
    const char *frames, *frame, *scene, *cache, *csv, *png;
    int         width, height, rays, repeats;
    void       *device;
    runner_info about;
    peers      *peers;
    char        cache_path[1024];
    FILE       *table; /* CSV, in memory until it is whole */
    char       *table_text;
    size_t      table_size;
    tally       score;
} job;

static void make_folder(const char *path)
{
    if (mkdir(path, 0777) != 0 && errno != EEXIST) die(EXIT_FRAME, "%s: cannot be made", path);
}

static void run_frame(job *j, const char *name, const capture *cap)
{
    bout *b = calloc(1, sizeof *b);
    char  error[1024] = "";
    int   missing;

    if (!b) die(EXIT_RUN, "out of memory");
    b->name = name;
    b->cap = *cap;
    b->device = j->device;
    b->peers = j->peers;
    b->repeats = j->repeats;
    b->png = j->png;
    snprintf(b->folder, sizeof b->folder, "%s/%s-%dx%d", j->cache_path, name, cap->width, cap->height);
    make_folder(b->folder);
    if (!variants_extract(HBIL_PEERS_SCRIPT, j->cache_path, b->folder, cap, &missing, error, sizeof error))
        die(missing ? EXIT_NO_PEERS : EXIT_RUN, "%s", error);
    bout_run(b);
    report_bout(b, &j->score);
    report_csv(j->table, b, j->about.device);
    bout_free(b);
}

static void run_captures(job *j)
{
    capture_names all;
    capture       cap;
    char          error[1024] = "";
    int           i, found = 0;

    if (setenv("HBIL_CAPTURES", j->frames, 1) != 0) die(EXIT_RUN, "out of memory");
    all = captures_list();
    for (i = 0; i < all.count; ++i) {
        if (j->frame && strcmp(j->frame, all.name[i]) != 0) continue;
        if (!captures_load(all.name[i], 0, &cap, error, sizeof error)) die(EXIT_FRAME, "%s", error);
        run_frame(j, all.name[i], &cap);
        ++found;
    }
    if (!found)
        die(EXIT_FRAME, "%s: no folder%s%s in it has a frame-000.exr", j->frames, j->frame ? " " : "",
            j->frame ? j->frame : "");
}

static void run_scene(job *j)
{
    capture cap;
    char    error[1024] = "";

    if (!capture_scene(&cap, j->scene, j->width, j->height, j->rays, NULL, error, sizeof error))
        die(EXIT_FRAME, "%s", error);
    run_frame(j, j->scene, &cap);
}

/* ---------------------------------------------------------------------------------------------------- command line */

static void usage(int code)
{
    fputs("usage: hbil-peers --frames DIR [--frame NAME] | --scene NAME [--size WxH] [--rays N]\n"
          "                  [--cache DIR] [--repeat N] [--csv FILE] [--png DIR]\n"
          "Ambient occlusion of three.js (GTAOPass) and n8ao beside presets of hbil.h, on OpenGL: error and time at\n"
          "equal taps and at equal time. Markdown on stdout, progress on stderr.\n"
          "  --frames DIR   subfolders with frame-000.exr, camera-000.json and, if there, hf-000.exr\n"
          "  --frame NAME   one of them\n"
          "  --scene NAME   a built-in scene, as hbil-frame --help lists them; --size 320x180 --rays 64 (a pixel, for its\n"
          "                 truth)\n"
          "  --cache DIR    npm packages and what is made of them, filled over the network once; default\n"
          "                 ~/.cache/hbil-peers\n"
          "  --repeat N     timed rounds, default 5\n"
          "  --csv FILE     all rows as CSV\n"
          "  --png DIR      all images, frame-method-convention-taps.png\n"
          "exit: 0 done; 2 usage; 3 a frame or file; 4 node, npm or the registry is not there; 5 GL, memory, or a\n"
          "      package that is not what it was\n",
          code ? stderr : stdout);
    exit(code);
}

static int number(const char *option, const char *text, int low, int high)
{
    char *end;
    long  v = strtol(text, &end, 10);

    if (end == text || *end || v < low || v > high)
        die(EXIT_USAGE, "%s %s: a number in [%d, %d] is wanted", option, text, low, high);
    return (int)v;
}

static void read_arguments(int argc, char **argv, job *j)
{
    const char *size = NULL, *rays = NULL, *repeat = NULL;
    const struct {
        const char *name, **to;
    } options[] = {{"--frames", &j->frames}, {"--frame", &j->frame}, {"--scene", &j->scene},
                   {"--size", &size},        {"--rays", &rays},      {"--cache", &j->cache},
                   {"--repeat", &repeat},    {"--csv", &j->csv},     {"--png", &j->png}};
    const int count = (int)(sizeof options / sizeof *options);
    int       i, k;

    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) usage(0);
        for (k = 0; k < count && strcmp(argv[i], options[k].name) != 0; ++k) {}
        if (k == count || i + 1 == argc) usage(EXIT_USAGE);
        *options[k].to = argv[++i];
    }
    if (!j->frames == !j->scene || (j->frame && !j->frames)) usage(EXIT_USAGE);
    if (size && (sscanf(size, "%dx%d", &j->width, &j->height) != 2 || j->width < 16 || j->height < 16))
        die(EXIT_USAGE, "--size %s: WIDTHxHEIGHT, each 16 or more, is wanted", size);
    if (rays) j->rays = number("--rays", rays, 1, 65536);
    if (repeat) j->repeats = number("--repeat", repeat, 1, REPEATS_MAX);
}

/* --cache, else the user's cache folder. */
static void find_cache(job *j)
{
    const char *home = getenv("HOME"), *xdg = getenv("XDG_CACHE_HOME");
    char        parent[900];

    if (j->cache) snprintf(j->cache_path, sizeof j->cache_path, "%s", j->cache);
    else {
        if (xdg && *xdg) snprintf(parent, sizeof parent, "%s", xdg);
        else snprintf(parent, sizeof parent, "%s/.cache", home && *home ? home : ".");
        make_folder(parent);
        snprintf(j->cache_path, sizeof j->cache_path, "%s/hbil-peers", parent);
    }
    make_folder(j->cache_path);
    if (j->png) make_folder(j->png);
}

int main(int argc, char **argv)
{
    static job j;
    char       error[1024] = "";

    j.width = 320;
    j.height = 180;
    j.rays = 64;
    j.repeats = 5;
    read_arguments(argc, argv, &j);
    find_cache(&j);
    j.device = runner_gl.open(0, &j.about, error, sizeof error);
    if (!j.device) die(EXIT_RUN, "%s", error);
    j.peers = peers_open(j.device, error, sizeof error);
    if (!j.peers) die(EXIT_RUN, "%s", error);
    j.table = open_memstream(&j.table_text, &j.table_size);
    if (!j.table) die(EXIT_RUN, "out of memory");
    report_csv_head(j.table);
    report_head(j.about.device, j.about.driver);
    if (j.frames) run_captures(&j);
    else run_scene(&j);
    report_summary(&j.score);
    fclose(j.table);
    if (j.csv && !text_write(j.csv, j.table_text, error, sizeof error)) die(EXIT_FRAME, "%s", error);
    free(j.table_text);
    peers_close(j.peers);
    runner_gl.close(j.device);
    return 0;
}
