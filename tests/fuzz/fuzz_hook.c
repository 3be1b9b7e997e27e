/* fuzz_hook.c - the text of environment=hook. */
#include "fuzz.h"
#include "../../hbil.h"

#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static hbil_plan plan;
    static char text[HBIL_GLSL_MAX + 65536];
    static int32_t pass;
    hbil_diag items[2];
    hbil_diags d = { items, 2, 0 };
    size_t need = 0;
    char *hook = (char *)malloc(size + 1);
    hbil_result result;
    if (!plan.pass_count) {
        static const char config[] = "outputs=far environment=hook";
        hbil_config c;
        memset(&c, 0, sizeof c);
        FUZZ_REQUIRE(hbil_config_parse(&c, config, strlen(config), NULL) == HBIL_OK && hbil_plan_build(&c, &plan, NULL) == HBIL_OK);
        while (!plan.passes[pass].hook) ++pass;
    }
    if (!hook || size > 60000) { free(hook); return 0; }
    if (size) memcpy(hook, data, size);
    hook[size] = 0;
    result = hbil_emit_glsl_hook(&plan, pass, hook, text, sizeof text, &need, &d);
    FUZZ_REQUIRE(result == HBIL_OK || result == HBIL_E_HOOK);
    FUZZ_REQUIRE((result == HBIL_OK) == (d.count == 0) && (d.count == 0 || items[0].text[0]));
    FUZZ_REQUIRE(result != HBIL_OK || (need == strlen(text) + 1 && need <= HBIL_GLSL_MAX + strlen(hook) && strstr(text, hook)));
    free(hook);
    return 0;
}
