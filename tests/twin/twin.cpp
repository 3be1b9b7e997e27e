/* twin.cpp - translates the emitted text into C++, has it compiled, and runs it on textures in memory. See twin.h. */
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include "twin.h"

/* TWIN_COMPILER, TWIN_SOURCES (folder of glsl.hpp), TWIN_CACHE (folder of the libraries): from CMake. */

/* Not in the namespace without a name: tests/mutation includes this file. */
struct texture {
    twin_texture               shared{};
    std::vector<unsigned char> texels, written;
};

struct twin {
    int                  precision = 0, flags = 0;
    std::string          hook, own_pass, own_text;
    bool                 compiled = false, ready = false; /* the library is of `plan`; the textures are */
    hbil_plan            plan{};
    void                *library = nullptr;
    twin_pass           *passes[HBIL_MAX_PASSES]{};
    uint32_t             room[2]{};
    std::vector<texture> textures[HBIL_MAX_TEXTURES]; /* by copy */
    bool                 fresh = true;
    uint32_t             frames = 0;
    std::vector<double>  outputs[HBIL_MAX_TEXTURES];
    twin_faults          faults{};
    twin_counts          counts[HBIL_MAX_PASSES]{};
};

namespace {

int fail(char *error, size_t size, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (size > 0) std::vsnprintf(error, size, format, args);
    va_end(args);
    return 0;
}

/* ---- text to C++ */

/* All that is changed in a text before it is compiled; glsl.hpp does the rest. */
std::string translate(std::string text)
{
    static const struct { const char *pattern, *with; } rules[] = {
        /* directives of GLSL alone, and the sources that a hook's lines are counted in */
        {"#(version|extension|line) [^\\n]*|\\bprecision (highp|mediump) \\w+;", ""},
        {"layout\\(local_size[^;]*;", ""},
        /* arrays are values */
        {"\\b(mediump )?(float|u?vec[234]) (\\w+)\\[([^\\]]+)\\]", "array<$1$2, $4> $3"},
        /* types that round */
        {"\\bmediump (float|vec4)\\b", "mediump_$1"},
        /* targets of a fragment shader */
        {"layout\\(location = \\d+\\) out (highp )?array<(\\w+), (\\d+)> ", "static array<target<$2>, $3> "},
        {"layout\\(location = \\d+\\) out (highp )?(\\w+) ", "static target<$2> "},
        /* what a function changes is a reference */
        {"\\b(inout|out) ((array<[^>]+>)|\\w+) (\\w+)", "$2 &$4"},
        /* members of the uniform block are globals, which twin_pass loads */
        {"layout\\([^)]*\\) uniform HbilFrame \\{([^}]*)\\};", "$1"},
        /* bindings are objects */
        {"(layout\\([^)]*\\) )?\\b(uniform|shared) ((readonly|writeonly|coherent|restrict|highp) )*", "static "},
        {"\\bhighp ", ""},
    };
    for (const auto &rule : rules) text = std::regex_replace(text, std::regex(rule.pattern), rule.with);
    return text;
}

/* What the text of a pass calls a binding. */
std::string name_of(const hbil_plan *plan, const hbil_binding &b)
{
    const std::string name = plan->textures[b.texture].name;
    return b.role == HBIL_ROLE_FROM ? "u_from" : b.role == HBIL_ROLE_TO ? "u_to" : b.role == HBIL_ROLE_LAST ? "u_last_" + name : "u_" + name;
}

/* The function that runs a pass. */
std::string entry(const hbil_plan *plan, uint32_t index, const std::string &text)
{
    const hbil_pass &pass = plan->passes[index];
    const bool draws = plan->config.stage == HBIL_STAGE_FRAGMENT;
    std::ostringstream out, begin, end;
    out << "static void bind(const twin_work *work)\n{\n    (void)work;\n";
    for (uint32_t b = 0; b < pass.binding_count; ++b) {
        const std::string name = name_of(plan, pass.bindings[b]);
        if (draws && pass.bindings[b].access == HBIL_ACCESS_WRITE) {
            begin << "glsl::begin(" << name << "); ";
            end << " glsl::end(work->bindings[" << b << "], x, y, " << name << ");";
        } else {
            out << "    " << name << ".t = work->bindings[" << b << "];\n";
        }
    }
    for (uint32_t c = 0; pass.constants && c < plan->constant_count; ++c)
        out << "    load(" << plan->constants[c].name << ", work->block + " << plan->constants[c].offset << ");\n";
    out << "}\nextern \"C\" __attribute__((visibility(\"default\"))) void twin_pass_" << index
        << "(twin_state *s, const twin_work *work)\n{\n    [[maybe_unused]] flushing now;\n    state = s;\n    bind(work);\n";
    if (draws)
        out << "    for (int y = 0; y < work->groups[1]; ++y)\n        for (int x = 0; x < work->groups[0]; ++x) {\n"
            << "            gl_FragCoord = vec4(real(x) + real(0.5), real(y) + real(0.5), real(0), real(1));\n"
            << "            s->at[0] = x, s->at[1] = y;\n            " << begin.str() << "main();" << end.str() << "\n        }\n";
    else
        out << "    static const int group[2] = {" << pass.group[0] << ", " << pass.group[1] << "};\n    compute(work->groups, group, "
            << (text.find("barrier()") != std::string::npos ? "true" : "false") << ", main);\n";
    out << "}\n";
    return out.str();
}

/* The emitted text of a pass, or the caller's in its place. */
bool text_of(const twin *t, const hbil_plan *plan, uint32_t pass, std::string &text, char *error, size_t size)
{
    std::vector<char> buffer(HBIL_GLSL_MAX + t->hook.size());
    if (!t->own_text.empty() && t->own_pass == plan->passes[pass].name) return text = t->own_text, true;
    const hbil_result result = plan->passes[pass].hook
        ? hbil_emit_glsl_hook(plan, (int32_t)pass, t->hook.c_str(), buffer.data(), buffer.size(), nullptr, nullptr)
        : hbil_emit_glsl(plan, (int32_t)pass, buffer.data(), buffer.size(), nullptr);
    text = buffer.data();
    return result == HBIL_OK || fail(error, size, "pass %s: %s", plan->passes[pass].name, hbil_result_name(result));
}

bool source_of(const twin *t, const hbil_plan *plan, std::string &source, char *error, size_t size)
{
    source = "#include \"glsl.hpp\"\nnamespace glsl {\n";
    for (uint32_t i = 0; i < plan->pass_count; ++i) {
        std::string text;
        if (!text_of(t, plan, i, text, error, size)) return false;
        source += "namespace pass_" + std::to_string(i) + " {\n#define float real\n#line 1 \"" + plan->passes[i].name + "\"\n"
                + translate(text) + "\n#undef float\n#undef imageStore\n#line 1 \"twin\"\n" + entry(plan, i, text) + "}\n";
    }
    source += "}\n";
    return true;
}

/* ---- the compiler */

uint64_t hash_of(const std::string &s, uint64_t h)
{
    for (const char c : s) h = (h ^ (unsigned char)c) * 0x100000001b3u;
    return h;
}

std::string read_file(const std::string &path)
{
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
}

bool fuses()
{
#if defined(__x86_64__) || defined(__i386__)
    return __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

std::string flags_of(const twin *t)
{
    std::string flags = "-std=c++20 -O1 -g1 -fPIC -shared -fvisibility=hidden -fno-math-errno -w";
    flags += t->flags & TWIN_LOOSE && fuses() ? " -mfma -fexpensive-optimizations -ffp-contract=fast" : " -ffp-contract=off";
    flags += t->precision == TWIN_DOUBLE ? " -DGLSL_DOUBLE=1" : " -DGLSL_DOUBLE=0";
    flags += t->flags & TWIN_STICKY ? " -DGLSL_STICKY=1" : " -DGLSL_STICKY=0";
    flags += t->flags & TWIN_LOOSE ? " -DGLSL_LOOSE=1" : " -DGLSL_LOOSE=0";
    if (t->flags & TWIN_SANITIZE) /* of arithmetic: memory is checked by glsl.hpp, texel by texel */
        flags += " -fsanitize=shift,signed-integer-overflow,integer-divide-by-zero,float-divide-by-zero,float-cast-overflow,bounds,bool"
                 " -fno-sanitize-recover=all";
    return flags;
}

/* Other processes may do the same at once: each writes files of its own and moves them to their places. */
bool compile(const std::string &source, const std::string &flags, const std::string &library, char *error, size_t size)
{
    const std::string own = library + "." + std::to_string((long)getpid());
    std::string said;
    char line[512];
    std::ofstream(own + ".cpp", std::ios::binary) << source;
    const std::string command = "'" TWIN_COMPILER "' " + flags + " -I'" TWIN_SOURCES "' -o '" + own + "' '" + own + ".cpp' 2>&1";
    FILE *pipe = popen(command.c_str(), "r");
    if (!pipe) return fail(error, size, "cannot run " TWIN_COMPILER);
    while (std::fgets(line, sizeof line, pipe)) said += line;
    const bool good = pclose(pipe) == 0 && std::rename((own + ".cpp").c_str(), (library + ".cpp").c_str()) == 0
                   && std::rename(own.c_str(), library.c_str()) == 0;
    return good || fail(error, size, "%s", said.empty() ? (own + ": the library cannot be written").c_str() : said.c_str());
}

bool open_library(twin *t, const hbil_plan *plan, char *error, size_t size)
{
    std::string source, name;
    char hex[17];
    if (!source_of(t, plan, source, error, size)) return false;
    const std::string flags = flags_of(t);
    uint64_t h = hash_of(flags + __VERSION__ TWIN_COMPILER, 0xcbf29ce484222325u);
    h = hash_of(read_file(TWIN_SOURCES "/glsl.hpp") + read_file(TWIN_SOURCES "/twin_abi.h"), h);
    std::snprintf(hex, sizeof hex, "%016llx", (unsigned long long)hash_of(source, h));
    mkdir(TWIN_CACHE, 0777);
    name = std::string(TWIN_CACHE "/") + hex + ".so";
    if (access(name.c_str(), R_OK) != 0 && !compile(source, flags, name, error, size)) return false;
    t->library = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!t->library) return fail(error, size, "%s", dlerror());
    for (uint32_t i = 0; i < plan->pass_count; ++i) {
        void *address = dlsym(t->library, ("twin_pass_" + std::to_string(i)).c_str());
        if (!address) return fail(error, size, "%s", dlerror());
        std::memcpy(&t->passes[i], &address, sizeof address);
    }
    return true;
}

void drop_library(twin *t)
{
    if (t->library) dlclose(t->library);
    t->library = nullptr;
    t->compiled = t->ready = false;
}

/* ---- textures */

size_t texel_bytes(const twin *t, const texture &x)
{
    return x.shared.channels == 0 ? 4 : (size_t)x.shared.channels * (t->precision == TWIN_DOUBLE ? 8 : 4);
}

void make_texture(const twin *t, texture &x, const hbil_texture &of, int width, int height, int depth, int channels)
{
    const size_t count = (size_t)width * (size_t)height * (size_t)depth;
    std::snprintf(x.shared.name, sizeof x.shared.name, "%s", of.name);
    x.shared.width = x.shared.bound[0] = width;
    x.shared.height = x.shared.bound[1] = height;
    x.shared.depth = depth;
    x.shared.channels = channels;
    x.shared.half = of.format == HBIL_FORMAT_RGBA16F;
    x.texels.assign(count * texel_bytes(t, x), 0xff); /* NaN */
    x.written.assign(count, 0);
    x.shared.texels = x.texels.data();
    x.shared.written = x.written.data();
}

void forget(texture &x)
{
    std::fill(x.texels.begin(), x.texels.end(), (unsigned char)0xff);
    std::fill(x.written.begin(), x.written.end(), (unsigned char)0);
}

double texel_get(const twin *t, const texture &x, size_t i)
{
    if (t->precision == TWIN_DOUBLE) return reinterpret_cast<const double *>(x.shared.texels)[i];
    return (double)reinterpret_cast<const float *>(x.shared.texels)[i];
}

void texel_set(const twin *t, texture &x, size_t i, float v)
{
    if (t->precision == TWIN_DOUBLE) reinterpret_cast<double *>(x.shared.texels)[i] = (double)v;
    else reinterpret_cast<float *>(x.shared.texels)[i] = v;
}

bool set_input(const twin *t, texture &x, const hbil_texture &of, const image &in, const uint32_t extent[2], int sample, char *error,
               size_t size)
{
    static const float fill[4] = {0, 0, 0, 1};
    const bool flat = of.dim != HBIL_DIM_CUBE && of.dim != HBIL_DIM_3D;
    if (!in.data) return fail(error, size, "input %s is missing", of.name);
    if (flat && (in.width < (int)extent[0] || in.height < (int)extent[1] || image_slices(&in) != 1))
        return fail(error, size, "input %s has another shape than the plan needs", of.name);
    make_texture(t, x, of, in.width, in.height, image_slices(&in), 4);
    const size_t count = x.written.size();
    for (size_t i = 0; i < count; ++i)
        for (int k = 0; k < 4; ++k)
            texel_set(t, x, 4 * i + (size_t)k, k < in.channels ? in.data[i * (size_t)in.channels + (size_t)k] : fill[k]);
    std::fill(x.written.begin(), x.written.end(), (unsigned char)1);
    x.shared.sample = of.dim == HBIL_DIM_2D_MULTISAMPLE ? sample : 0;
    if (flat) x.shared.bound[0] = (int)extent[0], x.shared.bound[1] = (int)extent[1];
    return true;
}

/* As runner.c: all textures that lie on the screen have room for what the inputs do. */
void room_of(const hbil_plan *plan, const image *inputs, const uint32_t frame[2], uint32_t room[2])
{
    room[0] = room[1] = UINT32_MAX;
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        const hbil_texture &x = plan->textures[i];
        if (x.life != HBIL_LIFE_INPUT || x.dim == HBIL_DIM_CUBE || x.dim == HBIL_DIM_3D) continue;
        if ((uint32_t)inputs[i].width < room[0]) room[0] = (uint32_t)inputs[i].width;
        if ((uint32_t)inputs[i].height < room[1]) room[1] = (uint32_t)inputs[i].height;
    }
    if (plan->config.width != 0 || room[0] == UINT32_MAX) std::memcpy(room, frame, 2 * sizeof *room);
}

int channels_of(const hbil_texture &x)
{
    return x.format == HBIL_FORMAT_R32UI ? 0 : x.format == HBIL_FORMAT_R32F ? 1 : 4;
}

/* Textures of ours for a room; what history holds stays while the room does. */
void set_textures(twin *t, const uint32_t room[2])
{
    const bool keep = t->ready && std::memcmp(t->room, room, sizeof t->room) == 0;
    for (uint32_t i = 0; i < t->plan.texture_count; ++i) {
        const hbil_texture &x = t->plan.textures[i];
        uint32_t extent[2] = {1, 1};
        if (x.life == HBIL_LIFE_INPUT) continue;
        hbil_plan_extent(&t->plan, (int32_t)i, room[0], room[1], extent);
        if (!keep) t->textures[i].assign(x.copies, texture());
        for (size_t c = 0; c < x.copies; ++c) {
            texture &copy = t->textures[i][c];
            const bool last = x.life == HBIL_LIFE_HISTORY && c != t->frames % x.copies;
            if (!keep) make_texture(t, copy, x, (int)extent[0], (int)extent[1], x.layers, channels_of(x));
            else if (!last) forget(copy); /* garbage between frames */
        }
    }
    if (!keep) t->fresh = true;
    std::memcpy(t->room, room, sizeof t->room);
    t->ready = true;
}

bool set_inputs(twin *t, const uint32_t size[2], const image *inputs, char *error, size_t error_size)
{
    for (uint32_t i = 0; i < t->plan.texture_count; ++i) {
        uint32_t extent[2];
        if (t->plan.textures[i].life != HBIL_LIFE_INPUT) continue;
        if (hbil_plan_extent(&t->plan, (int32_t)i, size[0], size[1], extent) != HBIL_OK)
            return fail(error, error_size, "frame size %ux%u is not in [1, 16384]", size[0], size[1]);
        t->textures[i].assign(1, texture());
        if (!set_input(t, t->textures[i][0], t->plan.textures[i], inputs[i], extent, t->plan.config.sample, error, error_size)) return false;
    }
    return true;
}

bool get_outputs(twin *t, const uint32_t size[2], image *outputs, char *error, size_t error_size)
{
    for (uint32_t i = 0; i < t->plan.texture_count; ++i) {
        const hbil_texture &of = t->plan.textures[i];
        if (of.life != HBIL_LIFE_OUTPUT) continue;
        const texture &x = t->textures[i][0];
        const int channels = x.shared.channels ? x.shared.channels : 1;
        uint32_t extent[2];
        hbil_plan_extent(&t->plan, (int32_t)i, size[0], size[1], extent);
        const int width = (int)extent[0], height = (int)extent[1];
        if (!image_make_slices(&outputs[i], width, height, of.layers, channels)) return fail(error, error_size, "out of memory");
        if (of.dim == HBIL_DIM_2D) outputs[i].depth = 0;
        t->outputs[i].clear();
        for (int z = 0; z < of.layers; ++z)
            for (int y = 0; y < height; ++y)
                for (int k = 0; k < width * channels; ++k) {
                    const size_t from = ((size_t)z * (size_t)x.shared.height + (size_t)y) * (size_t)(x.shared.width * channels) + (size_t)k;
                    float &to = outputs[i].data[t->outputs[i].size()];
                    if (x.shared.channels == 0) std::memcpy(&to, &x.texels[4 * from], sizeof to); /* whole numbers: their bits */
                    else to = (float)texel_get(t, x, from);
                    t->outputs[i].push_back(x.shared.channels == 0 ? (double)to : texel_get(t, x, from));
                }
    }
    return true;
}

void run_pass(twin *t, uint32_t index, const hbil_dispatch &grid, const unsigned char *block)
{
    const hbil_pass &pass = t->plan.passes[index];
    twin_texture *bindings[HBIL_MAX_BINDINGS] = {};
    twin_state state = {&t->faults, &t->counts[index], pass.name, {0, 0}};
    twin_work work = {{(int)grid.groups[0], (int)grid.groups[1]}, bindings, block};
    for (uint32_t b = 0; b < pass.binding_count; ++b) {
        auto &copies = t->textures[pass.bindings[b].texture];
        const uint32_t n = (uint32_t)copies.size();
        bindings[b] = &copies[(t->frames % n + n - pass.bindings[b].age) % n].shared;
    }
    t->counts[index] = twin_counts();
    t->passes[index](&state, &work);
}

int run(twin *t, const hbil_plan *plan, const hbil_frame *frame, const image *inputs, image *outputs, char *error, size_t size)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_dispatch grids[HBIL_MAX_PASSES];
    hbil_diag item = {};
    hbil_diags diags = {&item, 1, 0};
    hbil_frame now = *frame;
    uint32_t extent[2] = {frame->width ? frame->width : (uint32_t)plan->config.width, frame->height ? frame->height : (uint32_t)plan->config.height};
    uint32_t room[2];
    if (!twin_compile(t, plan, error, size)) return 0;
    if (!set_inputs(t, extent, inputs, error, size)) return 0;
    room_of(plan, inputs, extent, room);
    set_textures(t, room);
    if (t->fresh) now.reset = 1;
    if (hbil_pack_constants(plan, &now, block, sizeof block, nullptr, &diags) != HBIL_OK || hbil_plan_frame(plan, &now, grids) != HBIL_OK)
        return fail(error, size, "%s", item.text);
    for (uint32_t i = 0; i < plan->pass_count; ++i) run_pass(t, i, grids[i], block);
    t->fresh = false;
    ++t->frames;
    return get_outputs(t, extent, outputs, error, size);
}

} // namespace

/* ---- public */

twin *twin_open(int precision, int flags)
{
    twin *t = new (std::nothrow) twin;
    if (!t) return nullptr;
    t->precision = precision;
    t->flags = flags;
    return t;
}

void twin_close(twin *t)
{
    if (t) drop_library(t);
    delete t;
}

int twin_hook(twin *t, const char *text)
{
    if (t->hook == (text ? text : "")) return 1;
    drop_library(t);
    t->hook = text ? text : "";
    return 1;
}

int twin_text(twin *t, const char *pass, const char *text)
{
    if (t->own_text == (text ? text : "") && t->own_pass == (text ? pass : "")) return 1;
    drop_library(t);
    t->own_pass = text ? pass : "";
    t->own_text = text ? text : "";
    return 1;
}

int twin_compile(twin *t, const hbil_plan *plan, char *error, size_t size)
{
    if (t->compiled && std::memcmp(plan, &t->plan, sizeof *plan) == 0) return 1;
    drop_library(t);
    t->plan = *plan;
    t->frames = 0;
    if (!open_library(t, plan, error, size)) return drop_library(t), 0;
    t->compiled = true;
    return 1;
}

int twin_run(twin *t, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
             image outputs[HBIL_MAX_TEXTURES], char *error, size_t size)
{
    std::memset(outputs, 0, HBIL_MAX_TEXTURES * sizeof *outputs);
    try {
        if (run(t, plan, frame, inputs, outputs, error, size)) return 1;
    } catch (const std::exception &e) {
        fail(error, size, "%s", e.what());
    }
    for (int i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&outputs[i]);
    return 0;
}

void twin_spoil(twin *t, int32_t history)
{
    for (texture &copy : t->textures[history]) std::fill(copy.texels.begin(), copy.texels.end(), (unsigned char)0xff);
}

const double *twin_output(const twin *t, int32_t texture)
{
    return texture < 0 || t->outputs[texture].empty() ? nullptr : t->outputs[texture].data();
}

twin_counts twin_counted(const twin *t, uint32_t pass) { return t->counts[pass]; }
const twin_faults *twin_faulted(const twin *t) { return &t->faults; }
void twin_forgive(twin *t) { t->faults = twin_faults(); }

int twin_faultless(const twin *t, char *why, size_t size)
{
    int good = 1;
    if (size > 0) why[0] = 0;
    for (int k = 0; k < TWIN_FAULT_KINDS; ++k) {
        const size_t used = std::strlen(why);
        if (t->faults.count[k] == 0) continue;
        std::snprintf(why + used, size - used, "%s%s (%lu times)", good ? "" : "; ", t->faults.first[k], t->faults.count[k]);
        good = 0;
    }
    return good;
}
