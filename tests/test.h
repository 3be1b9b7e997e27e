/* test.h - cmocka with its prerequisites, and the header under test. */
#ifndef HBIL_TEST_H
#define HBIL_TEST_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "../hbil.h"

/* A shader's text behind its header comment, which names the config. */
static inline const char *test_body(const char *text)
{
    const char *body = strstr(text, "\n\n");
    assert_non_null(body);
    return body;
}

/* A frame that fits a resolved config: 90 degree camera, near 0.1 m, far 100 m, in the conventions asked for. */
static inline hbil_frame test_frame(const hbil_config *c, uint32_t width, uint32_t height)
{
    hbil_frame f;
    double near_z = 0.1, far_z = 100, low = c->clip == HBIL_CLIP_GL ? -1 : 0;
    int reversed = c->depth_direction == HBIL_DEPTH_DIRECTION_REVERSED;
    double ndc_near = reversed ? 1 : low, ndc_far = reversed ? low : 1;
    memset(&f, 0, sizeof f);
    f.width = width;
    f.height = height;
    f.view[0] = f.view[5] = f.view[10] = f.view[15] = 1;
    f.far_color[0] = f.far_color[1] = f.far_color[2] = f.far_sh[0][0] = 1;
    f.probe_step[0] = f.probe_step[1] = f.probe_step[2] = 1;
    f.projection[0] = (float)height / (float)width;
    f.projection[5] = -1;
    if (c->projection == HBIL_PROJECTION_ORTHOGRAPHIC) { /* ndc = a z + b, z = -depth */
        double a = (ndc_far - ndc_near) / (near_z - far_z);
        f.projection[10] = (float)a;
        f.projection[14] = (float)(ndc_near + a * near_z);
        f.projection[15] = 1;
    } else if (c->depth_far == HBIL_DEPTH_FAR_INFINITE) { /* ndc = -a + b / depth */
        f.projection[10] = (float)-ndc_far;
        f.projection[14] = (float)((ndc_near - ndc_far) * near_z);
        f.projection[11] = -1;
    } else {
        double b = (ndc_near - ndc_far) / (1 / near_z - 1 / far_z);
        f.projection[10] = (float)(b / far_z - ndc_far);
        f.projection[14] = (float)b;
        f.projection[11] = -1;
    }
    memcpy(f.last_projection, f.projection, sizeof f.projection);
    memcpy(f.last_view, f.view, sizeof f.view);
    return f;
}

#endif
