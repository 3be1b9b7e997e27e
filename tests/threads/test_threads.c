/* test_threads.c - the core keeps no state: eight threads build plans and write texts at once, of equal and of different
 * configs, and get what one thread gets. Built with ThreadSanitizer, so that shared memory is found even where the results
 * happen to be right. */
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define THREADS 8
#define ROUNDS 3
#define TEXT_BYTES (1u << 19)

static const char *const configs[] = {
    "", "target=gl", "outputs=ao", "outputs=bent slices=1 steps=1", "reach=2.5 dynamic=reach+slices", "noise=ign spacing=geometric",
    "projection=orthographic depth=device clip=gl", "normals=depth width=1920 height=1080",
    "depth=device depth_direction=reversed depth_far=infinite normals=world", "slices=99 reach=-1", "no_such_option=1",
};
enum { CONFIGS = sizeof configs / sizeof configs[0] };

/* All that the core makes of one config. */
typedef struct result {
    hbil_plan plan;
    hbil_diag diags[8];
    int32_t   diag_count;
    uint64_t  hash;
    size_t    size;
    char      text[TEXT_BYTES]; /* printed config, every pass, manifest, uniform block */
} result;

static result           *serial; /* one per config, by the main thread alone */
static pthread_barrier_t together;

static int append(result *r, hbil_result code, size_t need)
{
    r->size += need;
    return code == HBIL_OK && r->size < TEXT_BYTES;
}

/* The rest of the room for text. */
static char  *at(result *r)   { return r->text + r->size; }
static size_t room(result *r) { return TEXT_BYTES - r->size; }

/* 0: the core refused what it should do, or the text does not fit. A refused config is no fault. */
static int make(const char *text, result *r)
{
    hbil_config config;
    hbil_diags  diags;
    hbil_frame  frame;
    size_t      need = 0;
    int32_t     i;
    int         ok;

    memset(r, 0, sizeof *r);
    memset(&config, 0, sizeof config);
    memset(&frame, 0, sizeof frame);
    diags.items = r->diags;
    diags.capacity = 8;
    diags.count = 0;
    hbil_config_parse(&config, text, strlen(text), &diags);
    ok = append(r, hbil_config_print(&config, 1, at(r), room(r), &need), need);
    r->hash = hbil_config_hash(&config);
    if (hbil_plan_build(&config, &r->plan, &diags) == HBIL_OK) {
        for (i = 0; ok && i < (int32_t)r->plan.pass_count; ++i) ok = append(r, hbil_emit_glsl(&r->plan, i, at(r), room(r), &need), need);
        ok = ok && append(r, hbil_emit_manifest(&r->plan, at(r), room(r), &need), need);
        /* an empty frame is refused: the messages count */
        if (ok) hbil_pack_constants(&r->plan, &frame, at(r), room(r), &need, &diags);
    }
    r->diag_count = diags.count;
    return ok;
}

/* Round 0: all threads on the same config. Others: each on another one. Returns the number of results that differ. */
static void *work(void *argument)
{
    const size_t thread = *(const size_t *)argument;
    result      *mine = (result *)malloc(sizeof *mine);
    size_t       round, i, wrong = mine == NULL;

    for (round = 0; round < ROUNDS; ++round) {
        for (i = 0; i < CONFIGS; ++i) {
            const size_t c = round == 0 ? i : (i + thread) % CONFIGS;
            pthread_barrier_wait(&together); /* so that the calls do overlap */
            if (!mine || (make(configs[c], mine) && memcmp(mine, &serial[c], sizeof *mine) == 0)) continue;
            fprintf(stderr, "thread %lu, config \"%s\": differs from one thread alone\n", (unsigned long)thread, configs[c]);
            ++wrong;
        }
    }
    free(mine);
    return wrong ? argument : NULL;
}

int main(void)
{
    pthread_t threads[THREADS];
    size_t    numbers[THREADS], i;
    int       failed = 0;

    serial = (result *)calloc(CONFIGS, sizeof *serial);
    if (!serial || pthread_barrier_init(&together, NULL, THREADS) != 0) return 1;
    for (i = 0; i < CONFIGS; ++i) {
        if (make(configs[i], &serial[i])) continue;
        fprintf(stderr, "config \"%s\": the core refuses, or TEXT_BYTES is too small\n", configs[i]);
        failed = 1;
    }
    for (i = 0; i < THREADS; ++i) {
        numbers[i] = i;
        /* the others would wait for it at the barrier for ever */
        if (pthread_create(&threads[i], NULL, work, &numbers[i]) != 0) { perror("pthread_create"); exit(1); }
    }
    for (i = 0; i < THREADS; ++i) {
        void *wrong = NULL;
        pthread_join(threads[i], &wrong);
        if (wrong) failed = 1;
    }
    pthread_barrier_destroy(&together);
    free(serial);
    printf("%d threads, %d rounds of %d configs: %s\n", THREADS, ROUNDS, (int)CONFIGS, failed ? "FAILED" : "equal");
    return failed;
}
