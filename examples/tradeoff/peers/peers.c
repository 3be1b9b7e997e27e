/* peers.c - see peers.h. A recipe is small: a few passes, each a full-screen triangle into one texture. */
#include "peers.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../frame/json.h"
#include "gl.h"

#define PROGRAMS_MAX 64
#define TEXTURES_MAX 16
#define PASSES_MAX 8
#define UNIFORMS_MAX 48
#define NAME 64
#define FILE_MAX (1u << 20)
#define SKY_FROM 1e9f /* m */

typedef struct program {
    char   vertex[NAME], fragment[NAME];
    GLuint name;
} program;

struct peers {
    GLuint  vertices, depth, normal, white;
    int     width, height;
    program programs[PROGRAMS_MAX];
    int     program_count;
};

typedef struct uniform {
    char   name[NAME];
    GLint  location;
    GLenum type;
    int    count; /* elements of an array, or 1 */
    int    unit;  /* of a sampler */
    GLuint texture;
    float *values;
} uniform;

typedef struct pass {
    GLuint  program, framebuffer;
    int     width, height; /* of its target */
    int     clears, timed;
    float   clear[4];
    uniform uniforms[UNIFORMS_MAX];
    int     uniform_count;
} pass;

typedef struct target {
    GLuint name;
    int    width, height, own;
} target;

struct peer_pass {
    target textures[TEXTURES_MAX];
    pass   passes[PASSES_MAX];
    int    texture_count, pass_count, taps, result;
    GLuint vertices;
};

/* ----------------------------------------------------------------------------------------------------------- frame */

peers *peers_open(void *device, char *error, size_t error_size)
{
    static const float         corners[] = {-1, -1, 0, 0, 0, 3, -1, 0, 2, 0, -1, 3, 0, 0, 2}; /* position, uv */
    static const unsigned char white[] = {255, 255, 255, 255};
    peers                     *p = calloc(1, sizeof *p);
    GLuint                     buffer = 0;

    if (!p || !gl_load(device, error, error_size)) {
        if (!p) frame_error(error, error_size, "out of memory");
        free(p);
        return NULL;
    }
    gl.GenVertexArrays(1, &p->vertices);
    gl.BindVertexArray(p->vertices);
    gl.GenBuffers(1, &buffer); /* lives as long as the context */
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    gl.BufferData(GL_ARRAY_BUFFER, sizeof corners, corners, GL_STATIC_DRAW);
    gl.VertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 20, NULL);
    gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, 20, (const void *)12);
    gl.EnableVertexAttribArray(0);
    gl.EnableVertexAttribArray(1);
    gl.BindVertexArray(0);
    p->white = gl_texture(GL_RGBA8, 1, 1, GL_RGBA, GL_UNSIGNED_BYTE, white);
    return p;
}

void peers_close(peers *p)
{
    int i;

    if (!p) return;
    for (i = 0; i < p->program_count; ++i) gl.DeleteProgram(p->programs[i].name);
    gl.DeleteTextures(1, &p->depth);
    gl.DeleteTextures(1, &p->normal);
    gl.DeleteTextures(1, &p->white);
    free(p);
}

/* Linear depth to the depth buffer's value; float, since a 24-bit buffer is no finer near 1, where nearly all of it
 * lies. */
static float device_depth(const capture *cap, float linear)
{
    const double a = (double)cap->projection[10], b = (double)cap->projection[14], z = (double)linear;

    if (!(linear < SKY_FROM)) return 1.0f;
    return (float)fmin(fmax(0.5 + 0.5 * (b - a * z) / z, 0.0), 1.0);
}

int peers_frame(peers *p, const capture *cap, char *error, size_t error_size)
{
    const int w = cap->width, h = cap->height;
    image     depth = {0, 0, 0, NULL}, normal = {0, 0, 0, NULL};
    int       x, y, c;

    if (cap->orthographic)
        return frame_error(error, error_size, "an orthographic frame: the peers are bound for perspective ones");
    if (!image_make(&depth, w, h, 1) || !image_make(&normal, w, h, 4)) {
        image_free(&depth);
        return frame_error(error, error_size, "out of memory");
    }
    for (y = 0; y < h; ++y) {
        for (x = 0; x < w; ++x) {
            const int from = y * w + x, to = (h - 1 - y) * w + x;

            depth.data[to] = device_depth(cap, cap->depth.data[from]);
            for (c = 0; c < 3; ++c) normal.data[4 * to + c] = 0.5f * cap->normal.data[3 * from + c] + 0.5f;
            normal.data[4 * to + 3] = 1.0f;
        }
    }
    gl.DeleteTextures(1, &p->depth);
    gl.DeleteTextures(1, &p->normal);
    p->depth = gl_texture(GL_R32F, w, h, GL_RED, GL_FLOAT, depth.data);
    p->normal = gl_texture(GL_RGBA16F, w, h, GL_RGBA, GL_FLOAT, normal.data);
    p->width = w;
    p->height = h;
    image_free(&depth);
    image_free(&normal);
    return 1;
}

/* -------------------------------------------------------------------------------------------------------- programs */

static GLuint compile(GLenum stage, const char *folder, const char *file, char *error, size_t error_size)
{
    char   path[1024], log[512] = "", *text;
    GLuint shader;
    GLint  ok = 0;

    snprintf(path, sizeof path, "%s/%s", folder, file);
    text = text_read(path, FILE_MAX, "a shader of extract.mjs", error, error_size);
    if (!text) return 0;
    shader = gl.CreateShader(stage);
    gl.ShaderSource(shader, 1, (const char *const *)&text, NULL);
    gl.CompileShader(shader);
    free(text);
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok) return shader;
    gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
    gl.DeleteShader(shader);
    frame_error(error, error_size, "%s: the GL driver rejects it: %s", path, log);
    return 0;
}

static GLuint link_program(const char *folder, const char *vertex, const char *fragment, char *error, size_t error_size)
{
    const GLuint name = gl.CreateProgram();
    const GLuint v = compile(GL_VERTEX_SHADER, folder, vertex, error, error_size);
    const GLuint f = v ? compile(GL_FRAGMENT_SHADER, folder, fragment, error, error_size) : 0;
    char         log[512] = "";
    GLint        ok = 0;

    if (f) {
        gl.AttachShader(name, v);
        gl.AttachShader(name, f);
        gl.BindAttribLocation(name, 0, "position");
        gl.BindAttribLocation(name, 1, "uv");
        gl.LinkProgram(name);
        gl.GetProgramiv(name, GL_LINK_STATUS, &ok);
        gl.GetProgramInfoLog(name, sizeof log, NULL, log);
        if (!ok) frame_error(error, error_size, "%s/%s does not link: %s", folder, fragment, log);
    }
    gl.DeleteShader(v);
    gl.DeleteShader(f);
    if (ok) return name;
    gl.DeleteProgram(name);
    return 0;
}

/* Files are named after their content: the same name is the same program, in all recipes. */
static GLuint find_program(peers *p, const char *folder, const char *vertex, const char *fragment, char *error,
                           size_t error_size)
{
    program *q = p->programs;
    int      i;

    for (i = 0; i < p->program_count; ++i, ++q)
        if (strcmp(q->vertex, vertex) == 0 && strcmp(q->fragment, fragment) == 0) return q->name;
    if (p->program_count == PROGRAMS_MAX || strlen(vertex) >= NAME || strlen(fragment) >= NAME) {
        frame_error(error, error_size, "%s: more than %d programs, or file names of more than %d letters", folder,
                    PROGRAMS_MAX, NAME);
        return 0;
    }
    q->name = link_program(folder, vertex, fragment, error, error_size);
    if (!q->name) return 0;
    strcpy(q->vertex, vertex);
    strcpy(q->fragment, fragment);
    p->program_count++;
    return q->name;
}

/* --------------------------------------------------------------------------------------------------------- recipes */

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(object, name));
    return text ? text : "";
}

static int int_of(const cJSON *object, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, name);
    return cJSON_IsNumber(item) ? item->valueint : -1;
}

static int truth_of(const cJSON *object, const char *name)
{
    return cJSON_IsTrue(cJSON_GetObjectItemCaseSensitive(object, name));
}

/* Bytes of a texture that the package brings, rgba8. */
static void *read_bytes(const char *folder, const char *file, size_t size, char *error, size_t error_size)
{
    char  path[1024];
    void *bytes = malloc(size);
    FILE *f;

    snprintf(path, sizeof path, "%s/%s", folder, file);
    f = fopen(path, "rb");
    if (!bytes || !f || fread(bytes, 1, size, f) != size) {
        frame_error(error, error_size,
                    "%s: not the %zu bytes of a texture. Empty the cache folder's recipes and run again", path, size);
        free(bytes);
        bytes = NULL;
    }
    if (f) fclose(f);
    return bytes;
}

static int load_texture(const peers *p, target *t, const cJSON *entry, const char *folder, char *error,
                        size_t error_size)
{
    static const struct {
        const char *name;
        GLenum      format;
    } formats[] = {{"rgba8", GL_RGBA8}, {"rgba16f", GL_RGBA16F}, {"r32f", GL_R32F}, {"rgba32f", GL_RGBA32F}};
    const char *input = text_of(entry, "input"), *format = text_of(entry, "format"), *file = text_of(entry, "data");
    const int   kinds = (int)(sizeof formats / sizeof *formats);
    void       *data = NULL;
    int         i;

    t->width = *input ? p->width : int_of(entry, "width");
    t->height = *input ? p->height : int_of(entry, "height");
    if (*input) {
        t->name = strcmp(input, "depth") == 0 ? p->depth : strcmp(input, "normal") == 0 ? p->normal : p->white;
        return 1;
    }
    for (i = 0; i < kinds && strcmp(formats[i].name, format) != 0; ++i) {}
    if (i == kinds || t->width < 1 || t->height < 1)
        return frame_error(error, error_size, "%s: a texture of format %s", folder, format);
    if (*file) {
        data = read_bytes(folder, file, 4 * (size_t)t->width * (size_t)t->height, error, error_size);
        if (!data) return 0;
    }
    t->own = 1;
    t->name = gl_texture(formats[i].format, t->width, t->height, GL_RGBA, GL_UNSIGNED_BYTE, data);
    free(data);
    if (truth_of(entry, "linear")) {
        gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    }
    if (truth_of(entry, "repeat")) {
        gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
        gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
    }
    return 1;
}

/* Floats of an element; 0: not a type that these passes have. */
static int components(GLenum type)
{
    switch (type) {
    case GL_FLOAT:
    case GL_INT:
    case GL_BOOL:
    case GL_SAMPLER_2D: return 1;
    case GL_FLOAT_VEC2: return 2;
    case GL_FLOAT_VEC3: return 3;
    case GL_FLOAT_VEC4: return 4;
    case GL_FLOAT_MAT4: return 16;
    default: return 0;
    }
}

static const cJSON *find_uniform(const cJSON *list, const char *name)
{
    const cJSON *item;

    cJSON_ArrayForEach(item, list) if (strcmp(text_of(item, "name"), name) == 0) return item;
    return NULL;
}

/* A sampler without a texture reads white: three.js binds an empty one there. */
static int fill_uniform(const peers *p, const peer_pass *q, uniform *u, const cJSON *entry, char *error,
                        size_t error_size)
{
    const int    wanted = u->count * components(u->type), index = entry ? int_of(entry, "texture") : -1;
    const cJSON *values = entry ? cJSON_GetObjectItemCaseSensitive(entry, "values") : NULL;
    int          i;

    if (u->type == GL_SAMPLER_2D) {
        u->texture = index >= 0 && index < q->texture_count ? q->textures[index].name : p->white;
        return 1;
    }
    if (wanted == 0 || cJSON_GetArraySize(values) < wanted)
        return frame_error(error, error_size,
                           "uniform %s: the shader takes %d numbers of type 0x%04x, the recipe has %d", u->name, wanted,
                           u->type, cJSON_GetArraySize(values));
    u->values = malloc((size_t)wanted * sizeof *u->values);
    for (i = 0; u->values && i < wanted; ++i) u->values[i] = (float)cJSON_GetArrayItem(values, i)->valuedouble;
    return u->values != NULL;
}

static int load_uniforms(const peers *p, const peer_pass *q, pass *to, const cJSON *list, char *error,
                         size_t error_size)
{
    GLint active = 0;
    int   i, unit = 0;

    gl.GetProgramiv(to->program, GL_ACTIVE_UNIFORMS, &active);
    if (active > UNIFORMS_MAX)
        return frame_error(error, error_size, "a shader with more than %d uniforms", UNIFORMS_MAX);
    for (i = 0; i < active; ++i) {
        uniform *u = &to->uniforms[to->uniform_count];
        char    *bracket;
        GLint    count = 0;

        gl.GetActiveUniform(to->program, (GLuint)i, sizeof u->name, NULL, &count, &u->type, u->name);
        bracket = strchr(u->name, '[');
        if (bracket) *bracket = 0;
        u->location = gl.GetUniformLocation(to->program, u->name);
        u->count = count;
        u->unit = u->type == GL_SAMPLER_2D ? unit++ : 0;
        to->uniform_count++;
        if (!fill_uniform(p, q, u, find_uniform(list, u->name), error, error_size)) return 0;
    }
    return 1;
}

static int load_pass(peers *p, peer_pass *q, pass *to, const cJSON *entry, const char *folder, char *error,
                     size_t error_size)
{
    const cJSON  *clear = cJSON_GetObjectItemCaseSensitive(entry, "clear");
    const int     index = int_of(entry, "target");
    const target *t = &q->textures[index];
    int           i;

    if (index < 0 || index >= q->texture_count || !t->own)
        return frame_error(error, error_size, "%s: a pass without a target", folder);
    to->program = find_program(p, folder, text_of(entry, "vertex"), text_of(entry, "fragment"), error, error_size);
    if (!to->program) return 0;
    to->width = t->width;
    to->height = t->height;
    to->timed = truth_of(entry, "timed");
    to->clears = cJSON_GetArraySize(clear) == 4;
    for (i = 0; i < 4 && to->clears; ++i) to->clear[i] = (float)cJSON_GetArrayItem(clear, i)->valuedouble;
    gl.GenFramebuffers(1, &to->framebuffer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, to->framebuffer);
    gl.FramebufferTexture2D(GL_DRAW_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, t->name, 0);
    if (gl.CheckFramebufferStatus(GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return frame_error(error, error_size, "%s: the GL driver does not draw into a texture of that format", folder);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    return load_uniforms(p, q, to, cJSON_GetObjectItemCaseSensitive(entry, "uniforms"), error, error_size);
}

static int load_all(peers *p, peer_pass *q, const cJSON *root, const char *folder, char *error, size_t error_size)
{
    const cJSON *textures = cJSON_GetObjectItemCaseSensitive(root, "textures");
    const cJSON *passes = cJSON_GetObjectItemCaseSensitive(root, "passes"), *entry;

    q->taps = int_of(root, "taps");
    q->result = int_of(root, "result");
    q->vertices = p->vertices;
    if (cJSON_GetArraySize(textures) > TEXTURES_MAX || cJSON_GetArraySize(passes) > PASSES_MAX || q->result < 0
        || q->result >= cJSON_GetArraySize(textures))
        return frame_error(error, error_size, "%s: not a recipe of extract.mjs", folder);
    cJSON_ArrayForEach(entry, textures) if (!load_texture(p, &q->textures[q->texture_count++], entry, folder, error,
                                                          error_size)) return 0;
    cJSON_ArrayForEach(
        entry, passes) if (!load_pass(p, q, &q->passes[q->pass_count++], entry, folder, error, error_size)) return 0;
    return 1;
}

peer_pass *peer_load(peers *p, const char *folder, const char *name, char *error, size_t error_size)
{
    peer_pass *q = calloc(1, sizeof *q);
    cJSON     *root;
    char       path[1024];
    int        ok;

    snprintf(path, sizeof path, "%s/%s.json", folder, name);
    root = q ? json_read(path, FILE_MAX, "a recipe of extract.mjs", error, error_size) : NULL;
    ok = root && load_all(p, q, root, folder, error, error_size);
    cJSON_Delete(root);
    if (ok) return q;
    peer_free(q);
    return NULL;
}

void peer_free(peer_pass *q)
{
    int i, k;

    if (!q) return;
    for (i = 0; i < q->pass_count; ++i) {
        gl.DeleteFramebuffers(1, &q->passes[i].framebuffer);
        for (k = 0; k < q->passes[i].uniform_count; ++k) free(q->passes[i].uniforms[k].values);
    }
    for (i = 0; i < q->texture_count; ++i)
        if (q->textures[i].own) gl.DeleteTextures(1, &q->textures[i].name);
    free(q);
}

int peer_taps(const peer_pass *q)
{
    return q->taps;
}

int peer_set(peer_pass *q, const char *name, float value)
{
    int i, k, found = 0;

    for (i = 0; i < q->pass_count; ++i)
        for (k = 0; k < q->passes[i].uniform_count; ++k)
            if (strcmp(q->passes[i].uniforms[k].name, name) == 0 && q->passes[i].uniforms[k].values) {
                q->passes[i].uniforms[k].values[0] = value;
                ++found;
            }
    return found;
}

/* ------------------------------------------------------------------------------------------------------------- run */

static void set_uniform(const uniform *u)
{
    GLint whole = u->values ? (GLint)u->values[0] : u->unit;

    switch (u->type) {
    case GL_SAMPLER_2D:
        gl.ActiveTexture(GL_TEXTURE0 + (GLenum)u->unit);
        gl.BindTexture(GL_TEXTURE_2D, u->texture);
        gl.Uniform1iv(u->location, 1, &whole);
        break;
    case GL_INT:
    case GL_BOOL: gl.Uniform1iv(u->location, 1, &whole); break;
    case GL_FLOAT: gl.Uniform1fv(u->location, u->count, u->values); break;
    case GL_FLOAT_VEC2: gl.Uniform2fv(u->location, u->count, u->values); break;
    case GL_FLOAT_VEC3: gl.Uniform3fv(u->location, u->count, u->values); break;
    case GL_FLOAT_VEC4: gl.Uniform4fv(u->location, u->count, u->values); break;
    default: gl.UniformMatrix4fv(u->location, u->count, GL_FALSE, u->values); break;
    }
}

static void draw(const pass *p)
{
    int k;

    gl.UseProgram(p->program);
    for (k = 0; k < p->uniform_count; ++k) set_uniform(&p->uniforms[k]);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, p->framebuffer);
    gl.Viewport(0, 0, p->width, p->height);
    if (p->clears) gl.ClearBufferfv(GL_COLOR, 0, p->clear);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

int peer_run(peer_pass *q, double *ms, char *error, size_t error_size)
{
    double begin;
    GLenum code;
    int    i;

    gl.BindVertexArray(q->vertices);
    begin = gl_now();
    for (i = 0; i < q->pass_count; ++i)
        if (q->passes[i].timed) draw(&q->passes[i]);
    if (ms) *ms = gl_now() - begin;
    for (i = 0; i < q->pass_count; ++i)
        if (!q->passes[i].timed) draw(&q->passes[i]);
    gl.BindVertexArray(0);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.UseProgram(0);
    code = gl.GetError();
    return code == GL_NO_ERROR || frame_error(error, error_size, "GL error 0x%04x while a peer is drawn", code);
}

int peer_read(const peer_pass *q, image *ao)
{
    const target *t = &q->textures[q->result];
    return gl_read(t->name, t->width, t->height, 1, ao);
}
