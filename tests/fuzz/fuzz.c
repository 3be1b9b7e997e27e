/* fuzz.c - see fuzz.h. */
#include "fuzz.h"

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[256];
static long owner;
int fuzz_errors = 2;

void fuzz_fail(const char *file, int line, const char *condition)
{
    const char *name = strrchr(file, '/');
    dprintf(fuzz_errors, "%s:%d: does not hold: %s\n", name ? name + 1 : file, line, condition);
    abort();
}

/* Removes what is in a folder of ours, which may hold folders. */
static void empty(const char *path)
{
    char inner[1024];
    struct dirent *entry;
    struct stat s;
    DIR *d = opendir(path);
    while (d && (entry = readdir(d)) != NULL) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) continue;
        if (snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name) >= (int)sizeof inner || lstat(inner, &s)) continue;
        if (S_ISDIR(s.st_mode)) empty(inner);
        remove(inner);
    }
    if (d) closedir(d);
}

static void leave(void)
{
    if (getpid() != owner) return; /* a child's end is not ours */
    empty(folder);
    if (chdir("/") == 0) rmdir(folder);
}

void fuzz_enter_folder(void)
{
    const char *base = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/hbil-fuzz-XXXXXX", base && *base && strlen(base) < 200 ? base : "/tmp");
    if (!mkdtemp(folder) || chdir(folder) || !freopen("/dev/null", "r", stdin)) {
        fprintf(stderr, "cannot make a folder like %s; set TMPDIR to one that can be written\n", folder);
        exit(2);
    }
    owner = getpid();
    atexit(leave);
}

void fuzz_empty_folder(void) { empty(folder); }

void fuzz_write(const char *name, const void *data, size_t size)
{
    FILE *f = fopen(name, "wb");
    int ok = f && fwrite(data, 1, size, f) == size;
    if (f) ok = fclose(f) == 0 && ok;
    if (ok) return;
    fprintf(stderr, "cannot write %s/%s; is the disk full?\n", folder, name);
    exit(2);
}

uint32_t fuzz_take(fuzz_reader *r, size_t bytes)
{
    uint32_t value = 0;
    size_t i;
    for (i = 0; i < bytes && i < r->left; ++i) value |= (uint32_t)r->at[i] << 8 * i;
    r->at += i;
    r->left -= i;
    return value;
}
