/* matrix_state.c - the journal of a matrix: a line for each variant that is whole. See matrix.h.
 *
 *   <key> <config hash> <count> { <text key> <bytes> <file> } | <facts>
 *
 * Appended to while variants are made, written anew at the end. A line that was torn, or whose key is another's, only
 * tells which files are ours to remove, as the manifest does. */
#include "matrix.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define STATE_SCHEMA 1

static const char *const folders[] = { "", "spirv/", "glsl/" };

/* ---------------------------------------------------------------------- key */

/* Whatever may change what is made: this program and its libraries, glslang among them, byte by byte, and the format.
 * Where the system does not tell them it is 0, which fits no line: then all is made again. */
static uint64_t key_of(const matrix_job *m)
{
    uint64_t sum = STATE_SCHEMA;
    char line[2048], last[2048] = "", *path, *data;
    FILE *f = fopen("/proc/self/maps", "r");
    size_t size;
    int ok = f != NULL;
    while (ok && fgets(line, sizeof line, f)) {
        line[strcspn(line, "\n")] = 0;
        path = strchr(line, '/');
        if (!path || !strstr(line, " r-xp ") || strcmp(path, last) == 0) continue;
        strcpy(last, path);
        data = read_all(path, &size);
        ok = data != NULL;
        if (ok) sum += hash_bytes(HASH, data, size); /* a sum: they are mapped in any order */
        free(data);
    }
    if (f) fclose(f);
    return ok && *last ? hash_bytes(sum, m->spirv ? "spirv" : "glsl", 4) : 0;
}

/* ---------------------------------------------------------------------- names */

/* Is this name, relative to the folder, one that a run makes? As "spirv/march-0123456789abcdef.spv". Nothing else is
 * ever removed. */
static int is_ours(const char *name)
{
    static const char *const tops[] = { MANIFEST_FILE, STATE_FILE, "hbil_variants.h", "hbil_variants.c" };
    static const char *const ends[] = { ".spv", ".comp", ".frag", ".vert" };
    const char *base = strchr(name, '/');
    size_t i, k, n;
    if (!base) {
        for (i = 0; i < sizeof tops / sizeof *tops; ++i)
            if (strcmp(name, tops[i]) == 0) return 1;
        return 0;
    }
    n = (size_t)(++base - name);
    for (i = 1; i < sizeof folders / sizeof *folders; ++i)
        if (strlen(folders[i]) == n && strncmp(name, folders[i], n) == 0) break;
    k = strspn(base, "abcdefghijklmnopqrstuvwxyz0123456789_");
    if (i == sizeof folders / sizeof *folders || k == 0 || base[k] != '-') return 0;
    if (strspn(base + k + 1, "0123456789abcdef") != 16) return 0;
    for (i = 0; i < sizeof ends / sizeof *ends; ++i)
        if (strcmp(base + k + 17, ends[i]) == 0) return 1;
    return 0;
}

static int remove_in(const matrix_job *m, const char *name, const char *suffix)
{
    char path[1200];
    snprintf(path, sizeof path, "%s%s%s", m->folder, name, suffix);
    if (remove(path) == 0) return 1;
    if (errno == ENOENT || errno == ENOTDIR) return 0;
    fprintf(stderr, "shadergen: cannot remove %s: %s\n", path, strerror(errno));
    return -1;
}

int state_clean(matrix_job *m)
{
    char path[1200], name[320];
    size_t i, n;
    int ok = 1;
    for (i = 0; i < sizeof folders / sizeof *folders && ok; ++i) {
        struct dirent *entry;
        DIR *d;
        snprintf(path, sizeof path, "%s%s", m->folder, folders[i]);
        d = opendir(path);
        while (d && ok && (entry = readdir(d)) != NULL) {
            n = (size_t)snprintf(name, sizeof name, "%s%s", folders[i], entry->d_name);
            if (n < 4 || n >= sizeof name || strcmp(name + n - 4, ".tmp")) continue;
            name[n - 4] = 0;
            if (is_ours(name)) ok = remove_in(m, name, ".tmp") >= 0;
        }
        if (d) closedir(d);
    }
    return ok ? DONE : IO;
}

/* ---------------------------------------------------------------------- reading */

/* The next word of a line, terminated; NULL: none. */
static char *word(char **at)
{
    char *from = *at + strspn(*at, " ");
    size_t n = strcspn(from, " ");
    if (n == 0) return NULL;
    *at = from + n + (from[n] == ' ');
    from[n] = 0;
    return from;
}

static int number(char **at, int base, uint64_t *out)
{
    char *w = word(at), *end;
    if (!w || strspn(w, base == 16 ? "0123456789abcdef" : "0123456789") != strlen(w)) return 0;
    *out = strtoull(w, &end, base);
    return *end == 0;
}

/* One line; what does not read is not there. 0: out of memory. */
static int read_line(matrix_job *m, char *at)
{
    variant v;
    uint64_t key, count;
    char *name, *bar;
    int32_t i;
    memset(&v, 0, sizeof v);
    if (!number(&at, 16, &key) || key != m->key || key == 0 || !number(&at, 16, &v.hash)) return 1;
    if (!number(&at, 10, &count) || count == 0 || count > VARIANT_PASSES) return 1;
    for (i = 0; i < (int32_t)count; ++i) {
        uint64_t text, bytes;
        slot *s;
        if (!number(&at, 16, &text) || !number(&at, 10, &bytes)) return 1;
        if (!(name = word(&at)) || !strchr(name, '/') || !is_ours(name)) return 1;
        v.slots[v.count] = slot_of(m, text);
        if (v.slots[v.count] < 0) return 0;
        s = &m->slots[v.slots[v.count++]];
        if (strlen(name) >= sizeof s->file) return 1;
        strcpy(s->file, name);
        s->bytes = bytes;
        s->status = SLOT_LISTED;
    }
    bar = word(&at);
    if (!bar || strcmp(bar, "|")) return 1;
    v.facts = strdup(at);
    variant *old = variants_add(&m->old);
    if (!v.facts || !old) { free(v.facts); return 0; }
    *old = v;
    return map_put(&m->old_index, v.hash, m->old.count - 1);
}

/* A file of an earlier run; none is as good as an empty one. */
static int read_old(const matrix_job *m, const char *name, char **text)
{
    char path[1200];
    size_t size;
    snprintf(path, sizeof path, "%s%s", m->folder, name);
    *text = read_all(path, &size);
    if (*text) return DONE;
    if (errno == ENOENT || errno == ENOTDIR) return (*text = strdup("")) != NULL ? DONE : no_memory();
    fprintf(stderr, "shadergen: cannot read %s: %s\n", path, strerror(errno));
    return IO;
}

int state_read(matrix_job *m)
{
    char *copy, *line, *end;
    int ok = 1, code = read_old(m, STATE_FILE, &m->state);
    if (code == DONE) code = read_old(m, MANIFEST_FILE, &m->manifest);
    if (code != DONE) return code;
    m->key = key_of(m);
    copy = strdup(m->state);
    for (line = copy; ok && copy && (end = strchr(line, '\n')) != NULL; line = end + 1) {
        *end = 0;
        ok = read_line(m, line);
    }
    free(copy);
    return copy && ok ? DONE : no_memory();
}

/* ---------------------------------------------------------------------- writing */

static void print_variant(FILE *f, const matrix_job *m, const variant *v)
{
    int32_t i;
    fprintf(f, "%016" PRIx64 " %016" PRIx64 " %d", m->key, v->hash, (int)v->count);
    for (i = 0; i < v->count; ++i) {
        const slot *s = &m->slots[v->slots[i]];
        fprintf(f, " %016" PRIx64 " %" PRIu64 " %s", s->key, s->bytes, s->file);
    }
    fprintf(f, " | %s\n", v->facts);
}

int state_append(matrix_job *m, const variant *v)
{
    char path[1200];
    snprintf(path, sizeof path, "%s" STATE_FILE, m->folder);
    if (!m->journal) {
        const size_t n = strlen(m->state);
        m->journal = fopen(path, "ab");
        if (m->journal && n && m->state[n - 1] != '\n') fputc('\n', m->journal); /* a torn line must not go on */
    }
    if (m->journal) print_variant(m->journal, m, v);
    if (m->journal && fflush(m->journal) == 0) return DONE;
    fprintf(stderr, "shadergen: cannot write %s: %s\n", path, strerror(errno));
    return IO;
}

int state_print(const matrix_job *m, file *f)
{
    FILE *out = open_memstream(&f->data, &f->size);
    int32_t i;
    if (out) {
        fputs("# What shadergen matrix made here, so that its next run need not; without this it makes all again.\n"
              "# A line is a variant; its first word stands for the program. Keep this out of version control.\n", out);
        for (i = 0; i < m->list.count; ++i)
            if (!m->list.items[i].refused) print_variant(out, m, &m->list.items[i]);
    }
    snprintf(f->path, sizeof f->path, "%s" STATE_FILE, m->folder);
    return out && fclose(out) == 0 ? DONE : no_memory();
}

/* The names of the files that the variants need. */
static int wanted_files(const matrix_job *m, map *wanted)
{
    static const char *const also[] = { MANIFEST_FILE, STATE_FILE, "hbil_variants.h", "hbil_variants.c" };
    int32_t i, k;
    for (i = 0; i < (m->c ? 4 : 2); ++i)
        if (!map_put(wanted, hash_bytes(HASH, also[i], strlen(also[i])), 1)) return 0;
    for (i = 0; i < m->list.count; ++i)
        for (k = 0; k < m->list.items[i].count; ++k) {
            const char *name = m->slots[m->list.items[i].slots[k]].file;
            if (!map_put(wanted, hash_bytes(HASH, name, strlen(name)), 1)) return 0;
        }
    return 1;
}

static int exists(const matrix_job *m, const char *name)
{
    char path[1200];
    snprintf(path, sizeof path, "%s%s", m->folder, name);
    return access(path, F_OK) == 0;
}

/* Removes what a text of an earlier run names and nobody wants; --check: tells it. */
static int remove_named(matrix_job *m, char *text, const map *wanted)
{
    char *name, *rest = NULL;
    for (name = strtok_r(text, " \"\n", &rest); name; name = strtok_r(NULL, " \"\n", &rest)) {
        int one;
        if (!is_ours(name) || map_find(wanted, hash_bytes(HASH, name, strlen(name))) >= 0) continue;
        if (m->check) {
            if (exists(m, name)) say_stale(m, name, "is needed by no variant");
            continue;
        }
        one = remove_in(m, name, "");
        if (one < 0) return 0;
        m->removed += one;
    }
    return 1;
}

int state_remove_old(matrix_job *m)
{
    map wanted = { NULL, NULL, 0, 0 };
    char path[1200];
    int code = wanted_files(m, &wanted) ? DONE : no_memory();
    if (code == DONE && !(remove_named(m, m->manifest, &wanted) && remove_named(m, m->state, &wanted))) code = IO;
    map_free(&wanted);
    snprintf(path, sizeof path, "%s%s", m->folder, m->spirv ? "glsl" : "spirv");
    if (m->removed) rmdir(path); /* the other format's, if it is empty now */
    return code;
}
