/* decimate.h - captures made small without another camera: the same rays, fewer of them. */
#ifndef HBIL_TESTS_DECIMATE_H
#define HBIL_TESTS_DECIMATE_H

#include <string.h>

#include "../../examples/frame/capture.h"

/* Every by-th pixel of every by-th row of the G-buffer and of the truths of the scene as a frame of its own, or as one of a film of which
 * all are made small, with the same rays through its pixel centres. by: even. 1, or 0: out of memory, and the capture is of no more use. */
static inline int decimate(capture *cap, int by)
{
    const int    width = cap->width / by, height = cap->height / by;
    const int    size[2] = {cap->width, cap->height}, small[2] = {width, height};
    image *const images[] = {&cap->depth, &cap->normal, &cap->albedo, &cap->direct, &cap->f0, &cap->roughness, &cap->motion,
                             &cap->truth_ao, &cap->truth_near, &cap->truth_far, &cap->truth_bounce};
    for (size_t k = 0; k < sizeof images / sizeof *images; ++k) {
        const int channels = images[k]->channels;
        image     out;
        if (!images[k]->data) {
            continue;
        }
        if (!image_make(&out, width, height, channels)) {
            return 0;
        }
        for (int i = 0; i < width * height; ++i) {
            const int from = (i / width * by + by / 2) * cap->width + i % width * by + by / 2;
            memcpy(out.data + i * channels, images[k]->data + from * channels, (size_t)channels * sizeof *out.data);
        }
        image_free(images[k]);
        *images[k] = out;
    }
    for (int i = 0; cap->motion.data && i < 2 * width * height; ++i) {
        cap->motion.data[i] /= (float)by;
    }
    for (int axis = 0; axis < 2; ++axis) { /* centre x' + 1/2 of the small frame is by (x' + 1/2) + 1/2 of the large one */
        const double scale = (double)size[axis] / (by * small[axis]), shift = scale * (1.0 - 1.0 / size[axis]) - 1.0;
        for (int column = 0; column < 4; ++column) {
            float *m = cap->projection + 4 * column;
            m[axis] = (float)(scale * (double)m[axis] + shift * (double)m[3]);
        }
    }
    cap->width = width;
    cap->height = height;
    return 1;
}

#endif
