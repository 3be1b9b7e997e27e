/* hbil_glslang.h - GLSL text of a pass to SPIR-V words, over glslang's C interface.
 *
 * Needs glslang 12 or later and, since glslang is C++, its C++ run time. Debian: glslang-dev spirv-tools. Static link line,
 * in this order: -lglslang -lSPIRV -lMachineIndependent -lGenericCodeGen -lOGLCompiler -lOSDependent
 *   -lglslang-default-resource-limits -lSPIRV-Tools-opt -lSPIRV-Tools -lstdc++ -lm
 * (pkg-config glslang names only the first of them; glslang 14 has no OGLCompiler any more.)
 * glslang keeps process-wide tables: call hbil_glslang_init once before the first compile, hbil_glslang_shutdown after the
 * last. Both count, so they pair up beside another user of glslang; neither may run at the same time as any other call.
 *
 * [x] Vulkan 1.1, SPIR-V 1.3             [x] any number of threads compile at once
 * [x] OpenGL and ES, for checks only     [x] spirv-opt's passes for size   [ ] debug info: glslangValidator -g
 *
 * OWNERSHIP  text, words, log: yours, not kept. Everything made inside a call is freed before it returns.
 *
 * INTEGRATION
 *   1. In one file: #define HBIL_GLSLANG_IMPLEMENTATION, then include this file. hbil.h is found beside it or comes first.
 *   2. hbil_glslang_init() at start.
 *   3. hbil_emit_glsl(&plan, pass, text, sizeof text, NULL).
 *   4. hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, count, &need, log, sizeof log).
 *   5. hbil_glslang_shutdown() at the end.
 *
 * CHANGELOG
 *   2026-11  NEW first version, hbil_glslang_optimize. */
#ifndef HBIL_GLSLANG_H
#define HBIL_GLSLANG_H

#ifndef HBIL_H
#include "hbil.h"
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef enum hbil_glslang_result {
    HBIL_GLSLANG_OK,
    HBIL_GLSLANG_E_ARG,     /* null pointer or unknown target */
    HBIL_GLSLANG_E_COMPILE, /* the text is not valid, see the log */
    HBIL_GLSLANG_E_SPACE    /* words too small, *need_words tells the count */
} hbil_glslang_result;

/* 1 on success, 0: out of memory. */
int  hbil_glslang_init(void);
void hbil_glslang_shutdown(void);

/* Compile one shader that hbil.h made: its stage and version are read from the text. Writes all words or none. cap_words, *need_words: uint32_t, not bytes; words may be NULL if
 * cap_words is 0, need_words may be NULL. HBIL_TARGET_GL and _GLES are for checks: the GL backend takes the text
 * itself. ESSL 3.00 has no SPIR-V: it is checked, and *need_words is 0.
 * log (may be NULL if log_cap is 0) is always terminated: glslang's messages, "ERROR: 0:<line>: ...", cut to fit. */
hbil_glslang_result hbil_glslang_compile(const char *text, hbil_target target, uint32_t *words, size_t cap_words,
                                         size_t *need_words, char *log, size_t log_cap);
/* The same, then spirv-opt's passes for size: calls inlined, variables in SSA form, dead code gone, names kept. */
hbil_glslang_result hbil_glslang_optimize(const char *text, hbil_target target, uint32_t *words, size_t cap_words,
                                          size_t *need_words, char *log, size_t log_cap);

#ifdef __cplusplus
}
#endif
#endif /* HBIL_GLSLANG_H */

#ifdef HBIL_GLSLANG_IMPLEMENTATION
#ifndef HBIL_GLSLANG_IMPLEMENTED
#define HBIL_GLSLANG_IMPLEMENTED

#include <string.h>

#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

int  hbil_glslang_init(void)     { return glslang_initialize_process() != 0; }
void hbil_glslang_shutdown(void) { glslang_finalize_process(); }

/* Append to log, always terminated. */
static void hbil_glslang__log(char *log, size_t cap, const char *text)
{
    if (cap == 0 || text == NULL) return;
    const size_t used = strlen(log), room = cap - 1 - used, size = strlen(text);
    memcpy(log + used, text, size < room ? size : room);
    log[used + (size < room ? size : room)] = '\0';
}

/* SPIR-V begins with ESSL 3.10. */
static int hbil_glslang__has_spirv(const char *text) { return strncmp(text, "#version 300 es", 15) != 0; }

static glslang_input_t hbil_glslang__input(const char *text, hbil_target target)
{
    const int vulkan = target == HBIL_TARGET_VULKAN, spirv = hbil_glslang__has_spirv(text);
    const int rules = (spirv ? (int)GLSLANG_MSG_SPV_RULES_BIT : 0) | (vulkan ? (int)GLSLANG_MSG_VULKAN_RULES_BIT : 0);
    glslang_input_t in;
    memset(&in, 0, sizeof in);
    in.language = GLSLANG_SOURCE_GLSL;
    in.stage = strstr(text, "local_size_x") != NULL ? GLSLANG_STAGE_COMPUTE
             : strstr(text, "gl_Position") != NULL ? GLSLANG_STAGE_VERTEX : GLSLANG_STAGE_FRAGMENT;
    in.client = vulkan ? GLSLANG_CLIENT_VULKAN : spirv ? GLSLANG_CLIENT_OPENGL : GLSLANG_CLIENT_NONE;
    in.client_version = vulkan ? GLSLANG_TARGET_VULKAN_1_1 : GLSLANG_TARGET_OPENGL_450;
    in.target_language = spirv ? GLSLANG_TARGET_SPV : GLSLANG_TARGET_NONE;
    in.target_language_version = vulkan ? GLSLANG_TARGET_SPV_1_3 : GLSLANG_TARGET_SPV_1_0;
    in.code = text;
    in.default_version = 450; /* the text's own #version comes first */
    in.default_profile = GLSLANG_CORE_PROFILE;
    in.messages = (glslang_messages_t)rules;
    in.resource = glslang_default_resource();
    return in;
}

/* Parse, link and translate; the words stay in the program. */
static int hbil_glslang__build(glslang_shader_t *shader, glslang_program_t *program, const glslang_input_t *in,
                               int optimize, char *log, size_t log_cap)
{
    /* stage=fragment leaves bindings to their names */
    if (in->stage != GLSLANG_STAGE_COMPUTE)
        glslang_shader_set_options(shader, (int)GLSLANG_SHADER_AUTO_MAP_BINDINGS | (int)GLSLANG_SHADER_AUTO_MAP_LOCATIONS);
    const int parsed = glslang_shader_preprocess(shader, in) && glslang_shader_parse(shader, in);
    hbil_glslang__log(log, log_cap, glslang_shader_get_info_log(shader));
    if (!parsed) return 0;
    glslang_program_add_shader(program, shader);
    const int linked = glslang_program_link(program, (int)in->messages);
    hbil_glslang__log(log, log_cap, glslang_program_get_info_log(program));
    if (!linked || in->target_language == GLSLANG_TARGET_NONE) return linked;
    glslang_spv_options_t options;
    memset(&options, 0, sizeof options);
    options.disable_optimizer = !optimize;
    options.optimize_size = optimize != 0;
    glslang_program_SPIRV_generate_with_options(program, in->stage, &options);
    hbil_glslang__log(log, log_cap, glslang_program_SPIRV_get_messages(program));
    return glslang_program_SPIRV_get_size(program) != 0;
}

static hbil_glslang_result hbil_glslang__words(const char *text, hbil_target target, int optimize, uint32_t *words,
                                               size_t cap_words, size_t *need_words, char *log, size_t log_cap)
{
    if (log == NULL && log_cap > 0) return HBIL_GLSLANG_E_ARG;
    if (log_cap > 0) log[0] = '\0';
    if (need_words != NULL) *need_words = 0;
    if (text == NULL || (words == NULL && cap_words > 0)) return HBIL_GLSLANG_E_ARG;
    if (target < HBIL_TARGET_VULKAN || target > HBIL_TARGET_GLES) return HBIL_GLSLANG_E_ARG;

    const glslang_input_t in = hbil_glslang__input(text, target);
    glslang_shader_t *shader = glslang_shader_create(&in);
    glslang_program_t *program = glslang_program_create();
    hbil_glslang_result result = HBIL_GLSLANG_E_COMPILE;
    if (shader != NULL && program != NULL && hbil_glslang__build(shader, program, &in, optimize, log, log_cap)) {
        const size_t need = hbil_glslang__has_spirv(text) ? glslang_program_SPIRV_get_size(program) : 0;
        if (need_words != NULL) *need_words = need;
        result = need <= cap_words ? HBIL_GLSLANG_OK : HBIL_GLSLANG_E_SPACE;
        if (result == HBIL_GLSLANG_OK && need > 0) glslang_program_SPIRV_get(program, words);
    }
    if (result == HBIL_GLSLANG_E_COMPILE && log_cap > 0 && log[0] == '\0')
        hbil_glslang__log(log, log_cap, "glslang gave no reason: was hbil_glslang_init called?");
    if (program != NULL) glslang_program_delete(program);
    if (shader != NULL) glslang_shader_delete(shader);
    return result;
}

hbil_glslang_result hbil_glslang_compile(const char *text, hbil_target target, uint32_t *words, size_t cap_words,
                                         size_t *need_words, char *log, size_t log_cap)
{
    return hbil_glslang__words(text, target, 0, words, cap_words, need_words, log, log_cap);
}

hbil_glslang_result hbil_glslang_optimize(const char *text, hbil_target target, uint32_t *words, size_t cap_words,
                                          size_t *need_words, char *log, size_t log_cap)
{
    return hbil_glslang__words(text, target, 1, words, cap_words, need_words, log, log_cap);
}

#endif /* HBIL_GLSLANG_IMPLEMENTED */
#endif /* HBIL_GLSLANG_IMPLEMENTATION */
