/* grid.c - lists and ranges of options. */
#include "grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../hbil.h"
#include "image.h"

static int add_value(grid_axis *a, const char *text, size_t length, char *error, size_t error_size)
{
    if (length == 0 || length >= sizeof a->values[0])
        return frame_error(error, error_size, "%s: a value of %d characters. Write NAME=VALUE,VALUE or NAME=A..B*K",
                           a->name, (int)length);
    if (a->count == GRID_VALUES_MAX)
        return frame_error(error, error_size, "%s: more than %d values. Use a wider step", a->name, GRID_VALUES_MAX);
    memcpy(a->values[a->count], text, length);
    a->values[a->count++][length] = 0;
    return 1;
}

/* "A..B", "A..B*K" or "A..B+K". */
static int add_range(grid_axis *a, const char *text, char *error, size_t error_size)
{
    const char *dots = strstr(text, "..");
    char       *end, value[48];
    double      first = strtod(text, &end), last, step = 1.0, v;
    char        kind = '+';
    const int   starts = end == dots || end == dots + 1; /* of "1..8" strtod takes the first dot along */
    int         i;

    last = strtod(dots + 2, &end);
    if (*end == '*' || *end == '+') {
        kind = *end;
        step = strtod(end + 1, &end);
    }
    if (!starts || *end || !(first <= last) || !(kind == '*' ? step > 1.0 && first > 0.0 : step > 0.0))
        return frame_error(error, error_size,
                           "%s=%s: a range is A..B*K with K above 1, A..B+K with K above 0, or A..B, "
                           "and A is the smaller",
                           a->name, text);
    for (i = 0; i <= GRID_VALUES_MAX; i++) {
        v = kind == '*' ? first * pow(step, i) : first + step * i;
        if (v > last * (1.0 + 1e-9)) break;
        snprintf(value, sizeof value, "%.9g", v);
        if (!add_value(a, value, strlen(value), error, error_size)) return 0;
    }
    return 1;
}

static int add_values(grid_axis *a, char *list, char *error, size_t error_size)
{
    char *item, *next;

    for (item = list; item; item = next) {
        next = strchr(item, ',');
        if (next) *next++ = 0;
        if (!(strstr(item, "..") ? add_range(a, item, error, error_size)
                                 : add_value(a, item, strlen(item), error, error_size))) return 0;
    }
    return 1;
}

static int add_axis(grid *g, const char *name, char *list, char *error, size_t error_size)
{
    grid_axis *a = &g->axes[g->count];
    int32_t    near;
    int        i;

    if (strcmp(name, "preset") != 0 && hbil_option_find(name, strlen(name), &near) < 0)
        return frame_error(error, error_size, "%s: no such option; %s is the nearest, and hbil-frame --help lists all",
                           name, hbil_option_at(near)->name);
    for (i = 0; i < g->count; i++)
        if (strcmp(g->axes[i].name, name) == 0)
            return frame_error(error, error_size, "%s: is there twice. Join its values with commas", name);
    if (g->count == GRID_AXES_MAX) return frame_error(error, error_size, "more than %d options", GRID_AXES_MAX);
    memset(a, 0, sizeof *a);
    snprintf(a->name, sizeof a->name, "%s", name);
    g->count++;
    return add_values(a, list, error, error_size);
}

int grid_parse(grid *g, const char *text, char *error, size_t error_size)
{
    char *copy = malloc(strlen(text) + 1), *word, *next, *equals, *comment;
    int   ok = copy != NULL;

    memset(g, 0, sizeof *g);
    if (!ok) return frame_error(error, error_size, "out of memory");
    strcpy(copy, text);
    while ((comment = strchr(copy, '#')) != NULL) memset(comment, ' ', strcspn(comment, "\n"));
    for (word = copy + strspn(copy, " \t\r\n"); ok && *word; word = next) {
        next = word + strcspn(word, " \t\r\n");
        if (*next) *next++ = 0;
        next += strspn(next, " \t\r\n");
        equals = strchr(word, '=');
        if (equals) *equals = 0;
        ok = equals ? add_axis(g, word, equals + 1, error, error_size)
                    : frame_error(error, error_size, "%s: without =. Write NAME=VALUE,VALUE or NAME=A..B*K", word);
    }
    free(copy);
    return ok;
}

uint64_t grid_size(const grid *g)
{
    uint64_t size = 1;
    int      i;

    for (i = 0; i < g->count; i++) {
        size *= (uint64_t)g->axes[i].count;
        if (size > 1000000000u) return 0;
    }
    return size;
}

int grid_text(const grid *g, uint64_t index, char *text, size_t size)
{
    size_t used = 0;
    int    i, pass, wrote, value[GRID_AXES_MAX];

    for (i = g->count - 1; i >= 0; i--) { /* the last axis turns fastest */
        value[i] = (int)(index % (uint64_t)g->axes[i].count);
        index /= (uint64_t)g->axes[i].count;
    }
    if (size > 0) text[0] = 0;
    for (pass = 0; pass < 2; pass++)
        for (i = 0; i < g->count; i++) {
            const grid_axis *a = &g->axes[i];

            if ((strcmp(a->name, "preset") == 0) != (pass == 0)) continue;
            wrote = snprintf(text + used, size - used, "%s%s=%s", used ? " " : "", a->name, a->values[value[i]]);
            if (wrote < 0 || (size_t)wrote >= size - used) return 0;
            used += (size_t)wrote;
        }
    return 1;
}

uint64_t grid_random(uint64_t *state)
{
    uint64_t z = *state += 0x9e3779b97f4a7c15u;

    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/* Knuth's selection sampling: each index is taken with the odds of what is still wanted among what is left. */
int grid_choose(uint64_t total, uint64_t count, uint64_t seed, uint64_t *out)
{
    uint64_t i, taken = 0, state = seed;

    for (i = 0; i < total && taken < count; i++)
        if (grid_random(&state) % (total - i) < count - taken) out[taken++] = i;
    return taken == count;
}
