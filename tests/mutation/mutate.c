/* mutate.c - takes each guard out of the shaders in turn and shows which test fails for it. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "guards.h"
#include "trial.h"
#include "../../examples/frame/image.h"

enum { WORDS = 600, JOBS_MAX = 64, LIMIT_S = 600 };

/* What became of a guard. */
typedef struct outcome { char kind; char by[128], why[WORDS]; } outcome; /* kind: K killed, S survived, U in no case's text, E fault */

typedef struct options {
    const char *root, *only, *out;
    int list, lint, baseline, jobs, sample, open;
} options;

static guard_list guards;
static outcome   *outcomes;     /* of this run */
static char       error[1024];
static const char *cases = ""; /* part of the names of those that run */
static int         quick;

/* ------------------------------------------------------------------------------------------------------------ the recorded table */

/* Text of guards.md, which has a row for each guard: | id | guard | without | killed by | how |. NULL: there is none. */
static char *table;

static char *read_table(const char *root)
{
    char path[1024], ignored[256];
    snprintf(path, sizeof path, "%s/tests/mutation/guards.md", root);
    return text_read(path, 1 << 22, "a text", ignored, sizeof ignored);
}

/* Row of an id; NULL: none. */
static const char *row_of(const char *id)
{
    char start[128];
    snprintf(start, sizeof start, "| `%s` |", id);
    return table ? strstr(table, start) : NULL;
}

/* n-th cell of a row, from 0. */
static void cell(const char *row, int n, char *out, size_t size)
{
    const char *from = row, *end;
    for (; n >= 0; --n) from = strstr(from, "| ") + 2;
    end = strstr(from, " |");
    snprintf(out, size, "%.*s", (int)(end - from), from);
}

/* A | in a cell would end it. */
static void escape(const char *from, char *out, size_t size)
{
    size_t n = 0;
    for (; *from && n + 8 < size; ++from)
        if (*from == '|') n += (size_t)sprintf(out + n, "&#124;");
        else out[n++] = *from;
    out[n] = 0;
}

/* Does the table have this guard, as it is now? */
static int is_known(const guard *g)
{
    const char *row = row_of(g->id);
    char code[700], was[700];
    escape(g->code, code, sizeof code);
    if (row) cell(row, 1, was, sizeof was);
    return row && strncmp(was + 1, code, strlen(code)) == 0 && strlen(was) == strlen(code) + 2;
}

static int lint(void)
{
    int i, faults = 0;
    const char *at;
    for (i = 0; i < guards.count; ++i) {
        const guard *g = &guards.at[i];
        if (!is_known(g))
            faults += printf("%s, line %d: %s: no test is known to fail without it; run make mutate, add a case to tests/extreme if it survives\n", g->id,
                             g->line, g->code) > 0;
    }
    for (at = table; at && (at = strstr(at, "\n| `")) != NULL; ++at) {
        char id[128];
        snprintf(id, sizeof id, "%.*s", (int)strcspn(at + 4, "`"), at + 4);
        for (i = 0; i < guards.count && strcmp(guards.at[i].id, id) != 0; ++i) { }
        if (i == guards.count) faults += printf("%s: in the table, not in the sources: run make mutate\n", id) > 0;
    }
    if (faults == 0) printf("%d guards: each has a case that fails without it\n", guards.count);
    return faults != 0;
}

/* Of this run, or as it stands in the table. */
static void write_row(FILE *f, const guard *g, const outcome *o)
{
    char code[700], without[700], why[700];
    const char *row = row_of(g->id);
    if (!o->kind && is_known(g)) fprintf(f, "%.*s\n", (int)strcspn(row, "\n"), row);
    if (o->kind != 'K') return;
    escape(g->code, code, sizeof code);
    escape(g->without, without, sizeof without);
    escape(o->why, why, sizeof why);
    fprintf(f, "| `%s` | `%s` | `%s` | %s | %s |\n", g->id, code, without, o->by, why);
}

/* Survivors get no row, so that the lint fails. */
static int write_table(const options *o)
{
    char path[1024], *text = NULL;
    size_t size = 0;
    FILE *f = open_memstream(&text, &size);
    int i, killed = 0, ok;
    if (!f) return 0;
    for (i = 0; i < guards.count; ++i) killed += outcomes[i].kind == 'K' || (!outcomes[i].kind && is_known(&guards.at[i]));
    fprintf(f, "# Guards of the shaders, and the test that fails without each\n\nWritten by `make mutate` (hbil-mutate): do not edit. Each guard that is "
               "found in shadergen/glsl is taken out of the emitted text,\nand the cases of tests/extreme run until one fails, on lavapipe, fragments on "
               "OSMesa; *on loose*: on a CPU as inexact as Vulkan\nallows (tests/twin). *contract*: an output is not finite or not in its range. "
               "*expected*: what the case knows to be true is not. *undefined*: an\noperation that GLSL leaves undefined. *work*: a pass does more than "
               "the case needs. *ends*: the program does not end, or crashes.\n\n%d guards; %d killed.\n\n"
               "| guard | code | without it | case that fails | how |\n|---|---|---|---|---|\n", guards.count, killed);
    for (i = 0; i < guards.count; ++i)
        write_row(f, &guards.at[i], &outcomes[i]);
    fclose(f);
    snprintf(path, sizeof path, "%s/tests/mutation/guards.md", o->root);
    ok = text_write(o->out ? o->out : path, text, error, sizeof error);
    free(text);
    return ok;
}

/* --------------------------------------------------------------------------------------------------------------------- one guard */

/* One case without the guard. 1: it was told apart. A case that fails with all guards in place says nothing of this one. */
static int kills(int i, const guard *g, outcome *o)
{
    char ignored[WORDS];
    const int held = trial_run(i, g, o->why, sizeof o->why);
    trial_label(i, o->by);
    if (held == 1) o->kind = 'S';
    else if (trial_run(i, NULL, ignored, sizeof ignored) == 1) o->kind = held == 0 ? 'K' : 'E';
    else if (o->kind == 'U') o->kind = 'S';
    return o->kind == 'K' || o->kind == 'E';
}

/* Cases with a truth of their own, and the hazards. */
static int is_first(const extreme_case *c)
{
    return strncmp(c->name, "truth_", 6) == 0 || (c->name[0] == 'H' && c->frames < 10);
}

/* What killed it last time, then the cases with a truth of their own, then all; those of a config together, which is compiled once. */
static void run_guard(const guard *g, const char *last, outcome *o)
{
    const int n = trial_count();
    char *done = (char *)calloc((size_t)n, 1);
    char label[128];
    int round, i, k, tried = 0;
    if (!done) exit(3);
    o->kind = 'U';
    for (round = 0; round < (quick ? 2 : 3); ++round)
        for (i = n - 1; i >= 0; --i) {
            if (done[i] || (round == 0 && strcmp(last, trial_label(i, label)) != 0) || (round == 1 && !is_first(trial_case(i)))) continue;
            if (!strstr(trial_label(i, label), cases) || !trial_has(i, g)) continue;
            for (k = i; k >= 0; --k) {
                if (done[k] || trial_group(k) != trial_group(i) || (round < 2 && k != i) || !strstr(trial_label(k, label), cases)) continue;
                done[k] = 1;
                ++tried;
                if (!kills(k, g, o)) continue;
                free(done);
                return;
            }
        }
    snprintf(o->by, sizeof o->by, "%d cases", tried);
    free(done);
}

static void run_baseline(int from, int stride, outcome *o)
{
    int i, failed = 0;
    for (i = 0; i < trial_count(); ++i) {
        char why[WORDS], label[128];
        if (trial_group(i) % stride != from || !strstr(trial_label(i, label), cases) || trial_run(i, NULL, why, sizeof why) == 1) continue;
        ++failed;
        printf("without a mutation: %s, \"%s\": %s\n", label, trial_case(i)->config, why);
        fflush(stdout);
    }
    o->kind = failed ? 'K' : 'S';
    snprintf(o->by, sizeof o->by, "%d", failed);
}

/* -------------------------------------------------------------------------------------------------------------------------- jobs */

typedef struct job { pid_t pid; int pipe, index; time_t start; } job;

static int start_job(job *j, int index, const options *o)
{
    int ends[2];
    fflush(stdout);
    if (pipe(ends) || (j->pid = fork()) < 0) return 0;
    if (j->pid == 0) {
        outcome result;
        char last[128] = "";
        memset(&result, 0, sizeof result);
        close(ends[0]);
        if (o->baseline) run_baseline(index, o->jobs, &result);
        else {
            const char *row = row_of(guards.at[index].id);
            if (row) cell(row, 3, last, sizeof last);
            run_guard(&guards.at[index], last, &result);
        }
        _exit(write(ends[1], &result, sizeof result) == (ssize_t)sizeof result ? 0 : 3);
    }
    close(ends[1]);
    j->pipe = ends[0];
    j->index = index;
    j->start = time(NULL);
    return 1;
}

/* 0: still at work. */
static int end_job(job *j, outcome *o)
{
    int status = 0;
    const int late = time(NULL) - j->start > LIMIT_S;
    if (late) kill(j->pid, SIGKILL);
    if (waitpid(j->pid, &status, late ? 0 : WNOHANG) != j->pid) return 0;
    if (read(j->pipe, o, sizeof *o) != (ssize_t)sizeof *o) {
        memset(o, 0, sizeof *o);
        o->kind = 'K';
        snprintf(o->by, sizeof o->by, "-");
        if (late) snprintf(o->why, sizeof o->why, "ends: not within %d s", LIMIT_S);
        else snprintf(o->why, sizeof o->why, "ends: by signal %d", WIFSIGNALED(status) ? WTERMSIG(status) : 0);
    }
    close(j->pipe);
    j->pid = 0;
    return 1;
}

static void report(int index, int done, int all, const options *o)
{
    static const char *const words[] = { "killed", "SURVIVES", "IN NO CASE", "FAULT" };
    const outcome *r = &outcomes[index];
    const guard *g = &guards.at[index];
    if (o->baseline) return;
    printf("[%d/%d] %s line %d: %s -> %s: %s; %s; %s\n", done, all, g->id, g->line, g->code, g->without,
           words[strchr("KSUE", r->kind) - "KSUE"], r->by, r->kind == 'K' || r->kind == 'E' ? r->why : "");
    fflush(stdout);
}

static int chosen(int index, const options *o)
{
    if (o->open && is_known(&guards.at[index])) return 0;
    if (o->only && !strstr(guards.at[index].id, o->only)) return 0;
    if (o->sample && !is_known(&guards.at[index])) return 0;
    return o->sample == 0 || index % ((guards.count + o->sample - 1) / o->sample) == 0;
}

static int run_jobs(const options *o)
{
    job jobs[JOBS_MAX];
    int next = 0, done = 0, all = 0, running = 0, i;
    const int count = o->baseline ? o->jobs : guards.count;
    const struct timespec nap = {0, 20000000};
    memset(jobs, 0, sizeof jobs);
    for (i = 0; i < count; ++i) all += o->baseline || chosen(i, o);
    do {
        for (i = 0; i < o->jobs; ++i) {
            if (jobs[i].pid && end_job(&jobs[i], &outcomes[jobs[i].index])) {
                --running;
                report(jobs[i].index, ++done, all, o);
                if (!o->baseline && !o->sample && done % 10 == 0 && !write_table(o)) return 0; /* a run that is stopped leaves what it has */
            }
            while (next < count && !(o->baseline || chosen(next, o))) ++next;
            if (jobs[i].pid || next == count) continue;
            if (!start_job(&jobs[i], next++, o)) return snprintf(error, sizeof error, "fork: %s", strerror(errno)), 0;
            ++running;
        }
        nanosleep(&nap, NULL);
    } while (running || next < count);
    return 1;
}

static int summary(void)
{
    int i, killed = 0, open = 0;
    for (i = 0; i < guards.count; ++i) {
        const guard *g = &guards.at[i];
        if (outcomes[i].kind == 'K') ++killed;
        if (!outcomes[i].kind || outcomes[i].kind == 'K') continue;
        if (++open == 1) printf("\nno test fails without:\n");
        printf("  %s line %d: %s -> %s (%s)\n", g->id, g->line, g->code, g->without, outcomes[i].by);
    }
    printf("%d guards taken out: %d killed, %d open\n", killed + open, killed, open);
    return open != 0;
}

static const char help[] =
    "hbil-mutate - takes each guard out of the shaders in turn: which test fails?\n\n"
    "usage: hbil-mutate [options]\n"
    "  --list          the guards that the sources have\n"
    "  --only TEXT     guards whose id has this part\n"
    "  --cases TEXT    cases whose name has this part\n"
    "  --sample N      at most N of those that have a row in the table, evenly from all\n"
    "  --open          only guards that the table does not have\n"
    "  --quick         only the hazards and the cases with a truth of their own\n"
    "  --lint          only compare the sources with the table: every guard has a row\n"
    "  --baseline      only run all cases with all guards in place\n"
    "  --jobs N        at once; default: the number of processors\n"
    "  --root DIR      the repository; default: .\n"
    "  --out FILE      the table, with what this run has found; default: DIR/tests/mutation/guards.md\n"
    "exit: 0 a test fails without each guard, 1 not so, 2 wrong usage, 3 cannot be run\n";

static int parse(int argc, char **argv, options *o)
{
    int i;
    o->root = ".";
    o->jobs = (int)sysconf(_SC_NPROCESSORS_ONLN);
    for (i = 1; i < argc; ++i) {
        const char *a = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (strcmp(a, "--list") == 0) o->list = 1;
        else if (strcmp(a, "--lint") == 0) o->lint = 1;
        else if (strcmp(a, "--quick") == 0) quick = 1;
        else if (strcmp(a, "--open") == 0) o->open = 1;
        else if (strcmp(a, "--baseline") == 0) o->baseline = 1;
        else if (value && strcmp(a, "--only") == 0) o->only = argv[++i];
        else if (value && strcmp(a, "--cases") == 0) cases = argv[++i];
        else if (value && strcmp(a, "--out") == 0) o->out = argv[++i];
        else if (value && strcmp(a, "--root") == 0) o->root = argv[++i];
        else if (value && strcmp(a, "--sample") == 0) o->sample = atoi(argv[++i]);
        else if (value && strcmp(a, "--jobs") == 0) o->jobs = atoi(argv[++i]);
        else return fprintf(stderr, "hbil-mutate: %s? see hbil-mutate --help\n", a), 0;
    }
    if (o->jobs < 1) o->jobs = 1;
    if (o->jobs > JOBS_MAX) o->jobs = JOBS_MAX;
    return 1;
}

int main(int argc, char **argv)
{
    options o;
    char folder[1024], label[128];
    int i, run, open;
    memset(&o, 0, sizeof o);
    setenv("LP_NUM_THREADS", "0", 0); /* the jobs are what runs side by side */
    setenv("GALLIVM_PERF", "nopt", 0); /* lavapipe: what compiles quickly; no shader runs for long */
    if (argc > 1 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) return fputs(help, stdout), 0;
    if (!parse(argc, argv, &o)) return 2;
    snprintf(folder, sizeof folder, "%s/shadergen/glsl", o.root);
    if (!guards_read(folder, &guards, error, sizeof error)) return fprintf(stderr, "hbil-mutate: %s\n", error), 3;
    table = read_table(o.root);
    if (o.list) {
        for (i = 0; i < guards.count; ++i)
            if (chosen(i, &o)) printf("%s line %d: %s -> %s\n", guards.at[i].id, guards.at[i].line, guards.at[i].code, guards.at[i].without);
        return 0;
    }
    if (o.lint) return lint();
    outcomes = (outcome *)calloc((size_t)guards.count + JOBS_MAX, sizeof *outcomes);
    if (!outcomes || !trial_prepare(error, sizeof error) || !run_jobs(&o)) return fprintf(stderr, "hbil-mutate: %s\n", error), 3;
    if (o.baseline) {
        for (i = 0, open = 0; i < o.jobs; ++i) open += outcomes[i].kind != 'S';
        for (i = 0, run = 0; i < trial_count(); ++i) run += strstr(trial_label(i, label), cases) != NULL;
        if (!run) return fprintf(stderr, "hbil-mutate: no case has %s in its name; tests/extreme lists them\n", cases), 2;
        printf("%d cases; %s\n", run, open ? "some fail with all guards in place" : "all hold with all guards in place");
        return open != 0;
    }
    open = summary();
    if (!o.sample && !write_table(&o)) return fprintf(stderr, "hbil-mutate: %s\n", error), 3;
    return open;
}
