/* variants.c - what hbil_variant_find gives against files of shadergen --format spirv.
 *
 *   variants CONFIG FOLDER     FOLDER holds PASS.spv of that config, as hbil_config_parse reads it
 *   variants CONFIG            the config is in no matrix
 *
 * Exit 0 if all is equal; the table is looked through, too. */
#define HBIL_IMPLEMENTATION
#include "hbil.h"
#include "hbil_variants.h"

#include <stdio.h>
#include <string.h>

static int fail(const char *what, const char *name)
{
    printf("variants: %s %s\n", what, name);
    return 1;
}

/* Every hash of the table is found, in rising order, and none beside it. */
static int check_table(void)
{
    size_t i;
    for (i = 0; i < HBIL_VARIANTS_COUNT; ++i) {
        const hbil_variant *v = &hbil_variants[i];
        hbil_config c;
        memset(&c, 0, sizeof c);
        if (i && hbil_variants[i - 1].hash >= v->hash) return fail("not sorted:", v->config);
        if (hbil_variant_find(v->hash) != v) return fail("not found:", v->config);
        if (hbil_variant_find(v->hash + 1) || hbil_variant_find(v->hash - 1)) return fail("found beside", v->config);
        if (hbil_config_parse(&c, v->config, strlen(v->config), NULL) != HBIL_OK || hbil_config_hash(&c) != v->hash)
            return fail("another hash than that of its config:", v->config);
    }
    return hbil_variant_find(0) != NULL;
}

static int check_pass(const hbil_variant_pass *pass, const char *name, const char *folder)
{
    static uint32_t words[65536];
    char path[512];
    size_t count;
    FILE *f;
    if (strcmp(pass->name, name)) return fail("pass is called", pass->name);
    snprintf(path, sizeof path, "%s/%s.spv", folder, name);
    f = fopen(path, "rb");
    if (!f) return fail("cannot read", path);
    count = fread(words, sizeof *words, sizeof words / sizeof *words, f);
    fclose(f);
    if (count && count == pass->count && memcmp(words, pass->words, count * sizeof *words) == 0) return 0;
    return fail("differs:", path);
}

int main(int argc, char **argv)
{
    const hbil_variant *v;
    hbil_config config;
    hbil_plan plan;
    uint32_t i;
    if (argc < 2 || argc > 3) return 2;
    memset(&config, 0, sizeof config);
    if (hbil_config_parse(&config, argv[1], strlen(argv[1]), NULL) != HBIL_OK) return fail("cannot read", argv[1]);
    if (hbil_plan_build(&config, &plan, NULL) != HBIL_OK) return fail("refused:", argv[1]);
    if (HBIL_VARIANTS_VERSION != hbil_version() || check_table()) return fail("wrong table", "");
    v = hbil_variant_find(hbil_config_hash(&config));
    if (argc == 2) return v ? fail("there is", argv[1]) : 0;
    if (!v) return fail("there is no", argv[1]);
    if (v != hbil_variant_find(plan.hash) || v->pass_count != plan.pass_count) return fail("other passes:", argv[1]);
    for (i = 0; i < v->pass_count; ++i)
        if (check_pass(&v->passes[i], plan.passes[i].name, argv[2])) return 1;
    return 0;
}
