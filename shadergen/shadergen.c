/* shadergen.c - writes the shaders of a config: GLSL, SPIR-V or the manifest of the plan. See help(). */

#define HBIL_IMPLEMENTATION
#include "../hbil.h"
#include "../backends/hbil_glslang.h"

#include "build.h"
#include "matrix.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *format, *pass, *output, *explain, *action, *hook;
    int         verbose;
} arguments;

static int help(FILE *f, int code)
{
    fputs("shadergen - writes the shaders of a horizon-based lighting config\n\n"
          "usage: shadergen [config] [output]\n"
          "       shadergen matrix FILE -o DIR    all combinations of lists of values; see shadergen matrix --help\n\n"
          "config, later wins over earlier, --set over all:\n"
          "  --preset NAME           start from a preset (see --list-presets)\n"
          "  -c, --config FILE       name=value pairs, # comments; - is standard input\n"
          "  --set NAME=VALUE[,...]  sets are written with +: outputs=ao+near\n"
          "  --target NAME           same as --set target=NAME\n"
          "output:\n"
          "  --format FORMAT         glsl (default), spirv, manifest (the plan as JSON)\n"
          "  --pass NAME             only this pass\n"
          "  --hook FILE             GLSL text with the function of environment=hook; - is standard input\n"
          "  -o, --output PATH       file, folder (ends with /), or - for standard output (default)\n"
          "instead of output:\n"
          "  --list-options          the options and presets\n"
          "  --list-presets          the presets and what they set\n"
          "  --explain NAME          an option: meaning, unit, range, default, source;\n"
          "                          or a preset: its values, each with its source\n"
          "  --print-config          the config after defaults and checks\n"
          "also:\n"
          "  -v                      print notes, such as options without effect\n"
          "  --version, -h, --help\n\n"
          "example: shadergen --set outputs=ao,slices=2 --format spirv -o shaders/\n\n"
          "exit: 0 done, 1 config or hook refused, 2 wrong usage, 3 cannot read or write, 4 glslang refused our text\n", f);
    return code;
}

static int usage(const char *what, const char *word)
{
    fprintf(stderr, "shadergen: %s%s; see shadergen --help\n", what, word);
    return USAGE;
}

/* ---------------------------------------------------------------------- the option table, for people */

static void print_range(const hbil_option *o)
{
    if (*o->choices) printf("%s {%s}", o->kind == HBIL_KIND_SET ? "any of" : "one of", o->choices);
    else printf("[%.9g, %.9g]", o->min, o->max);
}

/* Text of the default, as hbil_config_print spells it. */
static void default_text(int32_t option, char *buf, size_t cap)
{
    static const hbil_config zero;
    char all[4096], *at, name[64];
    hbil_config_print(&zero, 1, all, sizeof all, NULL);
    snprintf(name, sizeof name, "%s=", hbil_option_at(option)->name);
    at = strstr(all, name);
    while (at && at != all && at[-1] != ' ') at = strstr(at + 1, name);
    snprintf(buf, cap, "%.*s", at ? (int)strcspn(at + strlen(name), " ") : 0, at ? at + strlen(name) : "");
}

static int list_options(void)
{
    int32_t i;
    char def[64];
    printf("options (shadergen --explain NAME tells more):\n");
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        default_text(i, def, sizeof def);
        printf("  %-16s %s\n  %-16s ", o->name, o->meaning, "");
        print_range(o);
        printf("%s%s, default %s\n", *o->unit && strcmp(o->unit, "1") ? " " : "", strcmp(o->unit, "1") ? o->unit : "", def);
    }
    printf("presets:\n");
    for (i = 0; hbil_preset_name(i); ++i) printf("  %-16s %s\n", hbil_preset_name(i), hbil_preset_meaning(i));
    return DONE;
}

/* What a preset sets, as config text in table order. */
static void print_values(const char *name)
{
    hbil_config c;
    char text[4096] = "";
    memset(&c, 0, sizeof c);
    if (hbil_config_preset(name, &c, NULL) == HBIL_OK) hbil_config_print(&c, 0, text, sizeof text, NULL);
    puts(*text ? text : "the default of every option");
}

static int list_presets(void)
{
    int32_t i;
    printf("presets (shadergen --explain NAME tells where each value comes from):\n");
    for (i = 0; hbil_preset_name(i); ++i) {
        printf("  %-12s %s\n  %-12s ", hbil_preset_name(i), hbil_preset_meaning(i), "");
        print_values(hbil_preset_name(i));
    }
    return DONE;
}

/* The sources are lines "option=value: source". Values that are said to be the default count too: they are a statement. */
static void explain_preset(int32_t preset)
{
    const char *at = hbil_preset_sources(preset), *name = hbil_preset_name(preset), *meaning = hbil_preset_meaning(preset);
    if (!at || !name || !meaning) return;
    printf("%s\n  meaning   %s\n  sets      ", name, meaning);
    print_values(name);
    for (; *at; at += strspn(at, "\n")) {
        int line = (int)strcspn(at, "\n"), value = (int)strcspn(at, ":\n"), source = value + (int)strspn(at + value, ": ");
        if (source > line) source = line;
        printf("  %-42.*s %.*s\n", value, at, line - source, at + source);
        at += line;
    }
}

/* Offers the nearest of both kinds; the message of hbil_config_preset ends with that of the presets. */
static int unknown_name(const char *name, const char *option)
{
    hbil_config c;
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    const char *preset;
    hbil_config_preset(name, &c, &diags);
    preset = diags.count ? strstr(item.text, "did you mean ") : NULL;
    fprintf(stderr, "shadergen: no option or preset %s; did you mean the option %s, or the preset %s\n", name, option,
            preset ? preset + 13 : "?");
    return USAGE;
}

static int explain(const char *name)
{
    int32_t nearest, preset, i = hbil_option_find(name, strlen(name), &nearest);
    const hbil_option *o = hbil_option_at(i);
    char def[64];
    for (preset = 0; hbil_preset_name(preset) && strcmp(hbil_preset_name(preset), name); ++preset) { }
    if (hbil_preset_name(preset)) explain_preset(preset);
    if (!o) {
        if (hbil_preset_name(preset)) return DONE;
        return unknown_name(name, hbil_option_at(nearest)->name);
    }
    default_text(i, def, sizeof def);
    printf("%s\n  meaning   %s\n  unit      %s\n  range     ", o->name, o->meaning,
           !*o->unit ? "none" : strcmp(o->unit, "1") ? o->unit : "1 (a ratio)");
    print_range(o);
    printf("\n  default   %s\n  stage     baked%s\n", def, o->dynamic ? "; dynamic if named in the option dynamic" : "");
    if (*o->applies) printf("  applies   if %s\n", o->applies);
    printf("  source    %s\n", o->source);
    return DONE;
}

/* ---------------------------------------------------------------------- outputs */

/* Reads the file of --hook where a pass that is asked for calls it. It is a mistake to leave --hook out there, or to give it
 * to a plan that calls nothing. */
static int read_hook(const hbil_plan *plan, const arguments *a, int32_t only, hook_file *hook)
{
    size_t size = 0;
    int32_t i, needed = -1, text = strcmp(a->format, "manifest") != 0;
    for (i = 0; i < (int32_t)plan->pass_count; ++i)
        if (plan->passes[i].hook && text && (only < 0 || only == i)) needed = i;
    if (a->hook && plan->config.environment != HBIL_ENVIRONMENT_HOOK)
        return usage("--hook without environment=hook: no pass would call the function; set environment=hook, with an "
                     "output such as far, or leave --hook out", "");
    if (needed < 0) return DONE;
    if (!a->hook) {
        fprintf(stderr, "shadergen: environment=hook: pass %s calls a function of yours, vec3 hbil_far_hook(vec3 position, "
                "vec3 direction, float cos_aperture); name the file that defines it: --hook FILE\n",
                plan->passes[needed].name);
        return USAGE;
    }
    hook->path = strcmp(a->hook, "-") ? a->hook : "standard input";
    hook->text = read_all(a->hook, &size);
    if (!hook->text) {
        fprintf(stderr, "shadergen: cannot read %s: %s\n", hook->path, strerror(errno));
        return IO;
    }
    if (strlen(hook->text) == size) return DONE;
    fprintf(stderr, "shadergen: %s holds a zero byte: name a text file after --hook\n", hook->path);
    return CONFIG;
}

/* Which pass --pass names; -1 all. */
static int find_pass(const hbil_plan *plan, const arguments *a, int32_t *only)
{
    uint32_t i;
    *only = a->pass ? hbil_plan_pass(plan, a->pass) : -1;
    if (!a->pass || *only >= 0) return DONE;
    fprintf(stderr, "shadergen: this config has no pass %s; it has:", a->pass);
    for (i = 0; i < plan->pass_count; ++i) fprintf(stderr, " %s", plan->passes[i].name);
    fputc('\n', stderr);
    return USAGE;
}

static int add_pass(const hbil_plan *plan, int32_t pass, int spirv, const hook_file *hook, const char *path, files *outputs)
{
    file *f = files_add(outputs);
    int code = f ? build_pass(plan, pass, spirv, hook, f) : IO;
    return code == DONE && !file_place(f, path, plan->passes[pass].name, spirv ? ".spv" : ".comp") ? IO : code;
}

static int add_manifest(const hbil_plan *plan, const char *path, files *outputs)
{
    file *f = files_add(outputs);
    int code = f ? build_manifest(plan, f) : IO;
    return code == DONE && !file_place(f, path, "plan", ".json") ? IO : code;
}

static int generate(const hbil_plan *plan, const arguments *a)
{
    files outputs = { NULL, 0, 0 };
    hook_file hook = { NULL, NULL };
    int32_t i, only;
    int spirv = strcmp(a->format, "spirv") == 0, manifest = strcmp(a->format, "manifest") == 0;
    int code = find_pass(plan, a, &only), folder = a->output[strlen(a->output) - 1] == '/';
    if (code != DONE) return code;
    if (!folder && !a->pass && !manifest && (spirv || strcmp(a->output, "-")))
        return usage("several passes do not fit one file: name a folder (-o DIR/) or one pass (--pass NAME)", "");
    code = read_hook(plan, a, only, &hook);
    if (manifest && code == DONE) code = add_manifest(plan, a->output, &outputs);
    for (i = 0; i < (int32_t)plan->pass_count && code == DONE && !manifest; ++i)
        if (!a->pass || i == only) code = add_pass(plan, i, spirv, &hook, a->output, &outputs);
    if (code == DONE && folder && !folder_make(a->output)) code = IO;
    if (code == DONE && !files_write(&outputs, NULL)) code = IO;
    files_free(&outputs);
    free(hook.text);
    return code;
}

static int print_config(const hbil_config *config)
{
    hbil_config c;
    char text[4096], *s;
    if (hbil_config_resolve(config, &c, NULL) != HBIL_OK) return CONFIG;
    if (hbil_config_print(&c, 1, text, sizeof text, NULL) != HBIL_OK) return CONFIG;
    for (s = text; *s; ++s) if (*s == ' ') *s = '\n';
    puts(text);
    return DONE;
}

/* ---------------------------------------------------------------------- command line */

static int apply(hbil_config *config, const char *kind, const char *value)
{
    hbil_diag items[16];
    hbil_diags diags = { items, 16, 0 };
    hbil_result result;
    char *text = NULL;
    size_t size = 0;
    if (strcmp(kind, "preset") == 0) {
        result = hbil_config_preset(value, config, &diags);
    } else if (strcmp(kind, "target") == 0) {
        result = hbil_config_set(config, "target", value, &diags);
    } else if (strcmp(kind, "set") == 0) {
        result = hbil_config_parse(config, value, strlen(value), &diags);
    } else {
        text = read_all(value, &size);
        if (!text) {
            fprintf(stderr, "shadergen: cannot read %s: %s\n", value, strerror(errno));
            return IO;
        }
        result = hbil_config_parse(config, text, size, &diags);
        free(text);
    }
    print_diags(&diags, text ? value : "", 1);
    return result == HBIL_OK ? DONE : CONFIG;
}

/* Value options, in the order in which they take effect; 0: not part of the config. */
static const struct { const char *name, *brief, *kind; int order; } flags[] = {
    { "--preset", "", "preset", 1 }, { "--config", "-c", "file", 2 }, { "--set", "", "set", 3 },
    { "--target", "", "target", 3 }, { "--format", "", "format", 0 }, { "--pass", "", "pass", 0 },
    { "--output", "-o", "output", 0 }, { "--explain", "", "explain", 0 }, { "--hook", "", "hook", 0 } };

static int is_action(const char *word)
{
    static const char *const actions[] = { "--list-options", "--list-presets", "--print-config", "--version", "--help" };
    size_t k;
    for (k = 0; k < sizeof actions / sizeof actions[0]; ++k)
        if (strcmp(word, actions[k]) == 0) return 1;
    return 0;
}

/* One round over the command line; takes up the flags of one order. */
static int read_arguments(int argc, char **argv, int order, arguments *a, hbil_config *config)
{
    int i, code = DONE;
    size_t k;
    for (i = 1; i < argc; ++i) {
        for (k = 0; k < sizeof flags / sizeof flags[0]; ++k)
            if (strcmp(argv[i], flags[k].name) == 0 || (*flags[k].brief && strcmp(argv[i], flags[k].brief) == 0)) break;
        if (k == sizeof flags / sizeof flags[0]) {
            if (strcmp(argv[i], "-v") == 0) a->verbose = 1;
            else if (strcmp(argv[i], "-h") == 0) a->action = "--help";
            else if (is_action(argv[i])) a->action = argv[i];
            else return usage("unknown argument ", argv[i]);
            continue;
        }
        if (++i == argc || !*argv[i]) return usage("no value after ", flags[k].name);
        if (flags[k].order != order) continue;
        if (order) {
            int one = apply(config, flags[k].kind, argv[i]);
            if (one != DONE) code = one; /* go on: report every fault */
        } else if (strcmp(flags[k].kind, "format") == 0) a->format = argv[i];
        else if (strcmp(flags[k].kind, "pass") == 0) a->pass = argv[i];
        else if (strcmp(flags[k].kind, "output") == 0) a->output = argv[i];
        else if (strcmp(flags[k].kind, "hook") == 0) a->hook = argv[i];
        else a->explain = argv[i];
    }
    return code;
}

static int run(int argc, char **argv)
{
    hbil_config config;
    hbil_plan plan;
    hbil_diag items[32];
    hbil_diags diags = { items, 32, 0 };
    arguments a = { "glsl", NULL, "-", NULL, NULL, NULL, 0 };
    int order, code;
    memset(&config, 0, sizeof config);
    if (argc == 1) return help(stdout, DONE);
    code = read_arguments(argc, argv, 0, &a, &config);
    if (code != DONE) return code;
    if (a.action && strcmp(a.action, "--help") == 0) return help(stdout, DONE);
    if (a.action && strcmp(a.action, "--version") == 0) {
        printf("shadergen %d.%d.%d\n", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
        return DONE;
    }
    if (a.action && strcmp(a.action, "--list-options") == 0) return list_options();
    if (a.action && strcmp(a.action, "--list-presets") == 0) return list_presets();
    if (a.explain) return explain(a.explain);
    if (strcmp(a.format, "glsl") && strcmp(a.format, "spirv") && strcmp(a.format, "manifest"))
        return usage("--format must be glsl, spirv or manifest, not ", a.format);
    for (order = 1; order <= 3; ++order) {
        int one = read_arguments(argc, argv, order, &a, &config);
        if (one != DONE) code = one;
    }
    if (code != DONE) return code;
    if (hbil_plan_build(&config, &plan, &diags) != HBIL_OK) code = CONFIG;
    print_diags(&diags, "", a.verbose);
    if (code != DONE) return code;
    if (a.action) return print_config(&config);
    if (strcmp(a.format, "spirv") == 0 && !hbil_glslang_init()) return usage("glslang does not start", "");
    code = generate(&plan, &a);
    if (strcmp(a.format, "spirv") == 0) hbil_glslang_shutdown();
    return code;
}

int main(int argc, char **argv)
{
    int code = argc > 1 && strcmp(argv[1], "matrix") == 0 ? matrix(argc - 1, argv + 1) : run(argc, argv);
    if (code == DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        fprintf(stderr, "shadergen: cannot write -: %s\n", strerror(errno));
        code = IO;
    }
    return code;
}
