/* json.c - JSON files, with errors that name the file, the member and the fix. */
#include "json.h"

#include <math.h>
#include <stdlib.h>

#include "image.h"

cJSON *json_read(const char *path, size_t most, const char *what, char *error, size_t error_size)
{
    char  *text = text_read(path, most, what, error, error_size);
    cJSON *root = text ? cJSON_ParseWithOpts(text, NULL, 1) : NULL; /* nothing may follow the value */

    if (text && !root) { /* the parser points to the fault: say its line */
        const char *at = cJSON_GetErrorPtr(), *p;
        int line = 1;
        for (p = text; at && p < at; p++) line += *p == '\n';
        frame_error(error, error_size, "%s: is not valid JSON (line %d). Mend it, or give %s", path, line, what);
    }
    free(text);
    return root;
}

int json_number(const cJSON *root, const char *name, double *out, const char *path, char *error, size_t error_size)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, name);

    if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
        return frame_error(error, error_size, "%s: \"%s\" is %s. It must be a finite number", path, name,
                           item ? "not one" : "missing");
    *out = item->valuedouble;
    return 1;
}

int json_numbers(const cJSON *array, int count, double *out)
{
    const cJSON *item;
    int          n = 0;

    if (!cJSON_IsArray(array)) return 0;
    cJSON_ArrayForEach(item, array) {
        if (n == count || !cJSON_IsNumber(item) || !isfinite(item->valuedouble)) return 0;
        out[n++] = item->valuedouble;
    }
    return n == count;
}
