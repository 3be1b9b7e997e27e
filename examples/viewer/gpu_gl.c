/* gpu_gl.c - the viewer on OpenGL 4.3: sun's shadow map, G-buffer, the plan through backends/hbil_gl.h, tone
 * mapping.
 *
 * The context is the window's, or without a window one of EGL or OSMesa, which examples/frame/runner_gl.c opens;
 * the implementation of hbil_gl.h is there, too. What concerns hbil.h is in gl_plan, hand_over (its inputs and
 * outputs) and gl_frame. */
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <GL/glcorearb.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../hbil.h"
#include "../../backends/hbil_gl.h"
#include "../frame/runner_internal.h"
#include "gpu.h"
#include "viewer_shaders.h"

#define FAIL(g, ...) (snprintf((g)->setup.error, (g)->setup.error_size, __VA_ARGS__), 0)

#define GL_FUNCTIONS(X)                                        \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                   \
    X(PFNGLATTACHSHADERPROC, AttachShader)                     \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                         \
    X(PFNGLBINDBUFFERBASEPROC, BindBufferBase)                 \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)               \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                       \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)               \
    X(PFNGLBLITFRAMEBUFFERPROC, BlitFramebuffer)               \
    X(PFNGLBUFFERDATAPROC, BufferData)                         \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus) \
    X(PFNGLCLEARPROC, Clear)                                   \
    X(PFNGLCOMPILESHADERPROC, CompileShader)                   \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)                   \
    X(PFNGLCREATESHADERPROC, CreateShader)                     \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback)     \
    X(PFNGLDELETEBUFFERSPROC, DeleteBuffers)                   \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)         \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)                   \
    X(PFNGLDELETESHADERPROC, DeleteShader)                     \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)                 \
    X(PFNGLDELETEVERTEXARRAYSPROC, DeleteVertexArrays)         \
    X(PFNGLDEPTHFUNCPROC, DepthFunc)                           \
    X(PFNGLDISABLEPROC, Disable)                               \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                         \
    X(PFNGLDRAWBUFFERSPROC, DrawBuffers)                       \
    X(PFNGLENABLEPROC, Enable)                                 \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
    X(PFNGLFINISHPROC, Finish)                                 \
    X(PFNGLFRAMEBUFFERTEXTUREPROC, FramebufferTexture)         \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                         \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)               \
    X(PFNGLGENTEXTURESPROC, GenTextures)                       \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)               \
    X(PFNGLGETERRORPROC, GetError)                             \
    X(PFNGLGETINTEGER64VPROC, GetInteger64v)                   \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)           \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                     \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)             \
    X(PFNGLGETSTRINGPROC, GetString)                           \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                       \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)                   \
    X(PFNGLREADPIXELSPROC, ReadPixels)                         \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                     \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)                   \
    X(PFNGLTEXSTORAGE2DPROC, TexStorage2D)                     \
    X(PFNGLTEXSTORAGE3DPROC, TexStorage3D)                     \
    X(PFNGLTEXTUREVIEWPROC, TextureView)                       \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                         \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)       \
    X(PFNGLVIEWPORTPROC, Viewport)
#define GL_MEMBER(type, name) type name;
typedef struct gl_functions { GL_FUNCTIONS(GL_MEMBER) } gl_functions;

enum { DRAW_SHADOW, DRAW_MODEL, DRAW_SKY, DRAW_SCREEN, DRAW_TEXT, DRAWS };
enum { FBO_SHADOW, FBO_SCENE, FBO_PICTURE, FBOS };
enum { VAO_MODEL, VAO_TEXT, VAO_NONE, VAOS };
enum { BUFFER_UNIFORMS, BUFFER_VERTICES, BUFFER_TEXT, BUFFERS };
enum { TIMES_OWN = 4 };

static const GLenum target_formats[TARGETS] = {
    GL_DEPTH_COMPONENT32F, GL_RGBA16F, GL_SRGB8_ALPHA8, GL_RGBA16F, GL_RG16F, GL_RGBA8
};

typedef struct gl_gpu {
    gpu_setup    setup;
    void        *headless;             /* device of runner_gl; NULL with a window */
    gl_functions gl;
    GLuint       programs[DRAWS], fbos[FBOS], vaos[VAOS], buffers[BUFFERS];
    GLsizei      vertex_count;
    int          width, height;        /* 0 before the first resize */
    GLuint       shadow, picture, views[GPU_VIEWS], outputs[HBIL_MAX_TEXTURES];
    hbil_gl      light;                /* zeroed while there is none */
    int64_t      ticks[TIMES_OWN + 1]; /* ns: start, after shadow, after G-buffer, before and after the screen */
    int          messages;
} gl_gpu;

/* ---- open and close ---------------------------------------------------------------------------------------------- */

void *runner_gl_proc(void *user, const char *name); /* examples/frame/runner_gl.c */

/* get_proc of hbil_gl.h; user is the gl_gpu. */
static void *get_proc(void *user, const char *name)
{
    gl_gpu    *g = user;
    GLFWglproc function;
    void      *address = NULL;

    if (g->headless) return runner_gl_proc(g->headless, name);
    function = glfwGetProcAddress(name);
    memcpy(&address, &function, sizeof address); /* ISO C has no conversion between the two */
    return address;
}

static int load_functions(gl_gpu *g)
{
#define GL_ROW(type, name) {"gl" #name, offsetof(gl_functions, name)},
    static const struct { const char *name; size_t offset; } table[] = {GL_FUNCTIONS(GL_ROW)};
#undef GL_ROW
    size_t i;

    for (i = 0; i < sizeof table / sizeof *table; i++) {
        void *address = get_proc(g, table[i].name);
        if (!address) return FAIL(g, "the GL driver has no %s: update it", table[i].name);
        memcpy((char *)&g->gl + table[i].offset, &address, sizeof address);
    }
    return 1;
}

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length,
                                const GLchar *text, const void *user)
{
    gl_gpu *g = NULL;

    (void)source, (void)type, (void)length;
    memcpy(&g, &user, sizeof g); /* GL hands our own pointer back as const */
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    g->messages++;
    fprintf(stderr, "gl: message %u: %s\n", id, text);
}

static GLuint make_program(gl_gpu *g, const char *name, const char *vertex, const char *fragment)
{
    const char *texts[3] = {"#version 430 core\n#define VERTEX_INDEX gl_VertexID\n", shader_scene_glsl, NULL};
    GLuint program = g->gl.CreateProgram();
    char   log[512] = "";
    GLint  linked = 0;
    int    i;

    for (i = 0; i < 2; i++) {
        GLuint shader = g->gl.CreateShader(i ? GL_FRAGMENT_SHADER : GL_VERTEX_SHADER);
        texts[2] = i ? fragment : vertex;
        g->gl.ShaderSource(shader, 3, texts, NULL);
        g->gl.CompileShader(shader);
        if (!log[0]) g->gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
        g->gl.AttachShader(program, shader);
        g->gl.DeleteShader(shader);
    }
    g->gl.LinkProgram(program);
    g->gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked) return program;
    if (!log[0]) g->gl.GetProgramInfoLog(program, sizeof log, NULL, log);
    g->gl.DeleteProgram(program);
    return (GLuint)FAIL(g, "shader %s: %s", name, log);
}

static GLuint make_texture(gl_gpu *g, GLuint *name, GLenum format, int width, int height, int layers)
{
    const GLenum target = layers ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;

    g->gl.DeleteTextures(1, name);
    g->gl.GenTextures(1, name);
    g->gl.BindTexture(target, *name);
    if (layers) g->gl.TexStorage3D(target, 1, format, width, height, layers);
    else g->gl.TexStorage2D(target, 1, format, width, height);
    g->gl.TexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    g->gl.TexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return *name;
}

static void make_vertex_arrays(gl_gpu *g)
{
    static const GLint rows[][2] = GPU_ATTRIBUTES;
    GLuint i;

    g->gl.GenVertexArrays(VAOS, g->vaos);
    g->gl.GenBuffers(BUFFERS, g->buffers);
    g->gl.BindVertexArray(g->vaos[VAO_MODEL]);
    g->gl.BindBuffer(GL_ARRAY_BUFFER, g->buffers[BUFFER_VERTICES]);
    for (i = 0; i < 5; i++) {
        g->gl.EnableVertexAttribArray(i);
        g->gl.VertexAttribPointer(i, rows[i][1], GL_FLOAT, GL_FALSE, sizeof(gpu_vertex),
                                  (const void *)((size_t)rows[i][0] * sizeof(float)));
    }
    g->gl.BindVertexArray(g->vaos[VAO_TEXT]);
    g->gl.BindBuffer(GL_ARRAY_BUFFER, g->buffers[BUFFER_TEXT]);
    g->gl.EnableVertexAttribArray(0);
    g->gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 3 * sizeof(float), NULL);
}

static int make_programs(gl_gpu *g)
{
    static const char *const rows[DRAWS][3] = {
        {"shadow", shader_shadow_vert, shader_shadow_frag}, {"model", shader_model_vert, shader_model_frag},
        {"sky", shader_cover_vert, shader_sky_frag}, {"screen", shader_cover_vert, shader_screen_frag},
        {"text", shader_text_vert, shader_text_frag}};
    int draw;

    for (draw = 0; draw < DRAWS; draw++)
        if (!(g->programs[draw] = make_program(g, rows[draw][0], rows[draw][1], rows[draw][2]))) return 0;
    return 1;
}

static void gl_close(void *gpu)
{
    gl_gpu *g = gpu;
    int     i;

    if (g->gl.Viewport) { /* the last of the functions: all are there */
        hbil_gl_shutdown(&g->light);
        g->gl.DeleteTextures(HBIL_MAX_TEXTURES, g->outputs);
        g->gl.DeleteTextures(GPU_VIEWS, g->views);
        g->gl.DeleteTextures(1, &g->shadow);
        g->gl.DeleteTextures(1, &g->picture);
        g->gl.DeleteFramebuffers(FBOS, g->fbos);
        g->gl.DeleteVertexArrays(VAOS, g->vaos);
        g->gl.DeleteBuffers(BUFFERS, g->buffers);
        for (i = 0; i < DRAWS; i++) g->gl.DeleteProgram(g->programs[i]);
    }
    if (g->headless) runner_gl.close(g->headless);
    free(g);
}

static int start(gl_gpu *g, char device[128])
{
    static runner_info about;

    if (g->setup.window) {
        glfwMakeContextCurrent(g->setup.window);
        glfwSwapInterval(1);
    } else {
        g->headless = runner_gl.open(0, &about, g->setup.error, g->setup.error_size);
        if (!g->headless) return 0;
    }
    if (!load_functions(g)) return 0;
    snprintf(device, 128, "%.127s", (const char *)g->gl.GetString(GL_RENDERER));
    if (g->setup.validate) {
        g->gl.Enable(GL_DEBUG_OUTPUT);
        g->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        g->gl.DebugMessageCallback(on_message, g);
    }
    if (!make_programs(g)) return 0;
    make_vertex_arrays(g);
    g->gl.GenFramebuffers(FBOS, g->fbos);
    make_texture(g, &g->shadow, GL_DEPTH_COMPONENT32F, SHADOW_SIZE, SHADOW_SIZE, 0);
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->fbos[FBO_SHADOW]);
    g->gl.FramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, g->shadow, 0);
    g->gl.DrawBuffers(0, NULL);
    g->gl.DepthFunc(GL_LEQUAL);
    g->gl.Enable(GL_FRAMEBUFFER_SRGB); /* encodes what goes into TARGET_ALBEDO; no other image is sRGB */
    return 1;
}

static void *gl_open(const gpu_setup *setup, char device[128])
{
    gl_gpu *g = calloc(1, sizeof *g);

    if (!g) {
        snprintf(setup->error, setup->error_size, "out of memory");
        return NULL;
    }
    g->setup = *setup;
    if (start(g, device)) return g;
    gl_close(g);
    return NULL;
}

static int gl_messages(const void *gpu) { return ((const gl_gpu *)gpu)->messages; }

/* GL errors since the last look, as the return value of a call. */
static int no_error(gl_gpu *g, const char *where)
{
    const GLenum code = g->gl.GetError();
    return code == GL_NO_ERROR || FAIL(g, "GL error 0x%04x %s: --validate tells more", code, where);
}

static int gl_model(void *gpu, const gpu_vertex *vertices, size_t count)
{
    gl_gpu *g = gpu;

    g->vertex_count = (GLsizei)count;
    g->gl.BindBuffer(GL_ARRAY_BUFFER, g->buffers[BUFFER_VERTICES]);
    g->gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)(count * sizeof *vertices), vertices, GL_STATIC_DRAW);
    return no_error(g, "on uploading the model");
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* Our textures for its inputs and outputs. */
static int hand_over(gl_gpu *g)
{
    const hbil_plan *plan = &g->light.plan;
    unsigned         names[HBIL_MAX_TEXTURES];
    uint32_t         t;

    memset(names, 0, sizeof names);
    g->gl.DeleteTextures(HBIL_MAX_TEXTURES, g->outputs);
    memset(g->outputs, 0, sizeof g->outputs);
    for (t = 0; t < plan->texture_count; t++) {
        const hbil_texture *texture = &plan->textures[t];
        const int target = gpu_input_of(texture->name);
        if (texture->life == HBIL_LIFE_INPUT && target >= 0) names[t] = g->views[target];
        if (texture->life == HBIL_LIFE_OUTPUT)
            names[t] = make_texture(g, &g->outputs[t], hbil_gl_format((hbil_format)texture->format), g->width,
                                    g->height, texture->dim == HBIL_DIM_2D_ARRAY ? texture->layers : 0);
    }
    return hbil_gl_resize(&g->light, (uint32_t)g->width, (uint32_t)g->height, names) == HBIL_GL_OK
        || FAIL(g, "%s", g->light.message);
}

static int gl_plan(void *gpu, const hbil_plan *plan)
{
    static char  scratch[HBIL_GLSL_MAX];
    gl_gpu      *g = gpu;
    hbil_gl_info info = {0};
    hbil_gl      next;

    info.plan = plan;
    info.get_proc = get_proc;
    info.user = g;
    info.scratch = scratch;
    info.scratch_size = sizeof scratch;
    info.timings = 1;
    if (hbil_gl_init(&info, &next) != HBIL_GL_OK) return FAIL(g, "%s", next.message);
    hbil_gl_shutdown(&g->light);
    g->light = next;
    return g->width == 0 || hand_over(g);
}

/* ---- size -------------------------------------------------------------------------------------------------------- */

static int gl_resize(void *gpu, int width, int height)
{
    gl_gpu *g = gpu;
    GLenum  colours[TARGETS - 1], attachment;
    int     t;

    g->width = width;
    g->height = height;
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->fbos[FBO_SCENE]);
    for (t = 0; t < TARGETS; t++) {
        make_texture(g, &g->views[t], target_formats[t], width, height, 0);
        attachment = t ? GL_COLOR_ATTACHMENT0 + (GLenum)t - 1 : GL_DEPTH_ATTACHMENT;
        g->gl.FramebufferTexture(GL_FRAMEBUFFER, attachment, g->views[t], 0);
        if (t) colours[t - 1] = attachment;
    }
    g->gl.DrawBuffers(TARGETS - 1, colours);
    if (g->gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return FAIL(g, "this driver cannot draw into a G-buffer of %dx%d", width, height);

    /* a second name for the same texels, with alpha where red is read */
    g->gl.DeleteTextures(1, &g->views[TARGET_ROUGHNESS]);
    g->gl.GenTextures(1, &g->views[TARGET_ROUGHNESS]);
    g->gl.TextureView(g->views[TARGET_ROUGHNESS], GL_TEXTURE_2D, g->views[TARGET_SPECULAR],
                      target_formats[TARGET_SPECULAR], 0, 1, 0, 1);
    g->gl.BindTexture(GL_TEXTURE_2D, g->views[TARGET_ROUGHNESS]);
    g->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_SWIZZLE_R, GL_ALPHA);

    make_texture(g, &g->picture, GL_RGBA8, width, height, 0); /* screen.frag encodes sRGB itself */
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->fbos[FBO_PICTURE]);
    g->gl.FramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, g->picture, 0);
    return no_error(g, "on making the G-buffer") && hand_over(g);
}

/* ---- one frame --------------------------------------------------------------------------------------------------- */

static void draw(gl_gpu *g, int what, int vertices, GLsizei count)
{
    g->gl.UseProgram(g->programs[what]);
    g->gl.BindVertexArray(g->vaos[vertices]);
    g->gl.DrawArrays(GL_TRIANGLES, 0, count);
}

static void begin_draw(gl_gpu *g, int fbo, int width, int height, GLbitfield clear)
{
    g->gl.BindFramebuffer(GL_FRAMEBUFFER, g->fbos[fbo]);
    g->gl.Viewport(0, 0, width, height);
    g->gl.Clear(clear);
}

static void bind_textures(gl_gpu *g, const gpu_frame *frame)
{
    const GLuint names[] = {g->shadow, g->views[TARGET_NORMAL], g->views[TARGET_ALBEDO], g->views[TARGET_DIRECT],
                            frame->shown >= 0 ? g->outputs[frame->shown] : g->views[TARGET_DIRECT]};
    GLuint i;

    for (i = 0; i < sizeof names / sizeof *names; i++) { /* bindings 1 to 5 of shaders/ */
        g->gl.ActiveTexture(GL_TEXTURE1 + i);
        g->gl.BindTexture(GL_TEXTURE_2D, names[i]);
    }
    g->gl.ActiveTexture(GL_TEXTURE0);
}

/* Software rasterisers measure nothing without waiting. */
static void stamp(gl_gpu *g, int index)
{
    g->gl.Finish();
    g->gl.GetInteger64v(GL_TIMESTAMP, &g->ticks[index]);
}

/* Row 0 is the top here and the bottom in a window. */
static void show(gl_gpu *g)
{
    g->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, g->fbos[FBO_PICTURE]);
    g->gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    g->gl.Disable(GL_FRAMEBUFFER_SRGB); /* the window may be sRGB, the picture is encoded already */
    g->gl.BlitFramebuffer(0, 0, g->width, g->height, 0, g->height, g->width, 0, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    g->gl.Enable(GL_FRAMEBUFFER_SRGB);
}

/* What the window is about to show, or the picture. */
static void read_pixels(gl_gpu *g, unsigned char *to)
{
    const size_t row = (size_t)g->width * 4;
    int y;
    size_t i;

    if (!g->setup.window) {
        g->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, g->fbos[FBO_PICTURE]);
        g->gl.ReadPixels(0, 0, g->width, g->height, GL_RGBA, GL_UNSIGNED_BYTE, to);
        return;
    }
    g->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    for (y = 0; y < g->height; y++)
        g->gl.ReadPixels(0, g->height - 1 - y, g->width, 1, GL_RGBA, GL_UNSIGNED_BYTE, to + (size_t)y * row);
    for (i = 3; i < row * (size_t)g->height; i += 4) to[i] = 255;
}

static int gl_frame(void *gpu, const gpu_frame *frame)
{
    gl_gpu *g = gpu;

    g->gl.BindBuffer(GL_UNIFORM_BUFFER, g->buffers[BUFFER_UNIFORMS]);
    g->gl.BufferData(GL_UNIFORM_BUFFER, sizeof frame->scene, &frame->scene, GL_STREAM_DRAW);
    g->gl.BindBufferBase(GL_UNIFORM_BUFFER, 0, g->buffers[BUFFER_UNIFORMS]);
    bind_textures(g, frame);
    stamp(g, 0);
    g->gl.Enable(GL_DEPTH_TEST);
    begin_draw(g, FBO_SHADOW, SHADOW_SIZE, SHADOW_SIZE, GL_DEPTH_BUFFER_BIT);
    draw(g, DRAW_SHADOW, VAO_MODEL, g->vertex_count);
    stamp(g, 1);
    begin_draw(g, FBO_SCENE, g->width, g->height, GL_DEPTH_BUFFER_BIT | GL_COLOR_BUFFER_BIT);
    draw(g, DRAW_MODEL, VAO_MODEL, g->vertex_count);
    draw(g, DRAW_SKY, VAO_NONE, 3);
    stamp(g, 2);
    if (hbil_gl_run(&g->light, &frame->light) != HBIL_GL_OK) return FAIL(g, "%s", g->light.message);
    g->gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    stamp(g, 3);
    g->gl.Disable(GL_DEPTH_TEST);
    begin_draw(g, FBO_PICTURE, g->width, g->height, 0);
    draw(g, DRAW_SCREEN, VAO_NONE, 3);
    if (frame->text_corners > 0) {
        g->gl.BindBuffer(GL_ARRAY_BUFFER, g->buffers[BUFFER_TEXT]);
        g->gl.BufferData(GL_ARRAY_BUFFER, (GLsizeiptr)frame->text_corners * 3 * (GLsizeiptr)sizeof(float), frame->text,
                         GL_STREAM_DRAW);
        draw(g, DRAW_TEXT, VAO_TEXT, frame->text_corners);
    }
    stamp(g, 4);
    if (g->setup.window) show(g);
    if (frame->pixels) read_pixels(g, frame->pixels);
    if (!no_error(g, "in this frame")) return 0;
    if (g->setup.window) glfwSwapBuffers(g->setup.window);
    return 1;
}

static int gl_times(void *gpu, gpu_time times[GPU_TIMES])
{
    static const char *const names[] = {"shadow", "g-buffer", "screen"};
    gl_gpu  *g = gpu;
    double   ms[HBIL_MAX_PASSES];
    int      count = 0;
    uint32_t p;

    if (hbil_gl_timings(&g->light, ms) != HBIL_GL_OK) return 0;
    for (p = 0; p < 2; p++, count++) {
        snprintf(times[count].name, sizeof times[count].name, "%s", names[p]);
        times[count].ms = 1e-6 * (double)(g->ticks[p + 1] - g->ticks[p]);
    }
    for (p = 0; p < g->light.plan.pass_count; p++, count++) {
        snprintf(times[count].name, sizeof times[count].name, "%s", g->light.plan.passes[p].name);
        times[count].ms = ms[p];
    }
    snprintf(times[count].name, sizeof times[count].name, "%s", names[2]);
    times[count++].ms = 1e-6 * (double)(g->ticks[4] - g->ticks[3]);
    return count;
}

const gpu_ops gpu_gl = {"gl", gl_open, gl_close, gl_messages, gl_model, gl_plan, gl_resize, gl_frame, gl_times};
