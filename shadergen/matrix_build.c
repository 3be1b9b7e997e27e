/* matrix_build.c - makes the variants of a matrix on all threads. See matrix.h. */
#include "matrix.h"
#include "cost.h"
#include "../backends/hbil_glslang.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define WORDS_MAX 65536 /* SPIR-V words of one pass */

/* A text on its way into its slot. */
typedef struct source { const char *pass, *suffix, *text, *config; size_t size; hbil_target target; } source;

typedef struct worker { matrix_job *job; uint32_t *words; char log[8192]; cost_cache costs; } worker;

/* ---------------------------------------------------------------------- what people see */

double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* On a terminal one line, written over and over, else a line every two seconds. `done` is 0 at the begin. Main thread
 * only. The cursor stays at the begin of the line, so that a message takes its place. */
void progress(const matrix_job *m, const char *what, int32_t done, int32_t all)
{
    static const char hashes[] = "##############################", dots[] = "..............................";
    static double begin, last;
    const double now = seconds();
    const int terminal = isatty(STDERR_FILENO), full = (int)(30 * (int64_t)done / all);
    char line[160];
    if (m->quiet) return;
    if (done == 0) begin = last = now;
    if (terminal && done == all && last > begin) fprintf(stderr, "\r%79s\r", "");
    if (done == 0 || done == all || now - last < (terminal ? 0.1 : 2.0)) return;
    last = now;
    snprintf(line, sizeof line, "%d of %d, %.0f s left", (int)done, (int)all, (now - begin) / done * (all - done));
    if (terminal) fprintf(stderr, "\rshadergen: %s [%.*s%.*s] %-24s\r", what, full, hashes, 30 - full, dots, line);
    else fprintf(stderr, "shadergen: %s: %s\n", what, line);
}

void say_stale(matrix_job *m, const char *name, const char *what)
{
    ++m->stale;
    fprintf(stderr, "shadergen: %s%s %s\n", m->folder, name, what);
}

/* ---------------------------------------------------------------------- slots */

const char *slot_name(const slot *s) { return strchr(s->file, '/') + 1; }
int         name_of(const slot *s)   { return (int)strcspn(slot_name(s), "-"); }

int32_t slot_of(matrix_job *m, uint64_t key)
{
    int32_t found = map_find(&m->slot_index, key);
    if (found >= 0) return found;
    if (m->slot_count == m->slot_room) {
        int32_t room = m->slot_room ? 2 * m->slot_room : 256;
        slot *more = (slot *)realloc(m->slots, (size_t)room * sizeof *more);
        if (!more) return -1;
        m->slots = more;
        m->slot_room = room;
    }
    if (!map_put(&m->slot_index, key, m->slot_count)) return -1;
    memset(&m->slots[m->slot_count], 0, sizeof *m->slots);
    m->slots[m->slot_count].key = key;
    return m->slot_count++;
}

/* Is the file there, with the bytes that its name tells? */
static int is_whole(const matrix_job *m, const slot *s)
{
    char path[1200], hash[20];
    size_t size = 0;
    char *data;
    snprintf(path, sizeof path, "%s%s", m->folder, s->file);
    data = read_all(path, &size);
    if (!data) return 0;
    snprintf(hash, sizeof hash, "%016" PRIx64, hash_bytes(HASH, data, size));
    free(data);
    return size == s->bytes && strncmp(slot_name(s) + name_of(s) + 1, hash, 16) == 0;
}

/* Under lock: a thread writes at a time, as texts that differ may have equal words. */
static int store(matrix_job *m, slot *s, const source *from, const void *data, size_t size)
{
    files one = { NULL, 0, 0 };
    file *f = files_add(&one);
    int ok = 0, differs = 0;
    snprintf(s->file, sizeof s->file, "%s%s-%016" PRIx64 "%s", m->spirv ? "spirv/" : "glsl/", from->pass,
             hash_bytes(HASH, data, size), from->suffix);
    s->bytes = size;
    if (f) f->data = (char *)malloc(size + 1);
    if (f && f->data) {
        memcpy(f->data, data, size);
        f->size = size;
        snprintf(f->path, sizeof f->path, "%s%s", m->folder, s->file);
        ok = files_write(&one, m->check ? &differs : NULL);
    } else {
        no_memory();
    }
    m->stale += differs;
    files_free(&one);
    return ok ? DONE : IO;
}

/* The words of a text, in w->words. */
static int translate(worker *w, const source *from, size_t *size)
{
    size_t count = 0;
    const int ok = hbil_glslang_compile(from->text, from->target, w->words, WORDS_MAX, &count, w->log, sizeof w->log)
                 == HBIL_GLSLANG_OK;
    *size = count * sizeof *w->words;
    return ok && count ? DONE : COMPILER;
}

/* Under lock: waits for another thread that works on it. Is it good now, or 0: the caller has it, BUSY. */
static int acquire(matrix_job *m, int32_t index)
{
    while (m->slots[index].status == SLOT_BUSY) pthread_cond_wait(&m->changed, &m->lock);
    if (m->slots[index].status == SLOT_GOOD) return 1;
    if (m->slots[index].status == SLOT_LISTED) {
        slot copy = m->slots[index];
        int whole;
        m->slots[index].status = SLOT_BUSY;
        pthread_mutex_unlock(&m->lock);
        whole = is_whole(m, &copy);
        pthread_mutex_lock(&m->lock);
        if (!whole && m->check) say_stale(m, copy.file, "is not up to date");
        if (whole || m->check) {
            m->slots[index].status = SLOT_GOOD;
            pthread_cond_broadcast(&m->changed);
            return 1;
        }
    }
    m->slots[index].status = SLOT_BUSY;
    return 0;
}

static void release(matrix_job *m, int32_t index, slot_status status)
{
    m->slots[index].status = status;
    pthread_cond_broadcast(&m->changed);
}

/* The slot of a text, its file made if need be. */
static int make_file(worker *w, const source *from, uint64_t key, int32_t *index)
{
    matrix_job *m = w->job;
    int code = DONE;
    pthread_mutex_lock(&m->lock);
    *index = slot_of(m, key);
    if (*index >= 0 && !acquire(m, *index)) {
        const void *data = from->text;
        size_t size = from->size;
        slot made;
        if (m->spirv) {
            pthread_mutex_unlock(&m->lock);
            code = translate(w, from, &size);
            pthread_mutex_lock(&m->lock);
            data = w->words;
            ++m->compiled;
        }
        made = m->slots[*index];
        if (code != DONE && m->code == DONE)
            fprintf(stderr, "shadergen: glslang refused pass %s of a config; please report this with it: %s\n%s\n",
                    from->pass, from->config, w->log);
        if (code == DONE) code = m->code; /* of another thread: its message is enough */
        if (code == DONE) code = store(m, &made, from, data, size);
        if (m->code == DONE) m->code = code;
        m->slots[*index] = made;
        release(m, *index, code == DONE ? SLOT_GOOD : SLOT_NEW);
    }
    pthread_mutex_unlock(&m->lock);
    return *index < 0 ? no_memory() : code;
}

/* ---------------------------------------------------------------------- variants */

/* Behind #version a text tells in comments what made it. */
static char *behind_head(char *text)
{
    char *at = text + strcspn(text, "\n");
    while (strncmp(at, "\n//", 3) == 0) at += 1 + strcspn(at + 1, "\n");
    return at;
}

/* A text that several configs share must not name one of them: cuts the line out that does. */
static void cut_rebuild(char *text)
{
    char *at = strstr(text, "\n// rebuild "), *end;
    if (!at || at >= behind_head(text)) return;
    end = at + 1 + strcspn(at + 1, "\n");
    memmove(at, end, strlen(end) + 1);
}

/* Takes up one text of a variant; text: malloc'd, NULL if there was no memory for it. */
static int make_pass(worker *w, variant *v, const char *pass, const char *suffix, char *text, const char *config)
{
    source from = { pass, suffix, text, config, 0, (hbil_target)v->config.target };
    uint64_t key = hash_bytes(HASH, pass, strlen(pass));
    const char *code;
    int32_t index = -1;
    int result;
    if (!text) return no_memory();
    if (!w->job->spirv) cut_rebuild(text);
    from.size = strlen(text);
    code = w->job->spirv ? behind_head(text) : text; /* #version says no more than target and stage */
    key = hash_bytes(key, &v->config.target, sizeof v->config.target);
    key = hash_bytes(key, &v->config.stage, sizeof v->config.stage);
    key = hash_bytes(key, code, strlen(code));
    result = make_file(w, &from, key, &index);
    free(text);
    if (result == DONE) v->slots[v->count++] = index;
    return result;
}

/* What the manifest says of a variant beside its files, as members of a JSON object. It follows from the plan alone and
 * may take its time: the state keeps it. */
static char *facts_of(worker *w, const hbil_plan *plan)
{
    static const char form[] = "\"uniform_bytes\": %u, \"cost\": {\"fetches\": %.9g, \"loads\": %.9g, \"stores\": %.9g, \"atomics\": %.9g, "
        "\"bytes_read\": %.9g, \"bytes_written\": %.9g, \"floats\": %.9g, \"divisions\": %.9g, \"registers\": %d, \"unknown_loops\": %d}";
    const size_t room = sizeof form + 160;
    cost_total *t = (cost_total *)malloc(sizeof *t);
    char *text = t && cost_of_plans(plan, &w->costs, t) == DONE ? (char *)malloc(room) : NULL;
    if (text)
        snprintf(text, room, form, (unsigned)plan->constants_size, t->fixed.access[COST_FETCH], t->fixed.access[COST_LOAD],
                 t->fixed.access[COST_STORE], t->fixed.access[COST_ATOMIC], t->fixed.bytes_read, t->fixed.bytes_written,
                 t->fixed.ops[COST_FLOAT], t->fixed.ops[COST_DIVIDE], (int)t->registers, (int)t->unknown);
    free(t);
    return text;
}

/* From an earlier run, if all its files are whole. */
static int take_old(matrix_job *m, variant *v)
{
    int32_t i, old = map_find(&m->old_index, v->hash);
    int good = old >= 0;
    if (!good) return 0;
    pthread_mutex_lock(&m->lock);
    for (i = 0; i < m->old.items[old].count && good; ++i) {
        v->slots[i] = m->old.items[old].slots[i];
        good = acquire(m, v->slots[i]);
        if (!good) release(m, v->slots[i], SLOT_NEW);
    }
    pthread_mutex_unlock(&m->lock);
    if (good) v->facts = strdup(m->old.items[old].facts);
    if (v->facts) v->count = m->old.items[old].count;
    return v->facts != NULL;
}

static int make_variant(worker *w, variant *v)
{
    matrix_job *m = w->job;
    hbil_diag items[16];
    hbil_diags diags = { items, 16, 0 };
    hbil_plan plan;
    char config[4096] = "";
    size_t size;
    int32_t i;
    int code = DONE;
    if (v->refused || take_old(m, v)) return DONE;
    if (hbil_plan_build(&v->config, &plan, &diags) != HBIL_OK) {
        v->refused = reasons(&diags);
        return v->refused ? DONE : no_memory();
    }
    hbil_config_print(&v->config, 0, config, sizeof config, NULL);
    for (i = 0; i < (int32_t)plan.pass_count && code == DONE; ++i)
        code = make_pass(w, v, plan.passes[i].name, language_suffix(&plan, m->spirv ? SPIRV : GLSL),
                         build_glsl(&plan, i, NULL, &size, NULL), config);
    if (code == DONE && plan.config.stage == HBIL_STAGE_FRAGMENT) {
        file vertex = { "", NULL, 0 };
        build_vertex(&plan, &vertex);
        code = make_pass(w, v, "vertex", m->spirv ? ".spv" : ".vert", vertex.data, config);
    }
    if (code == DONE && !(v->facts = facts_of(w, &plan))) code = no_memory();
    if (code != DONE || m->check) return code;
    pthread_mutex_lock(&m->lock);
    code = state_append(m, v);
    pthread_mutex_unlock(&m->lock);
    return code;
}

static void *work(void *arg)
{
    matrix_job *m = (matrix_job *)arg;
    worker w = { m, (uint32_t *)malloc(WORDS_MAX * sizeof(uint32_t)), "", { NULL, 0 } };
    pthread_mutex_lock(&m->lock);
    if (!w.words) m->code = no_memory();
    while (m->next < m->list.count && m->code == DONE) {
        variant *v = &m->list.items[m->next++];
        int code;
        pthread_mutex_unlock(&m->lock);
        code = make_variant(&w, v);
        pthread_mutex_lock(&m->lock);
        ++m->done;
        if (m->code == DONE) m->code = code;
    }
    --m->running;
    pthread_cond_broadcast(&m->changed);
    pthread_mutex_unlock(&m->lock);
    free(w.words);
    cost_cache_free(&w.costs);
    return NULL;
}

/* Shows how far it is until all have ended. */
static void watch(matrix_job *m)
{
    pthread_mutex_lock(&m->lock);
    while (m->running) {
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += 100000000;
        if (until.tv_nsec >= 1000000000) { until.tv_nsec -= 1000000000; ++until.tv_sec; }
        pthread_cond_timedwait(&m->changed, &m->lock, &until);
        progress(m, "variants", m->done, m->list.count);
    }
    pthread_mutex_unlock(&m->lock);
}

int build_all(matrix_job *m)
{
    pthread_t *threads = (pthread_t *)calloc((size_t)m->threads, sizeof *threads);
    int i, started = 0;
    if (!threads || !hbil_glslang_init()) { free(threads); return no_memory(); }
    progress(m, "variants", 0, m->list.count);
    pthread_mutex_lock(&m->lock);
    while (started < m->threads && pthread_create(&threads[started], NULL, work, m) == 0) ++started;
    m->running = started;
    pthread_mutex_unlock(&m->lock);
    watch(m);
    for (i = 0; i < started; ++i) pthread_join(threads[i], NULL);
    hbil_glslang_shutdown();
    free(threads);
    return started ? m->code : no_memory();
}
