/* runner_gl.c - the OpenGL and OpenGL ES side of runner.h: makes a context without a window, uploads, runs hbil_gl.h, reads back.
 *
 * The context comes from EGL if that finds a GPU, else from OSMesa, else from EGL's software rasteriser; HBIL_GL=osmesa or
 * HBIL_GL=egl forces one; ES comes from EGL only. Where there is no 4.3, one of 3.3 will do, for stage=fragment. Both libraries are
 * opened at run time, so a build needs neither. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include "runner_internal.h"
#define HBIL_GL_IMPLEMENTATION
#include "../../backends/hbil_gl.h"

/* OSMesa, spelt out: GL/osmesa.h pulls in GL/gl.h and is gone from newer Mesa. */
enum { OSMESA_RGBA = 0x1908, OSMESA_FORMAT = 0x22, OSMESA_PROFILE = 0x33, OSMESA_CORE_PROFILE = 0x34,
       OSMESA_CONTEXT_MAJOR_VERSION = 0x36, OSMESA_CONTEXT_MINOR_VERSION = 0x37 };
typedef struct osmesa_functions {
    void *(*CreateContextAttribs)(const int *attributes, void *share);
    GLboolean (*MakeCurrent)(void *context, void *buffer, GLenum type, GLsizei width, GLsizei height);
    void *(*GetProcAddress)(const char *name);
    void (*DestroyContext)(void *context);
} osmesa_functions;

typedef struct egl_functions {
    PFNEGLGETPROCADDRESSPROC  GetProcAddress;
    PFNEGLQUERYSTRINGPROC     QueryString;
    PFNEGLINITIALIZEPROC      Initialize;
    PFNEGLBINDAPIPROC         BindAPI;
    PFNEGLCREATECONTEXTPROC   CreateContext;
    PFNEGLDESTROYCONTEXTPROC  DestroyContext;
    PFNEGLMAKECURRENTPROC     MakeCurrent;
} egl_functions;

#define GL_FUNCTIONS(X)                                    \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)           \
    X(PFNGLATTACHSHADERPROC, AttachShader)                 \
    X(PFNGLBINDIMAGETEXTUREPROC, BindImageTexture)         \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                   \
    X(PFNGLCOMPILESHADERPROC, CompileShader)               \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)               \
    X(PFNGLCREATESHADERPROC, CreateShader)                 \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback) \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)     \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)               \
    X(PFNGLDELETESHADERPROC, DeleteShader)                 \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)             \
    X(PFNGLDISPATCHCOMPUTEPROC, DispatchCompute)           \
    X(PFNGLENABLEPROC, Enable)                             \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D) \
    X(PFNGLFRAMEBUFFERTEXTURELAYERPROC, FramebufferTextureLayer) \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)           \
    X(PFNGLGENTEXTURESPROC, GenTextures)                   \
    X(PFNGLGETERRORPROC, GetError)                         \
    X(PFNGLGETINTEGERVPROC, GetIntegerv)                   \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                 \
    X(PFNGLGETSTRINGPROC, GetString)                       \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                   \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)               \
    X(PFNGLREADPIXELSPROC, ReadPixels)                     \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                 \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)               \
    X(PFNGLTEXSTORAGE2DPROC, TexStorage2D)                 \
    X(PFNGLTEXSTORAGE2DMULTISAMPLEPROC, TexStorage2DMultisample) \
    X(PFNGLTEXSTORAGE3DPROC, TexStorage3D)                 \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)               \
    X(PFNGLTEXSUBIMAGE3DPROC, TexSubImage3D)               \
    X(PFNGLUNIFORM1IPROC, Uniform1i)                       \
    X(PFNGLUSEPROGRAMPROC, UseProgram)
#define GL_MEMBER(type, name) type name;
typedef struct gl_functions { GL_FUNCTIONS(GL_MEMBER) } gl_functions;

/* The texture of an input or output, kept from call to call while its shape is the same. */
typedef struct gl_image {
    GLuint name;
    GLenum target, format;
    int    width, height, depth;
} gl_image;

typedef struct gl_device {
    osmesa_functions osmesa;
    egl_functions    egl;
    void            *osmesa_context;    /* this one or the next two */
    EGLDisplay       display;
    EGLContext       egl_context;
    int              es;                /* OpenGL ES */
    unsigned char    pixel[4];          /* OSMesa draws here; nothing is drawn */
    gl_functions     gl;
    hbil_gl          backend;           /* zeroed while there is none */
    gl_image         images[HBIL_MAX_TEXTURES];
    GLuint           spread;            /* program that fills multisample textures, made when first needed */
    int              messages;
    const char      *hook;
    const char      *own_pass, *own_text; /* instead of what hbil.h emits */
    char             scratch[2 * HBIL_GLSL_MAX]; /* room for a hook */
} gl_device;

/* -------------------------------------------------------------------------------------------------------- contexts */

/* Copies the addresses of names[] to consecutive function pointers; 0 if the library or one of them is missing. The library is
 * never closed: drivers leave threads and exit handlers behind. */
static int load_library(const char *file, const char *const *names, size_t count, void *pointers)
{
    void  *library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
    size_t i;
    if (!library) return 0;
    for (i = 0; i < count; ++i) {
        void *address = dlsym(library, names[i]);
        if (!address) return 0;
        memcpy((char *)pointers + i * sizeof address, &address, sizeof address);
    }
    return 1;
}

static int osmesa_open(gl_device *d)
{
    static const char *const names[] = { "OSMesaCreateContextAttribs", "OSMesaMakeCurrent", "OSMesaGetProcAddress",
                                         "OSMesaDestroyContext" };
    static const int attributes[] = { OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
                                      OSMESA_CONTEXT_MAJOR_VERSION, 4, OSMESA_CONTEXT_MINOR_VERSION, 5, 0 };
    static const int old[] = { OSMESA_FORMAT, OSMESA_RGBA, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
                               OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0 };
    if (!load_library("libOSMesa.so.8", names, sizeof names / sizeof *names, &d->osmesa)) return 0;
    d->osmesa_context = d->osmesa.CreateContextAttribs(attributes, NULL);
    if (!d->osmesa_context) d->osmesa_context = d->osmesa.CreateContextAttribs(old, NULL);
    if (!d->osmesa_context) return 0;
    if (d->osmesa.MakeCurrent(d->osmesa_context, d->pixel, GL_UNSIGNED_BYTE, 1, 1)) return 1;
    d->osmesa.DestroyContext(d->osmesa_context);
    d->osmesa_context = NULL;
    return 0;
}

/* No eglTerminate: the process has each display once, a second runner may be on it. */
static void egl_close(gl_device *d)
{
    d->egl.MakeCurrent(d->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (d->egl_context != EGL_NO_CONTEXT) d->egl.DestroyContext(d->display, d->egl_context);
    d->egl_context = EGL_NO_CONTEXT;
    d->display = EGL_NO_DISPLAY;
}

static int is_software(const char *renderer)
{
    return strstr(renderer, "llvmpipe") || strstr(renderer, "softpipe") || strstr(renderer, "swrast") ||
           strstr(renderer, "Software Rasterizer");
}

static EGLContext egl_context(gl_device *d, EGLDisplay display, EGLint major, EGLint minor, int validate)
{
    const EGLint attributes[] = { EGL_CONTEXT_MAJOR_VERSION, major, EGL_CONTEXT_MINOR_VERSION, minor,
                                  EGL_CONTEXT_OPENGL_DEBUG, validate ? EGL_TRUE : EGL_FALSE,
                                  d->es ? EGL_NONE : EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE };
    return d->egl.CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
}

/* A context without a surface on one display; any_renderer 0: only if a GPU draws it. */
static int egl_try(gl_device *d, EGLDisplay display, int validate, int any_renderer)
{
    PFNGLGETSTRINGPROC get_string;
    const char *renderer = NULL;
    if (display == EGL_NO_DISPLAY || !d->egl.Initialize(display, NULL, NULL)) return 0;
    d->display = display;
    d->egl.BindAPI(d->es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    d->egl_context = egl_context(d, display, d->es ? 3 : 4, d->es ? 1 : 3, validate);
    if (d->egl_context == EGL_NO_CONTEXT) d->egl_context = egl_context(d, display, 3, d->es ? 0 : 3, validate);
    get_string = (PFNGLGETSTRINGPROC)d->egl.GetProcAddress("glGetString");
    if (d->egl_context != EGL_NO_CONTEXT && get_string &&
        d->egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, d->egl_context))
        renderer = (const char *)get_string(GL_RENDERER);
    if (renderer && (any_renderer || !is_software(renderer))) return 1;
    egl_close(d);
    return 0;
}

/* Every GPU that EGL lists, then Mesa's display without a window system. */
static int egl_open(gl_device *d, int validate, int any_renderer)
{
    static const char *const names[] = { "eglGetProcAddress", "eglQueryString", "eglInitialize", "eglBindAPI",
                                         "eglCreateContext", "eglDestroyContext", "eglMakeCurrent" };
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display;
    PFNEGLQUERYDEVICESEXTPROC query_devices;
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device;
    EGLDeviceEXT devices[16];
    EGLint count = 0, i;
    const char *extensions;
    if (!load_library("libEGL.so.1", names, sizeof names / sizeof *names, &d->egl)) return 0;
    get_display = (PFNEGLGETPLATFORMDISPLAYEXTPROC)d->egl.GetProcAddress("eglGetPlatformDisplayEXT");
    query_devices = (PFNEGLQUERYDEVICESEXTPROC)d->egl.GetProcAddress("eglQueryDevicesEXT");
    query_device = (PFNEGLQUERYDEVICESTRINGEXTPROC)d->egl.GetProcAddress("eglQueryDeviceStringEXT");
    extensions = d->egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!get_display || !extensions) return 0;
    if (query_devices && query_device && strstr(extensions, "EGL_EXT_platform_device"))
        query_devices((EGLint)(sizeof devices / sizeof *devices), devices, &count);
    for (i = 0; i < count; ++i) {
        const char *kind = query_device(devices[i], EGL_EXTENSIONS);
        if (kind && strstr(kind, "EGL_MESA_device_software")) continue; /* spares loading a rasteriser only to refuse it */
        if (egl_try(d, get_display(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL), validate, 0)) return 1;
    }
    return any_renderer && strstr(extensions, "EGL_MESA_platform_surfaceless") &&
           egl_try(d, get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL), validate, 1);
}

static int open_context(gl_device *d, int validate, char *error, size_t error_size)
{
    const char *forced = getenv("HBIL_GL");
    int egl, osmesa;
    if (forced && !*forced) forced = NULL;
    egl = !forced || strcmp(forced, "egl") == 0;
    osmesa = !d->es && (!forced || strcmp(forced, "osmesa") == 0);
    if (d->es) egl = 1;
    if (!egl && !osmesa) {
        snprintf(error, error_size, "HBIL_GL=%s: osmesa or egl, or leave it unset", forced);
        return 0;
    }
    if (egl && egl_open(d, validate, 0)) return 1;
    if (osmesa && osmesa_open(d)) return 1;
    if (egl && egl_open(d, validate, 1)) return 1;
    snprintf(error, error_size, "no OpenGL %s context%s%s: in Debian, install %s", d->es ? "ES 3.1" : "4.3",
             forced && !d->es ? " by HBIL_GL=" : "", forced && !d->es ? forced : "", !egl ? "libosmesa6" : !osmesa ? "libegl1 and libgl1-mesa-dri"
             : "libosmesa6, or libegl1 and libgl1-mesa-dri, or the driver of your GPU");
    return 0;
}

static int make_current(gl_device *d)
{
    if (d->osmesa_context) return d->osmesa.MakeCurrent(d->osmesa_context, d->pixel, GL_UNSIGNED_BYTE, 1, 1) != 0;
    d->egl.BindAPI(d->es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
    d->egl.MakeCurrent(d->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); /* EGL does not see that OSMesa took over */
    return d->egl.MakeCurrent(d->display, EGL_NO_SURFACE, EGL_NO_SURFACE, d->egl_context) != 0;
}

/* get_proc of hbil_gl.h; user is the device. Not static: tests/gpu/test_gl_state.c works on the context of a runner too. */
void *runner_gl_proc(void *user, const char *name);
void *runner_gl_proc(void *user, const char *name)
{
    gl_device *d = (gl_device *)user;
    void (*function)(void);
    void *address = NULL;
    if (d->osmesa_context) return d->osmesa.GetProcAddress(name);
    function = d->egl.GetProcAddress(name);
    memcpy(&address, &function, sizeof address); /* ISO C has no conversion between the two */
    return address;
}

/* ---------------------------------------------------------------------------------------------------------- device */

static void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity, GLsizei length, const GLchar *text,
                                const void *user)
{
    gl_device *d = NULL;
    (void)source, (void)type, (void)length;
    memcpy(&d, &user, sizeof d); /* GL hands our own pointer back as const */
    if (severity == GL_DEBUG_SEVERITY_NOTIFICATION) return;
    d->messages++;
    fprintf(stderr, "gl: message %u: %s\n", id, text);
}

static int load_functions(gl_device *d, char *error, size_t error_size)
{
#define GL_ROW(type, name) { "gl" #name, offsetof(gl_functions, name) },
    static const struct { const char *name; size_t offset; } table[] = { GL_FUNCTIONS(GL_ROW) };
#undef GL_ROW
    size_t i;
    for (i = 0; i < sizeof table / sizeof *table; ++i) {
        void *address = runner_gl_proc(d, table[i].name);
        if (!address && strcmp(table[i].name, "glDebugMessageCallback")) {
            snprintf(error, error_size, "the GL driver has no %s: update it", table[i].name);
            return 0;
        }
        memcpy((char *)&d->gl + table[i].offset, &address, sizeof address);
    }
    return 1;
}

static void gl_close(void *device)
{
    gl_device *d = (gl_device *)device;
    int i;
    if (d->gl.DeleteTextures && make_current(d)) {
        for (i = 0; i < HBIL_MAX_TEXTURES; ++i) d->gl.DeleteTextures(1, &d->images[i].name);
        d->gl.DeleteProgram(d->spread);
        hbil_gl_shutdown(&d->backend);
    }
    if (d->osmesa_context) d->osmesa.DestroyContext(d->osmesa_context);
    if (d->egl_context != EGL_NO_CONTEXT) egl_close(d);
    free(d);
}

/* The context stays current on this thread. */
static void *open_device(int es, int validate, runner_info *about, char *error, size_t error_size)
{
    gl_device *d = (gl_device *)calloc(1, sizeof *d);
    if (!d) {
        snprintf(error, error_size, "out of memory");
        return NULL;
    }
    d->es = es;
    if (!open_context(d, validate, error, error_size)) {
        free(d);
        return NULL;
    }
    if (!load_functions(d, error, error_size)) {
        gl_close(d);
        return NULL;
    }
    if (validate && d->gl.DebugMessageCallback) {
        d->gl.Enable(GL_DEBUG_OUTPUT);
        d->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        d->gl.DebugMessageCallback(on_message, d);
    }
    memset(about, 0, sizeof *about);
    snprintf(about->backend, sizeof about->backend, es ? "gles" : "gl");
    snprintf(about->device, sizeof about->device, "%s", (const char *)d->gl.GetString(GL_RENDERER));
    snprintf(about->driver, sizeof about->driver, "%s, %s", (const char *)d->gl.GetString(GL_VERSION),
             d->osmesa_context ? "OSMesa" : "EGL");
    snprintf(about->timing, sizeof about->timing, es ? "none: OpenGL ES has no GL_TIMESTAMP"
                                                     : "GL_TIMESTAMP after glFinish, around each pass");
    return d;
}

static void *gl_open(int validate, runner_info *about, char *error, size_t error_size)
{
    return open_device(0, validate, about, error, error_size);
}

static void *gles_open(int validate, runner_info *about, char *error, size_t error_size)
{
    return open_device(1, validate, about, error, error_size);
}

static int gl_messages(const void *device)
{
    return ((const gl_device *)device)->messages;
}

/* ------------------------------------------------------------------------------------------------------------- run */

static GLenum target_of(uint16_t dim)
{
    static const GLenum targets[] = { GL_TEXTURE_2D, GL_TEXTURE_2D, GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_2D_ARRAY,
                                      GL_TEXTURE_CUBE_MAP, GL_TEXTURE_3D };
    return targets[dim];
}

/* The texture for plan texture index, bound; made anew if its shape changed. depth: of an array and 3D only. */
static GLuint image_texture(gl_device *d, uint32_t index, GLenum target, int width, int height, int depth, GLenum format)
{
    gl_image *t = &d->images[index];
    if (t->name && t->target == target && t->width == width && t->height == height && t->depth == depth && t->format == format) {
        d->gl.BindTexture(target, t->name);
        return t->name;
    }
    d->gl.DeleteTextures(1, &t->name);
    d->gl.GenTextures(1, &t->name);
    d->gl.BindTexture(target, t->name);
    if (target == GL_TEXTURE_2D_MULTISAMPLE)
        d->gl.TexStorage2DMultisample(target, RUNNER_SAMPLES, format, width, height, GL_TRUE);
    else if (target == GL_TEXTURE_2D_ARRAY || target == GL_TEXTURE_3D)
        d->gl.TexStorage3D(target, 1, format, width, height, depth);
    else
        d->gl.TexStorage2D(target, 1, format, width, height);
    t->target = target;
    t->width = width;
    t->height = height;
    t->depth = depth;
    t->format = format;
    return t->name;
}

static GLenum pixel_format(int channels)
{
    static const GLenum formats[] = { GL_RED, GL_RG, GL_RGB, GL_RGBA };
    return formats[channels - 1];
}

/* 4 for rgba32f, 2 for rg16f, 1 for r32f */
static int format_channels(hbil_format format)
{
    const char *name = hbil_format_name(format);
    return strncmp(name, "rgba", 4) == 0 ? 4 : strncmp(name, "rg", 2) == 0 ? 2 : 1;
}

/* Copies texture `from` into one sample of the bound multisample texture `to` and garbage into the others. A compute shader
 * does it: image stores reach single samples, which uploads do not. */
static int spread(gl_device *d, GLuint from, GLuint to, const image *in, int sample, char *error, size_t error_size)
{
    static const char *const text = "#version 430\n"
        "layout(local_size_x = 8, local_size_y = 8) in;\n"
        "layout(binding = 0) uniform sampler2D u_from;\n"
        "layout(binding = 0, rgba32f) uniform writeonly image2DMS u_to;\n"
        "layout(location = 0) uniform int SAMPLE;\n"
        "layout(location = 1) uniform int SAMPLES;\n"
        "void main() {\n"
        "    ivec2 p = ivec2(gl_GlobalInvocationID.xy);\n"
        "    if (any(greaterThanEqual(p, imageSize(u_to)))) return;\n"
        "    for (int i = 0; i < SAMPLES; ++i) imageStore(u_to, p, i, i == SAMPLE ? texelFetch(u_from, p, 0) : vec4(7e7));\n"
        "}\n";
    GLint limit = 0, linked = 0;
    GLuint shader;
    d->gl.GetIntegerv(GL_MAX_IMAGE_SAMPLES, &limit);
    if (limit < RUNNER_SAMPLES)
        return frame_error(error, error_size, "multisampled inputs: this GL driver stores images of %d samples, %d are needed. "
                           "Set multisample=no, or use the Vulkan backend", limit, RUNNER_SAMPLES);
    if (!d->spread) {
        d->spread = d->gl.CreateProgram();
        shader = d->gl.CreateShader(GL_COMPUTE_SHADER);
        d->gl.ShaderSource(shader, 1, &text, NULL);
        d->gl.CompileShader(shader);
        d->gl.AttachShader(d->spread, shader);
        d->gl.LinkProgram(d->spread);
        d->gl.DeleteShader(shader);
    }
    d->gl.GetProgramiv(d->spread, GL_LINK_STATUS, &linked);
    if (!linked) return frame_error(error, error_size, "multisampled inputs: the GL driver rejects the shader that makes them");
    d->gl.BindTexture(GL_TEXTURE_2D, from);
    d->gl.BindImageTexture(0, to, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA32F);
    d->gl.UseProgram(d->spread);
    d->gl.Uniform1i(0, sample);
    d->gl.Uniform1i(1, RUNNER_SAMPLES);
    d->gl.DispatchCompute((GLuint)(in->width + 7) / 8, (GLuint)(in->height + 7) / 8, 1);
    d->gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    d->gl.UseProgram(0);
    d->gl.BindImageTexture(0, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
    return 1;
}

/* A multisampled input, by way of a plain texture. */
static GLuint fill_samples(gl_device *d, uint32_t index, const image *in, int sample, char *error, size_t error_size)
{
    GLuint plain = 0, to = image_texture(d, index, GL_TEXTURE_2D_MULTISAMPLE, in->width, in->height, 1, GL_RGBA32F);
    int ok;
    d->gl.GenTextures(1, &plain);
    d->gl.BindTexture(GL_TEXTURE_2D, plain);
    d->gl.TexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA32F, in->width, in->height);
    d->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    d->gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    d->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, in->width, in->height, pixel_format(in->channels), GL_FLOAT, in->data);
    ok = spread(d, plain, to, in, sample, error, error_size);
    d->gl.DeleteTextures(1, &plain);
    return ok ? to : 0;
}

/* One channel or four, as the textures have them: ES does not pad. Absent: out of memory. */
static image padded(const image *in)
{
    image out = { 0 };
    size_t i, count = (size_t)in->width * (size_t)in->height * (size_t)image_slices(in);
    int c;
    if (image_make_slices(&out, in->width, in->height, image_slices(in), 4))
        for (i = 0; i < count; ++i)
            for (c = 0; c < 4; ++c) out.data[4 * i + (size_t)c] = c < in->channels ? in->data[i * (size_t)in->channels + (size_t)c] : c == 3;
    return out;
}

static GLuint fill_texture(gl_device *d, const hbil_plan *plan, uint32_t index, const image *in, char *error, size_t error_size)
{
    GLenum target = target_of(plan->textures[index].dim), pixels = pixel_format(in->channels);
    GLenum format = in->channels == 1 ? GL_R32F : GL_RGBA32F;
    size_t slice = (size_t)in->width * (size_t)in->height * (size_t)in->channels;
    int depth = target == GL_TEXTURE_3D ? image_slices(in) : 1, face;
    GLuint name;
    if (target == GL_TEXTURE_2D_MULTISAMPLE && d->es) {
        frame_error(error, error_size, "multisampled inputs: OpenGL ES stores no images of several samples. Set multisample=no, or "
                    "use another backend");
        return 0;
    }
    if (target == GL_TEXTURE_2D_MULTISAMPLE) return fill_samples(d, index, in, (int)plan->config.sample, error, error_size);
    name = image_texture(d, index, target, in->width, in->height, depth, format);
    if (target == GL_TEXTURE_3D)
        d->gl.TexSubImage3D(target, 0, 0, 0, 0, in->width, in->height, depth, pixels, GL_FLOAT, in->data);
    else if (target == GL_TEXTURE_CUBE_MAP)
        for (face = 0; face < 6; ++face)
            d->gl.TexSubImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + (GLenum)face, 0, 0, 0, in->width, in->height, pixels, GL_FLOAT,
                                in->data + (size_t)face * slice);
    else
        d->gl.TexSubImage2D(target, 0, 0, 0, in->width, in->height, pixels, GL_FLOAT, in->data);
    return name;
}

/* The texture of an input with its content; 0: error[] says why. */
static GLuint fill_input(gl_device *d, const hbil_plan *plan, uint32_t index, const image *in, char *error, size_t error_size)
{
    if (d->es && in->channels > 1 && in->channels < 4) {
        image wide = padded(in);
        GLuint made = wide.data ? fill_texture(d, plan, index, &wide, error, error_size) : 0;
        if (!wide.data) frame_error(error, error_size, "out of memory");
        image_free(&wide);
        return made;
    }
    return fill_texture(d, plan, index, in, error, error_size);
}

/* Makes the textures of yours that the plan binds, fills the inputs, makes the output images. GL pads rgb to rgba itself. */
static int set_images(gl_device *d, const hbil_plan *plan, uint32_t width, uint32_t height, const image *inputs, image *outputs,
                      char *error, size_t error_size)
{
    unsigned names[HBIL_MAX_TEXTURES] = { 0 };
    uint32_t i, extent[2];
    for (i = 0; i < plan->texture_count; ++i) {
        const hbil_texture *t = &plan->textures[i];
        if (t->life == HBIL_LIFE_INPUT) {
            frame_error(error, error_size, "input %s: GL makes no texture: out of memory, or the context is lost. Render smaller, or "
                        "open another runner", t->name); /* unless there is a better reason */
            names[i] = fill_input(d, plan, i, &inputs[i], error, error_size);
            if (!names[i]) return 0;
        } else if (t->life == HBIL_LIFE_OUTPUT) {
            hbil_format format = (hbil_format)t->format;
            if (hbil_plan_extent(plan, (int32_t)i, width, height, extent) != HBIL_OK ||
                !image_make_slices(&outputs[i], (int)extent[0], (int)extent[1], t->layers, format_channels(format))) {
                snprintf(error, error_size, "output %s cannot be made for a frame of %u x %u", t->name, width, height);
                return 0;
            }
            names[i] = image_texture(d, i, target_of(t->dim), (int)extent[0], (int)extent[1], t->layers, hbil_gl_format(format));
        }
    }
    if (hbil_gl_resize(&d->backend, width, height, names) == HBIL_GL_OK) return 1;
    snprintf(error, error_size, "%s", d->backend.message);
    return 0;
}

/* ES reads back through framebuffers only, and four channels; so does GL, then. 0: out of memory. */
static int read_outputs(gl_device *d, const hbil_plan *plan, image *outputs)
{
    GLuint framebuffer = 0;
    int ok = 1;
    uint32_t i;
    d->gl.GenFramebuffers(1, &framebuffer);
    d->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    if (plan->config.stage == HBIL_STAGE_COMPUTE) d->gl.MemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT); /* image stores before reads */
    for (i = 0; i < plan->texture_count && ok; ++i) {
        image *out = &outputs[i], all = { 0 };
        size_t k, layer, count = (size_t)out->width * (size_t)out->height, channels = (size_t)out->channels;
        if (plan->textures[i].life != HBIL_LIFE_OUTPUT) continue;
        ok = image_make(&all, out->width, out->height, 4);
        for (layer = 0; layer < plan->textures[i].layers && ok; ++layer) {
            if (plan->textures[i].dim == HBIL_DIM_2D_ARRAY)
                d->gl.FramebufferTextureLayer(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, d->images[i].name, 0, (GLint)layer);
            else
                d->gl.FramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, d->images[i].name, 0);
            d->gl.ReadPixels(0, 0, out->width, out->height, GL_RGBA, GL_FLOAT, all.data);
            for (k = 0; k < count; ++k) memcpy(out->data + (layer * count + k) * channels, all.data + 4 * k, channels * sizeof(float));
        }
        image_free(&all);
    }
    d->gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    d->gl.DeleteFramebuffers(1, &framebuffer);
    return ok;
}

/* hbil_gl.h emits by itself, so the program is replaced once it is made. */
static int set_own_text(gl_device *d, const hbil_plan *plan)
{
    const int32_t pass = d->own_text ? hbil_plan_pass(plan, d->own_pass) : -1;
    if (pass < 0) return 1;
    d->gl.DeleteProgram(d->backend.program[pass]);
    if (hbil_gl__compile(&d->backend, (uint32_t)pass, d->own_text) == HBIL_GL_OK) return 1;
    d->backend.plan.hash = ~plan->hash; /* the next run begins anew */
    return 0;
}

static int set_plan(gl_device *d, const hbil_plan *plan)
{
    hbil_gl_info info = { 0 };
    if (memcmp(&d->backend.plan, plan, sizeof *plan) == 0) return 1;
    hbil_gl_shutdown(&d->backend);
    info.plan = plan;
    info.get_proc = runner_gl_proc;
    info.user = d;
    info.scratch = d->scratch;
    info.scratch_size = sizeof d->scratch;
    info.hook = d->hook;
    info.timings = !d->es;
    return hbil_gl_init(&info, &d->backend) == HBIL_GL_OK && set_own_text(d, plan);
}

/* Programs hold the old text: they go. */
static void gl_set_hook(void *device, const char *text)
{
    gl_device *d = (gl_device *)device;
    d->hook = text;
    if (make_current(d)) hbil_gl_shutdown(&d->backend);
}

static void gl_set_text(void *device, const char *pass, const char *text)
{
    gl_device *d = (gl_device *)device;
    d->own_pass = pass;
    d->own_text = text;
    if (make_current(d)) hbil_gl_shutdown(&d->backend);
}

/* After a run that failed: the next one begins without history, on textures of its own, with no error pending. */
static int recover(gl_device *d)
{
    int i;
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) d->gl.DeleteTextures(1, &d->images[i].name);
    memset(d->images, 0, sizeof d->images);
    d->gl.DeleteProgram(d->spread); /* it may be one that does not link */
    d->spread = 0;
    hbil_gl_shutdown(&d->backend);
    for (i = 0; i < 16 && d->gl.GetError() != GL_NO_ERROR; ++i) {} /* a lost context would go on saying so */
    return 0;
}

static int run(gl_device *d, const hbil_plan *plan, const hbil_frame *frame, const uint32_t size[2],
               const image inputs[HBIL_MAX_TEXTURES], image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error,
               size_t error_size)
{
    GLenum code;
    int i;
    if (!set_plan(d, plan)) {
        snprintf(error, error_size, "%s", d->backend.message);
        return 0;
    }
    if (!set_images(d, plan, size[0], size[1], inputs, outputs, error, error_size)) return 0;
    for (i = 0; i < repeat; ++i) {
        if (hbil_gl_run(&d->backend, frame) != HBIL_GL_OK) {
            snprintf(error, error_size, "%s", d->backend.message);
            return 0;
        }
        if (ms && !d->es) hbil_gl_timings(&d->backend, ms + (size_t)i * plan->pass_count);
        else if (ms) memset(ms + (size_t)i * plan->pass_count, 0, plan->pass_count * sizeof *ms);
    }
    if (!read_outputs(d, plan, outputs)) return frame_error(error, error_size, "out of memory");
    code = d->gl.GetError();
    if (code == GL_NO_ERROR) return 1;
    return frame_error(error, error_size, "GL error 0x%04x%s", code, code == GL_OUT_OF_MEMORY
                       ? ": out of memory. Render smaller, or free some" : code == GL_CONTEXT_LOST
                       ? ": the context is lost. Close this runner and open another one"
                       : ": open the runner with validation to see the message");
}

static int gl_run(void *device, const hbil_plan *plan, const hbil_frame *frame, const uint32_t size[2],
                  const image inputs[HBIL_MAX_TEXTURES], image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    gl_device *d = (gl_device *)device;
    if (!make_current(d))
        return frame_error(error, error_size, "the GL context cannot be made current: use a runner on one thread at a time");
    return run(d, plan, frame, size, inputs, outputs, repeat, ms, error, error_size) || recover(d);
}

const runner_ops runner_gl = { gl_open, gl_close, gl_messages, gl_set_hook, gl_set_text, NULL, gl_run };
const runner_ops runner_gles = { gles_open, gl_close, gl_messages, gl_set_hook, gl_set_text, NULL, gl_run };
