/* hbil-tradeoff - what accuracy costs on this device and these frames: sweeps options, compares two configs, drops
 * features, tells how cost grows, checks what the articles say. */
#include <stdio.h>
#include <string.h>

#define HBIL_IMPLEMENTATION
#include "analysis.h"
#include "commands.h"

static void help(void)
{
    fputs("usage: hbil-tradeoff COMMAND ...\n"
          "Measures time against error of configs of hbil.h.\n\n", stdout);
    sweep_help();
    putchar('\n');
    pair_help();
    putchar('\n');
    ablate_help();
    putchar('\n');
    growth_help();
    putchar('\n');
    statements_help();
    fputs(
        "\n  report, recommend, compare: from the results of sweeps; hbil-tradeoff report --help tells more\n\n"
        "frames and runs, in all but these:\n",
        stdout);
    settings_help();
    fputs(
        "  --help, --version\n\n"
        "errors: root of the mean square over pixels and channels; three, told apart:\n"
        "  sampling   against the same estimator with so many samples that no noise is left: more samples buy it down\n"
        "  estimator  of that one against rays through the depth buffer as a solid: another estimator buys it down\n"
        "  model      of the config against the path-traced scene: what the screen does not show is in it\n"
        "  Frames without hf-NNN.exr get their height field traced on about 2000 pixels. Truths of near and far\n"
        "  light of frames with f0 are taken times 1 - F0.\n"
        "exit: 0 done; 1 all configs refused, or growth is off; 2 usage; 3 a file cannot be read or written, or is\n"
        "      malformed; 4 frame and config do not fit each other; 5 backend, driver or memory\n",
        stdout);
}

int main(int argc, char **argv)
{
    const char *name = argc > 1 ? argv[1] : "";

    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return help(), TRADE_DONE;
    if (strcmp(name, "--version") == 0) {
        printf("hbil-tradeoff %d.%d.%d\n", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
        return TRADE_DONE;
    }
    if (strcmp(name, "sweep") == 0) return sweep_main(argc - 2, argv + 2);
    if (strcmp(name, "pair") == 0) return pair_main(argc - 2, argv + 2);
    if (strcmp(name, "ablate") == 0) return ablate_main(argc - 2, argv + 2);
    if (strcmp(name, "growth") == 0) return growth_main(argc - 2, argv + 2);
    if (strcmp(name, "statements") == 0) return statements_main(argc - 2, argv + 2);
    if (analysis_knows(name)) return analysis_main(argc, argv);
    fprintf(stderr,
            "hbil-tradeoff: %s: must be sweep, pair, ablate, growth, statements, report, recommend or compare; "
            "hbil-tradeoff --help tells more\n",
            *name ? name : "no command");
    return TRADE_USAGE;
}
