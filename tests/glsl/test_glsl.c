/* test_glsl.c - over a pairwise matrix of all options: the text compiles, the SPIR-V is valid, glslang's own preprocessor
 * over the authored chunks gives the same SPIR-V as our filter (twin), and reflection finds what the plan says. One sweep
 * finds out all three, and compiles texts once that are equal but for the values of constants, each of which it has compiled once, too
 * (HBIL_LONG=1: equal texts). And: what a config switches off is absent from its shaders. */

#define HBIL_IMPLEMENTATION
#include "../test.h"
#include "../matrix.h"
#include "../../backends/hbil_glslang.h"

#include <spirv-tools/libspirv.h>
#include <spirv_cross/spirv_cross_c.h>

#define WORDS 65536

#define CONFIGS 4096

static hbil_config configs[CONFIGS];
static int         config_count;
static char        text[HBIL_GLSL_MAX], twin[4 * HBIL_GLSL_MAX], log_text[4096];
static uint32_t    words[WORDS];

/* What an engine might paste: a declaration of its own, and the function. */
static const char hook[] =
    "const vec3 zenith = vec3(0.45, 0.75, 1.30);\n"
    "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) {\n"
    "    return zenith * (0.5 + 0.5 * direction.z) * step(-1e30, position.x) * (1.0 + 0.0 * cos_aperture);\n"
    "}\n";

static int draws(const hbil_plan *plan) { return plan->config.stage == HBIL_STAGE_FRAGMENT; }

static void emit(const hbil_plan *plan, int32_t pass)
{
    assert_int_equal(hbil_emit_glsl_hook(plan, pass, hook, text, sizeof text, NULL, NULL), HBIL_OK);
}

/* Calls check for every pass of every config; counts passes. */
static int for_all(void (*check)(const hbil_plan *plan, int32_t pass))
{
    int k, n = 0;
    for (k = 0; k < config_count; ++k) {
        hbil_plan plan;
        int32_t i;
        assert_int_equal(hbil_plan_build(&configs[k], &plan, NULL), HBIL_OK);
        for (i = 0; i < (int32_t)plan.pass_count; ++i, ++n) {
            emit(&plan, i);
            check(&plan, i);
        }
    }
    return n;
}

/* Words of SPIR-V; 0: refused, and said why. */
static size_t compile(const char *source, const hbil_plan *plan, uint32_t *out)
{
    size_t need = 0;
    hbil_glslang_result r = hbil_glslang_compile(source, (hbil_target)plan->config.target, out, WORDS, &need, log_text, sizeof log_text);
    if (r == HBIL_GLSLANG_OK) return need;
    print_error("%s\n%s\n", log_text, source);
    return 0;
}

static int word_count(const char *s, const char *word)
{
    size_t n = strlen(word);
    int count = 0;
    while ((s = strstr(s, word)) != NULL) {
        count += !hbil__is_word(s[-1]) && !hbil__is_word(s[n]);
        s += n;
    }
    return count;
}

/* ---------------------------------------------------------------------- valid */

static int is_valid(const hbil_plan *plan, size_t count)
{
    spv_context context = spvContextCreate(plan->config.target == HBIL_TARGET_VULKAN ? SPV_ENV_VULKAN_1_1 : SPV_ENV_OPENGL_4_5);
    spv_diagnostic diagnostic = NULL;
    int valid = spvValidateBinary(context, words, count, &diagnostic) == SPV_SUCCESS;
    if (!valid) print_error("%s\n%s\n", diagnostic ? diagnostic->error : "", text);
    spvDiagnosticDestroy(diagnostic);
    spvContextDestroy(context);
    return valid;
}

/* ---------------------------------------------------------------------- twin */

/* #define lines for every symbol in the #if lines of a chunk. */
static void define_symbols(const hbil_config *c, const char *chunk, hbil__sink *s)
{
    const char *at = chunk;
    for (; *at; at += strcspn(at, "\n") + 1) {
        const char *end = at + strcspn(at, "\n"), *w = at;
        if (*at != '#') continue;
        while ((w = strstr(w, "HBIL_")) != NULL && w < end) {
            size_t len = 0;
            char name[64], define[96];
            while (hbil__is_word(w[len])) ++len;
            memcpy(name, w, len);
            name[len] = 0;
            snprintf(define, sizeof define, "#define %s %d\n", name, hbil__symbol(c, name, len));
            if (s->size == 0 || !strstr(twin, define)) hbil__puts(s, define);
            w += len;
        }
    }
}

/* The same pass with the chunks as authored: #if lines left for glslang's preprocessor. */
static void make_twin(const hbil_plan *plan, int32_t pass)
{
    hbil__used used;
    hbil__sink s = hbil__sink_open(twin, sizeof twin);
    const char *body = strstr(text, ".glsl\n\n"), *first = strchr(text, '\n') + 1;
    int32_t i;
    memset(twin, 0, sizeof twin);
    assert_non_null(body);
    while (body[-1] != '\n') --body; /* the line that names the first file */
    hbil__scan_pass(&plan->config, hbil__pass_row(plan->passes[pass].name), &used);
    hbil__put(&s, text, (size_t)(first - text)); /* #version */
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (hbil__marked(used.chunks, i)) define_symbols(&plan->config, hbil__chunks[i].text, &s);
    hbil__put(&s, first, (size_t)(body - first)); /* layout and constants: from the plan in both */
    for (i = 0; i < HBIL__COUNT(hbil__chunks); ++i)
        if (hbil__marked(used.chunks, i)) hbil__puts(&s, hbil__chunks[i].text);
    assert_int_equal(hbil__sink_close(&s, NULL), HBIL_OK);
}

/* ---------------------------------------------------------------------- reflection */

static spvc_compiler compiler;

#define FITS(condition) do { if (!(condition)) return unfit(#condition); } while (0)

static int unfit(const char *condition)
{
    print_error("%s\nreflection: not so: %s\n", text, condition);
    return 0;
}

static const spvc_reflected_resource *resources(spvc_resource_type type, size_t *count)
{
    const spvc_reflected_resource *list;
    spvc_resources all;
    assert_int_equal(spvc_compiler_create_shader_resources(compiler, &all), SPVC_SUCCESS);
    assert_int_equal(spvc_resources_get_resource_list_for_type(all, type, &list, count), SPVC_SUCCESS);
    return list;
}

static SpvImageFormat spirv_format(uint16_t format)
{
    return format == HBIL_FORMAT_R32F ? SpvImageFormatR32f : format == HBIL_FORMAT_R32UI ? SpvImageFormatR32ui :
           format == HBIL_FORMAT_RGBA32F ? SpvImageFormatRgba32f :
           format == HBIL_FORMAT_RGBA16F ? SpvImageFormatRgba16f : SpvImageFormatUnknown;
}

/* Does the text call a binding so? */
static int is_called(const hbil_plan *plan, const hbil_binding *bind, const char *name)
{
    char own[64];
    hbil__sink s = hbil__sink_open(own, sizeof own);
    hbil__put_binding_name(&s, plan, bind);
    return hbil__sink_close(&s, NULL) == HBIL_OK && strcmp(own, name) == 0;
}

/* Each resource of one kind is one binding of the plan, and their numbers are equal. Fragment shaders have no numbers but the
 * locations of their targets. */
static int bindings_fit(const hbil_plan *plan, const hbil_pass *pass, spvc_resource_type type, hbil_access access)
{
    size_t count, k;
    const spvc_reflected_resource *list = resources(type, &count);
    uint32_t b, expected = 0;
    for (b = 0; b < pass->binding_count; ++b) expected += pass->bindings[b].access == access;
    FITS(count == expected);
    for (k = 0; k < count; ++k) {
        const hbil_texture *t = NULL;
        for (b = 0; b < pass->binding_count; ++b)
            if (pass->bindings[b].access == access && is_called(plan, &pass->bindings[b], list[k].name)) break;
        FITS(b < pass->binding_count);
        t = &plan->textures[pass->bindings[b].texture];
        if (draws(plan) && access == HBIL_ACCESS_WRITE)
            FITS(spvc_compiler_get_decoration(compiler, list[k].id, SpvDecorationLocation) == pass->bindings[b].slot);
        if (draws(plan)) continue;
        FITS(spvc_compiler_get_decoration(compiler, list[k].id, SpvDecorationBinding) == pass->bindings[b].slot);
        if (plan->config.target == HBIL_TARGET_VULKAN)
            FITS(spvc_compiler_get_decoration(compiler, list[k].id, SpvDecorationDescriptorSet) == 0);
        if (access == HBIL_ACCESS_WRITE && !draws(plan)) {
            spvc_type image = spvc_compiler_get_type_handle(compiler, list[k].type_id);
            FITS(spvc_type_get_image_storage_format(image) == spirv_format(t->format));
            FITS(t->format == HBIL_FORMAT_ANY || hbil_format_bytes((hbil_format)t->format) > 0);
        }
    }
    return 1;
}

static int block_fits(const hbil_plan *plan, const hbil_pass *pass)
{
    size_t count, size;
    const spvc_reflected_resource *list = resources(SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, &count);
    spvc_type type;
    uint32_t i;
    FITS(count == pass->constants);
    if (!count) return 1;
    type = spvc_compiler_get_type_handle(compiler, list[0].base_type_id);
    FITS(draws(plan) || spvc_compiler_get_decoration(compiler, list[0].id, SpvDecorationBinding) == plan->constants_slot);
    FITS(spvc_type_get_num_member_types(type) == plan->constant_count);
    FITS(spvc_compiler_get_declared_struct_size(compiler, type, &size) == SPVC_SUCCESS);
    FITS((size + 15) / 16 * 16 == plan->constants_size);
    for (i = 0; i < plan->constant_count; ++i) {
        unsigned offset;
        FITS(spvc_compiler_type_struct_member_offset(compiler, type, i, &offset) == SPVC_SUCCESS);
        FITS(offset == plan->constants[i].offset);
        FITS(strcmp(spvc_compiler_get_member_name(compiler, list[0].base_type_id, i), plan->constants[i].name) == 0);
    }
    return 1;
}

/* Sets `compiler`, for as long as the context lives. */
static spvc_context reflect(size_t count)
{
    spvc_context context;
    spvc_parsed_ir ir;
    assert_int_equal(spvc_context_create(&context), SPVC_SUCCESS);
    assert_int_equal(spvc_context_parse_spirv(context, words, count, &ir), SPVC_SUCCESS);
    assert_int_equal(spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &compiler), SPVC_SUCCESS);
    return context;
}

static int pass_fits(const hbil_plan *plan, const hbil_pass *pass)
{
    if (!draws(plan)) {
        FITS(spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, 0) == pass->group[0]);
        FITS(spvc_compiler_get_execution_mode_argument_by_index(compiler, SpvExecutionModeLocalSize, 1) == pass->group[1]);
    }
    return bindings_fit(plan, pass, SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, HBIL_ACCESS_SAMPLE) &&
           bindings_fit(plan, pass, draws(plan) ? SPVC_RESOURCE_TYPE_STAGE_OUTPUT : SPVC_RESOURCE_TYPE_STORAGE_IMAGE, HBIL_ACCESS_WRITE) && block_fits(plan, pass);
}

static int reflection_fits(const hbil_plan *plan, int32_t pass, size_t count)
{
    spvc_context context = reflect(count);
    int fits = pass_fits(plan, &plan->passes[pass]);
    spvc_context_destroy(context);
    return fits;
}

/* ---------------------------------------------------------------------- the sweep */

/* What is known of a text, by hashes: too many for the words themselves. */
typedef struct known { uint64_t text, twin, pass; } known;

/* Counts of the sweep, and what it found wrong. */
typedef struct sweep_counts { int done, passes, texts, invalid, unlike, misfits; } sweep_counts;

#define KNOWN 16384 /* a power of two, twice the passes at least */
static known        table[KNOWN];
static uint64_t     constants[KNOWN]; /* hashes of the lines of constants that were compiled */
static sweep_counts counts;

/* FNV-1a. */
static uint64_t hash(uint64_t h, const void *data, size_t size)
{
    const unsigned char *bytes = (const unsigned char *)data;
    size_t i;
    for (i = 0; i < size; ++i) h = (h ^ bytes[i]) * 0x100000001b3u;
    return h;
}

static uint64_t hash_words(size_t count) { return hash(count, words, count * sizeof *words); }

/* Of a shader without the comment on top, which names the config, and without the values of constants. *fresh: a line of these was
 * never seen before. */
static uint64_t hash_text(const char *source, int *fresh)
{
    const char *body = test_body(source);
    uint64_t h = 1;
    for (; *source; source += strcspn(source, "\n") + 1) {
        const size_t line = strcspn(source, "\n") + 1;
        const int constant = strncmp(source, "const ", 6) == 0 && !getenv("HBIL_LONG");
        const uint64_t whole = hash(3, source, line);
        size_t i = whole & (KNOWN - 1);
        if (source < body && strncmp(source, "//", 2) == 0) continue;
        h = hash(h, source, constant ? strcspn(source, "=") : line);
        if (!constant) continue;
        while (constants[i] && constants[i] != whole) i = (i + 1) & (KNOWN - 1);
        *fresh |= !constants[i];
        constants[i] = whole;
    }
    return h;
}

/* Of all that reflection compares with. */
static uint64_t hash_pass(const hbil_plan *plan, const hbil_pass *pass)
{
    uint64_t h = hash(2, pass->group, sizeof pass->group);
    uint32_t i;
    for (i = 0; i < pass->binding_count; ++i) {
        const hbil_binding *b = &pass->bindings[i];
        const hbil_texture *t = &plan->textures[b->texture];
        h = hash(h, t->name, sizeof t->name);
        h = hash(h, &t->format, sizeof t->format);
        h = hash(h, &b->slot, sizeof b->slot);
        h = hash(h, &b->role, sizeof b->role);
    }
    if (!pass->constants) return h;
    h = hash(h, &plan->constants_slot, sizeof plan->constants_slot);
    h = hash(h, &plan->constants_size, sizeof plan->constants_size);
    return hash(h, plan->constants, plan->constant_count * sizeof plan->constants[0]);
}

/* The place of a text together with its twin and its pass; empty if .text is 0. */
static known *find(uint64_t of_text, uint64_t of_twin, uint64_t of_pass)
{
    uint64_t i = of_text & (KNOWN - 1);
    while (table[i].text && (table[i].text != of_text || table[i].twin != of_twin || table[i].pass != of_pass))
        i = (i + 1) & (KNOWN - 1);
    return &table[i];
}

/* All three questions about a text with a twin and a pass that were not seen together yet. */
static void examine(const hbil_plan *plan, int32_t pass)
{
    uint64_t of_text;
    size_t n;
    ++counts.texts;
    if (strncmp(text, "#version 300 es", 15) == 0) { /* which has no SPIR-V: it is valid, and then seen through 3.10 */
        counts.invalid += hbil_glslang_compile(text, HBIL_TARGET_GLES, NULL, 0, NULL, log_text, sizeof log_text) != HBIL_GLSLANG_OK;
        text[10] = twin[10] = '1';
    }
    n = compile(text, plan, words);
    of_text = hash_words(n);
    counts.invalid += !n || !is_valid(plan, n);
    counts.misfits += !n || !reflection_fits(plan, pass, n);
    n = n ? compile(twin, plan, words) : 0;
    if (n && hash_words(n) == of_text) return;
    print_error("%s\nthis text and its twin give different SPIR-V\n", text);
    ++counts.unlike;
}

static void sweep_pass(const hbil_plan *plan, int32_t pass)
{
    int fresh = 0;
    uint64_t of_text = hash_text(text, &fresh), of_twin, of_pass = hash_pass(plan, &plan->passes[pass]);
    known *at;
    make_twin(plan, pass);
    of_twin = hash_text(twin, &fresh);
    assert_true(counts.texts < KNOWN / 2);
    at = find(of_text, of_twin, of_pass);
    ++counts.passes;
    if (at->text && !fresh) return;
    at->text = of_text;
    at->twin = of_twin;
    at->pass = of_pass;
    examine(plan, pass);
}

static const sweep_counts *sweep(void)
{
    if (!counts.done) for_all(sweep_pass);
    counts.done = 1;
    return &counts;
}

static void every_text_compiles_and_its_spirv_is_valid(void **state)
{
    const sweep_counts *c = sweep();
    (void)state;
    print_message("%d configs, %d passes, %d texts compiled\n", config_count, c->passes, c->texts);
    assert_true(c->texts > 0);
    assert_int_equal(c->invalid, 0);
}

static void filter_and_glslang_preprocessor_give_the_same_spirv(void **state)
{
    (void)state;
    assert_int_equal(sweep()->unlike, 0);
}

static void reflection_equals_the_plan(void **state)
{
    (void)state;
    assert_int_equal(sweep()->misfits, 0);
}

/* ---------------------------------------------------------------------- what is off is absent */

/* What there is less: fetches, samples or stores; only arithmetic; or nothing, since something else is there instead. */
typedef enum saving { FETCHES, ARITHMETIC, INSTEAD } saving;

/* Textures and members of the uniform block that the config `with` has and the config `without` has not: all of them. */
typedef struct absence { const char *with, *without, *textures, *members; saving saves; } absence;

static const absence absences[] = {
    /* outputs */
    { "outputs=ao+near", "outputs=near", "ao", "", FETCHES },
    { "outputs=ao+uniform_ao", "outputs=ao", "uniform_ao", "", FETCHES },
    { "outputs=ao+bent", "outputs=ao", "bent", "", FETCHES },
    { "outputs=ao+cone", "outputs=ao", "cone bent", "", FETCHES },
    { "outputs=ao+near", "outputs=ao", "near radiance", "", FETCHES },
    { "outputs=ao+sh", "outputs=ao", "sh radiance", "", FETCHES },
    { "outputs=ao+far environment=constant", "outputs=ao", "far", "HBIL_FAR_COLOR", FETCHES },
    { "outputs=ao+near+irradiance", "outputs=ao+near", "irradiance", "", FETCHES },
    { "outputs=ao+specular_occlusion", "outputs=ao", "specular_occlusion roughness bent", "", FETCHES },
    { "outputs=ao+specular_occlusion", "outputs=ao+specular_occlusion roughness=0.5", "roughness", "", FETCHES },
    { "outputs=ao+multi_bounce", "outputs=ao", "multi_bounce albedo", "", FETCHES },
    { "outputs=ao+multi_bounce bounce=cubic", "outputs=ao+multi_bounce", "", "", ARITHMETIC },
    { "outputs=ao+near+composite", "outputs=ao+near", "composite direct albedo", "", FETCHES },
    /* environments */
    { "outputs=near+composite environment=constant", "outputs=near+composite", "ao", "HBIL_FAR_COLOR", FETCHES },
    { "outputs=near+composite environment=sh", "outputs=near+composite", "ao bent",
      "HBIL_FAR_SH1 HBIL_FAR_SH2 HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=near+composite environment=cube", "outputs=near+composite", "ao bent sky", "HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=near+composite environment=probes", "outputs=near+composite", "ao bent probes",
      "HBIL_EYE HBIL_PROBE_ORIGIN HBIL_PROBE_SCALE HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=near+composite environment=hook", "outputs=near+composite", "ao bent",
      "HBIL_EYE HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=far environment=sh", "outputs=far environment=sh sh_order=1", "", "HBIL_FAR_SH2", ARITHMETIC },
    { "outputs=far environment=probes", "outputs=far environment=probes sh_order=1", "", "", FETCHES },
    { "outputs=far environment=sh", "outputs=far environment=sh far_visibility=ao", "bent", "", FETCHES },
    { "outputs=ao+far environment=sh estimator=bitmask far_visibility=free_bits", "outputs=ao estimator=bitmask", "far",
      "HBIL_FAR_SH1 HBIL_FAR_SH2 HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=ao+far environment=cube estimator=bitmask far_visibility=free_bits", "outputs=ao estimator=bitmask",
      "far sky", "HBIL_WORLD_TO_VIEW", FETCHES },
    { "outputs=ao+far environment=probes estimator=bitmask far_visibility=free_bits", "outputs=ao estimator=bitmask",
      "far probes", "HBIL_EYE HBIL_PROBE_ORIGIN HBIL_PROBE_SCALE HBIL_WORLD_TO_VIEW", FETCHES },
    /* light on its way */
    { "outputs=near f0=scalar", "outputs=near", "f0", "", FETCHES },
    { "outputs=near f0=rgb", "outputs=near", "f0", "", FETCHES },
    { "outputs=far environment=sh f0=rgb", "outputs=far environment=sh", "f0", "", FETCHES },
    { "outputs=near facing=filter", "outputs=near", "", "", ARITHMETIC }, /* the normal's fetch is there, once in the text */
    { "outputs=near facing=half_space", "outputs=near", "", "", ARITHMETIC },
    { "outputs=near firefly=5", "outputs=near", "", "", ARITHMETIC },
    { "outputs=near firefly=5 dynamic=firefly", "outputs=near", "", "HBIL_FIREFLY", ARITHMETIC },
    { "outputs=near dynamic=near_intensity", "outputs=near", "", "HBIL_NEAR_INTENSITY", ARITHMETIC },
    { "outputs=ao+near dynamic=near_intensity", "outputs=ao dynamic=near_intensity", "near radiance",
      "HBIL_NEAR_INTENSITY", FETCHES },
    { "outputs=far environment=sh dynamic=far_intensity", "outputs=far environment=sh", "",
      "HBIL_FAR_INTENSITY", ARITHMETIC },
    { "outputs=ao+far environment=constant dynamic=far_intensity", "outputs=ao dynamic=far_intensity", "far",
      "HBIL_FAR_COLOR HBIL_FAR_INTENSITY", FETCHES },
    { "outputs=ao ao_exponent=2", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao dynamic=ao_exponent", "outputs=ao", "", "HBIL_AO_EXPONENT", ARITHMETIC },
    { "outputs=specular_occlusion roughness=0.5 dynamic=roughness", "outputs=specular_occlusion roughness=0.5", "",
      "HBIL_ROUGHNESS", ARITHMETIC },
    /* the search */
    { "outputs=ao reach=2", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao reach=2 dynamic=reach+falloff", "outputs=ao", "", "HBIL_REACH HBIL_FALLOFF", ARITHMETIC },
    { "outputs=ao estimator=horizon occluder=heuristic", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao estimator=horizon occluder=heuristic dynamic=decay", "outputs=ao dynamic=decay", "",
      "HBIL_DECAY", ARITHMETIC },
    { "outputs=ao occluder=thick estimator=bitmask", "outputs=ao estimator=bitmask", "", "", ARITHMETIC },
    { "outputs=ao occluder=thick estimator=bitmask dynamic=thickness", "outputs=ao estimator=bitmask dynamic=thickness", "",
      "HBIL_THICKNESS", ARITHMETIC },
    { "outputs=ao estimator=hbao dynamic=angle_bias", "outputs=ao estimator=hbao", "", "HBIL_ANGLE_BIAS", ARITHMETIC },
    { "outputs=ao estimator=hbao reach=2", "outputs=ao estimator=hbao", "", "", ARITHMETIC },
    { "outputs=ao estimator=hbao_plus dynamic=multiplier", "outputs=ao estimator=hbao_plus", "",
      "HBIL_MULTIPLIER", ARITHMETIC },
    { "outputs=ao sampling=bilinear", "outputs=ao", "", "", ARITHMETIC }, /* four fetches a sample, once in the text */
    { "outputs=ao exponent=3", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao dynamic=slices+steps+exponent+bias+pull", "outputs=ao", "",
      "HBIL_SLICES HBIL_STEPS HBIL_EXPONENT HBIL_BIAS HBIL_PULL", ARITHMETIC },
    { "outputs=ao", "outputs=ao noise=none", "", "HBIL_FRAME_INDEX", ARITHMETIC },
    /* the sweep and the levers */
    { "outputs=ao march=sweep", "outputs=ao", "swept", "", INSTEAD },
    { "outputs=ao+near march=sweep", "outputs=ao march=sweep", "near radiance view_radiance swept_light", "", FETCHES },
    { "outputs=ao+near march=sweep facing=half_space", "outputs=ao+near march=sweep", "", "", FETCHES },
    { "outputs=ao march=sweep slices=4 sweep_stride=3", "outputs=ao march=sweep slices=4", "", "", ARITHMETIC },
    { "outputs=ao+near march=both estimator=bitmask reach=1", "outputs=ao+near estimator=bitmask reach=1",
      "swept swept_light view_radiance", "", FETCHES },
    { "outputs=ao mips=spread", "outputs=ao mips=mean", "", "", ARITHMETIC },
    { "outputs=ao mips=mean", "outputs=ao", "depth_mips", "", FETCHES },
    { "outputs=ao+near mips=mean", "outputs=ao mips=mean", "near radiance view_radiance radiance_mips", "", FETCHES },
    { "outputs=ao interleave=yes", "outputs=ao", "", "", INSTEAD }, /* another noise */
    { "outputs=near gather=packed", "outputs=near", "view_radiance", "", FETCHES },
    /* the frames before, the filters, the grid */
    { "outputs=ao filter=3x3", "outputs=ao", "to from", "", FETCHES },
    { "outputs=ao+near+bent filter=5x5", "outputs=ao+near+bent", "to from", "", FETCHES },
    { "outputs=ao filter=3x3 filter_passes=3", "outputs=ao filter=3x3", "", "", FETCHES },
    { "outputs=ao filter=3x3 slices=1", "outputs=ao slices=1", "to from", "", FETCHES },
    { "outputs=ao temporal=yes", "outputs=ao", "to from last_signal last_seen seen",
      "HBIL_LAST_FROM_VIEW HBIL_LAST_TO_RAY HBIL_LAST_SIZE HBIL_RESET", FETCHES },
    { "outputs=ao temporal=yes", "outputs=ao temporal=yes rectify=none", "", "", ARITHMETIC }, /* fetches are a function's */
    { "outputs=ao temporal=yes dynamic=history", "outputs=ao temporal=yes", "", "HBIL_HISTORY", ARITHMETIC },
    { "outputs=ao temporal=yes reproject=gather", "outputs=ao temporal=yes", "motion", "", INSTEAD },
    { "outputs=ao temporal=yes reproject=scatter", "outputs=ao temporal=yes", "landed claimed", "HBIL_VIEW_FROM_LAST", FETCHES },
    { "outputs=near bounces=recursive", "outputs=near gather=packed", "albedo seen last_seen bounce last_bounce",
      "HBIL_LAST_FROM_VIEW HBIL_LAST_TO_RAY HBIL_LAST_SIZE HBIL_RESET", FETCHES },
    { "outputs=near bounces=recursive reproject=scatter", "outputs=near bounces=recursive", "landed claimed pushed pushed_8 pushed_far",
      "HBIL_VIEW_FROM_LAST", FETCHES },
    { "outputs=near bounces=recursive temporal=yes", "outputs=near bounces=recursive", "to from last_signal", "", FETCHES },
    { "outputs=ao downscale=2", "outputs=ao", "to from full_depth full_normal", "HBIL_FULL_SIZE", FETCHES },
    { "outputs=near downscale=4", "outputs=near gather=packed", "to from full_depth full_normal", "HBIL_FULL_SIZE", FETCHES },
    { "outputs=ao+near filter=3x3 storage=half", "outputs=ao+near filter=3x3", "", "", ARITHMETIC }, /* kept below the largest half */
    { "outputs=ao filter=3x3 arithmetic=half", "outputs=ao filter=3x3", "", "", INSTEAD },
    /* inputs */
    { "outputs=ao depth=device", "outputs=ao", "", "HBIL_DEPTH_TO_VIEW", ARITHMETIC },
    { "outputs=ao dynamic=sky_depth", "outputs=ao", "", "HBIL_SKY_DEPTH", ARITHMETIC },
    { "outputs=ao normals=world", "outputs=ao", "", "HBIL_WORLD_TO_VIEW", INSTEAD },
    { "outputs=ao", "outputs=ao normals=depth", "normal", "HBIL_VIEW_Z", INSTEAD },
    { "outputs=ao normal_encoding=octahedral_888", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao normal_encoding=xy", "outputs=ao", "", "", ARITHMETIC },
    { "outputs=ao multisample=yes", "outputs=ao", "multisampled_depth multisampled_normal", "", INSTEAD },
    { "outputs=ao multisample=yes normals=depth", "outputs=ao normals=depth", "multisampled_depth", "", INSTEAD },
    { "outputs=ao", "outputs=ao width=64 height=48", "", "HBIL_SIZE", ARITHMETIC },
};

/* What the SPIR-V of all passes of a config holds. Names, each between blanks. */
typedef struct census { char textures[512], members[1024]; int memory, instructions; } census;

static void note(char *list, size_t room, const char *prefix, const char *name)
{
    char word[128];
    snprintf(word, sizeof word, " %s%s ", prefix, name);
    if (strstr(list, word)) return;
    assert_true(strlen(list) + strlen(word) < room);
    strcat(list, word);
}

static void count_instructions(const uint32_t *at, const uint32_t *end, census *c)
{
    for (at += 5; at < end; at += *at >> 16) { /* 5 words of header */
        const uint32_t op = *at & 0xffff;
        assert_true(*at >> 16 > 0);
        ++c->instructions;
        c->memory += op == SpvOpImageFetch || op == SpvOpImageSampleExplicitLod || op == SpvOpImageWrite;
    }
}

static void count_resources(spvc_resource_type type, census *c)
{
    size_t count, k;
    const spvc_reflected_resource *list = resources(type, &count);
    for (k = 0; k < count; ++k) {
        note(c->textures, sizeof c->textures, "", list[k].name + 2); /* u_ */
        if (spvc_type_get_image_multisampled(spvc_compiler_get_type_handle(compiler, list[k].type_id)))
            note(c->textures, sizeof c->textures, "multisampled_", list[k].name + 2);
    }
}

static void count_members(census *c)
{
    size_t count;
    const spvc_reflected_resource *list = resources(SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, &count);
    const spvc_type_id block = count ? list[0].base_type_id : 0;
    unsigned i, n = count ? spvc_type_get_num_member_types(spvc_compiler_get_type_handle(compiler, block)) : 0;
    assert_true(count <= 1);
    for (i = 0; i < n; ++i) note(c->members, sizeof c->members, "", spvc_compiler_get_member_name(compiler, block, i));
}

/* 0: the config is refused. */
static int take_census(const char *prefix, const char *config, census *c)
{
    hbil_config options;
    hbil_plan plan;
    int32_t i;
    memset(&options, 0, sizeof options);
    memset(c, 0, sizeof *c);
    assert_int_equal(hbil_config_parse(&options, prefix, strlen(prefix), NULL), HBIL_OK);
    assert_int_equal(hbil_config_parse(&options, config, strlen(config), NULL), HBIL_OK);
    if (hbil_plan_build(&options, &plan, NULL) != HBIL_OK) return 0;
    for (i = 0; i < (int32_t)plan.pass_count; ++i) {
        spvc_context context;
        size_t n;
        emit(&plan, i);
        n = compile(text, &plan, words);
        assert_true(n > 0);
        count_instructions(words, words + n, c);
        context = reflect(n);
        count_resources(SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, c);
        count_resources(SPVC_RESOURCE_TYPE_STORAGE_IMAGE, c);
        count_members(c);
        spvc_context_destroy(context);
    }
    return 1;
}

/* Blank-separated names of a that b has not. */
static void names_without(const char *a, const char *b, char *out, size_t room)
{
    *out = 0;
    while (a += strspn(a, " "), *a) {
        char word[64], name[66];
        int n = (int)strcspn(a, " ");
        snprintf(word, sizeof word, "%.*s", n, a);
        snprintf(name, sizeof name, " %s ", word);
        if (!strstr(b, name)) note(out, room, "", word);
        a += n;
    }
}

/* Are the names of `with` that `without` lacks those of `expected`? */
static int vanish(const char *with, const char *without, const char *expected)
{
    char gone[1024], wanted[1024] = " ", extra[1024], kept[1024];
    names_without(with, without, gone, sizeof gone);
    names_without(expected, "", wanted, sizeof wanted);
    names_without(gone, wanted, extra, sizeof extra);
    names_without(wanted, gone, kept, sizeof kept);
    if (*kept) print_error("there with and without, or not at all:%s\n", kept);
    if (*extra) print_error("gone, but not in the table:%s\n", extra);
    return !*kept && !*extra;
}

static int is_saved(const absence *row, const census *with, const census *without)
{
    int fetches = with->memory - without->memory, instructions = with->instructions - without->instructions;
    if (row->saves == INSTEAD) return 1;
    if (instructions > 0 && (row->saves == FETCHES ? fetches > 0 : fetches >= 0)) return 1;
    print_error("instructions %d -> %d, of these fetches and stores %d -> %d\n", with->instructions, without->instructions,
                with->memory, without->memory);
    return 0;
}

/* With the default estimator, and with the bitmask where a row names none and both configs are legal with it. */
static void disabled_means_absent(void **state)
{
    static const char *const prefixes[] = { "", "estimator=bitmask " };
    size_t i, k;
    int wrong = 0, compared = 0;
    (void)state;
    for (k = 0; k < 2; ++k)
        for (i = 0; i < sizeof absences / sizeof absences[0]; ++i) {
            const absence *row = &absences[i];
            census with, without;
            int good;
            if (k && strstr(row->with, "estimator=")) continue;
            good = take_census(prefixes[k], row->with, &with) && take_census(prefixes[k], row->without, &without);
            assert_true(good || k > 0);
            if (!good) continue;
            ++compared;
            good = vanish(with.textures, without.textures, row->textures);
            good &= vanish(with.members, without.members, row->members);
            good &= is_saved(row, &with, &without);
            if (good) continue;
            print_error("    in %s%s, against %s\n", prefixes[k], row->with, row->without);
            ++wrong;
        }
    print_message("%d pairs of configs\n", compared);
    assert_int_equal(wrong, 0);
}

/* ---------------------------------------------------------------------- text for people */

/* Every hbil_ and HBIL_ name that a line declares is used on another line; members of the block by any pass of the plan. */
static void check_no_dead_names(const hbil_plan *plan, int32_t pass)
{
    const char *s = text;
    (void)pass;
    assert_memory_equal(text, "#version ", 9);
    assert_null(strstr(text, "#if"));
    assert_true(!strstr(text, "#define") || (draws(plan) && word_count(text, "imageStore") > 1));
    assert_null(strstr(text, "\n\n\n"));
    assert_null(strstr(text, " \n"));
    assert_null(strchr(text, '\t'));
    assert_null(strchr(text, '\r'));
    assert_int_equal(text[strlen(text) - 1], '\n');
    for (; *s; s += strcspn(s, "\n") + 1) {
        char name[64];
        size_t n = 0;
        const char *at = strncmp(s, "const ", 6) == 0 || strncmp(s, "layout(set", 10) == 0 || strncmp(s, "layout(bind", 11) == 0 ||
                         strncmp(s, "struct ", 7) == 0 || (*s >= 'a' && *s <= 'z' && strncmp(s, "layout", 6) && strncmp(s, "void main", 9)) ? s : NULL;
        if (!at) continue;
        while (strncmp(at, "hbil_", 5) && strncmp(at, "HBIL_", 5) && strncmp(at, "u_", 2) && *at != '\n') ++at;
        if (*at == '\n') continue;
        if (strncmp(at, "HbilFrame", 9) == 0) continue;
        while (hbil__is_word(at[n])) ++n;
        memcpy(name, at, n);
        name[n] = 0;
        if (word_count(test_body(text), name) < 2) { /* below the header comment */
            print_error("%s\nunused: %s\n", text, name);
            fail();
        }
    }
}

static void text_has_no_directive_and_no_unused_name(void **state)
{
    (void)state;
    for_all(check_no_dead_names);
}

static void every_uniform_is_read_by_a_pass(void **state)
{
    int k;
    (void)state;
    for (k = 0; k < config_count; ++k) {
        int uses[HBIL_MAX_CONSTANTS] = { 0 };
        hbil_plan plan;
        uint32_t i, j;
        assert_int_equal(hbil_plan_build(&configs[k], &plan, NULL), HBIL_OK);
        for (j = 0; j < plan.pass_count; ++j) {
            if (!plan.passes[j].constants) continue;
            emit(&plan, (int32_t)j);
            for (i = 0; i < plan.constant_count; ++i) uses[i] += word_count(strstr(text, "uniform HbilFrame"), plan.constants[i].name) - 1;
        }
        for (i = 0; i < plan.constant_count; ++i) assert_true(uses[i] > 0);
    }
}

static void ao_alone_holds_nothing_of_radiance(void **state)
{
    static const char *const words_of_light[] = { "radiance", "albedo", "direct", "u_near", "RADIANCE", "bent", "near;", "composite" };
    hbil_config c;
    hbil_plan plan;
    int32_t i;
    size_t k;
    (void)state;
    memset(&c, 0, sizeof c);
    c.outputs = HBIL_OUTPUTS_AO;
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    assert_int_equal(plan.pass_count, 2);
    assert_int_equal(hbil_plan_texture(&plan, "radiance"), -1);
    for (i = 0; i < (int32_t)plan.pass_count; ++i) {
        hbil_emit_glsl(&plan, i, text, sizeof text, NULL);
        for (k = 0; k < sizeof words_of_light / sizeof words_of_light[0]; ++k) {
            const char *body = test_body(text);
            const char *hit = strstr(body, words_of_light[k]);
            if (hit && strcmp(words_of_light[k], "direct") == 0 && strncmp(hit, "direction", 9) == 0) hit = NULL;
            while (hit && hit > body && *hit != '\n' && strncmp(hit, "//", 2)) --hit; /* a word in a comment is no code */
            if (hit && *hit == '\n') print_error("%s in the text of %s\n", words_of_light[k], plan.passes[i].name);
            assert_true(!hit || *hit != '\n');
        }
    }
}

static int set_up(void **state)
{
    (void)state;
    config_count = matrix_pairwise(configs);
    config_count += matrix_in_contexts(configs + config_count, CONFIGS - config_count);
    return hbil_glslang_init() ? 0 : -1;
}

static int tear_down(void **state)
{
    (void)state;
    hbil_glslang_shutdown();
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_text_compiles_and_its_spirv_is_valid),
        cmocka_unit_test(filter_and_glslang_preprocessor_give_the_same_spirv),
        cmocka_unit_test(reflection_equals_the_plan),
        cmocka_unit_test(disabled_means_absent),
        cmocka_unit_test(text_has_no_directive_and_no_unused_name),
        cmocka_unit_test(every_uniform_is_read_by_a_pass),
        cmocka_unit_test(ao_alone_holds_nothing_of_radiance),
    };
    return cmocka_run_group_tests_name("glsl", tests, set_up, tear_down);
}
