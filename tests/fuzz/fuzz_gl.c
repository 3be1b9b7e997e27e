/* fuzz_gl.c - damaged plans on hbil_gl.h, over a GL that answers to all: texture names are bytes of the heap, and what its calls are
 * given is read. */
#include "damage.h"
#include "../test.h"

#define HBIL_GL_IMPLEMENTATION
#include "../../backends/hbil_gl.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wpedantic" /* functions as data pointers, as get_proc has them; return of a void expression */
#endif

static const char *const configs[] = { "target=gl outputs=ao", "target=gl", "target=gl march=sweep slices=4",
    "target=gl temporal=yes bounces=recursive reproject=scatter downscale=2", "target=gl stage=fragment temporal=yes outputs=ao+near",
    "target=gles stage=fragment outputs=ao", "target=gles environment=probes outputs=irradiance", "target=gl outputs=far environment=hook" };
static int      es;
static unsigned bound[8], next_name = 100, live; /* live: objects that were made and not deleted */
static uint32_t fail_at, calls;
static volatile unsigned seen;

/* 1, but for the call that fails. */
static int answer(void) { return ++calls != fail_at; }
static uintptr_t result(const char *name)
{
    if (strcmp(name, "createProgram") == 0 || strcmp(name, "createShader") == 0) return ++live, ++next_name;
    if (strcmp(name, "checkFramebufferStatus") == 0) return answer() ? HBIL_GL__FRAMEBUFFER_COMPLETE : 0;
    if (strcmp(name, "getString") == 0) return (uintptr_t)(es ? "OpenGL ES 3.1 fake" : "4.3 fake");
    return strncmp(name, "is", 2) == 0; /* isTexture, isProgram... */
}

/* Every function of the list, as if nothing happened; those below do more. */
#define FAKE(when, type, member, name, args) static type HBIL_GL_CALL fake_##member args { return (type)result(#member); }
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#endif
HBIL_GL__FUNCTIONS(FAKE)
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

static int index_of(unsigned target)
{
    int i;
    for (i = 1; i < HBIL_GL__DIMS && hbil_gl__targets[i].target != target; ++i) { }
    FUZZ_REQUIRE(i < HBIL_GL__DIMS);
    return i;
}

static void HBIL_GL_CALL bind_texture(unsigned target, unsigned name) { bound[index_of(target)] = name; }

static void HBIL_GL_CALL get_integer(unsigned name, int *value)
{
    int i;
    *value = name == HBIL_GL__MAX_COMBINED_TEXTURE_IMAGE_UNITS ? 96 : name == HBIL_GL__MAX_IMAGE_UNITS ? 8
           : name == HBIL_GL__MAX_UNIFORM_BUFFER_BINDINGS ? 36 : 0;
    if (name == HBIL_GL__VIEWPORT) value[1] = value[2] = value[3] = 0;
    if (name == HBIL_GL__POLYGON_MODE) value[1] = 0;
    for (i = 1; i < HBIL_GL__DIMS; ++i)
        if (hbil_gl__targets[i].binding == name) *value = (int)bound[i];
}
static void HBIL_GL_CALL get_integer_i(unsigned name, unsigned index, int *value) { *value = 0; }
static void HBIL_GL_CALL get_integer64_i(unsigned name, unsigned index, int64_t *value) { *value = 0; }
static void HBIL_GL_CALL get_integer64(unsigned name, int64_t *value) { *value = 0; }
static void HBIL_GL_CALL get_boolean(unsigned name, unsigned char *value) { memset(value, 1, 4); }
static void HBIL_GL_CALL get_boolean_i(unsigned name, unsigned index, unsigned char *value) { memset(value, 1, 4); }
static void HBIL_GL_CALL get_status(unsigned object, unsigned name, int *value) { *value = answer(); }
static void HBIL_GL_CALL get_log(unsigned object, int size, int *length, char *log)
{
    FUZZ_REQUIRE(size > 0);
    memset(log, 'x', (size_t)size - 1);
    log[size - 1] = 0;
}
static void HBIL_GL_CALL get_level(unsigned target, int level, unsigned name, int *value)
{
    *value = name == HBIL_GL__TEXTURE_WIDTH || name == HBIL_GL__TEXTURE_HEIGHT ? 64 : name == HBIL_GL__TEXTURE_DEPTH ? 512
           : name == HBIL_GL__TEXTURE_SAMPLES ? 32 : name == HBIL_GL__TEXTURE_RED_TYPE ? 0 : HBIL_GL__R32F;
    if (!answer()) *value = 0;
}
static void HBIL_GL_CALL get_texture(unsigned target, unsigned name, int *value) { *value = 1; }
static void HBIL_GL_CALL make(int count, unsigned *names)
{
    while (count-- > 0) names[count] = ++next_name, ++live;
}
static void HBIL_GL_CALL drop(int count, const unsigned *names)
{
    while (count-- > 0) live -= names[count] != 0;
}
static void HBIL_GL_CALL drop_one(unsigned name) { live -= name != 0; }
static void HBIL_GL_CALL draw_buffers(int count, const unsigned *buffers)
{
    FUZZ_REQUIRE(count <= HBIL_GL__TARGETS);
    while (count-- > 0) seen += buffers[count];
}
static void HBIL_GL_CALL shader_source(unsigned shader, int count, const char *const *text, const int *lengths) { seen += (unsigned)strlen(*text); }
static void HBIL_GL_CALL buffer_data(unsigned target, ptrdiff_t size, const void *data, unsigned usage)
{
    FUZZ_REQUIRE(size > 0);
    while (size--) seen += ((const unsigned char *)data)[size];
}
static void HBIL_GL_CALL active_texture(unsigned unit) { FUZZ_REQUIRE(unit - HBIL_GL__TEXTURE0 < HBIL_GL_MAX_UNITS || unit == 0); }
static int HBIL_GL_CALL get_location(unsigned program, const char *name) { return (int)strlen(name); }
static void HBIL_GL_CALL dispatch(unsigned x, unsigned y, unsigned z) { FUZZ_REQUIRE(x > 0 && y > 0 && z > 0 && x <= 65535 && y <= 65535); }

static void *get_proc(void *user, const char *name)
{
    static const struct { const char *name; void *address; } better[] = {
        { "glBindTexture", (void *)bind_texture }, { "glGetIntegerv", (void *)get_integer }, { "glGetIntegeri_v", (void *)get_integer_i },
        { "glGetInteger64i_v", (void *)get_integer64_i }, { "glGetInteger64v", (void *)get_integer64 }, { "glGetBooleanv", (void *)get_boolean },
        { "glGetBooleani_v", (void *)get_boolean_i }, { "glGetShaderiv", (void *)get_status }, { "glGetProgramiv", (void *)get_status },
        { "glGetShaderInfoLog", (void *)get_log }, { "glGetProgramInfoLog", (void *)get_log }, { "glGetTexLevelParameteriv", (void *)get_level },
        { "glGetTexParameteriv", (void *)get_texture }, { "glGenTextures", (void *)make }, { "glGenBuffers", (void *)make },
        { "glGenSamplers", (void *)make }, { "glGenFramebuffers", (void *)make }, { "glGenVertexArrays", (void *)make },
        { "glDeleteTextures", (void *)drop }, { "glDeleteBuffers", (void *)drop }, { "glDeleteSamplers", (void *)drop },
        { "glDeleteProgram", (void *)drop_one }, { "glDeleteShader", (void *)drop_one }, { "glDeleteFramebuffers", (void *)drop }, { "glDeleteVertexArrays", (void *)drop }, { "glDrawBuffers", (void *)draw_buffers },
        { "glShaderSource", (void *)shader_source }, { "glBufferData", (void *)buffer_data }, { "glActiveTexture", (void *)active_texture },
        { "glGetUniformLocation", (void *)get_location }, { "glDispatchCompute", (void *)dispatch } };
    size_t i;
    for (i = 0; i < sizeof better / sizeof *better; ++i)
        if (strcmp(better[i].name, name) == 0) return better[i].address;
#define ROW(when, type, member, text, args) if (strcmp(name, text) == 0) return (void *)fake_##member;
    HBIL_GL__FUNCTIONS(ROW)
    return NULL;
}

static void check(const hbil_gl *ctx, hbil_gl_result r)
{
    FUZZ_REQUIRE(r == HBIL_GL_OK || (ctx->message[0] && memchr(ctx->message, 0, sizeof ctx->message)));
}

static void run(const hbil_gl_info *info)
{
    static hbil_gl ctx;
    unsigned textures[HBIL_MAX_TEXTURES];
    hbil_frame frame;
    hbil_gl_result r = hbil_gl_init(info, &ctx);
    uint32_t i;
    check(&ctx, r);
    FUZZ_REQUIRE(r == HBIL_GL_OK || live == 0);
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) textures[i] = i + 1;
    if (r == HBIL_GL_OK) {
        FUZZ_REQUIRE(hbil_plan_check(info->plan, NULL) == HBIL_OK);
        r = hbil_gl_resize(&ctx, 64, 36, textures);
        check(&ctx, r);
    }
    frame = test_frame(&info->plan->config, 64, 36);
    for (i = 0; r == HBIL_GL_OK && i < 3; ++i) {
        r = hbil_gl_run(&ctx, &frame);
        check(&ctx, r);
    }
    hbil_gl_shutdown(&ctx);
    hbil_gl_shutdown(&ctx);
    FUZZ_REQUIRE(live == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static char scratch[HBIL_GLSL_MAX];
    static hbil_plan plan;
    hbil_gl_info info;
    fuzz_reader r = { data, size };
    fail_at = fuzz_take(&r, 1);
    calls = live = 0;
    damaged_plan(&r, configs, sizeof configs / sizeof *configs, &plan);
    es = plan.config.target == HBIL_TARGET_GLES;
    memset(&info, 0, sizeof info);
    info.plan = &plan;
    info.get_proc = get_proc;
    info.scratch = scratch;
    info.scratch_size = sizeof scratch;
    info.hook = "vec3 hbil_far_hook(vec3 a, vec3 b, float c) { return a; }";
    info.timings = size & 1 && !es;
    run(&info);
    return 0;
}
