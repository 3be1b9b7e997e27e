/* preload.c - a library for LD_PRELOAD that ends a process, or fills its disk, at the n-th step by which it changes a file below a folder.
 *
 *   HBIL_FAULT_UNDER=DIR   which files; an absolute path
 *   HBIL_FAULT_AT=N        the step, from 1; 0 or nothing: none
 *   HBIL_FAULT=HOW         kill: SIGKILL before it. torn: half of what it writes, then SIGKILL. full: from it on there is no space
 *   HBIL_FAULT_COUNT=FILE  write there how many steps there were, at exit
 *   HBIL_FAULT_DLOPEN=TEXT no library whose name has that in it can be opened
 * Steps: opening a file to write, writing, flushing, closing what was written, renaming, removing, cutting short. Linux, glibc. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILES = 4096 };

static unsigned char below[FILES]; /* by descriptor: 1: a file to watch */
static int           steps;

static const char *setting(const char *name)
{
    const char *value = getenv(name);
    return value ? value : "";
}

/* The next function of that name, into *pointer. */
static void next(const char *name, void *pointer)
{
    void *address = dlsym(RTLD_NEXT, name);
    memcpy(pointer, &address, sizeof address);
}
#define NEXT(type, name, parameters) type (*real) parameters; next(#name, &real)

static int is_below(const char *path)
{
    const char *under = setting("HBIL_FAULT_UNDER");
    char        full[8192];
    if (!*under) return 0;
    if (path[0] == '/') return strncmp(path, under, strlen(under)) == 0;
    if (!getcwd(full, sizeof full) || strlen(full) + strlen(path) + 2 > sizeof full) return 0;
    strcat(strcat(full, "/"), path);
    return strncmp(full, under, strlen(under)) == 0;
}

static void watch(int file, const char *path)
{
    if (file >= 0 && file < FILES) below[file] = (unsigned char)is_below(path);
}

static int watched(int file) { return file >= 0 && file < FILES && below[file]; }

enum { GO, TEAR, FULL };

/* One more step. Does not return where it is the one to be killed at. */
static int step(void)
{
    const int   at = atoi(setting("HBIL_FAULT_AT"));
    const char *how = setting("HBIL_FAULT");
    ++steps;
    if (at < 1 || steps < at) return GO;
    if (strcmp(how, "full") == 0) return FULL;
    if (steps > at) return GO;
    if (strcmp(how, "torn") == 0) return TEAR;
    kill(getpid(), SIGKILL);
    return GO;
}

static void die(void) { kill(getpid(), SIGKILL); }

/* Half of what a file has gained since `before` stays. */
static void tear(int file, off_t before)
{
    struct stat now;
    if (fstat(file, &now) == 0 && now.st_size > before && ftruncate(file, before + (now.st_size - before) / 2) == 0) {}
    die();
}

static off_t size_of(int file)
{
    struct stat now;
    return fstat(file, &now) == 0 ? now.st_size : 0;
}

FILE *fopen(const char *path, const char *mode)
{
    NEXT(FILE *, fopen, (const char *, const char *));
    const int writes = strpbrk(mode, "wa+") != NULL && is_below(path);
    const int now = writes ? step() : GO;
    FILE     *f;
    if (now == FULL) errno = ENOSPC;
    f = now == FULL ? NULL : real(path, mode);
    if (now == TEAR) die();
    if (f && writes) watch(fileno(f), path);
    return f;
}

static int open_as(const char *name, const char *path, int flags, mode_t mode)
{
    const int writes = (flags & (O_WRONLY | O_RDWR)) != 0 && is_below(path);
    const int now = writes ? step() : GO;
    int (*real)(const char *, int, ...);
    int file;
    next(name, &real);
    if (now == FULL && (flags & O_CREAT)) return errno = ENOSPC, -1;
    file = real(path, flags, mode);
    if (now == TEAR) die();
    if (writes) watch(file, path);
    return file;
}

#define OPEN(name)                                          \
    int name(const char *path, int flags, ...)              \
    {                                                       \
        mode_t  mode = 0;                                   \
        va_list args;                                       \
        va_start(args, flags);                              \
        if (flags & O_CREAT) mode = va_arg(args, mode_t);   \
        va_end(args);                                       \
        return open_as(#name, path, flags, mode);           \
    }
OPEN(open)
OPEN(open64)

ssize_t write(int file, const void *bytes, size_t size)
{
    NEXT(ssize_t, write, (int, const void *, size_t));
    const int now = watched(file) ? step() : GO;
    if (now == FULL) return errno = ENOSPC, -1;
    if (now == TEAR && real(file, bytes, size / 2) >= 0) die();
    return real(file, bytes, size);
}

#define PWRITE(name)                                                            \
    ssize_t name(int file, const void *bytes, size_t size, off_t at)            \
    {                                                                           \
        NEXT(ssize_t, name, (int, const void *, size_t, off_t));                \
        const int now = watched(file) ? step() : GO;                            \
        if (now == FULL) return errno = ENOSPC, -1;                             \
        if (now == TEAR && real(file, bytes, size / 2, at) >= 0) die();         \
        return real(file, bytes, size, at);                                     \
    }
PWRITE(pwrite)
PWRITE(pwrite64)

size_t fwrite(const void *bytes, size_t size, size_t count, FILE *f)
{
    NEXT(size_t, fwrite, (const void *, size_t, size_t, FILE *));
    const int now = watched(fileno(f)) ? step() : GO;
    if (now == FULL) return errno = ENOSPC, 0;
    if (now == TEAR) {
        real(bytes, 1, size * count / 2, f);
        fflush(f);
        die();
    }
    return real(bytes, size, count, f);
}

int fflush(FILE *f)
{
    NEXT(int, fflush, (FILE *));
    const int   file = f ? fileno(f) : -1, now = watched(file) ? step() : GO;
    const off_t before = now == TEAR ? size_of(file) : 0;
    int         result;
    if (now == FULL) return errno = ENOSPC, EOF;
    result = real(f);
    if (now == TEAR) tear(file, before);
    return result;
}

int fclose(FILE *f)
{
    NEXT(int, fclose, (FILE *));
    const int   file = fileno(f), watching = watched(file), now = watching ? step() : GO;
    const off_t before = now == TEAR ? size_of(file) : 0;
    int         result;
    if (now == TEAR) {
        int (*flush)(FILE *);
        next("fflush", &flush);
        flush(f);
        tear(file, before);
    }
    if (watching) below[file] = 0;
    result = real(f);
    return now == FULL ? errno = ENOSPC, EOF : result;
}

int close(int file)
{
    NEXT(int, close, (int));
    if (watched(file)) {
        if (step() == TEAR) die();
        below[file] = 0;
    }
    return real(file);
}

int rename(const char *from, const char *to)
{
    NEXT(int, rename, (const char *, const char *));
    const int now = is_below(to) ? step() : GO;
    const int result = real(from, to);
    if (now == TEAR) die(); /* after it */
    return result;
}

int remove(const char *path)
{
    NEXT(int, remove, (const char *));
    const int now = is_below(path) ? step() : GO;
    const int result = real(path);
    if (now == TEAR) die();
    return result;
}

int ftruncate(int file, off_t size)
{
    NEXT(int, ftruncate, (int, off_t));
    if (watched(file) && step() == TEAR) die();
    return real(file, size);
}

void *dlopen(const char *path, int flags)
{
    NEXT(void *, dlopen, (const char *, int));
    const char *hidden = setting("HBIL_FAULT_DLOPEN");
    return *hidden && path && strstr(path, hidden) ? NULL : real(path, flags);
}

__attribute__((destructor)) static void tell(void)
{
    const char *path = setting("HBIL_FAULT_COUNT");
    if (!*path) return;
    NEXT(FILE *, fopen, (const char *, const char *));
    FILE *f = real(path, "w");
    if (!f) return;
    fprintf(f, "%d\n", steps);
    fclose(f);
}
