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
    const char *format, *pass, *output, *explain, *action;
    int         verbose;
} arguments;

/* An output in memory; all are made before the first is written. */
typedef struct output { char path[1024]; char *data; size_t size; } output;

static int help(FILE *f, int code)
{
    fputs("shadergen - writes the shaders of a horizon-based lighting config\n\n"
          "usage: shadergen [config] [output]\n\n"
          "config, later wins over earlier, --set over all:\n"
          "  --preset NAME           start from a preset (see --list-options)\n"
          "  -c, --config FILE       name=value pairs, # comments; - is standard input\n"
          "  --set NAME=VALUE[,...]  sets are written with +: outputs=ao+near\n"
          "  --target NAME           same as --set target=NAME\n"
          "output:\n"
          "  --format FORMAT         glsl (default), spirv, manifest (the plan as JSON)\n"
          "  --pass NAME             only this pass\n"
          "  -o, --output PATH       file, folder (ends with /), or - for standard output (default)\n"
          "instead of output:\n"
          "  --list-options          the options and presets\n"
          "  --explain NAME          one option: meaning, unit, range, default, source\n"
          "  --print-config          the config after defaults and checks\n"
          "also:\n"
          "  -v                      print notes, such as options without effect\n"
          "  --version, -h, --help\n\n"
          "example: shadergen --set outputs=ao,slices=2 --format spirv -o shaders/\n\n"
          "exit: 0 done, 1 config refused, 2 wrong usage, 3 cannot read or write, 4 glslang refused our text\n", f);
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

static int explain(const char *name)
{
    int32_t nearest, i = hbil_option_find(name, strlen(name), &nearest);
    const hbil_option *o = hbil_option_at(i);
    char def[64];
    if (!o) {
        fprintf(stderr, "shadergen: no option %s; did you mean %s?\n", name, hbil_option_at(nearest)->name);
        return USAGE;
    }
    default_text(i, def, sizeof def);
    printf("%s\n  meaning   %s\n  unit      %s\n  range     ", o->name, o->meaning, !*o->unit ? "none" : strcmp(o->unit, "1") ? o->unit : "1 (a ratio)");
    print_range(o);
    printf("\n  default   %s\n  stage     %s\n", def, o->dynamic ? "baked; dynamic if named in the option dynamic" : "baked");
    if (*o->applies) printf("  applies   if %s\n", o->applies);
    printf("  source    %s\n", o->source);
    return DONE;
}

/* ---------------------------------------------------------------------- files */

static char *read_all(const char *path, size_t *size)
{
    FILE *f = strcmp(path, "-") ? fopen(path, "rb") : stdin;
    char *data = NULL;
    size_t n = 0, room = 0, got = 1;
    if (!f) return NULL;
    while (got) {
        if (n == room) {
            char *more = (char *)realloc(data, room += 65536);
            if (!more) break;
            data = more;
        }
        got = fread(data + n, 1, room - n, f);
        n += got;
    }
    if (ferror(f)) { free(data); data = NULL; }
    if (f != stdin) fclose(f);
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

static int compile(const char *text, hbil_target target, const char *pass, output *o)
{
    static char log[8192];
    uint32_t *words = (uint32_t *)malloc(WORDS_MAX * sizeof *words);
    size_t need = 0;
    hbil_glslang_result result = words ? hbil_glslang_compile(text, target, words, WORDS_MAX, &need, log, sizeof log) : HBIL_GLSLANG_E_ARG;
    if (result != HBIL_GLSLANG_OK) {
        free(words);
        fprintf(stderr, "shadergen: glslang refused pass %s; please report this with the `rebuild` line of its text:\n%s\n", pass, log);
        return COMPILER;
    }
    o->data = (char *)words;
    o->size = need * sizeof *words;
    return DONE;
}

static int make_pass(const hbil_plan *plan, int32_t pass, int spirv, output *o)
{
    size_t need = 0;
    int code = DONE;
    char *text;
    hbil_emit_glsl(plan, pass, NULL, 0, &need);
    text = (char *)malloc(need);
    if (!text || hbil_emit_glsl(plan, pass, text, need, NULL) != HBIL_OK) { free(text); return IO; }
    if (spirv) {
        code = compile(text, (hbil_target)plan->config.target, plan->passes[pass].name, o);
        free(text);
    } else {
        o->data = text;
        o->size = need - 1;
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

static int generate(const hbil_plan *plan, const arguments *a)
{
    output outputs[HBIL_MAX_PASSES];
    int32_t i, only = a->pass ? hbil_plan_pass(plan, a->pass) : -1;
    int count = 0, code = DONE, spirv = strcmp(a->format, "spirv") == 0, manifest = strcmp(a->format, "manifest") == 0;
    int folder = a->output[strlen(a->output) - 1] == '/';
    memset(outputs, 0, sizeof outputs);
    if (a->pass && only < 0) {
        fprintf(stderr, "shadergen: this config has no pass %s; it has:", a->pass);
        for (i = 0; i < (int32_t)plan->pass_count; ++i) fprintf(stderr, " %s", plan->passes[i].name);
        fputc('\n', stderr);
        return USAGE;
    }
    if (!folder && !a->pass && !manifest && (spirv || strcmp(a->output, "-")))
        return usage("several passes do not fit one file: name a folder (-o DIR/) or one pass (--pass NAME)", "");
    if (manifest) {
        size_t need = 0;
        hbil_emit_manifest(plan, NULL, 0, &need);
        outputs[0].data = (char *)malloc(need);
        if (!outputs[0].data || hbil_emit_manifest(plan, outputs[0].data, need, NULL) != HBIL_OK) code = IO;
        outputs[0].size = need - 1;
        if (code == DONE) code = place(&outputs[0], a->output, "plan", ".json");
        count = 1;
    } else {
        for (i = 0; i < (int32_t)plan->pass_count && code == DONE; ++i) {
            if (a->pass && i != only) continue;
            code = make_pass(plan, i, spirv, &outputs[count]);
            if (code == DONE) code = place(&outputs[count], a->output, plan->passes[i].name, spirv ? ".spv" : ".comp");
            ++count;
        }
    }
    if (folder && code == DONE && mkdir(a->output, 0777) && errno != EEXIST) {
        fprintf(stderr, "shadergen: cannot make folder %s: %s\n", a->output, strerror(errno));
        code = IO;
    }
    if (code == DONE) code = write_outputs(outputs, count);
    for (i = 0; i < count; ++i) free(outputs[i].data);
    return code;
}

static int print_config(const hbil_config *config)
{
    hbil_config c;
    char text[4096], *s;
    if (hbil_config_resolve(config, &c, NULL) != HBIL_OK || hbil_config_print(&c, 1, text, sizeof text, NULL) != HBIL_OK) return CONFIG;
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
    { "--preset", "", "preset", 1 }, { "--config", "-c", "file", 2 }, { "--set", "", "set", 3 }, { "--target", "", "target", 3 },
    { "--format", "", "format", 0 }, { "--pass", "", "pass", 0 }, { "--output", "-o", "output", 0 }, { "--explain", "", "explain", 0 } };

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
            else if (strcmp(argv[i], "--list-options") == 0 || strcmp(argv[i], "--print-config") == 0 ||
                     strcmp(argv[i], "--version") == 0 || strcmp(argv[i], "--help") == 0) a->action = argv[i];
            else if (strcmp(argv[i], "-h") == 0) a->action = "--help";
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
    arguments a = { "glsl", NULL, "-", NULL, NULL, 0 };
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
