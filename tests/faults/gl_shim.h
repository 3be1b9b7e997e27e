/* gl_shim.h - stands between a program and GL: makes the n-th call of a function fail as GL says that it may, hides functions, lies about
 * versions and limits, loses the context, and counts what is made against what is deleted. Include behind GL/glcorearb.h and hbil_gl.h. */
#ifndef HBIL_TEST_GL_SHIM_H
#define HBIL_TEST_GL_SHIM_H

#include <string.h>

/* How a call fails. NAMES: gives zeros; ZERO: returns 0; STORE: does nothing; STATUS: says no; each leaves GL_OUT_OF_MEMORY. */
enum { NAMES, ZERO, STORE, STATUS, NEVER };
/* X(function of GL, its type, how it fails) */
#define GLS_VOID(X) \
    X(GenTextures, GENTEXTURES, NAMES) X(GenBuffers, GENBUFFERS, NAMES) X(GenSamplers, GENSAMPLERS, NAMES) \
    X(GenFramebuffers, GENFRAMEBUFFERS, NAMES) X(GenVertexArrays, GENVERTEXARRAYS, NAMES) \
    X(TexStorage2D, TEXSTORAGE2D, STORE) X(TexStorage3D, TEXSTORAGE3D, STORE) X(TexImage2D, TEXIMAGE2D, STORE) \
    X(TexImage3D, TEXIMAGE3D, STORE) X(BufferData, BUFFERDATA, STORE) X(TexSubImage2D, TEXSUBIMAGE2D, STORE) \
    X(ReadPixels, READPIXELS, STORE) X(GetShaderiv, GETSHADERIV, STATUS) X(GetProgramiv, GETPROGRAMIV, STATUS) \
    X(BindTexture, BINDTEXTURE, NEVER) X(BindBuffer, BINDBUFFER, NEVER) X(ActiveTexture, ACTIVETEXTURE, NEVER) \
    X(UseProgram, USEPROGRAM, NEVER) X(CompileShader, COMPILESHADER, NEVER) X(LinkProgram, LINKPROGRAM, NEVER) \
    X(DispatchCompute, DISPATCHCOMPUTE, NEVER) X(DrawArrays, DRAWARRAYS, NEVER) X(BindSampler, BINDSAMPLER, NEVER) \
    X(SamplerParameteri, SAMPLERPARAMETERI, NEVER)
/* The same, of those with a value: its type, what a call that fails returns, parameters, arguments */
#define GLS_VALUE(X)                                                  \
    X(CreateShader, CREATESHADER, ZERO, GLuint, 0, (GLenum k), (k))   \
    X(CreateProgram, CREATEPROGRAM, ZERO, GLuint, 0, (void), ())      \
    X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS, STATUS, GLenum, GL_FRAMEBUFFER_UNSUPPORTED, (GLenum t), (t))
/* X(function, its type, function that makes what it deletes) */
#define GLS_DELETES(X)                                                                                                        \
    X(DeleteTextures, DELETETEXTURES, GenTextures) X(DeleteBuffers, DELETEBUFFERS, GenBuffers)                                \
    X(DeleteSamplers, DELETESAMPLERS, GenSamplers) X(DeleteFramebuffers, DELETEFRAMEBUFFERS, GenFramebuffers)                 \
    X(DeleteVertexArrays, DELETEVERTEXARRAYS, GenVertexArrays)

#define GLS_ID(f, type, how) GLS_##f,
#define GLS_ID_VALUE(f, type, how, result, failed, parameters, arguments) GLS_##f,
enum { GLS_VOID(GLS_ID) GLS_VALUE(GLS_ID_VALUE) GLS_CALLS };
#define GLS_NAME(f, type, how) "gl" #f,
#define GLS_NAME_VALUE(f, type, how, result, failed, parameters, arguments) "gl" #f,
static const char *const gls_names[] = { GLS_VOID(GLS_NAME) GLS_VALUE(GLS_NAME_VALUE) };
#define GLS_HOW(f, type, how) how,
#define GLS_HOW_VALUE(f, type, how, result, failed, parameters, arguments) how,
static const int gls_how[] = { GLS_VOID(GLS_HOW) GLS_VALUE(GLS_HOW_VALUE) };

enum { GLS_LIVE = 512 };

static struct {
    int         call, at;                   /* which call of which function fails; at 0: none */
    int         calls[GLS_CALLS], all, failed;
    int         lose_at;                    /* the context is lost at that one of all calls; 0: never */
    int         lost;
    hbil_gl    *victim;                     /* whose functions then do nothing */
    GLenum      pending;                    /* error */
    const char *hidden, *version;           /* no such function; NULL: as it is */
    GLenum      limit;                      /* is 0; 0: none */
    struct { GLuint name; int kind; } live[GLS_LIVE];
    int         live_count, alien;
    void     *(*proc)(const char *name);
} gls;

static void gls_clear(void)
{
    gls.call = gls.at = gls.all = gls.failed = gls.lose_at = gls.lost = 0;
    memset(gls.calls, 0, sizeof gls.calls);
    gls.victim = NULL;
    gls.pending = GL_NO_ERROR;
    gls.hidden = gls.version = NULL;
    gls.limit = 0;
}

static void gls_made(int kind, GLuint name)
{
    if (name == 0) return;
    assert_true(gls.live_count < GLS_LIVE);
    gls.live[gls.live_count].name = name;
    gls.live[gls.live_count++].kind = kind;
}

static void gls_gone(int kind, GLuint name)
{
    int i;
    if (name == 0) return;
    for (i = 0; i < gls.live_count; ++i)
        if (gls.live[i].name == name && gls.live[i].kind == kind) break;
    if (i == gls.live_count) ++gls.alien;
    else gls.live[i] = gls.live[--gls.live_count];
}

/* ---- a lost context: no function has an effect, none changes a value that it is asked for */
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wpedantic"
#define GLS_LOST(when, type, member, name, args) static type HBIL_GL_CALL lost_##member args { return (type)0; }
HBIL_GL__FUNCTIONS(GLS_LOST)
#pragma GCC diagnostic pop
#define GLS_LOST_MEMBER(when, type, member, name, args) functions->member = lost_##member;
static void gls_lose(hbil_gl_functions *functions) { HBIL_GL__FUNCTIONS(GLS_LOST_MEMBER) }

/* 1: this call fails. */
static int gls_fault(int call)
{
    if (++gls.all == gls.lose_at && gls.victim) {
        gls_lose(&gls.victim->gl);
        gls.lost = 1;
    }
    if (++gls.calls[call] != gls.at || call != gls.call) return 0;
    ++gls.failed;
    if (gls_how[call] != STATUS) gls.pending = GL_OUT_OF_MEMORY;
    return 1;
}

/* What a call of NAMES or STATUS writes. */
static void gls_write(int call, GLint count, void *to)
{
    if (gls_how[call] == NAMES) memset(to, 0, (size_t)count * sizeof(GLuint));
    if (gls_how[call] == STATUS) *(GLint *)to = 0;
}

#define GLS_FUNCTION(f, type, how) static PFNGL##type##PROC gls_real_##f;
GLS_VOID(GLS_FUNCTION)
#define GLS_FUNCTION_VALUE(f, type, how, result, failed_, parameters, arguments)                                    \
    static PFNGL##type##PROC gls_real_##f;                                                                          \
    static result APIENTRY gls_##f parameters                                                                       \
    {                                                                                                               \
        result value = failed_;                                                                                     \
        if (gls_fault(GLS_##f) || gls.lost) return value;                                                           \
        value = gls_real_##f arguments;                                                                             \
        if (gls_how[GLS_##f] == ZERO) gls_made(GLS_##f, (GLuint)value);                                             \
        return value;                                                                                               \
    }
GLS_VALUE(GLS_FUNCTION_VALUE)

#define GLS_GEN(f)                                                                                                  \
    static void APIENTRY gls_##f(GLsizei n, GLuint *names)                                                          \
    {                                                                                                               \
        GLsizei i;                                                                                                  \
        if (gls_fault(GLS_##f)) gls_write(GLS_##f, n, names);                                                       \
        else if (!gls.lost) gls_real_##f(n, names);                                                                 \
        else return;                                                                                                \
        for (i = 0; i < n; ++i) gls_made(GLS_##f, names[i]);                                                        \
    }
GLS_GEN(GenTextures) GLS_GEN(GenBuffers) GLS_GEN(GenSamplers) GLS_GEN(GenFramebuffers) GLS_GEN(GenVertexArrays)
#define GLS_QUERY(f)                                                                                                \
    static void APIENTRY gls_##f(GLuint s, GLenum n, GLint *value)                                                  \
    {                                                                                                               \
        if (gls_fault(GLS_##f)) gls_write(GLS_##f, 1, value);                                                       \
        else if (!gls.lost) gls_real_##f(s, n, value);                                                              \
    }
GLS_QUERY(GetShaderiv) GLS_QUERY(GetProgramiv)
#define GLS_PLAIN(f, parameters, arguments) \
    static void APIENTRY gls_##f parameters { if (!gls_fault(GLS_##f) && !gls.lost) gls_real_##f arguments; }
GLS_PLAIN(TexStorage2D, (GLenum t, GLsizei l, GLenum f, GLsizei w, GLsizei h), (t, l, f, w, h))
GLS_PLAIN(TexStorage3D, (GLenum t, GLsizei l, GLenum f, GLsizei w, GLsizei h, GLsizei d), (t, l, f, w, h, d))
GLS_PLAIN(TexImage2D, (GLenum t, GLint l, GLint f, GLsizei w, GLsizei h, GLint b, GLenum c, GLenum y, const void *p),
          (t, l, f, w, h, b, c, y, p))
GLS_PLAIN(TexImage3D, (GLenum t, GLint l, GLint f, GLsizei w, GLsizei h, GLsizei d, GLint b, GLenum c, GLenum y, const void *p),
          (t, l, f, w, h, d, b, c, y, p))
GLS_PLAIN(TexSubImage2D, (GLenum t, GLint l, GLint x, GLint y, GLsizei w, GLsizei h, GLenum f, GLenum k, const void *p),
          (t, l, x, y, w, h, f, k, p))
GLS_PLAIN(ReadPixels, (GLint x, GLint y, GLsizei w, GLsizei h, GLenum f, GLenum k, void *p), (x, y, w, h, f, k, p))
GLS_PLAIN(BindTexture, (GLenum t, GLuint n), (t, n))
GLS_PLAIN(BindBuffer, (GLenum t, GLuint n), (t, n))
GLS_PLAIN(ActiveTexture, (GLenum t), (t))
GLS_PLAIN(UseProgram, (GLuint p), (p))
GLS_PLAIN(CompileShader, (GLuint s), (s))
GLS_PLAIN(LinkProgram, (GLuint p), (p))
GLS_PLAIN(DispatchCompute, (GLuint x, GLuint y, GLuint z), (x, y, z))
GLS_PLAIN(DrawArrays, (GLenum m, GLint f, GLsizei n), (m, f, n))
GLS_PLAIN(BindSampler, (GLuint u, GLuint s), (u, s))
GLS_PLAIN(SamplerParameteri, (GLuint s, GLenum n, GLint v), (s, n, v))

/* What GL leaves of a buffer whose store it cannot make. */
static void APIENTRY gls_BufferData(GLenum t, GLsizeiptr s, const void *p, GLenum u)
{
    if (gls_fault(GLS_BufferData)) gls_real_BufferData(t, 0, NULL, u);
    else if (!gls.lost) gls_real_BufferData(t, s, p, u);
}

#define GLS_DELETE(f, type, made)                                                                                   \
    static PFNGL##type##PROC gls_real_##f;                                                                          \
    static void APIENTRY gls_##f(GLsizei n, const GLuint *names)                                                    \
    {                                                                                                               \
        GLsizei i;                                                                                                  \
        for (i = 0; i < n; ++i) gls_gone(GLS_##made, names[i]);                                                     \
        gls_real_##f(n, names);                                                                                     \
    }
GLS_DELETES(GLS_DELETE)

static PFNGLDELETESHADERPROC  gls_real_DeleteShader;
static PFNGLDELETEPROGRAMPROC gls_real_DeleteProgram;
static PFNGLGETERRORPROC      gls_real_GetError;
static PFNGLGETSTRINGPROC     gls_real_GetString;
static PFNGLGETINTEGERVPROC   gls_real_GetIntegerv;

static void APIENTRY gls_DeleteShader(GLuint name)
{
    gls_gone(GLS_CreateShader, name);
    gls_real_DeleteShader(name);
}

static void APIENTRY gls_DeleteProgram(GLuint name)
{
    gls_gone(GLS_CreateProgram, name);
    gls_real_DeleteProgram(name);
}

static GLenum APIENTRY gls_GetError(void)
{
    const GLenum pending = gls.pending;
    gls.pending = GL_NO_ERROR;
    return pending != GL_NO_ERROR ? pending : gls_real_GetError();
}

static const GLubyte *APIENTRY gls_GetString(GLenum name)
{
    return name == GL_VERSION && gls.version ? (const GLubyte *)gls.version : gls_real_GetString(name);
}

static void APIENTRY gls_GetIntegerv(GLenum name, GLint *value)
{
    gls_real_GetIntegerv(name, value);
    if (gls.limit && name == gls.limit) *value = 0;
}

/* Deletes what a lost context has kept, which is not really lost. */
static void gls_sweep(int from)
{
    while (gls.live_count > from) {
        const GLuint name = gls.live[gls.live_count - 1].name;
        const int kind = gls.live[--gls.live_count].kind;
#define GLS_SWEEP(f, type, made) if (kind == GLS_##made) gls_real_##f(1, &name);
        GLS_DELETES(GLS_SWEEP)
        if (kind == GLS_CreateShader) gls_real_DeleteShader(name);
        if (kind == GLS_CreateProgram) gls_real_DeleteProgram(name);
    }
}

static void *gls_address(void (*function)(void))
{
    void *address;
    memcpy(&address, &function, sizeof address); /* ISO C has no conversion between the two */
    return address;
}

static void *gls_proc(const char *name)
{
    void *real = gls.proc(name), *mine = NULL;
    if (gls.hidden && strcmp(name, gls.hidden) == 0) return NULL;
    if (!real) return NULL;
#define GLS_TAKE(f)                                                         \
    if (strcmp(name, "gl" #f) == 0) {                                       \
        void *const wrapper = gls_address((void (*)(void))gls_##f);         \
        memcpy(&gls_real_##f, &real, sizeof real);                          \
        mine = wrapper;                                                     \
    }
#define GLS_TAKE_VOID(f, type, how) GLS_TAKE(f)
#define GLS_TAKE_VALUE(f, type, how, result, failed, parameters, arguments) GLS_TAKE(f)
#define GLS_TAKE_DELETE(f, type, made) GLS_TAKE(f)
    GLS_VOID(GLS_TAKE_VOID)
    GLS_VALUE(GLS_TAKE_VALUE)
    GLS_DELETES(GLS_TAKE_DELETE)
    GLS_TAKE(DeleteShader)
    GLS_TAKE(DeleteProgram)
    GLS_TAKE(GetError)
    GLS_TAKE(GetString)
    GLS_TAKE(GetIntegerv)
    return mine ? mine : real;
}

#endif
