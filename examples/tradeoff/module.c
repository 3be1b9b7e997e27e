/* module.c - reads a SPIR-V module by SPIRV-Tools and SPIRV-Cross, and patches its bindings. */
#include "module.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <spirv-tools/libspirv.h>
#include <spirv_cross/spirv_cross_c.h>

#include "../../shadergen/files.h"

#define COMPILE "glslangValidator -V --target-env vulkan1.1 -o FILE.spv FILE.comp"
#define INPUTS  "depth, normal, radiance, albedo"
#define OUTPUTS "ao, near"

/* A module that is being read. */
typedef struct reader {
    external          *e;
    const module_text *text;
    settings          *s;
    hbil_pass         *pass;
    uint32_t          *words;
    size_t             count;
    spvc_compiler      compiler;
    uint32_t           push;                         /* id of the push constants; 0: none */
    int                found[HBIL_MAX_BINDINGS + 1]; /* keys that have their resource */
} reader;

#define FAIL(r, format, ...)                                                                                           \
    frame_error((r)->s->error, sizeof (r)->s->error, "--external, %s: " format, (r)->text->path, __VA_ARGS__)

#define FORMAT(name) (1u << HBIL_FORMAT_##name)
/* What a name can be; formats: of storage images. The last row: any other name. */
static const struct row { const char *name; hbil_life life; unsigned formats; } rows[] = {
    {"depth", HBIL_LIFE_INPUT, FORMAT(R32F)},        {"normal", HBIL_LIFE_INPUT, FORMAT(RGBA32F)},
    {"radiance", HBIL_LIFE_INPUT, FORMAT(RGBA32F)},  {"albedo", HBIL_LIFE_INPUT, FORMAT(RGBA32F)},
    {"ao", HBIL_LIFE_OUTPUT, FORMAT(R32F) | FORMAT(RGBA32F)}, {"near", HBIL_LIFE_OUTPUT, FORMAT(RGBA32F)},
    {"", HBIL_LIFE_TRANSIENT, FORMAT(R32F) | FORMAT(R32UI) | FORMAT(RGBA32F) | FORMAT(RGBA16F)},
};
#define ROWS (sizeof rows / sizeof *rows)

static const struct row *row_of(const char *name)
{
    size_t i = 0;

    while (i + 1 < ROWS && strcmp(rows[i].name, name) != 0) i++;
    return &rows[i];
}

/* ---- the file ---------------------------------------------------------------------------------------------------- */

static int read_words(reader *r)
{
    size_t size;
    char  *data = read_all(r->text->path, &size);

    if (!data) return FAIL(r, "cannot be read (%s). Give the SPIR-V of a compute shader", strerror(errno));
    r->words = (uint32_t *)(void *)data; /* from malloc */
    r->count = size / sizeof *r->words;
    if (size % sizeof *r->words == 0 && r->count > 5 && r->words[0] == SpvMagicNumber) return 1;
    return FAIL(r, "is no SPIR-V. Compile it: %s", COMPILE);
}

/* What is not valid may take the driver down. */
static int validate(reader *r)
{
    spv_context    context = spvContextCreate(SPV_ENV_VULKAN_1_1);
    spv_diagnostic why = NULL;
    const int      ok = context && spvValidateBinary(context, r->words, r->count, &why) == SPV_SUCCESS;

    if (!ok) FAIL(r, "is not valid for Vulkan 1.1: %s. Compile it for that: %s", why ? why->error : "?", COMPILE);
    spvDiagnosticDestroy(why);
    if (context) spvContextDestroy(context);
    return ok;
}

/* The runner's device has no features on. */
static int check_capabilities(reader *r)
{
    const SpvCapability *list;
    size_t               count = 0, i;

    spvc_compiler_get_declared_capabilities(r->compiler, &list, &count);
    for (i = 0; i < count; i++)
        if (list[i] != SpvCapabilityShader && list[i] != SpvCapabilityMatrix && list[i] != SpvCapabilityImageQuery
            && (list[i] < SpvCapabilityGroupNonUniform || list[i] > SpvCapabilityGroupNonUniformQuad))
            return FAIL(r, "declares the SPIR-V capability %d, a feature that is off here. Do without: images have a "
                           "format, numbers 32 bits", (int)list[i]);
    return 1;
}

static int choose_entry(reader *r)
{
    const spvc_entry_point *points;
    const char             *chosen = NULL;
    char                    all[512] = "";
    size_t                  count = 0, i;
    int                     fit = 0;

    spvc_compiler_get_entry_points(r->compiler, &points, &count);
    for (i = 0; i < count; i++) {
        const size_t used = strlen(all);

        if (points[i].execution_model != SpvExecutionModelGLCompute) continue;
        snprintf(all + used, sizeof all - used, " %s", points[i].name);
        if (r->text->entry && strcmp(points[i].name, r->text->entry) != 0) continue;
        chosen = points[i].name;
        fit++;
    }
    if (fit != 1 || strlen(chosen) >= sizeof *r->e->entries)
        return FAIL(r, "has %s. Choose with entry=, of at most 63 letters:%s",
                    !*all ? "no compute shader" : fit ? "several entry points" : "no such entry point", all);
    r->e->crowded |= count > 1;
    strcpy(r->e->entries[r->e->plan.pass_count], chosen);
    return spvc_compiler_set_entry_point(r->compiler, chosen, SpvExecutionModelGLCompute) == SPVC_SUCCESS;
}

static int read_group(reader *r)
{
    unsigned size[3], i;

    for (i = 0; i < 3; i++)
        size[i] = spvc_compiler_get_execution_mode_argument_by_index(r->compiler, SpvExecutionModeLocalSize, i);
    if (size[0] < 1 || size[1] < 1 || size[0] > UINT16_MAX || size[1] > UINT16_MAX || size[2] != 1)
        return FAIL(r, "has a local size of %u x %u x %u. An invocation is a pixel: its z must be 1", size[0], size[1],
                    size[2]);
    r->pass->group[0] = (uint16_t)size[0];
    r->pass->group[1] = (uint16_t)size[1];
    return 1;
}

/* ---- resources --------------------------------------------------------------------------------------------------- */

/* The key that names the resource. NULL: there is none. */
static const module_key *key_of(reader *r, const spvc_reflected_resource *res, int push)
{
    const int set = push ? -1 : (int)spvc_compiler_get_decoration(r->compiler, res->id, SpvDecorationDescriptorSet);
    const int binding = push ? 0 : (int)spvc_compiler_get_decoration(r->compiler, res->id, SpvDecorationBinding);
    int       i;

    for (i = 0; i < r->text->count; i++) {
        if (r->text->keys[i].set != set || r->text->keys[i].binding != binding) continue;
        r->found[i] = 1;
        return &r->text->keys[i];
    }
    if (push) FAIL(r, "no key names its push constants %s. Add %s", res->name, "uniforms=push");
    else
        FAIL(r, "no key names %s at set %d, binding %d. Add one, as in depth=%d.%d", res->name, set, binding, set,
             binding);
    return NULL;
}

static int place(reader *r, const spvc_reflected_resource *res, uint32_t slot)
{
    unsigned set, binding;

    if (!spvc_compiler_get_binary_offset_for_decoration(r->compiler, res->id, SpvDecorationDescriptorSet, &set)
        || !spvc_compiler_get_binary_offset_for_decoration(r->compiler, res->id, SpvDecorationBinding, &binding))
        return FAIL(r, "%s has its binding from a group of decorations. Compile it: %s", res->name, COMPILE);
    r->words[set] = 0;
    r->words[binding] = slot;
    return 1;
}

static hbil_format format_of(SpvImageFormat format)
{
    return format == SpvImageFormatR32f ? HBIL_FORMAT_R32F : format == SpvImageFormatR32ui ? HBIL_FORMAT_R32UI
         : format == SpvImageFormatRgba32f ? HBIL_FORMAT_RGBA32F : format == SpvImageFormatRgba16f ? HBIL_FORMAT_RGBA16F
         : HBIL_FORMAT_COUNT;
}

/* Formats as text. */
static const char *list_formats(unsigned formats, char text[64])
{
    int f;

    text[0] = 0;
    for (f = 0; f < HBIL_FORMAT_COUNT; f++)
        if (formats & 1u << f) strcat(strcat(text, *text ? " or " : ""), hbil_format_name((hbil_format)f));
    return text;
}

/* The plan's texture of that name, made if need be. -1: it cannot be. format: of a storage image, 0: sampled. */
static int texture_of(reader *r, const char *name, int format)
{
    const struct row *row = row_of(name);
    hbil_plan        *plan = &r->e->plan;
    int               at = hbil_plan_texture(plan, name);
    const int         fixed = at >= 0 && row->life != HBIL_LIFE_INPUT;
    const unsigned    formats = fixed ? 1u << plan->textures[at].format : row->formats;
    hbil_texture     *t;
    char              list[64];

    if (format && !(formats & 1u << format))
        return FAIL(r, "%s is a storage image of another format. Declare it %s", name, list_formats(formats, list)), -1;
    if (at >= 0) return at;
    if (!format && row->life != HBIL_LIFE_INPUT)
        return FAIL(r, "%s is read, but is no input (%s), and no pass before this one writes it", name, INPUTS), -1;
    if (plan->texture_count == HBIL_MAX_TEXTURES)
        return FAIL(r, "%s: more than %d images", name, HBIL_MAX_TEXTURES), -1;
    at = (int)plan->texture_count++;
    t = &plan->textures[at];
    strcpy(t->name, name);
    t->format = (uint16_t)(row->life == HBIL_LIFE_INPUT ? (int)HBIL_FORMAT_ANY : format);
    t->life = (uint16_t)row->life;
    t->div = t->mips = t->copies = t->layers = 1;
    t->dim = HBIL_DIM_2D;
    return at;
}

/* A binding, and what it waits for: accesses of other passes, and of last frame. */
static int bind(reader *r, int texture, int access)
{
    const uint16_t at = (uint16_t)texture;
    hbil_pass     *pass = r->pass;
    hbil_binding  *b = &pass->bindings[pass->binding_count];
    hbil_barrier  *wait = &pass->barriers[pass->barrier_count];

    if (pass->binding_count == HBIL_MAX_BINDINGS) return FAIL(r, "has more than %d images", HBIL_MAX_BINDINGS);
    b->texture = at;
    b->access = (uint8_t)access;
    b->role = access == HBIL_ACCESS_WRITE ? HBIL_ROLE_UPDATE : HBIL_ROLE_SAMPLE;
    b->slot = ++pass->binding_count; /* the block has 0 */
    if (r->e->plan.textures[at].life == HBIL_LIFE_INPUT) return 1;
    wait->texture = at;
    wait->before = HBIL_ACCESS_SAMPLE | HBIL_ACCESS_WRITE;
    wait->after = (uint8_t)access;
    pass->barrier_count++;
    return 1;
}

static int take_image(reader *r, const spvc_reflected_resource *res, int access)
{
    const module_key *key = key_of(r, res, 0);
    spvc_type         type = spvc_compiler_get_type_handle(r->compiler, res->type_id);
    int               texture, is_uint;

    if (!key) return 0;
    if (strcmp(key->name, "uniforms") == 0) return FAIL(r, "%s, which uniforms names, is an image", res->name);
    if (spvc_type_get_num_array_dimensions(type) > 0 || spvc_type_get_image_dimension(type) != SpvDim2D
        || spvc_type_get_image_arrayed(type) || spvc_type_get_image_multisampled(type))
        return FAIL(r, "%s is no plain 2D image. Declare it %s", key->name, "sampler2D, texture2D or image2D");
    texture = texture_of(r, key->name, access == HBIL_ACCESS_SAMPLE
                                           ? 0 : (int)format_of(spvc_type_get_image_storage_format(type)));
    if (texture < 0) return 0;
    type = spvc_compiler_get_type_handle(r->compiler, spvc_type_get_image_sampled_type(type));
    is_uint = r->e->plan.textures[texture].format == HBIL_FORMAT_R32UI;
    if (spvc_type_get_basetype(type) != (is_uint ? SPVC_BASETYPE_UINT32 : SPVC_BASETYPE_FP32))
        return FAIL(r, "%s has texels of another type. Declare it of %s", key->name, is_uint ? "uint" : "float");
    return bind(r, texture, access) && place(r, res, r->pass->binding_count);
}

static int take_sampled(reader *r, const spvc_reflected_resource *res)
{
    return take_image(r, res, HBIL_ACCESS_SAMPLE);
}

static int take_stored(reader *r, const spvc_reflected_resource *res) { return take_image(r, res, HBIL_ACCESS_WRITE); }

static int take_block(reader *r, const spvc_reflected_resource *res)
{
    const int         push = spvc_type_get_storage_class(spvc_compiler_get_type_handle(r->compiler, res->type_id))
                             == SpvStorageClassPushConstant;
    const module_key *key = key_of(r, res, push);
    size_t            size = 0;

    if (!key) return 0;
    spvc_compiler_get_declared_struct_size(
        r->compiler, spvc_compiler_get_type_handle(r->compiler, res->base_type_id), &size);
    if (strcmp(key->name, "uniforms") != 0) return FAIL(r, "%s is a uniform block, not an image", key->name);
    if (size > sizeof(external_block))
        return FAIL(r, "the block %s has %u bytes, what is handed over %u. Declare the block of %s", res->name,
                    (unsigned)size, (unsigned)sizeof(external_block), "examples/tradeoff/README.md");
    r->e->plan.constants_size = sizeof(external_block);
    r->pass->constants = 1;
    if (push) r->push = res->id;
    return push || place(r, res, 0);
}

/* Shares the binding of an image: hbil_vk.h makes combined descriptors, which serve both. */
static int take_sampler(reader *r, const spvc_reflected_resource *res)
{
    int i;

    for (i = 0; i < r->pass->binding_count; i++)
        if (r->pass->bindings[i].access == HBIL_ACCESS_SAMPLE) return place(r, res, r->pass->bindings[i].slot);
    return FAIL(r, "has the sampler %s, but no image that it could sample", res->name);
}

static int refuse(reader *r, const spvc_reflected_resource *res)
{
    return FAIL(r, "%s is neither an image nor a uniform block, and there is nothing else here", res->name);
}

static int take_resources(reader *r)
{
    static const struct {
        spvc_resource_type type;
        int (*take)(reader *, const spvc_reflected_resource *);
    } kinds[] = { /* samplers behind images */
        {SPVC_RESOURCE_TYPE_SAMPLED_IMAGE, take_sampled}, {SPVC_RESOURCE_TYPE_SEPARATE_IMAGE, take_sampled},
        {SPVC_RESOURCE_TYPE_STORAGE_IMAGE, take_stored},  {SPVC_RESOURCE_TYPE_SEPARATE_SAMPLERS, take_sampler},
        {SPVC_RESOURCE_TYPE_UNIFORM_BUFFER, take_block},  {SPVC_RESOURCE_TYPE_PUSH_CONSTANT, take_block},
        {SPVC_RESOURCE_TYPE_STORAGE_BUFFER, refuse},      {SPVC_RESOURCE_TYPE_ACCELERATION_STRUCTURE, refuse},
    };
    const spvc_reflected_resource *list;
    spvc_resources                 all;
    spvc_set                       used;
    size_t                         count, i, k;

    if (spvc_compiler_get_active_interface_variables(r->compiler, &used) != SPVC_SUCCESS
        || spvc_compiler_create_shader_resources_for_active_variables(r->compiler, &all, used) != SPVC_SUCCESS)
        return FAIL(r, "its resources cannot be read. Compile it: %s", COMPILE);
    for (k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        if (spvc_resources_get_resource_list_for_type(all, kinds[k].type, &list, &count) != SPVC_SUCCESS) continue;
        for (i = 0; i < count; i++)
            if (!kinds[k].take(r, &list[i])) return 0;
    }
    for (k = 0; k < (size_t)r->text->count; k++)
        if (!r->found[k])
            return FAIL(r, "%s: %s uses nothing there. Mend its binding, or leave the key out", r->text->keys[k].name,
                        r->e->entries[r->e->plan.pass_count]);
    return r->pass->binding_count > 0 || FAIL(r, "reads and writes no image (%s)", INPUTS ", " OUTPUTS);
}

/* ---- the pass ---------------------------------------------------------------------------------------------------- */

/* Moves push constants into the uniform block: storage classes, and the binding that they lack. */
static int push_to_uniform(reader *r)
{
    const uint32_t binding[] = {4u << 16 | SpvOpDecorate, r->push, SpvDecorationDescriptorSet, 0,
                                4u << 16 | SpvOpDecorate, r->push, SpvDecorationBinding, 0};
    uint32_t      *to = malloc(r->count * sizeof *to + sizeof binding);
    size_t         at, used = 5, length;

    if (!to) return FAIL(r, "%s", "out of memory");
    memcpy(to, r->words, used * sizeof *to);
    for (at = 5; at < r->count; at += length) {
        const uint32_t op = r->words[at] & 0xffff, class_at = op == SpvOpTypePointer ? 2 : 3;

        length = r->words[at] >> 16; /* has been validated */
        if (used == at && (op == SpvOpDecorate || op == SpvOpMemberDecorate)) {
            memcpy(to + used, binding, sizeof binding);
            used += sizeof binding / sizeof *binding;
        }
        memcpy(to + used, r->words + at, length * sizeof *to);
        if ((op == SpvOpTypePointer || op == SpvOpVariable) && to[used + class_at] == SpvStorageClassPushConstant)
            to[used + class_at] = SpvStorageClassUniform;
        used += length;
    }
    free(r->words);
    r->words = to;
    r->count = used;
    return 1;
}

static int reflect(reader *r, spvc_context context)
{
    spvc_parsed_ir ir;

    if (spvc_context_parse_spirv(context, r->words, r->count, &ir) != SPVC_SUCCESS
        || spvc_context_create_compiler(context, SPVC_BACKEND_NONE, ir, SPVC_CAPTURE_MODE_TAKE_OWNERSHIP, &r->compiler)
               != SPVC_SUCCESS)
        return FAIL(r, "SPIRV-Cross cannot read it: %s", spvc_context_get_last_error_string(context));
    return check_capabilities(r) && choose_entry(r) && read_group(r) && take_resources(r)
           && (!r->push || push_to_uniform(r));
}

int module_append(external *e, const module_text *text, settings *s)
{
    reader       r;
    spvc_context context = NULL;
    uint32_t     p = e->plan.pass_count;
    int          code = TRADE_FILES;

    memset(&r, 0, sizeof r);
    r.e = e;
    r.text = text;
    r.s = s;
    if (p == HBIL_MAX_PASSES) return FAIL(&r, "more than %d passes", HBIL_MAX_PASSES), TRADE_USAGE;
    r.pass = &e->plan.passes[p];
    snprintf(r.pass->name, sizeof r.pass->name, "%d", (int)p + 1);
    r.pass->grid = HBIL_GRID_PIXELS;
    if (read_words(&r) && validate(&r)) {
        code = TRADE_USAGE;
        if (spvc_context_create(&context) != SPVC_SUCCESS) FAIL(&r, "%s", "out of memory");
        else if (reflect(&r, context)) code = TRADE_DONE;
        spvc_context_destroy(context);
    }
    r.pass->domain = r.pass->bindings[0].texture; /* all are of the frame's size */
    e->words[p] = r.words;
    e->spirv.words[p] = r.words;
    e->spirv.counts[p] = r.count;
    e->spirv.entries[p] = e->entries[p];
    e->plan.pass_count += code == TRADE_DONE;
    if (code != TRADE_DONE) free(r.words);
    return code;
}
