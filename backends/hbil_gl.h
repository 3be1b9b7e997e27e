/* hbil_gl.h - runs a plan of hbil.h on OpenGL 4.3 or ES 3.1 or later, with stage=fragment on OpenGL 3.3 or ES 3.0: three calls to set
 * up, one call a frame.
 *
 * May be used as it is. In exactly one C99 or C++11 file, define HBIL_GL_IMPLEMENTATION before the include; the
 * implementation of hbil.h has to be in the program too. Includes no GL header and links no GL library: every function comes
 * through your callback, so glad, GLEW, epoxy, SDL, GLFW, EGL, GLX, WGL or OSMesa may have made the context, and any GL
 * header may stand in the same file before or after this one.
 *
 * Features
 *   [x] Any plan with target=gl or gles, stage=compute or fragment: inputs, outputs, transient and history textures (copies, age)
 *   [x] 2D, multisampled, array, cube and 3D textures; your function for environment=hook
 *   [x] Barriers: glMemoryBarrier exactly where the plan says, with the narrowest bits
 *   [x] Your textures are checked once, on resize: missing, wrong target, too small, wrong format; the message names the fix
 *   [x] No heap, no thread, no global: the context lives in your memory (7 KB), text passes through your scratch buffer
 *   [x] Puts back all GL state that it touches (list below); tests/gpu/test_gl_state.c sets each item and compares
 *   [x] Milliseconds per pass, also on software rasterisers; not on ES, which has no time stamps
 *   [x] Labels on programs and textures, for RenderDoc and debug output
 *   [x] The first frame after a resize begins without history
 *   [x] Frames smaller than the textures: resize once to the largest, then any frame.width and height up to it
 *   [ ] Contexts older than 4.3 with ARB_compute_shader and friends
 *   [ ] Mip chains: no plan has them yet
 *   [ ] Transient textures that share memory
 *   [ ] Program binaries: cache them around this file, or let the driver do it
 *
 * Who owns what
 *   | thing                         | made by        | freed by                                  |
 *   | context, get_proc, its user   | you            | you; current in every call of this file   |
 *   | hbil_gl (the struct)          | you            | you, after hbil_gl_shutdown               |
 *   | scratch buffer                | you            | you, right after hbil_gl_init             |
 *   | plan                          | you            | you, right after hbil_gl_init: it is copied |
 *   | text of your hook             | you            | you, right after hbil_gl_init             |
 *   | resources that it reads       | you            | you, after hbil_gl_shutdown               |
 *   | INPUT and OUTPUT textures     | you            | you, after the next resize or shutdown    |
 *   | TRANSIENT, HISTORY textures   | hbil_gl_resize | hbil_gl_resize, hbil_gl_shutdown          |
 *   | a program per pass            | hbil_gl_init   | hbil_gl_shutdown                          |
 *   | two samplers, one buffer      | hbil_gl_init   | hbil_gl_shutdown                          |
 *   | stage=fragment: a framebuffer per pass, a vertex array | hbil_gl_init | hbil_gl_shutdown     |
 *
 * State put back
 *   hbil_gl_init, hbil_gl_shutdown   touch none; with stage=fragment init GL_CURRENT_PROGRAM
 *   hbil_gl_resize                   of the active unit, for each target that the plan has: GL_TEXTURE_BINDING_<target>
 *                                    stage=fragment: GL_DRAW_FRAMEBUFFER_BINDING, GL_PIXEL_UNPACK_BUFFER_BINDING
 *   hbil_gl_run                      GL_CURRENT_PROGRAM
 *                                    GL_ACTIVE_TEXTURE
 *                                    of each texture unit that the plan uses: GL_SAMPLER_BINDING, and for each target that
 *                                    it uses there: GL_TEXTURE_BINDING_<target>
 *                                    of each image unit that the plan uses: GL_IMAGE_BINDING_NAME, _LEVEL, _LAYERED, _LAYER,
 *                                    _ACCESS, _FORMAT
 *                                    of the uniform binding that the plan uses: GL_UNIFORM_BUFFER_BINDING, _START, _SIZE
 *                                    GL_UNIFORM_BUFFER_BINDING (the generic one)
 *                                    GL_TEXTURE_CUBE_MAP_SEAMLESS, on while a plan with a cube map runs
 *                                    stage=fragment: GL_DRAW_FRAMEBUFFER_BINDING, GL_VERTEX_ARRAY_BINDING, GL_VIEWPORT,
 *                                    GL_POLYGON_MODE, GL_BLEND and GL_COLOR_WRITEMASK of eight targets (ES: of all at once),
 *                                    GL_DEPTH_TEST, GL_STENCIL_TEST, GL_SCISSOR_TEST, GL_CULL_FACE, GL_RASTERIZER_DISCARD,
 *                                    GL_COLOR_LOGIC_OP, GL_CLIP_DISTANCE0 to 7. Of viewport arrays (OpenGL 4.1) the first is
 *                                    saved, and stands in all afterwards
 *   A current program that you have already deleted cannot be put back, since GL frees it when it stops being current: 0 is
 *   current afterwards. Call hbil_gl_run outside transform feedback and conditional rendering, which GL applies to it too.
 *   Faults: what fails says so by its result, and by hbil_gl.message what failed and what to do. After a failed init nothing is
 *   left; after a failed resize hbil_gl_run is refused until one succeeds. A context that is lost, or not current on the calling
 *   thread, answers no question: hbil_gl_resize and hbil_gl_run ask one, and return E_CONTEXT. What glGetGraphicsResetStatus would
 *   say stays for you. hbil_gl_shutdown then only forgets, since GL has freed all with the context; begin anew on a new one.
 *   Threads: one hbil_gl on one context, that is current on one thread; any number of such at once.
 *   glGetError is never called while all goes well, so errors of yours stay pending. Where a GL call of ours fails (a texture
 *   of another target, no memory), its error is taken off again and the message shows it; one of yours that was pending then goes
 *   with it, since GL keeps the first only.
 *
 * Integration in five steps
 *   1. Plan: hbil_config c = {0}; c.target = HBIL_TARGET_GL; hbil_plan_build(&c, &plan, &diags);
 *      Or HBIL_TARGET_GLES; and c.stage = HBIL_STAGE_FRAGMENT where there are no compute shaders.
 *   2. With your context current:
 *          static void *get_proc(void *user, const char *name) { (void)user; return SDL_GL_GetProcAddress(name); }
 *          static char scratch[HBIL_GLSL_MAX];
 *          hbil_gl_info info = {0};
 *          info.plan = &plan; info.get_proc = get_proc; info.scratch = scratch; info.scratch_size = sizeof scratch;
 *          if (hbil_gl_init(&info, &gl) != HBIL_GL_OK) puts(gl.message);
 *      With environment=hook: info.hook = your GLSL text, see hbil_emit_glsl_hook. It may declare samplers, images and blocks
 *      on units that no pass of the plan uses (take the highest); bind them before hbil_gl_run, which leaves them alone.
 *      Messages of the driver about it point into source 1, at its own lines (Mesa says source 0 in some, with that line).
 *   3. When the size or a texture of yours changes: put your texture names where the plan wants them, then resize. INPUT: a
 *      texture with level 0 of a float, normalised or depth format. OUTPUT: of exactly hbil_gl_format(plan.textures[i].format).
 *      By hbil_texture.dim, at least as large as the frame (larger is fine, texel 0,0 is the corner), read by texelFetch:
 *          2D              GL_TEXTURE_2D
 *          2D_MULTISAMPLE  GL_TEXTURE_2D_MULTISAMPLE with more samples than plan.config.sample
 *          2D_ARRAY        GL_TEXTURE_2D_ARRAY of at least hbil_texture.layers layers; written as a whole
 *      and of any size, read with a linear filter at level 0, clamped to the edge:
 *          CUBE            GL_TEXTURE_CUBE_MAP
 *          3D              GL_TEXTURE_3D
 *          unsigned textures[HBIL_MAX_TEXTURES] = {0};
 *          textures[hbil_plan_texture(&plan, "depth")] = my_depth; ...
 *          hbil_gl_resize(&gl, width, height, textures);
 *      With an unchanged size this keeps our textures, so it is cheap enough to swap yours every frame.
 *   4. Each frame, after your G-buffer: hbil_gl_run(&gl, &frame);   If you wrote inputs by image stores, glMemoryBarrier first.
 *   5. Before you read outputs: glMemoryBarrier with the bit of your next use, mostly GL_TEXTURE_FETCH_BARRIER_BIT. At the end:
 *      hbil_gl_shutdown(&gl);
 *
 * Changelog (API: your code may need a change; EMIT; FIX; NEW)
 *   2026-11-28  NEW   a lost context, objects that cannot be made and a uniform block without memory are reported; targets of
 *                     stage=fragment are counted against what the driver has
 *   2026-11-25  NEW   target=gles; stage=fragment; outputs on ES have to be made by glTexStorage, which is checked
 *   2026-11-25  NEW   frames smaller than the textures; the first frame after a resize has no history
 *   2026-11-24  NEW   multisampled, array, cube and 3D textures; hook
 *   2026-11-22  NEW   first version
 */

#ifndef HBIL_GL_H
#define HBIL_GL_H

#ifndef HBIL_H
#include "hbil.h"
#endif

#ifndef HBIL_GL_API
#define HBIL_GL_API extern
#endif

/* GL's calling convention. Differs from C's on 32-bit Windows only. */
#if defined(_WIN32) && !defined(_WIN64)
#define HBIL_GL_CALL __stdcall
#else
#define HBIL_GL_CALL
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define HBIL_GL_MAX_COPIES 4  /* of one HISTORY texture */
#define HBIL_GL_MAX_UNITS  16 /* texture units and image units 0..15 */

#define HBIL_GL__DIMS (HBIL_DIM_3D + 1)

/* Result of every call that can fail; hbil_gl.message then says what to do. This list makes the enum and the names. */
#define HBIL_GL_RESULTS(X)                                                  \
    X(OK,         "success")                                                \
    X(E_ARG,      "null pointer, number out of range, or call out of order") \
    X(E_CONTEXT,  "no current context, or of another kind or version than the plan wants") \
    X(E_FUNCTION, "get_proc does not know a GL function")                   \
    X(E_PLAN,     "plan is for another target or exceeds a limit")          \
    X(E_SPACE,    "scratch buffer too small")                               \
    X(E_COMPILE,  "the driver rejects a shader")                            \
    X(E_TEXTURE,  "a texture of yours is missing, too small or of the wrong kind") \
    X(E_MEMORY,   "a GL object of ours cannot be made")                     \
    X(E_FRAME,    "frame does not fit the plan or the last resize")
#define HBIL_GL__RESULT_ENUM(name, text) HBIL_GL_##name,
typedef enum hbil_gl_result { HBIL_GL_RESULTS(HBIL_GL__RESULT_ENUM) HBIL_GL_RESULT_COUNT } hbil_gl_result;

/* GL functions in use, named as WebGL names them: no GL header has macros of these names. First when they are needed: always; for
 * compute shaders; to draw (stage=fragment); to draw on desktop GL; or OPTIONAL, used where they are there. */
#define HBIL_GL__FUNCTIONS(X)                                                                                               \
    X(ALWAYS,   void,           activeTexture,            "glActiveTexture",           (unsigned unit))                     \
    X(ALWAYS,   void,           attachShader,             "glAttachShader",            (unsigned program, unsigned shader)) \
    X(ALWAYS,   void,           bindBuffer,               "glBindBuffer",              (unsigned target, unsigned buffer))  \
    X(ALWAYS,   void,           bindBufferBase,           "glBindBufferBase",          (unsigned target, unsigned index,    \
                                                                                     unsigned buffer))                      \
    X(ALWAYS,   void,           bindBufferRange,          "glBindBufferRange",         (unsigned target, unsigned index,    \
                                                                                     unsigned buffer, ptrdiff_t offset,     \
                                                                                     ptrdiff_t size))                       \
    X(DRAW,     void,           bindFramebuffer,          "glBindFramebuffer",         (unsigned target,                    \
                                                                                     unsigned framebuffer))                 \
    X(COMPUTE,  void,           bindImageTexture,         "glBindImageTexture",        (unsigned unit, unsigned texture,    \
                                                                                     int level, unsigned char layered,      \
                                                                                     int layer, unsigned access,            \
                                                                                     unsigned format))                      \
    X(ALWAYS,   void,           bindSampler,              "glBindSampler",             (unsigned unit, unsigned sampler))   \
    X(ALWAYS,   void,           bindTexture,              "glBindTexture",             (unsigned target, unsigned texture)) \
    X(DRAW,     void,           bindVertexArray,          "glBindVertexArray",         (unsigned array))                    \
    X(ALWAYS,   void,           bufferData,               "glBufferData",              (unsigned target, ptrdiff_t size,    \
                                                                                     const void *data, unsigned usage))     \
    X(DRAW,     unsigned,       checkFramebufferStatus,   "glCheckFramebufferStatus",  (unsigned target))                   \
    X(DRAW,     void,           colorMask,                "glColorMask",               (unsigned char r, unsigned char g,   \
                                                                                     unsigned char b, unsigned char a))     \
    X(DESKTOP,  void,           colorMaski,               "glColorMaski",              (unsigned buffer, unsigned char r,   \
                                                                                     unsigned char g, unsigned char b,      \
                                                                                     unsigned char a))                      \
    X(ALWAYS,   void,           compileShader,            "glCompileShader",           (unsigned shader))                   \
    X(ALWAYS,   unsigned,       createProgram,            "glCreateProgram",           (void))                              \
    X(ALWAYS,   unsigned,       createShader,             "glCreateShader",            (unsigned type))                     \
    X(ALWAYS,   void,           deleteBuffers,            "glDeleteBuffers",           (int count, const unsigned *buffers))\
    X(DRAW,     void,           deleteFramebuffers,       "glDeleteFramebuffers",      (int count,                          \
                                                                                     const unsigned *framebuffers))         \
    X(ALWAYS,   void,           deleteProgram,            "glDeleteProgram",           (unsigned program))                  \
    X(ALWAYS,   void,           deleteSamplers,           "glDeleteSamplers",          (int count,                          \
                                                                                     const unsigned *samplers))             \
    X(ALWAYS,   void,           deleteShader,             "glDeleteShader",            (unsigned shader))                   \
    X(ALWAYS,   void,           deleteTextures,           "glDeleteTextures",          (int count,                          \
                                                                                     const unsigned *textures))             \
    X(DRAW,     void,           deleteVertexArrays,       "glDeleteVertexArrays",      (int count, const unsigned *arrays)) \
    X(ALWAYS,   void,           disable,                  "glDisable",                 (unsigned capability))               \
    X(DESKTOP,  void,           disablei,                 "glDisablei",                (unsigned capability,                \
                                                                                     unsigned index))                       \
    X(COMPUTE,  void,           dispatchCompute,          "glDispatchCompute",         (unsigned x, unsigned y, unsigned z))\
    X(DRAW,     void,           drawArrays,               "glDrawArrays",              (unsigned mode, int first,           \
                                                                                     int count))                            \
    X(DRAW,     void,           drawBuffers,              "glDrawBuffers",             (int count, const unsigned *buffers))\
    X(ALWAYS,   void,           enable,                   "glEnable",                  (unsigned capability))               \
    X(DESKTOP,  void,           enablei,                  "glEnablei",                 (unsigned capability,                \
                                                                                     unsigned index))                       \
    X(ALWAYS,   void,           finish,                   "glFinish",                  (void))                              \
    X(DRAW,     void,           framebufferTexture2D,     "glFramebufferTexture2D",    (unsigned target,                    \
                                                                                     unsigned attachment,                   \
                                                                                     unsigned texture_target,               \
                                                                                     unsigned texture, int level))          \
    X(DRAW,     void,           framebufferTextureLayer,  "glFramebufferTextureLayer", (unsigned target,                    \
                                                                                     unsigned attachment, unsigned texture, \
                                                                                     int level, int layer))                 \
    X(ALWAYS,   void,           genBuffers,               "glGenBuffers",              (int count, unsigned *buffers))      \
    X(DRAW,     void,           genFramebuffers,          "glGenFramebuffers",         (int count, unsigned *framebuffers)) \
    X(ALWAYS,   void,           genSamplers,              "glGenSamplers",             (int count, unsigned *samplers))     \
    X(ALWAYS,   void,           genTextures,              "glGenTextures",             (int count, unsigned *textures))     \
    X(DRAW,     void,           genVertexArrays,          "glGenVertexArrays",         (int count, unsigned *arrays))       \
    X(ALWAYS,   void,           getBufferParameteriv,     "glGetBufferParameteriv",    (unsigned target, unsigned name,     \
                                                                                     int *value))                           \
    X(DESKTOP,  void,           getBooleani_v,            "glGetBooleani_v",           (unsigned name, unsigned index,      \
                                                                                     unsigned char *values))                \
    X(DRAW,     void,           getBooleanv,              "glGetBooleanv",             (unsigned name,                      \
                                                                                     unsigned char *values))                \
    X(ALWAYS,   unsigned,       getError,                 "glGetError",                (void))                              \
    X(ALWAYS,   void,           getInteger64i_v,          "glGetInteger64i_v",         (unsigned name, unsigned index,      \
                                                                                     int64_t *value))                       \
    X(ALWAYS,   void,           getInteger64v,            "glGetInteger64v",           (unsigned name, int64_t *value))     \
    X(ALWAYS,   void,           getIntegeri_v,            "glGetIntegeri_v",           (unsigned name, unsigned index,      \
                                                                                     int *value))                           \
    X(ALWAYS,   void,           getIntegerv,              "glGetIntegerv",             (unsigned name, int *value))         \
    X(ALWAYS,   void,           getProgramInfoLog,        "glGetProgramInfoLog",       (unsigned program, int size,         \
                                                                                     int *length, char *log))               \
    X(ALWAYS,   void,           getProgramiv,             "glGetProgramiv",            (unsigned program, unsigned name,    \
                                                                                     int *value))                           \
    X(ALWAYS,   void,           getShaderInfoLog,         "glGetShaderInfoLog",        (unsigned shader, int size,          \
                                                                                     int *length, char *log))               \
    X(ALWAYS,   void,           getShaderiv,              "glGetShaderiv",             (unsigned shader, unsigned name,     \
                                                                                     int *value))                           \
    X(ALWAYS,   const unsigned char *, getString, "glGetString", (unsigned name))                                           \
    X(OPTIONAL, void,           getTexLevelParameteriv,   "glGetTexLevelParameteriv",  (unsigned target, int level,         \
                                                                                     unsigned name, int *value))            \
    X(ALWAYS,   void,           getTexParameteriv,        "glGetTexParameteriv",       (unsigned target, unsigned name,     \
                                                                                     int *value))                           \
    X(DRAW,     unsigned,       getUniformBlockIndex,     "glGetUniformBlockIndex",    (unsigned program, const char *name))\
    X(DRAW,     int,            getUniformLocation,       "glGetUniformLocation",      (unsigned program, const char *name))\
    X(ALWAYS,   unsigned char,  isEnabled,                "glIsEnabled",               (unsigned capability))               \
    X(DESKTOP,  unsigned char,  isEnabledi,               "glIsEnabledi",              (unsigned capability,                \
                                                                                     unsigned index))                       \
    X(ALWAYS,   unsigned char,  isProgram,                "glIsProgram",               (unsigned program))                  \
    X(ALWAYS,   unsigned char,  isTexture,                "glIsTexture",               (unsigned texture))                  \
    X(ALWAYS,   void,           linkProgram,              "glLinkProgram",             (unsigned program))                  \
    X(COMPUTE,  void,           memoryBarrier,            "glMemoryBarrier",           (unsigned bits))                     \
    X(OPTIONAL, void,           objectLabel,              "glObjectLabel",             (unsigned kind, unsigned name,       \
                                                                                     int length, const char *label))        \
    X(DESKTOP,  void,           polygonMode,              "glPolygonMode",             (unsigned face, unsigned mode))      \
    X(ALWAYS,   void,           samplerParameteri,        "glSamplerParameteri",       (unsigned sampler, unsigned name,    \
                                                                                     int value))                            \
    X(ALWAYS,   void,           shaderSource,             "glShaderSource",            (unsigned shader, int count,         \
                                                                                     const char *const *text,               \
                                                                                     const int *lengths))                   \
    X(DRAW,     void,           texImage2D,               "glTexImage2D",              (unsigned target, int level,         \
                                                                                     int internal, int width, int height,   \
                                                                                     int border, unsigned format,           \
                                                                                     unsigned type, const void *texels))    \
    X(DRAW,     void,           texImage3D,               "glTexImage3D",              (unsigned target, int level,         \
                                                                                     int internal, int width, int height,   \
                                                                                     int depth, int border,                 \
                                                                                     unsigned format, unsigned type,        \
                                                                                     const void *texels))                   \
    X(COMPUTE,  void,           texStorage2D,             "glTexStorage2D",            (unsigned target, int levels,        \
                                                                                     unsigned format, int width,            \
                                                                                     int height))                           \
    X(COMPUTE,  void,           texStorage3D,             "glTexStorage3D",            (unsigned target, int levels,        \
                                                                                     unsigned format, int width,            \
                                                                                     int height, int depth))                \
    X(DRAW,     void,           uniform1i,                "glUniform1i",               (int location, int value))           \
    X(DRAW,     void,           uniformBlockBinding,      "glUniformBlockBinding",     (unsigned program, unsigned block,   \
                                                                                     unsigned binding))                     \
    X(ALWAYS,   void,           useProgram,               "glUseProgram",              (unsigned program))                  \
    X(DRAW,     void,           viewport,                 "glViewport",                (int x, int y, int width,            \
                                                                                     int height))
#define HBIL_GL__MEMBER(when, type, member, name, args) type (HBIL_GL_CALL *member) args;
typedef struct hbil_gl_functions { HBIL_GL__FUNCTIONS(HBIL_GL__MEMBER) } hbil_gl_functions;

/* What hbil_gl_init needs. Zero every member first. */
typedef struct hbil_gl_info {
    const hbil_plan *plan;      /* built with target=gl */
    void *(*get_proc)(void *user, const char *name); /* address of a GL function of the current context, NULL: unknown */
    void  *user;                /* handed to get_proc */
    char  *scratch;             /* for the text of one pass at a time; HBIL_GLSL_MAX bytes, and those of hook, are enough */
    size_t scratch_size;
    const char *hook;           /* environment=hook: your GLSL text, terminated; else NULL */
    int    timings;             /* 1: measure every pass. Waits for the device around each: for profiling only */
} hbil_gl_info;

/* One plan on one context. Yours to place, ours to fill; read what you like. Zeroed is a valid "not there". */
typedef struct hbil_gl {
    hbil_plan plan;
    uint32_t  width, height;    /* render size of our textures; 0 before the first resize */
    int       runnable;         /* 1 after a resize that succeeded */
    int       fresh;            /* 1: our textures hold garbage */
    uint32_t  frames;           /* run so far: picks the copies of history */
    int       timings;
    uint32_t  texture_units[HBIL_GL__DIMS]; /* by hbil_dim. bit n: unit n is used with that target; [0]: with any */
    uint32_t  image_units;      /* bit n: unit n is used */
    int       es, draws;        /* 1: target=gles; 1: stage=fragment */
    unsigned  program[HBIL_MAX_PASSES];
    unsigned  texture[HBIL_MAX_TEXTURES][HBIL_GL_MAX_COPIES]; /* yours and ours, by plan texture and copy */
    unsigned  samplers[2];      /* nearest; linear for CUBE and 3D. They overrule the parameters of your textures */
    unsigned  buffer;           /* uniform block */
    unsigned  framebuffer[HBIL_MAX_PASSES], vertex_array; /* stage=fragment */
    double    ms[HBIL_MAX_PASSES];
    hbil_gl_functions gl;
    char      message[512];     /* of the last call that failed; terminated */
} hbil_gl;

/* The context has to be current on the calling thread in all calls. Different hbil_gl may be used at the same time. */

/* Static text, never NULL: "unknown" outside the enum. */
HBIL_GL_API const char *hbil_gl_result_name(hbil_gl_result result);
/* GL internal format of a plan's format, GL_R32F...; 0 for HBIL_FORMAT_ANY and outside the enum. */
HBIL_GL_API unsigned hbil_gl_format(hbil_format format);
/* Load functions, compile all passes. *ctx is overwritten: shut down a live one first. On failure nothing is left to free.
 * E_ARG, E_CONTEXT, E_FUNCTION, E_PLAN, E_SPACE, E_COMPILE, E_MEMORY */
HBIL_GL_API hbil_gl_result hbil_gl_init(const hbil_gl_info *info, hbil_gl *ctx);
/* Set the render size and your textures: textures[i] is a GL name where plan texture i is INPUT or OUTPUT, others are not
 * read. width, height: as in hbil_frame. On failure hbil_gl_run is refused until a resize succeeds.
 * E_ARG, E_CONTEXT, E_TEXTURE, E_MEMORY */
HBIL_GL_API hbil_gl_result hbil_gl_resize(hbil_gl *ctx, uint32_t width, uint32_t height,
                                          const unsigned textures[HBIL_MAX_TEXTURES]);
/* Issue all passes of one frame. Does not wait, unless timings were asked for. On failure none was issued.
 * E_ARG, E_CONTEXT, E_FRAME, E_MEMORY */
HBIL_GL_API hbil_gl_result hbil_gl_run(hbil_gl *ctx, const hbil_frame *frame);
/* ms[plan.pass_count]: milliseconds of each pass in the last hbil_gl_run. E_ARG: not asked for at init */
HBIL_GL_API hbil_gl_result hbil_gl_timings(hbil_gl *ctx, double *ms);
/* Delete all that is ours and zero *ctx. A zeroed ctx, or one whose init failed, is fine. */
HBIL_GL_API void hbil_gl_shutdown(hbil_gl *ctx);

#ifdef __cplusplus
}
#endif
#endif /* HBIL_GL_H */

/* ==================================================================================================================
 *                                    API READERS MAY STOP HERE
 * ================================================================================================================== */

#if defined(HBIL_GL_IMPLEMENTATION) && !defined(HBIL_GL__IMPLEMENTED)
#define HBIL_GL__IMPLEMENTED

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Values from the OpenGL registry, under names that no GL header uses. */
enum {
    HBIL_GL__NEAREST = 0x2600, HBIL_GL__LINEAR = 0x2601, HBIL_GL__TEXTURE_MIN_FILTER = 0x2801, HBIL_GL__TEXTURE_MAG_FILTER = 0x2800,
    HBIL_GL__TEXTURE_WRAP_S = 0x2802, HBIL_GL__TEXTURE_WRAP_T = 0x2803, HBIL_GL__TEXTURE_WRAP_R = 0x8072,
    HBIL_GL__CLAMP_TO_EDGE = 0x812F, HBIL_GL__TEXTURE_CUBE_MAP_SEAMLESS = 0x884F,
    HBIL_GL__TEXTURE_2D = 0x0DE1, HBIL_GL__TEXTURE_2D_MULTISAMPLE = 0x9100, HBIL_GL__TEXTURE_2D_ARRAY = 0x8C1A,
    HBIL_GL__TEXTURE_CUBE_MAP = 0x8513, HBIL_GL__TEXTURE_CUBE_MAP_POSITIVE_X = 0x8515, HBIL_GL__TEXTURE_3D = 0x806F,
    HBIL_GL__TEXTURE_BINDING_2D = 0x8069, HBIL_GL__TEXTURE_BINDING_2D_MULTISAMPLE = 0x9104,
    HBIL_GL__TEXTURE_BINDING_2D_ARRAY = 0x8C1D, HBIL_GL__TEXTURE_BINDING_CUBE_MAP = 0x8514, HBIL_GL__TEXTURE_BINDING_3D = 0x806A,
    HBIL_GL__TEXTURE0 = 0x84C0, HBIL_GL__ACTIVE_TEXTURE = 0x84E0, HBIL_GL__SAMPLER_BINDING = 0x8919,
    HBIL_GL__TEXTURE_DEPTH = 0x8071, HBIL_GL__TEXTURE_SAMPLES = 0x9106,
    HBIL_GL__TEXTURE_WIDTH = 0x1000, HBIL_GL__TEXTURE_HEIGHT = 0x1001, HBIL_GL__TEXTURE_INTERNAL_FORMAT = 0x1003,
    HBIL_GL__TEXTURE_RED_TYPE = 0x8C10, HBIL_GL__INT = 0x1404, HBIL_GL__UNSIGNED_INT = 0x1405,
    HBIL_GL__R32F = 0x822E, HBIL_GL__R32UI = 0x8236, HBIL_GL__RGBA32F = 0x8814, HBIL_GL__RGBA16F = 0x881A,
    HBIL_GL__IMAGE_BINDING_NAME = 0x8F3A, HBIL_GL__IMAGE_BINDING_LEVEL = 0x8F3B, HBIL_GL__IMAGE_BINDING_LAYERED = 0x8F3C,
    HBIL_GL__IMAGE_BINDING_LAYER = 0x8F3D, HBIL_GL__IMAGE_BINDING_ACCESS = 0x8F3E, HBIL_GL__IMAGE_BINDING_FORMAT = 0x906E,
    HBIL_GL__WRITE_ONLY = 0x88B9, HBIL_GL__READ_WRITE = 0x88BA,
    HBIL_GL__UNIFORM_BUFFER = 0x8A11, HBIL_GL__UNIFORM_BUFFER_BINDING = 0x8A28, HBIL_GL__UNIFORM_BUFFER_START = 0x8A29,
    HBIL_GL__UNIFORM_BUFFER_SIZE = 0x8A2A, HBIL_GL__STREAM_DRAW = 0x88E0,
    HBIL_GL__COMPUTE_SHADER = 0x91B9, HBIL_GL__COMPILE_STATUS = 0x8B81, HBIL_GL__LINK_STATUS = 0x8B82,
    HBIL_GL__CURRENT_PROGRAM = 0x8B8D, HBIL_GL__PROGRAM = 0x82E2, HBIL_GL__TEXTURE = 0x1702,
    HBIL_GL__TEXTURE_FETCH_BARRIER_BIT = 0x08, HBIL_GL__SHADER_IMAGE_ACCESS_BARRIER_BIT = 0x20,
    HBIL_GL__MAX_COMBINED_TEXTURE_IMAGE_UNITS = 0x8B4D, HBIL_GL__MAX_IMAGE_UNITS = 0x8F38,
    HBIL_GL__MAX_UNIFORM_BUFFER_BINDINGS = 0x8A2F, HBIL_GL__MAX_DRAW_BUFFERS = 0x8824, HBIL_GL__BUFFER_SIZE = 0x8764,
    HBIL_GL__VERSION = 0x1F02, HBIL_GL__TIMESTAMP = 0x8E28, HBIL_GL__TEXTURE_IMMUTABLE_FORMAT = 0x912F,
    HBIL_GL__FRAGMENT_SHADER = 0x8B30, HBIL_GL__VERTEX_SHADER = 0x8B31, HBIL_GL__TRIANGLES = 0x0004,
    HBIL_GL__DRAW_FRAMEBUFFER = 0x8CA9, HBIL_GL__DRAW_FRAMEBUFFER_BINDING = 0x8CA6, HBIL_GL__COLOR_ATTACHMENT0 = 0x8CE0,
    HBIL_GL__FRAMEBUFFER_COMPLETE = 0x8CD5, HBIL_GL__VERTEX_ARRAY_BINDING = 0x85B5, HBIL_GL__VIEWPORT = 0x0BA2,
    HBIL_GL__PIXEL_UNPACK_BUFFER = 0x88EC, HBIL_GL__PIXEL_UNPACK_BUFFER_BINDING = 0x88EF,
    HBIL_GL__BLEND = 0x0BE2, HBIL_GL__COLOR_WRITEMASK = 0x0C23, HBIL_GL__POLYGON_MODE = 0x0B40, HBIL_GL__FILL = 0x1B02,
    HBIL_GL__FRONT_AND_BACK = 0x0408, HBIL_GL__RED = 0x1903, HBIL_GL__RGBA = 0x1908, HBIL_GL__RED_INTEGER = 0x8D94,
    HBIL_GL__FLOAT = 0x1406
};

/* Capabilities that would spoil a triangle over the whole target; the first five are of ES, too. */
static const unsigned hbil_gl__capabilities[] = { 0x0B71 /* GL_DEPTH_TEST */, 0x0B90 /* GL_STENCIL_TEST */,
    0x0C11 /* GL_SCISSOR_TEST */, 0x0B44 /* GL_CULL_FACE */, 0x8C89 /* GL_RASTERIZER_DISCARD */, 0x0BF2 /* GL_COLOR_LOGIC_OP */,
    0x3000, 0x3001, 0x3002, 0x3003, 0x3004, 0x3005, 0x3006, 0x3007 /* GL_CLIP_DISTANCE0... */ };
enum { HBIL_GL__CAPABILITIES = sizeof hbil_gl__capabilities / sizeof *hbil_gl__capabilities, HBIL_GL__ES_CAPABILITIES = 5,
       HBIL_GL__TARGETS = 8 };

/* Targets by hbil_dim. level: what glGetTexLevelParameteriv takes. */
static const struct { unsigned target, binding, level; const char *name; } hbil_gl__targets[HBIL_GL__DIMS] = {
    { 0, 0, 0, "" },
    { HBIL_GL__TEXTURE_2D, HBIL_GL__TEXTURE_BINDING_2D, HBIL_GL__TEXTURE_2D, "GL_TEXTURE_2D" },
    { HBIL_GL__TEXTURE_2D_MULTISAMPLE, HBIL_GL__TEXTURE_BINDING_2D_MULTISAMPLE, HBIL_GL__TEXTURE_2D_MULTISAMPLE,
      "GL_TEXTURE_2D_MULTISAMPLE" },
    { HBIL_GL__TEXTURE_2D_ARRAY, HBIL_GL__TEXTURE_BINDING_2D_ARRAY, HBIL_GL__TEXTURE_2D_ARRAY, "GL_TEXTURE_2D_ARRAY" },
    { HBIL_GL__TEXTURE_CUBE_MAP, HBIL_GL__TEXTURE_BINDING_CUBE_MAP, HBIL_GL__TEXTURE_CUBE_MAP_POSITIVE_X, "GL_TEXTURE_CUBE_MAP" },
    { HBIL_GL__TEXTURE_3D, HBIL_GL__TEXTURE_BINDING_3D, HBIL_GL__TEXTURE_3D, "GL_TEXTURE_3D" } };

static int hbil_gl__filtered(const hbil_texture *t) { return t->dim == HBIL_DIM_CUBE || t->dim == HBIL_DIM_3D; }

/* What hbil_gl_run changes: the list of the header. */
typedef struct hbil_gl__state {
    int     program, active_texture, seamless;
    int     texture[HBIL_GL_MAX_UNITS][HBIL_GL__DIMS], sampler[HBIL_GL_MAX_UNITS];
    struct { int name, level, layered, layer, access, format; } image[HBIL_GL_MAX_UNITS];
    int     uniform_buffer, uniform_generic;
    int64_t uniform_start, uniform_size;
    int     framebuffer, vertex_array, viewport[4], polygon_mode[2]; /* from here on: stage=fragment */
    unsigned char enabled[HBIL_GL__CAPABILITIES], blend[HBIL_GL__TARGETS], mask[HBIL_GL__TARGETS][4];
} hbil_gl__state;

static hbil_gl_result hbil_gl__fail(hbil_gl *ctx, hbil_gl_result result, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(ctx->message, sizeof ctx->message, format, args);
    va_end(args);
    return result;
}

/* ---------------------------------------------------------------------------------------------- init and shutdown */

/* The version is judged before missing functions: on an old context it is the reason why they are missing. It is read as
 * text, since GL_MAJOR_VERSION is itself an error before 3.0. */
static hbil_gl_result hbil_gl__check_version(hbil_gl *ctx)
{
    static const char *const least[2][2] = { { "4.3", "3.3" }, { "3.1", "3.0" } };
    const char *version = (const char *)ctx->gl.getString(HBIL_GL__VERSION), *number, *need = least[ctx->es][ctx->draws];
    const char *kind = ctx->es ? "OpenGL ES" : "desktop OpenGL";
    int es, major = 0, minor = 0;
    if (!version)
        return hbil_gl__fail(ctx, HBIL_GL_E_CONTEXT, "no GL context is current on this thread: make yours current "
                             "before hbil_gl_init");
    es = strncmp(version, "OpenGL ES ", 10) == 0;
    number = version + (es ? 10 : 0);
    if (sscanf(number, "%d.%d", &major, &minor) != 2 || es != ctx->es)
        return hbil_gl__fail(ctx, HBIL_GL_E_CONTEXT, "the context is \"%.100s\", not %s: ask for %s %s%s, or build the plan with "
                             "target=%s", version, kind, ctx->es ? kind : "OpenGL", need, ctx->es ? "" : " core", es ? "gles" : "gl");
    if (es && major == 3 && minor == 0) ctx->gl.getTexLevelParameteriv = NULL; /* some loaders know it, but it is of 3.1 */
    if (major < need[0] - '0' || (major == need[0] - '0' && minor < need[2] - '0'))
        return hbil_gl__fail(ctx, HBIL_GL_E_CONTEXT, "the context is OpenGL \"%.100s\", %s need %s: ask for a %s%s context when you "
                             "create it, or update the driver%s", version, ctx->draws ? "these shaders" : "compute shaders", need,
                             need, ctx->es ? "" : " core", ctx->draws ? "" : ", or build the plan with stage=fragment");
    return HBIL_GL_OK;
}

static hbil_gl_result hbil_gl__load(hbil_gl *ctx, const hbil_gl_info *info)
{
    enum { ALWAYS, COMPUTE, DRAW, DESKTOP, OPTIONAL };
#define HBIL_GL__ROW(when, type, member, name, args) { name, offsetof(hbil_gl_functions, member), when },
    static const struct { const char *name; size_t offset; int when; } table[] = { HBIL_GL__FUNCTIONS(HBIL_GL__ROW) };
#undef HBIL_GL__ROW
    const char *missing = NULL;
    size_t i;
    for (i = 0; i < sizeof table / sizeof *table; ++i) {
        void *address = info->get_proc(info->user, table[i].name);
        int needed = table[i].when == ALWAYS || (table[i].when == COMPUTE && !ctx->draws) || (table[i].when == DRAW && ctx->draws) ||
                     (table[i].when == DESKTOP && ctx->draws && !ctx->es);
        if (!address && !missing && needed) missing = table[i].name;
        /* copied as bytes: ISO C has no conversion between object and function pointers */
        memcpy((char *)&ctx->gl + table[i].offset, &address, sizeof address);
    }
    if (ctx->gl.getString) {
        hbil_gl_result result = hbil_gl__check_version(ctx);
        if (result != HBIL_GL_OK) return result;
    }
    if (missing)
        return hbil_gl__fail(ctx, HBIL_GL_E_FUNCTION, "get_proc returns NULL for %s: give the loader of the current context, "
                             "one that also knows functions of GL 1.1", missing);
    return HBIL_GL_OK;
}

static hbil_gl_result hbil_gl__check_plan_texture(hbil_gl *ctx, const hbil_texture *t)
{
    int flat = t->dim == HBIL_DIM_2D || t->dim == HBIL_DIM_2D_ARRAY;
    if (t->life != HBIL_LIFE_INPUT && !hbil_gl_format((hbil_format)t->format))
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "texture %s has a format unknown to this hbil_gl.h: take the one of the "
                             "same release as hbil.h", t->name);
    if (t->copies < 1 || t->copies > HBIL_GL_MAX_COPIES)
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "texture %s has %u copies: raise HBIL_GL_MAX_COPIES (%d)", t->name,
                             (unsigned)t->copies, HBIL_GL_MAX_COPIES);
    if (t->copies > 1 && t->life <= HBIL_LIFE_OUTPUT)
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "texture %s is yours, of which there is one, and has %u copies: set 1", t->name,
                             (unsigned)t->copies);
    if (t->dim < HBIL_DIM_2D || t->dim >= HBIL_GL__DIMS || t->layers < 1 || (t->life != HBIL_LIFE_INPUT && !flat) ||
        (t->dim == HBIL_DIM_2D && t->layers != 1))
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "texture %s has dim %u and %u layers: only inputs may be other than 2D of one "
                             "layer or 2D_ARRAY", t->name, (unsigned)t->dim, (unsigned)t->layers);
    return HBIL_GL_OK;
}

/* Render targets of a pass, one a layer. */
static int hbil_gl__target_count(const hbil_plan *plan, const hbil_pass *pass)
{
    int count = 0;
    uint32_t i;
    for (i = 0; i < pass->binding_count; ++i)
        if (pass->bindings[i].access == HBIL_ACCESS_WRITE) count += plan->textures[pass->bindings[i].texture].layers;
    return count;
}

/* ES 3.0 promises four targets, all others eight. */
static hbil_gl_result hbil_gl__check_target_counts(hbil_gl *ctx)
{
    int targets = 0;
    uint32_t i;
    ctx->gl.getIntegerv(HBIL_GL__MAX_DRAW_BUFFERS, &targets);
    if (targets > HBIL_GL__TARGETS) targets = HBIL_GL__TARGETS;
    for (i = 0; i < ctx->plan.pass_count; ++i)
        if (hbil_gl__target_count(&ctx->plan, &ctx->plan.passes[i]) > targets)
            return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "pass %s draws to %d targets at once, %d can be used here: ask for fewer outputs",
                                 ctx->plan.passes[i].name, hbil_gl__target_count(&ctx->plan, &ctx->plan.passes[i]), targets);
    return HBIL_GL_OK;
}

/* Checks all that could make a later GL call fail, and notes which units the plan uses. */
static hbil_gl_result hbil_gl__check_plan(hbil_gl *ctx)
{
    const hbil_plan *plan = &ctx->plan;
    int texture_units = 0, image_units = 0, uniform_bindings = 0;
    hbil_gl_result result = HBIL_GL_OK;
    uint32_t i, k;
    ctx->gl.getIntegerv(HBIL_GL__MAX_COMBINED_TEXTURE_IMAGE_UNITS, &texture_units);
    if (ctx->draws) image_units = HBIL_GL__TARGETS;
    else ctx->gl.getIntegerv(HBIL_GL__MAX_IMAGE_UNITS, &image_units);
    ctx->gl.getIntegerv(HBIL_GL__MAX_UNIFORM_BUFFER_BINDINGS, &uniform_bindings);
    if (texture_units > HBIL_GL_MAX_UNITS) texture_units = HBIL_GL_MAX_UNITS;
    if (image_units > HBIL_GL_MAX_UNITS) image_units = HBIL_GL_MAX_UNITS;
    for (i = 0; i < plan->texture_count && result == HBIL_GL_OK; ++i)
        result = hbil_gl__check_plan_texture(ctx, &plan->textures[i]);
    if (result == HBIL_GL_OK && ctx->draws) result = hbil_gl__check_target_counts(ctx);
    if (result != HBIL_GL_OK) return result;
    for (i = 0; i < plan->pass_count; ++i)
        for (k = 0; k < plan->passes[i].binding_count; ++k) {
            const hbil_binding *b = &plan->passes[i].bindings[k];
            int write = b->access == HBIL_ACCESS_WRITE, units = write ? image_units : texture_units;
            if (b->slot >= units)
                return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "pass %s uses %s %u, %d can be used here: ask for fewer outputs",
                                     plan->passes[i].name, write ? (ctx->draws ? "target" : "image unit") : "texture unit", (unsigned)b->slot, units);
            if (write && !ctx->draws) ctx->image_units |= 1u << b->slot;
            if (!write) ctx->texture_units[0] |= 1u << b->slot;
            if (!write) ctx->texture_units[plan->textures[b->texture].dim] |= 1u << b->slot;
        }
    if (plan->constants_slot >= (uint32_t)uniform_bindings)
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "the uniform block is at binding %u, the context has %d: update "
                             "the driver", (unsigned)plan->constants_slot, uniform_bindings);
    return HBIL_GL_OK;
}

/* What the text calls a binding: see hbil_role. */
static const char *hbil_gl__uniform_name(char name[40], const hbil_plan *plan, const hbil_binding *b)
{
    const char *head = b->role == HBIL_ROLE_LAST ? "u_last_" : b->role == HBIL_ROLE_FROM ? "u_from" : "u_";
    strcpy(name, head);
    return b->role == HBIL_ROLE_FROM ? name : strcat(name, plan->textures[b->texture].name);
}

/* Units and block by their names, which shaders before GL 4.2 cannot say themselves. */
static void hbil_gl__name_units(hbil_gl *ctx, uint32_t index)
{
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_pass *pass = &ctx->plan.passes[index];
    unsigned program = ctx->program[index];
    char name[40];
    uint32_t i;
    int old = 0;
    gl->getIntegerv(HBIL_GL__CURRENT_PROGRAM, &old);
    gl->useProgram(program);
    for (i = 0; i < pass->binding_count; ++i)
        if (pass->bindings[i].access == HBIL_ACCESS_SAMPLE)
            gl->uniform1i(gl->getUniformLocation(program, hbil_gl__uniform_name(name, &ctx->plan, &pass->bindings[i])),
                          pass->bindings[i].slot);
    if (pass->constants) gl->uniformBlockBinding(program, gl->getUniformBlockIndex(program, "HbilFrame"), ctx->plan.constants_slot);
    gl->useProgram(gl->isProgram((unsigned)old) ? (unsigned)old : 0);
}

static hbil_gl_result hbil_gl__no_object(hbil_gl *ctx, const char *what)
{
    return hbil_gl__fail(ctx, HBIL_GL_E_MEMORY, "%s cannot be made (GL error 0x%04x): out of memory, or the context is lost: free some, "
                         "or make a new context", what, ctx->gl.getError());
}

/* Behind what message[] says already. */
static hbil_gl_result hbil_gl__add_log(hbil_gl *ctx, unsigned object, void (HBIL_GL_CALL *log)(unsigned, int, int *, char *))
{
    size_t used = strlen(ctx->message);
    log(object, (int)(sizeof ctx->message - used), NULL, ctx->message + used);
    if (!ctx->message[used])
        snprintf(ctx->message + used, sizeof ctx->message - used, "the driver does not say why (GL error 0x%04x). Update it, or give it "
                 "memory", ctx->gl.getError());
    return HBIL_GL_E_COMPILE;
}

/* The driver's log goes straight behind the pass name in message[], cut to what fits: the first error comes first. */
static hbil_gl_result hbil_gl__add_shader(hbil_gl *ctx, uint32_t pass, unsigned kind, const char *text)
{
    const hbil_gl_functions *gl = &ctx->gl;
    unsigned shader = gl->createShader(kind);
    int compiled = 0;
    if (!shader) return hbil_gl__no_object(ctx, "a shader");
    gl->shaderSource(shader, 1, &text, NULL);
    gl->compileShader(shader);
    gl->getShaderiv(shader, HBIL_GL__COMPILE_STATUS, &compiled);
    if (compiled) gl->attachShader(ctx->program[pass], shader);
    else {
        hbil_gl__fail(ctx, HBIL_GL_E_COMPILE, "pass %s does not compile: ", ctx->plan.passes[pass].name);
        hbil_gl__add_log(ctx, shader, gl->getShaderInfoLog);
    }
    gl->deleteShader(shader); /* lives on inside the program */
    return compiled ? HBIL_GL_OK : HBIL_GL_E_COMPILE;
}

static hbil_gl_result hbil_gl__compile(hbil_gl *ctx, uint32_t pass, const char *text)
{
    const hbil_gl_functions *gl = &ctx->gl;
    const char *name = ctx->plan.passes[pass].name;
    unsigned program = gl->createProgram();
    hbil_gl_result result;
    int linked = 0;
    ctx->program[pass] = program;
    if (!program) return hbil_gl__no_object(ctx, "a program");
    result = hbil_gl__add_shader(ctx, pass, ctx->draws ? HBIL_GL__FRAGMENT_SHADER : HBIL_GL__COMPUTE_SHADER, text);
    if (result == HBIL_GL_OK && ctx->draws) {
        char vertex[512];
        if (hbil_emit_vertex(&ctx->plan, vertex, sizeof vertex, NULL) != HBIL_OK)
            return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "hbil_emit_vertex fails: build the plan with hbil_plan_build");
        result = hbil_gl__add_shader(ctx, pass, HBIL_GL__VERTEX_SHADER, vertex);
    }
    if (result != HBIL_GL_OK) return result;
    gl->linkProgram(program);
    gl->getProgramiv(program, HBIL_GL__LINK_STATUS, &linked);
    if (!linked) {
        hbil_gl__fail(ctx, HBIL_GL_E_COMPILE, "pass %s does not link: ", name);
        return hbil_gl__add_log(ctx, program, gl->getProgramInfoLog);
    }
    if (ctx->draws) hbil_gl__name_units(ctx, pass);
    if (gl->objectLabel) gl->objectLabel(HBIL_GL__PROGRAM, program, -1, name);
    return HBIL_GL_OK;
}

static hbil_gl_result hbil_gl__make_programs(hbil_gl *ctx, const hbil_gl_info *info)
{
    uint32_t pass;
    for (pass = 0; pass < ctx->plan.pass_count; ++pass) {
        size_t need = 0;
        hbil_diag diag;
        hbil_diags diags;
        hbil_gl_result result;
        hbil_result emitted;
        memset(&diag, 0, sizeof diag);
        diags.items = &diag;
        diags.capacity = 1;
        diags.count = 0;
        emitted = hbil_emit_glsl_hook(&ctx->plan, (int32_t)pass, info->hook, info->scratch, info->scratch_size, &need, &diags);
        if (emitted == HBIL_E_SPACE)
            return hbil_gl__fail(ctx, HBIL_GL_E_SPACE, "the text of pass %s takes %lu bytes, the scratch buffer has %lu: give "
                                 "it HBIL_GLSL_MAX, and what your hook takes", ctx->plan.passes[pass].name, (unsigned long)need,
                                 (unsigned long)info->scratch_size);
        if (emitted == HBIL_E_HOOK)
            return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "pass %s: %s: see hbil_gl_info.hook", ctx->plan.passes[pass].name,
                                 diag.text[0] ? diag.text : hbil_result_name(emitted));
        if (emitted != HBIL_OK)
            return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "hbil_emit_glsl: %s: build the plan with hbil_plan_build",
                                 hbil_result_name(emitted));
        result = hbil_gl__compile(ctx, pass, info->scratch);
        if (result != HBIL_GL_OK) return result;
    }
    return HBIL_GL_OK;
}

/* Deletes the textures that are ours and forgets those that are yours. */
static void hbil_gl__delete_textures(hbil_gl *ctx)
{
    uint32_t i;
    for (i = 0; i < ctx->plan.texture_count; ++i)
        if (ctx->plan.textures[i].life >= HBIL_LIFE_TRANSIENT)
            ctx->gl.deleteTextures(HBIL_GL_MAX_COPIES, ctx->texture[i]); /* GL skips names that are 0 */
    memset(ctx->texture, 0, sizeof ctx->texture);
    ctx->width = ctx->height = 0;
    ctx->runnable = 0;
}

/* All that is no program. */
static hbil_gl_result hbil_gl__make_objects(hbil_gl *ctx)
{
    int i, missing = 0;
    uint32_t p;
    ctx->gl.genBuffers(1, &ctx->buffer);
    ctx->gl.genSamplers(2, ctx->samplers);
    if (ctx->draws) {
        ctx->gl.genVertexArrays(1, &ctx->vertex_array);
        ctx->gl.genFramebuffers((int)ctx->plan.pass_count, ctx->framebuffer);
    }
    for (p = 0; p < ctx->plan.pass_count && ctx->draws; ++p) missing |= !ctx->framebuffer[p];
    if (missing || !ctx->buffer || !ctx->samplers[0] || !ctx->samplers[1] || (ctx->draws && !ctx->vertex_array))
        return hbil_gl__no_object(ctx, "a buffer, a sampler or a framebuffer");
    for (i = 0; i < 2; ++i) {
        ctx->gl.samplerParameteri(ctx->samplers[i], HBIL_GL__TEXTURE_MIN_FILTER, i ? HBIL_GL__LINEAR : HBIL_GL__NEAREST);
        ctx->gl.samplerParameteri(ctx->samplers[i], HBIL_GL__TEXTURE_MAG_FILTER, i ? HBIL_GL__LINEAR : HBIL_GL__NEAREST);
        ctx->gl.samplerParameteri(ctx->samplers[i], HBIL_GL__TEXTURE_WRAP_S, HBIL_GL__CLAMP_TO_EDGE);
        ctx->gl.samplerParameteri(ctx->samplers[i], HBIL_GL__TEXTURE_WRAP_T, HBIL_GL__CLAMP_TO_EDGE);
        ctx->gl.samplerParameteri(ctx->samplers[i], HBIL_GL__TEXTURE_WRAP_R, HBIL_GL__CLAMP_TO_EDGE);
    }
    return HBIL_GL_OK;
}

/* A context that is lost, or not current, changes no value that it is asked for. */
static hbil_gl_result hbil_gl__check_context(hbil_gl *ctx)
{
    int unit = -1;
    ctx->gl.getIntegerv(HBIL_GL__ACTIVE_TEXTURE, &unit);
    if (unit != -1) return HBIL_GL_OK;
    return hbil_gl__fail(ctx, HBIL_GL_E_CONTEXT, "the GL context does not answer: make it current on this thread; if it is, it is lost: "
                         "make a new one, and init again");
}

/* ---------------------------------------------------------------------------------------------------------- resize */

/* Size and kind of what is bound, as the plan wants it. extent: least size, of CUBE and 3D 1 x 1. */
static hbil_gl_result hbil_gl__check_shape(hbil_gl *ctx, uint32_t index, unsigned name, const uint32_t extent[2])
{
    const hbil_texture *t = &ctx->plan.textures[index];
    const char *role = t->life == HBIL_LIFE_INPUT ? "input" : "output";
    unsigned level = hbil_gl__targets[t->dim].level, face;
    int width = 0, height = 0, count = 0;
    ctx->gl.getTexLevelParameteriv(level, 0, HBIL_GL__TEXTURE_WIDTH, &width);
    ctx->gl.getTexLevelParameteriv(level, 0, HBIL_GL__TEXTURE_HEIGHT, &height);
    if ((uint32_t)width < extent[0] || (uint32_t)height < extent[1])
        return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s: level 0 of texture %u is %d x %d, the frame needs %u x %u: make it "
                             "that large, or resize to a smaller frame", role, t->name, name, width, height,
                             (unsigned)extent[0], (unsigned)extent[1]);
    for (face = 1; t->dim == HBIL_DIM_CUBE && face < 6; ++face) {
        ctx->gl.getTexLevelParameteriv(level + face, 0, HBIL_GL__TEXTURE_WIDTH, &count);
        if (count != width || width != height)
            return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s: face %u of texture %u is %d wide, face 0 is %d x %d: fill six "
                                 "square faces of one size", role, t->name, face, name, count, width, height);
    }
    if (t->dim == HBIL_DIM_2D_ARRAY) {
        ctx->gl.getTexLevelParameteriv(level, 0, HBIL_GL__TEXTURE_DEPTH, &count);
        if (count < t->layers)
            return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s: texture %u has %d layers, the plan needs %u", role, t->name,
                                 name, count, (unsigned)t->layers);
    }
    if (t->dim == HBIL_DIM_2D_MULTISAMPLE) {
        ctx->gl.getTexLevelParameteriv(level, 0, HBIL_GL__TEXTURE_SAMPLES, &count);
        if (count <= ctx->plan.config.sample)
            return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s: texture %u has %d samples, the plan reads sample %d: build it "
                                 "with a lower one", role, t->name, name, count, (int)ctx->plan.config.sample);
    }
    return HBIL_GL_OK;
}

/* Binds a texture of yours to the active unit and asks GL what it is. */
static hbil_gl_result hbil_gl__check_texture(hbil_gl *ctx, uint32_t index, unsigned name, const uint32_t extent[2])
{
    static const uint32_t any[2] = { 1, 1 };
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_texture *t = &ctx->plan.textures[index];
    const char *role = t->life == HBIL_LIFE_INPUT ? "input" : "output";
    hbil_gl_result result;
    int bound = 0, format = 0, type = 0;
    if (!name || !gl->isTexture(name))
        return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s is missing: put the name of a GL texture into textures[%u], it is "
                             "%u", role, t->name, (unsigned)index, name);
    gl->bindTexture(hbil_gl__targets[t->dim].target, name);
    gl->getIntegerv(hbil_gl__targets[t->dim].binding, &bound);
    if ((unsigned)bound != name)
        return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "%s %s: texture %u is not a %s (GL error 0x%04x): other kinds need a copy, "
                             "or an option that asks for them", role, t->name, name, hbil_gl__targets[t->dim].name,
                             gl->getError());
    if (t->life == HBIL_LIFE_OUTPUT && ctx->es && !ctx->draws) { /* ES stores into such only, and says nothing */
        int fixed = 0;
        gl->getTexParameteriv(hbil_gl__targets[t->dim].target, HBIL_GL__TEXTURE_IMMUTABLE_FORMAT, &fixed);
        if (!fixed)
            return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "output %s: OpenGL ES stores only into textures made by glTexStorage; %u "
                                 "was not", t->name, name);
    }
    if (!gl->getTexLevelParameteriv) return HBIL_GL_OK; /* ES 3.0: no way to ask */
    gl->getTexLevelParameteriv(hbil_gl__targets[t->dim].level, 0, HBIL_GL__TEXTURE_INTERNAL_FORMAT, &format);
    gl->getTexLevelParameteriv(hbil_gl__targets[t->dim].level, 0, HBIL_GL__TEXTURE_RED_TYPE, &type);
    result = hbil_gl__check_shape(ctx, index, name, hbil_gl__filtered(t) ? any : extent);
    if (result != HBIL_GL_OK) return result;
    if (t->life == HBIL_LIFE_OUTPUT && (unsigned)format != hbil_gl_format((hbil_format)t->format))
        return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "output %s: texture %u has internal format 0x%04x, the shader stores %s: "
                             "make it with 0x%04x, see hbil_gl_format", t->name, name, (unsigned)format,
                             hbil_format_name((hbil_format)t->format), hbil_gl_format((hbil_format)t->format));
    if (t->life == HBIL_LIFE_INPUT && (type == HBIL_GL__INT || type == HBIL_GL__UNSIGNED_INT))
        return hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "input %s: texture %u has an integer format (0x%04x): give it a float, "
                             "normalised or depth format", t->name, name, (unsigned)format);
    return HBIL_GL_OK;
}

/* Store of the texture that is bound. glTexStorage is newer than stage=fragment asks for. */
static void hbil_gl__allocate(const hbil_gl *ctx, const hbil_texture *t, int width, int height)
{
    const hbil_gl_functions *gl = &ctx->gl;
    unsigned target = hbil_gl__targets[t->dim].target, format = hbil_gl_format((hbil_format)t->format);
    int integer = t->format == HBIL_FORMAT_R32UI, one = integer || t->format == HBIL_FORMAT_R32F;
    unsigned channels = integer ? HBIL_GL__RED_INTEGER : one ? HBIL_GL__RED : HBIL_GL__RGBA;
    unsigned type = integer ? HBIL_GL__UNSIGNED_INT : HBIL_GL__FLOAT;
    int array = t->dim == HBIL_DIM_2D_ARRAY;
    if (array && ctx->draws) gl->texImage3D(target, 0, (int)format, width, height, t->layers, 0, channels, type, NULL);
    else if (array) gl->texStorage3D(target, t->mips, format, width, height, t->layers);
    else if (ctx->draws) gl->texImage2D(target, 0, (int)format, width, height, 0, channels, type, NULL);
    else gl->texStorage2D(target, t->mips, format, width, height);
}

/* All copies of one texture of ours. A failed allocation shows in the size, which needs no glGetError on success. */
static hbil_gl_result hbil_gl__make_texture(hbil_gl *ctx, uint32_t index, const uint32_t extent[2])
{
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_texture *t = &ctx->plan.textures[index];
    unsigned target = hbil_gl__targets[t->dim].target;
    uint32_t copy;
    gl->genTextures(t->copies, ctx->texture[index]);
    for (copy = 0; copy < t->copies; ++copy) {
        unsigned name = ctx->texture[index][copy];
        int width = (int)extent[0];
        if (!name) return hbil_gl__no_object(ctx, "a texture");
        gl->bindTexture(target, name);
        hbil_gl__allocate(ctx, t, (int)extent[0], (int)extent[1]);
        if (gl->getTexLevelParameteriv) gl->getTexLevelParameteriv(target, 0, HBIL_GL__TEXTURE_WIDTH, &width);
        if ((uint32_t)width != extent[0])
            return hbil_gl__fail(ctx, HBIL_GL_E_MEMORY, "texture %s, %s, %u x %u, cannot be made (GL error 0x%04x): free video "
                                 "memory or render at a smaller size", t->name, hbil_format_name((hbil_format)t->format),
                                 (unsigned)extent[0], (unsigned)extent[1], gl->getError());
        if (gl->objectLabel) gl->objectLabel(HBIL_GL__TEXTURE, name, -1, t->name);
    }
    return HBIL_GL_OK;
}

/* Binds the framebuffer of a pass and attaches what it draws in this frame, a layer a target. */
static void hbil_gl__attach(const hbil_gl *ctx, uint32_t index, uint32_t frame)
{
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_pass *pass = &ctx->plan.passes[index];
    unsigned buffers[HBIL_GL__TARGETS] = { 0 };
    uint32_t i, layer;
    int count = 0;
    gl->bindFramebuffer(HBIL_GL__DRAW_FRAMEBUFFER, ctx->framebuffer[index]);
    for (i = 0; i < pass->binding_count; ++i) {
        const hbil_binding *b = &pass->bindings[i];
        const hbil_texture *t = &ctx->plan.textures[b->texture];
        unsigned name = ctx->texture[b->texture][(frame % t->copies + t->copies - b->age) % t->copies];
        if (b->access != HBIL_ACCESS_WRITE) continue;
        for (layer = 0; layer < t->layers; ++layer, ++count) {
            buffers[count] = HBIL_GL__COLOR_ATTACHMENT0 + (unsigned)count;
            if (t->dim == HBIL_DIM_2D_ARRAY)
                gl->framebufferTextureLayer(HBIL_GL__DRAW_FRAMEBUFFER, buffers[count], name, b->mip, (int)layer);
            else
                gl->framebufferTexture2D(HBIL_GL__DRAW_FRAMEBUFFER, buffers[count], HBIL_GL__TEXTURE_2D, name, b->mip);
        }
    }
    gl->drawBuffers(count, buffers);
}

/* Can the driver draw into all of it? ES 3.0 promises no float targets. */
static hbil_gl_result hbil_gl__check_targets(hbil_gl *ctx)
{
    hbil_gl_result result = HBIL_GL_OK;
    uint32_t pass;
    int old = 0;
    ctx->gl.getIntegerv(HBIL_GL__DRAW_FRAMEBUFFER_BINDING, &old);
    for (pass = 0; pass < ctx->plan.pass_count && result == HBIL_GL_OK; ++pass) {
        unsigned status;
        hbil_gl__attach(ctx, pass, 0);
        status = ctx->gl.checkFramebufferStatus(HBIL_GL__DRAW_FRAMEBUFFER);
        if (status != HBIL_GL__FRAMEBUFFER_COMPLETE)
            result = hbil_gl__fail(ctx, HBIL_GL_E_TEXTURE, "the driver cannot draw what pass %s writes (framebuffer status 0x%04x): %s",
                                   ctx->plan.passes[pass].name, status, ctx->es ? "OpenGL ES 3 needs EXT_color_buffer_float for it"
                                   : "outputs have to be of the format that hbil_gl_format names");
    }
    ctx->gl.bindFramebuffer(HBIL_GL__DRAW_FRAMEBUFFER, (unsigned)old);
    return result;
}

static hbil_gl_result hbil_gl__set_textures(hbil_gl *ctx, uint32_t width, uint32_t height, const unsigned *textures)
{
    int keep = width == ctx->width && height == ctx->height;
    hbil_gl_result result = HBIL_GL_OK;
    uint32_t i, extent[2];
    int unpack = 0;
    if (ctx->draws) { /* with one bound, glTexImage would read from it */
        ctx->gl.getIntegerv(HBIL_GL__PIXEL_UNPACK_BUFFER_BINDING, &unpack);
        ctx->gl.bindBuffer(HBIL_GL__PIXEL_UNPACK_BUFFER, 0);
    }
    if (!keep) hbil_gl__delete_textures(ctx);
    for (i = 0; i < ctx->plan.texture_count && result == HBIL_GL_OK; ++i) {
        int ours = ctx->plan.textures[i].life >= HBIL_LIFE_TRANSIENT;
        if (ours && keep) continue;
        if (hbil_plan_extent(&ctx->plan, (int32_t)i, width, height, extent) != HBIL_OK)
            result = hbil_gl__fail(ctx, HBIL_GL_E_ARG, "render size %u x %u: each has to be in [1, 16384]", (unsigned)width,
                                   (unsigned)height);
        else if (ours) result = hbil_gl__make_texture(ctx, i, extent);
        else result = hbil_gl__check_texture(ctx, i, ctx->texture[i][0] = textures[i], extent);
    }
    if (ctx->draws) ctx->gl.bindBuffer(HBIL_GL__PIXEL_UNPACK_BUFFER, (unsigned)unpack);
    if (result == HBIL_GL_OK && ctx->draws) result = hbil_gl__check_targets(ctx);
    if (result == HBIL_GL_OK) {
        ctx->width = width;
        ctx->height = height;
        ctx->runnable = 1;
        if (!keep) ctx->fresh = 1;
    }
    return result;
}

/* ------------------------------------------------------------------------------------------------------------- run */

/* Blending and masks: of each target on desktop GL, of all at once before ES 3.2. */
static void hbil_gl__save_draw(const hbil_gl *ctx, hbil_gl__state *s)
{
    const hbil_gl_functions *gl = &ctx->gl;
    unsigned i, count = ctx->es ? HBIL_GL__ES_CAPABILITIES : HBIL_GL__CAPABILITIES;
    gl->getIntegerv(HBIL_GL__DRAW_FRAMEBUFFER_BINDING, &s->framebuffer);
    gl->getIntegerv(HBIL_GL__VERTEX_ARRAY_BINDING, &s->vertex_array);
    gl->getIntegerv(HBIL_GL__VIEWPORT, s->viewport);
    if (!ctx->es) gl->getIntegerv(HBIL_GL__POLYGON_MODE, s->polygon_mode);
    for (i = 0; i < count; ++i) s->enabled[i] = gl->isEnabled(hbil_gl__capabilities[i]);
    if (ctx->es) {
        s->blend[0] = gl->isEnabled(HBIL_GL__BLEND);
        gl->getBooleanv(HBIL_GL__COLOR_WRITEMASK, s->mask[0]);
        return;
    }
    for (i = 0; i < HBIL_GL__TARGETS; ++i) {
        s->blend[i] = gl->isEnabledi(HBIL_GL__BLEND, i);
        gl->getBooleani_v(HBIL_GL__COLOR_WRITEMASK, i, s->mask[i]);
    }
}

static void hbil_gl__begin_draw(const hbil_gl *ctx)
{
    const hbil_gl_functions *gl = &ctx->gl;
    unsigned i, count = ctx->es ? HBIL_GL__ES_CAPABILITIES : HBIL_GL__CAPABILITIES;
    gl->bindVertexArray(ctx->vertex_array);
    if (!ctx->es) gl->polygonMode(HBIL_GL__FRONT_AND_BACK, HBIL_GL__FILL);
    for (i = 0; i < count; ++i) gl->disable(hbil_gl__capabilities[i]);
    gl->disable(HBIL_GL__BLEND);
    gl->colorMask(1, 1, 1, 1);
}

static void hbil_gl__restore_draw(const hbil_gl *ctx, const hbil_gl__state *s)
{
    const hbil_gl_functions *gl = &ctx->gl;
    unsigned i, count = ctx->es ? HBIL_GL__ES_CAPABILITIES : HBIL_GL__CAPABILITIES;
    gl->bindFramebuffer(HBIL_GL__DRAW_FRAMEBUFFER, (unsigned)s->framebuffer);
    gl->bindVertexArray((unsigned)s->vertex_array);
    gl->viewport(s->viewport[0], s->viewport[1], s->viewport[2], s->viewport[3]);
    if (!ctx->es) gl->polygonMode(HBIL_GL__FRONT_AND_BACK, (unsigned)s->polygon_mode[0]);
    for (i = 0; i < count; ++i)
        if (s->enabled[i]) gl->enable(hbil_gl__capabilities[i]);
    if (ctx->es) {
        if (s->blend[0]) gl->enable(HBIL_GL__BLEND);
        gl->colorMask(s->mask[0][0], s->mask[0][1], s->mask[0][2], s->mask[0][3]);
        return;
    }
    for (i = 0; i < HBIL_GL__TARGETS; ++i) {
        if (s->blend[i]) gl->enablei(HBIL_GL__BLEND, i);
        gl->colorMaski(i, s->mask[i][0], s->mask[i][1], s->mask[i][2], s->mask[i][3]);
    }
}

static void hbil_gl__save(const hbil_gl *ctx, hbil_gl__state *s)
{
    const hbil_gl_functions *gl = &ctx->gl;
    uint32_t unit, dim, slot = ctx->plan.constants_slot;
    gl->getIntegerv(HBIL_GL__CURRENT_PROGRAM, &s->program);
    gl->getIntegerv(HBIL_GL__ACTIVE_TEXTURE, &s->active_texture);
    for (unit = 0; unit < HBIL_GL_MAX_UNITS; ++unit) {
        if (ctx->texture_units[0] >> unit & 1) {
            gl->activeTexture(HBIL_GL__TEXTURE0 + unit);
            for (dim = 1; dim < HBIL_GL__DIMS; ++dim)
                if (ctx->texture_units[dim] >> unit & 1)
                    gl->getIntegerv(hbil_gl__targets[dim].binding, &s->texture[unit][dim]);
            gl->getIntegerv(HBIL_GL__SAMPLER_BINDING, &s->sampler[unit]);
        }
        if (ctx->image_units >> unit & 1) {
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_NAME, unit, &s->image[unit].name);
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_LEVEL, unit, &s->image[unit].level);
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_LAYERED, unit, &s->image[unit].layered);
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_LAYER, unit, &s->image[unit].layer);
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_ACCESS, unit, &s->image[unit].access);
            gl->getIntegeri_v(HBIL_GL__IMAGE_BINDING_FORMAT, unit, &s->image[unit].format);
        }
    }
    s->seamless = !ctx->texture_units[HBIL_DIM_CUBE] || ctx->es || gl->isEnabled(HBIL_GL__TEXTURE_CUBE_MAP_SEAMLESS);
    gl->getIntegerv(HBIL_GL__UNIFORM_BUFFER_BINDING, &s->uniform_generic);
    gl->getIntegeri_v(HBIL_GL__UNIFORM_BUFFER_BINDING, slot, &s->uniform_buffer);
    gl->getInteger64i_v(HBIL_GL__UNIFORM_BUFFER_START, slot, &s->uniform_start);
    gl->getInteger64i_v(HBIL_GL__UNIFORM_BUFFER_SIZE, slot, &s->uniform_size);
    if (ctx->draws) hbil_gl__save_draw(ctx, s);
}

static void hbil_gl__restore(const hbil_gl *ctx, const hbil_gl__state *s)
{
    const hbil_gl_functions *gl = &ctx->gl;
    uint32_t unit, dim, slot = ctx->plan.constants_slot;
    for (unit = 0; unit < HBIL_GL_MAX_UNITS; ++unit) {
        if (ctx->texture_units[0] >> unit & 1) {
            gl->activeTexture(HBIL_GL__TEXTURE0 + unit);
            for (dim = 1; dim < HBIL_GL__DIMS; ++dim)
                if (ctx->texture_units[dim] >> unit & 1)
                    gl->bindTexture(hbil_gl__targets[dim].target, (unsigned)s->texture[unit][dim]);
            gl->bindSampler(unit, (unsigned)s->sampler[unit]);
        }
        if (ctx->image_units >> unit & 1)
            gl->bindImageTexture(unit, (unsigned)s->image[unit].name, s->image[unit].level, s->image[unit].layered != 0,
                                 s->image[unit].layer, (unsigned)s->image[unit].access, (unsigned)s->image[unit].format);
    }
    gl->activeTexture((unsigned)s->active_texture);
    if (!s->seamless) gl->disable(HBIL_GL__TEXTURE_CUBE_MAP_SEAMLESS);
    /* size 0: bound whole, by glBindBufferBase. Either call also binds the generic point, which therefore comes last. */
    if (s->uniform_size > 0)
        gl->bindBufferRange(HBIL_GL__UNIFORM_BUFFER, slot, (unsigned)s->uniform_buffer, (ptrdiff_t)s->uniform_start,
                            (ptrdiff_t)s->uniform_size);
    else
        gl->bindBufferBase(HBIL_GL__UNIFORM_BUFFER, slot, (unsigned)s->uniform_buffer);
    gl->bindBuffer(HBIL_GL__UNIFORM_BUFFER, (unsigned)s->uniform_generic);
    gl->useProgram(gl->isProgram((unsigned)s->program) ? (unsigned)s->program : 0);
    if (ctx->draws) hbil_gl__restore_draw(ctx, s);
}

/* A new data store each frame: last frame's may still be in use, and nobody has to wait for it. That there is none shows in its
 * size, which needs no glGetError on success. */
static int hbil_gl__write_constants(hbil_gl *ctx, const void *block)
{
    int size = 0;
    ctx->gl.bindBufferBase(HBIL_GL__UNIFORM_BUFFER, ctx->plan.constants_slot, ctx->buffer);
    ctx->gl.bufferData(HBIL_GL__UNIFORM_BUFFER, (ptrdiff_t)ctx->plan.constants_size, block, HBIL_GL__STREAM_DRAW);
    ctx->gl.getBufferParameteriv(HBIL_GL__UNIFORM_BUFFER, HBIL_GL__BUFFER_SIZE, &size);
    if ((uint32_t)size == ctx->plan.constants_size) return 1;
    hbil_gl__no_object(ctx, "the uniform block");
    return 0;
}

static void hbil_gl__bind(const hbil_gl *ctx, const hbil_binding *b, uint32_t frame)
{
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_texture *t = &ctx->plan.textures[b->texture];
    unsigned name = ctx->texture[b->texture][(frame % t->copies + t->copies - b->age) % t->copies];
    if (b->access == HBIL_ACCESS_WRITE) {
        if (!ctx->draws) gl->bindImageTexture(b->slot, name, b->mip, t->dim == HBIL_DIM_2D_ARRAY, 0,
                             b->role == HBIL_ROLE_UPDATE ? HBIL_GL__READ_WRITE : HBIL_GL__WRITE_ONLY, hbil_gl_format((hbil_format)t->format));
    } else {
        gl->activeTexture(HBIL_GL__TEXTURE0 + (unsigned)b->slot);
        gl->bindTexture(hbil_gl__targets[t->dim].target, name);
        gl->bindSampler(b->slot, ctx->samplers[hbil_gl__filtered(t)]);
    }
}

/* A GL barrier is named by the access that follows it. The image bit also holds stores back until earlier fetches are done
 * (OpenGL 4.3 core, section 7.12.2), so write-after-read needs nothing else. */
static void hbil_gl__dispatch(const hbil_gl *ctx, uint32_t index, uint32_t frame, const hbil_dispatch *grid)
{
    const hbil_gl_functions *gl = &ctx->gl;
    const hbil_pass *pass = &ctx->plan.passes[index];
    unsigned bits = 0;
    uint32_t i;
    for (i = 0; i < pass->binding_count; ++i) hbil_gl__bind(ctx, &pass->bindings[i], frame);
    gl->useProgram(ctx->program[index]);
    if (ctx->draws) { /* GL itself keeps draws and what they sample in order */
        hbil_gl__attach(ctx, index, frame);
        gl->viewport(0, 0, (int)grid->groups[0], (int)grid->groups[1]);
        gl->drawArrays(HBIL_GL__TRIANGLES, 0, 3);
        return;
    }
    for (i = 0; i < pass->barrier_count; ++i) {
        if (pass->barriers[i].after & HBIL_ACCESS_WRITE) bits |= HBIL_GL__SHADER_IMAGE_ACCESS_BARRIER_BIT;
        if (pass->barriers[i].after & HBIL_ACCESS_SAMPLE) bits |= HBIL_GL__TEXTURE_FETCH_BARRIER_BIT;
    }
    if (bits) gl->memoryBarrier(bits);
    gl->dispatchCompute(grid->groups[0], grid->groups[1], grid->groups[2]);
}

/* Time of the GL server once all earlier work is done. Timer queries read 0 around compute on llvmpipe; this is right there
 * and on hardware. ns */
static int64_t hbil_gl__time(const hbil_gl *ctx)
{
    int64_t time = 0;
    ctx->gl.finish();
    ctx->gl.getInteger64v(HBIL_GL__TIMESTAMP, &time);
    return time;
}

/* ---------------------------------------------------------------------------------------------------------- public */

const char *hbil_gl_result_name(hbil_gl_result result)
{
#define HBIL_GL__RESULT_TEXT(name, text) text,
    static const char *const names[] = { HBIL_GL_RESULTS(HBIL_GL__RESULT_TEXT) };
#undef HBIL_GL__RESULT_TEXT
    return (unsigned)result < HBIL_GL_RESULT_COUNT ? names[result] : "unknown";
}

unsigned hbil_gl_format(hbil_format format)
{
    switch (format) { /* no default: the compiler names a format of hbil.h that has no row here */
    case HBIL_FORMAT_R32F:    return HBIL_GL__R32F;
    case HBIL_FORMAT_R32UI:   return HBIL_GL__R32UI;
    case HBIL_FORMAT_RGBA32F: return HBIL_GL__RGBA32F;
    case HBIL_FORMAT_RGBA16F: return HBIL_GL__RGBA16F;
    case HBIL_FORMAT_ANY:
    case HBIL_FORMAT_COUNT:   break;
    }
    return 0;
}

hbil_gl_result hbil_gl_init(const hbil_gl_info *info, hbil_gl *ctx)
{
    hbil_gl_result result;
    hbil_diag diag;
    hbil_diags diags;
    if (!ctx) return HBIL_GL_E_ARG;
    memset(ctx, 0, sizeof *ctx);
    if (!info || !info->plan || !info->get_proc || !info->scratch)
        return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "hbil_gl_init: plan, get_proc and scratch have to be given");
    memset(&diag, 0, sizeof diag);
    diags.items = &diag;
    diags.capacity = 1;
    diags.count = 0;
    if (hbil_plan_check(info->plan, &diags) != HBIL_OK) return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "%s", diag.text);
    ctx->plan = *info->plan;
    ctx->timings = info->timings;
    ctx->es = ctx->plan.config.target == HBIL_TARGET_GLES;
    ctx->draws = ctx->plan.config.stage == HBIL_STAGE_FRAGMENT;
    if (ctx->plan.config.target != HBIL_TARGET_GL && !ctx->es)
        return hbil_gl__fail(ctx, HBIL_GL_E_PLAN, "the plan was built for another target: set target=gl or gles in the config before "
                             "hbil_plan_build");
    if (ctx->es && ctx->timings)
        return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "timings: OpenGL ES has no GL_TIMESTAMP; measure around hbil_gl_run, with glFinish");
    result = hbil_gl__load(ctx, info);
    if (result != HBIL_GL_OK) {
        memset(&ctx->gl, 0, sizeof ctx->gl); /* what shutdown goes by */
        return result;
    }
    result = hbil_gl__check_plan(ctx);
    if (result == HBIL_GL_OK) result = hbil_gl__make_programs(ctx, info);
    if (result == HBIL_GL_OK) result = hbil_gl__make_objects(ctx);
    if (result != HBIL_GL_OK) {
        char message[sizeof ctx->message];
        memcpy(message, ctx->message, sizeof message);
        hbil_gl_shutdown(ctx);
        memcpy(ctx->message, message, sizeof message);
        return result;
    }
    return HBIL_GL_OK;
}

hbil_gl_result hbil_gl_resize(hbil_gl *ctx, uint32_t width, uint32_t height, const unsigned textures[HBIL_MAX_TEXTURES])
{
    hbil_gl_result result;
    int bound[HBIL_GL__DIMS] = { 0 };
    uint32_t i;
    if (!ctx) return HBIL_GL_E_ARG;
    if (!ctx->samplers[0] || !textures)
        return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "hbil_gl_resize: hbil_gl_init has to succeed first, textures has to be given");
    ctx->runnable = 0;
    result = hbil_gl__check_context(ctx);
    if (result != HBIL_GL_OK) return result;
    if (!width) width = (uint32_t)ctx->plan.config.width;
    if (!height) height = (uint32_t)ctx->plan.config.height;
    for (i = 0; i < ctx->plan.texture_count; ++i)
        ctx->gl.getIntegerv(hbil_gl__targets[ctx->plan.textures[i].dim].binding, &bound[ctx->plan.textures[i].dim]);
    result = hbil_gl__set_textures(ctx, width, height, textures);
    for (i = 0; i < ctx->plan.texture_count; ++i)
        ctx->gl.bindTexture(hbil_gl__targets[ctx->plan.textures[i].dim].target, (unsigned)bound[ctx->plan.textures[i].dim]);
    return result;
}

hbil_gl_result hbil_gl_run(hbil_gl *ctx, const hbil_frame *frame)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_dispatch grid[HBIL_MAX_PASSES];
    hbil_gl__state state;
    hbil_frame now;
    hbil_diag diag;
    hbil_diags diags;
    uint32_t width, height, pass;
    if (!ctx) return HBIL_GL_E_ARG;
    if (!ctx->runnable || !frame)
        return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "hbil_gl_run: hbil_gl_resize has to succeed first, frame has to be given");
    width = frame->width ? frame->width : (uint32_t)ctx->plan.config.width;
    height = frame->height ? frame->height : (uint32_t)ctx->plan.config.height;
    if (width > ctx->width || height > ctx->height)
        return hbil_gl__fail(ctx, HBIL_GL_E_FRAME, "the frame is %u x %u, the last resize was %u x %u: call hbil_gl_resize",
                             (unsigned)width, (unsigned)height, (unsigned)ctx->width, (unsigned)ctx->height);
    if (hbil_gl__check_context(ctx) != HBIL_GL_OK) return HBIL_GL_E_CONTEXT;
    now = *frame;
    if (ctx->fresh) now.reset = 1; /* our textures hold garbage */
    frame = &now;
    memset(&diag, 0, sizeof diag);
    diags.items = &diag;
    diags.capacity = 1;
    diags.count = 0;
    if (hbil_pack_constants(&ctx->plan, frame, block, sizeof block, NULL, &diags) != HBIL_OK ||
        hbil_plan_frame(&ctx->plan, frame, grid) != HBIL_OK)
        return hbil_gl__fail(ctx, HBIL_GL_E_FRAME, "frame %u: %s", (unsigned)frame->index,
                             diag.text[0] ? diag.text : "does not fit the plan");
    hbil_gl__save(ctx, &state);
    if (!state.seamless) ctx->gl.enable(HBIL_GL__TEXTURE_CUBE_MAP_SEAMLESS); /* as Vulkan has it always */
    if (ctx->plan.constants_size && !hbil_gl__write_constants(ctx, block)) {
        hbil_gl__restore(ctx, &state);
        return HBIL_GL_E_MEMORY;
    }
    if (ctx->draws) hbil_gl__begin_draw(ctx);
    for (pass = 0; pass < ctx->plan.pass_count; ++pass) {
        int64_t start = ctx->timings ? hbil_gl__time(ctx) : 0;
        hbil_gl__dispatch(ctx, pass, ctx->frames, &grid[pass]);
        if (ctx->timings) ctx->ms[pass] = (double)(hbil_gl__time(ctx) - start) * 1e-6;
    }
    hbil_gl__restore(ctx, &state);
    ctx->fresh = 0;
    ++ctx->frames;
    return HBIL_GL_OK;
}

hbil_gl_result hbil_gl_timings(hbil_gl *ctx, double *ms)
{
    if (!ctx) return HBIL_GL_E_ARG;
    if (!ctx->timings || !ms)
        return hbil_gl__fail(ctx, HBIL_GL_E_ARG, "hbil_gl_timings: set timings=1 in hbil_gl_info, ms has to be given");
    memcpy(ms, ctx->ms, ctx->plan.pass_count * sizeof *ms);
    return HBIL_GL_OK;
}

void hbil_gl_shutdown(hbil_gl *ctx)
{
    uint32_t pass;
    if (!ctx) return;
    if (ctx->gl.deleteProgram) {
        hbil_gl__delete_textures(ctx);
        for (pass = 0; pass < ctx->plan.pass_count; ++pass) ctx->gl.deleteProgram(ctx->program[pass]);
        if (ctx->draws) {
            ctx->gl.deleteFramebuffers((int)ctx->plan.pass_count, ctx->framebuffer);
            ctx->gl.deleteVertexArrays(1, &ctx->vertex_array);
        }
        ctx->gl.deleteSamplers(2, ctx->samplers);
        ctx->gl.deleteBuffers(1, &ctx->buffer);
    }
    memset(ctx, 0, sizeof *ctx);
}

#ifdef __cplusplus
}
#endif
#endif /* HBIL_GL_IMPLEMENTATION */
