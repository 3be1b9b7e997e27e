/* variants.c - see variants.h. The names of the options are those of three.js's GTAOPass.updateGtaoMaterial and of
 * n8ao's configuration; what is not set keeps the package's default. */
#include "variants.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#define SKY_FROM 1e9f /* m */

const char *const peer_names[PEERS] = {"three", "n8ao"};
const char *const convention_names[CONVENTIONS] = {"as shipped", "large", "best"};
const int         peer_rungs[PEERS][RUNGS_MAX] = {{3, 6, 9, 16, 30}, {4, 8, 16, 36, 64}};
const float       powers[POWERS] = {0.5f, 0.75f, 1.0f, 1.5f, 2.0f, 3.0f, 5.0f};
const char *const power_names[PEERS] = {"scale", "intensity"};

enum { RADII = 6 };

/* three: fall-off of horizons with the step off or on, steps even or quadratic; n8ao: the fall-off's reach, in radii
 * / 5. */
typedef struct point {
    float radius, falloff, exponent;
} point;

int variant_grid(int peer)
{
    return peer == PEER_THREE ? RADII * 4 : RADII * 2;
}

/* Radii as parts of `large`: 1, 1/2 ... 1/32. */
static point grid_point(int peer, int index)
{
    const point large[PEERS] = {{1.0f, 0.0f, 1.0f}, {1.0f, 5.0f, 1.0f}};
    const int   k = index / RADII;
    point       p = large[peer];

    p.radius = ldexpf(1.0f, -(index % RADII));
    if (k & 1) p.falloff = 1.0f;
    if (k & 2) p.exponent = 2.0f;
    return p;
}

void variant_name(int peer, int convention, int rung, int index, char out[64])
{
    snprintf(out, 64, "%s-%d-%c%d", peer_names[peer], peer_rungs[peer][rung], "slb"[convention],
             convention == AS_BEST ? index : 0);
}

void variant_text(int peer, int convention, int index, float large, char out[160])
{
    const point p = grid_point(peer, convention == AS_BEST ? index : 0);

    if (convention == AS_SHIPPED) snprintf(out, 160, "%s", "");
    else if (peer == PEER_THREE)
        snprintf(out, 160, "radius=%.3g thickness=%.3g distanceFallOff=%g distanceExponent=%g",
                 (double)(p.radius * large), (double)large, (double)p.falloff, (double)p.exponent);
    else snprintf(out, 160, "aoRadius=%.3g distanceFalloff=%g", (double)(p.radius * large), (double)p.falloff);
}

float variant_large(const capture *cap)
{
    float low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, sum = 0.0f;
    int   x, y, c;

    for (y = 0; y < cap->height; ++y) {
        for (x = 0; x < cap->width; ++x) {
            const float d = cap->depth.data[y * cap->width + x];
            const float ndc[2] = {2.0f * ((float)x + 0.5f) / (float)cap->width - 1.0f,
                                  2.0f * ((float)y + 0.5f) / (float)cap->height - 1.0f};
            const float at[3] = {d * ndc[0] / cap->projection[0], d * ndc[1] / cap->projection[5], d};

            if (!(d < SKY_FROM)) continue;
            for (c = 0; c < 3; ++c) {
                low[c] = fminf(low[c], at[c]);
                high[c] = fmaxf(high[c], at[c]);
            }
        }
    }
    for (c = 0; c < 3; ++c) sum += (high[c] - low[c]) * (high[c] - low[c]);
    return isfinite(sum) ? sqrtf(sum) : 1.0f;
}

/* --------------------------------------------------------------------------------------------------------- request */

static void put_settings(FILE *f, int peer, int convention, int rung, int index, float large)
{
    const point  p = grid_point(peer, convention == AS_BEST ? index : 0);
    const double radius = (double)(p.radius * large);

    fprintf(f, peer == PEER_THREE ? "\"samples\": %d" : "\"aoSamples\": %d", peer_rungs[peer][rung]);
    if (convention == AS_SHIPPED) return;
    if (peer == PEER_THREE)
        fprintf(f, ", \"radius\": %.9g, \"thickness\": %.9g, \"distanceFallOff\": %.9g, \"distanceExponent\": %.9g",
                radius, (double)large, (double)p.falloff, (double)p.exponent);
    else fprintf(f, ", \"aoRadius\": %.9g, \"distanceFalloff\": %.9g, \"intensity\": 1", radius, (double)p.falloff);
}

static void put_variants(FILE *f, float large)
{
    const char *comma = "";
    int         peer, rung, convention, index;
    char        name[64];

    for (peer = 0; peer < PEERS; ++peer)
        for (rung = 0; rung < RUNGS_MAX && peer_rungs[peer][rung]; ++rung)
            for (convention = 0; convention < CONVENTIONS; ++convention)
                for (index = 0; index < (convention == AS_BEST ? variant_grid(peer) : 1); ++index) {
                    variant_name(peer, convention, rung, index, name);
                    fprintf(f, "%s\n{ \"name\": \"%s\", \"peer\": \"%s\", \"settings\": { ", comma, name,
                            peer_names[peer]);
                    put_settings(f, peer, convention, rung, index, large);
                    fputs(" } }", f);
                    comma = ",";
                }
}

/* The projection with y up again: captures have row 0 at ndc y = -1. */
static int write_request(const char *path, const capture *cap, char *error, size_t error_size)
{
    char  *text = NULL;
    size_t size = 0;
    FILE  *f = open_memstream(&text, &size);
    int    i, ok;

    if (!f) return frame_error(error, error_size, "%s: out of memory", path);
    fprintf(f, "{ \"width\": %d, \"height\": %d, \"near\": %.9g, \"far\": %.9g, \"projection\": [", cap->width,
            cap->height, (double)cap->near_z, (double)cap->far_z);
    for (i = 0; i < 16; ++i)
        fprintf(f, "%s%.9g", i ? ", " : "", (double)(i % 4 == 1 ? -cap->projection[i] : cap->projection[i]));
    fputs("],\n  \"variants\": [", f);
    put_variants(f, variant_large(cap));
    fputs("] }\n", f);
    ok = fclose(f) == 0 ? text_write(path, text, error, error_size) : frame_error(error, error_size, "%s: out of memory", path);
    free(text);
    return ok;
}

int variants_extract(const char *script, const char *cache, const char *folder, const capture *cap, int *missing,
                     char *error, size_t error_size)
{
    char  request[1024];
    pid_t child;
    int   status = 0;

    *missing = 0;
    if (snprintf(request, sizeof request, "%s/request.json", folder) >= (int)sizeof request)
        return frame_error(error, error_size, "%s: too long a path", folder);
    if (!write_request(request, cap, error, error_size)) return 0;
    child = fork();
    if (child == 0) {
        execlp("node", "node", script, cache, request, folder, (char *)NULL);
        _exit(127);
    }
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {}
    if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 0) return 1;
    *missing = child > 0 && WIFEXITED(status) && (WEXITSTATUS(status) == 127 || WEXITSTATUS(status) == 3);
    if (child > 0 && WIFEXITED(status) && WEXITSTATUS(status) == 127)
        return frame_error(error, error_size, "node is missing: sh packages.sh peers");
    return frame_error(error, error_size, "node %s failed, see above", script);
}
