/* embed.c - writes the generated regions of hbil.h and README.md from options.def, passes.def and glsl/.
 *
 *   embed [--check] [ROOT]     ROOT: the folder that holds hbil.h, default .
 *
 * A region lies between a line with `<<gen NAME` and a line with `>>gen NAME`; nothing else is touched. Files are
 * replaced whole (temporary file, then rename), and only when they differ. Exit codes: see usage(). */

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DONE = 0, USAGE = 2, IO = 3, SOURCE = 4, STALE = 5 };

#define COUNT(a)     (sizeof(a) / sizeof((a)[0]))
#define CHUNK_MAX    4000 /* bytes: C99 promises string literals of 4095 only */
#define LINE_MAX_COL 120

/* ---------------------------------------------------------------------- tables */

typedef struct row { const char *kind, *name, *def, *min, *max, *unit, *choices, *stage, *applies, *meaning, *source; } row;

#define CHOICE(n, d, c, a, m, s)          { "CHOICE", #n, d, "", "", "", c, "BAKED", a, m, s },
#define SET(n, d, c, a, m, s)             { "SET", #n, d, "", "", "", c, "BAKED", a, m, s },
#define INT(n, d, lo, hi, u, st, a, m, s)   { "INT", #n, #d, #lo, #hi, u, "", #st, a, m, s },
#define FLOAT(n, d, lo, hi, u, st, a, m, s) { "FLOAT", #n, #d, #lo, #hi, u, "", #st, a, m, s },
#define SYMBOL(n, e, m)
#define REFUSE(e, w, f)
#define MEMBER(o, m, a)
#define PRESET(n, m)
#define VALUE(p, v, s)
static row options[64] = {
#include "options.def"
};
#undef CHOICE
#undef SET
#undef INT
#undef FLOAT
#undef SYMBOL
#undef REFUSE
#undef MEMBER
#undef PRESET
#undef VALUE

/* Rows of the other kinds of both files, in order. */
typedef struct fact { const char *kind, *a, *b, *c, *d, *e, *f, *g, *h; } fact;
#define CHOICE(n, d, c, a, m, s)
#define SET(n, d, c, a, m, s)
#define INT(n, d, lo, hi, u, st, a, m, s)
#define FLOAT(n, d, lo, hi, u, st, a, m, s)
#define SYMBOL(n, e, m)           { "SYMBOL", #n, e, m, "", "", "", "", "" },
#define REFUSE(e, w, f)           { "REFUSE", e, w, f, "", "", "", "", "" },
#define MEMBER(o, m, a)           { "MEMBER", #o, #m, a, "", "", "", "", "" },
#define PRESET(n, m)              { "PRESET", #n, m, "", "", "", "", "", "" },
#define VALUE(p, v, s)            { "VALUE", #p, v, s, "", "", "", "", "" },
#define FORMAT(n, q, b)           { "FORMAT", #n, q, #b, "", "", "", "", "" },
#define TEXTURE(n, l, f, d, k, g, w, m) { "TEXTURE", #n, #l, #f, #d, w, m, #k, #g },
#define PASS(n, x, g, d, gx, gy, m) { "PASS", #n, x, #d, #gx, #gy, m, #g, "" },
#define BIND(p, t, a, w)          { "BIND", #p, #t, #a, w, "", "", "", "" },
#define UNIFORM(t, n, m)          { "UNIFORM", #t, #n, m, "", "", "", "", "" },
static const fact facts[] = {
#include "options.def"
#include "passes.def"
};

static int option_count(void)
{
    int n = 0;
    while (options[n].name) ++n;
    return n;
}

/* ---------------------------------------------------------------------- text */

typedef struct text { char *data; size_t size; } text;

static void die(int code, const char *form, ...)
{
    va_list args;
    va_start(args, form);
    fputs("embed: ", stderr);
    vfprintf(stderr, form, args);
    fputc('\n', stderr);
    va_end(args);
    exit(code);
}

static void put(text *t, const char *form, ...)
{
    va_list args, again;
    int n;
    va_start(args, form);
    va_copy(again, args);
    n = vsnprintf(NULL, 0, form, args);
    t->data = (char *)realloc(t->data, t->size + (size_t)n + 1);
    if (!t->data) die(IO, "out of memory");
    vsnprintf(t->data + t->size, (size_t)n + 1, form, again);
    t->size += (size_t)n;
    va_end(again);
    va_end(args);
}

static const char *upper(const char *s)
{
    static char ring[4][128];
    static int turn;
    char *out = ring[turn = (turn + 1) % 4];
    size_t i;
    for (i = 0; s[i] && i < sizeof ring[0] - 1; ++i) out[i] = (char)toupper((unsigned char)s[i]);
    out[i] = 0;
    return out;
}

static char *read_file(const char *root, const char *name, size_t *size)
{
    char path[1024];
    text t = { NULL, 0 };
    char block[65536];
    size_t n;
    FILE *f;
    snprintf(path, sizeof path, "%s/%s", root, name);
    f = fopen(path, "rb");
    if (!f) die(IO, "cannot read %s: is ROOT the folder that holds hbil.h?", path);
    put(&t, "%s", "");
    while ((n = fread(block, 1, sizeof block, f)) > 0) {
        t.data = (char *)realloc(t.data, t.size + n + 1);
        if (!t.data) die(IO, "out of memory");
        memcpy(t.data + t.size, block, n);
        t.size += n;
        t.data[t.size] = 0;
    }
    if (ferror(f) || fclose(f)) die(IO, "cannot read %s", path);
    if (size) *size = t.size;
    return t.data;
}

static void write_file(const char *root, const char *name, const char *data, size_t size)
{
    char path[1024], temp[1040];
    FILE *f;
    snprintf(path, sizeof path, "%s/%s", root, name);
    snprintf(temp, sizeof temp, "%s.tmp", path);
    f = fopen(temp, "wb");
    if (!f || fwrite(data, 1, size, f) != size || fclose(f) || rename(temp, path)) {
        remove(temp);
        die(IO, "cannot write %s", path);
    }
}

/* ---------------------------------------------------------------------- option regions */

/* Calls emit for every blank-separated word; index counts from 0. */
static int word_at(const char *words, int index, char out[64])
{
    int i = 0;
    while (*words) {
        size_t n = strcspn(words, " ");
        if (i++ == index && n < 64) {
            memcpy(out, words, n);
            out[n] = 0;
            return 1;
        }
        words += n;
        while (*words == ' ') ++words;
    }
    return 0;
}

static int word_index(const char *words, const char *word)
{
    char w[64];
    int i;
    for (i = 0; word_at(words, i, w); ++i)
        if (strcmp(w, word) == 0) return i;
    return -1;
}

/* Range and default as people read them: "[1, 64], default 3" or "{vulkan, gl}, default vulkan" */
static int is_symbol(const char *s, size_t len);

static const char *range_of(const row *r, char out[512])
{
    char w[64];
    int i;
    if (*r->choices) {
        strcpy(out, "{");
        for (i = 0; word_at(r->choices, i, w); ++i) sprintf(out + strlen(out), "%s%s", i ? ", " : "", w);
        strcat(out, "}");
    } else {
        snprintf(out, 512, "[%s, %s]", r->min, r->max);
    }
    return out;
}

static const char *doc_of(const row *r, char out[1024])
{
    char range[512];
    snprintf(out, 1024, "%s. %s%s%s, default %s. %s. source: %s", r->meaning, r->unit, *r->unit ? ", " : "",
             range_of(r, range), r->def, strcmp(r->stage, "EITHER") == 0 ? "baked or dynamic" : "baked", r->source);
    return out;
}

static int is_default(const char *value);

/* Words in #if expressions of the tables: all must be symbols. */
static void check_expression(const char *what, const char *e)
{
    size_t n;
    for (; *e; e += n) {
        for (n = 0; isalnum((unsigned char)e[n]) || e[n] == '_'; ++n) { }
        if (n > 1 && !is_symbol(e, n)) die(SOURCE, "%s: unknown symbol %.*s", what, (int)n, e);
        if (n == 0) n = 1;
    }
}

/* A preset's value: of a preset that exists, an option that exists. */
static void check_value(const fact *value)
{
    size_t i;
    for (i = 0; i < COUNT(facts); ++i)
        if (strcmp(facts[i].kind, "PRESET") == 0 && strcmp(facts[i].a, value->a) == 0) break;
    if (i == COUNT(facts)) die(SOURCE, "options.def: %s is a value of no preset called %s", value->b, value->a);
    is_default(value->b);
}

static void check_expressions(void)
{
    const row *r;
    size_t i;
    for (r = options; r->name; ++r) check_expression(r->name, r->applies);
    for (i = 0; i < COUNT(facts); ++i) {
        const fact *f = &facts[i];
        if (strcmp(f->kind, "SYMBOL") == 0 || strcmp(f->kind, "PASS") == 0) check_expression(f->a, f->b);
        if (strcmp(f->kind, "REFUSE") == 0) check_expression(f->b, f->a);
        if (strcmp(f->kind, "MEMBER") == 0) check_expression(f->b, f->c);
        if (strcmp(f->kind, "VALUE") == 0) check_value(f);
        if (strcmp(f->kind, "TEXTURE") == 0) check_expression(f->a, f->e);
        if (strcmp(f->kind, "BIND") == 0) check_expression(f->b, f->d);
    }
}

static void gen_enums(text *t)
{
    char w[64];
    const row *r;
    size_t f;
    int i, sep = 0;
    for (r = options; r->name; ++r) {
        if (!*r->choices) continue;
        put(t, "typedef enum hbil_%s {", r->name);
        for (i = 0; word_at(r->choices, i, w); ++i) {
            put(t, "%s%s HBIL_%s_%s", i ? "," : "", i % 4 == 0 && i ? "\n   " : "", upper(r->name), upper(w));
            if (strcmp(r->kind, "SET") == 0) put(t, " = 0x%x", 1u << i);
            else if (i == 0) put(t, " = 1");
        }
        put(t, " } hbil_%s;\n", r->name);
    }
    put(t, "typedef enum hbil_format {");
    for (f = 0; f < COUNT(facts); ++f)
        if (strcmp(facts[f].kind, "FORMAT") == 0) {
            put(t, sep ? ", HBIL_FORMAT_%s" : " HBIL_FORMAT_%s = 1", facts[f].a);
            sep = 1;
        }
    put(t, ", HBIL_FORMAT_COUNT } hbil_format;\n");
}

static void gen_config(text *t)
{
    const row *r;
    char doc[1024];
    for (r = options; r->name; ++r) {
        const char *type = strcmp(r->kind, "FLOAT") == 0 ? "float" : strcmp(r->kind, "SET") == 0 ? "uint32_t" : "int32_t";
        put(t, "    /* %s */\n    %s %s;\n", doc_of(r, doc), type, r->name);
    }
}

/* Conditions of members of sets. */
static void gen_members(text *t)
{
    size_t i, n;
    put(t, "static const struct { int32_t option; uint32_t bit; const char *applies; } hbil__members[] = {\n");
    for (i = 0; i < COUNT(facts); ++i) {
        int bit = -1;
        if (strcmp(facts[i].kind, "MEMBER")) continue;
        for (n = 0; options[n].name; ++n)
            if (strcmp(options[n].name, facts[i].a) == 0) break;
        if (options[n].name) bit = word_index(options[n].choices, facts[i].b);
        if (bit < 0) die(SOURCE, "options.def: no member %s of %s", facts[i].b, facts[i].a);
        put(t, "    { %d, 0x%x, \"%s\" }, /* %s=%s */\n", (int)n, 1u << bit, facts[i].c, facts[i].a, facts[i].b);
    }
    put(t, "};\n");
}

/* Each preset with its config text, and where each value comes from. */
static void gen_presets(text *t)
{
    size_t i, k;
    put(t, "static const struct { const char *name, *meaning, *config, *sources; } hbil__presets[] = {\n");
    for (i = 0; i < COUNT(facts); ++i) {
        int values = 0;
        if (strcmp(facts[i].kind, "PRESET")) continue;
        put(t, "    { \"%s\", \"%s\",\n      \"", facts[i].a, facts[i].b);
        for (k = 0; k < COUNT(facts); ++k)
            if (strcmp(facts[k].kind, "VALUE") == 0 && strcmp(facts[k].a, facts[i].a) == 0)
                put(t, "%s%s", values++ ? " " : "", facts[k].b);
        put(t, "\",");
        for (k = 0; k < COUNT(facts); ++k)
            if (strcmp(facts[k].kind, "VALUE") == 0 && strcmp(facts[k].a, facts[i].a) == 0)
                put(t, "\n      \"%s: %s\\n\"", facts[k].b, facts[k].c);
        put(t, "%s },\n", values ? "" : " \"\"");
    }
    put(t, "};\n");
}

static void gen_options(text *t)
{
    const row *r;
    size_t i;
    int n, bit = 0;
    char w[64], names[64];
    put(t, "static const hbil_option hbil__options[] = {\n");
    for (r = options; r->name; ++r) {
        const char *def = r->def, *min = r->min, *max = r->max;
        char number[3][24];
        if (*r->choices) {
            unsigned bits = 0;
            int set = strcmp(r->kind, "SET") == 0;
            for (n = 0; word_at(r->choices, n, w); ++n) { }
            strcpy(names, r->def);
            for (i = 0; names[i]; ++i) if (names[i] == '+') names[i] = ' ';
            for (i = 0; word_at(names, (int)i, w); ++i) {
                int k = word_index(r->choices, w);
                if (k < 0 && !(set && strcmp(w, "none") == 0)) die(SOURCE, "options.def: %s has no choice %s", r->name, w);
                if (k >= 0) bits |= set ? 1u << k : (unsigned)k + 1u;
            }
            snprintf(number[0], 24, "%u", bits);
            snprintf(number[1], 24, "%u", set ? 0u : 1u);
            snprintf(number[2], 24, "%u", set ? (1u << n) - 1u : (unsigned)n);
            def = number[0], min = number[1], max = number[2];
        }
        put(t, "    { \"%s\", \"%s\", \"%s\",\n      \"%s\",\n      \"%s\",\n      \"%s\",\n      HBIL_KIND_%s, ",
            r->name, r->unit, r->choices, r->applies, r->meaning, r->source, r->kind);
        if (strcmp(r->stage, "EITHER") == 0) put(t, "HBIL_DYNAMIC_%s, ", upper(r->name)), ++bit;
        else put(t, "0, ");
        put(t, "(uint32_t)offsetof(hbil_config, %s), %s, %s, %s },\n", r->name, min, max, def);
    }
    put(t, "};\n");
    if (bit > 32) die(SOURCE, "options.def: more than 32 options are EITHER");
    put(t, "static const struct { const char *name, *expression; } hbil__symbols[] = {\n");
    for (i = 0; i < COUNT(facts); ++i)
        if (strcmp(facts[i].kind, "SYMBOL") == 0) put(t, "    { \"%s\", \"%s\" }, /* %s */\n", facts[i].a, facts[i].b, facts[i].c);
    put(t, "};\nstatic const struct { const char *expression, *why, *fix; } hbil__refused[] = {\n");
    for (i = 0; i < COUNT(facts); ++i)
        if (strcmp(facts[i].kind, "REFUSE") == 0)
            put(t, "    { \"%s\",\n      \"%s\", \"%s\" },\n", facts[i].a, facts[i].b, facts[i].c);
    put(t, "};\n");
    gen_members(t);
    gen_presets(t);
}

/* ---------------------------------------------------------------------- pass regions */

static int fact_index(const char *kind, const char *name)
{
    size_t i;
    int n = 0;
    for (i = 0; i < COUNT(facts); ++i) {
        if (strcmp(facts[i].kind, kind)) continue;
        if (strcmp(facts[i].a, name) == 0) return n;
        ++n;
    }
    die(SOURCE, "passes.def: no %s called %s", kind, name);
    return -1;
}

/* Layers by a rule of the core's. */
static const char *layers_rule(const char *rule)
{
    return strcmp(rule, "SIDES") == 0 ? "HBIL__LAYERS_SIDES" : "HBIL__LAYERS_SIGNAL";
}

/* Texels of the grid to one of a texture; 0: it has the frame's size. */
static const char *size_rule(const char *rule)
{
    return strcmp(rule, "DRAWN") == 0 ? "HBIL__DRAWN" : strcmp(rule, "GRID_8") == 0 ? "8" : strcmp(rule, "GRID") == 0 ? "1" : "0";
}

static void gen_passes(text *t)
{
    static const struct { const char *kind, *head; } tables[] = {
        { "FORMAT", "static const struct { const char *layout; uint32_t bytes; } hbil__formats[]" },
        { "TEXTURE", "static const struct { const char *name; uint16_t life, format, dim, layers, grid; const char *wanted, *meaning; } hbil__textures[]" },
        { "PASS", "static const struct { const char *name, *exists; uint16_t grid, domain, group[2]; const char *meaning; } hbil__passes[]" },
        { "BIND", "static const struct { uint16_t pass, texture, role; const char *when; } hbil__binds[]" },
        { "UNIFORM", "static const struct { uint16_t type; const char *glsl, *name, *meaning; } hbil__uniforms[]" } };
    size_t k, i;
    for (k = 0; k < COUNT(tables); ++k) {
        put(t, "%s = {\n", tables[k].head);
        for (i = 0; i < COUNT(facts); ++i) {
            const fact *f = &facts[i];
            if (strcmp(f->kind, tables[k].kind)) continue;
            if (k == 0) put(t, "    { \"%s\", %s },\n", f->b, f->c);
            if (k == 1) put(t, "    { \"%s\", HBIL_LIFE_%s, HBIL_FORMAT_%s, HBIL_DIM_%s, %s, %s, \"%s\",\n      \"%s\" },\n", f->a, f->b,
                            f->c, f->d, isdigit((unsigned char)*f->g) ? f->g : layers_rule(f->g), size_rule(f->h), f->e, f->f);
            if (k == 2) put(t, "    { \"%s\", \"%s\", HBIL_GRID_%s, %d, { %s, %s },\n      \"%s\" },\n", f->a, f->b, f->g,
                            fact_index("TEXTURE", f->c), f->d, f->e, f->f);
            if (k == 3) put(t, "    { %d, %d, HBIL_ROLE_%s, \"%s\" }, /* %s %s */\n", fact_index("PASS", f->a),
                            fact_index("TEXTURE", f->b), f->c, f->d, f->a, f->b);
            if (k == 4) put(t, "    { HBIL_TYPE_%s, \"%s\", \"%s\",\n      \"%s\" },\n", upper(f->a), f->a, f->b, f->c);
        }
        put(t, "};\n");
    }
}

/* ---------------------------------------------------------------------- GLSL region */

typedef struct chunk { char name[64]; char file[32]; const char *body; size_t size; int line; } chunk;
static chunk chunks[256];
static int   chunk_count;

/* Chunks that any pass may use; then one file per pass, in plan order. */
static const char *const shared_files[] = { "triangle", "common", "environment", "lines", "levels", "slice", "horizon", "bitmask", "hbao", "grid", "signal", "last" };

static int is_shared(const char *file)
{
    size_t i;
    for (i = 0; i < COUNT(shared_files); ++i)
        if (strcmp(shared_files[i], file) == 0) return 1;
    return 0;
}

/* Can a line of `file` name that chunk? */
static int chunk_find(const char *file, const char *name, size_t len)
{
    int i;
    for (i = 0; i < chunk_count; ++i)
        if (strlen(chunks[i].name) == len && memcmp(chunks[i].name, name, len) == 0 &&
            (strcmp(chunks[i].file, file) == 0 || is_shared(chunks[i].file))) return i;
    return -1;
}

/* HBIL_<OPTION>_<CHOICE or whole number>, or HBIL_<SYMBOL>? */
static int is_symbol(const char *s, size_t len)
{
    const row *r;
    char w[64], full[160];
    size_t k;
    int i;
    for (k = 0; k < COUNT(facts); ++k)
        if (strcmp(facts[k].kind, "SYMBOL") == 0 && strlen(facts[k].a) + 5 == len && memcmp(facts[k].a, s + 5, len - 5) == 0) return 1;
    for (r = options; r->name; ++r) {
        size_t n = (size_t)snprintf(full, sizeof full, "HBIL_%s_", upper(r->name));
        if (len <= n || memcmp(full, s, n)) continue;
        for (i = 0; word_at(r->choices, i, w); ++i)
            if (strlen(w) == len - n && memcmp(upper(w), s + n, len - n) == 0) return 1;
        if (!*r->choices && strspn(s + n, "0123456789") >= len - n) return 1;
    }
    return 0;
}

static int is_name(const char *s, size_t len)
{
    const row *r;
    size_t i;
    for (r = options; r->name; ++r)
        if (strlen(r->name) + 5 == len && memcmp(s, "HBIL_", 5) == 0 && memcmp(upper(r->name), s + 5, len - 5) == 0) return 1;
    for (i = 0; i < COUNT(facts); ++i)
        if (strcmp(facts[i].kind, "UNIFORM") == 0 && strlen(facts[i].b) == len && memcmp(facts[i].b, s, len) == 0) return 1;
    return 0;
}

/* Every hbil_ or HBIL_ word of a line must be known: a symbol in #if, else a chunk of this file or of a shared one,
 * a constant or a uniform. hbil_far_hook is the engine's. */
static void check_words(const char *file, int line, const char *s, size_t len)
{
    int directive = s[strspn(s, " ")] == '#';
    size_t i = 0, n;
    const char *comment = strstr(s, "//");
    if (comment && comment < s + len) len = (size_t)(comment - s);
    while (i < len) {
        if (!isalpha((unsigned char)s[i]) && s[i] != '_') { ++i; continue; }
        for (n = 0; i + n < len && (isalnum((unsigned char)s[i + n]) || s[i + n] == '_'); ++n) { }
        if (n > 5 && (memcmp(s + i, "hbil_", 5) == 0 || memcmp(s + i, "HBIL_", 5) == 0)) {
            int ok = directive ? is_symbol(s + i, n) : chunk_find(file, s + i, n) >= 0 || is_name(s + i, n) ||
                (n == 13 && memcmp(s + i, "hbil_far_hook", n) == 0);
            if (!ok) die(SOURCE, "%s.glsl:%d: unknown name %.*s", file, line, (int)n, s + i);
        }
        i += n;
    }
}

static void check_chunk(const chunk *c)
{
    const char *s = c->body, *end = c->body + c->size;
    int line = c->line, depth = 0;
    if (c->size > CHUNK_MAX) die(SOURCE, "%s.glsl:%d: chunk %s has %d bytes, at most %d: split it", c->file, line, c->name, (int)c->size, CHUNK_MAX);
    for (; s < end; ++line) {
        const char *nl = (const char *)memchr(s, '\n', (size_t)(end - s));
        size_t i, len = nl ? (size_t)(nl - s) : (size_t)(end - s);
        if (len > LINE_MAX_COL) die(SOURCE, "%s.glsl:%d: line over %d columns", c->file, line, LINE_MAX_COL);
        if (len && s[len - 1] == ' ') die(SOURCE, "%s.glsl:%d: trailing blank", c->file, line);
        for (i = 0; i < len; ++i)
            if (s[i] < 32 || s[i] > 126) die(SOURCE, "%s.glsl:%d: only printable ASCII and LF, no tabs", c->file, line);
        if (len > 2 && strncmp(s, "#if", 3) == 0) ++depth;
        if (len > 5 && strncmp(s, "#endif", 6) == 0) --depth;
        if (depth < 0) die(SOURCE, "%s.glsl:%d: #endif without #if in this chunk", c->file, line);
        check_words(c->file, line, s, len);
        s += len + 1;
    }
    if (depth) die(SOURCE, "%s.glsl: chunk %s: #if without #endif", c->file, c->name);
}

static char *glsl_files[32]; /* the chunks point into them */
static int   glsl_file_count;

static void load_glsl(const char *root, const char *file)
{
    static const char mark[] = "//@ chunk ";
    char path[128];
    char *s;
    int line = 1;
    chunk *open = NULL;
    snprintf(path, sizeof path, "shadergen/glsl/%s.glsl", file);
    if (glsl_file_count == (int)COUNT(glsl_files)) die(SOURCE, "too many GLSL files: raise the size of glsl_files");
    s = glsl_files[glsl_file_count++] = read_file(root, path, NULL);
    for (; *s; ++line) {
        size_t len = strcspn(s, "\n");
        if (strncmp(s, mark, sizeof mark - 1) == 0) {
            size_t n = len - (sizeof mark - 1);
            if (chunk_count == (int)COUNT(chunks) || n >= sizeof open->name) die(SOURCE, "%s:%d: too many chunks or too long a name", path, line);
            open = &chunks[chunk_count];
            memcpy(open->name, s + sizeof mark - 1, n);
            strcpy(open->file, file);
            if (chunk_find(file, open->name, n) >= 0) die(SOURCE, "%s:%d: second chunk called %s", path, line, open->name);
            if (is_name(open->name, n)) die(SOURCE, "%s:%d: %s is the name of an option or uniform", path, line, open->name);
            ++chunk_count;
            open->body = s + len + 1;
            open->line = line + 1;
        } else if (open) {
            open->size = (size_t)(s + len + (s[len] != 0) - open->body);
        } else if (len && strncmp(s, "//", 2)) {
            die(SOURCE, "%s:%d: text before the first `%sNAME` line", path, line, mark);
        }
        s += len + (s[len] != 0);
    }
}

static void load_all_glsl(const char *root)
{
    size_t i;
    int c;
    for (i = 0; i < COUNT(shared_files); ++i) load_glsl(root, shared_files[i]);
    for (i = 0; i < COUNT(facts); ++i)
        if (strcmp(facts[i].kind, "PASS") == 0) load_glsl(root, facts[i].a);
    for (c = 0; c < chunk_count; ++c) {
        while (chunks[c].size > 1 && chunks[c].body[chunks[c].size - 2] == '\n') --chunks[c].size;
        check_chunk(&chunks[c]);
    }
}

static void gen_glsl(text *t)
{
    int c;
    for (c = 0; c < chunk_count; ++c) {
        const char *s = chunks[c].body, *end = s + chunks[c].size;
        put(t, "static const char hbil__glsl_%s_%s[] =", chunks[c].file, chunks[c].name);
        while (s < end) {
            size_t i, len = strcspn(s, "\n");
            put(t, "\n\"");
            for (i = 0; i < len; ++i) put(t, s[i] == '"' || s[i] == '\\' ? "\\%c" : "%c", s[i]);
            put(t, "\\n\"");
            s += len + 1;
        }
        put(t, ";\n");
    }
    put(t, "static const struct { const char *name, *file, *text; } hbil__chunks[] = {\n");
    for (c = 0; c < chunk_count; ++c)
        put(t, "    { \"%s\", \"%s\", hbil__glsl_%s_%s },\n", chunks[c].name, chunks[c].file, chunks[c].file, chunks[c].name);
    put(t, "};\n");
}

/* ---------------------------------------------------------------------- README regions */

static void gen_readme_options(text *t)
{
    const row *r;
    char range[512];
    put(t, "| option | meaning | unit | range | default | baked or dynamic |\n|---|---|---|---|---|---|\n");
    for (r = options; r->name; ++r)
        put(t, "| `%s` | %s | %s | %s | %s | %s |\n", r->name, r->meaning, r->unit, range_of(r, range), r->def,
            strcmp(r->stage, "EITHER") == 0 ? "either" : "baked");
}

/* Is "option=value" the option's default? */
static int is_default(const char *value)
{
    const row *r;
    size_t n = strcspn(value, "=");
    for (r = options; r->name; ++r)
        if (strlen(r->name) == n && memcmp(r->name, value, n) == 0) return strcmp(r->def, value + n + 1) == 0;
    die(SOURCE, "options.def: preset with unknown option: %s", value);
    return 0;
}

static void gen_readme_presets(text *t)
{
    size_t i, k;
    put(t, "| preset | for | values |\n|---|---|---|\n");
    for (i = 0; i < COUNT(facts); ++i) {
        int values = 0;
        if (strcmp(facts[i].kind, "PRESET")) continue;
        put(t, "| `%s` | %s | ", facts[i].a, facts[i].b);
        for (k = 0; k < COUNT(facts); ++k)
            if (strcmp(facts[k].kind, "VALUE") == 0 && strcmp(facts[k].a, facts[i].a) == 0 && !is_default(facts[k].b))
                put(t, "%s`%s`", values++ ? " " : "", facts[k].b);
        put(t, values ? " |\n" : "`{0}` |\n");
    }
}

/* ---------------------------------------------------------------------- splice */

static const struct { const char *name; void (*make)(text *); } regions[] = {
    { "enums", gen_enums }, { "config", gen_config }, { "options", gen_options }, { "passes", gen_passes },
    { "glsl", gen_glsl }, { "readme-options", gen_readme_options }, { "readme-presets", gen_readme_presets } };

/* Copy `in`, replacing what lies between the marker lines of each region that occurs in it. */
static text splice(const char *file, const char *in, unsigned *seen)
{
    text out = { NULL, 0 };
    const char *s = in;
    put(&out, "%s", "");
    while (*s) {
        size_t k, len = strcspn(s, "\n") + 1;
        const char *mark = strstr(s, "<<gen ");
        put(&out, "%.*s", (int)len, s);
        if (mark && mark < s + len) {
            const char *name = mark + 6, *close;
            char end[64];
            size_t n = strcspn(name, " \n");
            for (k = 0; k < COUNT(regions); ++k)
                if (strlen(regions[k].name) == n && memcmp(regions[k].name, name, n) == 0) break;
            if (k == COUNT(regions)) die(SOURCE, "%s: unknown region %.*s", file, (int)n, name);
            if (*seen & 1u << k) die(SOURCE, "%s: region %s stands twice", file, regions[k].name);
            *seen |= 1u << k;
            snprintf(end, sizeof end, ">>gen %s", regions[k].name);
            close = strstr(s, end);
            if (!close) die(SOURCE, "%s: region %s is not closed by >>gen %s", file, regions[k].name, regions[k].name);
            regions[k].make(&out);
            while (close > s && close[-1] != '\n') --close;
            s = close;
            len = strcspn(s, "\n") + 1;
            put(&out, "%.*s", (int)len, s);
        }
        s += len - (s[len - 1] == 0);
    }
    return out;
}

static void add_dynamic_row(void)
{
    static char words[1024];
    row *r;
    for (r = options; r->name; ++r)
        if (strcmp(r->stage, "EITHER") == 0) sprintf(words + strlen(words), "%s%s", *words ? " " : "", r->name);
    r->kind = "SET", r->name = "dynamic", r->def = "none", r->min = r->max = r->unit = "", r->choices = words;
    r->stage = "BAKED", r->applies = "";
    r->meaning = "options kept as uniforms that may change from frame to frame; all others are literals in the text";
    r->source = "project";
}

static int usage(FILE *f, int code)
{
    fputs("usage: embed [--check] [ROOT]\n"
          "Writes the generated regions of ROOT/hbil.h and ROOT/README.md from ROOT/shadergen; ROOT is . by default.\n"
          "  --check   write nothing, exit 5 if a file is out of step\n"
          "exit: 0 done, 2 usage, 3 cannot read or write, 4 fault in a .glsl or .def file, 5 out of step\n", f);
    return code;
}

int main(int argc, char **argv)
{
    static const char *const targets[] = { "hbil.h", "README.md" };
    const char *root = NULL;
    int i, check = 0, stale = 0;
    unsigned seen = 0;
    size_t f;
    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return usage(stdout, DONE);
        if (strcmp(argv[i], "--check") == 0) check = 1;
        else if (argv[i][0] == '-' || root) return usage(stderr, USAGE);
        else root = argv[i];
    }
    if (!root) root = ".";
    if (option_count() + 1 >= (int)COUNT(options)) die(SOURCE, "options.def: too many options");
    add_dynamic_row();
    check_expressions();
    load_all_glsl(root);
    for (f = 0; f < COUNT(targets); ++f) {
        size_t size;
        char *in = read_file(root, targets[f], &size);
        text out = splice(targets[f], in, &seen);
        if (out.size != size || memcmp(out.data, in, size)) {
            stale = 1;
            if (check) fprintf(stderr, "embed: %s is out of step: run `cmake --build build --target embed`\n", targets[f]);
            else write_file(root, targets[f], out.data, out.size), printf("embed: wrote %s\n", targets[f]);
        }
        free(in);
        free(out.data);
    }
    for (f = 0; f < COUNT(regions); ++f)
        if (!(seen & 1u << f)) die(SOURCE, "no file has the region %s", regions[f].name);
    while (glsl_file_count) free(glsl_files[--glsl_file_count]);
    return check && stale ? STALE : DONE;
}
