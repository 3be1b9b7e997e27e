/* frames.c - writes captures for run.sh: DIR/metal, half of its floor a mirror (f0), and DIR/move, three frames of a
 * moving camera. frames --compile IN.comp OUT.spv: GLSL to SPIR-V, which not every machine has a program for. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define HBIL_IMPLEMENTATION
#include "../../backends/hbil_glslang.h"
#include "capture.h"

/* Rows of a column-major matrix; flip: -1 for the projection, whose y row a capture turns upside down. */
static int put_matrix(char *text, size_t size, const char *name, const float m[16], double flip)
{
    int used = snprintf(text, size, ", \"%s\": [", name), r, c;

    for (r = 0; r < 4; r++)
        for (c = 0; c < 4; c++)
            used += snprintf(text + used, size - (size_t)used, "%s%s%.9g%s", r && !c ? ", " : "", c ? ", " : "[",
                             (double)m[4 * c + r] * (r == 1 ? flip : 1.0), c == 3 ? "]" : "");
    return used + snprintf(text + used, size - (size_t)used, "]");
}

static int put_capture(const capture *cap, const char *folder, int number)
{
    const image_layer layers[] = {{"depth", "Z", cap->depth, 0},
                                  {"normal", "XYZ", cap->normal, 0},
                                  {"albedo", "RGB", cap->albedo, 0},
                                  {"direct", "RGB", cap->direct, 0},
                                  {"truth_ao", "Y", cap->truth_ao, 0},
                                  {"f0", "Y", cap->f0, 0},
                                  {"truth_near", "RGB", cap->truth_near, 0},
                                  {"truth_far", "RGB", cap->truth_far, 0}};
    char   path[512], text[2048], error[256];
    size_t used;

    snprintf(path, sizeof path, "%s/frame-%03d.exr", folder, number);
    if (!exr_write(path, layers, sizeof layers / sizeof *layers, error, sizeof error))
        return fprintf(stderr, "%s\n", error), 0;
    used = (size_t)snprintf(text, sizeof text, "{\"width\": %d, \"height\": %d, \"near\": %.9g, \"far\": %.9g",
                            cap->width, cap->height, (double)cap->near_z, (double)cap->far_z);
    used += (size_t)put_matrix(text + used, sizeof text - used, "projection_rows", cap->projection, -1.0);
    used += (size_t)put_matrix(text + used, sizeof text - used, "view_rows", cap->view, 1.0);
    snprintf(text + used, sizeof text - used, "}\n");
    snprintf(path, sizeof path, "%s/camera-%03d.json", folder, number);
    return text_write(path, text, error, sizeof error);
}

static int compile(const char *from, const char *to)
{
    static uint32_t words[1 << 16];
    char            log[512] = "";
    size_t          need = 0;
    char           *text = text_read(from, 1 << 16, "GLSL", log, sizeof log);
    FILE           *f = fopen(to, "wb");
    int             ok = text && f && hbil_glslang_init()
             && hbil_glslang_optimize(text, HBIL_TARGET_VULKAN, words, 1 << 16, &need, log, sizeof log)
                    == HBIL_GLSLANG_OK
             && fwrite(words, sizeof *words, need, f) == need;

    if (!f || fclose(f) != 0) ok = 0;
    if (!ok) fprintf(stderr, "%s: %s\n", from, log);
    free(text);
    hbil_glslang_shutdown();
    return ok;
}

int main(int argc, char **argv)
{
    char    folder[256], error[256];
    capture cap;
    int     i, ok = argc == 2;

    if (argc == 4 && strcmp(argv[1], "--compile") == 0) return compile(argv[2], argv[3]) ? 0 : 1;
    for (i = 0; ok && i < 4; i++) { /* three that move, one of metal */
        const float move[3] = {i < 3 ? 0.02f * (float)i : 0.0f, 0.0f, 0.0f};
        size_t      k;

        ok = capture_scene_from(&cap, "fence", move, 0.0f, 48, 28, 16, NULL, error, sizeof error);
        if (ok && i == 3) {
            ok = image_make(&cap.f0, 48, 28, 1);
            for (k = 0; ok && k < 48 * 28; k++) cap.f0.data[k] = k / 48 > 20 ? 0.9f : 0.04f;
        }
        snprintf(folder, sizeof folder, "%s/%s", argv[1], i < 3 ? "move" : "metal");
        mkdir(folder, 0777);
        ok = ok && put_capture(&cap, folder, i % 3);
        capture_free(&cap);
    }
    return ok ? 0 : 1;
}
