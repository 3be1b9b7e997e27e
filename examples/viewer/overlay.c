/* overlay.c - stb_easy_font's quads to triangles. */
#include "overlay.h"

#include <string.h>

#include <stb/stb_easy_font.h>

typedef struct corner { float x, y, z; unsigned char colour[4]; } corner; /* of stb_easy_font */

int overlay_text(float *corners, int max, const char *text, float x, float y, float scale)
{
    static const int order[6] = {0, 1, 2, 0, 2, 3};
    static corner    quads[4 * 8192];
    char             copy[4096]; /* stb's parameter is not const */
    int              count, q, i, layer, used = 0;

    strncpy(copy, text, sizeof copy - 1);
    copy[sizeof copy - 1] = 0;
    count = stb_easy_font_print(0.0f, 0.0f, copy, NULL, quads, sizeof quads);
    for (layer = 0; layer < 2; layer++) /* the edge, then the letters */
        for (q = 0; q < count; q++)
            for (i = 0; i < 6 && used + 6 <= max; i++) {
                const corner *c = &quads[4 * q + order[i]];
                float        *to = corners + 3 * used;
                to[0] = x + scale * c->x + (layer ? 0.0f : 1.0f);
                to[1] = y + scale * c->y + (layer ? 0.0f : 1.0f);
                to[2] = layer ? 1.0f : 0.0f;
                if (++used % 6 == 0) break;
            }
    return used;
}
