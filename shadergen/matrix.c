/* matrix.c - command line and order of work of shadergen matrix. See help() and matrix.h. */
#include "matrix.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <unistd.h>

#define THREADS_MAX 256

static int help(void)
{
    fputs("shadergen matrix - builds all combinations of lists of values\n\n"
          "usage: shadergen matrix FILE -o DIR [options]\n\n"
          "FILE, or - for standard input: options of a config, a list of values each. All combinations are variants:\n"
          "  preset  = fast, balanced      # the base, if any\n"
          "  outputs = ao, ao+near\n"
          "  slices  = 1, 2, 4\n"
          "Combinations that mean nothing are refused; the manifest tells why. Those that resolve to the same config\n"
          "are one variant. Equal shaders are one file.\n\n"
          "DIR, made if need be:\n"
          "  spirv/PASS-HASH.spv     SPIR-V, named by its bytes; or glsl/PASS-HASH.comp, .frag, .vert\n"
          "  manifest.json           each variant: its config, hash and files; what was refused\n"
          "  hbil_variants.h and .c  with --c: hbil_variant_find, from hbil_config_hash to SPIR-V\n"
          "  matrix.state            what the next run need not make again\n\n"
          "options:\n"
          "  -o, --output DIR        the folder\n"
          "  --format FORMAT         spirv (default) or glsl\n"
          "  --c                     the words as C, too\n"
          "  --jobs N                threads, 1 to 256; default: one for each core\n"
          "  --check                 write nothing; exit 5 if a run would change anything\n"
          "  -q                      no progress, no summary\n"
          "  -v                      also what was refused, and the memory that it took\n"
          "  -h, --help\n\n"
          "An interrupted run goes on where it was. Files of earlier runs that no variant needs are removed.\n\n"
          "exit: 0 done, 1 FILE is wrong or all is refused, 2 wrong usage, 3 cannot read or write,\n"
          "      4 glslang refused our text, 5 --check found something stale\n", stdout);
    return DONE;
}

static int usage(const char *what, const char *word)
{
    fprintf(stderr, "shadergen: %s%s; see shadergen matrix --help\n", what, word);
    return USAGE;
}

/* ---------------------------------------------------------------------- command line */

static int read_threads(matrix_job *m, const char *text)
{
    size_t n = strlen(text);
    m->threads = n <= 3 && strspn(text, "0123456789") == n ? atoi(text) : 0;
    return m->threads >= 1 && m->threads <= THREADS_MAX ? DONE : usage("--jobs must be in [1, 256], not ", text);
}

static int read_value(matrix_job *m, const char *flag, const char *value)
{
    if (strcmp(flag, "--jobs") == 0) return read_threads(m, value);
    if (strcmp(flag, "--format") == 0) {
        m->spirv = strcmp(value, "spirv") == 0;
        return m->spirv || strcmp(value, "glsl") == 0 ? DONE : usage("--format must be spirv or glsl, not ", value);
    }
    m->folder = value;
    return DONE;
}

static int takes_value(const char *a)
{
    return strcmp(a, "-o") == 0 || strcmp(a, "--output") == 0 || strcmp(a, "--jobs") == 0 || strcmp(a, "--format") == 0;
}

static int read_arguments(matrix_job *m, int argc, char **argv)
{
    int i, code = DONE;
    for (i = 1; i < argc && code == DONE; ++i) {
        const char *a = argv[i];
        if (strcmp(a, "-q") == 0) m->quiet = 1;
        else if (strcmp(a, "-v") == 0) m->verbose = 1;
        else if (strcmp(a, "--c") == 0) m->c = 1;
        else if (strcmp(a, "--check") == 0) m->check = 1;
        else if (takes_value(a)) {
            if (++i == argc || !*argv[i]) return usage("no value after ", a);
            code = read_value(m, a, argv[i]);
        }
        else if ((*a == '-' && a[1]) || !*a) return usage("unknown argument ", a);
        else if (m->file) return usage("one file at a time, not also ", a);
        else m->file = a;
    }
    if (code != DONE) return code;
    if (!m->file) return usage("name the file of the matrix", "");
    if (!m->folder) return usage("name the folder to write to: -o DIR", "");
    if (strcmp(m->folder, "-") == 0) return usage("a matrix is many files: after -o name a folder, not ", m->folder);
    if (m->c && !m->spirv) return usage("--c holds SPIR-V: leave out --c or --format glsl", "");
    return DONE;
}

/* ---------------------------------------------------------------------- order of work */

/* Makes the folders and keeps other runs out until the program ends. */
static int take_folder(const matrix_job *m)
{
    char path[1024];
    int fd;
    snprintf(path, sizeof path, "%s%s", m->folder, m->spirv ? "spirv/" : "glsl/");
    if (!folder_make(path)) return IO;
    fd = open(m->folder, O_RDONLY); /* kept open */
    if (fd < 0 || flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return DONE;
    fprintf(stderr, "shadergen: another shadergen matrix is at work in %s; wait for it\n", m->folder);
    return IO;
}

static void print_refused(const matrix_job *m)
{
    int32_t i;
    for (i = 0; i < m->list.count; ++i) {
        char config[4096] = "";
        const char *at;
        if (!m->list.items[i].refused) continue;
        hbil_config_print(&m->list.items[i].config, 0, config, sizeof config, NULL);
        fprintf(stderr, "shadergen: refused: %s\n", config);
        for (at = m->list.items[i].refused; *at; at += strcspn(at, "\n"), at += *at == '\n')
            fprintf(stderr, "    %.*s\n", (int)strcspn(at, "\n"), at);
    }
}

static int all_refused(const matrix_job *m)
{
    int32_t i;
    for (i = 0; i < m->list.count; ++i)
        if (!m->list.items[i].refused) return 0;
    if (m->verbose) print_refused(m);
    fprintf(stderr, "shadergen: all %d combinations are refused; the first: %s\n", (int)m->combinations,
            m->list.items[0].refused);
    return 1;
}

/* manifest, C and state: all or none. Then what is left over goes. */
static int finish(matrix_job *m)
{
    files outputs = { NULL, 0, 0 };
    file *f = files_add(&outputs);
    int differs = 0, code = f ? output_manifest(m, f) : no_memory();
    if (code == DONE && m->c && !m->stale) /* --check may lack what C is made from */
        code = files_add(&outputs) && (f = files_add(&outputs)) != NULL ? output_c(m, f - 1, f) : no_memory();
    if (code == DONE && !m->check)
        code = (f = files_add(&outputs)) != NULL ? state_print(m, f) : no_memory();
    if (code == DONE && !files_write(&outputs, m->check ? &differs : NULL)) code = IO;
    m->stale += differs;
    files_free(&outputs);
    return code == DONE ? state_remove_old(m) : code;
}

static void summary(const matrix_job *m, double begin)
{
    const matrix_counts *n = &m->counts;
    struct rusage used;
    if (m->verbose) print_refused(m);
    if (!m->quiet)
        fprintf(stderr, "shadergen: %d variants of %d combinations, %d refused, %d equal to others; %d files, %.1f MB; "
                "%d compiled, %d removed; %.1f s\n", (int)n->variants, (int)m->combinations, (int)n->refused,
                (int)m->equal, (int)n->files, (double)n->bytes * 1e-6, (int)m->compiled, (int)m->removed,
                seconds() - begin);
    if (m->verbose && getrusage(RUSAGE_SELF, &used) == 0)
        fprintf(stderr, "shadergen: %d threads, peak memory %ld MB, processor %.1f s\n", m->threads,
                used.ru_maxrss / 1024, (double)(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
                1e-6 * (double)(used.ru_utime.tv_usec + used.ru_stime.tv_usec));
}

static int run(matrix_job *m)
{
    const double begin = seconds();
    int code = list_read(m);
    if (code == DONE && all_refused(m)) code = CONFIG;
    if (code == DONE && !m->check) code = take_folder(m);
    if (code == DONE) code = state_read(m);
    if (code == DONE && !m->check) code = state_clean(m);
    if (code == DONE) code = build_all(m);
    if (code == DONE && all_refused(m)) code = CONFIG;
    if (code == DONE) code = finish(m);
    if (code != DONE) return code;
    summary(m, begin);
    if (!m->stale) return DONE;
    fprintf(stderr, "shadergen: %d files in %s are not up to date; run it without --check\n", (int)m->stale, m->folder);
    return STALE;
}

int matrix(int argc, char **argv)
{
    matrix_job m;
    char folder[1024];
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    int i, code;
    for (i = 1; i < argc; ++i)
        if (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0) return help();
    memset(&m, 0, sizeof m);
    m.spirv = 1;
    m.threads = cores < 1 ? 1 : cores < THREADS_MAX ? (int)cores : THREADS_MAX;
    code = read_arguments(&m, argc, argv);
    if (code != DONE) return code;
    if (strlen(m.folder) > 900) return usage("path too long: ", m.folder);
    snprintf(folder, sizeof folder, "%s%s", m.folder, m.folder[strlen(m.folder) - 1] == '/' ? "" : "/");
    m.folder = folder;
    pthread_mutex_init(&m.lock, NULL);
    pthread_cond_init(&m.changed, NULL);
    code = run(&m);
    if (m.journal) fclose(m.journal);
    variants_free(&m.list);
    variants_free(&m.old);
    map_free(&m.old_index);
    map_free(&m.slot_index);
    free(m.slots);
    free(m.state);
    free(m.manifest);
    pthread_cond_destroy(&m.changed);
    pthread_mutex_destroy(&m.lock);
    return code;
}
