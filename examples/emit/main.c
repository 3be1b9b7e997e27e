/* hbil-emit - a config in, the texts of its passes out: step 1 and 2 of hbil.h, and nothing else. */
#define HBIL_IMPLEMENTATION
#include "../../hbil.h"
#include <stdio.h>
#include <string.h>

static int help(FILE *f, int code)
{
    fputs("usage: hbil-emit [NAME=VALUE ...]     such as: hbil-emit outputs=ao+near slices=2\n\n"
          "Prints the GLSL of every pass. The options are those of hbil.h; none is the default config.\n"
          "exit: 0 done, 1 config refused, 2 wrong usage, 3 cannot write\n", f);
    return code;
}

int main(int argc, char **argv)
{
    static char text[HBIL_GLSL_MAX];
    hbil_config config = {0};
    hbil_plan   plan;
    hbil_diag   items[16];
    hbil_diags  diags = { items, 16, 0 };
    hbil_result result = HBIL_OK;
    int         i;
    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return help(stdout, 0);
        if (strchr(argv[i], '=') == NULL) return help(stderr, 2);
        if (hbil_config_parse(&config, argv[i], strlen(argv[i]), &diags) != HBIL_OK) result = HBIL_E_CONFIG;
    }
    if (result == HBIL_OK) result = hbil_plan_build(&config, &plan, &diags);
    for (i = 0; i < diags.count && i < diags.capacity; ++i) fprintf(stderr, "hbil-emit: %s\n", items[i].text);
    for (i = 0; result == HBIL_OK && i < (int)plan.pass_count; ++i) {
        result = hbil_emit_glsl(&plan, i, text, sizeof text, NULL);
        if (result == HBIL_OK) fputs(text, stdout);
        else fprintf(stderr, "hbil-emit: pass %s: %s\n", plan.passes[i].name, hbil_result_name(result));
    }
    if (result != HBIL_OK) return 1;
    return fflush(stdout) == 0 && !ferror(stdout) ? 0 : 3;
}
