/* gpu.c - which image of the G-buffer goes into which input of a plan. */
#include "gpu.h"

#include <string.h>

int gpu_input_of(const char *plan_texture)
{
    static const struct { const char *input; int target; } table[] = {
        {"depth", TARGET_DEPTH},       {"normal", TARGET_NORMAL}, {"albedo", TARGET_ALBEDO}, {"direct", TARGET_DIRECT},
        {"radiance", TARGET_DIRECT}, /* diffuse surfaces, and what glows: what leaves them is what we see */
        {"motion", TARGET_MOTION},     {"f0", TARGET_SPECULAR},   {"roughness", TARGET_ROUGHNESS},
    };
    size_t i;

    for (i = 0; i < sizeof table / sizeof *table; i++)
        if (strcmp(plan_texture, table[i].input) == 0) return table[i].target;
    return -1;
}
