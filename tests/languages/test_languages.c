/* test_languages.c - every preset in every language: GLSL and ESSL, compute and fragment, pass glslang and spirv-val (the glsl test
 * does that over the whole matrix); HLSL is read again by glslang's own HLSL front end, MSL by a reader of its bindings; both bind where
 * the manifest says. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../../backends/hbil_glslang.h"
#include "../../shadergen/build.h"

#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#define WORDS 65536

static uint32_t words[WORDS];
static char     text[HBIL_GLSL_MAX], log_text[4096], manifest[262144];

/* 0: refused, with `why` in the message. */
static int plan_of_preset(int32_t preset, const char *values, hbil_plan *plan)
{
    hbil_config c;
    assert_int_equal(hbil_config_preset(hbil_preset_name(preset), &c, NULL), HBIL_OK);
    if (hbil_config_parse(&c, values, strlen(values), NULL) != HBIL_OK) fail_msg("%s", values);
    return hbil_plan_build(&c, plan, NULL) == HBIL_OK;
}

static size_t spirv_of(const hbil_plan *plan, int32_t pass)
{
    size_t need = 0;
    assert_int_equal(hbil_emit_glsl(plan, pass, text, sizeof text, NULL), HBIL_OK);
    if (hbil_glslang_compile(text, (hbil_target)plan->config.target, words, WORDS, &need, log_text, sizeof log_text) != HBIL_GLSLANG_OK)
        fail_msg("%s: %s", plan->passes[pass].name, log_text);
    return need;
}

/* ---------------------------------------------------------------------- dialects of GLSL */

static void every_preset_compiles_in_every_dialect(void **state)
{
    static const char *const dialects[] = { "target=vulkan", "target=gl", "target=gles", "target=gl stage=fragment march=sampled reproject=camera",
                                            "target=gles stage=fragment march=sampled reproject=camera" };
    int32_t k, i;
    size_t d;
    int texts = 0;
    (void)state;
    for (k = 0; hbil_preset_name(k); ++k)
        for (d = 0; d < sizeof dialects / sizeof dialects[0]; ++d) {
            static hbil_plan plan;
            if (!plan_of_preset(k, dialects[d], &plan)) fail_msg("%s %s", hbil_preset_name(k), dialects[d]);
            for (i = 0; i < (int32_t)plan.pass_count; ++i, ++texts) spirv_of(&plan, i);
            if (plan.config.stage != HBIL_STAGE_FRAGMENT) continue;
            assert_int_equal(hbil_emit_vertex(&plan, text, sizeof text, NULL), HBIL_OK);
            assert_int_equal(hbil_glslang_compile(text, (hbil_target)plan.config.target, words, WORDS, NULL, log_text, sizeof log_text), HBIL_GLSLANG_OK);
        }
    print_message("%d texts\n", texts);
}

/* ---------------------------------------------------------------------- HLSL */

/* By glslang's HLSL front end, which knows shader model 5. */
static void read_hlsl(const char *source, const char *where)
{
    glslang_input_t in;
    glslang_shader_t *shader;
    glslang_program_t *program = glslang_program_create();
    memset(&in, 0, sizeof in);
    in.language = GLSLANG_SOURCE_HLSL;
    in.stage = GLSLANG_STAGE_COMPUTE;
    in.client = GLSLANG_CLIENT_VULKAN;
    in.client_version = GLSLANG_TARGET_VULKAN_1_1;
    in.target_language = GLSLANG_TARGET_SPV;
    in.target_language_version = GLSLANG_TARGET_SPV_1_3;
    in.code = source;
    in.default_version = 500;
    in.default_profile = GLSLANG_NO_PROFILE;
    in.messages = (glslang_messages_t)((int)GLSLANG_MSG_READ_HLSL_BIT | (int)GLSLANG_MSG_SPV_RULES_BIT | (int)GLSLANG_MSG_VULKAN_RULES_BIT);
    in.resource = glslang_default_resource();
    shader = glslang_shader_create(&in);
    if (!glslang_shader_preprocess(shader, &in) || !glslang_shader_parse(shader, &in))
        fail_msg("%s: %s", where, glslang_shader_get_info_log(shader));
    glslang_program_add_shader(program, shader);
    if (!glslang_program_link(program, (int)in.messages)) fail_msg("%s: %s", where, glslang_program_get_info_log(program));
    glslang_program_delete(program);
    glslang_shader_delete(shader);
}

/* The declaration of a name ends with this, on its line. */
static void assert_declared(const char *source, const char *name, const char *end, const char *where)
{
    char word[256], line[1024];
    const char *at;
    snprintf(word, sizeof word, " %s", name);
    for (at = source; (at = strstr(at, word)) != NULL; ++at) {
        const char *behind = at + strlen(word);
        const size_t length = strcspn(at, "\n");
        if (*behind != ' ' && *behind != ';') continue;
        assert_true(length < sizeof line);
        memcpy(line, at, length);
        line[length] = 0;
        if (strstr(line, end)) return;
    }
    fail_msg("%s: %s is not declared with %s", where, name, end);
}

static void name_of(const hbil_plan *plan, const hbil_binding *b, char name[64])
{
    hbil__sink s = hbil__sink_open(name, 64);
    hbil__put_binding_name(&s, plan, b);
    assert_int_equal(hbil__sink_close(&s, NULL), HBIL_OK);
}

/* What the manifest says of binding b of the pass, the value of a key. */
static void manifest_says(const char *pass, int b, const char *key, char out[32])
{
    char head[64];
    const char *at;
    int i;
    snprintf(head, sizeof head, "{\"name\": \"%s\", \"group\"", pass);
    at = strstr(manifest, head);
    assert_non_null(at);
    at = strstr(at, "\"bindings\": [");
    for (i = 0; i <= b; ++i) at = strstr(at + 1, "{\"slot\"");
    snprintf(head, sizeof head, "\"%s\": \"", key);
    at = strstr(at, head) + strlen(head);
    snprintf(out, 32, "%.*s", (int)strcspn(at, "\""), at);
}

static void check_registers(const hbil_plan *plan, int32_t pass, language l, const char *source, const char *where)
{
    const hbil_pass *p = &plan->passes[pass];
    char name[64], place[32], end[64];
    int b;
    for (b = 0; b < p->binding_count; ++b) {
        name_of(plan, &p->bindings[b], name);
        manifest_says(p->name, b, l == MSL ? "msl" : "hlsl", place);
        snprintf(end, sizeof end, l == MSL ? "[[%s]]" : l == HLSL_6 ? " : register(%s, space0);" : " : register(%s);", place);
        assert_declared(source, name, end, where);
    }
    if (!p->constants) return;
    if (l == MSL) assert_non_null(strstr(source, "constant HbilFrame& "));
    assert_non_null(strstr(source, l == MSL ? "[[buffer(0)]]" : "cbuffer HbilFrame : register(b0"));
}

static void presets_in(language l, const char *label)
{
    int32_t k, i;
    int texts = 0;
    size_t size;
    for (k = 0; hbil_preset_name(k); ++k) {
        static hbil_plan plan;
        assert_true(plan_of_preset(k, "", &plan));
        assert_int_equal(hbil_emit_manifest(&plan, manifest, sizeof manifest, NULL), HBIL_OK);
        for (i = 0; i < (int32_t)plan.pass_count; ++i, ++texts) {
            char where[96], *source = build_cross(&plan, i, l, words, spirv_of(&plan, i), &size);
            snprintf(where, sizeof where, "%s, %s of %s", label, plan.passes[i].name, hbil_preset_name(k));
            if (!source) fail_msg("%s", where);
            assert_int_equal(size, strlen(source));
            check_registers(&plan, i, l, source, where);
            if (l != MSL) read_hlsl(source, where);
            free(source);
        }
    }
    print_message("%d texts\n", texts);
}

static void hlsl_5_is_read_by_glslang_and_binds_as_the_manifest_says(void **state) { (void)state; presets_in(HLSL_5, "HLSL 5.0"); }
static void hlsl_6_is_read_by_glslang_and_binds_as_the_manifest_says(void **state) { (void)state; presets_in(HLSL_6, "HLSL 6.0"); }
static void msl_binds_as_the_manifest_says(void **state) { (void)state; presets_in(MSL, "MSL 2.1"); }

/* Registers stay below what shader model 5.0 and Metal have. */
static void registers_are_few(void **state)
{
    int32_t k, i, b;
    (void)state;
    for (k = 0; hbil_preset_name(k); ++k) {
        static hbil_plan plan;
        assert_true(plan_of_preset(k, "", &plan));
        for (i = 0; i < (int32_t)plan.pass_count; ++i)
            for (b = 0; b < plan.passes[i].binding_count; ++b)
                assert_in_range(hbil_plan_register(&plan, i, b), 0, plan.passes[i].bindings[b].access == HBIL_ACCESS_WRITE ? 7 : 15);
        assert_int_equal(hbil_plan_register(&plan, (int32_t)plan.pass_count, 0), -1);
        assert_int_equal(hbil_plan_register(&plan, 0, plan.passes[0].binding_count), -1);
        assert_int_equal(hbil_plan_register(NULL, 0, 0), -1);
    }
}

static int set_up(void **state)
{
    (void)state;
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
        cmocka_unit_test(every_preset_compiles_in_every_dialect),
        cmocka_unit_test(hlsl_5_is_read_by_glslang_and_binds_as_the_manifest_says),
        cmocka_unit_test(hlsl_6_is_read_by_glslang_and_binds_as_the_manifest_says),
        cmocka_unit_test(msl_binds_as_the_manifest_says),
        cmocka_unit_test(registers_are_few),
    };
    return cmocka_run_group_tests_name("languages", tests, set_up, tear_down);
}
