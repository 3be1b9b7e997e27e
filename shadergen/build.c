/* build.c - see build.h. */
#include "build.h"

#include "../backends/hbil_glslang.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WORDS_MAX 65536 /* SPIR-V words of one pass */

static char compiler_log[8192];

int no_memory(void)
{
    fprintf(stderr, "shadergen: out of memory\n");
    return IO;
}

static hbil_glslang_result compile(const char *text, hbil_target target, file *f)
{
    uint32_t *words = (uint32_t *)malloc(WORDS_MAX * sizeof *words);
    size_t need = 0;
    hbil_glslang_result result = HBIL_GLSLANG_E_ARG;
    if (words) result = hbil_glslang_compile(text, target, words, WORDS_MAX, &need, compiler_log, sizeof compiler_log);
    if (result != HBIL_GLSLANG_OK) { free(words); return result; }
    f->data = (char *)words;
    f->size = need * sizeof *words;
    return HBIL_GLSLANG_OK;
}

char *build_glsl(const hbil_plan *plan, int32_t pass, const char *hook, size_t *size, hbil_diags *diags)
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
    file f = { "", NULL, 0 };
    size_t size;
    char *text = build_glsl(plan, pass, plain, &size, NULL);
    int ok = text && compile(text, (hbil_target)plan->config.target, &f) == HBIL_GLSLANG_OK;
    free(text);
    free(f.data);
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

const char *language_suffix(const hbil_plan *plan, language l)
{
    static const char *const suffixes[] = { ".comp", ".spv", ".hlsl", ".hlsl", ".metal" };
    return l == GLSL && plan->config.stage == HBIL_STAGE_FRAGMENT ? ".frag" : suffixes[l];
}

/* GLSL in f becomes words, or what SPIRV-Cross makes of them. */
static int translate(const hbil_plan *plan, int32_t pass, language l, const hook_file *hook, file *f)
{
    file words = { "", NULL, 0 };
    int code = DONE;
    if (compile(f->data, (hbil_target)plan->config.target, &words) != HBIL_GLSLANG_OK) return refused(plan, pass, hook);
    free(f->data);
    f->data = words.data;
    f->size = words.size;
    if (l == SPIRV) return DONE;
    f->data = build_cross(plan, pass, l, (const uint32_t *)(void *)words.data, words.size / sizeof(uint32_t), &f->size);
    if (!f->data) code = COMPILER;
    free(words.data);
    return code;
}

int build_pass(const hbil_plan *plan, int32_t pass, language l, const hook_file *hook, file *f)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    f->data = build_glsl(plan, pass, hook->text, &f->size, &diags);
    if (!f->data) {
        int i;
        for (i = 0; i < diags.count && i < diags.capacity; ++i)
            fprintf(stderr, "shadergen: %s%s%s\n", hook->path ? hook->path : "", hook->path ? ": " : "", items[i].text);
        return diags.count ? CONFIG : no_memory();
    }
    return l == GLSL ? DONE : translate(plan, pass, l, hook, f);
}

int build_vertex(const hbil_plan *plan, file *f)
{
    size_t need = 0;
    hbil_emit_vertex(plan, NULL, 0, &need);
    f->data = (char *)malloc(need);
    f->size = need - 1;
    return f->data && hbil_emit_vertex(plan, f->data, need, NULL) == HBIL_OK ? DONE : no_memory();
}

int build_manifest(const hbil_plan *plan, file *f)
{
    size_t need = 0;
    hbil_emit_manifest(plan, NULL, 0, &need);
    f->data = (char *)malloc(need);
    f->size = need - 1;
    return f->data && hbil_emit_manifest(plan, f->data, need, NULL) == HBIL_OK ? DONE : no_memory();
}
