/* image.h - float images in memory, EXR and PNG on disk. */
#ifndef HBIL_FRAME_IMAGE_H
#define HBIL_FRAME_IMAGE_H

#include <stddef.h>

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wmissing-field-initializers" /* {0, 0, 0, NULL} is an absent image; depth follows it */
#endif

/* Interleaved floats, rows top to bottom. data == NULL: the image is absent. */
typedef struct image {
    int    width, height, channels; /* channels 1..4 */
    float *data;                    /* width * height * channels, slice after slice */
    int    depth;                   /* slices: layers, cube faces +X -X +Y -Y +Z -Z, or z. 0 and 1: a plain image */
} image;

/* 1 on success; 0 when out of memory or a size is not in [1, 16384] (the image is then absent). Zero-filled. */
int  image_make(image *out, int width, int height, int channels);
/* The same with `depth` slices. */
int  image_make_slices(image *out, int width, int height, int depth, int channels);
/* Slices of an image: its depth, 1 for a plain image. */
int  image_slices(const image *img);
void image_free(image *img);

/* Print a message into error[] (may be NULL if error_size is 0), cut to fit. Always 0, for `return frame_error(...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
int  frame_error(char *error, size_t error_size, const char *format, ...);

/* Channel names of an image in an EXR layer: "ao" + "Y" -> ao.Y, "near" + "RGB" -> near.R near.G near.B, "" + "RGB" -> R G B */
typedef struct image_layer {
    const char *layer;      /* "depth" */
    const char *channels;   /* "Z", "XYZ", "RGB", "Y" */
    image       pixels;
    int         required;   /* read only: missing is an error; else the image stays absent */
} image_layer;

/* Read the layers of an EXR file (any compression, half, float or uint, scan line or tiled, data window at any origin).
 * 1 on success. 0: error[] says what is wrong and how to mend it, all images are absent. */
int exr_read(const char *path, image_layer *layers, int count, char *error, size_t error_size);
/* Names of the channels of its first part, one after the other, each with its 0, an empty one at the end; caller frees.
 * *parts: how many parts there are. NULL: exr_read will say why. */
char *exr_names(const char *path, int *parts);
/* Write all present layers as float channels, ZIP-compressed. Temporary file beside the target, then rename: an existing file is
 * replaced whole or not at all. */
int exr_write(const char *path, const image_layer *layers, int count, char *error, size_t error_size);
/* 8-bit sRGB PNG of 1 or 3 channels, values in [0, 1] taken as linear if linear != 0, as they are if not. Renamed into place. */
int png_write(const char *path, const image *img, int linear, char *error, size_t error_size);
/* All that is written here comes through PATH.<process>.tmp, renamed to PATH once it is whole. A run that is killed leaves that file; the
 * next one that writes PATH removes those of processes that are no more, as does this. */
void temp_clean(const char *path);
/* A text file of at most `most` bytes, terminated; caller frees. what: what should be in it, for the message, "the camera's JSON".
 * NULL: error[] says why. */
char *text_read(const char *path, size_t most, const char *what, char *error, size_t error_size);
/* Text file, renamed into place. */
int text_write(const char *path, const char *text, char *error, size_t error_size);

#endif
