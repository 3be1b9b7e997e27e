/* gl.h - the GL functions that this program calls, on the context of runner_gl.c, and textures in and out. */
#ifndef HBIL_PEERS_GL_H
#define HBIL_PEERS_GL_H

#include <GL/glcorearb.h>

#include "../../frame/image.h"

#define GL_FUNCTIONS(X)                                    \
    X(PFNGLACTIVETEXTUREPROC, ActiveTexture)               \
    X(PFNGLATTACHSHADERPROC, AttachShader)                 \
    X(PFNGLBINDATTRIBLOCATIONPROC, BindAttribLocation)     \
    X(PFNGLBINDBUFFERPROC, BindBuffer)                     \
    X(PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer)           \
    X(PFNGLBINDTEXTUREPROC, BindTexture)                   \
    X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray)           \
    X(PFNGLBUFFERDATAPROC, BufferData)                     \
    X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, CheckFramebufferStatus) \
    X(PFNGLCLEARBUFFERFVPROC, ClearBufferfv)               \
    X(PFNGLCOMPILESHADERPROC, CompileShader)               \
    X(PFNGLCREATEPROGRAMPROC, CreateProgram)               \
    X(PFNGLCREATESHADERPROC, CreateShader)                 \
    X(PFNGLDELETEFRAMEBUFFERSPROC, DeleteFramebuffers)     \
    X(PFNGLDELETEPROGRAMPROC, DeleteProgram)               \
    X(PFNGLDELETESHADERPROC, DeleteShader)                 \
    X(PFNGLDELETETEXTURESPROC, DeleteTextures)             \
    X(PFNGLDRAWARRAYSPROC, DrawArrays)                     \
    X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray) \
    X(PFNGLFINISHPROC, Finish)                             \
    X(PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D) \
    X(PFNGLGENBUFFERSPROC, GenBuffers)                     \
    X(PFNGLGENFRAMEBUFFERSPROC, GenFramebuffers)           \
    X(PFNGLGENTEXTURESPROC, GenTextures)                   \
    X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays)           \
    X(PFNGLGETACTIVEUNIFORMPROC, GetActiveUniform)         \
    X(PFNGLGETERRORPROC, GetError)                         \
    X(PFNGLGETINTEGER64VPROC, GetInteger64v)               \
    X(PFNGLGETPROGRAMIVPROC, GetProgramiv)                 \
    X(PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)       \
    X(PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog)         \
    X(PFNGLGETSHADERIVPROC, GetShaderiv)                   \
    X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation)     \
    X(PFNGLLINKPROGRAMPROC, LinkProgram)                   \
    X(PFNGLMEMORYBARRIERPROC, MemoryBarrier)               \
    X(PFNGLREADPIXELSPROC, ReadPixels)                     \
    X(PFNGLSHADERSOURCEPROC, ShaderSource)                 \
    X(PFNGLTEXPARAMETERIPROC, TexParameteri)               \
    X(PFNGLTEXSTORAGE2DPROC, TexStorage2D)                 \
    X(PFNGLTEXSUBIMAGE2DPROC, TexSubImage2D)               \
    X(PFNGLUNIFORM1FVPROC, Uniform1fv)                     \
    X(PFNGLUNIFORM1IVPROC, Uniform1iv)                     \
    X(PFNGLUNIFORM2FVPROC, Uniform2fv)                     \
    X(PFNGLUNIFORM3FVPROC, Uniform3fv)                     \
    X(PFNGLUNIFORM4FVPROC, Uniform4fv)                     \
    X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv)         \
    X(PFNGLUSEPROGRAMPROC, UseProgram)                     \
    X(PFNGLVERTEXATTRIBPOINTERPROC, VertexAttribPointer)   \
    X(PFNGLVIEWPORTPROC, Viewport)
#define GL_MEMBER(type, name) type name;
typedef struct gl_functions { GL_FUNCTIONS(GL_MEMBER) } gl_functions;
extern gl_functions gl;

/* runner_gl.c's: get_proc of hbil_gl.h; user is the device of runner_gl.open. */
void *runner_gl_proc(void *user, const char *name);

/* 1, or 0: error[] names the function that the driver lacks. */
int    gl_load(void *device, char *error, size_t error_size);
/* Immutable, one level, nearest, clamped. data: NULL, or pixels of that format and type. It is left bound. */
GLuint gl_texture(GLenum format, int width, int height, GLenum pixels, GLenum type, const void *data);
/* Red of a texture. flip: the last row first. 1, or 0: out of memory. */
int    gl_read(GLuint texture, int width, int height, int flip, image *out);
/* ms by the device's clock once all is done before it. */
double gl_now(void);

#endif
