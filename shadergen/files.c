/* files.c - see files.h. POSIX: rename replaces. */
#include "files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

file *files_add(files *list)
{
    if (list->count == list->room) {
        int room = list->room ? 2 * list->room : 16;
        file *more = (file *)realloc(list->items, (size_t)room * sizeof *more);
        if (!more) return NULL;
        list->items = more;
        list->room = room;
    }
    return memset(&list->items[list->count++], 0, sizeof(file));
}

void files_free(files *list)
{
    int i;
    for (i = 0; i < list->count; ++i) free(list->items[i].data);
    free(list->items);
    memset(list, 0, sizeof *list);
}

char *read_all(const char *path, size_t *size)
{
    FILE *f = strcmp(path, "-") ? fopen(path, "rb") : stdin;
    char *data = NULL;
    size_t n = 0, room = 0, got = 1;
    if (!f) return NULL;
    while (got) {
        if (n == room) {
            char *more = (char *)realloc(data, (room += 65536) + 1);
            if (!more) { free(data); data = NULL; break; }
            data = more;
        }
        got = fread(data + n, 1, room - n, f);
        n += got;
    }
    if (data && ferror(f)) { free(data); data = NULL; }
    if (f != stdin) fclose(f);
    if (data) data[n] = 0;
    *size = n;
    return data;
}

int file_place(file *f, const char *path, const char *name, const char *suffix)
{
    size_t n = strlen(path);
    int folder = n && path[n - 1] == '/';
    if (snprintf(f->path, sizeof f->path, "%s%s%s", path, folder ? name : "", folder ? suffix : "") < (int)sizeof f->path) return 1;
    fprintf(stderr, "shadergen: path too long: %s\n", path);
    return 0;
}

int folder_make(const char *path)
{
    char part[1024];
    size_t n;
    for (n = 1; path[n - 1] && n < sizeof part; ++n) {
        if (path[n - 1] != '/' || n == 1) continue;
        memcpy(part, path, n);
        part[n] = 0;
        if (mkdir(part, 0777) == 0 || errno == EEXIST) continue;
        fprintf(stderr, "shadergen: cannot make folder %s: %s\n", part, strerror(errno));
        return 0;
    }
    return 1;
}

/* Standard output, a terminal, a pipe, /dev/null: written to as it is, where a rename would put a file in its place. */
static int is_stream(const char *path)
{
    struct stat s;
    return strcmp(path, "-") == 0 || (stat(path, &s) == 0 && !S_ISREG(s.st_mode) && !S_ISDIR(s.st_mode));
}

static int same_on_disk(const file *f)
{
    size_t size = 0;
    char *data = is_stream(f->path) ? NULL : read_all(f->path, &size);
    int same = data && size == f->size && memcmp(data, f->data, size) == 0;
    free(data);
    return same;
}

static void temporary(char temp[1040], const file *f) { strcat(strcpy(temp, f->path), ".tmp"); }

/* To a stream, or to the temporary file, which is gone again after a failure. */
static int write_one(const file *f)
{
    char temp[1040];
    int standard = strcmp(f->path, "-") == 0, stream = is_stream(f->path), ok;
    FILE *out;
    temporary(temp, f);
    out = standard ? stdout : fopen(stream ? f->path : temp, "wb");
    ok = out && fwrite(f->data, 1, f->size, out) == f->size && fflush(out) == 0;
    if (out && !standard) {
        ok = fclose(out) == 0 && ok;
        if (!ok && !stream) remove(temp);
    }
    return ok;
}

/* Renames what was written, the files marked changed below `count`. Returns the first that failed, or -1. */
static int rename_all(const files *list, const char *changed, int count)
{
    char temp[1040];
    int i;
    for (i = 0; i < count; ++i) {
        if (!changed[i] || is_stream(list->items[i].path)) continue;
        temporary(temp, &list->items[i]);
        if (rename(temp, list->items[i].path)) return i;
    }
    return -1;
}

int files_write(files *list, int *stale)
{
    char *changed = (char *)calloc((size_t)list->count + 1, 1), temp[1040];
    int i, made, bad = -1;
    if (!changed) { fprintf(stderr, "shadergen: out of memory\n"); return 0; }
    if (stale) *stale = 0;
    for (made = 0; made < list->count && bad < 0; ++made) {
        changed[made] = (char)!same_on_disk(&list->items[made]);
        if (stale && changed[made]) fprintf(stderr, "shadergen: %s is not up to date\n", list->items[made].path);
        if (stale) *stale += changed[made];
        else if (changed[made] && !write_one(&list->items[made])) { bad = made; changed[made] = 0; }
        else if (!changed[made] && !is_stream(list->items[made].path)) { /* what a killed run may have left */
            temporary(temp, &list->items[made]);
            remove(temp);
        }
    }
    if (!stale && bad < 0) bad = rename_all(list, changed, made);
    if (bad >= 0) {
        fprintf(stderr, "shadergen: cannot write %s: %s\n", list->items[bad].path, strerror(errno));
        for (i = 0; i < made; ++i) {
            temporary(temp, &list->items[i]);
            if (changed[i] && !is_stream(list->items[i].path)) remove(temp);
        }
    }
    free(changed);
    return bad < 0;
}
