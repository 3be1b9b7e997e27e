/* runner_gl.c - the OpenGL side of runner.h: makes a context without a window, uploads, runs hbil_gl.h, reads back.
 *
 * The context comes from EGL if that finds a GPU, else from OSMesa, else from EGL's software rasteriser; HBIL_GL=osmesa or
 * HBIL_GL=egl forces one. Both libraries are opened at run time, so a build needs neither. */
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
    X(PFNGLBINDTEXTUREPROC, BindTexture)                   \
    X(PFNGLDEBUGMESSAGECALLBACKPROC, DebugMessageCallback) \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)             \
    X(PFNGLENABLEPROC, Enable)                             \
    X(PFNGLGENTEXTURESPROC, GenTextures)                   \
    X(PFNGLGETERRORPROC, GetError)                         \
    X(PFNGLGETSTRINGPROC, GetString)                       \
    X(PFNGLGETTEXIMAGEPROC, GetTexImage)                   \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)               \
    X(PFNGLTEXSTORAGE2DPROC, TexStorage2D)                 \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)
#define GL_MEMBER(type, name) type name;
typedef struct gl_functions { GL_FUNCTIONS(GL_MEMBER) } gl_functions;

/* The texture of an input or output, kept from call to call while its shape is the same. */
typedef struct gl_image {
    GLuint name;
    GLenum format;
    int    width, height;
} gl_image;

typedef struct gl_device {
    osmesa_functions osmesa;
    egl_functions    egl;
    void            *osmesa_context;    /* this one or the next two */
    EGLDisplay       display;
    EGLContext       egl_context;
    unsigned char    pixel[4];          /* OSMesa draws here; nothing is drawn */
    gl_functions     gl;
    hbil_gl          backend;           /* zeroed while there is none */
    gl_image         images[HBIL_MAX_TEXTURES];
    int              messages;
    char             scratch[HBIL_GLSL_MAX];
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
    if (!load_library("libOSMesa.so.8", names, sizeof names / sizeof *names, &d->osmesa)) return 0;
    d->osmesa_context = d->osmesa.CreateContextAttribs(attributes, NULL);
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

/* A context without a surface on one display; any_renderer 0: only if a GPU draws it. */
static int egl_try(gl_device *d, EGLDisplay display, int validate, int any_renderer)
{
    const EGLint attributes[] = { EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_CONTEXT_OPENGL_DEBUG, validate ? EGL_TRUE : EGL_FALSE,
                                  EGL_NONE };
    PFNGLGETSTRINGPROC get_string;
    const char *renderer = NULL;
    if (display == EGL_NO_DISPLAY || !d->egl.Initialize(display, NULL, NULL)) return 0;
    d->display = display;
    d->egl.BindAPI(EGL_OPENGL_API);
    d->egl_context = d->egl.CreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
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
    osmesa = !forced || strcmp(forced, "osmesa") == 0;
    if (!egl && !osmesa) {
        snprintf(error, error_size, "HBIL_GL=%s: osmesa or egl, or leave it unset", forced);
        return 0;
    }
    if (egl && egl_open(d, validate, 0)) return 1;
    if (osmesa && osmesa_open(d)) return 1;
    if (egl && egl_open(d, validate, 1)) return 1;
    snprintf(error, error_size, "no OpenGL 4.3 context%s%s: in Debian, install %s", forced ? " by HBIL_GL=" : "",
             forced ? forced : "", !egl ? "libosmesa6" : !osmesa ? "libegl1 and libgl1-mesa-dri"
             : "libosmesa6, or libegl1 and libgl1-mesa-dri, or the driver of your GPU");
    return 0;
}

static int make_current(gl_device *d)
{
    if (d->osmesa_context) return d->osmesa.MakeCurrent(d->osmesa_context, d->pixel, GL_UNSIGNED_BYTE, 1, 1) != 0;
    d->egl.BindAPI(EGL_OPENGL_API);
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
        if (!address) {
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
        hbil_gl_shutdown(&d->backend);
    }
    if (d->osmesa_context) d->osmesa.DestroyContext(d->osmesa_context);
    if (d->egl_context != EGL_NO_CONTEXT) egl_close(d);
    free(d);
}

/* The context stays current on this thread. */
static void *gl_open(int validate, runner_info *about, char *error, size_t error_size)
{
    gl_device *d = (gl_device *)calloc(1, sizeof *d);
    if (!d) {
        snprintf(error, error_size, "out of memory");
        return NULL;
    }
    if (!open_context(d, validate, error, error_size)) {
        free(d);
        return NULL;
    }
    if (!load_functions(d, error, error_size)) {
        gl_close(d);
        return NULL;
    }
    if (validate) {
        d->gl.Enable(GL_DEBUG_OUTPUT);
        d->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
        d->gl.DebugMessageCallback(on_message, d);
    }
    memset(about, 0, sizeof *about);
    snprintf(about->backend, sizeof about->backend, "gl");
    snprintf(about->device, sizeof about->device, "%s", (const char *)d->gl.GetString(GL_RENDERER));
    snprintf(about->driver, sizeof about->driver, "%s, %s", (const char *)d->gl.GetString(GL_VERSION),
             d->osmesa_context ? "OSMesa" : "EGL");
    snprintf(about->timing, sizeof about->timing, "GL_TIMESTAMP after glFinish, around each pass");
    return d;
}

static int gl_messages(const void *device)
{
    return ((const gl_device *)device)->messages;
}

/* ------------------------------------------------------------------------------------------------------------- run */

/* The texture for plan texture index, bound; made anew if its shape changed. */
static GLuint image_texture(gl_device *d, uint32_t index, int width, int height, GLenum format)
{
    gl_image *t = &d->images[index];
    if (t->name && t->width == width && t->height == height && t->format == format) {
        d->gl.BindTexture(GL_TEXTURE_2D, t->name);
        return t->name;
    }
    d->gl.DeleteTextures(1, &t->name);
    d->gl.GenTextures(1, &t->name);
    d->gl.BindTexture(GL_TEXTURE_2D, t->name);
    d->gl.TexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
    t->width = width;
    t->height = height;
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

/* Makes the textures of yours that the plan binds, fills the inputs, makes the output images. GL pads rgb to rgba itself. */
static int set_images(gl_device *d, const hbil_plan *plan, uint32_t width, uint32_t height, const image *inputs, image *outputs,
                      char *error, size_t error_size)
{
    unsigned names[HBIL_MAX_TEXTURES] = { 0 };
    uint32_t i, extent[2];
    for (i = 0; i < plan->texture_count; ++i) {
        const hbil_texture *t = &plan->textures[i];
        const image *in = &inputs[i];
        if (t->life == HBIL_LIFE_INPUT) {
            names[i] = image_texture(d, i, in->width, in->height, in->channels == 1 ? GL_R32F : GL_RGBA32F);
            d->gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, in->width, in->height, pixel_format(in->channels), GL_FLOAT, in->data);
        } else if (t->life == HBIL_LIFE_OUTPUT) {
            hbil_format format = (hbil_format)t->format;
            if (hbil_plan_extent(plan, (int32_t)i, width, height, extent) != HBIL_OK ||
                !image_make(&outputs[i], (int)extent[0], (int)extent[1], format_channels(format))) {
                snprintf(error, error_size, "output %s cannot be made for a frame of %u x %u", t->name, width, height);
                return 0;
            }
            names[i] = image_texture(d, i, (int)extent[0], (int)extent[1], hbil_gl_format(format));
        }
    }
    if (hbil_gl_resize(&d->backend, width, height, names) == HBIL_GL_OK) return 1;
    snprintf(error, error_size, "%s", d->backend.message);
    return 0;
}

static void read_outputs(gl_device *d, const hbil_plan *plan, image *outputs)
{
    uint32_t i;
    d->gl.MemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT); /* image stores before glGetTexImage */
    for (i = 0; i < plan->texture_count; ++i)
        if (plan->textures[i].life == HBIL_LIFE_OUTPUT) {
            d->gl.BindTexture(GL_TEXTURE_2D, d->images[i].name);
            d->gl.GetTexImage(GL_TEXTURE_2D, 0, pixel_format(outputs[i].channels), GL_FLOAT, outputs[i].data);
        }
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
    info.timings = 1;
    return hbil_gl_init(&info, &d->backend) == HBIL_GL_OK;
}

static int gl_run(void *device, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
                  image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    gl_device *d = (gl_device *)device;
    uint32_t width = frame->width ? frame->width : (uint32_t)plan->config.width;
    uint32_t height = frame->height ? frame->height : (uint32_t)plan->config.height;
    GLenum code;
    int i;
    if (!make_current(d)) {
        snprintf(error, error_size, "the GL context cannot be made current: use a runner on one thread at a time");
        return 0;
    }
    if (!set_plan(d, plan)) {
        snprintf(error, error_size, "%s", d->backend.message);
        return 0;
    }
    if (!set_images(d, plan, width, height, inputs, outputs, error, error_size)) return 0;
    for (i = 0; i < repeat; ++i) {
        if (hbil_gl_run(&d->backend, frame) != HBIL_GL_OK) {
            snprintf(error, error_size, "%s", d->backend.message);
            return 0;
        }
        if (ms) hbil_gl_timings(&d->backend, ms + (size_t)i * plan->pass_count);
    }
    read_outputs(d, plan, outputs);
    code = d->gl.GetError();
    if (code != GL_NO_ERROR) {
        snprintf(error, error_size, "GL error 0x%04x: open the runner with validation to see the message", code);
        return 0;
    }
    return 1;
}

const runner_ops runner_gl = { gl_open, gl_close, gl_messages, gl_run };
