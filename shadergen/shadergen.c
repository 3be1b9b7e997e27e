/* shadergen.c - writes the shaders of a config: GLSL, SPIR-V or the manifest of the plan. See help(). */

#define HBIL_IMPLEMENTATION
#include "../hbil.h"
#define HBIL_GLSLANG_IMPLEMENTATION
#include "../backends/hbil_glslang.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { DONE = 0, CONFIG = 1, USAGE = 2, IO = 3, COMPILER = 4 };
#define WORDS_MAX 65536 /* SPIR-V words of one pass */

typedef struct arguments {
    const char *format, *pass, *output, *explain, *action, *hook;
    int         verbose;
} arguments;

/* The function of environment=hook: its file and what is in it, both NULL without --hook. */
typedef struct hook_file { const char *path; char *text; } hook_file;

/* An output in memory; all are made before the first is written. */
typedef struct output { char path[1024]; char *data; size_t size; } output;

static int help(FILE *f, int code)
{
    fputs("shadergen - writes the shaders of a horizon-based lighting config\n\n"
          "usage: shadergen [config] [output]\n\n"
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

static void print_diags(const hbil_diags *diags, const char *where, int verbose)
{
    int i, n = diags->count < diags->capacity ? diags->count : diags->capacity;
    for (i = 0; i < n; ++i)
        if (verbose || diags->items[i].severity != HBIL_NOTE)
            fprintf(stderr, "shadergen: %s%s%s\n", where, *where ? ": " : "", diags->items[i].text);
    if (diags->count > n) fprintf(stderr, "shadergen: and %d more\n", diags->count - n);
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

/* ---------------------------------------------------------------------- files */

/* The whole file with a zero behind it; size is without that. NULL: errno says why. */
static char *read_all(const char *path, size_t *size)
{
    FILE *f = strcmp(path, "-") ? fopen(path, "rb") : stdin;
    char *data = NULL;
    size_t n = 0, room = 0, got = 1;
    if (!f) return NULL;
    while (got) {
        if (n == room) {
            char *more = (char *)realloc(data, (room += 65536) + 1);
            if (!more) { free(data); data = NULL; break; }
            data = more;
        }
        got = fread(data + n, 1, room - n, f);
        n += got;
    }
    if (ferror(f)) { free(data); data = NULL; }
    if (f != stdin) fclose(f);
    if (data) data[n] = 0;
    *size = n;
    return data;
}

static int same_on_disk(const output *o)
{
    size_t size = 0;
    char *data = read_all(o->path, &size);
    int same = data && size == o->size && memcmp(data, o->data, size) == 0;
    free(data);
    return same;
}

/* Writes one output: to standard output, or to the temporary file, which is gone again after a failure. */
static int write_one(const output *o, const char *temp)
{
    FILE *f = *temp ? fopen(temp, "wb") : stdout;
    int ok = f && fwrite(o->data, 1, o->size, f) == o->size && fflush(f) == 0;
    if (f && f != stdout) {
        ok = fclose(f) == 0 && ok;
        if (!ok) remove(temp);
    }
    return ok;
}

/* All temporary files first, then all renames: a full disk or a folder in the way leaves every old file as it was. */
static int write_outputs(output *outputs, int count)
{
    char temp[HBIL_MAX_PASSES][1040];
    int i, made, bad = -1;
    for (made = 0; made < count && bad < 0; ++made) {
        int changed = strcmp(outputs[made].path, "-") == 0 || !same_on_disk(&outputs[made]);
        temp[made][0] = 0;
        if (changed && strcmp(outputs[made].path, "-")) strcat(strcpy(temp[made], outputs[made].path), ".tmp");
        if (changed && !write_one(&outputs[made], temp[made])) bad = made, temp[made][0] = 0;
    }
    for (i = 0; i < made && bad < 0; ++i)
        if (temp[i][0] && rename(temp[i], outputs[i].path)) bad = i;
    if (bad < 0) return DONE;
    fprintf(stderr, "shadergen: cannot write %s: %s\n", outputs[bad].path, strerror(errno));
    for (i = 0; i < made; ++i)
        if (temp[i][0]) remove(temp[i]);
    return IO;
}

/* ---------------------------------------------------------------------- outputs */

static char compiler_log[8192];

static hbil_glslang_result compile(const char *text, hbil_target target, output *o)
{
    uint32_t *words = (uint32_t *)malloc(WORDS_MAX * sizeof *words);
    size_t need = 0;
    hbil_glslang_result result = HBIL_GLSLANG_E_ARG;
    if (words) result = hbil_glslang_compile(text, target, words, WORDS_MAX, &need, compiler_log, sizeof compiler_log);
    if (result != HBIL_GLSLANG_OK) { free(words); return result; }
    o->data = (char *)words;
    o->size = need * sizeof *words;
    return HBIL_GLSLANG_OK;
}

static char *emit(const hbil_plan *plan, int32_t pass, const char *hook, size_t *size, hbil_diags *diags)
{
    size_t need = 0;
    char *text = NULL;
    if (hbil_emit_glsl_hook(plan, pass, hook, NULL, 0, &need, diags) == HBIL_E_SPACE) text = (char *)malloc(need);
    if (text && hbil_emit_glsl_hook(plan, pass, hook, text, need, NULL, NULL) != HBIL_OK) { free(text); text = NULL; }
    *size = need ? need - 1 : 0;
    return text;
}

/* Does the pass compile with a hook that is surely right? Then the fault is in the other one. */
static int compiles_without(const hbil_plan *plan, int32_t pass)
{
    static const char plain[] = "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) { return position; }";
    output o = { "", NULL, 0 };
    size_t size;
    char *text = emit(plan, pass, plain, &size, NULL);
    int ok = text && compile(text, (hbil_target)plan->config.target, &o) == HBIL_GLSLANG_OK;
    free(text);
    free(o.data);
    return ok;
}

/* glslang's "ERROR: 1:4: text" is line 4 of the hook, source 1: FILE:4: text. Returns how many lines spoke of it. */
static int print_hook_errors(const char *path)
{
    const char *at = compiler_log;
    int count = 0;
    for (; *at; at += strcspn(at, "\n"), at += strspn(at, "\n")) {
        int length = (int)strcspn(at, "\n");
        if (strncmp(at, "ERROR: 1:", 9)) continue;
        if (strncmp(at + strcspn(at, "'\n"), "'' : compilation terminated", 27) == 0) continue;
        fprintf(stderr, "%s:%.*s\n", path, length - 9, at + 9);
        ++count;
    }
    return count;
}

/* Says whose fault it is that glslang refused a pass: the hook's or ours. */
static int refused(const hbil_plan *plan, int32_t pass, const hook_file *hook)
{
    const char *name = plan->passes[pass].name;
    static char log[sizeof compiler_log];
    strcpy(log, compiler_log);
    if (!plan->passes[pass].hook || !compiles_without(plan, pass)) {
        fprintf(stderr, "shadergen: glslang refused pass %s; please report this with the `rebuild` line of its text:\n%s\n",
                name, log);
        return COMPILER;
    }
    strcpy(compiler_log, log);
    fprintf(stderr, "shadergen: the hook %s does not compile in pass %s\n", hook->path, name);
    if (!print_hook_errors(hook->path)) fprintf(stderr, "%s: breaks the text behind it:\n%s\n", hook->path, log);
    return CONFIG;
}

static int make_pass(const hbil_plan *plan, int32_t pass, int spirv, const hook_file *hook, output *o)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    size_t size;
    int code = DONE;
    char *text = emit(plan, pass, hook->text, &size, &diags);
    if (!text) {
        print_diags(&diags, hook->path ? hook->path : "", 1);
        if (!diags.count) fprintf(stderr, "shadergen: out of memory\n");
        return diags.count ? CONFIG : IO;
    }
    if (spirv) {
        if (compile(text, (hbil_target)plan->config.target, o) != HBIL_GLSLANG_OK) code = refused(plan, pass, hook);
        free(text);
    } else {
        o->data = text;
        o->size = size;
    }
    return code;
}

/* path: -, a folder with a / at its end, or a file (one output only). */
static int place(output *o, const char *path, const char *name, const char *suffix)
{
    size_t n = strlen(path);
    int long_path = snprintf(o->path, sizeof o->path, "%s%s%s", path, n && path[n - 1] == '/' ? name : "",
                             n && path[n - 1] == '/' ? suffix : "") >= (int)sizeof o->path;
    if (!long_path) return DONE;
    fprintf(stderr, "shadergen: path too long\n");
    return IO;
}

static int make_manifest(const hbil_plan *plan, output *o)
{
    size_t need = 0;
    hbil_emit_manifest(plan, NULL, 0, &need);
    o->data = (char *)malloc(need);
    o->size = need - 1;
    return o->data && hbil_emit_manifest(plan, o->data, need, NULL) == HBIL_OK ? DONE : IO;
}

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

static int generate(const hbil_plan *plan, const arguments *a)
{
    output outputs[HBIL_MAX_PASSES];
    hook_file hook = { NULL, NULL };
    int32_t i, only;
    int spirv = strcmp(a->format, "spirv") == 0, manifest = strcmp(a->format, "manifest") == 0;
    int count = 0, code = find_pass(plan, a, &only);
    int folder = a->output[strlen(a->output) - 1] == '/';
    memset(outputs, 0, sizeof outputs);
    if (code != DONE) return code;
    if (!folder && !a->pass && !manifest && (spirv || strcmp(a->output, "-")))
        return usage("several passes do not fit one file: name a folder (-o DIR/) or one pass (--pass NAME)", "");
    code = read_hook(plan, a, only, &hook);
    if (manifest && code == DONE) {
        code = make_manifest(plan, &outputs[0]);
        if (code == DONE) code = place(&outputs[0], a->output, "plan", ".json");
        count = 1;
    }
    for (i = 0; i < (int32_t)plan->pass_count && code == DONE && !manifest; ++i) {
        if (a->pass && i != only) continue;
        code = make_pass(plan, i, spirv, &hook, &outputs[count]);
        if (code == DONE) code = place(&outputs[count], a->output, plan->passes[i].name, spirv ? ".spv" : ".comp");
        ++count;
    }
    if (folder && code == DONE && mkdir(a->output, 0777) && errno != EEXIST) {
        fprintf(stderr, "shadergen: cannot make folder %s: %s\n", a->output, strerror(errno));
        code = IO;
    }
    if (code == DONE) code = write_outputs(outputs, count);
    for (i = 0; i < count; ++i) free(outputs[i].data);
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
    int code = run(argc, argv);
    if (code == DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        fprintf(stderr, "shadergen: cannot write -: %s\n", strerror(errno));
        code = IO;
    }
    return code;
}
