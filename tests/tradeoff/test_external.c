/* test_external.c - externals: bindings, units, orientation and uniforms are as external.h says, our own march run as
 * an external gives our own picture, and what does not fit is refused with the reason. Exit code 77: no Vulkan. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define HBIL_IMPLEMENTATION
#include "../../backends/hbil_glslang.h"
#include "measure.h"

enum { WIDTH = 48, HEIGHT = 28 };

static runner  *device;
static settings s;
static capture  cap;
static subject  sub = {"scene:fence", &cap, 1};
static char     folder[64];

#define HEAD "#version 450\nlayout(local_size_x = 8, local_size_y = 4) in;\n"
#define MEMBERS "{ ivec2 size; vec2 texel; mat4 projection, inverse_projection, view; uint frame; }"
#define BEGIN                                                                                                          \
    "void main() { ivec2 p = ivec2(gl_GlobalInvocationID.xy); if (any(greaterThanEqual(p, u.size))) return;\n"

/* ---- helpers ----------------------------------------------------------------------------------------------------- */

/* SPIR-V of the text in the folder; its path. */
static const char *compile(const char *name, const char *text)
{
    static char     path[128];
    static uint32_t words[1 << 16];
    size_t          need;
    char            log[512];
    FILE           *f;

    if (hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, 1 << 16, &need, log, sizeof log) != HBIL_GLSLANG_OK)
        fail_msg("%s: %s", name, log);
    snprintf(path, sizeof path, "%s/%s.spv", folder, name);
    f = fopen(path, "wb");
    assert_non_null(f);
    assert_int_equal(fwrite(words, sizeof *words, need, f), need);
    fclose(f);
    return path;
}

/* "%s" in the text is the folder. The exit code; *x is to be freed. */
static int open_text(externals *x, const char *text)
{
    static char filled[2048];
    size_t      used = 0;
    const char *mark;

    for (; (mark = strstr(text, "%s")) != NULL; text = mark + 2)
        used += (size_t)snprintf(filled + used, sizeof filled - used, "%.*s%s", (int)(mark - text), text, folder);
    snprintf(filled + used, sizeof filled - used, "%s", text);
    memset(x, 0, sizeof *x);
    assert_true(externals_add(x, &s, filled));
    return externals_open(x, &s);
}

static void run_external(const char *text, uint32_t frame, image out[OUTS])
{
    externals x;
    lit       l;

    if (open_text(&x, text) != TRADE_DONE) fail_msg("%s: %s", text, s.error);
    if (!lit_open_external(&l, device, &s, &x.list[0], &sub, s.error, sizeof s.error)
        || !lit_images(&l, frame, out, s.error, sizeof s.error)) fail_msg("%s: %s", text, s.error);
    lit_close(&l);
    externals_free(&x);
}

static void free_images(image out[OUTS])
{
    int k;

    for (k = 0; k < OUTS; k++) image_free(&out[k]);
}

static int near_to(double a, double b, double tolerance) { return fabs(a - b) <= tolerance * (1.0 + fabs(b)); }

/* ---- what is bound ----------------------------------------------------------------------------------------------- */

/* Texels reach the shader where and as they are: columns of normals, radiance and albedo in turns. */
static void inputs_are_those_of_the_frame(void **state)
{
    static const char text[] = HEAD
        "layout(set = 1, binding = 4) uniform sampler2D u_normal;\n"
        "layout(set = 0, binding = 7) uniform sampler2D u_radiance; layout(binding = 9) uniform sampler2D u_albedo;\n"
        "layout(set = 2, binding = 0, r32f) readonly uniform image2D u_depth;\n"
        "layout(set = 2, binding = 1, rgba32f) writeonly uniform image2D u_ao;\n"
        "layout(set = 0, binding = 1, rgba32f) writeonly uniform image2D u_near;\n"
        "layout(std140, set = 3, binding = 5) uniform block " MEMBERS " u;\n"
        BEGIN "imageStore(u_ao, p, imageLoad(u_depth, p));\n"
        "imageStore(u_near, p, p.x % 3 == 0 ? texelFetch(u_normal, p, 0)\n"
        "    : p.x % 3 == 1 ? texelFetch(u_radiance, p, 0) : texelFetch(u_albedo, p, 0)); }\n";
    image out[OUTS];
    int   i, c;

    (void)state;
    compile("inputs", text);
    run_external("spv=%s/inputs.spv,normal=1.4,radiance=7,albedo=9,depth=2.0,ao=2.1,near=1,uniforms=3.5", 0, out);
    for (i = 0; i < WIDTH * HEIGHT; i++) {
        const image *from = i % WIDTH % 3 == 0 ? &cap.normal : i % WIDTH % 3 == 1 ? &cap.direct : &cap.albedo;

        assert_true(out[OUT_AO].data[i] == cap.depth.data[i]);
        for (c = 0; c < 3; c++) assert_true(out[OUT_NEAR].data[3 * i + c] == from->data[3 * i + c]);
    }
    free_images(out);
}

/* Device depth and inverse projection give the point, row 0 on top; every number of the block is in its place. */
static void uniforms_are_those_of_the_frame(const char *block, const char *description)
{
    char         text[2048];
    const double x0 = (double)cap.projection[0], y0 = (double)cap.projection[5];
    image        out[OUTS];
    int          i, k;

    snprintf(text, sizeof text, HEAD
             "layout(binding = 0) uniform texture2D u_depth; layout(binding = 1) uniform sampler u_nearest;\n"
             "layout(binding = 2, r32f) writeonly uniform image2D u_ao;\n"
             "layout(binding = 3, rgba32f) writeonly uniform image2D u_near;\nlayout(%s) uniform block " MEMBERS " u;\n"
             BEGIN "vec2 uv = (vec2(p) + 0.5) * u.texel;\n"
             "vec2 to = p.y == 1 ? vec2(-7.0, 0.0) : vec2(0.0);\n"
             "float d = textureLod(sampler2D(u_depth, u_nearest), uv + to, 0.0).r;\n"
             "vec4 q = u.inverse_projection * vec4(2.0 * uv - 1.0, d, 1.0);\n"
             "imageStore(u_near, p, vec4(q.xyz / q.w, 0.0));\n"
             "imageStore(u_ao, p, vec4(p.x < 16 ? u.view[p.x / 4][p.x %% 4]\n"
             "    : p.x < 32 ? u.projection[p.x / 4 - 4][p.x %% 4]\n"
             "    : p.x == 32 ? float(u.frame) : p.x == 33 ? float(u.size.x) : float(u.size.y))); }\n",
             block);
    compile("block", text);
    run_external(description, 3, out);
    for (i = 0; i < WIDTH * HEIGHT; i++) {
        const int    x = i % WIDTH, y = i / WIDTH;
        const double z = (double)cap.depth.data[y == 1 ? i - x : i]; /* row 1 reads beyond the left edge: clamped */
        const double want[3] = {(2.0 * (x + 0.5) / WIDTH - 1.0) * z / x0, (2.0 * (y + 0.5) / HEIGHT - 1.0) * z / y0,
                                -z};

        for (k = 0; k < 3; k++) assert_true(near_to((double)out[OUT_NEAR].data[3 * i + k], want[k], 1e-3));
    }
    for (i = 0; i < 16; i++) {
        assert_true(out[OUT_AO].data[i] == cap.view[i]);
        if (i != 10 && i != 14) assert_true(out[OUT_AO].data[16 + i] == cap.projection[i]); /* z has another clip */
    }
    assert_true(out[OUT_AO].data[32] == 3.0f && out[OUT_AO].data[33] == WIDTH && out[OUT_AO].data[34] == HEIGHT);
    free_images(out);
}

static void uniforms_in_a_block_or_pushed(void **state)
{
    (void)state;
    uniforms_are_those_of_the_frame(
        "std140, binding = 4", "spv=%s/block.spv,depth=0,ao=2,near=3,uniforms=4,depth_format=device");
    uniforms_are_those_of_the_frame(
        "push_constant", "depth_format=reversed,spv=%s/block.spv,depth=0,ao=2,near=3,uniforms=push");
}

/* Passes of a config as they are emitted, their block made of ours, give what the config gives. */
static void our_own_march_as_an_external(void **state)
{
    static const char block[] = "layout(std140, set = 0, binding = 0) uniform Mine " MEMBERS " mine;\n"
        "#define HBIL_PIXEL_TO_RAY (mine.inverse_projection[0][0] * vec4(2.0 * mine.texel.x, 0.0, -1.0, 0.0) \\\n"
        "    + mine.inverse_projection[1][1] * vec4(0.0, 2.0 * mine.texel.y, 0.0, -1.0))\n"
        "#define HBIL_SIZE mine.size\n#define HBIL_VIEW_Z -1.0\n#define HBIL_FRAME_INDEX mine.frame\n";
    static char text[HBIL_GLSL_MAX], whole[HBIL_GLSL_MAX + sizeof block];
    char        description[1024] = "name=ours";
    image       own[OUTS], out[OUTS];
    hbil_config config;
    lit         l;
    uint32_t    p, b;
    int         k;

    (void)state;
    if (!config_make(&s, "outputs=ao+near slices=2 steps=4", 0, &cap, &config, s.error, sizeof s.error)
        || !lit_open(&l, device, &s, &config, &sub, s.error, sizeof s.error)
        || !lit_images(&l, 5, own, s.error, sizeof s.error)) fail_msg("%s", s.error);
    for (p = 0; p < l.plan.pass_count; p++) {
        char *at = description + strlen(description), *begin, *end;

        assert_int_equal(hbil_emit_glsl(&l.plan, (int32_t)p, text, sizeof text, NULL), HBIL_OK);
        begin = strstr(text, "layout(set = 0, binding = 0, std140)");
        end = begin ? strstr(begin, "};") : NULL;
        assert_non_null(end);
        snprintf(whole, sizeof whole, "%.*s%s%s", (int)(begin - text), text, block, end + 2);
        at += sprintf(at, ",spv=%s,uniforms=0", compile(l.plan.passes[p].name, whole));
        for (b = 0; b < l.plan.passes[p].binding_count; b++)
            at += sprintf(at, ",%s=%d", l.plan.textures[l.plan.passes[p].bindings[b].texture].name,
                          l.plan.passes[p].bindings[b].slot);
    }
    assert_int_equal(l.plan.pass_count, 2);
    lit_close(&l);
    run_external(description, 5, out);
    for (k = 0; k < WIDTH * HEIGHT; k++) {
        assert_true(near_to((double)out[OUT_AO].data[k], (double)own[OUT_AO].data[k], 1e-4));
        assert_true(near_to((double)out[OUT_NEAR].data[3 * k], (double)own[OUT_NEAR].data[3 * k], 1e-4));
    }
    free_images(out);
    free_images(own);
}

/* ---- what it is worth -------------------------------------------------------------------------------------------- */

static const char flat[] = HEAD "layout(binding = 0, r32f) writeonly uniform image2D u_ao;\n"
    "void main() { imageStore(u_ao, ivec2(gl_GlobalInvocationID.xy), vec4(0.25)); }\n";

/* Calls the entry point, and what the compiler notes about it, "mine" instead of "main". */
static void rename_entry(const char *path)
{
    unsigned char bytes[4096];
    FILE         *f = fopen(path, "r+b");
    size_t        size, i;

    assert_non_null(f);
    size = fread(bytes, 1, sizeof bytes, f);
    for (i = 0; i + 4 <= size; i += 4)
        if (memcmp(bytes + i, "main", 4) == 0) memcpy(bytes + i, "mine", 4);
    rewind(f);
    assert_int_equal(fwrite(bytes, 1, size, f), size);
    fclose(f);
}

/* Errors of a constant, by hand; costs where loops are counted, and none where they are not. */
static void errors_and_costs(void **state)
{
    static const char loop[] = HEAD "layout(binding = 0, r32f) writeonly uniform image2D u_ao;\n"
        "layout(binding = 1) uniform sampler2D u_depth;\nvoid main() { float a = 0.0;\n"
        "for (int i = 0; i < 4; ++i) a += texelFetch(u_depth, ivec2(i), 0).r;\n"
        "imageStore(u_ao, ivec2(0), vec4(a)); }\n";
    externals x;
    truth     t;
    lit       l;
    measured  m;
    price     cost;
    double    sum = 0.0;
    int       i, count = 0;

    (void)state;
    rename_entry(compile("flat", flat));
    assert_int_equal(open_text(&x, "spv=%s/flat.spv,ao=0,entry=mine"), TRADE_DONE);
    assert_string_equal(x.list[0].name, "external:flat");
    assert_int_equal(truth_make(&s, &sub, 0, &t), TRADE_DONE);
    assert_true(lit_open_external(&l, device, &s, &x.list[0], &sub, s.error, sizeof s.error));
    if (measure_all(&s, &l, &t, NULL, &m) != TRADE_DONE) fail_msg("%s", s.error);
    for (i = 0; i < WIDTH * HEIGHT; i++)
        if (t.model_mask[i]) {
            sum += pow(0.25 - (double)cap.truth_ao.data[i], 2.0);
            count++;
        }
    assert_true(near_to(m.out[OUT_AO].rmse_model, sqrt(sum / count), 1e-6));
    assert_true(m.out[OUT_AO].rmse_field > 0.0 && isnan(m.out[OUT_AO].rmse_sampling) && !m.out[OUT_NEAR].present);
    assert_true(m.out[OUT_AO].flicker < 1e-12);
    assert_true(m.time.median > 0.0);
    assert_true(m.cost.fetches == 0.0 && m.cost.bytes_written == 4.0);
    lit_close(&l);
    externals_free(&x);
    compile("loop", loop);
    assert_int_equal(open_text(&x, "spv=%s/loop.spv,ao=0,depth=1"), TRADE_DONE);
    assert_true(lit_open_external(&l, device, &s, &x.list[0], &sub, s.error, sizeof s.error));
    assert_int_equal(measure_cost(&s, &l, &cost), TRADE_DONE);
    assert_true(isnan(cost.fetches) && isnan(cost.registers)); /* its counter is no SSA value */
    lit_close(&l);
    externals_free(&x);
    truth_free(&t);
}

static uint64_t hash_of(const char *text)
{
    externals x;
    uint64_t  hash;

    if (open_text(&x, text) != TRADE_DONE) fail_msg("%s: %s", text, s.error);
    hash = x.list[0].plan.hash;
    externals_free(&x);
    return hash;
}

static void hashes(void **state)
{
    char     other[sizeof flat];
    uint64_t hash;

    (void)state;
    compile("flat", flat);
    hash = hash_of("spv=%s/flat.spv,ao=0");
    compile("copy", flat);
    assert_true(hash == hash_of("spv=%s/copy.spv,ao=0.0,name=flat")); /* where it lies does not count */
    assert_true(hash != hash_of("spv=%s/flat.spv,ao=0,name=other"));
    strcpy(other, flat);
    memcpy(strstr(other, "0.25"), "0.35", 4);
    compile("flat", other);
    assert_true(hash != hash_of("spv=%s/flat.spv,ao=0"));
}

/* ---- what does not fit ------------------------------------------------------------------------------------------- */

#define AO    "layout(binding = 1, r32f) uniform image2D u_ao;\n"
#define WRITE "void main() { imageStore(u_ao, ivec2(0), "

static void faults(void **state)
{
    static const struct { const char *name, *text; } shaders[] = {
        {"good", HEAD AO "layout(binding = 0) uniform sampler2D u_depth;\n"
                 WRITE "texelFetch(u_depth, ivec2(0), 0)); }"},
        {"uint", HEAD AO "layout(binding = 0) uniform usampler2D u_depth;\n"
                 WRITE "vec4(texelFetch(u_depth, ivec2(0), 0))); }"},
        {"half", HEAD "layout(binding = 1, rgba16f) uniform image2D u_ao;\n" WRITE "vec4(1)); }"},
        {"any", HEAD "layout(binding = 1) writeonly uniform image2D u_ao;\n" WRITE "vec4(1)); }"},
        {"array", HEAD "layout(binding = 1, r32f) uniform image2DArray u_ao;\n"
                  "void main() { imageStore(u_ao, ivec3(0), vec4(1)); }"},
        {"buffer", HEAD AO "layout(binding = 0) buffer B { float x; } b;\n" WRITE "vec4(b.x)); }"},
        {"pushed", HEAD AO "layout(push_constant) uniform B { float x; } b;\n" WRITE "vec4(b.x)); }"},
        {"long", HEAD AO "layout(binding = 0) uniform B { vec4 x[15]; } b;\n" WRITE "b.x[14]); }"},
        {"deep", "#version 450\nlayout(local_size_x = 4, local_size_z = 4) in;\n" AO WRITE "vec4(1)); }"},
    };
    static const struct { const char *text, *says; int code; } bad[] = {
        {"depth=0", "before any spv=", TRADE_USAGE},
        {"entry=main,spv=%s/good.spv", "before any spv=", TRADE_USAGE},
        {"name=x", "add spv=FILE", TRADE_USAGE},
        {"spv", "KEY=VALUE", TRADE_USAGE},
        {"spv=%s/nowhere.spv,ao=1", "cannot be read", TRADE_FILES},
        {"spv=%s/text.spv,ao=1", "no SPIR-V", TRADE_FILES},
        {"spv=%s/torn.spv,ao=1", "not valid", TRADE_FILES},
        {"spv=%s/good.spv,depth=0", "no key names u_ao at set 0, binding 1", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=1,normal=2", "normal: main uses nothing there", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=x", "must be a binding", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=push", "must be a binding", TRADE_USAGE},
        {"spv=%s/good.spv,depth=1,ao=0", "ao is read, but is no input", TRADE_USAGE},
        {"spv=%s/good.spv,dept=0,ao=1", "dept is read, but is no input (depth, normal", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,oa=1", "oa is written, but no other pass reads it", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,near=1", "of another format. Declare it rgba32f", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,uniforms=1", "is an image", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=1,entry=other", "no such entry point", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=1,name=a b", "letters", TRADE_USAGE},
        {"spv=%s/good.spv,depth=0,ao=1,depth_format=z", "must be linear", TRADE_USAGE},
        {"spv=%s/half.spv,ao=1", "Declare it r32f or rgba32f", TRADE_USAGE},
        {"spv=%s/any.spv,ao=1", "capability 56", TRADE_USAGE},
        {"spv=%s/array.spv,ao=1", "no plain 2D image", TRADE_USAGE},
        {"spv=%s/uint.spv,depth=0,ao=1", "Declare it of float", TRADE_USAGE},
        {"spv=%s/buffer.spv,depth=0,ao=1", "neither an image nor a uniform block", TRADE_USAGE},
        {"spv=%s/pushed.spv,ao=1", "uniforms=push", TRADE_USAGE},
        {"spv=%s/long.spv,uniforms=0,ao=1", "has 240 bytes, what is handed over 224", TRADE_USAGE},
        {"spv=%s/long.spv,depth=0,ao=1", "is a uniform block", TRADE_USAGE},
        {"spv=%s/deep.spv,ao=1", "4 x 1 x 4", TRADE_USAGE},
    };
    externals x;
    size_t    i;
    char      path[128];
    FILE     *f;

    (void)state;
    for (i = 0; i < sizeof shaders / sizeof *shaders; i++) compile(shaders[i].name, shaders[i].text);
    snprintf(path, sizeof path, "%s/text.spv", folder);
    assert_true(text_write(path, "#version 450, which is no SPIR-V", s.error, sizeof s.error));
    f = fopen(compile("torn", flat), "r+b");
    assert_non_null(f);
    fseek(f, 40, SEEK_SET);
    fputs("nonsense", f);
    fclose(f);
    for (i = 0; i < sizeof bad / sizeof *bad; i++) {
        const int code = open_text(&x, bad[i].text);

        if (code != bad[i].code || !strstr(s.error, bad[i].says)) fail_msg("%s: %d, %s", bad[i].text, code, s.error);
        externals_free(&x);
    }
    s.backend = "gl";
    assert_int_equal(open_text(&x, "spv=%s/good.spv,depth=0,ao=1"), TRADE_USAGE);
    assert_non_null(strstr(s.error, "--backend vulkan"));
    s.backend = "vulkan";
    externals_free(&x);
}

static void too_big_a_group(void **state)
{
    externals x;
    image     out[OUTS];
    lit       l;

    (void)state;
    compile("big", "#version 450\nlayout(local_size_x = 1024, local_size_y = 64) in;\n" AO WRITE "vec4(1)); }");
    assert_int_equal(open_text(&x, "spv=%s/big.spv,ao=1"), TRADE_DONE);
    assert_true(lit_open_external(&l, device, &s, &x.list[0], &sub, s.error, sizeof s.error));
    assert_false(lit_images(&l, 0, out, s.error, sizeof s.error));
    assert_non_null(strstr(s.error, "groups of 1024x64, the device allows"));
    lit_close(&l);
    externals_free(&x);
}

/* The layers watched all of it. */
static void validation_is_silent(void **state)
{
    (void)state;
    assert_int_equal(runner_messages(device), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(inputs_are_those_of_the_frame), cmocka_unit_test(uniforms_in_a_block_or_pushed),
        cmocka_unit_test(our_own_march_as_an_external),  cmocka_unit_test(errors_and_costs),
        cmocka_unit_test(hashes),                        cmocka_unit_test(faults),
        cmocka_unit_test(too_big_a_group),               cmocka_unit_test(validation_is_silent),
    };
    char command[96];
    int  failed;

    strcpy(folder, "/tmp/test_external.XXXXXX");
    settings_default(&s);
    s.scenes = "fence";
    s.quiet = 1;
    s.seconds = 0.2;
    s.cache = folder;
    device = runner_open(s.backend, 1, s.error, sizeof s.error);
    if (!device) return fprintf(stderr, "skipped: %s\n", s.error), 77;
    if (!mkdtemp(folder) || settings_finish(&s) != TRADE_DONE || !hbil_glslang_init()
        || !capture_scene(&cap, "fence", WIDTH, HEIGHT, 16, NULL, s.error, sizeof s.error)) return 1;
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    capture_free(&cap);
    hbil_glslang_shutdown();
    runner_close(device);
    settings_free(&s);
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    if (system(command) != 0) return 1;
    return failed;
}
