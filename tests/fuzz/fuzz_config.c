/* fuzz_config.c - config text: parse, set, preset, resolve, print, hash, and the way round. */
#include "fuzz.h"
#include "../../hbil.h"

#include <stdlib.h>
#include <string.h>

#define TEXT_MAX 2048 /* what hbil_config_hash takes: text beyond would not count */

static void check_diags(const hbil_diags *d, hbil_result result)
{
    int32_t i, errors = 0;
    for (i = 0; i < d->count && i < d->capacity; ++i) {
        FUZZ_REQUIRE(memchr(d->items[i].text, 0, sizeof d->items[i].text) && d->items[i].text[0]);
        FUZZ_REQUIRE(d->items[i].option >= -1 && d->items[i].option < hbil_option_count());
        errors += d->items[i].severity == HBIL_ERROR;
    }
    FUZZ_REQUIRE(result != HBIL_E_CONFIG || errors || d->count > d->capacity);
    FUZZ_REQUIRE(result != HBIL_OK || !errors);
}

/* Text of a resolved config, whole and cut, reads back as that config. */
static void check_text(const hbil_config *resolved, int all, size_t cut)
{
    char text[2 * TEXT_MAX], *exact;
    hbil_config back;
    size_t need = 0, again = 0;
    FUZZ_REQUIRE(hbil_config_print(resolved, all, text, sizeof text, &need) == HBIL_OK && need == strlen(text) + 1);
    FUZZ_REQUIRE(all || need <= TEXT_MAX);
    memset(&back, 0, sizeof back);
    FUZZ_REQUIRE(hbil_config_parse(&back, text, need - 1, NULL) == HBIL_OK);
    FUZZ_REQUIRE(hbil_config_resolve(&back, &back, NULL) == HBIL_OK);
    FUZZ_REQUIRE(memcmp(&back, resolved, sizeof back) == 0);
    cut = cut % need + 1;
    exact = (char *)malloc(cut);
    if (!exact) return;
    FUZZ_REQUIRE(hbil_config_print(resolved, all, exact, cut, &again) == (cut < need ? HBIL_E_SPACE : HBIL_OK));
    FUZZ_REQUIRE(again == need && strlen(exact) == cut - 1 && memcmp(exact, text, cut - 1) == 0);
    free(exact);
}

static void check_config(const hbil_config *c, size_t cut)
{
    hbil_diag items[8];
    hbil_diags d = { items, 8, 0 };
    hbil_config resolved, twice;
    char text[64];
    hbil_result result = hbil_config_resolve(c, &resolved, &d);
    check_diags(&d, result);
    hbil_config_print(c, 1, text, sizeof text, NULL); /* any bytes */
    hbil_config_print(c, 0, NULL, 0, NULL);
    FUZZ_REQUIRE((hbil_config_hash(c) != 0) == (result == HBIL_OK));
    if (result != HBIL_OK) return;
    FUZZ_REQUIRE(hbil_config_resolve(&resolved, &twice, NULL) == HBIL_OK && memcmp(&resolved, &twice, sizeof twice) == 0);
    FUZZ_REQUIRE(hbil_config_hash(c) == hbil_config_hash(&resolved));
    check_text(&resolved, 0, cut);
    check_text(&resolved, 1, cut);
}

/* The same text as a name and a value. */
static void set_one(const char *text, size_t size)
{
    hbil_diag items[2];
    hbil_diags d = { items, 2, 0 };
    hbil_config c, before;
    char *name = (char *)malloc(size + 1), *value;
    hbil_result result;
    if (!name) return;
    if (size) memcpy(name, text, size);
    name[size] = 0;
    memset(&c, 0, sizeof c);
    hbil_config_preset(name, &c, NULL);
    before = c;
    value = strchr(name, '=');
    if (value) *value++ = 0;
    result = hbil_config_set(&c, name, value ? value : "", &d);
    check_diags(&d, result);
    FUZZ_REQUIRE(result == HBIL_OK || memcmp(&c, &before, sizeof c) == 0);
    free(name);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    hbil_diag items[8];
    hbil_diags d = { items, 8, 0 };
    hbil_config c;
    memset(&c, 0, sizeof c);
    check_diags(&d, hbil_config_parse(&c, (const char *)data, size, &d));
    check_config(&c, size);
    set_one((const char *)data, size);
    return 0;
}
