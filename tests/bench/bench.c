/* hbil-bench - how long the core takes: plans, texts, SPIR-V. Medians of wall time on one thread; no test, nothing can fail
 * but the core itself. Sizes and compile times of the header: compile.sh. */
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#include "../../backends/hbil_glslang.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define SAMPLES 201       /* odd: the median is a sample */
#define SPIRV_SAMPLES 21
#define BATCH 16          /* calls per sample, so that the clock's own time does not count */
#define WORDS_MAX 65536

static const char *const config_texts[] = { "", "outputs=ao", "outputs=ao+near+bent+composite reach=2.5 dynamic=slices+reach depth=device" };
enum { CONFIGS = sizeof config_texts / sizeof config_texts[0] };

static char     text[HBIL_GLSL_MAX];
static uint32_t words[WORDS_MAX];
static double   samples[SAMPLES];

static double microseconds(void)
{
    struct timespec t;

    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e6 * (double)t.tv_sec + 1e-3 * (double)t.tv_nsec;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

static double median(double *values, size_t count)
{
    qsort(values, count, sizeof *values, compare);
    return values[count / 2];
}

static void refuse(const char *what)
{
    fprintf(stderr, "hbil-bench: %s\n", what);
    exit(1);
}

/* Bytes of all texts of a plan. */
static size_t emit_all(const hbil_plan *plan)
{
    size_t  bytes = 0, need = 0;
    int32_t i;

    for (i = 0; i < (int32_t)plan->pass_count; ++i) {
        if (hbil_emit_glsl(plan, i, text, sizeof text, &need) != HBIL_OK) refuse("a text is refused");
        bytes += need - 1;
    }
    return bytes;
}

static void bench_core(const char *config_text)
{
    static hbil_plan plan;
    hbil_config config;
    double      build, emit, manifest;
    size_t      i, k, bytes = 0, need = 0;

    memset(&config, 0, sizeof config);
    if (hbil_config_parse(&config, config_text, strlen(config_text), NULL) != HBIL_OK) refuse("a config is refused");
    for (i = 0; i < SAMPLES; ++i) {
        const double begin = microseconds();
        for (k = 0; k < BATCH; ++k)
            if (hbil_plan_build(&config, &plan, NULL) != HBIL_OK) refuse("a plan is refused");
        samples[i] = (microseconds() - begin) / BATCH;
    }
    build = median(samples, SAMPLES);
    for (i = 0; i < SAMPLES; ++i) {
        const double begin = microseconds();
        for (k = 0; k < BATCH; ++k) bytes = emit_all(&plan);
        samples[i] = (microseconds() - begin) / BATCH;
    }
    emit = median(samples, SAMPLES);
    for (i = 0; i < SAMPLES; ++i) {
        const double begin = microseconds();
        for (k = 0; k < BATCH; ++k)
            if (hbil_emit_manifest(&plan, text, sizeof text, &need) != HBIL_OK) refuse("a manifest is refused");
        samples[i] = (microseconds() - begin) / BATCH;
    }
    manifest = median(samples, SAMPLES);
    printf("%9.1f %9.1f %9.1f %7lu %7lu   %s\n", build, emit, manifest, (unsigned long)bytes, (unsigned long)(need - 1),
           *config_text ? config_text : "defaults");
}

/* ms of one compile of the text. */
static double compile(hbil_target target, size_t *need)
{
    static char  log[4096];
    const double begin = microseconds();

    if (hbil_glslang_compile(text, target, words, WORDS_MAX, need, log, sizeof log) != HBIL_GLSLANG_OK) refuse(log);
    return (microseconds() - begin) / 1000;
}

/* Every pass of the plan with all outputs. The first compile of a process builds glslang's tables. */
static void bench_spirv(void)
{
    static hbil_plan plan;
    hbil_config config;
    double      first;
    size_t      need = 0, bytes = 0;
    int32_t     pass;
    int         i;

    memset(&config, 0, sizeof config);
    config.outputs = HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR | HBIL_OUTPUTS_BENT | HBIL_OUTPUTS_COMPOSITE;
    if (hbil_plan_build(&config, &plan, NULL) != HBIL_OK) refuse("a plan is refused");
    if (!hbil_glslang_init()) refuse("glslang does not start");
    printf("\n%-10s %9s %9s %7s %7s\n", "SPIR-V", "first ms", "warm ms", "GLSL B", "SPV B");
    for (pass = 0; pass < (int32_t)plan.pass_count; ++pass) {
        if (hbil_emit_glsl(&plan, pass, text, sizeof text, &bytes) != HBIL_OK) refuse("a text is refused");
        first = compile(HBIL_TARGET_VULKAN, &need);
        for (i = 0; i < SPIRV_SAMPLES; ++i) samples[i] = compile(HBIL_TARGET_VULKAN, &need);
        printf("%-10s %9.2f %9.2f %7lu %7lu\n", plan.passes[pass].name, first, median(samples, SPIRV_SAMPLES),
               (unsigned long)(bytes - 1), (unsigned long)(4 * need));
    }
    hbil_glslang_shutdown();
}

int main(void)
{
    size_t i;

    printf("hbil %d.%d.%d: medians, one thread. sizeof(hbil_plan) %lu, sizeof(hbil_config) %lu\n\n", HBIL_VERSION_MAJOR,
           HBIL_VERSION_MINOR, HBIL_VERSION_PATCH, (unsigned long)sizeof(hbil_plan), (unsigned long)sizeof(hbil_config));
    printf("%9s %9s %9s %7s %7s   config\n", "plan us", "GLSL us", "JSON us", "GLSL B", "JSON B");
    for (i = 0; i < CONFIGS; ++i) bench_core(config_texts[i]);
    bench_spirv();
    return 0;
}
