/* test_glsl.c - over a pairwise matrix of all options: the text compiles, the SPIR-V is valid, glslang's own preprocessor
 * over the authored chunks gives the same SPIR-V as our filter (twin), and reflection finds what the plan says. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../matrix.h"
#define HBIL_GLSLANG_IMPLEMENTATION
#include "../../backends/hbil_glslang.h"

#include <spirv-tools/libspirv.h>
#include <spirv_cross/spirv_cross_c.h>

#define WORDS 65536

static hbil_config configs[MATRIX_ROWS];
static int         config_count;
static char        text[HBIL_GLSL_MAX], twin[4 * HBIL_GLSL_MAX], log_text[4096];
static uint32_t    words[WORDS], twin_words[WORDS];

/* Calls check for every pass of every config; counts passes. */
static int for_all(void (*check)(const hbil_plan *plan, int32_t pass))
{
    int k, n = 0;
    for (k = 0; k < config_count; ++k) {
        hbil_plan plan;
        int32_t i;
        assert_int_equal(hbil_plan_build(&configs[k], &plan, NULL), HBIL_OK);
        for (i = 0; i < (int32_t)plan.pass_count; ++i, ++n) {
            assert_int_equal(hbil_emit_glsl(&plan, i, text, sizeof text, NULL), HBIL_OK);
            check(&plan, i);
        }
    }
    return n;
}

static size_t compile(const char *source, const hbil_plan *plan, uint32_t *out)
{
    size_t need = 0;
    hbil_glslang_result r = hbil_glslang_compile(source, (hbil_target)plan->config.target, out, WORDS, &need, log_text, sizeof log_text);
    if (r != HBIL_GLSLANG_OK) print_error("%s\n%s\n", source, log_text);
    assert_int_equal(r, HBIL_GLSLANG_OK);
    return need;
}

/* ---------------------------------------------------------------------- valid */

static void check_valid(const hbil_plan *plan, int32_t pass)
{
    spv_context context = spvContextCreate(plan->config.target == HBIL_TARGET_GL ? SPV_ENV_OPENGL_4_5 : SPV_ENV_VULKAN_1_1);
    spv_diagnostic diagnostic = NULL;
    (void)pass;
    if (spvValidateBinary(context, words, compile(text, plan, words), &diagnostic) != SPV_SUCCESS) {
        print_error("%s\n%s\n", text, diagnostic ? diagnostic->error : "");
        fail();
    }
    spvDiagnosticDestroy(diagnostic);
    spvContextDestroy(context);
}

static void every_text_compiles_and_its_spirv_is_valid(void **state)
{
    int n = for_all(check_valid);
    (void)state;
    print_message("%d configs, %d passes\n", config_count, n);
}

/* ---------------------------------------------------------------------- twin */

/* #define lines for every symbol in the #if lines of a chunk. */
static void define_symbols(const hbil_config *c, const char *chunk, hbil__sink *s)
{
    const char *at = chunk;
    for (; *at; at += strcspn(at, "\n") + 1) {
        const char *end = at + strcspn(at, "\n"), *w = at;
        if (*at != '#') continue;
        while ((w = strstr(w, "HBIL_")) != NULL && w < end) {
            size_t len = 0;
            char name[64], define[96];
            while (hbil__is_word(w[len])) ++len;
            memcpy(name, w, len);
            name[len] = 0;
            snprintf(define, sizeof define, "#define %s %d\n", name, hbil__symbol(c, name, len));
            if (s->size == 0 || !strstr(twin, define)) hbil__puts(s, define);
            w += len;
        }
    }
}

/* The same pass with the chunks as authored: #if lines left for glslang's preprocessor. */
static void check_twin(const hbil_plan *plan, int32_t pass)
{
    hbil__used used;
    hbil__sink s = hbil__sink_open(twin, sizeof twin);
    const char *body = strstr(text, "// ---- "), *first = strchr(text, '\n') + 1;
    size_t a, b;
    int32_t i;
    memset(twin, 0, sizeof twin);
    assert_non_null(body);
    hbil__scan_pass(&plan->config, hbil__pass_row(plan->passes[pass].name), &used);
    hbil__put(&s, text, (size_t)(first - text)); /* #version */
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (hbil__marked(used.chunks, i)) define_symbols(&plan->config, hbil__chunks[i].text, &s);
    hbil__put(&s, first, (size_t)(body - first)); /* layout and constants: from the plan in both */
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (hbil__marked(used.chunks, i)) hbil__puts(&s, hbil__chunks[i].text);
    assert_int_equal(hbil__sink_close(&s, NULL), HBIL_OK);
    a = compile(text, plan, words);
    b = compile(twin, plan, twin_words);
    assert_int_equal(a, b);
    assert_memory_equal(words, twin_words, a * sizeof *words);
}

static void filter_and_glslang_preprocessor_give_the_same_spirv(void **state)
{
    int n = for_all(check_twin);
    (void)state;
    print_message("%d twins\n", n);
}

/* ---------------------------------------------------------------------- reflection */

static spvc_compiler compiler;

static const spvc_reflected_resource *resources(spvc_resource_type type, size_t *count)
{
    const spvc_reflected_resource *list;
    spvc_resources all;
    assert_int_equal(spvc_compiler_create_shader_resources(compiler, &all), SPVC_SUCCESS);
    assert_int_equal(spvc_resources_get_resource_list_for_type(all, type, &list, count), SPVC_SUCCESS);
    return list;
}

static SpvImageFormat spirv_format(uint16_t format)
{
    return format == HBIL_FORMAT_R32F ? SpvImageFormatR32f : format == HBIL_FORMAT_R32UI ? SpvImageFormatR32ui :
           format == HBIL_FORMAT_RGBA32F ? SpvImageFormatRgba32f : SpvImageFormatUnknown;
}

/* Each resource of one kind is one binding of the plan, and their numbers are equal. */
static void check_bindings(const hbil_plan *plan, const hbil_pass *pass, spvc_resource_type type, hbil_access access)
{
    size_t count, k;
    const spvc_reflected_resource *list = resources(type, &count);
    uint32_t b, expected = 0;
    for (b = 0; b < pass->binding_count; ++b) expected += pass->bindings[b].access == access;
    assert_int_equal(count, expected);
    for (k = 0; k < count; ++k) {
        const hbil_texture *t = NULL;
        for (b = 0; b < pass->binding_count; ++b)
            if (pass->bindings[b].access == access && strcmp(plan->textures[pass->bindings[b].texture].name, list[k].name + 2) == 0) break;
        assert_true(b < pass->binding_count);
        t = &plan->textures[pass->bindings[b].texture];
        assert_int_equal(spvc_compiler_get_decoration(compiler, list[k].id, SpvDecorationBinding), pass->bindings[b].slot);
        if (plan->config.target == HBIL_TARGET_VULKAN)
            assert_int_equal(spvc_compiler_get_decoration(compiler, list[k].id, SpvDecorationDescriptorSet), 0);
        if (access == HBIL_ACCESS_WRITE) {
            spvc_type image = spvc_compiler_get_type_handle(compiler, list[k].type_id);
            assert_int_equal(spvc_type_get_image_storage_format(image), spirv_format(t->format));
            assert_true(t->format == HBIL_FORMAT_ANY || hbil_format_bytes((hbil_format)t->format) > 0);
        }
    }
}

static void check_block(const hbil_plan *plan, const hbil_pass *pass)
{
    size_t count, size;
    const spvc_reflected_resource *list = resources(SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, &count);
    spvc_type type;
    uint32_t i;
    assert_int_equal(count, pass->constants);
    if (!count) return;
    type = spvc_compiler_get_type_handle(compiler, list[0].base_type_id);
    assert_int_equal(spvc_compiler_get_decoration(compiler, list[0].id, SpvDecorationBinding), plan->constants_slot);
    assert_int_equal(spvc_type_get_num_member_types(type), plan->constant_count);
    assert_int_equal(spvc_compiler_get_declared_struct_size(compiler, type, &size), SPVC_SUCCESS);
    assert_int_equal((size + 15) / 16 * 16, plan->constants_size);
    for (i = 0; i < plan->constant_count; ++i) {
        unsigned offset;
        assert_int_equal(spvc_compiler_type_struct_member_offset(compiler, type, i, &offset), SPVC_SUCCESS);
        assert_int_equal(offset, plan->constants[i].offset);
        assert_string_equal(spvc_compiler_get_member_name(compiler, list[0].base_type_id, i), plan->constants[i].name);
    }
}

static void check_reflection(const hbil_plan *plan, int32_t pass)
{
    const hbil_pass *p = &plan->passes[pass];
    spvc_context context;
    spvc_parsed_ir ir;
    size_t n = compile(text, plan, words);
    assert_int_equal(spvc_context_create(&context), SPVC_SUCCESS);
    assert_int_equal(spvc_context_parse_spirv(context, words, n, &ir), SPVC_SUCCESS);
    assert_int_equal(spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler), SPVC_SUCCESS);
    assert_int_equal(spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, 0), p->group[0]);
    assert_int_equal(spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, 1), p->group[1]);
    check_bindings(plan, p, SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, HBIL_ACCESS_SAMPLE);
    check_bindings(plan, p, SPVC_RESOURCE_TYPE_STORAGE_IMAGE, HBIL_ACCESS_WRITE);
    check_block(plan, p);
    spvc_context_destroy(context);
}

static void reflection_equals_the_plan(void **state)
{
    (void)state;
    for_all(check_reflection);
}

/* ---------------------------------------------------------------------- text for people */

static int word_count(const char *s, const char *word)
{
    size_t n = strlen(word);
    int count = 0;
    while ((s = strstr(s, word)) != NULL) {
        count += !hbil__is_word(s[-1]) && !hbil__is_word(s[n]);
        s += n;
    }
    return count;
}

/* Every hbil_ and HBIL_ name that a line declares is used on another line; members of the block by any pass of the plan. */
static void check_no_dead_names(const hbil_plan *plan, int32_t pass)
{
    const char *s = text;
    (void)plan;
    (void)pass;
    assert_memory_equal(text, "#version 4", 10);
    assert_null(strstr(text, "#if"));
    assert_null(strstr(text, "#define"));
    assert_null(strstr(text, "\n\n\n"));
    assert_null(strstr(text, " \n"));
    assert_null(strchr(text, '\t'));
    assert_null(strchr(text, '\r'));
    assert_int_equal(text[strlen(text) - 1], '\n');
    for (; *s; s += strcspn(s, "\n") + 1) {
        char name[64];
        size_t n = 0;
        const char *at = strncmp(s, "const ", 6) == 0 || strncmp(s, "layout(set", 10) == 0 || strncmp(s, "layout(bind", 11) == 0 ||
                         strncmp(s, "struct ", 7) == 0 || (*s >= 'a' && *s <= 'z' && strncmp(s, "layout", 6) && strncmp(s, "void main", 9)) ? s : NULL;
        if (!at) continue;
        while (strncmp(at, "hbil_", 5) && strncmp(at, "HBIL_", 5) && strncmp(at, "u_", 2) && *at != '\n') ++at;
        if (*at == '\n') continue;
        if (strncmp(at, "HbilFrame", 9) == 0) continue;
        while (hbil__is_word(at[n])) ++n;
        memcpy(name, at, n);
        name[n] = 0;
        if (word_count(strstr(text, "layout(local"), name) < 2) { /* below the header comment */
            print_error("%s\nunused: %s\n", text, name);
            fail();
        }
    }
}

static void text_has_no_directive_and_no_unused_name(void **state)
{
    (void)state;
    for_all(check_no_dead_names);
}

static void every_uniform_is_read_by_a_pass(void **state)
{
    int k;
    (void)state;
    for (k = 0; k < config_count; ++k) {
        hbil_plan plan;
        uint32_t i, j;
        assert_int_equal(hbil_plan_build(&configs[k], &plan, NULL), HBIL_OK);
        for (i = 0; i < plan.constant_count; ++i) {
            int uses = 0;
            for (j = 0; j < plan.pass_count; ++j) {
                hbil_emit_glsl(&plan, (int32_t)j, text, sizeof text, NULL);
                if (plan.passes[j].constants) uses += word_count(strstr(text, "uniform HbilFrame"), plan.constants[i].name) - 1;
            }
            assert_true(uses > 0);
        }
    }
}

static void ao_alone_holds_nothing_of_radiance(void **state)
{
    static const char *const words_of_light[] = { "radiance", "albedo", "direct", "u_near", "RADIANCE", "bent", "near;", "composite" };
    hbil_config c;
    hbil_plan plan;
    int32_t i;
    size_t k;
    (void)state;
    memset(&c, 0, sizeof c);
    c.outputs = HBIL_OUTPUTS_AO;
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    assert_int_equal(plan.pass_count, 2);
    assert_int_equal(hbil_plan_texture(&plan, "radiance"), -1);
    for (i = 0; i < (int32_t)plan.pass_count; ++i) {
        hbil_emit_glsl(&plan, i, text, sizeof text, NULL);
        for (k = 0; k < sizeof words_of_light / sizeof words_of_light[0]; ++k) {
            const char *body = strstr(text, "layout(local");
            const char *hit = strstr(body, words_of_light[k]);
            if (hit && strcmp(words_of_light[k], "direct") == 0 && strncmp(hit, "direction", 9) == 0) hit = NULL;
            while (hit && hit > body && *hit != '\n' && strncmp(hit, "//", 2)) --hit; /* a word in a comment is no code */
            if (hit && *hit == '\n') print_error("%s in the text of %s\n", words_of_light[k], plan.passes[i].name);
            assert_true(!hit || *hit != '\n');
        }
    }
}

static int set_up(void **state)
{
    (void)state;
    config_count = matrix_pairwise(configs);
    return hbil_glslang_init() ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    hbil_glslang_shutdown();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_text_compiles_and_its_spirv_is_valid),
        cmocka_unit_test(filter_and_glslang_preprocessor_give_the_same_spirv),
        cmocka_unit_test(reflection_equals_the_plan),
        cmocka_unit_test(text_has_no_directive_and_no_unused_name),
        cmocka_unit_test(every_uniform_is_read_by_a_pass),
        cmocka_unit_test(ao_alone_holds_nothing_of_radiance),
    };
    return cmocka_run_group_tests_name("glsl", tests, set_up, tear_down);
}
