/* gl.c - see gl.h */
#include "gl.h"

#include <stddef.h>
#include <string.h>

gl_functions gl;

int gl_load(void *device, char *error, size_t error_size)
{
#define GL_ROW(type, name) { "gl" #name, offsetof(gl_functions, name) },
    static const struct { const char *name; size_t offset; } table[] = { GL_FUNCTIONS(GL_ROW) };
    size_t i;

    for (i = 0; i < sizeof table / sizeof *table; ++i) {
        void *address = runner_gl_proc(device, table[i].name);

        if (!address) return frame_error(error, error_size, "the GL driver has no %s: update it", table[i].name);
        memcpy((char *)&gl + table[i].offset, &address, sizeof address);
    }
    return 1;
}

GLuint gl_texture(GLenum format, int width, int height, GLenum pixels, GLenum type, const void *data)
{
    GLuint name = 0;

    gl.GenTextures(1, &name);
    gl.BindTexture(GL_TEXTURE_2D, name);
    gl.TexStorage2D(GL_TEXTURE_2D, 1, format, width, height);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    if (data) gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, pixels, type, data);
    return name;
}

int gl_read(GLuint texture, int width, int height, int flip, image *out)
{
    GLuint framebuffer = 0;
    image  all = {0, 0, 0, NULL};
    int    x, y;

    if (!image_make(out, width, height, 1) || !image_make(&all, width, height, 4)) {
        image_free(out);
        return 0;
    }
    gl.MemoryBarrier(GL_FRAMEBUFFER_BARRIER_BIT);
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    gl.FramebufferTexture2D(GL_READ_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, all.data);
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, 0);
    gl.DeleteFramebuffers(1, &framebuffer);
    for (y = 0; y < height; ++y)
        for (x = 0; x < width; ++x) out->data[y * width + x] = all.data[4 * ((flip ? height - 1 - y : y) * width + x)];
    image_free(&all);
    return 1;
}

double gl_now(void)
{
    GLint64 ns = 0;

    gl.Finish();
    gl.GetInteger64v(GL_TIMESTAMP, &ns);
    return (double)ns * 1e-6;
}
