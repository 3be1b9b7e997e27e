/* shadergen.c - writes the shaders of a config: GLSL, SPIR-V or the manifest of the plan. See help(). */

#define HBIL_IMPLEMENTATION
#include "../hbil.h"
#include "../backends/hbil_glslang.h"

#include "build.h"
#include "cost.h"
#include "matrix.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *format, *pass, *output, *explain, *action, *hook, *depfile, *stamp, *error_format;
    int         verbose, quiet, check, json, cost;
} arguments;

/* A config file that was read, for the places of its faults and for --depfile. */
typedef struct source { const char *path; char *text; } source;

#define SOURCES_MAX 64
static source sources[SOURCES_MAX];
static int    source_count, msvc; /* msvc: how faults of config files are written */

static int help(FILE *f, int code)
{
    fputs("shadergen - writes the shaders of a horizon-based lighting config\n\n"
          "usage: shadergen [config] [output]\n"
          "       shadergen matrix FILE -o DIR    all combinations of lists of values; see shadergen matrix --help\n\n"
          "config, later wins over earlier, --set over all:\n"
          "  --preset NAME           start from a preset (see --list-presets)\n"
          "  -c, --config FILE       name=value pairs, # comments; - is standard input; may be repeated\n"
          "  --set NAME=VALUE[,...]  sets are written with +: outputs=ao+near\n"
          "  --target NAME           same as --set target=NAME: vulkan (default), gl, gles\n"
          "output:\n"
          "  --format FORMAT         glsl (default), spirv, c (a header that compiles alone), manifest (the plan as JSON),\n"
          "                          hlsl (shader model 5.0), hlsl6 (6.0), msl (2.1), essl (same as --target gles)\n"
          "  --pass NAME             only this pass\n"
          "  --hook FILE             GLSL text with the function of environment=hook; - is standard input\n"
          "  -o, --output PATH       file, folder (ends with /), or - for standard output (default)\n"
          "  --depfile FILE          a make rule: the outputs depend on the config files and the hook\n"
          "  --stamp FILE            holds the config's hash; then it is the target of that rule\n"
          "  --check                 write nothing; exit 5 if an output is not up to date\n"
          "instead of output:\n"
          "  --cost                  what each pass costs per pixel, and what each option adds\n"
          "  --list-options          the options and presets; with --json as data\n"
          "  --list-presets          the presets and what they set\n"
          "  --explain NAME          an option: meaning, unit, range, default, source;\n"
          "                          or a preset: its values, each with its source\n"
          "  --print-config          the config after defaults and checks\n"
          "many configs at once: shadergen matrix --help\n"
          "also:\n"
          "  --error-format STYLE    of faults in config files: gcc (FILE:LINE: error: ..., default) or msvc (FILE(LINE): ...)\n"
          "  -q, -v                  print errors only; print notes, too, such as options without effect\n"
          "  --version, -h, --help\n\n"
          "example: shadergen --set outputs=ao,slices=2 --format spirv -o shaders/\n\n"
          "exit: 0 done, 1 config or hook refused, 2 wrong usage, 3 cannot read or write,\n"
          "      4 a compiler refused our text, 5 --check found something that is not up to date\n", f);
    return code;
}

static int usage(const char *what, const char *word)
{
    fprintf(stderr, "shadergen: %s%s; see shadergen --help\n", what, word);
    return USAGE;
}

/* ---------------------------------------------------------------------- findings */

/* Line of a text that sets an option; 0: none does. */
static int line_of(const char *text, const char *option)
{
    size_t n = strlen(option);
    int line = 1, found = 0;
    for (; *text; ++line) {
        const char *end = text + strcspn(text, "\n"), *at = text, *comment = memchr(text, '#', (size_t)(end - text));
        if (comment) end = comment;
        while (at < end) {
            at += strspn(at, " \t,;");
            if (strncmp(at, option, n) == 0 && (at[n] == '=' || at[n] == ' ' || at[n] == '\t')) found = line;
            while (at < end && !strchr(" \t,;", *at)) ++at;
        }
        text += strcspn(text, "\n");
        if (*text) ++text;
    }
    return found;
}

static void print_at(const char *path, int line, const char *severity, const char *text)
{
    if (msvc) fprintf(stderr, "%s(%d): %s: %s\n", path, line, severity, text);
    else fprintf(stderr, "%s:%d: %s: %s\n", path, line, severity, text);
}

/* At the place that it is about, where a config file says it; else after the name of the program. */
static void print_diag(const hbil_diag *d, const source *from)
{
    static const char *const severities[] = { "note", "warning", "error" };
    const char *severity = severities[d->severity == HBIL_ERROR ? 2 : d->severity == HBIL_NOTE ? 0 : 1];
    const hbil_option *o = hbil_option_at(d->option);
    int i, line = 0;
    if (from) {
        const char *text = d->text;
        if (strncmp(text, "line ", 5) == 0) line = atoi(text + 5);
        if (line) text = strchr(text, ':') ? strchr(text, ':') + 2 : text;
        print_at(from->path, line ? line : 1, severity, text);
        return;
    }
    for (i = source_count - 1; i >= 0 && o && !line; --i) {
        line = line_of(sources[i].text, o->name);
        if (line) print_at(sources[i].path, line, severity, d->text);
    }
    if (!line) fprintf(stderr, "shadergen: %s\n", d->text);
}

static void print_diags(const hbil_diags *diags, const source *from, const arguments *a)
{
    int i, n = diags->count < diags->capacity ? diags->count : diags->capacity;
    for (i = 0; i < n; ++i)
        if (diags->items[i].severity == HBIL_ERROR || (!a->quiet && (a->verbose || from || diags->items[i].severity != HBIL_NOTE)))
            print_diag(&diags->items[i], from);
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

static void json_string(const char *s)
{
    putchar('"');
    for (; *s; ++s) printf(*s == '"' || *s == '\\' ? "\\%c" : *s == '\n' ? "\\n" : "%c", *s);
    putchar('"');
}

static void json_pair(const char *key, const char *value, int first)
{
    printf("%s\"%s\": ", first ? "" : ", ", key);
    json_string(value);
}

static int list_json(void)
{
    static const char *const kinds[] = { "choice", "int", "float", "set" };
    int32_t i;
    char def[64], values[4096];
    printf("{\n  \"schema\": 1, \"version\": %d,\n  \"options\": [", HBIL_VERSION);
    for (i = 0; i < hbil_option_count(); ++i) {
        const hbil_option *o = hbil_option_at(i);
        default_text(i, def, sizeof def);
        printf("%s\n    {", i ? "," : "");
        json_pair("name", o->name, 1);
        json_pair("kind", kinds[o->kind == HBIL_KIND_INT ? 1 : o->kind == HBIL_KIND_FLOAT ? 2 : o->kind == HBIL_KIND_SET ? 3 : 0], 0);
        json_pair("meaning", o->meaning, 0);
        json_pair("unit", o->unit, 0);
        if (*o->choices) json_pair("choices", o->choices, 0);
        else printf(", \"min\": %.9g, \"max\": %.9g", o->min, o->max);
        json_pair("default", def, 0);
        printf(", \"dynamic\": %s", o->dynamic ? "true" : "false");
        json_pair("applies", o->applies, 0);
        json_pair("source", o->source, 0);
        putchar('}');
    }
    printf("],\n  \"presets\": [");
    for (i = 0; hbil_preset_name(i); ++i) {
        hbil_config c;
        printf("%s\n    {", i ? "," : "");
        json_pair("name", hbil_preset_name(i), 1);
        json_pair("meaning", hbil_preset_meaning(i), 0);
        if (hbil_config_preset(hbil_preset_name(i), &c, NULL) != HBIL_OK || hbil_config_print(&c, 0, values, sizeof values, NULL) != HBIL_OK) *values = 0;
        json_pair("values", values, 0);
        putchar('}');
    }
    puts("]\n}");
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
        int line = (int)strcspn(at, "\n"), value = (int)strcspn(at, ":\n"), origin = value + (int)strspn(at + value, ": ");
        if (origin > line) origin = line;
        printf("  %-42.*s %.*s\n", value, at, line - origin, at + origin);
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
    printf("\n  default   %s\n  baked     %s\n", def, o->dynamic ? "unless the option dynamic names it" : "always");
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

/* The languages of --format; C and MANIFEST are of all passes at once. */
enum { C_HEADER = MSL + 1, MANIFEST };
static const struct { const char *name; int is; } formats[] = { { "glsl", GLSL }, { "spirv", SPIRV }, { "hlsl", HLSL_5 }, { "hlsl6", HLSL_6 },
    { "msl", MSL }, { "essl", GLSL }, { "c", C_HEADER }, { "manifest", MANIFEST } };
enum { FORMATS = sizeof formats / sizeof formats[0] };

static int format_of(const char *name)
{
    int i = 0;
    while (i < FORMATS && strcmp(formats[i].name, name)) ++i;
    return i < FORMATS ? formats[i].is : -1;
}

/* Does the dialect lead there? */
static int check_format(const hbil_plan *plan, const arguments *a)
{
    int is = format_of(a->format), draws = plan->config.stage == HBIL_STAGE_FRAGMENT;
    if (strcmp(a->format, "essl") == 0 && plan->config.target != HBIL_TARGET_GLES)
        return usage("--format essl: another target is set; leave it out, or set target=gles", "");
    if ((is == HLSL_5 || is == HLSL_6 || is == MSL) && plan->config.target != HBIL_TARGET_VULKAN)
        return usage("HLSL and MSL are made from the shaders for Vulkan: leave target out, not with --format ", a->format);
    if (is == SPIRV && draws && plan->config.target == HBIL_TARGET_GLES)
        return usage("ESSL 3.00 has no SPIR-V: take --format glsl, or set stage=compute", "");
    return DONE;
}

static int add_file(const hbil_plan *plan, int32_t pass, int format, const hook_file *hook, const arguments *a, files *outputs)
{
    file *f = files_add(outputs);
    const char *name = "hbil_shaders", *suffix = ".h";
    int code;
    if (!f) return no_memory();
    if (format == MANIFEST) {
        code = build_manifest(plan, f);
        name = "plan";
        suffix = ".json";
    } else if (format == C_HEADER) {
        code = build_c(plan, pass, a->output[strlen(a->output) - 1] == '/' ? name : a->output, hook, f);
    } else if (pass < 0) {
        code = build_vertex(plan, f);
        name = "vertex";
        suffix = ".vert";
    } else {
        code = build_pass(plan, pass, (language)format, hook, f);
        name = plan->passes[pass].name;
        suffix = language_suffix(plan, (language)format);
    }
    return code == DONE && !file_place(f, a->output, name, suffix) ? IO : code;
}

/* Path in a make rule. */
static void put_escaped(char *out, size_t room, const char *path)
{
    size_t n = strlen(out);
    for (; *path && n + 3 < room; ++path) {
        if (*path == ' ' || *path == '#') out[n++] = '\\';
        if (*path == '$') out[n++] = '$';
        out[n++] = *path;
    }
    out[n] = 0;
}

/* What make or ninja need to know, and the file whose time says that it was done. */
static int add_rule(const hbil_plan *plan, const hook_file *hook, const arguments *a, files *outputs)
{
    size_t room = 4096;
    int i, count = outputs->count;
    file *stamp = a->stamp ? files_add(outputs) : NULL, *rule;
    char *text;
    if (a->stamp && (!stamp || !(stamp->data = (char *)malloc(32)))) return no_memory();
    if (stamp && !file_place(stamp, a->stamp, "", "")) return IO;
    if (stamp) stamp->size = (size_t)snprintf(stamp->data, 32, "%016llx\n", (unsigned long long)plan->hash);
    if (!a->depfile) return DONE;
    for (i = 0; i < source_count; ++i) room += 2 * strlen(sources[i].path) + 4;
    room += (size_t)(count + 2) * 2 * sizeof outputs->items[0].path;
    rule = files_add(outputs);
    text = (char *)calloc(room, 1);
    if (!rule || !text) { free(text); return no_memory(); }
    rule->data = text;
    if (!file_place(rule, a->depfile, "", "")) return IO;
    if (a->stamp) put_escaped(text, room, a->stamp);
    else for (i = 0; i < count; ++i) {
        if (i) strcat(text, " ");
        put_escaped(text, room, outputs->items[i].path);
    }
    strcat(text, ":");
    for (i = 0; i < source_count; ++i) {
        if (strcmp(sources[i].path, "-") == 0) continue;
        strcat(text, " ");
        put_escaped(text, room, sources[i].path);
    }
    if (hook->path && strcmp(a->hook, "-")) {
        strcat(text, " ");
        put_escaped(text, room, hook->path);
    }
    strcat(text, "\n");
    rule->size = strlen(text);
    return DONE;
}

/* The outputs, in memory. */
static int make_outputs(const hbil_plan *plan, const arguments *a, int32_t only, const hook_file *hook, files *outputs)
{
    int format = format_of(a->format), folder = a->output[strlen(a->output) - 1] == '/', code = DONE;
    int32_t i;
    if (format == MANIFEST || format == C_HEADER) return add_file(plan, only, format, hook, a, outputs);
    for (i = 0; i < (int32_t)plan->pass_count && code == DONE; ++i)
        if (only < 0 || i == only) code = add_file(plan, i, format, hook, a, outputs);
    if (code == DONE && only < 0 && folder && plan->config.stage == HBIL_STAGE_FRAGMENT && format == GLSL)
        code = add_file(plan, -1, format, hook, a, outputs);
    return code;
}

static int generate(const hbil_plan *plan, const arguments *a)
{
    files outputs = { NULL, 0, 0 };
    hook_file hook = { NULL, NULL };
    int32_t only;
    int format = format_of(a->format), stale = 0;
    int code = find_pass(plan, a, &only), folder = a->output[strlen(a->output) - 1] == '/', standard = strcmp(a->output, "-") == 0;
    if (code == DONE) code = check_format(plan, a);
    if (code != DONE) return code;
    if (!folder && !a->pass && format != MANIFEST && format != C_HEADER && (format == SPIRV || !standard))
        return usage("several passes do not fit one file: name a folder (-o DIR/) or one pass (--pass NAME)", "");
    if (standard && (a->check || (a->depfile && !a->stamp)))
        return usage(a->check ? "--check compares files: name them with -o" : "--depfile: name the outputs with -o, or a --stamp", "");
    code = read_hook(plan, a, only, &hook);
    if (code == DONE) code = make_outputs(plan, a, only, &hook, &outputs);
    if (code == DONE && !a->check) code = add_rule(plan, &hook, a, &outputs);
    if (code == DONE && folder && !a->check && !folder_make(a->output)) code = IO;
    if (code == DONE && !files_write(&outputs, a->check ? &stale : NULL)) code = IO;
    if (code == DONE && stale) code = STALE;
    files_free(&outputs);
    free(hook.text);
    return code;
}

static int report_cost(const hbil_plan *plan, const arguments *a)
{
    hook_file hook = { NULL, NULL };
    int code = read_hook(plan, a, -1, &hook);
    if (code == DONE) code = cost_print(stdout, plan, &hook);
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

static int apply(hbil_config *config, const char *kind, const char *value, const arguments *a)
{
    hbil_diag items[16];
    hbil_diags diags = { items, 16, 0 };
    hbil_result result;
    source *from = NULL;
    size_t size = 0;
    if (strcmp(kind, "preset") == 0) {
        result = hbil_config_preset(value, config, &diags);
    } else if (strcmp(kind, "target") == 0) {
        result = hbil_config_set(config, "target", value, &diags);
    } else if (strcmp(kind, "set") == 0) {
        result = hbil_config_parse(config, value, strlen(value), &diags);
    } else {
        if (source_count == SOURCES_MAX) return usage("too many config files; put them together: ", value);
        from = &sources[source_count];
        from->path = value;
        from->text = read_all(value, &size);
        if (!from->text) {
            fprintf(stderr, "shadergen: cannot read %s: %s\n", value, strerror(errno));
            return IO;
        }
        ++source_count;
        result = hbil_config_parse(config, from->text, size, &diags);
    }
    print_diags(&diags, from, a);
    return result == HBIL_OK ? DONE : CONFIG;
}

static int is_action(const char *word)
{
    static const char *const actions[] = { "--list-options", "--list-presets", "--print-config", "--version", "--help" };
    size_t k;
    for (k = 0; k < sizeof actions / sizeof actions[0]; ++k)
        if (strcmp(word, actions[k]) == 0) return 1;
    return 0;
}

/* Value options, in the order in which they take effect; 0: not part of the config. */
static const struct { const char *name, *brief, *kind; int order; } flags[] = {
    { "--preset", "", "preset", 1 }, { "--config", "-c", "file", 2 }, { "--set", "", "set", 3 },
    { "--target", "", "target", 3 }, { "--format", "", "format", 0 }, { "--pass", "", "pass", 0 },
    { "--output", "-o", "output", 0 }, { "--explain", "", "explain", 0 }, { "--hook", "", "hook", 0 },
    { "--depfile", "", "depfile", 0 }, { "--stamp", "", "stamp", 0 }, { "--error-format", "", "error_format", 0 } };

/* Where the value of such a flag goes. */
static const char **place_of(arguments *a, const char *kind)
{
    const struct { const char *kind; const char **place; } places[] = { { "format", &a->format }, { "pass", &a->pass },
        { "output", &a->output }, { "explain", &a->explain }, { "hook", &a->hook }, { "depfile", &a->depfile }, { "stamp", &a->stamp },
        { "error_format", &a->error_format } };
    size_t i = 0;
    while (strcmp(places[i].kind, kind)) ++i;
    return places[i].place;
}

/* Flags without a value. 0: it is none of them. */
static int read_switch(arguments *a, const char *word)
{
    const struct { const char *word; int *on; } switches[] = { { "-v", &a->verbose }, { "-q", &a->quiet }, { "--check", &a->check },
        { "--json", &a->json }, { "--cost", &a->cost } };
    size_t i;
    for (i = 0; i < sizeof switches / sizeof switches[0]; ++i)
        if (strcmp(word, switches[i].word) == 0) { *switches[i].on = 1; return 1; }
    if (strcmp(word, "-h") == 0) word = "--help";
    if (!is_action(word)) return 0;
    a->action = word;
    return 1;
}

/* The nearest flag, by the measure that options have. */
static int unknown_argument(const char *word)
{
    static const char *const switches[] = { "--check", "--json", "--cost", "--list-options", "--list-presets", "--print-config", "--version",
                                            "--help" };
    const char *best = flags[0].name;
    size_t i, count = sizeof flags / sizeof flags[0], all = count + sizeof switches / sizeof switches[0];
    for (i = 0; i < all; ++i) {
        const char *name = i < count ? flags[i].name : switches[i - count];
        if (hbil__distance(name, word, strlen(word)) < hbil__distance(best, word, strlen(word))) best = name;
    }
    if (*word != '-') return usage("unknown argument ", word);
    fprintf(stderr, "shadergen: unknown argument %s; did you mean %s? see shadergen --help\n", word, best);
    return USAGE;
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
            if (!read_switch(a, argv[i])) return unknown_argument(argv[i]);
            continue;
        }
        if (++i == argc || !*argv[i]) return usage("no value after ", flags[k].name);
        if (flags[k].order != order) continue;
        if (order) {
            int one = apply(config, flags[k].kind, argv[i], a);
            if (one != DONE) code = one; /* go on: report every fault */
        } else {
            *place_of(a, flags[k].kind) = argv[i];
        }
    }
    return code;
}

/* What needs no config. -1: something else was asked for. */
static int run_action(const arguments *a)
{
    if (a->action && strcmp(a->action, "--help") == 0) return help(stdout, DONE);
    if (a->action && strcmp(a->action, "--version") == 0) {
        printf("shadergen %d.%d.%d\n", HBIL_VERSION_MAJOR, HBIL_VERSION_MINOR, HBIL_VERSION_PATCH);
        return DONE;
    }
    if (a->action && strcmp(a->action, "--list-options") == 0) return a->json ? list_json() : list_options();
    if (a->action && strcmp(a->action, "--list-presets") == 0) return list_presets();
    return a->explain ? explain(a->explain) : -1;
}

static int check_arguments(const arguments *a)
{
    if (a->cost && strcmp(a->output, "-")) return usage("--cost prints to the standard output: leave -o out", "");
    if (a->json) return usage("--json belongs to --list-options", "");
    if (format_of(a->format) < 0) return usage("--format must be glsl, spirv, c, manifest, hlsl, hlsl6, msl or essl, not ", a->format);
    if (strcmp(a->error_format, "gcc") && strcmp(a->error_format, "msvc"))
        return usage("--error-format must be gcc or msvc, not ", a->error_format);
    return DONE;
}

static int run(int argc, char **argv)
{
    hbil_config config;
    hbil_plan plan;
    hbil_diag item_of[32];
    hbil_diags diags = { item_of, 32, 0 };
    arguments a = { "glsl", NULL, "-", NULL, NULL, NULL, NULL, NULL, "gcc", 0, 0, 0, 0, 0 };
    int order, code, compiles;
    memset(&config, 0, sizeof config);
    if (argc == 1) return help(stdout, DONE);
    code = read_arguments(argc, argv, 0, &a, &config);
    if (code != DONE) return code;
    code = run_action(&a);
    if (code >= 0) return code;
    code = check_arguments(&a);
    if (code != DONE) return code;
    msvc = strcmp(a.error_format, "msvc") == 0;
    for (order = 1; order <= 3; ++order) {
        int one = read_arguments(argc, argv, order, &a, &config);
        if (one != DONE) code = one;
        if (order == 1 && strcmp(a.format, "essl") == 0) config.target = HBIL_TARGET_GLES;
    }
    if (code != DONE) return code;
    if (hbil_plan_build(&config, &plan, &diags) != HBIL_OK) code = CONFIG;
    print_diags(&diags, NULL, &a);
    if (code != DONE) return code;
    if (a.action) return print_config(&config);
    if (a.cost) return report_cost(&plan, &a);
    compiles = format_of(a.format) != GLSL && format_of(a.format) != MANIFEST;
    if (compiles && !hbil_glslang_init()) return no_memory();
    code = generate(&plan, &a);
    if (compiles) hbil_glslang_shutdown();
    return code;
}

int main(int argc, char **argv)
{
    int code = argc > 1 && strcmp(argv[1], "matrix") == 0 ? matrix(argc - 1, argv + 1) : run(argc, argv), i;
    for (i = 0; i < source_count; ++i) free(sources[i].text);
    if (code == DONE && (fflush(stdout) != 0 || ferror(stdout))) {
        fprintf(stderr, "shadergen: cannot write -: %s\n", strerror(errno));
        code = IO;
    }
    return code;
}
