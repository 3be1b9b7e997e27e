/* test_gl_state.c - hbil_gl.h is a polite guest: it puts all GL state back, leaves no error and takes none, and says what is
 * wrong instead of failing later. Exit code 77 (skipped) where no OpenGL context can be had. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include <GL/glcorearb.h>

#include "../../examples/frame/runner_internal.h"
#include "../../backends/hbil_gl.h"

enum { WIDTH = 21, HEIGHT = 13, UNITS = 16, IMAGES = 8, BLOCKS = 4 };
#define ALL_OUTPUTS "target=gl outputs=ao+near+bent+composite noise=none"
/* Between them, every kind of texture. */
#define CUBE_PLAN   "target=gl outputs=ao+sh+far+composite environment=cube multisample=yes sample=2"
#define PROBE_PLAN  "target=gl outputs=ao+far environment=probes"
#define DRAWN_PLAN  "target=gl stage=fragment outputs=ao+near+sh noise=none"

#define GL_FUNCTIONS(X)                                  \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture)             \
    X(PFNGLATTACHSHADERPROC, AttachShader)               \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                   \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)         \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)         \
    X(PFNGLCOLORMASKPROC, ColorMask)                     \
    X(PFNGLCOLORMASKIPROC, ColorMaski)                   \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)   \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)   \
    X(PFNGLDISABLEIPROC, Disablei)                       \
    X(PFNGLENABLEIPROC, Enablei)                         \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D) \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)         \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)         \
    X(PFNGLGETBOOLEANI_VPROC, GetBooleani_v)             \
    X(PFNGLISENABLEDPROC, IsEnabled)                     \
    X(PFNGLISENABLEDIPROC, IsEnabledi)                   \
    X(PFNGLPOLYGONMODEPROC, PolygonMode)                 \
    X(PFNGLSCISSORPROC, Scissor)                         \
    X(PFNGLVIEWPORTPROC, Viewport)                       \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase)           \
    X(PFNGLBINDBUFFERRANGEPROC, BindBufferRange)         \
    X(PFNGLBINDIMAGETEXTUREPROC, BindImageTexture)       \
    X(PFNGLBINDSAMPLERPROC, BindSampler)                 \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                 \
    X(PFNGLBUFFERDATAPROC, BufferData)                   \
    X(PFNGLCOMPILESHADERPROC, CompileShader)             \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)             \
    X(PFNGLCREATESHADERPROC, CreateShader)               \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)             \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)             \
    X(PFNGLDELETESAMPLERSPROC, DeleteSamplers)           \
    X(PFNGLDELETESHADERPROC, DeleteShader)               \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)           \
    X(PFNGLDISABLEPROC, Disable)                         \
    X(PFNGLENABLEPROC, Enable)                           \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                   \
    X(PFNGLGENSAMPLERSPROC, GenSamplers)                 \
    X(PFNGLGENTEXTURESPROC, GenTextures)                 \
    X(PFNGLGETERRORPROC, GetError)                       \
    X(PFNGLGETINTEGERI_VPROC, GetIntegeri_v)             \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                 \
    X(PFNGLGETTEXIMAGEPROC, GetTexImage)                 \
    X(PFNGLISBUFFERPROC, IsBuffer)                       \
    X(PFNGLISPROGRAMPROC, IsProgram)                     \
    X(PFNGLISSAMPLERPROC, IsSampler)                     \
    X(PFNGLISTEXTUREPROC, IsTexture)                     \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                 \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)             \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)               \
    X(PFNGLTEXIMAGE2DPROC, TexImage2D)                   \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)             \
    X(PFNGLTEXSTORAGE2DPROC, TexStorage2D)               \
    X(PFNGLTEXSTORAGE2DMULTISAMPLEPROC, TexStorage2DMultisample) \
    X(PFNGLTEXSTORAGE3DPROC, TexStorage3D)               \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)             \
    X(PFNGLUSEPROGRAMPROC, UseProgram)
#define GL_MEMBER(type, name) type name;
static struct { GL_FUNCTIONS(GL_MEMBER) } gl;

void *runner_gl_proc(void *user, const char *name); /* in examples/frame/runner_gl.c */

static void *device;

/* What every test starts from: a plan, a frame, and a texture for each INPUT and OUTPUT. */
static hbil_plan  plan;
static hbil_frame frame;
static unsigned   textures[HBIL_MAX_TEXTURES];
static char       scratch[HBIL_GLSL_MAX];
static hbil_gl    ctx;
static const char *hook;

/* ---------------------------------------------------------------------------------------------------------- helpers */

static void load_functions(void)
{
#define GL_ROW(type, name) { "gl" #name, (char *)&gl.name },
    const struct { const char *name; char *pointer; } table[] = { GL_FUNCTIONS(GL_ROW) };
    size_t i;
    for (i = 0; i < sizeof table / sizeof *table; ++i) {
        void *address = runner_gl_proc(device, table[i].name);
        memcpy(table[i].pointer, &address, sizeof address);
    }
}

static unsigned make_texture(GLenum format, int width, int height)
{
    unsigned name = 0;
    gl.GenTextures(1, &name);
    gl.BindTexture(GL_TEXTURE_2D, name);
    gl.TexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    return name;
}

/* Of the target that a plan's texture wants. */
static unsigned make_shaped(const hbil_texture *t, GLenum format)
{
    unsigned name = 0;
    if (t->dim == HBIL_DIM_2D) return make_texture(format, WIDTH, HEIGHT);
    gl.GenTextures(1, &name);
    if (t->dim == HBIL_DIM_2D_MULTISAMPLE) {
        gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, name);
        gl.TexStorage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, 4, format, WIDTH, HEIGHT, GL_TRUE);
        gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, 0);
    } else if (t->dim == HBIL_DIM_CUBE) {
        gl.BindTexture(GL_TEXTURE_CUBE_MAP, name);
        gl.TexStorage2D(GL_TEXTURE_CUBE_MAP, 1, format, 4, 4);
        gl.BindTexture(GL_TEXTURE_CUBE_MAP, 0);
    } else {
        GLenum target = t->dim == HBIL_DIM_3D ? GL_TEXTURE_3D : GL_TEXTURE_2D_ARRAY;
        gl.BindTexture(target, name);
        if (t->dim == HBIL_DIM_3D) gl.TexStorage3D(target, 1, format, 2, 2, 2 * 9);
        else gl.TexStorage3D(target, 1, format, WIDTH, HEIGHT, t->layers);
        gl.BindTexture(target, 0);
    }
    return name;
}

/* depth(x) = distance + slope * |x - middle|: a valley */
static void fill_depth(float distance, float slope)
{
    float depth[WIDTH * HEIGHT];
    int i;
    for (i = 0; i < WIDTH * HEIGHT; ++i) {
        int x = i % WIDTH - WIDTH / 2;
        depth[i] = distance - slope * (float)(x < 0 ? -x : x);
    }
    gl.BindTexture(GL_TEXTURE_2D, textures[hbil_plan_texture(&plan, "depth")]);
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, WIDTH, HEIGHT, GL_RED, GL_FLOAT, depth);
    gl.BindTexture(GL_TEXTURE_2D, 0);
}

static void read_ao(float ao[WIDTH * HEIGHT])
{
    gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    gl.BindTexture(GL_TEXTURE_2D, textures[hbil_plan_texture(&plan, "ao")]);
    gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, ao);
    gl.BindTexture(GL_TEXTURE_2D, 0);
}

static void build_plan(const char *text, hbil_plan *out)
{
    hbil_config config;
    memset(&config, 0, sizeof config);
    assert_int_equal(hbil_config_parse(&config, text, strlen(text), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&config, out, NULL), HBIL_OK);
}

/* A loader that lies about one function: function NULL says that there is no such function. */
typedef struct lie {
    const char *name;
    void (*function)(void);
} lie;

#define FUNCTION(f) ((void (*)(void))(f))

static void *lying_proc(void *user, const char *name)
{
    const lie *l = (const lie *)user;
    void *address = NULL;
    if (!l->name || strcmp(name, l->name) != 0) return runner_gl_proc(device, name);
    memcpy(&address, &l->function, sizeof address);
    return address;
}

static hbil_gl_result init_with(const hbil_plan *p, lie l, size_t scratch_size)
{
    hbil_gl_info info;
    memset(&info, 0, sizeof info);
    info.plan = p;
    info.get_proc = lying_proc;
    info.user = &l;
    info.scratch = scratch;
    info.scratch_size = scratch_size;
    info.hook = hook;
    info.timings = 1;
    return hbil_gl_init(&info, &ctx);
}

static hbil_gl_result init(void)
{
    lie none = { NULL, NULL };
    return init_with(&plan, none, sizeof scratch);
}

static void assert_message(const char *part)
{
    if (!strstr(ctx.message, part)) fail_msg("message \"%s\" does not name \"%s\"", ctx.message, part);
}

static void set_plan(const char *config)
{
    float blue[3 * WIDTH * HEIGHT]; /* a normal towards the camera, and a colour */
    uint32_t i;
    for (i = 0; i < 3 * WIDTH * HEIGHT; ++i) blue[i] = i % 3 == 2 ? 1.0f : 0.0f;
    build_plan(config, &plan);
    memset(textures, 0, sizeof textures);
    for (i = 0; i < plan.texture_count; ++i) {
        const hbil_texture *t = &plan.textures[i];
        if (t->life == HBIL_LIFE_OUTPUT) textures[i] = make_shaped(t, hbil_gl_format((hbil_format)t->format));
        if (t->life != HBIL_LIFE_INPUT) continue;
        textures[i] = make_shaped(t, strcmp(t->name, "depth") == 0 ? GL_R32F : GL_RGBA32F);
        if (t->dim != HBIL_DIM_2D) continue;
        gl.BindTexture(GL_TEXTURE_2D, textures[i]);
        gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, WIDTH, HEIGHT, GL_RGB, GL_FLOAT, blue);
        gl.BindTexture(GL_TEXTURE_2D, 0);
    }
    if (plan.config.multisample != HBIL_MULTISAMPLE_YES) fill_depth(4.0f, 0.1f);
    frame = test_frame(&plan.config, WIDTH, HEIGHT);
    memset(&ctx, 0, sizeof ctx);
}

static void drop_plan(void)
{
    hbil_gl_shutdown(&ctx);
    gl.DeleteTextures(HBIL_MAX_TEXTURES, textures);
    hook = NULL;
}

static int setup(void **state)
{
    (void)state;
    set_plan(ALL_OUTPUTS);
    return 0;
}

/* Every test ends without a GL error. */
static int teardown(void **state)
{
    (void)state;
    drop_plan();
    return (int)gl.GetError();
}

/* ------------------------------------------------------------------------------------------------------------ state */

/* A snapshot: what the header lists, on every unit whether used or not, and some state that nothing has reason to touch. */
typedef struct snapshot {
    int  count;
    struct { GLenum name; int index, value; } items[512];
} snapshot;

static void take_value(snapshot *s, GLenum name, int index, int value)
{
    assert_in_range(s->count, 0, 511);
    s->items[s->count].name = name;
    s->items[s->count].index = index;
    s->items[s->count++].value = value;
}

static void take(snapshot *s, GLenum name, int index, int indexed)
{
    int value = -1;
    if (indexed) gl.GetIntegeri_v(name, (GLuint)index, &value);
    else gl.GetIntegerv(name, &value);
    take_value(s, name, index, value);
}

static const GLenum switches[] = { GL_DEPTH_TEST, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_CULL_FACE, GL_RASTERIZER_DISCARD,
    GL_COLOR_LOGIC_OP, GL_CLIP_DISTANCE0, GL_CLIP_DISTANCE7, GL_DEPTH_CLAMP, GL_MULTISAMPLE, GL_PRIMITIVE_RESTART };
enum { SWITCHES = sizeof switches / sizeof *switches };

/* What decides how a triangle is drawn. */
static void take_drawing(snapshot *s)
{
    int i, values[4] = { 0 };
    GLboolean mask[4];
    for (i = 0; i < SWITCHES; ++i) take_value(s, switches[i], 0, gl.IsEnabled(switches[i]));
    for (i = 0; i < IMAGES; ++i) {
        take_value(s, GL_BLEND, i, gl.IsEnabledi(GL_BLEND, (GLuint)i));
        gl.GetBooleani_v(GL_COLOR_WRITEMASK, (GLuint)i, mask);
        take_value(s, GL_COLOR_WRITEMASK, i, mask[0] + 2 * mask[1] + 4 * mask[2] + 8 * mask[3]);
    }
    gl.GetIntegerv(GL_VIEWPORT, values);
    for (i = 0; i < 4; ++i) take_value(s, GL_VIEWPORT, i, values[i]);
    gl.GetIntegerv(GL_SCISSOR_BOX, values);
    for (i = 0; i < 4; ++i) take_value(s, GL_SCISSOR_BOX, i, values[i]);
    gl.GetIntegerv(GL_POLYGON_MODE, values);
    take_value(s, GL_POLYGON_MODE, 0, values[0]);
}

static void take_snapshot(snapshot *s)
{
    static const GLenum plain[] = {
        GL_CURRENT_PROGRAM, GL_ACTIVE_TEXTURE, GL_UNIFORM_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_BINDING,
        GL_DISPATCH_INDIRECT_BUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER_BINDING, GL_PIXEL_PACK_BUFFER_BINDING, GL_UNPACK_ALIGNMENT,
        GL_COPY_WRITE_BUFFER_BINDING, GL_PROGRAM_PIPELINE_BINDING, GL_VERTEX_ARRAY_BINDING, GL_DRAW_FRAMEBUFFER_BINDING,
        GL_READ_FRAMEBUFFER_BINDING,
        GL_TEXTURE_CUBE_MAP_SEAMLESS };
    static const GLenum images[] = { GL_IMAGE_BINDING_NAME, GL_IMAGE_BINDING_LEVEL, GL_IMAGE_BINDING_LAYERED,
                                    GL_IMAGE_BINDING_LAYER, GL_IMAGE_BINDING_ACCESS, GL_IMAGE_BINDING_FORMAT };
    static const GLenum blocks[] = { GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE };
    int active = 0, i, k;
    s->count = 0;
    for (i = 0; i < (int)(sizeof plain / sizeof *plain); ++i) take(s, plain[i], 0, 0);
    gl.GetIntegerv(GL_ACTIVE_TEXTURE, &active);
    for (i = 0; i < UNITS; ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + (GLenum)i);
        take(s, GL_TEXTURE_BINDING_2D, i, 0);
        take(s, GL_TEXTURE_BINDING_2D_ARRAY, i, 0);
        take(s, GL_TEXTURE_BINDING_2D_MULTISAMPLE, i, 0);
        take(s, GL_TEXTURE_BINDING_CUBE_MAP, i, 0);
        take(s, GL_TEXTURE_BINDING_3D, i, 0);
        take(s, GL_SAMPLER_BINDING, i, 0);
    }
    gl.ActiveTexture((GLenum)active);
    for (i = 0; i < IMAGES; ++i)
        for (k = 0; k < 6; ++k) take(s, images[k], i, 1);
    for (i = 0; i < BLOCKS; ++i)
        for (k = 0; k < 3; ++k) take(s, blocks[k], i, 1);
    take_drawing(s);
}

static void assert_same(const snapshot *before, const char *verb)
{
    snapshot after;
    int i;
    take_snapshot(&after);
    assert_int_equal(before->count, after.count);
    for (i = 0; i < after.count; ++i)
        if (before->items[i].value != after.items[i].value)
            fail_msg("%s: state 0x%04x of unit %d was %d, is %d", verb, before->items[i].name, before->items[i].index,
                     before->items[i].value, after.items[i].value);
}

/* Objects behind the odd values. */
typedef struct odd_objects {
    unsigned program, buffer, flat[UNITS], array, multisample, cube, volume, samplers[UNITS], framebuffer, vertex_array;
} odd_objects;

static unsigned make_program(void)
{
    static const char *const text = "#version 430\nlayout(local_size_x = 1) in;\nvoid main() {}\n";
    unsigned program = gl.CreateProgram(), shader = gl.CreateShader(GL_COMPUTE_SHADER);
    gl.ShaderSource(shader, 1, &text, NULL);
    gl.CompileShader(shader);
    gl.AttachShader(program, shader);
    gl.LinkProgram(program);
    gl.DeleteShader(shader);
    return program;
}

static void make_odd_objects(odd_objects *o)
{
    int i;
    o->program = make_program();
    gl.GenBuffers(1, &o->buffer);
    gl.BindBuffer(GL_UNIFORM_BUFFER, o->buffer);
    gl.BufferData(GL_UNIFORM_BUFFER, 65536, NULL, GL_STATIC_DRAW);
    gl.GenTextures(1, &o->array);
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, o->array);
    gl.TexStorage3D(GL_TEXTURE_2D_ARRAY, 3, GL_RGBA8, 8, 8, 6);
    gl.GenTextures(1, &o->multisample);
    gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, o->multisample);
    gl.TexStorage2DMultisample(GL_TEXTURE_2D_MULTISAMPLE, 4, GL_RGBA8, 8, 8, GL_TRUE);
    gl.GenTextures(1, &o->cube);
    gl.BindTexture(GL_TEXTURE_CUBE_MAP, o->cube);
    gl.TexStorage2D(GL_TEXTURE_CUBE_MAP, 1, GL_RGBA8, 8, 8);
    gl.GenTextures(1, &o->volume);
    gl.BindTexture(GL_TEXTURE_3D, o->volume);
    gl.TexStorage3D(GL_TEXTURE_3D, 1, GL_RGBA8, 8, 8, 8);
    gl.GenFramebuffers(1, &o->framebuffer);
    gl.GenVertexArrays(1, &o->vertex_array);
    gl.GenSamplers(UNITS, o->samplers);
    for (i = 0; i < UNITS; ++i) o->flat[i] = make_texture(GL_R32F, 4, 4);
    gl.BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, o->flat[0], 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
}

/* No two units alike, nothing at its default. whole: uniform buffers bound by glBindBufferBase instead of a range. */
static void set_odd_state(const odd_objects *o, int whole)
{
    GLuint i;
    for (i = 0; i < UNITS; ++i) {
        gl.ActiveTexture(GL_TEXTURE0 + i);
        gl.BindTexture(GL_TEXTURE_2D, o->flat[i]);
        gl.BindTexture(GL_TEXTURE_2D_ARRAY, o->array);
        gl.BindTexture(GL_TEXTURE_2D_MULTISAMPLE, o->multisample);
        gl.BindTexture(GL_TEXTURE_CUBE_MAP, o->cube);
        gl.BindTexture(GL_TEXTURE_3D, o->volume);
        gl.BindSampler(i, o->samplers[i]);
    }
    if (whole) gl.Enable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    gl.ActiveTexture(GL_TEXTURE0 + 2);
    for (i = 0; i < IMAGES; ++i)
        gl.BindImageTexture(i, o->array, 1 + (GLint)(i & 1), (i & 1) != 0, 5 - (GLint)(i & 3),
                            i & 2 ? GL_READ_WRITE : GL_READ_ONLY, i & 4 ? GL_RGBA8_SNORM : GL_RGBA8UI);
    for (i = 0; i < BLOCKS; ++i) {
        if (whole) gl.BindBufferBase(GL_UNIFORM_BUFFER, i, o->buffer);
        else gl.BindBufferRange(GL_UNIFORM_BUFFER, i, o->buffer, 1024 * (1 + (GLintptr)i), 512 + 256 * (GLsizeiptr)i);
    }
    gl.BindBuffer(GL_UNIFORM_BUFFER, whole ? 0 : o->buffer);
    gl.UseProgram(o->program);
    gl.BindFramebuffer(GL_FRAMEBUFFER, o->framebuffer);
    gl.BindVertexArray(o->vertex_array);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, o->buffer);
    gl.Viewport(3, 4, 5, 6);
    gl.Scissor(1, 2, 3, 4);
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_LINE);
    for (i = 0; i < SWITCHES; ++i) gl.Enable(switches[i]);
    for (i = 0; i < IMAGES; ++i) {
        if (i & 1) gl.Enablei(GL_BLEND, i);
        gl.ColorMaski(i, i & 1, i & 2, i & 4, i & 1);
    }
}

static void delete_odd_objects(odd_objects *o)
{
    GLuint i;
    for (i = 0; i < SWITCHES; ++i)
        if (switches[i] != GL_MULTISAMPLE) gl.Disable(switches[i]);
    for (i = 0; i < IMAGES; ++i) gl.Disablei(GL_BLEND, i);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.PolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl.BindVertexArray(0);
    gl.BindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    gl.DeleteFramebuffers(1, &o->framebuffer);
    gl.DeleteVertexArrays(1, &o->vertex_array);
    gl.UseProgram(0);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.DeleteProgram(o->program);
    gl.DeleteBuffers(1, &o->buffer);
    gl.DeleteTextures(UNITS, o->flat);
    gl.DeleteTextures(1, &o->array);
    gl.DeleteTextures(1, &o->multisample);
    gl.DeleteTextures(1, &o->cube);
    gl.DeleteTextures(1, &o->volume);
    gl.Disable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    gl.DeleteSamplers(UNITS, o->samplers);
}

static void use_every_verb(const snapshot *before)
{
    double ms[HBIL_MAX_PASSES] = { 0 };
    uint32_t i;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_same(before, "hbil_gl_init");
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_same(before, "hbil_gl_resize");
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    assert_same(before, "hbil_gl_run");
    assert_int_equal(hbil_gl_timings(&ctx, ms), HBIL_GL_OK);
    for (i = 0; i < plan.pass_count; ++i) assert_true(ms[i] > 0.0);
    hbil_gl_shutdown(&ctx);
    assert_same(before, "hbil_gl_shutdown");
}

static void every_verb_puts_all_state_back(void **state)
{
    static const char *const plans[] = { ALL_OUTPUTS, CUBE_PLAN, PROBE_PLAN, DRAWN_PLAN };
    int variant, messages = runner_gl.messages(device);
    (void)state;
    for (variant = 0; variant < 12; ++variant) { /* each with ranges, whole buffers, everything at its default */
        odd_objects odd;
        snapshot before;
        drop_plan();
        set_plan(plans[variant / 3]);
        make_odd_objects(&odd);
        if (variant % 3 < 2) set_odd_state(&odd, variant % 3);
        else delete_odd_objects(&odd);
        take_snapshot(&before);
        use_every_verb(&before);
        if (variant % 3 < 2) delete_odd_objects(&odd);
    }
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    assert_int_equal(runner_gl.messages(device), messages);
}

static void a_pending_error_of_the_caller_stays_pending(void **state)
{
    snapshot before;
    int messages = runner_gl.messages(device);
    (void)state;
    take_snapshot(&before);
    gl.Enable(0xFFFF);
    assert_int_equal(runner_gl.messages(device), messages + 1); /* debug output does count */
    use_every_verb(&before);
    assert_int_equal(gl.GetError(), GL_INVALID_ENUM);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
}

/* GL frees such a program as soon as another one is current, so it cannot come back; that must not become an error. */
static void a_deleted_current_program_becomes_none(void **state)
{
    unsigned program = make_program();
    int current = -1;
    (void)state;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    gl.UseProgram(program);
    gl.DeleteProgram(program);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    gl.GetIntegerv(GL_CURRENT_PROGRAM, &current);
    assert_int_equal(current, 0);
}

/* What it puts back it also sets: the caller's blending, masks and tests do not get into the picture. */
static void odd_state_does_not_change_the_picture(void **state)
{
    static float plain[WIDTH * HEIGHT], odd_ao[WIDTH * HEIGHT];
    odd_objects odd;
    (void)state;
    drop_plan();
    set_plan(DRAWN_PLAN);
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(plain);
    assert_true(plain[WIDTH * HEIGHT / 2] > 0.1f && plain[WIDTH * HEIGHT / 2] < 0.99f); /* the valley */
    make_odd_objects(&odd);
    set_odd_state(&odd, 0);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    delete_odd_objects(&odd);
    read_ao(odd_ao);
    assert_memory_equal(plain, odd_ao, sizeof plain);
}

/* --------------------------------------------------------------------------------------------------------- barriers */

static struct { unsigned bits[HBIL_MAX_PASSES], count; } recorded;

static void APIENTRY record_barrier(GLbitfield bits)
{
    recorded.bits[recorded.count++ % HBIL_MAX_PASSES] = bits;
    gl.MemoryBarrier(bits);
}

/* Software rasterisers finish every dispatch before the next, so a missing barrier shows in the calls only. */
static void each_pass_waits_for_what_it_reads_and_overwrites(void **state)
{
    lie l = { "glMemoryBarrier", FUNCTION(record_barrier) };
    (void)state;
    assert_int_equal(init_with(&plan, l, sizeof scratch), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    recorded.count = 0;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    assert_int_equal(recorded.count, 3);
    assert_int_equal(recorded.bits[0], GL_SHADER_IMAGE_ACCESS_BARRIER_BIT); /* prepare: last frame's march may still read */
    assert_int_equal(recorded.bits[1], GL_TEXTURE_FETCH_BARRIER_BIT);       /* march: reads what prepare wrote */
    assert_int_equal(recorded.bits[2], GL_TEXTURE_FETCH_BARRIER_BIT);       /* light: reads what march wrote */
}

/* ----------------------------------------------------------------------------------------------------------- errors */

static const GLubyte *APIENTRY old_version(GLenum name) { (void)name; return (const GLubyte *)"4.2.0 Old Driver"; }
static const GLubyte *APIENTRY es_version(GLenum name) { (void)name; return (const GLubyte *)"OpenGL ES 3.2 Driver"; }
static const GLubyte *APIENTRY no_version(GLenum name) { (void)name; return NULL; }

static void APIENTRY broken_source(GLuint shader, GLsizei count, const GLchar *const *text, const GLint *lengths)
{
    static const char *const broken = "#version 430\nthis is no shader\n";
    (void)count, (void)text, (void)lengths;
    gl.ShaderSource(shader, 1, &broken, NULL);
}

static void APIENTRY no_storage(GLenum target, GLsizei levels, GLenum format, GLsizei width, GLsizei height)
{
    (void)target, (void)levels, (void)format, (void)width, (void)height;
    gl.Enable(0xFFFF); /* as a failed allocation, it leaves an error */
}

static void init_names_what_is_wrong_with_the_context(void **state)
{
    const struct { lie l; hbil_gl_result result; const char *part; } cases[] = {
        { { "glGetString", FUNCTION(old_version) }, HBIL_GL_E_CONTEXT, "4.2.0 Old Driver" },
        { { "glGetString", FUNCTION(es_version) }, HBIL_GL_E_CONTEXT, "OpenGL ES 3.2" },
        { { "glGetString", FUNCTION(no_version) }, HBIL_GL_E_CONTEXT, "current" },
        { { "glDispatchCompute", NULL }, HBIL_GL_E_FUNCTION, "glDispatchCompute" },
        { { "glGetString", NULL }, HBIL_GL_E_FUNCTION, "glGetString" },
        { { "glShaderSource", FUNCTION(broken_source) }, HBIL_GL_E_COMPILE, "pass prepare does not compile: 0" } };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof cases / sizeof *cases; ++i) {
        assert_int_equal(init_with(&plan, cases[i].l, sizeof scratch), cases[i].result);
        assert_message(cases[i].part);
        assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_E_ARG);
        assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_ARG);
    }
}

static void init_names_what_is_wrong_with_the_plan(void **state)
{
    lie none = { NULL, NULL };
    hbil_plan bad;
    (void)state;
    build_plan("target=vulkan", &bad);
    assert_int_equal(init_with(&bad, none, sizeof scratch), HBIL_GL_E_PLAN);
    assert_message("target=gl");
    bad = plan;
    bad.textures[0].copies = HBIL_GL_MAX_COPIES + 1;
    assert_int_equal(init_with(&bad, none, sizeof scratch), HBIL_GL_E_PLAN);
    assert_message("HBIL_GL_MAX_COPIES");
    bad = plan;
    bad.textures[hbil_plan_texture(&plan, "ao")].format = HBIL_FORMAT_COUNT;
    assert_int_equal(init_with(&bad, none, sizeof scratch), HBIL_GL_E_PLAN);
    assert_message("texture ao");
    bad = plan;
    bad.textures[hbil_plan_texture(&plan, "ao")].dim = HBIL_DIM_CUBE;
    assert_int_equal(init_with(&bad, none, sizeof scratch), HBIL_GL_E_PLAN);
    assert_message("texture ao has dim 4 and 1 layers");
    bad = plan;
    bad.passes[1].bindings[0].slot = HBIL_GL_MAX_UNITS;
    assert_int_equal(init_with(&bad, none, sizeof scratch), HBIL_GL_E_PLAN);
    assert_message("pass march uses texture unit 16");
    assert_int_equal(init_with(&plan, none, 100), HBIL_GL_E_SPACE);
    assert_message("HBIL_GLSL_MAX");
    assert_int_equal(init_with(NULL, none, sizeof scratch), HBIL_GL_E_ARG);
    assert_message("plan");
    assert_int_equal(hbil_gl_init(NULL, NULL), HBIL_GL_E_ARG);
    assert_string_equal(hbil_gl_result_name(HBIL_GL_OK), "success");
    assert_string_equal(hbil_gl_result_name(HBIL_GL_RESULT_COUNT), "unknown");
    assert_int_equal(hbil_gl_format(HBIL_FORMAT_ANY), 0);
}

/* Puts one wrong texture in, expects its message, and that a run is refused without touching GL. */
static void expect_refused(const char *texture, unsigned name, const char *part)
{
    int32_t index = hbil_plan_texture(&plan, texture);
    unsigned right = textures[index];
    textures[index] = name;
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_E_TEXTURE);
    assert_message(part);
    assert_message(texture);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_ARG);
    assert_int_equal(gl.GetError(), GL_NO_ERROR);
    textures[index] = right;
}

static void resize_names_the_texture_that_is_wrong(void **state)
{
    odd_objects odd;
    unsigned narrow = make_texture(GL_R32F, WIDTH - 1, HEIGHT), low = make_texture(GL_R32F, WIDTH, HEIGHT - 1);
    unsigned half = make_texture(GL_R16F, WIDTH, HEIGHT), whole = make_texture(GL_R32UI, WIDTH, HEIGHT);
    (void)state;
    make_odd_objects(&odd);
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK); /* what fails after it takes this back */
    expect_refused("ao", 0, "missing");
    expect_refused("depth", 0, "missing");
    expect_refused("ao", 123456, "missing");
    expect_refused("ao", narrow, "20 x 13");
    expect_refused("depth", low, "21 x 12");
    expect_refused("ao", half, "r32f");
    expect_refused("depth", whole, "integer format");
    expect_refused("radiance", odd.array, "not a GL_TEXTURE_2D (GL error 0x0502)");
    expect_refused("depth", odd.multisample, "not a GL_TEXTURE_2D (GL error 0x0502)");
    assert_int_equal(hbil_gl_resize(&ctx, 0, HEIGHT, textures), HBIL_GL_E_ARG);
    assert_message("[1, 16384]");
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, NULL), HBIL_GL_E_ARG);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    gl.DeleteTextures(1, &narrow);
    gl.DeleteTextures(1, &low);
    gl.DeleteTextures(1, &half);
    gl.DeleteTextures(1, &whole);
    delete_odd_objects(&odd);
}

static void resize_names_the_shape_that_is_wrong(void **state)
{
    hbil_texture three;
    odd_objects odd;
    unsigned layers, faces = 0;
    GLuint i;
    (void)state;
    drop_plan();
    set_plan(CUBE_PLAN);
    make_odd_objects(&odd);
    memset(&three, 0, sizeof three);
    three.dim = HBIL_DIM_2D_ARRAY;
    three.layers = 3;
    layers = make_shaped(&three, GL_RGBA32F);
    gl.GenTextures(1, &faces);
    gl.BindTexture(GL_TEXTURE_CUBE_MAP, faces);
    for (i = 0; i < 5; ++i)
        gl.TexImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + i, 0, GL_RGBA8, 8, 8, 0, GL_RGBA, GL_UNSIGNED_BYTE, NULL);
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    expect_refused("sky", odd.volume, "not a GL_TEXTURE_CUBE_MAP (GL error 0x0502)");
    expect_refused("sky", faces, "face 5 of texture");
    expect_refused("depth", odd.flat[0], "not a GL_TEXTURE_2D_MULTISAMPLE (GL error 0x0502)");
    expect_refused("depth", odd.multisample, "8 x 8");
    expect_refused("sh", layers, "has 3 layers, the plan needs 4");
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    hbil_gl_shutdown(&ctx);
    plan.config.sample = 4; /* the textures have 4 */
    assert_int_equal(init(), HBIL_GL_OK);
    expect_refused("depth", textures[hbil_plan_texture(&plan, "depth")], "has 4 samples, the plan reads sample 4");
    gl.DeleteTextures(1, &layers);
    gl.DeleteTextures(1, &faces);
    delete_odd_objects(&odd);
}

/* Sampler of its own on a unit that the plan leaves free; the file neither touches nor needs to know it. */
static void a_hook_may_read_resources_of_yours(void **state)
{
    static const float three = 3.0f;
    float far_light[4 * WIDTH * HEIGHT], ao[WIDTH * HEIGHT];
    unsigned mine;
    int i;
    (void)state;
    drop_plan();
    set_plan("target=gl outputs=ao+far environment=hook");
    assert_int_equal(init(), HBIL_GL_E_ARG);
    assert_message("no text given");
    hook = "vec3 far_away(vec3 d) { return d; }";
    assert_int_equal(init(), HBIL_GL_E_ARG);
    assert_message("hbil_far_hook");
    hook = "layout(binding = 15) uniform sampler2D u_mine;\n"
           "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
           "    return texelFetch(u_mine, ivec2(0), 0).rrr;\n"
           "}\n";
    mine = make_texture(GL_R32F, 1, 1);
    gl.ActiveTexture(GL_TEXTURE0 + 15);
    gl.BindTexture(GL_TEXTURE_2D, mine);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, 1, 1, GL_RED, GL_FLOAT, &three);
    gl.ActiveTexture(GL_TEXTURE0);
    assert_int_equal(init(), HBIL_GL_OK);
    hook = NULL; /* no longer needed */
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(ao);
    gl.BindTexture(GL_TEXTURE_2D, textures[hbil_plan_texture(&plan, "far")]);
    gl.GetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_FLOAT, far_light);
    for (i = 0; i < WIDTH * HEIGHT; ++i) assert_true(far_light[4 * i] > 2.999f * ao[i] && far_light[4 * i] < 3.001f * ao[i]);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    gl.DeleteTextures(1, &mine);
}

static void resize_reports_a_texture_that_cannot_be_made(void **state)
{
    lie l = { "glTexStorage2D", FUNCTION(no_storage) };
    (void)state;
    assert_int_equal(init_with(&plan, l, sizeof scratch), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_E_MEMORY);
    assert_message("view_depth, r32f, 21 x 13, cannot be made (GL error 0x0500)");
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_ARG);
}

static void run_names_what_is_wrong_with_the_frame(void **state)
{
    (void)state;
    assert_int_equal(hbil_gl_run(NULL, &frame), HBIL_GL_E_ARG);
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_ARG);
    assert_message("hbil_gl_resize");
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    frame.width = WIDTH + 1;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_FRAME);
    assert_message("22 x 13");
    frame.width = WIDTH;
    frame.projection[0] = 0.0f;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_E_FRAME);
    assert_message("projection");
    assert_int_equal(hbil_gl_timings(&ctx, NULL), HBIL_GL_E_ARG);
}

/* --------------------------------------------------------------------------------------------------------- textures */

static void an_unchanged_size_keeps_our_textures(void **state)
{
    int32_t ours = hbil_plan_texture(&plan, "view_depth"), ao = hbil_plan_texture(&plan, "ao");
    unsigned kept, other = make_texture(GL_R32F, WIDTH + 5, HEIGHT + 1), first;
    float a[WIDTH * HEIGHT], b[(WIDTH + 5) * (HEIGHT + 1)];
    int x, y;
    (void)state;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(a);
    kept = ctx.texture[ours][0];
    first = textures[ao];
    textures[ao] = other; /* larger than the frame, which is fine */
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(ctx.texture[ours][0], kept);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(b);
    for (y = 0; y < HEIGHT; ++y)
        for (x = 0; x < WIDTH; ++x) assert_true(a[y * WIDTH + x] == b[y * (WIDTH + 5) + x]);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH - 4, HEIGHT - 4, textures), HBIL_GL_OK);
    frame.width = WIDTH - 4;
    frame.height = HEIGHT - 4;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    gl.DeleteTextures(1, &first);
}

/* A texture without mip levels but with GL's default filter, which wants them, is incomplete: on its own it reads 0. */
static void filters_of_inputs_do_not_matter(void **state)
{
    int32_t depth = hbil_plan_texture(&plan, "depth");
    unsigned complete = textures[depth], incomplete = 0;
    float a[WIDTH * HEIGHT], b[WIDTH * HEIGHT];
    (void)state;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(a);
    gl.GenTextures(1, &incomplete);
    gl.BindTexture(GL_TEXTURE_2D, incomplete);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R32F, WIDTH, HEIGHT, 0, GL_RED, GL_FLOAT, NULL);
    textures[depth] = incomplete;
    fill_depth(4.0f, 0.1f);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(b);
    assert_memory_equal(a, b, sizeof a);
    gl.DeleteTextures(1, &complete);
}

static void shutdown_deletes_what_is_ours_and_nothing_else(void **state)
{
    hbil_gl old;
    uint32_t i;
    (void)state;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    old = ctx;
    assert_true(gl.IsBuffer(old.buffer) && gl.IsSampler(old.samplers[0]) && gl.IsSampler(old.samplers[1]));
    hbil_gl_shutdown(&ctx);
    hbil_gl_shutdown(&ctx); /* of a zeroed context: nothing */
    assert_false(gl.IsBuffer(old.buffer) || gl.IsSampler(old.samplers[0]) || gl.IsSampler(old.samplers[1]));
    for (i = 0; i < plan.pass_count; ++i) assert_false(gl.IsProgram(old.program[i]));
    for (i = 0; i < plan.texture_count; ++i)
        assert_int_equal(gl.IsTexture(old.texture[i][0]), plan.textures[i].life < HBIL_LIFE_TRANSIENT);
}

/* No pass uses history yet, so a plan is bent to do so: march reads the view depth that prepare wrote the frame before. */
static void age_1_reads_what_the_last_frame_wrote(void **state)
{
    int32_t depth = hbil_plan_texture(&plan, "view_depth"), march = hbil_plan_pass(&plan, "march");
    float flat[WIDTH * HEIGHT], valley[WIDTH * HEIGHT], now[WIDTH * HEIGHT];
    lie none = { NULL, NULL };
    hbil_plan bent = plan;
    uint32_t i;
    (void)state;
    assert_int_equal(init(), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(valley);
    fill_depth(4.0f, 0.0f);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK);
    read_ao(flat);
    assert_memory_not_equal(flat, valley, sizeof flat);
    hbil_gl_shutdown(&ctx);

    bent.textures[depth].life = HBIL_LIFE_HISTORY;
    bent.textures[depth].copies = 2;
    for (i = 0; i < bent.passes[march].binding_count; ++i)
        if (bent.passes[march].bindings[i].texture == depth) bent.passes[march].bindings[i].age = 1;
    assert_int_equal(init_with(&bent, none, sizeof scratch), HBIL_GL_OK);
    assert_int_equal(hbil_gl_resize(&ctx, WIDTH, HEIGHT, textures), HBIL_GL_OK);
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK); /* writes flat */
    fill_depth(4.0f, 0.1f);
    frame.index = 1;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK); /* writes valley, reads flat */
    read_ao(now);
    assert_memory_equal(now, flat, sizeof now);
    fill_depth(4.0f, 0.0f);
    frame.index = 2;
    assert_int_equal(hbil_gl_run(&ctx, &frame), HBIL_GL_OK); /* writes flat, reads valley */
    read_ao(now);
    assert_memory_equal(now, valley, sizeof now);
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(every_verb_puts_all_state_back),
        TEST(a_pending_error_of_the_caller_stays_pending),
        TEST(a_deleted_current_program_becomes_none),
        TEST(odd_state_does_not_change_the_picture),
        TEST(each_pass_waits_for_what_it_reads_and_overwrites),
        TEST(init_names_what_is_wrong_with_the_context),
        TEST(init_names_what_is_wrong_with_the_plan),
        TEST(resize_names_the_texture_that_is_wrong),
        TEST(resize_names_the_shape_that_is_wrong),
        TEST(a_hook_may_read_resources_of_yours),
        TEST(resize_reports_a_texture_that_cannot_be_made),
        TEST(run_names_what_is_wrong_with_the_frame),
        TEST(an_unchanged_size_keeps_our_textures),
        TEST(filters_of_inputs_do_not_matter),
        TEST(shutdown_deletes_what_is_ours_and_nothing_else),
        TEST(age_1_reads_what_the_last_frame_wrote),
    };
    runner_info about;
    char error[512] = "";
    int failed;
    device = runner_gl.open(1, &about, error, sizeof error);
    if (!device) {
        printf("skipped: %s\n", error);
        return 77;
    }
    printf("%s, %s\n", about.device, about.driver);
    load_functions();
    failed = cmocka_run_group_tests(tests, NULL, NULL);
    runner_gl.close(device);
    return failed;
}
