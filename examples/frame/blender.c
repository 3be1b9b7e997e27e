/* blender.c - the render passes of Blender's multilayer EXR, as a capture wants them.
 *
 *   channels               hold                                            become
 *   Depth.Z or .V          along the view axis, Blender units; sky 1e10    depth, a unit as a metre
 *   Normal.XYZ             of the shading, unit, world space; sky 0        normal, in view space
 *   DiffCol.RGB            diffuse reflectance                             albedo
 *   DiffDir.RGB            E/pi of lamps, glowing surfaces and world       direct = DiffCol * DiffDir
 *   Emit.RGB               radiance                                        emission
 *   Vector.XYZW            XY: pixel in the last frame minus here, +y up   motion, +y down
 *   DiffInd.RGB, AO.RGB    E/pi of one bounce, visibility                  truth_near, truth_ao
 *
 * The last row only in a view layer named "truth", which export_frame.py --truth makes: in others light is of all
 * bounces, and visibility of what is near.
 *
 * The name of a view layer and a dot go before each: any text, with dots and spaces, or nothing at all. */
#include "blender.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NAME_BYTES 288 /* a channel's name has at most 255; behind it goes one of ours */
#define TRUTH "truth."
#define ALL_REQUIRED ((1u << REQUIRED) - 1u)

enum { DEPTH, NORMAL, COLOUR, LIGHT, REQUIRED, EMISSION = REQUIRED, MOTION, INDIRECT, OCCLUSION, PASSES };

/* Where the required ones are, below View Layer Properties > Passes. */
static const char *const switches[REQUIRED] = {
    "Depth (Data > Z)", "Normal (Data > Normal)", "DiffCol (Light > Diffuse > Color)",
    "DiffDir (Light > Diffuse > Direct)",
};

/* The long names are those of Blender 5. */
static const struct { int pass; const char *name, *channels; } spellings[] = {
    {DEPTH, "Depth", "Z"},       {DEPTH, "Depth", "V"},
    {NORMAL, "Normal", "XYZ"},   {COLOUR, "DiffCol", "RGB"},
    {LIGHT, "DiffDir", "RGB"},   {COLOUR, "Diffuse Color", "RGB"},
    {EMISSION, "Emit", "RGB"},   {LIGHT, "Diffuse Direct", "RGB"},
    {MOTION, "Vector", "XY"},    {EMISSION, "Emission", "RGB"},
    {INDIRECT, "DiffInd", "RGB"}, {INDIRECT, "Diffuse Indirect", "RGB"},
    {OCCLUSION, "AO", "R"},      {OCCLUSION, "Ambient Occlusion", "R"},
};
enum { SPELLINGS = sizeof spellings / sizeof *spellings };

static int has(const char *names, const char *name)
{
    for (; *names; names += strlen(names) + 1)
        if (strcmp(names, name) == 0) return 1;
    return 0;
}

/* Bit k: the view layer has pass k. */
static unsigned passes_of(const char *names, const char *layer)
{
    char     name[2 * NAME_BYTES];
    unsigned bits = 0;
    int      i;

    for (i = 0; i < SPELLINGS; i++) {
        snprintf(name, sizeof name, "%s%s.%c", layer, spellings[i].name, spellings[i].channels[0]);
        if (has(names, name)) bits |= 1u << spellings[i].pass;
    }
    return bits;
}

static int count_bits(unsigned bits)
{
    int count = 0;

    for (; bits; bits &= bits - 1u) count++;
    return count;
}

/* The view layer, dot included, with the most required passes; of several such the first. 0: none has any, and
 * there is not even a rendered picture. */
static int choose_layer(const char *names, char layer[NAME_BYTES])
{
    const char *name;
    int         most = 0;

    for (name = names; *name; name += strlen(name) + 1) {
        const char *dot = strrchr(name, '.');
        char        candidate[NAME_BYTES], picture[2 * NAME_BYTES];
        int         count;

        while (dot && dot > name && dot[-1] != '.') dot--; /* to the beginning of the pass */
        snprintf(candidate, sizeof candidate, "%.*s", dot ? (int)(dot - name) : 0, name);
        count = count_bits(passes_of(names, candidate) & ALL_REQUIRED);
        snprintf(picture, sizeof picture, "%sCombined.R", candidate);
        if (2 * count + has(names, picture) <= most) continue;
        most = 2 * count + has(names, picture);
        memcpy(layer, candidate, sizeof candidate);
    }
    return most > 0;
}

static int missing_passes(const char *exr, const char *layer, unsigned bits, int parts, char *error, size_t error_size)
{
    const char *before = " ";
    size_t      used;
    int         k;

    frame_error(error, error_size, "%s: view layer \"%.*s\" of Blender lacks", exr, (int)strlen(layer) - 1, layer);
    for (k = 0; k < REQUIRED && error_size > 0; k++) {
        if (bits & 1u << k) continue;
        used = strlen(error);
        snprintf(error + used, error_size - used, "%s%s", before, switches[k]);
        before = ", ";
    }
    used = error_size > 0 ? strlen(error) : 0;
    snprintf(error + used, error_size - used, "%s", parts > 1
             ? " in the first of its parts. Switch Interleave on in Output Properties > Output, and render again by "
               "Cycles"
             : ". Switch that on in View Layer Properties > Passes, and render again by Cycles, or write the frame by "
               "examples/blender/export_frame.py");
    return BLENDER_FAULT;
}

/* Truth of light is known only where a surface reflects some: truth_ao is 0 elsewhere, as in all captures. */
static int is_lit(const float albedo[3]) { return albedo[0] > 0.0f || albedo[1] > 0.0f || albedo[2] > 0.0f; }

/* Blender's conventions to ours, in place. */
static void convert(image pass[PASSES], const float view[16])
{
    const size_t count = (size_t)pass[DEPTH].width * (size_t)pass[DEPTH].height;
    size_t       p;
    int          i;

    for (p = 0; p < count; p++) {
        float       *n = pass[NORMAL].data + 3 * p;
        const float  w[3] = {n[0], n[1], n[2]}, length = sqrtf(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);

        for (i = 0; i < 3; i++) {
            const float turned = view[i] * w[0] + view[4 + i] * w[1] + view[8 + i] * w[2];

            /* shorter than 1 where a pixel is the mean of several surfaces */
            n[i] = length > 0.0f ? turned / length : 0.0f;
            pass[LIGHT].data[3 * p + (size_t)i] *= pass[COLOUR].data[3 * p + (size_t)i];
        }
        if (pass[MOTION].data) pass[MOTION].data[2 * p + 1] *= -1.0f;
        if (pass[OCCLUSION].data && !is_lit(pass[COLOUR].data + 3 * p)) pass[OCCLUSION].data[p] = 0.0f;
    }
}

/* The images of one view layer, from the spellings that the file has. */
static int read_passes(const char *exr, const char *layer, image pass[PASSES], char *error, size_t error_size)
{
    image_layer layers[SPELLINGS];
    char        names[SPELLINGS][2 * NAME_BYTES];
    const int   truth = strcmp(layer, TRUTH) == 0;
    int         i, count = 0;

    for (i = 0; i < SPELLINGS; i++) {
        if (spellings[i].pass >= INDIRECT && !truth) continue;
        snprintf(names[count], sizeof names[0], "%s%s", layer, spellings[i].name);
        memset(&layers[count], 0, sizeof layers[0]);
        layers[count].layer = names[count];
        layers[count++].channels = spellings[i].channels;
    }
    if (!exr_read(exr, layers, count, error, error_size)) return 0;
    for (i = 0; i < count; i++) { /* the spellings of truth come last, so i counts the same rows */
        image *target = &pass[spellings[i].pass];

        if (target->data) image_free(&layers[i].pixels);
        else *target = layers[i].pixels;
    }
    return 1;
}

int blender_read(capture *out, const char *exr, char *error, size_t error_size)
{
    char     layer[NAME_BYTES];
    image    pass[PASSES];
    unsigned bits;
    int      parts = 1;
    char    *names = exr_names(exr, &parts);

    if (!names || has(names, "depth.Z") || !choose_layer(names, layer)) {
        free(names);
        return BLENDER_NOT;
    }
    bits = passes_of(names, layer) & ALL_REQUIRED;
    free(names);
    if (bits != ALL_REQUIRED && !*layer) return BLENDER_NOT; /* single names without a layer may be anybody's */
    if (bits != ALL_REQUIRED) return missing_passes(exr, layer, bits, parts, error, error_size);
    memset(pass, 0, sizeof pass);
    if (!read_passes(exr, layer, pass, error, error_size)) return BLENDER_FAULT;
    convert(pass, out->view);
    out->depth = pass[DEPTH];
    out->normal = pass[NORMAL];
    out->albedo = pass[COLOUR];
    out->direct = pass[LIGHT];
    out->emission = pass[EMISSION];
    out->motion = pass[MOTION];
    out->truth_near = pass[INDIRECT];
    out->truth_ao = pass[OCCLUSION];
    return BLENDER_READ;
}
