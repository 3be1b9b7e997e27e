/* matrix_list.c - the file of a matrix: name = value, value, ...; and the product of its lists. See matrix.h. */
#include "matrix.h"

#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#ifndef COMBINATIONS_MAX
#define COMBINATIONS_MAX 100000
#endif
#define OPTIONS_MAX      256 /* lists of one file */
#define FAULTS_SHOWN     20

/* ---------------------------------------------------------------------- lists and maps */

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *p = (const unsigned char *)data;
    size_t i;
    for (i = 0; i < size; ++i) hash = (hash ^ p[i]) * 1099511628211u;
    return hash;
}

/* Where the key is, or the free place that it would take. */
static int32_t place_of(const map *m, uint64_t key)
{
    uint32_t mask = (uint32_t)m->room - 1, i = (uint32_t)(key ^ key >> 32) & mask;
    while (m->values[i] >= 0 && m->keys[i] != key) i = (i + 1) & mask;
    return (int32_t)i;
}

int map_find(const map *m, uint64_t key) { return m->room ? m->values[place_of(m, key)] : -1; }

static int map_grow(map *m)
{
    map more = { NULL, NULL, m->count, m->room ? 2 * m->room : 1024 };
    int32_t i;
    more.keys = (uint64_t *)malloc((size_t)more.room * sizeof *more.keys);
    more.values = (int32_t *)malloc((size_t)more.room * sizeof *more.values);
    if (!more.keys || !more.values) { free(more.keys); free(more.values); return 0; }
    for (i = 0; i < more.room; ++i) more.values[i] = -1;
    for (i = 0; i < m->room; ++i) {
        if (m->values[i] < 0) continue;
        int32_t at = place_of(&more, m->keys[i]);
        more.keys[at] = m->keys[i];
        more.values[at] = m->values[i];
    }
    map_free(m);
    *m = more;
    return 1;
}

int map_put(map *m, uint64_t key, int32_t value)
{
    int32_t at;
    if (2 * m->count >= m->room && !map_grow(m)) return 0;
    at = place_of(m, key);
    m->count += m->values[at] < 0;
    m->keys[at] = key;
    m->values[at] = value;
    return 1;
}

void map_free(map *m)
{
    free(m->keys);
    free(m->values);
    memset(m, 0, sizeof *m);
}

variant *variants_add(variants *list)
{
    if (list->count == list->room) {
        int32_t room = list->room ? 2 * list->room : 64;
        variant *more = (variant *)realloc(list->items, (size_t)room * sizeof *more);
        if (!more) return NULL;
        list->items = more;
        list->room = room;
    }
    return memset(&list->items[list->count++], 0, sizeof(variant));
}

void variants_free(variants *list)
{
    int32_t i;
    for (i = 0; i < list->count; ++i) {
        free(list->items[i].refused);
        free(list->items[i].facts);
    }
    free(list->items);
    memset(list, 0, sizeof *list);
}

/* ---------------------------------------------------------------------- reading */

/* An option, or preset, and its values. */
typedef struct axis { char *name; int line; char **values; int32_t count; } axis;

typedef struct reader {
    const char *path, *at;
    int   line, faults, failed; /* failed: out of memory */
    axis *axes;
    int   count;
} reader;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void fault(reader *r, const char *format, ...)
{
    va_list args;
    if (r->faults++ >= FAULTS_SHOWN) return;
    fprintf(stderr, "%s:%d: ", r->path, r->line);
    va_start(args, format);
    vfprintf(stderr, format, args);
    va_end(args);
    fputc('\n', stderr);
}

static void skip_blanks(reader *r) { r->at += strspn(r->at, " \t\r"); }

static void skip_separators(reader *r)
{
    for (;;) {
        r->at += strspn(r->at, " \t\r,");
        if (*r->at == '#') r->at += strcspn(r->at, "\n");
        if (*r->at != '\n') return;
        ++r->at;
        ++r->line;
    }
}

/* Length of the word here; the reader goes on behind it and the blanks that follow. */
static size_t take_word(reader *r)
{
    size_t size = strcspn(r->at, " \t\r=,#\n");
    r->at += size;
    skip_blanks(r);
    return size;
}

static int is_preset(const axis *a) { return strcmp(a->name, "preset") == 0; }

/* The name of a line: known, and not seen before. */
static void check_name(reader *r, const axis *a)
{
    int32_t nearest;
    int i;
    if (!is_preset(a) && hbil_option_find(a->name, strlen(a->name), &nearest) < 0)
        fault(r, "%.40s: no such option; did you mean %s?", a->name,
              strncmp(a->name, "preset", 6) ? hbil_option_at(nearest)->name : "preset");
    for (i = 0; &r->axes[i] < a; ++i)
        if (strcmp(r->axes[i].name, a->name) == 0)
            fault(r, "%.40s has its list in line %d already; write one list", a->name, r->axes[i].line);
}

static void check_value(reader *r, const axis *a, const char *value)
{
    hbil_config scratch;
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    memset(&scratch, 0, sizeof scratch);
    if (is_preset(a)) hbil_config_preset(value, &scratch, &diags);
    else if (hbil_option_find(a->name, strlen(a->name), NULL) >= 0) hbil_config_set(&scratch, a->name, value, &diags);
    if (diags.count) fault(r, "%s", item.text);
}

static void take_value(reader *r, axis *a)
{
    const char *from;
    size_t size;
    char **more;
    skip_blanks(r);
    from = r->at;
    size = take_word(r);
    if (size == 0) {
        fault(r, "%.40s: a value is missing", a->name);
        return;
    }
    more = (char **)realloc(a->values, (size_t)(a->count + 1) * sizeof *more);
    if (!more) { r->failed = 1; return; }
    a->values = more;
    a->values[a->count] = strndup(from, size);
    if (!a->values[a->count]) { r->failed = 1; return; }
    check_value(r, a, a->values[a->count++]);
}

/* Behind a value: steps over the comma if the list goes on. It does not where that stands before another name =, or at
 * the end of the line. */
static int more_values(reader *r)
{
    const char *comma = r->at;
    size_t size;
    int more;
    if (*comma != ',') return 0;
    ++r->at;
    skip_blanks(r);
    size = take_word(r);
    more = size && *r->at != '=';
    r->at = comma + more;
    return more;
}

/* name = value, value, ... */
static void take_axis(reader *r)
{
    axis *more = (axis *)realloc(r->axes, (size_t)(r->count + 1) * sizeof *more), *a;
    const char *from = r->at;
    size_t size = take_word(r);
    if (!more) { r->failed = 1; return; }
    r->axes = more;
    if (*r->at != '=' || !size) {
        fault(r, "%.*s: expected name = value, value, ...; values are parted by commas", size < 40 ? (int)size : 40,
              from);
        r->at += *r->at == '=';
        return;
    }
    a = (axis *)memset(&r->axes[r->count], 0, sizeof *a);
    a->line = r->line;
    a->name = strndup(from, size);
    if (!a->name) { r->failed = 1; return; }
    ++r->count;
    check_name(r, a);
    ++r->at;
    do take_value(r, a); while (!r->failed && more_values(r));
}

/* The whole file. */
static int read_axes(reader *r, const char *path)
{
    size_t size;
    char *text = read_all(path, &size);
    r->path = strcmp(path, "-") ? path : "standard input";
    r->line = 1;
    if (!text) {
        fprintf(stderr, "shadergen: cannot read %s: %s\n", r->path, strerror(errno));
        return IO;
    }
    if (strlen(text) != size) {
        fprintf(stderr, "shadergen: %s holds a zero byte: name a text file\n", r->path);
        free(text);
        return CONFIG;
    }
    r->at = text;
    for (skip_separators(r); *r->at && !r->failed; skip_separators(r)) take_axis(r);
    free(text);
    if (r->failed) return no_memory();
    if (r->faults > FAULTS_SHOWN) fprintf(stderr, "%s: and %d more faults\n", r->path, r->faults - FAULTS_SHOWN);
    return r->faults ? CONFIG : DONE;
}

static void free_axes(reader *r)
{
    int i, k;
    for (i = 0; i < r->count; ++i) {
        for (k = 0; k < r->axes[i].count; ++k) free(r->axes[i].values[k]);
        free(r->axes[i].values);
        free(r->axes[i].name);
    }
    free(r->axes);
}

/* ---------------------------------------------------------------------- the product */

/* Combination number `index`; the last list turns fastest. All values have been checked. */
static void combine(const reader *r, int32_t index, hbil_config *c)
{
    int32_t digits[OPTIONS_MAX];
    int i;
    for (i = r->count - 1; i >= 0; --i) {
        digits[i] = index % r->axes[i].count;
        index /= r->axes[i].count;
    }
    memset(c, 0, sizeof *c);
    for (i = 0; i < r->count; ++i) /* the base first, whatever its line */
        if (is_preset(&r->axes[i])) hbil_config_preset(r->axes[i].values[digits[i]], c, NULL);
    for (i = 0; i < r->count; ++i)
        if (!is_preset(&r->axes[i])) hbil_config_set(c, r->axes[i].name, r->axes[i].values[digits[i]], NULL);
}

char *reasons(const hbil_diags *diags)
{
    size_t size = 1;
    int i, n = diags->count < diags->capacity ? diags->count : diags->capacity;
    char *text;
    for (i = 0; i < n; ++i) size += strlen(diags->items[i].text) + 1;
    text = (char *)calloc(size, 1);
    for (i = 0; i < n && text; ++i) {
        if (diags->items[i].severity != HBIL_ERROR) continue;
        if (*text) strcat(text, "\n");
        strcat(text, diags->items[i].text);
    }
    return text;
}

/* What a matrix refuses of what hbil.h takes; NULL: nothing. */
static const char *unfit(const matrix_job *m, const hbil_config *c)
{
    if (c->environment == HBIL_ENVIRONMENT_HOOK)
        return "environment=hook: its text would be yours, and the hash of a config does not know it; build it by "
               "shadergen --hook FILE, or set environment=none";
    if (m->spirv && c->stage == HBIL_STAGE_FRAGMENT && c->target == HBIL_TARGET_GLES)
        return "stage=fragment: ESSL 3.00 has no SPIR-V; take --format glsl, or set stage=compute";
    return NULL;
}

/* Adds a combination, unless it equals an earlier one. */
static int add_combination(matrix_job *m, map *seen, const hbil_config *asked)
{
    hbil_diag items[32];
    hbil_diags diags = { items, 32, 0 };
    hbil_config c;
    const char *why = NULL;
    uint64_t hash = 0;
    variant *v;
    if (hbil_config_resolve(asked, &c, &diags) == HBIL_OK) {
        why = unfit(m, &c);
        hash = why ? 0 : hbil_config_hash(&c);
        if (hash && map_find(seen, hash) >= 0) {
            ++m->equal;
            return DONE;
        }
    }
    v = variants_add(&m->list);
    if (!v || (hash && !map_put(seen, hash, m->list.count - 1))) return no_memory();
    v->hash = hash;
    v->config = hash ? c : *asked;
    if (!hash) v->refused = why ? strdup(why) : reasons(&diags);
    return hash || v->refused ? DONE : no_memory();
}

static int multiply(matrix_job *m, const reader *r)
{
    map seen = { NULL, NULL, 0, 0 };
    hbil_config c;
    int64_t all = 1;
    int i, code = DONE;
    for (i = 0; i < r->count && all <= COMBINATIONS_MAX; ++i) all *= r->axes[i].count;
    if (all > COMBINATIONS_MAX) {
        fprintf(stderr, "shadergen: %s: the product of its lists exceeds %d combinations; shorten or split it\n",
                r->path, COMBINATIONS_MAX);
        return CONFIG;
    }
    m->combinations = (int32_t)all;
    progress(m, "combinations", 0, m->combinations);
    for (i = 0; i < m->combinations && code == DONE; ++i) {
        combine(r, i, &c);
        code = add_combination(m, &seen, &c);
        progress(m, "combinations", i + 1, m->combinations);
    }
    map_free(&seen);
    return code;
}

int list_read(matrix_job *m)
{
    reader r;
    int code;
    memset(&r, 0, sizeof r);
    code = read_axes(&r, m->file);
    if (code == DONE) code = multiply(m, &r);
    free_axes(&r);
    return code;
}
