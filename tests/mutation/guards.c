/* guards.c - finds guards by their form, not by a list: a new one is found by itself.
 *
 *   clamp    clamp(x, a, b)                       -> x
 *   max min  of x and a constant                  -> x;  of two values: each alone. Largest channels and the like are no guards
 *   if       (condition) leave: continue, return, break  -> never; and each of its parts alone
 *   when     other conditions against sky, size, zero or something tiny -> always; each part of an && alone
 *   nan      !(a < b)                             -> a >= b: what NaN makes of a test
 *   mix      mix(constant, x, greaterThan(..))    -> x
 *   finite   hbil_finite(x)                       -> x
 *   floor    int(floor(x)), ivec2(floor(x))       -> int(x), ivec2(x)
 *   epsilon  HBIL_BIAS, HBIL_PULL, HBIL_LEAST_NY, HBIL_STRIDE in hbil_go, 1e-3 and smaller -> 0.0; 1.001 -> 1.0
 */
#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "guards.h"

/* A chunk's text, and the same with its comments blanked, of equal length. */
typedef struct source {
    guard_list *list;
    const char *file, *chunk, *text;
    char       *code;
    size_t      size;
    int         line; /* of its first line */
} source;

typedef struct span { size_t from, to; } span;

static int is_word(char c) { return isalnum((unsigned char)c) || c == '_'; }

static int starts(const source *s, size_t i, const char *word)
{
    const size_t n = strlen(word);
    return strncmp(s->code + i, word, n) == 0 && !is_word(s->code[i + n]) && (i == 0 || !is_word(s->code[i - 1]));
}

static int same(const source *s, span a, const char *text)
{
    return a.to - a.from == strlen(text) && strncmp(s->code + a.from, text, a.to - a.from) == 0;
}

static span trim(const source *s, span a)
{
    while (a.from < a.to && isspace((unsigned char)s->code[a.from])) ++a.from;
    while (a.to > a.from && isspace((unsigned char)s->code[a.to - 1])) --a.to;
    return a;
}

/* From an opening bracket to behind its closing one. */
static size_t behind(const source *s, size_t i)
{
    int depth = 0;
    for (; i < s->size; ++i) {
        depth += strchr("([{", s->code[i]) ? 1 : strchr(")]}", s->code[i]) ? -1 : 0;
        if (depth == 0) return i + 1;
    }
    return s->size;
}

/* Parts of [from, to) between a separator of one or two characters, outside brackets. Returns their number. */
static int split(const source *s, span a, const char *separator, span out[8])
{
    const size_t n = strlen(separator);
    int count = 0;
    size_t i, from = a.from;
    for (i = a.from; i < a.to; ++i) {
        if (strchr("([{", s->code[i])) i = behind(s, i) - 1;
        else if (strncmp(s->code + i, separator, n) == 0 && count < 7) {
            out[count++] = trim(s, (span){from, i});
            from = i + n;
            i += n - 1;
        }
    }
    out[count++] = trim(s, (span){from, a.to});
    return count;
}

/* Numbers, constants in capitals and vectors of them. */
static int is_constant(const source *s, span a)
{
    size_t i = a.from;
    while (i < a.to) {
        size_t n = i;
        while (n < a.to && is_word(s->code[n])) ++n;
        if (n == i) {
            ++i;
            continue;
        }
        if (isalpha((unsigned char)s->code[i]) && !(i > a.from && s->code[i - 1] == '.') && strncmp(s->code + i, "HBIL_", 5)
            && !same(s, (span){i, n}, "vec2") && !same(s, (span){i, n}, "vec3") && !same(s, (span){i, n}, "vec4")
            && !same(s, (span){i, n}, "ivec2"))
            return 0;
        i = n;
    }
    return 1;
}

/* ---------------------------------------------------------------------------------------------------------------- the list */

static void fold(char *to, size_t room, const char *from, size_t size)
{
    size_t i, n = 0;
    for (i = 0; i < size && n + 2 < room; ++i) {
        const int blank = isspace((unsigned char)from[i]) != 0;
        if (!blank) to[n++] = from[i];
        else if (n && to[n - 1] != ' ') to[n++] = ' ';
    }
    to[n] = 0;
}

static int number_of(const source *s, const char *kind)
{
    char start[96];
    int i, n = 1;
    snprintf(start, sizeof start, "%s:%s:%s#", s->file, s->chunk, kind);
    for (i = 0; i < s->list->count; ++i) n += strncmp(s->list->at[i].id, start, strlen(start)) == 0;
    return n;
}

static void *grown(void *p, size_t size)
{
    p = realloc(p, size);
    if (p) return p;
    fprintf(stderr, "hbil-mutate: out of memory\n");
    exit(3);
}

/* A guard: [from, to) becomes the text `put`. */
static void add(const source *s, const char *kind, span a, const char *put)
{
    size_t from = a.from, to = a.to, i;
    guard *g;
    while (from > 0 && s->text[from - 1] != '\n') --from;
    while (to < s->size && s->text[to] != '\n') ++to;
    if (s->list->count == s->list->room) {
        s->list->room = 2 * s->list->room + 64;
        s->list->at = (guard *)grown(s->list->at, (size_t)s->list->room * sizeof *s->list->at);
    }
    g = &s->list->at[s->list->count];
    memset(g, 0, sizeof *g);
    snprintf(g->id, sizeof g->id, "%s:%s:%s#%d", s->file, s->chunk, kind, number_of(s, kind));
    snprintf(g->file, sizeof g->file, "%s", s->file);
    snprintf(g->chunk, sizeof g->chunk, "%s", s->chunk);
    g->line = s->line;
    for (i = 0; i < a.from; ++i) g->line += s->text[i] == '\n';
    fold(g->code, sizeof g->code, s->text + a.from, a.to - a.from);
    fold(g->without, sizeof g->without, put, strlen(put));
    g->find = (char *)grown(NULL, to - from + 1);
    g->put = (char *)grown(NULL, to - from + strlen(put) + 1);
    memcpy(g->find, s->text + from, to - from);
    g->find[to - from] = 0;
    sprintf(g->put, "%.*s%s%.*s", (int)(a.from - from), s->text + from, put, (int)(to - a.to), s->text + a.to);
    for (i = 0; i < (size_t)s->list->count; ++i) /* the same line twice in a chunk: one guard, see guard_remove */
        if (strcmp(s->list->at[i].chunk, g->chunk) == 0 && strcmp(s->list->at[i].file, g->file) == 0
            && strcmp(s->list->at[i].find, g->find) == 0 && strcmp(s->list->at[i].put, g->put) == 0) {
            free(g->find);
            free(g->put);
            return;
        }
    ++s->list->count;
}

/* The part `keep` of it stays. */
static void add_keep(const source *s, const char *kind, span a, span keep)
{
    char put[1024];
    size_t i, plain = 1;
    for (i = keep.from; i < keep.to; ++i) {
        if (strchr("([", s->code[i])) i = behind(s, i) - 1;
        else plain &= is_word(s->code[i]) || s->code[i] == '.';
    }
    snprintf(put, sizeof put, plain ? "%.*s" : "(%.*s)", (int)(keep.to - keep.from), s->text + keep.from);
    add(s, kind, a, put);
}

/* --------------------------------------------------------------------------------------------------------- calls of functions */

/* Largest or smallest of the channels of one vector, or of calls of one function: a value, not a guard. Constants among them are
 * looked at on their own. */
static int is_reduction(const source *s, span a)
{
    span part[8];
    size_t n;
    int i, count;
    a = trim(s, a);
    if (is_constant(s, a)) {
        for (n = a.from; n < a.to; ++n)
            if (s->code[n] == '.' && a.to - n == 2) return 1; /* HBIL_SIZE.x */
        return 1;
    }
    if (starts(s, a.from, "max") || starts(s, a.from, "min") || starts(s, a.from, "abs")) {
        const size_t open = a.from + 3;
        if (behind(s, open) != a.to) return 0;
        count = split(s, (span){open + 1, a.to - 1}, ",", part);
        for (i = 0; i < count; ++i)
            if (!is_reduction(s, part[i])) return 0;
        return 1;
    }
    if (starts(s, a.from, "hbil_load_depth")) return 1;
    for (n = a.from; n < a.to; ++n)
        if (!is_word(s->code[n]) && s->code[n] != '.') return 0;
    return a.to - a.from > 2 && s->code[a.to - 2] == '.' && strchr("xyzwrgba", s->code[a.to - 1]) != NULL;
}

static void find_call(const source *s, size_t i)
{
    static const char *const names[] = { "clamp", "max", "min", "mix", "hbil_finite", "int", "ivec2" };
    span part[8], all;
    size_t k, open;
    int count;
    for (k = 0; k < sizeof names / sizeof *names && !starts(s, i, names[k]); ++k) { }
    if (k == sizeof names / sizeof *names) return;
    open = i + strlen(names[k]);
    if (s->code[open] != '(') return;
    all = (span){i, behind(s, open)};
    count = split(s, (span){open + 1, all.to - 1}, ",", part);
    if (k == 0 && count == 3) add_keep(s, "clamp", all, part[0]);
    else if (k == 1 || k == 2) {
        const int first = is_constant(s, part[0]), second = is_constant(s, part[1]);
        if (first && second) return;
        if (!first && !second && is_reduction(s, all)) return;
        if (!first) add_keep(s, names[k], all, part[0]);
        if (!second) add_keep(s, names[k], all, part[1]);
    } else if (k == 3 && count == 3 && is_constant(s, part[0]) && !is_constant(s, part[1])
               && (starts(s, part[2].from, "greaterThan") || starts(s, part[2].from, "greaterThanEqual")))
        add_keep(s, "mix", all, part[1]);
    else if (k == 4 && strcmp(s->chunk, "hbil_finite")) add_keep(s, "finite", all, part[0]);
    else if (k >= 5 && starts(s, part[0].from, "floor")) {
        const size_t inner = part[0].from + 5;
        if (behind(s, inner) == part[0].to) add_keep(s, "floor", part[0], (span){inner + 1, part[0].to - 1});
    }
}

/* --------------------------------------------------------------------------------------------------------------- conditions */

/* Against the sky, the screen, zero or something tiny or huge; a sign, x < 0.0, a bit or a turn is a choice. */
static int is_guardy(const source *s, span a)
{
    static const char *const words[] = { "HBIL_SKY", "HBIL_SIZE", "HBIL_NOWHERE", "HBIL_RESET", "HBIL_LEAST", "> 0.0", ">= 0", "> 0",
        "!= 0", "== 0", "<= 0", "lessThan", "greaterThan", "1e", "hbil_has_pushed", "hbil_levels" };
    char text[512];
    size_t k;
    snprintf(text, sizeof text, "%.*s", (int)(a.to - a.from), s->code + a.from);
    if (strstr(text, " & ") || strstr(text, " % ") || strncmp(text, "i == ", 5) == 0) return 0; /* bits, turns */
    for (k = 0; k < sizeof words / sizeof *words; ++k)
        if (strstr(text, words[k])) return 1;
    return 0;
}

static span unwrap(const source *s, span a)
{
    while (a.to > a.from && s->code[a.from] == '(' && behind(s, a.from) == a.to) a = trim(s, (span){a.from + 1, a.to - 1});
    return a;
}

static int holds(const source *s, span a, const char *word)
{
    const char *at = strstr(s->code + a.from, word);
    return at != NULL && at < s->code + a.to;
}

/* Every part of || never, every part of && always; whole: what becomes of a condition without parts, NULL: nothing. */
static void find_parts(const source *s, const char *kind, span a, const char *whole)
{
    span part[8];
    int i, count;
    a = unwrap(s, trim(s, a));
    count = split(s, a, "||", part);
    if (count > 1) {
        for (i = 0; i < count; ++i) {
            add(s, kind, part[i], "false");
            find_parts(s, kind, part[i], NULL);
        }
        return;
    }
    count = split(s, a, "&&", part);
    if (whole && holds(s, a, "hbil_go(")) { /* which moves on: it is still called */
        char put[256];
        snprintf(put, sizeof put, "%.*s && false", (int)(a.to - a.from), s->text + a.from);
        add(s, kind, a, put);
    } else if (whole) add(s, kind, a, whole);
    if (count > 1)
        for (i = 0; i < count; ++i) {
            add(s, kind, part[i], "true");
            find_parts(s, kind, part[i], NULL);
        }
    else if (s->code[a.from] == '!' && s->code[a.from + 1] == '(') find_parts(s, kind, (span){a.from + 1, a.to}, NULL);
}

/* Does a statement leave: continue, break or return, also as the last one of a block? */
static int leaves(const source *s, size_t i)
{
    size_t end;
    while (isspace((unsigned char)s->code[i])) ++i;
    if (s->code[i] != '{') return starts(s, i, "continue") || starts(s, i, "break") || starts(s, i, "return");
    for (end = behind(s, i) - 2; end > i && s->code[end] != ';'; --end) { }
    while (end > i && s->code[end - 1] != '\n' && s->code[end - 1] != '{') --end;
    while (isspace((unsigned char)s->code[end])) ++end;
    return starts(s, end, "continue") || starts(s, end, "break") || starts(s, end, "return");
}

static void find_if(const source *s, size_t i)
{
    const size_t open = i + 3, end = behind(s, open);
    const span cond = {open + 1, end - 1};
    size_t stop = end;
    span part[8];
    if (leaves(s, end)) {
        find_parts(s, "if", cond, "false");
        while (stop < s->size && s->code[stop] != ';' && s->code[stop] != '/') ++stop;
        if (s->code[stop] == '/') find_parts(s, "when", cond, "true"); /* what is divided by stands in the condition */
    } else if (is_guardy(s, cond) && split(s, cond, " == 0u", part) == 1 && split(s, cond, " != 0u", part) == 1)
        find_parts(s, "when", cond, "true");
}

/* condition ? a : b */
static void find_choice(const source *s, size_t question)
{
    size_t from = question;
    int depth = 0;
    span cond, part[8];
    while (from > 0) {
        const char c = s->code[from - 1];
        if (c == ')' || c == ']') ++depth;
        else if ((c == '(' || c == '[') && depth-- == 0) break;
        else if (depth == 0 && strchr(",;?:{}", c)) break;
        else if (depth == 0 && c == '=' && s->code[from] != '=' && !strchr("=<>!", s->code[from - 2])) break;
        --from;
    }
    cond = trim(s, (span){from, question});
    if (starts(s, cond.from, "return")) cond = trim(s, (span){cond.from + 6, cond.to});
    if (split(s, cond, "&&", part) > 1 || split(s, cond, "||", part) > 1) find_parts(s, "when", cond, NULL);
    else if (is_guardy(s, cond)) { /* towards the side that is computed */
        size_t end = question + 1;
        while (end < s->size && s->code[end] != ':') end = strchr("([", s->code[end]) ? behind(s, end) : end + 1;
        add(s, "when", cond, is_constant(s, (span){question + 1, end}) ? "false" : "true");
    }
}

/* bool x = ...;  x = a && b;  return a && b; */
static void find_statement(const source *s, size_t from, size_t end)
{
    span a = trim(s, (span){from, end}), part[8];
    size_t i;
    int is_bool, is_return;
    while (starts(s, a.from, "for") || starts(s, a.from, "if")) a = trim(s, (span){behind(s, a.from + (s->code[a.from] == 'f' ? 4 : 3)), a.to});
    is_bool = starts(s, a.from, "bool");
    is_return = starts(s, a.from, "return");
    for (i = a.from; i < a.to && (s->code[i] != '=' || s->code[i + 1] == '=' || strchr("=<>!", s->code[i - 1])); ++i) { }
    if (i == a.to && !is_return) return;
    a = trim(s, (span){is_return ? a.from + 6 : i + 1, a.to});
    if (memchr(s->code + a.from, '?', a.to - a.from)) return; /* see find_choice */
    if (split(s, a, "&&", part) > 1 || split(s, a, "||", part) > 1) find_parts(s, "when", a, NULL);
    else if ((is_bool || is_return) && is_guardy(s, a)) {
        char text[512];
        snprintf(text, sizeof text, "%.*s", (int)(a.to - a.from), s->code + a.from);
        if (strstr(text, "lessThan") || strchr(text, '<') || strchr(text, '>'))
            add(s, "when", a, strstr(text, "< -1e") ? "false" : "true");
    }
}

static void find_for(const source *s, size_t i)
{
    span clause[8], part[8];
    int k, count;
    if (split(s, (span){i + 5, behind(s, i + 4) - 1}, ";", clause) != 3) return;
    count = split(s, clause[1], "&&", part);
    for (k = 1; k < count; ++k) add(s, "when", part[k], "true");
}

/* The opposite of a condition, as a number would have it. */
static void negate(const source *s, span a, char *out, size_t room)
{
    static const char *const not_all[][2] = { {"all(lessThan(", "any(greaterThanEqual("}, {"all(greaterThan(", "any(lessThanEqual("} };
    span part[8];
    size_t k, n = 0, i;
    const int count = split(s, a = unwrap(s, trim(s, a)), "&&", part);
    int p;
    *out = 0;
    for (p = 0; p < count && n < room; ++p) {
        const span b = part[p];
        if (p) n += (size_t)snprintf(out + n, room - n, " || ");
        for (k = 0; k < 2 && strncmp(s->code + b.from, not_all[k][0], strlen(not_all[k][0])); ++k) { }
        if (k < 2) {
            n += (size_t)snprintf(out + n, room - n, "%s%.*s", not_all[k][1], (int)(b.to - b.from - strlen(not_all[k][0])),
                                  s->text + b.from + strlen(not_all[k][0]));
            continue;
        }
        for (i = b.from; i < b.to && s->code[i] != '<' && s->code[i] != '>'; ++i) { }
        if (i == b.to) {
            *out = 0;
            return;
        }
        n += (size_t)snprintf(out + n, room - n, "%.*s%s%.*s", (int)(i - b.from), s->text + b.from, s->code[i] == '<' ? ">=" : "<=",
                              (int)(b.to - i - 1), s->text + i + 1);
    }
}

static void find_not(const source *s, size_t i)
{
    char put[512];
    size_t open = i + 1;
    if (starts(s, open, "all")) open += 3;
    if (s->code[open] != '(') return;
    negate(s, (span){i + 1, behind(s, open)}, put + 1, sizeof put - 2);
    if (!put[1]) return;
    put[0] = '(';
    strcat(put, ")");
    add(s, "nan", (span){i, behind(s, open)}, put);
}

/* ----------------------------------------------------------------------------------------------------------------- epsilons */

static int is_bound(const source *s, size_t i) /* the constant of a max, min or clamp, looked at there */
{
    int depth = 0;
    while (i > 0 && s->code[i - 1] != ';' && s->code[i - 1] != '{') {
        const char c = s->code[--i];
        if (c == ')') ++depth;
        else if (c == '(' && depth-- == 0) {
            depth = 0;
            if (i >= 3 && (starts(s, i - 3, "max") || starts(s, i - 3, "min"))) return 1;
            if (i >= 5 && starts(s, i - 5, "clamp")) return 1;
            if (i >= 4 && strncmp(s->code + i - 3, "vec", 3) && strncmp(s->code + i - 4, "vec", 3)) return 0;
        }
    }
    return 0;
}

static void find_epsilon(const source *s, size_t i)
{
    static const char *const words[] = { "HBIL_BIAS", "HBIL_PULL", "HBIL_LEAST_NY" };
    size_t n = i, k;
    double v;
    if (!strchr(s->code, '{')) return; /* a constant's own declaration */
    if (strcmp(s->chunk, "hbil_go") == 0 && starts(s, i, "HBIL_STRIDE")) add(s, "epsilon", (span){i, i + 11}, "0.0");
    for (k = 0; k < sizeof words / sizeof *words; ++k)
        if (starts(s, i, words[k])) add(s, "epsilon", (span){i, i + strlen(words[k])}, "0.0");
    if (!isdigit((unsigned char)s->code[i]) || s->code[i - 1] == '.') return;
    while (isalnum((unsigned char)s->code[n]) || s->code[n] == '.' || (s->code[n] == '-' && s->code[n - 1] == 'e')) ++n;
    v = strtod(s->code + i, NULL);
    if (is_bound(s, i)) return;
    if (v > 0 && v <= 1e-3 && memchr(s->code + i, 'e', n - i)) add(s, "epsilon", (span){i, n}, "0.0");
    if (v > 1 && v < 1.01) add(s, "epsilon", (span){i, n}, "1.0");
}

/* ------------------------------------------------------------------------------------------------------------ chunks and files */

static void find_all(const source *s)
{
    size_t i, statement = 0;
    int depth = 0;
    for (i = 0; i < s->size; ++i) {
        const char c = s->code[i];
        const int begins = i == 0 || !is_word(s->code[i - 1]);
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (c == ';' && depth == 0) {
            find_statement(s, statement, i);
            statement = i + 1;
        }
        if (c == '{' || c == '}') statement = i + 1;
        if (c == '?') find_choice(s, i);
        if (c == '!' && s->code[i + 1] != '=') find_not(s, i);
        if (!begins || !is_word(c)) continue;
        if (strncmp(s->code + i, "if (", 4) == 0) find_if(s, i);
        else if (strncmp(s->code + i, "for (", 5) == 0) find_for(s, i);
        else {
            find_call(s, i);
            find_epsilon(s, i);
        }
    }
}

static void read_chunk(source *s)
{
    size_t i;
    s->code = (char *)grown(NULL, s->size + 8);
    memcpy(s->code, s->text, s->size);
    memset(s->code + s->size, 0, 8);
    for (i = 0; i + 1 < s->size; ++i) /* comments and directives */
        if ((s->code[i] == '/' && s->code[i + 1] == '/') || s->code[i] == '#')
            for (; i < s->size && s->code[i] != '\n'; ++i) s->code[i] = ' ';
    find_all(s);
    free(s->code);
}

static void read_file(guard_list *list, const char *file, const char *text)
{
    static const char mark[] = "//@ chunk ";
    const char *at = strstr(text, mark);
    while (at) {
        const char *name = at + strlen(mark), *body = strchr(name, '\n') + 1, *end = strstr(body, mark), *c;
        char chunk[40];
        source s = {list, file, chunk, body, NULL, end ? (size_t)(end - body) : strlen(body), 1};
        snprintf(chunk, sizeof chunk, "%.*s", (int)(body - 1 - name), name);
        for (c = text; c < body; ++c) s.line += *c == '\n';
        read_chunk(&s);
        at = end;
    }
}

static char *load(const char *path)
{
    FILE *f = fopen(path, "rb");
    char *text = NULL;
    size_t n;
    if (!f) return NULL;
    text = (char *)grown(NULL, 1 << 20);
    n = fread(text, 1, (1 << 20) - 1, f);
    text[n] = 0;
    fclose(f);
    return text;
}

static int is_glsl(const struct dirent *d)
{
    const size_t n = strlen(d->d_name);
    return n > 5 && n < 24 && strcmp(d->d_name + n - 5, ".glsl") == 0;
}

int guards_read(const char *folder, guard_list *out, char *error, size_t size)
{
    struct dirent **files = NULL;
    const int count = scandir(folder, &files, is_glsl, alphasort);
    int i, ok = count > 0;
    memset(out, 0, sizeof *out);
    if (!ok) snprintf(error, size, "no .glsl files in %s: give the folder of the repository", folder);
    for (i = 0; i < count; ++i) {
        char path[1024];
        char *text;
        snprintf(path, sizeof path, "%s/%s", folder, files[i]->d_name);
        text = ok ? load(path) : NULL;
        if (text) read_file(out, files[i]->d_name, text);
        else if (ok) ok = snprintf(error, size, "cannot read %s", path) < 0;
        free(text);
        free(files[i]);
    }
    free(files);
    return ok;
}

void guards_free(guard_list *list)
{
    int i;
    for (i = 0; i < list->count; ++i) {
        free(list->at[i].find);
        free(list->at[i].put);
    }
    free(list->at);
    memset(list, 0, sizeof *list);
}

/* The function of that name in emitted text: from its first line to behind its closing brace. main and the chunks' names are unique in
 * a text. */
static int function_of(const char *text, const char *name, const char **from, const char **to)
{
    char head[64];
    const char *at = text;
    snprintf(head, sizeof head, " %s(", name);
    while ((at = strstr(at, head)) != NULL) {
        const char *line = at, *end = at;
        while (line > text && line[-1] != '\n') --line;
        while (*end && *end != '{' && *end != ';') ++end;
        at += strlen(head);
        if (isspace((unsigned char)*line) || *line == '/' || *end != '{') continue;
        *from = line;
        *to = strstr(line, "\n}");
        return *to != NULL;
    }
    return 0;
}

int guard_remove(const guard *g, const char *text, char *out)
{
    const char *from, *to, *at;
    const size_t n = strlen(g->find);
    int places = 0;
    if (!function_of(text, g->chunk, &from, &to)) return 0;
    while ((at = strstr(from, g->find)) != NULL && at < to) {
        if (at[-1] == '\n' && at[n] == '\n') {
            memcpy(out, text, (size_t)(at - text));
            out += at - text;
            out += sprintf(out, "%s", g->put);
            text = at + n;
            ++places;
        }
        from = at + n;
    }
    strcpy(out, text);
    return places;
}
