/* consumer.c - prints the hash of the plan of a config file, and the name, bytes and FNV-1a sum of each text. */
#define HBIL_IMPLEMENTATION
#include "hbil.h"
#include <stdio.h>

int main(int argc, char **argv)
{
    static char   text[HBIL_GLSL_MAX], file[4096];
    hbil_config   config = {0};
    hbil_plan     plan;
    FILE         *f = argc == 2 ? fopen(argv[1], "rb") : NULL;
    size_t        size = f ? fread(file, 1, sizeof file, f) : 0;
    unsigned long sum;
    const char   *at;
    int           pass;
    if (f) fclose(f);
    if (!size || hbil_config_parse(&config, file, size, NULL) != HBIL_OK) return 1;
    if (hbil_plan_build(&config, &plan, NULL) != HBIL_OK) return 1;
    printf("hash %08lx%08lx\n", (unsigned long)(plan.hash >> 32), (unsigned long)(plan.hash & 0xffffffff));
    for (pass = 0; pass < (int)plan.pass_count; ++pass) {
        if (hbil_emit_glsl(&plan, pass, text, sizeof text, NULL) != HBIL_OK) return 1;
        for (sum = 2166136261u, at = text; *at; ++at) sum = ((sum ^ (unsigned char)*at) * 16777619u) & 0xffffffff;
        printf("pass %s %d %08lx\n", plan.passes[pass].name, (int)(at - text), sum);
    }
    return 0;
}
