/* checked.c - rewrites calls and divisions of emitted text, and wraps its main. Looks at
 *   sqrt, log2, inversesqrt, normalize   arguments outside their domain, NaN
 *   int(), uint(), ivec2(), uvec3()      of numbers that do not fit, NaN
 *   a / b, a /= b                        b = 0
 *   a << b, a >> b                       b outside [0, 31]
 *   clamp, smoothstep                    of NaN, or between bounds that are the wrong way round
 *   texelFetch, imageLoad, imageStore    outside the texture
 * A fault changes no result: it is written to the output "faults". */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "checked.h"

static const char *const kinds[] = { "an argument outside its function's domain", "a division by zero", "a number that fits no integer",
                                     "a texel outside the texture", "a clamp of NaN or between bounds the wrong way round" };

void checked_plan(const hbil_plan *plan, hbil_plan *out)
{
    const uint16_t index = (uint16_t)plan->texture_count;
    hbil_texture *t = &out->textures[index];
    uint32_t p;
    *out = *plan;
    if (index == HBIL_MAX_TEXTURES) return;
    strcpy(t->name, "faults");
    t->format = HBIL_FORMAT_R32F;
    t->life = HBIL_LIFE_OUTPUT;
    t->div = t->mips = t->copies = 1;
    t->dim = HBIL_DIM_2D_ARRAY;
    t->layers = (uint16_t)(plan->pass_count < 2 ? 2 : plan->pass_count);
    ++out->texture_count;
    for (p = 0; p < plan->pass_count; ++p) {
        hbil_pass *pass = &out->passes[p];
        hbil_binding *b = &pass->bindings[pass->binding_count];
        uint32_t i;
        if (pass->binding_count == HBIL_MAX_BINDINGS) {
            *out = *plan;
            return;
        }
        memset(b, 0, sizeof *b);
        b->texture = index;
        b->access = HBIL_ACCESS_WRITE;
        b->role = HBIL_ROLE_WRITE;
        b->slot = (uint16_t)(plan->constants_slot + 1);
        for (i = 0; i < pass->binding_count; ++i)
            if (pass->bindings[i].slot >= b->slot) b->slot = (uint16_t)(pass->bindings[i].slot + 1);
        ++pass->binding_count;
    }
}

int checked_strip(const hbil_plan *plan, hbil_plan *out)
{
    uint32_t p;
    *out = *plan;
    if (!plan->texture_count || strcmp(plan->textures[plan->texture_count - 1].name, "faults")) return 0;
    memset(&out->textures[--out->texture_count], 0, sizeof *out->textures);
    for (p = 0; p < plan->pass_count; ++p) memset(&out->passes[p].bindings[--out->passes[p].binding_count], 0, sizeof(hbil_binding));
    return 1;
}

/* ------------------------------------------------------------------------------------------------------------------- rewriting */

typedef struct writer { char *at, *end; } writer;

static void put(writer *w, const char *s, size_t n)
{
    if ((size_t)(w->end - w->at) <= n) n = 0; /* does not happen: 4 times the text */
    memcpy(w->at, s, n);
    w->at += n;
    *w->at = 0;
}

static void puts_to(writer *w, const char *s) { put(w, s, strlen(s)); }

static int is_word(char c) { return isalnum((unsigned char)c) || c == '_'; }

static const char *behind(const char *s)
{
    int depth = 0;
    do {
        depth += strchr("([{", *s) ? 1 : strchr(")]}", *s) ? -1 : 0;
        ++s;
    } while (depth && *s);
    return s;
}

/* The end of the argument at s: its comma or the closing bracket. */
static const char *argument(const char *s)
{
    while (*s != ',' && *s != ')') s = strchr("([", *s) ? behind(s) : s + 1;
    return s;
}

static void rewrite(writer *w, const char *s, const char *end);

/* texelFetch(u_x, p, level) and the like: p is looked at. */
static const char *rewrite_access(writer *w, const char *s, const char *text, int is_image)
{
    const char *name = strchr(s, '(') + 1, *p = argument(name), *next = argument(p + 1), *end = behind(name - 1);
    char declared[96];
    snprintf(declared, sizeof declared, "sampler2DMS %.*s;", (int)(p - name), name);
    put(w, s, (size_t)(p + 1 - s));
    puts_to(w, " ck_in(");
    rewrite(w, p + 1, next);
    puts_to(w, is_image ? ", imageSize(" : ", textureSize(");
    put(w, name, (size_t)(p - name));
    puts_to(w, is_image || strstr(text, declared) ? "))" : ", 0))");
    rewrite(w, next, end);
    return end;
}

/* a / b, a << b, a / = b: the b. */
static const char *rewrite_divisor(writer *w, const char *s, const char *function)
{
    const char *from, *end;
    put(w, s, 1);
    ++s;
    if (*s == '=') {
        put(w, s, 1);
        from = s + 1;
        for (end = from; *end != ';';) end = strchr("([", *end) ? behind(end) : end + 1;
    } else {
        while (*s == ' ') ++s;
        from = end = s;
        if (isdigit((unsigned char)*s)) return s; /* a number */
        while (is_word(*end)) ++end;
        while (*end == '(' || *end == '[' || *end == '.') {
            if (*end != '.') end = behind(end);
            else do ++end; while (is_word(*end));
        }
    }
    puts_to(w, function);
    rewrite(w, from, end);
    puts_to(w, ")");
    return end;
}

static const char *whole_text; /* for declarations */

static int token(const char *s, const char *name) { return strncmp(s, name, strlen(name)) == 0 && s[strlen(name)] == '('; }

static void rewrite(writer *w, const char *s, const char *end)
{
    static const char *const calls[] = { "sqrt", "log2", "inversesqrt", "normalize", "int", "uint", "ivec2", "uvec2", "uvec3", "clamp", "smoothstep" };
    while (s < end) {
        const int begins = !is_word(s[-1]) && s[-1] != '.';
        size_t i;
        if (s[0] == '/' && s[1] == '/') { /* a comment */
            const char *line = strchr(s, '\n');
            put(w, s, (size_t)(line - s));
            s = line;
        } else if (s[-1] == '\n' && strncmp(s, "const ", 6) == 0) { /* a constant expression */
            const char *semicolon = strchr(s, ';');
            put(w, s, (size_t)(semicolon - s));
            s = semicolon;
        } else if (begins && token(s, "texelFetch")) s = rewrite_access(w, s, whole_text, 0);
        else if (begins && (token(s, "imageStore") || token(s, "imageLoad") || token(s, "imageAtomicMin")))
            s = rewrite_access(w, s, whole_text, 1);
        else if (*s == '/') s = rewrite_divisor(w, s, " ck_by(");
        else if ((strncmp(s, "<<", 2) == 0 || strncmp(s, ">>", 2) == 0) && s[2] != '=') {
            put(w, s, 1);
            s = rewrite_divisor(w, s + 1, " ck_shift(");
        }
        else {
            for (i = 0; begins && i < sizeof calls / sizeof *calls; ++i)
                if (token(s, calls[i])) puts_to(w, "ck_");
            do put(w, s++, 1); while (s < end && is_word(s[-1]) && is_word(*s));
        }
    }
}

static const char prelude[] =
    "uint ck_faults = 0u;\n"
    "void ck_need(bool good, uint kind) { if (!good) ck_faults |= kind; }\n" /* isnan: !(a < b) may be compiled to a >= b */
    "float ck_sqrt(float x) { ck_need(x >= 0.0 && !isnan(x), 1u); return sqrt(x); }\n"
    "vec4 ck_sqrt(vec4 x) { ck_need(all(greaterThanEqual(x, vec4(0.0))) && !any(isnan(x)), 1u); return sqrt(x); }\n"
    "float ck_inversesqrt(float x) { ck_need(x > 0.0 && !isnan(x), 1u); return inversesqrt(x); }\n"
    "vec4 ck_inversesqrt(vec4 x) { ck_need(all(greaterThan(x, vec4(0.0))) && !any(isnan(x)), 1u); return inversesqrt(x); }\n"
    "float ck_log2(float x) { ck_need(x > 0.0 && !isnan(x), 1u); return log2(x); }\n"
    "vec2 ck_normalize(vec2 x) { ck_need(dot(x, x) > 0.0 && !any(isnan(x)), 1u); return normalize(x); }\n"
    "vec3 ck_normalize(vec3 x) { ck_need(dot(x, x) > 0.0 && !any(isnan(x)), 1u); return normalize(x); }\n"
    "float ck_by(float x) { ck_need(x != 0.0, 2u); return x; }\n"
    "vec2 ck_by(vec2 x) { ck_need(all(notEqual(x, vec2(0.0))), 2u); return x; }\n"
    "vec3 ck_by(vec3 x) { ck_need(all(notEqual(x, vec3(0.0))), 2u); return x; }\n"
    "vec4 ck_by(vec4 x) { ck_need(all(notEqual(x, vec4(0.0))), 2u); return x; }\n"
    "int ck_by(int x) { ck_need(x != 0, 2u); return x; }\n"
    "ivec2 ck_by(ivec2 x) { ck_need(all(notEqual(x, ivec2(0))), 2u); return x; }\n"
    "int ck_shift(int x) { ck_need(x >= 0 && x < 32, 1u); return x; }\n"
    "uint ck_shift(uint x) { ck_need(x < 32u, 1u); return x; }\n"
    "uvec3 ck_shift(uvec3 x) { return x; }\n"
    "int ck_int(float x) { ck_need(abs(x) < 2147483648.0 && !isnan(x), 4u); return int(x); }\n"
    "int ck_int(int x) { return x; }\n"
    "int ck_int(uint x) { return int(x); }\n"
    "uint ck_uint(float x) { ck_need(x > -1.0 && x < 4294967296.0 && !isnan(x), 4u); return uint(x); }\n"
    "uint ck_uint(int x) { return uint(x); }\n"
    "uint ck_uint(uint x) { return x; }\n"
    "ivec2 ck_ivec2(vec2 x) { ck_need(all(lessThan(abs(x), vec2(2147483648.0))) && !any(isnan(x)), 4u); return ivec2(x); }\n"
    "ivec2 ck_ivec2(ivec2 x) { return x; }\n"
    "ivec2 ck_ivec2(uvec2 x) { return ivec2(x); }\n"
    "ivec2 ck_ivec2(int x) { return ivec2(x); }\n"
    "ivec2 ck_ivec2(int x, int y) { return ivec2(x, y); }\n"
    "ivec2 ck_ivec2(uint x, uint y) { return ivec2(x, y); }\n"
    "uvec2 ck_uvec2(int x) { return uvec2(x); }\n"
    "uvec2 ck_uvec2(uint x) { return uvec2(x); }\n"
    "uvec2 ck_uvec2(ivec2 x) { return uvec2(x); }\n"
    "uvec2 ck_uvec2(uint x, uint y) { return uvec2(x, y); }\n"
    "uvec3 ck_uvec3(vec3 x) { ck_need(all(greaterThan(x, vec3(-1.0))) && all(lessThan(x, vec3(4294967296.0))) && !any(isnan(x)), 4u); return uvec3(x); }\n"
    "uvec3 ck_uvec3(uint x) { return uvec3(x); }\n"
    "uvec3 ck_uvec3(uint x, uint y, uint z) { return uvec3(x, y, z); }\n"
    "float ck_clamp(float x, float a, float b) { ck_need(!isnan(x) && a <= b, 16u); return clamp(x, a, b); }\n"
    "vec2 ck_clamp(vec2 x, float a, float b) { ck_need(!any(isnan(x)), 16u); return clamp(x, a, b); }\n"
    "vec3 ck_clamp(vec3 x, float a, float b) { ck_need(!any(isnan(x)), 16u); return clamp(x, a, b); }\n"
    "vec3 ck_clamp(vec3 x, vec3 a, vec3 b) { ck_need(!any(isnan(x)) && all(lessThanEqual(a, b)), 16u); return clamp(x, a, b); }\n"
    "vec4 ck_clamp(vec4 x, vec4 a, vec4 b) { ck_need(!any(isnan(x)) && all(lessThanEqual(a, b)), 16u); return clamp(x, a, b); }\n"
    "float ck_smoothstep(float a, float b, float x) { ck_need(!isnan(x), 16u); return smoothstep(a, b, x); }\n"
    "int ck_clamp(int x, int a, int b) { return clamp(x, a, b); }\n"
    "ivec2 ck_clamp(ivec2 x, ivec2 a, ivec2 b) { return clamp(x, a, b); }\n"
    "ivec2 ck_in(ivec2 p, ivec2 size) { ck_need(p == clamp(p, ivec2(0), size - 1), 8u); return p; }\n"
    "ivec3 ck_in(ivec3 p, ivec3 size) { ck_need(p == clamp(p, ivec3(0), size - 1), 8u); return p; }\n\n";

void checked_text(const hbil_plan *checked, int32_t pass, const char *text, char out[CHECKED_TEXT_MAX])
{
    const hbil_pass *of = &checked->passes[pass];
    const char *body = strstr(text, "\n// ---- "), *main_at = strstr(text, "\nvoid main() {");
    writer w = {out, out + CHECKED_TEXT_MAX};
    char line[256];
    whole_text = text;
    put(&w, text, (size_t)(body + 1 - text));
    snprintf(line, sizeof line, "layout(set = 0, binding = %d, r32f) uniform writeonly image2DArray u_faults;\n\n",
             of->bindings[of->binding_count - 1].slot);
    puts_to(&w, line);
    puts_to(&w, prelude);
    rewrite(&w, body + 1, main_at + 1);
    puts_to(&w, "void checked_main() {");
    rewrite(&w, main_at + strlen("\nvoid main() {"), text + strlen(text));
    puts_to(&w, "\nvoid main() {\n    checked_main();\n    ivec2 ck_size = imageSize(u_faults).xy;\n"
                "    ivec2 ck_p = ivec2(gl_GlobalInvocationID.xy);\n");
    if (pass == 0) /* which covers the frame: it clears */
        puts_to(&w, "    for (int i = 0; i < imageSize(u_faults).z; ++i) imageStore(u_faults, ivec3(ck_p, i), vec4(0.0));\n");
    snprintf(line, sizeof line, "    if (ck_faults != 0u) imageStore(u_faults, ivec3(ck_p %% ck_size, %d), vec4(float(ck_faults)));\n}\n",
             (int)pass);
    puts_to(&w, line);
}

int checked_holds(const hbil_plan *checked, const image *faults, char *why, size_t size)
{
    const int pixels = faults->width * faults->height;
    int i, k;
    for (i = 0; i < pixels * image_slices(faults); ++i) {
        const unsigned bits = (unsigned)faults->data[i];
        if (!bits) continue;
        for (k = 0; k < 4 && !(bits >> k & 1); ++k) { }
        snprintf(why, size, "pass %s, near pixel (%d, %d): %s", checked->passes[i / pixels].name, i % faults->width,
                 i % pixels / faults->width, kinds[k]);
        return 0;
    }
    return 1;
}
