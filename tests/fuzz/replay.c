/* replay.c - a harness without libFuzzer: all files of its corpus, then seeded mutations of them.
 *
 *   fuzz_NAME FOLDER [MUTATIONS [SEED]]     exit 0 all well; 1 a fault, whose input is kept; 2 wrong usage
 *   fuzz_NAME FILE                          that one input
 *
 * All of it runs in a child, which leaves its input where this process can see it if it dies. Same corpus and seed, same
 * inputs. */
#if defined(__linux__) && !defined(_DEFAULT_SOURCE)
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#endif
#include "fuzz.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#define INPUT_MAX  65536
#define FILES_MAX  4096
#define HANG_AFTER 20 /* s for one input */

typedef struct corpus { uint8_t *data[FILES_MAX]; size_t size[FILES_MAX]; char *name[FILES_MAX]; int count, is_folder; } corpus;

/* What the child is at. */
typedef struct progress { long files, mutations; size_t size; uint8_t input[INPUT_MAX]; } progress;

static uint64_t state;

static uint32_t random_below(uint32_t limit) /* xorshift64* */
{
    state ^= state >> 12, state ^= state << 25, state ^= state >> 27;
    return (uint32_t)((state * 2685821657736338717u) >> 33) % limit;
}

static int by_name(const void *a, const void *b) { return strcmp(*(char *const *)a, *(char *const *)b); }

static void load(corpus *c, int i)
{
    FILE *f = fopen(c->name[i], "rb");
    c->data[i] = (uint8_t *)malloc(INPUT_MAX);
    if (f && c->data[i]) c->size[i] = fread(c->data[i], 1, INPUT_MAX, f);
    if (!f || !c->data[i] || ferror(f)) {
        fprintf(stderr, "cannot read %s\n", c->name[i]);
        exit(2);
    }
    fclose(f);
}

static void read_corpus(corpus *c, const char *path)
{
    struct dirent *entry;
    DIR *d = opendir(path);
    char file[4096];
    int i;
    if (!d) c->name[c->count++] = strdup(path);
    while (d && c->count < FILES_MAX && (entry = readdir(d)) != NULL) {
        if (entry->d_name[0] == '.' || strcmp(entry->d_name, "found") == 0) continue;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        c->name[c->count++] = strdup(file);
    }
    c->is_folder = d != NULL;
    if (d) closedir(d);
    qsort(c->name, (size_t)c->count, sizeof *c->name, by_name); /* folders list in any order */
    for (i = 0; i < c->count; ++i) load(c, i);
}

/* One change of an input in place; returns its new size. */
static size_t mutate(uint8_t *in, size_t size, const corpus *c)
{
    static const uint32_t corners[] = { 0, 1, 0x7f, 0x80, 0xff, 0x7fff, 0x8000, 0xffff, 0x7fffffff, 0x80000000u, 0xffffffffu,
                                        0x7f800000, 0x7fc00000, 0x7149f2ca };
    size_t at = size ? random_below((uint32_t)size) : 0, n, k;
    int other = (int)random_below((uint32_t)c->count);
    switch (random_below(8)) {
    case 0: if (size) in[at] ^= (uint8_t)(1u << random_below(8)); break;
    case 1: if (size) in[at] = (uint8_t)random_below(256); break;
    case 2: if (size) in[at] = (uint8_t)(in[at] + random_below(33) - 16); break;
    case 3: /* a number at its corner */
        for (k = 0, n = (size_t)1 << random_below(3), other = (int)random_below(sizeof corners / sizeof *corners); k < n && at + k < size; ++k)
            in[at + k] = (uint8_t)(corners[other] >> 8 * k);
        break;
    case 4: /* out */
        n = 1 + random_below(16);
        if (at + n > size) n = size - at;
        memmove(in + at, in + at + n, size - at - n);
        return size - n;
    case 5: /* twice */
        n = 1 + random_below(16);
        if (at + n > size) n = size - at;
        if (size + n > INPUT_MAX) break;
        memmove(in + at + n, in + at, size - at);
        return size + n;
    case 6: /* from another file */
        n = 1 + random_below(64);
        if (!c->size[other]) break;
        k = random_below((uint32_t)c->size[other]);
        if (n > c->size[other] - k) n = c->size[other] - k;
        if (at + n > INPUT_MAX) break;
        memcpy(in + at, c->data[other] + k, n);
        return at + n > size ? at + n : size;
    default: return random_below(8) ? size : at; /* cut */
    }
    return size;
}

/* From an allocation of just that size, so that a byte too many is seen. */
static void run(progress *now, const uint8_t *data, size_t size)
{
    uint8_t *exact = (uint8_t *)malloc(size ? size : 1);
    if (!exact) exit(2);
    if (size) memcpy(now->input, data, size);
    if (size) memcpy(exact, data, size);
    now->size = size;
    alarm(HANG_AFTER);
    LLVMFuzzerTestOneInput(exact, size);
    alarm(0);
    free(exact);
}

/* What the code under test prints goes nowhere, what sanitizers print stays. */
#if defined(__GNUC__)
__attribute__((weak)) void __sanitizer_set_report_fd(void *fd);
#endif
static void be_quiet(void)
{
    const int nowhere = open("/dev/null", O_WRONLY);
    fuzz_errors = dup(2);
    if (nowhere < 0 || fuzz_errors < 0 || dup2(nowhere, 1) < 0 || dup2(nowhere, 2) < 0) exit(2);
#if defined(__GNUC__)
    if (__sanitizer_set_report_fd) __sanitizer_set_report_fd((void *)(intptr_t)fuzz_errors);
#endif
}

static void run_all(const corpus *c, progress *now, long mutations)
{
    static uint8_t in[INPUT_MAX];
    for (now->files = 0; now->files < c->count; ++now->files) run(now, c->data[now->files], c->size[now->files]);
    for (now->mutations = 0; now->mutations < mutations; ++now->mutations) {
        int from = (int)random_below((uint32_t)c->count), k = 1 + (int)random_below(6);
        size_t size = c->size[from];
        memcpy(in, c->data[from], size);
        while (k--) size = mutate(in, size, c);
        run(now, in, size);
    }
    now->size = 0;
}

/* The child has died: keeps its input, says where. */
static int tell(const corpus *c, const progress *now, const char *target, int status)
{
    char path[300];
    FILE *f;
    snprintf(path, sizeof path, "fault-%s", target);
    f = fopen(path, "wb");
    if (f) { fwrite(now->input, 1, now->size, f); fclose(f); }
    fprintf(stderr, "fuzz %s: %s in %s%s%ld: run this program with the file %s to see it again\n", target,
            WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM ? "no end" : "FAULT",
            now->files < c->count ? c->name[now->files] : "mutation ", now->files < c->count ? ", file " : "",
            now->files < c->count ? now->files : now->mutations, f ? path : "(cannot be written)");
    return 1;
}

int main(int argc, char **argv)
{
    static corpus c;
    const char *slash = strrchr(argv[0], '/'), *target = slash ? slash + 1 : argv[0];
    const long mutations = argc > 2 ? atol(argv[2]) : 0;
    progress *now = (progress *)mmap(NULL, sizeof *now, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    int i, status;
    pid_t child;
    if (argc < 2 || argc > 4 || mutations < 0 || now == MAP_FAILED) {
        fprintf(stderr, "usage: %s FOLDER|FILE [MUTATIONS [SEED]]\n", argv[0]);
        return 2;
    }
    if (strncmp(target, "fuzz_", 5) == 0) target += 5;
    state = (argc > 3 ? strtoull(argv[3], NULL, 10) : 1) * 0x9e3779b97f4a7c15u + 1;
    read_corpus(&c, argv[1]);
    if (c.count == 0) { fprintf(stderr, "fuzz %s: no files in %s\n", target, argv[1]); return 2; }
    fflush(NULL);
    child = fork();
    if (child == 0) {
        if (c.is_folder) be_quiet();
        run_all(&c, now, mutations);
        exit(0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) return 2;
    if (!WIFEXITED(status) || WEXITSTATUS(status)) return tell(&c, now, target, status);
    printf("fuzz %s: %d corpus files, %ld mutations, no fault\n", target, c.count, mutations);
    for (i = 0; i < c.count; ++i) { free(c.data[i]); free(c.name[i]); }
    return 0;
}
