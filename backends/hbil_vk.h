/* hbil_vk.h - runs a plan of hbil.h on Vulkan 1.1 or later: records its passes into your command buffer.
 *
 * May be used as it is. In exactly one C99 or C++11 file, define HBIL_VK_IMPLEMENTATION before the include; the implementation
 * of hbil.h has to be in the program too. If you use volk, include volk.h first. Links nothing: every Vulkan function comes
 * through your vkGetInstanceProcAddr, be it volk's, the loader's or your own.
 *
 * Features
 *   [x] Any plan with target=vulkan: inputs, outputs, transient and history textures (copies, age)
 *   [x] No Vulkan extension, no device feature; VK_EXT_debug_utils labels if the instance has them on
 *   [x] No heap, no thread, no global; the context lives in your memory, about 8 KB
 *   [x] 2D, multisampled, array, cube and 3D textures; resources of your own for environment=hook
 *   [x] Any number of frames in flight without copies: constants are written on the device's own time line
 *   [x] Milliseconds per pass
 *   [x] Passes of your own in a plan: your SPIR-V, entry point and uniform block
 *   [x] The first frame after a resize begins without history
 *   [x] Frames smaller than the textures: resize once to the largest, then any frame.width and height up to it
 *   [x] A texture of yours that is smaller than the plan says is refused before anything is recorded, if you give hbil_vk.extents
 *   [ ] Mip chains: no plan has them yet
 *   [ ] Transient textures that share memory
 *   [ ] Queue family transfers: record them around hbil_vk_record yourself
 *
 * Who owns what
 *   | thing                                          | made by       | freed by                                        |
 *   | instance, device, queue, cache, callbacks      | you           | you, after hbil_vk_shutdown                     |
 *   | command buffer, fence                          | you           | you                                             |
 *   | hbil_vk (the struct)                           | you           | you, after hbil_vk_shutdown; move it as you like |
 *   | plan, SPIR-V                                   | you           | you, right after hbil_vk_init                   |
 *   | images and views of INPUT and OUTPUT textures  | you           | you, after the next resize or shutdown          |
 *   | images, views, memory of TRANSIENT and HISTORY | hbil_vk_resize | hbil_vk_resize, hbil_vk_shutdown               |
 *   | pipelines, layouts, descriptor pool and sets,  | hbil_vk_init  | hbil_vk_shutdown                                |
 *   | two samplers, uniform buffer, query pool       |               |                                                 |
 *   | layout and set of your hook's resources        | you           | you, after hbil_vk_shutdown                     |
 *
 * Layouts and synchronisation
 *   Inputs   views of one level with sampled usage and a float, normalised or depth format; in hbil_vk_info.input_layout; your
 *            writes made visible to COMPUTE_SHADER / SHADER_READ before the recorded commands.
 *   Outputs  views of one level with storage and sampled usage, of hbil_vk_format; in GENERAL before and after. Your earlier
 *            accesses finished before COMPUTE_SHADER / SHADER_WRITE. Afterwards the last write is COMPUTE_SHADER /
 *            SHADER_WRITE: your barrier takes it from there.
 *   Shapes   by hbil_texture.dim:
 *            2D              VIEW_TYPE_2D of an image with one sample; of an array, one layer. Read by texelFetch.
 *            2D_MULTISAMPLE  VIEW_TYPE_2D of an image with more samples than plan.config.sample. Read by texelFetch.
 *            2D_ARRAY        VIEW_TYPE_2D_ARRAY of exactly hbil_texture.layers layers.
 *            CUBE            VIEW_TYPE_CUBE, any size; faces +X -X +Y -Y +Z -Z.
 *            3D              VIEW_TYPE_3D, any size.
 *            CUBE and 3D are read through a linear sampler that clamps to the edge, at level 0: a format with
 *            SAMPLED_IMAGE_FILTER_LINEAR. All others may be of any size from hbil_plan_extent on; texel 0,0 is the corner.
 *   Hook     environment=hook: a text that declares resources in set 1 needs hbil_vk_info.hook_layout, and hbil_vk.hook_set
 *            before each record. They are bound as set 1 in the passes that have hbil_pass.hook, and are yours to synchronise.
 *   Ours     always in GENERAL; all barriers are recorded, those against the frame before too.
 *   Order    submit in the order of recording: to one queue, or with semaphores between queues of the same family. Record anew
 *            for each frame; the first recording after a resize sets up our images.
 *   Idle     before hbil_vk_resize and hbil_vk_shutdown the device has finished all that was recorded.
 *   Record   outside a render pass. Leaves the compute pipeline and descriptor sets 0 and 1 of the compute bind point changed.
 *   Threads  one hbil_vk, one thread at a time. Several, of one device too, on a thread each: all that they share is what Vulkan
 *            lets threads share. Your queue, command pool and pipeline cache are yours to guard.
 *
 * Faults
 *   Every call that can fail says so by its result, and by hbil_vk.message what failed, of which pass or texture, and what to do.
 *   hbil_vk_init     nothing stays behind. Mend it, call again.
 *   hbil_vk_resize   refused (E_ARG, E_TEXTURE) or failed (E_VULKAN, E_DEVICE): hbil_vk_record is refused until a resize succeeds.
 *                    Refused keeps our images and their history.
 *   hbil_vk_record   nothing was recorded. What it records cannot fail, but your vkEndCommandBuffer and vkQueueSubmit can: if a
 *                    recording was not executed, set hbil_vk.fresh to 1, and the next one sets all up anew, without history.
 *   Device lost      the fence, the submit or the next call here says so. hbil_vk_shutdown as ever; a new device; hbil_vk_init.
 *
 * Integration in five steps
 *   1. Plan: hbil_config c = {0}; hbil_plan_build(&c, &plan, &diags);
 *   2. SPIR-V 1.3 or older of each pass: hbil_emit_glsl, then hbil_glslang.h at run time or glslangValidator offline.
 *      With environment=hook it is hbil_emit_glsl_hook that takes your function: this file never sees text. Messages of the
 *      compiler about it point into source 1, at its own lines.
 *   3.      hbil_vk_info info = {0};
 *           info.plan = &plan; info.spirv[p].words = ...; info.instance = ...; info.get_proc = vkGetInstanceProcAddr; ...
 *           if (hbil_vk_init(&info, &vk) != HBIL_VK_OK) puts(vk.message);
 *   4. When the size or a view of yours changes: put your views where the plan wants them, then resize. With an unchanged size
 *      this keeps our images and history.
 *           VkImageView views[HBIL_MAX_TEXTURES] = {0};
 *           views[hbil_plan_texture(&plan, "depth")] = my_depth; ...
 *           hbil_vk_resize(&vk, width, height, views);
 *      Vulkan does not tell the size of a view, and one that is too small reads as anything. Say it, and it is checked:
 *           VkExtent3D extents[HBIL_MAX_TEXTURES] = {0};
 *           extents[hbil_plan_texture(&plan, "depth")] = my_depth_extent; ...
 *           vk.extents = extents;    before each resize
 *   5. Each frame, after your G-buffer: hbil_vk_record(&vk, cmd, &frame); submit as ever. At the end: hbil_vk_shutdown(&vk);
 *
 * Changelog (API: your code may need a change; EMIT; FIX; NEW)
 *   2026-11-28  NEW   hbil_vk.extents, E_TEXTURE: views that are too small are refused; hbil_vk.fresh; messages name the VkResult and
 *                     the pass or texture
 *               API   after a resize that was refused, hbil_vk_record is refused too, until one succeeds
 *               FIX   a Vulkan call that failed and left garbage in its handle made shutdown destroy that
 *   2026-11-27  NEW   hbil_vk_spirv.entry, hbil_vk.block; the nearest sampler clamps to the edge
 *   2026-11-25  NEW   frames smaller than the images; history needs no clearing
 *   2026-11-24  NEW   multisampled, array, cube and 3D textures; hook_layout, hook_set
 *   2026-11-22  NEW   first version
 */

#ifndef HBIL_VK_H
#define HBIL_VK_H

#ifndef HBIL_H
#include "hbil.h"
#endif
#include <vulkan/vulkan_core.h> /* already there, without prototypes, if volk.h came first */

#ifndef HBIL_VK_API
#define HBIL_VK_API extern
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Result of every call that can fail; hbil_vk.message then says what to do. This list makes the enum and the names. */
#define HBIL_VK_RESULTS(X)                                        \
    X(OK,          "success")                                     \
    X(E_ARG,       "argument missing or out of range")            \
    X(E_PLAN,      "plan not made for this backend")              \
    X(E_DEVICE,    "device lacks what the plan needs")            \
    X(E_FRAME,     "frame does not fit the plan or the size")     \
    X(E_NOT_READY, "the device has not finished that recording")  \
    X(E_VULKAN,    "a Vulkan call failed")                        \
    X(E_TEXTURE,   "a texture of yours is too small")
#define HBIL_VK__RESULT_ENUM(name, text) HBIL_VK_##name,
typedef enum hbil_vk_result { HBIL_VK_RESULTS(HBIL_VK__RESULT_ENUM) HBIL_VK_RESULT_COUNT } hbil_vk_result;

typedef struct hbil_vk_spirv {
    const uint32_t *words;
    size_t          count;          /* of words, not bytes */
    const char     *entry;          /* point; NULL: "main" */
} hbil_vk_spirv;

/* Zero it first. */
typedef struct hbil_vk_info {
    VkInstance                   instance;       /* made with apiVersion 1.1 or later */
    VkPhysicalDevice             physical_device;
    VkDevice                     device;
    uint32_t                     queue_family;   /* of the queue you submit to; has compute */
    PFN_vkGetInstanceProcAddr    get_proc;       /* vkGetInstanceProcAddr: volk's, the loader's, anyone's */
    const VkAllocationCallbacks *allocator;      /* NULL, or kept until shutdown */
    VkPipelineCache              pipeline_cache; /* may be null */
    const hbil_plan             *plan;           /* copied */
    hbil_vk_spirv                spirv[HBIL_MAX_PASSES]; /* one per pass of the plan */
    VkImageLayout                input_layout;   /* of every input: 0 or GENERAL, or SHADER_READ_ONLY_OPTIMAL */
    int                          timestamps;     /* 1: hbil_vk_timings works */
    VkDescriptorSetLayout        hook_layout;    /* of set 1 in passes with .hook; null: your hook reads no resources */
} hbil_vk_info;

/* Every function used, as the member without "vk". */
#define HBIL_VK__INSTANCE_FUNCTIONS(X)                                                                           \
    X(GetPhysicalDeviceProperties) X(GetPhysicalDeviceQueueFamilyProperties) X(GetPhysicalDeviceMemoryProperties) \
    X(GetPhysicalDeviceFormatProperties)
#define HBIL_VK__DEVICE_FUNCTIONS(X)                                                                             \
    X(CreateImage) X(DestroyImage) X(GetImageMemoryRequirements) X(BindImageMemory)                              \
    X(CreateImageView) X(DestroyImageView) X(AllocateMemory) X(FreeMemory)                                       \
    X(CreateBuffer) X(DestroyBuffer) X(GetBufferMemoryRequirements) X(BindBufferMemory)                          \
    X(CreateSampler) X(DestroySampler) X(CreateDescriptorSetLayout) X(DestroyDescriptorSetLayout)                \
    X(CreateDescriptorPool) X(DestroyDescriptorPool) X(AllocateDescriptorSets) X(UpdateDescriptorSets)           \
    X(CreateShaderModule) X(DestroyShaderModule) X(CreatePipelineLayout) X(DestroyPipelineLayout)                \
    X(CreateComputePipelines) X(DestroyPipeline) X(CreateQueryPool) X(DestroyQueryPool) X(GetQueryPoolResults)   \
    X(CmdPipelineBarrier) X(CmdUpdateBuffer) X(CmdResetQueryPool) X(CmdWriteTimestamp)     \
    X(CmdBindPipeline) X(CmdBindDescriptorSets) X(CmdDispatch)
#define HBIL_VK__OPTIONAL_FUNCTIONS(X) X(CmdBeginDebugUtilsLabelEXT) X(CmdEndDebugUtilsLabelEXT)
#define HBIL_VK__MEMBER(name) PFN_vk##name name;
typedef struct hbil_vk__functions {
    HBIL_VK__INSTANCE_FUNCTIONS(HBIL_VK__MEMBER)
    HBIL_VK__DEVICE_FUNCTIONS(HBIL_VK__MEMBER)
    HBIL_VK__OPTIONAL_FUNCTIONS(HBIL_VK__MEMBER)
} hbil_vk__functions;

#define HBIL_VK__COPIES 2 /* a history has this frame's copy and last frame's: ages are 0 and 1 */

typedef struct hbil_vk {
    char     message[256];          /* why the last failed call failed, and what to do */
    uint32_t width, height;         /* of the last hbil_vk_resize, 0 before */
    VkDescriptorSet hook_set;       /* you set it: bound as set 1 where hook_layout applies. Read by hbil_vk_record */
    const void *block;              /* you set it: NULL, or plan.constants_size bytes instead of those of hbil_pack_constants,
                                       for a plan whose block you changed. Read by hbil_vk_record */
    const VkExtent3D *extents;      /* you set it: NULL, or of each view its size by plan texture; depth: layers of a 2D_ARRAY.
                                       0: not told. Read by the next hbil_vk_resize, which sets it back to NULL */
    int      fresh;                 /* 1: our images hold nothing: the next recording sets them up and begins without history.
                                       A resize sets it, and you do if a recording was not executed */

    /* private */
    hbil_vk__functions           fn;
    hbil_plan                    plan;
    VkDevice                     device;
    const VkAllocationCallbacks *allocator;
    VkImageLayout                input_layout;
    uint32_t                     max_extent, max_layers;
    VkPhysicalDeviceMemoryProperties memory_types;

    VkSampler                    samplers[2];    /* nearest; linear, for CUBE and 3D */
    VkDescriptorSetLayout        hook_layout;
    VkBuffer                     constants;
    VkDeviceMemory               constants_memory;
    VkQueryPool                  queries;        /* one timestamp before the first pass, one after each */
    double                       tick_ms;
    uint64_t                     tick_mask;
    int                          ticked;         /* a recording wrote timestamps */

    uint32_t                     frames;         /* recorded so far */
    uint32_t                     phases;         /* frames mod phases picks the descriptor sets */
    VkDescriptorPool             pool;
    VkDescriptorSetLayout        set_layouts[HBIL_MAX_PASSES];
    VkPipelineLayout             layouts[HBIL_MAX_PASSES];
    VkPipeline                   pipelines[HBIL_MAX_PASSES];
    VkDescriptorSet              sets[HBIL_MAX_PASSES][HBIL_VK__COPIES];

    VkDeviceMemory               memory;
    VkImage                      images[HBIL_MAX_TEXTURES][HBIL_VK__COPIES];
    VkImageView                  views[HBIL_MAX_TEXTURES][HBIL_VK__COPIES];
    int                          runnable;       /* the last resize succeeded */
} hbil_vk;

/* Static text, never NULL. */
HBIL_VK_API const char    *hbil_vk_result_name(hbil_vk_result result);
/* The format of a plan's texture; VK_FORMAT_UNDEFINED for HBIL_FORMAT_ANY. */
HBIL_VK_API VkFormat       hbil_vk_format(hbil_format format);

/* Make everything that does not depend on the size. On failure nothing stays behind but ctx->message. */
HBIL_VK_API hbil_vk_result hbil_vk_init(const hbil_vk_info *info, hbil_vk *ctx);
/* Make our images for the largest render size; take your view of each INPUT and OUTPUT, indexed by plan texture (other entries are not
 * read). The same size again only takes the views and keeps history. Device idle, see Layouts and synchronisation.
 * On failure hbil_vk_record is refused until a resize succeeds. */
HBIL_VK_API hbil_vk_result hbil_vk_resize(hbil_vk *ctx, uint32_t width, uint32_t height,
                                          const VkImageView views[HBIL_MAX_TEXTURES]);
/* Record all passes of one frame. Options made dynamic are read from frame->live. On failure nothing was recorded. */
HBIL_VK_API hbil_vk_result hbil_vk_record(hbil_vk *ctx, VkCommandBuffer cmd, const hbil_frame *frame);
/* Milliseconds of each pass of the last recording, after you waited for it; ms has plan->pass_count entries. Wait before you
 * record again: there is one set of timestamps. */
HBIL_VK_API hbil_vk_result hbil_vk_timings(hbil_vk *ctx, double *ms);
/* Free all that is ours. Fine after a failed init, and twice. Device idle, see Layouts and synchronisation, or lost. */
HBIL_VK_API void           hbil_vk_shutdown(hbil_vk *ctx);

#ifdef __cplusplus
}
#endif
#endif /* HBIL_VK_H */

#ifdef HBIL_VK_IMPLEMENTATION
#ifndef HBIL_VK_IMPLEMENTED
#define HBIL_VK_IMPLEMENTED

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define HBIL_VK__ZEROED(type, name) type name; memset(&name, 0, sizeof name)
#define HBIL_VK__STRUCT(type, name, tag) HBIL_VK__ZEROED(type, name); name.sType = VK_STRUCTURE_TYPE_##tag
/* Call a Vulkan function that can fail; return from here if it does. of: the name of the pass or texture, or NULL. */
#define HBIL_VK__TRY(ctx, of, name, args) do {                                              \
        const VkResult result_ = (ctx)->fn.name args;                                       \
        if (result_ != VK_SUCCESS) return hbil_vk__failed(ctx, "vk" #name, of, result_);    \
    } while (0)
/* The same for one that makes *(out): a call that fails may leave anything there, and shutdown must not destroy that. */
#define HBIL_VK__MAKE(ctx, of, name, out, args) do {                                        \
        const VkResult result_ = (ctx)->fn.name args;                                       \
        if (result_ != VK_SUCCESS) *(out) = VK_NULL_HANDLE;                                 \
        if (result_ != VK_SUCCESS) return hbil_vk__failed(ctx, "vk" #name, of, result_);    \
    } while (0)

#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static hbil_vk_result hbil_vk__fail(hbil_vk *ctx, hbil_vk_result result, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(ctx->message, sizeof ctx->message, format, args);
    va_end(args);
    return result;
}

/* Name of a VkResult and what to do about it. */
static const char *hbil_vk__why(VkResult result)
{
    switch ((int)result) { /* numbers: names that not every header has */
    case VK_ERROR_OUT_OF_HOST_MEMORY:    return "VK_ERROR_OUT_OF_HOST_MEMORY: free some memory and call again";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:  return "VK_ERROR_OUT_OF_DEVICE_MEMORY: render smaller, or free some and call again";
    case VK_ERROR_DEVICE_LOST:           return "VK_ERROR_DEVICE_LOST: shut down, make a new device, and begin anew with it";
    case VK_ERROR_INITIALIZATION_FAILED: return "VK_ERROR_INITIALIZATION_FAILED: the driver gives up: check the SPIR-V with spirv-val, "
                                                "or update the driver";
    case -1000012000:                    return "VK_ERROR_INVALID_SHADER_NV: the driver rejects the SPIR-V: check it with spirv-val, or "
                                                "update the driver";
    case VK_ERROR_TOO_MANY_OBJECTS:      return "VK_ERROR_TOO_MANY_OBJECTS: free allocations or samplers of yours, of which a device has few";
    case VK_ERROR_FORMAT_NOT_SUPPORTED:  return "VK_ERROR_FORMAT_NOT_SUPPORTED: change the options that ask for it";
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case -1000161000: /* VK_ERROR_FRAGMENTATION */ return "the driver's pool is used up: shut down and begin anew";
    default:                             return "see its manual page; the validation layer tells more";
    }
}

static hbil_vk_result hbil_vk__failed(hbil_vk *ctx, const char *call, const char *of, VkResult result)
{
    return hbil_vk__fail(ctx, HBIL_VK_E_VULKAN, "%s%s%s returned VkResult %d: %s", call, of != NULL ? " of " : "",
                         of != NULL ? of : "", (int)result, hbil_vk__why(result));
}

/* ------------------------------------------------------------------------------------------------------------------
 * Checks, all before the first object is made
 * ------------------------------------------------------------------------------------------------------------------ */

static hbil_vk_result hbil_vk__load(hbil_vk *ctx, const hbil_vk_info *info)
{
#define HBIL_VK__LOAD_INSTANCE(name) ctx->fn.name = (PFN_vk##name)info->get_proc(info->instance, "vk" #name);
#define HBIL_VK__LOAD_DEVICE(name) ctx->fn.name = (PFN_vk##name)device_proc(info->device, "vk" #name);
#define HBIL_VK__REQUIRE(name) \
    if (ctx->fn.name == NULL) return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "get_proc finds no vk" #name ": wrong instance or device");
    const PFN_vkGetDeviceProcAddr device_proc =
        (PFN_vkGetDeviceProcAddr)info->get_proc(info->instance, "vkGetDeviceProcAddr");
    if (device_proc == NULL) return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "get_proc finds no vkGetDeviceProcAddr: wrong instance");
    HBIL_VK__INSTANCE_FUNCTIONS(HBIL_VK__LOAD_INSTANCE)
    HBIL_VK__DEVICE_FUNCTIONS(HBIL_VK__LOAD_DEVICE)
    HBIL_VK__OPTIONAL_FUNCTIONS(HBIL_VK__LOAD_INSTANCE) /* null unless the instance extension is on */
    HBIL_VK__INSTANCE_FUNCTIONS(HBIL_VK__REQUIRE)
    HBIL_VK__DEVICE_FUNCTIONS(HBIL_VK__REQUIRE)
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__check_info(hbil_vk *ctx, const hbil_vk_info *info)
{
    if (info->instance == NULL || info->physical_device == NULL || info->device == NULL || info->get_proc == NULL)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "set instance, physical_device, device and get_proc in hbil_vk_info");
    const hbil_plan *plan = info->plan;
    if (plan == NULL || plan->pass_count == 0)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "hbil_vk_info.plan is no built plan: call hbil_plan_build");
    hbil_diag diag;
    hbil_diags diags = { &diag, 1, 0 };
    if (hbil_plan_check(plan, &diags) != HBIL_OK) return hbil_vk__fail(ctx, HBIL_VK_E_PLAN, "%s", diag.text);
    if ((int)plan->config.target != (int)HBIL_TARGET_VULKAN)
        return hbil_vk__fail(ctx, HBIL_VK_E_PLAN, "the plan was made for another target: build it with target=vulkan");
    if (info->input_layout != VK_IMAGE_LAYOUT_UNDEFINED && info->input_layout != VK_IMAGE_LAYOUT_GENERAL &&
        info->input_layout != VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "input_layout is %d: it must be 0, GENERAL or SHADER_READ_ONLY_OPTIMAL",
                             (int)info->input_layout);
    for (uint32_t p = 0; p < plan->pass_count; ++p)
        if (info->spirv[p].words == NULL || info->spirv[p].count < 5 || info->spirv[p].words[0] != 0x07230203)
            return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "spirv[%u] of pass %s holds no SPIR-V words", p, plan->passes[p].name);
    return HBIL_VK_OK;
}

/* Written ones are 2D or 2D_ARRAY; of inputs only the view is used, so any dim is fine. */
static hbil_vk_result hbil_vk__check_texture(hbil_vk *ctx, const hbil_texture *tex, VkPhysicalDevice physical_device)
{
    const VkFormatFeatureFlags need = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
    HBIL_VK__ZEROED(VkFormatProperties, format);
    if (tex->mips != 1 || tex->copies < 1 || tex->copies > HBIL_VK__COPIES)
        return hbil_vk__fail(ctx, HBIL_VK_E_PLAN, "texture %s has %u mips and %u copies: this backend does 1 and 1 or %d",
                             tex->name, tex->mips, tex->copies, HBIL_VK__COPIES);
    if ((tex->dim != HBIL_DIM_2D && tex->dim != HBIL_DIM_2D_ARRAY) || tex->layers < 1 ||
        (tex->dim == HBIL_DIM_2D && tex->layers != 1))
        return hbil_vk__fail(ctx, HBIL_VK_E_PLAN, "texture %s has dim %u and %u layers: only inputs may be other than 2D of one "
                             "layer or 2D_ARRAY", tex->name, tex->dim, tex->layers);
    if (tex->layers > ctx->max_layers)
        return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "texture %s has %u layers, the device allows %u: use fewer slices", tex->name, tex->layers,
                             ctx->max_layers);
    ctx->fn.GetPhysicalDeviceFormatProperties(physical_device, hbil_vk_format((hbil_format)tex->format), &format);
    if ((format.optimalTilingFeatures & need) != need)
        return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "device has no sampled storage images of format %s: change the options "
                             "that ask for texture %s", hbil_format_name((hbil_format)tex->format), tex->name);
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__check_textures(hbil_vk *ctx, VkPhysicalDevice physical_device)
{
    for (uint32_t t = 0; t < ctx->plan.texture_count; ++t) {
        const hbil_texture *tex = &ctx->plan.textures[t];
        if (tex->life == HBIL_LIFE_INPUT) continue; /* any format: what you sample from is yours */
        const hbil_vk_result result = hbil_vk__check_texture(ctx, tex, physical_device);
        if (result != HBIL_VK_OK) return result;
        if (tex->copies > ctx->phases) ctx->phases = tex->copies;
    }
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__check_passes(hbil_vk *ctx, const VkPhysicalDeviceLimits *limits)
{
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p) {
        const hbil_pass *pass = &ctx->plan.passes[p];
        const uint32_t samples = limits->maxPerStageDescriptorSamplers < limits->maxPerStageDescriptorSampledImages
                               ? limits->maxPerStageDescriptorSamplers : limits->maxPerStageDescriptorSampledImages;
        uint32_t writes = 0;
        for (uint32_t b = 0; b < pass->binding_count; ++b) writes += pass->bindings[b].access == HBIL_ACCESS_WRITE;
        if (pass->binding_count - writes > samples)
            return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "pass %s samples %u textures, the device allows %u: use fewer inputs", pass->name,
                                 pass->binding_count - writes, samples);
        if (writes > limits->maxPerStageDescriptorStorageImages)
            return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "pass %s writes %u images, the device allows %u: ask for fewer outputs",
                                 pass->name, writes, limits->maxPerStageDescriptorStorageImages);
        if ((uint32_t)pass->group[0] * pass->group[1] > limits->maxComputeWorkGroupInvocations ||
            pass->group[0] > limits->maxComputeWorkGroupSize[0] || pass->group[1] > limits->maxComputeWorkGroupSize[1])
            return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "pass %s has groups of %ux%u, the device allows %u invocations, %ux%u: use "
                                 "another device", pass->name, pass->group[0], pass->group[1],
                                 limits->maxComputeWorkGroupInvocations, limits->maxComputeWorkGroupSize[0],
                                 limits->maxComputeWorkGroupSize[1]);
    }
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__check_device(hbil_vk *ctx, const hbil_vk_info *info)
{
    enum { FAMILIES = 32 };
    HBIL_VK__ZEROED(VkPhysicalDeviceProperties, device);
    VkQueueFamilyProperties families[FAMILIES];
    uint32_t family_count = 0;
    ctx->fn.GetPhysicalDeviceProperties(info->physical_device, &device);
    ctx->fn.GetPhysicalDeviceMemoryProperties(info->physical_device, &ctx->memory_types);
    ctx->fn.GetPhysicalDeviceQueueFamilyProperties(info->physical_device, &family_count, NULL);
    if (family_count > FAMILIES) family_count = FAMILIES;
    ctx->fn.GetPhysicalDeviceQueueFamilyProperties(info->physical_device, &family_count, families);
    if (device.apiVersion < VK_API_VERSION_1_1)
        return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "device is Vulkan 1.0, SPIR-V 1.3 needs 1.1: use another device or driver");
    if (info->queue_family >= family_count || !(families[info->queue_family].queueFlags & VK_QUEUE_COMPUTE_BIT))
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "queue_family %u of %u has no compute: choose one with VK_QUEUE_COMPUTE_BIT",
                             info->queue_family, family_count);
    const uint32_t bits = families[info->queue_family].timestampValidBits;
    if (info->timestamps && bits == 0)
        return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "queue_family %u has no timestamps: set timestamps to 0", info->queue_family);
    ctx->tick_mask = bits >= 64 ? ~(uint64_t)0 : ((uint64_t)1 << bits) - 1;
    ctx->tick_ms = (double)device.limits.timestampPeriod * 1e-6;
    ctx->max_extent = device.limits.maxImageDimension2D;
    ctx->max_layers = device.limits.maxImageArrayLayers;
    const hbil_vk_result result = hbil_vk__check_passes(ctx, &device.limits);
    return result != HBIL_VK_OK ? result : hbil_vk__check_textures(ctx, info->physical_device);
}

/* ------------------------------------------------------------------------------------------------------------------
 * Objects that do not depend on the size
 * ------------------------------------------------------------------------------------------------------------------ */

/* Every resource has a device-local type among its own; types are sorted, so the first is the best. */
static hbil_vk_result hbil_vk__allocate(hbil_vk *ctx, const char *what, VkDeviceSize size, uint32_t types, VkDeviceMemory *out)
{
    HBIL_VK__STRUCT(VkMemoryAllocateInfo, info, MEMORY_ALLOCATE_INFO);
    info.allocationSize = size;
    for (uint32_t i = 0; i < ctx->memory_types.memoryTypeCount; ++i) {
        const int local = (ctx->memory_types.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) != 0;
        if (!local || !(types >> i & 1)) continue;
        info.memoryTypeIndex = i;
        HBIL_VK__MAKE(ctx, what, AllocateMemory, out, (ctx->device, &info, ctx->allocator, out));
        return HBIL_VK_OK;
    }
    return hbil_vk__fail(ctx, HBIL_VK_E_DEVICE, "no device-local memory type fits all of the plan's images: make them yourself");
}

static hbil_vk_result hbil_vk__make_common(hbil_vk *ctx, int timestamps)
{
    HBIL_VK__STRUCT(VkSamplerCreateInfo, sampler, SAMPLER_CREATE_INFO); /* zero: nearest; ours only texelFetch through it */
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    HBIL_VK__MAKE(ctx, NULL, CreateSampler, &ctx->samplers[0], (ctx->device, &sampler, ctx->allocator, &ctx->samplers[0]));
    sampler.minFilter = sampler.magFilter = VK_FILTER_LINEAR; /* maxLod 0: level 0 */
    HBIL_VK__MAKE(ctx, NULL, CreateSampler, &ctx->samplers[1], (ctx->device, &sampler, ctx->allocator, &ctx->samplers[1]));
    if (timestamps) {
        HBIL_VK__STRUCT(VkQueryPoolCreateInfo, queries, QUERY_POOL_CREATE_INFO);
        queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
        queries.queryCount = ctx->plan.pass_count + 1;
        HBIL_VK__MAKE(ctx, NULL, CreateQueryPool, &ctx->queries, (ctx->device, &queries, ctx->allocator, &ctx->queries));
    }
    if (ctx->plan.constants_size == 0) return HBIL_VK_OK;
    HBIL_VK__STRUCT(VkBufferCreateInfo, buffer, BUFFER_CREATE_INFO);
    buffer.size = ctx->plan.constants_size;
    buffer.usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    HBIL_VK__MAKE(ctx, "the uniform block", CreateBuffer, &ctx->constants, (ctx->device, &buffer, ctx->allocator, &ctx->constants));
    VkMemoryRequirements need;
    ctx->fn.GetBufferMemoryRequirements(ctx->device, ctx->constants, &need);
    const hbil_vk_result result = hbil_vk__allocate(ctx, "the uniform block", need.size, need.memoryTypeBits, &ctx->constants_memory);
    if (result != HBIL_VK_OK) return result;
    HBIL_VK__TRY(ctx, "the uniform block", BindBufferMemory, (ctx->device, ctx->constants, ctx->constants_memory, 0));
    return HBIL_VK_OK;
}

static VkDescriptorType hbil_vk__descriptor_type(const hbil_binding *binding)
{
    return binding->access == HBIL_ACCESS_WRITE ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
}

static hbil_vk_result hbil_vk__make_layouts(hbil_vk *ctx, uint32_t p)
{
    const hbil_pass *pass = &ctx->plan.passes[p];
    VkDescriptorSetLayoutBinding bindings[HBIL_MAX_BINDINGS + 1];
    memset(bindings, 0, sizeof bindings);
    for (uint32_t b = 0; b < pass->binding_count; ++b) {
        bindings[b].binding = pass->bindings[b].slot;
        bindings[b].descriptorType = hbil_vk__descriptor_type(&pass->bindings[b]);
    }
    bindings[pass->binding_count].binding = ctx->plan.constants_slot;
    bindings[pass->binding_count].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;

    HBIL_VK__STRUCT(VkDescriptorSetLayoutCreateInfo, set, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    set.bindingCount = (uint32_t)pass->binding_count + pass->constants;
    set.pBindings = bindings;
    for (uint32_t b = 0; b < set.bindingCount; ++b) {
        bindings[b].descriptorCount = 1;
        bindings[b].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    HBIL_VK__MAKE(ctx, pass->name, CreateDescriptorSetLayout, &ctx->set_layouts[p], (ctx->device, &set, ctx->allocator, &ctx->set_layouts[p]));
    HBIL_VK__STRUCT(VkPipelineLayoutCreateInfo, layout, PIPELINE_LAYOUT_CREATE_INFO);
    const VkDescriptorSetLayout sets[2] = { ctx->set_layouts[p], ctx->hook_layout };
    layout.setLayoutCount = pass->hook && ctx->hook_layout != VK_NULL_HANDLE ? 2 : 1;
    layout.pSetLayouts = sets;
    HBIL_VK__MAKE(ctx, pass->name, CreatePipelineLayout, &ctx->layouts[p], (ctx->device, &layout, ctx->allocator, &ctx->layouts[p]));
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__make_pipeline(hbil_vk *ctx, uint32_t p, const hbil_vk_spirv *spirv, VkPipelineCache cache)
{
    HBIL_VK__STRUCT(VkShaderModuleCreateInfo, module, SHADER_MODULE_CREATE_INFO);
    HBIL_VK__STRUCT(VkComputePipelineCreateInfo, pipeline, COMPUTE_PIPELINE_CREATE_INFO);
    module.codeSize = spirv->count * sizeof *spirv->words;
    module.pCode = spirv->words;
    pipeline.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    pipeline.stage.pName = spirv->entry != NULL ? spirv->entry : "main";
    pipeline.layout = ctx->layouts[p];
    HBIL_VK__TRY(ctx, ctx->plan.passes[p].name, CreateShaderModule, (ctx->device, &module, ctx->allocator, &pipeline.stage.module));
    const VkResult made =
        ctx->fn.CreateComputePipelines(ctx->device, cache, 1, &pipeline, ctx->allocator, &ctx->pipelines[p]);
    ctx->fn.DestroyShaderModule(ctx->device, pipeline.stage.module, ctx->allocator);
    if (made == VK_SUCCESS) return HBIL_VK_OK;
    ctx->pipelines[p] = VK_NULL_HANDLE;
    return hbil_vk__failed(ctx, "vkCreateComputePipelines", ctx->plan.passes[p].name, made);
}

static hbil_vk_result hbil_vk__make_sets(hbil_vk *ctx)
{
    enum { SAMPLED, STORAGE, UNIFORM, TYPES };
    VkDescriptorPoolSize sizes[TYPES] = { { VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1 }, /* 1 to spare: 0 is not legal */
                                          { VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 1 },
                                          { VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1 } };
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p) {
        const hbil_pass *pass = &ctx->plan.passes[p];
        sizes[UNIFORM].descriptorCount += ctx->phases * pass->constants;
        for (uint32_t b = 0; b < pass->binding_count; ++b)
            sizes[pass->bindings[b].access == HBIL_ACCESS_WRITE ? STORAGE : SAMPLED].descriptorCount += ctx->phases;
    }
    HBIL_VK__STRUCT(VkDescriptorPoolCreateInfo, pool, DESCRIPTOR_POOL_CREATE_INFO);
    pool.maxSets = ctx->plan.pass_count * ctx->phases;
    pool.poolSizeCount = TYPES;
    pool.pPoolSizes = sizes;
    HBIL_VK__MAKE(ctx, NULL, CreateDescriptorPool, &ctx->pool, (ctx->device, &pool, ctx->allocator, &ctx->pool));
    HBIL_VK__STRUCT(VkDescriptorSetAllocateInfo, set, DESCRIPTOR_SET_ALLOCATE_INFO);
    set.descriptorPool = ctx->pool;
    set.descriptorSetCount = 1;
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p)
        for (uint32_t phase = 0; phase < ctx->phases; ++phase) {
            set.pSetLayouts = &ctx->set_layouts[p];
            HBIL_VK__TRY(ctx, ctx->plan.passes[p].name, AllocateDescriptorSets, (ctx->device, &set, &ctx->sets[p][phase]));
        }
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__make(hbil_vk *ctx, const hbil_vk_info *info)
{
    hbil_vk_result result = hbil_vk__make_common(ctx, info->timestamps);
    for (uint32_t p = 0; p < ctx->plan.pass_count && result == HBIL_VK_OK; ++p) {
        result = hbil_vk__make_layouts(ctx, p);
        if (result == HBIL_VK_OK) result = hbil_vk__make_pipeline(ctx, p, &info->spirv[p], info->pipeline_cache);
    }
    return result != HBIL_VK_OK ? result : hbil_vk__make_sets(ctx);
}

/* ------------------------------------------------------------------------------------------------------------------
 * Images
 * ------------------------------------------------------------------------------------------------------------------ */

/* Copies of a texture that are ours: none of an INPUT or OUTPUT. */
static uint32_t hbil_vk__copies(const hbil_vk *ctx, uint32_t t)
{
    const hbil_texture *tex = &ctx->plan.textures[t];
    return tex->life == HBIL_LIFE_TRANSIENT || tex->life == HBIL_LIFE_HISTORY ? tex->copies : 0;
}

static VkImageSubresourceRange hbil_vk__whole(void)
{
    const VkImageSubresourceRange whole = { VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS };
    return whole;
}

static hbil_vk_result hbil_vk__make_image(hbil_vk *ctx, uint32_t t, uint32_t width, uint32_t height, VkImage *out)
{
    const hbil_texture *tex = &ctx->plan.textures[t];
    uint32_t extent[2] = { 0, 0 };
    hbil_plan_extent(&ctx->plan, (int32_t)t, width, height, extent);
    HBIL_VK__STRUCT(VkImageCreateInfo, image, IMAGE_CREATE_INFO);
    image.imageType = VK_IMAGE_TYPE_2D;
    image.format = hbil_vk_format((hbil_format)tex->format);
    image.extent.width = extent[0];
    image.extent.height = extent[1];
    image.extent.depth = 1;
    image.mipLevels = 1;
    image.arrayLayers = tex->layers;
    image.samples = VK_SAMPLE_COUNT_1_BIT;
    image.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
    HBIL_VK__MAKE(ctx, tex->name, CreateImage, out, (ctx->device, &image, ctx->allocator, out));
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__make_view(hbil_vk *ctx, uint32_t t, VkImage image, VkImageView *out)
{
    HBIL_VK__STRUCT(VkImageViewCreateInfo, view, IMAGE_VIEW_CREATE_INFO);
    view.image = image;
    view.viewType = ctx->plan.textures[t].dim == HBIL_DIM_2D_ARRAY ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D;
    view.format = hbil_vk_format((hbil_format)ctx->plan.textures[t].format);
    view.subresourceRange = hbil_vk__whole();
    HBIL_VK__MAKE(ctx, ctx->plan.textures[t].name, CreateImageView, out, (ctx->device, &view, ctx->allocator, out));
    return HBIL_VK_OK;
}

/* All images share one allocation. */
static hbil_vk_result hbil_vk__make_images(hbil_vk *ctx, uint32_t width, uint32_t height)
{
    VkDeviceSize offsets[HBIL_MAX_TEXTURES][HBIL_VK__COPIES], size = 0;
    uint32_t types = ~(uint32_t)0;
    hbil_vk_result result = HBIL_VK_OK;
    for (uint32_t t = 0; t < ctx->plan.texture_count; ++t)
        for (uint32_t k = 0; k < hbil_vk__copies(ctx, t); ++k) {
            result = hbil_vk__make_image(ctx, t, width, height, &ctx->images[t][k]);
            if (result != HBIL_VK_OK) return result;
            VkMemoryRequirements need;
            ctx->fn.GetImageMemoryRequirements(ctx->device, ctx->images[t][k], &need);
            offsets[t][k] = (size + need.alignment - 1) / need.alignment * need.alignment;
            size = offsets[t][k] + need.size;
            types &= need.memoryTypeBits;
        }
    if (size > 0) result = hbil_vk__allocate(ctx, "the plan's images", size, types, &ctx->memory);
    for (uint32_t t = 0; t < ctx->plan.texture_count; ++t)
        for (uint32_t k = 0; k < hbil_vk__copies(ctx, t) && result == HBIL_VK_OK; ++k) {
            HBIL_VK__TRY(ctx, ctx->plan.textures[t].name, BindImageMemory, (ctx->device, ctx->images[t][k], ctx->memory, offsets[t][k]));
            result = hbil_vk__make_view(ctx, t, ctx->images[t][k], &ctx->views[t][k]);
        }
    return result;
}

static void hbil_vk__drop_images(hbil_vk *ctx)
{
    for (uint32_t t = 0; t < HBIL_MAX_TEXTURES; ++t)
        for (uint32_t k = 0; k < HBIL_VK__COPIES; ++k) {
            ctx->fn.DestroyImageView(ctx->device, ctx->views[t][k], ctx->allocator);
            ctx->fn.DestroyImage(ctx->device, ctx->images[t][k], ctx->allocator);
        }
    ctx->fn.FreeMemory(ctx->device, ctx->memory, ctx->allocator);
    memset(ctx->views, 0, sizeof ctx->views);
    memset(ctx->images, 0, sizeof ctx->images);
    ctx->memory = VK_NULL_HANDLE;
    ctx->width = ctx->height = 0;
}

static void hbil_vk__drop(hbil_vk *ctx)
{
    hbil_vk__drop_images(ctx);
    for (uint32_t p = 0; p < HBIL_MAX_PASSES; ++p) {
        ctx->fn.DestroyPipeline(ctx->device, ctx->pipelines[p], ctx->allocator);
        ctx->fn.DestroyPipelineLayout(ctx->device, ctx->layouts[p], ctx->allocator);
        ctx->fn.DestroyDescriptorSetLayout(ctx->device, ctx->set_layouts[p], ctx->allocator);
    }
    ctx->fn.DestroyDescriptorPool(ctx->device, ctx->pool, ctx->allocator); /* and its sets */
    ctx->fn.DestroyQueryPool(ctx->device, ctx->queries, ctx->allocator);
    ctx->fn.DestroyBuffer(ctx->device, ctx->constants, ctx->allocator);
    ctx->fn.FreeMemory(ctx->device, ctx->constants_memory, ctx->allocator);
    ctx->fn.DestroySampler(ctx->device, ctx->samplers[0], ctx->allocator);
    ctx->fn.DestroySampler(ctx->device, ctx->samplers[1], ctx->allocator);
}

static int hbil_vk__filtered(const hbil_texture *tex) { return tex->dim == HBIL_DIM_CUBE || tex->dim == HBIL_DIM_3D; }

/* What you told of the size of a view against what the plan wants; those of CUBE and 3D may be of any. */
static hbil_vk_result hbil_vk__check_extent(hbil_vk *ctx, const hbil_texture *tex, const uint32_t need[2], const VkExtent3D *is)
{
    const char *role = tex->life == HBIL_LIFE_INPUT ? "input" : "output";
    if (hbil_vk__filtered(tex) || is->width == 0 || is->height == 0) return HBIL_VK_OK;
    if (is->width < need[0] || is->height < need[1])
        return hbil_vk__fail(ctx, HBIL_VK_E_TEXTURE, "%s %s: your view is %ux%u, the frame needs %ux%u: make it that large, or resize "
                             "to a smaller frame", role, tex->name, is->width, is->height, need[0], need[1]);
    if (tex->dim == HBIL_DIM_2D_ARRAY && is->depth != 0 && is->depth < tex->layers)
        return hbil_vk__fail(ctx, HBIL_VK_E_TEXTURE, "%s %s: your view has %u layers, the plan needs %u: make it with as many", role,
                             tex->name, is->depth, (uint32_t)tex->layers);
    return HBIL_VK_OK;
}

static hbil_vk_result hbil_vk__check_size(hbil_vk *ctx, uint32_t width, uint32_t height,
                                          const VkImageView views[HBIL_MAX_TEXTURES], const VkExtent3D *extents)
{
    const uint32_t baked[2] = { (uint32_t)ctx->plan.config.width, (uint32_t)ctx->plan.config.height };
    if ((baked[0] != 0 && baked[0] != width) || (baked[1] != 0 && baked[1] != height))
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "size %ux%u, but the plan bakes %ux%u: build a plan with width=0 height=0",
                             width, height, baked[0], baked[1]);
    if (width == 0 || height == 0 || width > ctx->max_extent || height > ctx->max_extent)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "size %ux%u: the device has images from 1x1 to %ux%u", width, height,
                             ctx->max_extent, ctx->max_extent);
    for (uint32_t t = 0; t < ctx->plan.texture_count; ++t) {
        const hbil_texture *tex = &ctx->plan.textures[t];
        const int yours = tex->life == HBIL_LIFE_INPUT || tex->life == HBIL_LIFE_OUTPUT;
        uint32_t extent[2];
        if (hbil_plan_extent(&ctx->plan, (int32_t)t, width, height, extent) != HBIL_OK)
            return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "size %ux%u is more than hbil takes, 16384: render smaller", width,
                                 height);
        if (yours && views[t] == VK_NULL_HANDLE)
            return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "views[%u] is null: it must be your view of %s %s", t,
                                 tex->life == HBIL_LIFE_INPUT ? "input" : "output", tex->name);
        const hbil_vk_result result = yours && extents != NULL ? hbil_vk__check_extent(ctx, tex, extent, &extents[t]) : HBIL_VK_OK;
        if (result != HBIL_VK_OK) return result;
    }
    return HBIL_VK_OK;
}

static void hbil_vk__write_set(hbil_vk *ctx, uint32_t p, uint32_t phase, const VkImageView views[HBIL_MAX_TEXTURES])
{
    const hbil_pass *pass = &ctx->plan.passes[p];
    VkDescriptorImageInfo images[HBIL_MAX_BINDINGS];
    VkWriteDescriptorSet writes[HBIL_MAX_BINDINGS + 1];
    const VkDescriptorBufferInfo constants = { ctx->constants, 0, VK_WHOLE_SIZE };
    memset(writes, 0, sizeof writes);
    for (uint32_t b = 0; b < pass->binding_count; ++b) {
        const hbil_binding *binding = &pass->bindings[b];
        const uint32_t t = binding->texture, copies = hbil_vk__copies(ctx, t);
        images[b].sampler = ctx->samplers[hbil_vk__filtered(&ctx->plan.textures[t])];
        images[b].imageView = copies > 0 ? ctx->views[t][(phase % copies + copies - binding->age) % copies] : views[t];
        images[b].imageLayout = ctx->plan.textures[t].life == HBIL_LIFE_INPUT ? ctx->input_layout : VK_IMAGE_LAYOUT_GENERAL;
        writes[b].dstBinding = binding->slot;
        writes[b].descriptorType = hbil_vk__descriptor_type(binding);
        writes[b].pImageInfo = &images[b];
    }
    writes[pass->binding_count].dstBinding = ctx->plan.constants_slot;
    writes[pass->binding_count].descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    writes[pass->binding_count].pBufferInfo = &constants;
    const uint32_t count = (uint32_t)pass->binding_count + pass->constants;
    for (uint32_t b = 0; b < count; ++b) {
        writes[b].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[b].dstSet = ctx->sets[p][phase];
        writes[b].descriptorCount = 1;
    }
    ctx->fn.UpdateDescriptorSets(ctx->device, count, writes, 0, NULL);
}

/* ------------------------------------------------------------------------------------------------------------------
 * Recording
 * ------------------------------------------------------------------------------------------------------------------ */

typedef struct hbil_vk__frame {
    hbil_dispatch grid[HBIL_MAX_PASSES];
    uint32_t      constants[HBIL_CONSTANTS_MAX / 4];
} hbil_vk__frame;

/* All that can fail, so that a failed record has recorded nothing. */
static hbil_vk_result hbil_vk__prepare(hbil_vk *ctx, const hbil_frame *frame, hbil_vk__frame *out)
{
    hbil_diag diag;
    hbil_diags diags = { &diag, 1, 0 };
    const uint32_t width = frame->width != 0 ? frame->width : (uint32_t)ctx->plan.config.width;
    const uint32_t height = frame->height != 0 ? frame->height : (uint32_t)ctx->plan.config.height;
    if (!ctx->runnable)
        return hbil_vk__fail(ctx, HBIL_VK_E_FRAME, "no images: a hbil_vk_resize has to succeed first");
    if (width > ctx->width || height > ctx->height)
        return hbil_vk__fail(ctx, HBIL_VK_E_FRAME, "frame is %ux%u, the images are %ux%u: call hbil_vk_resize", width, height,
                             ctx->width, ctx->height);
    if (ctx->hook_layout != VK_NULL_HANDLE && ctx->hook_set == VK_NULL_HANDLE)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "hook_layout was given, but hbil_vk.hook_set is null: set it before you record");
    hbil_frame now = *frame;
    if (ctx->fresh) now.reset = 1; /* our images hold garbage */
    hbil_result result = hbil_pack_constants(&ctx->plan, &now, out->constants, sizeof out->constants, NULL, &diags);
    if (result == HBIL_OK) result = hbil_plan_frame(&ctx->plan, frame, out->grid);
    if (ctx->block != NULL) memcpy(out->constants, ctx->block, ctx->plan.constants_size);
    if (result == HBIL_OK) return HBIL_VK_OK;
    return hbil_vk__fail(ctx, HBIL_VK_E_FRAME, "%s", diags.count > 0 ? diag.text : hbil_result_name(result));
}

static void hbil_vk__memory_barrier(hbil_vk *ctx, VkCommandBuffer cmd, VkPipelineStageFlags from, VkAccessFlags written,
                                    VkPipelineStageFlags to, VkAccessFlags access)
{
    HBIL_VK__STRUCT(VkMemoryBarrier, barrier, MEMORY_BARRIER);
    barrier.srcAccessMask = written;
    barrier.dstAccessMask = access;
    ctx->fn.CmdPipelineBarrier(cmd, from, to, 0, 1, &barrier, 0, NULL, 0, NULL);
}

static void hbil_vk__set_up_image(hbil_vk *ctx, VkCommandBuffer cmd, VkImage image)
{
    HBIL_VK__STRUCT(VkImageMemoryBarrier, barrier, IMAGE_MEMORY_BARRIER);
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = hbil_vk__whole();
    /* behind the shaders of a frame before, which is there where you have set fresh */
    ctx->fn.CmdPipelineBarrier(cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL, 0, NULL,
                               1, &barrier);
}

/* New images to GENERAL. */
static void hbil_vk__set_up_images(hbil_vk *ctx, VkCommandBuffer cmd)
{
    for (uint32_t t = 0; t < ctx->plan.texture_count; ++t)
        for (uint32_t k = 0; k < hbil_vk__copies(ctx, t); ++k) hbil_vk__set_up_image(ctx, cmd, ctx->images[t][k]);
    ctx->fresh = 0;
}

/* One copy of the uniform block is enough for any number of frames in flight: it is written on the device's own time line,
 * after the last frame's passes have read it and before this frame's do. */
static void hbil_vk__write_constants(hbil_vk *ctx, VkCommandBuffer cmd, const hbil_vk__frame *frame)
{
    hbil_vk__memory_barrier(ctx, cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                            VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
    ctx->fn.CmdUpdateBuffer(cmd, ctx->constants, 0, ctx->plan.constants_size, frame->constants);
    hbil_vk__memory_barrier(ctx, cmd, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                            VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_UNIFORM_READ_BIT);
}

static void hbil_vk__start_clock(hbil_vk *ctx, VkCommandBuffer cmd)
{
    ctx->fn.CmdResetQueryPool(cmd, ctx->queries, 0, ctx->plan.pass_count + 1);
    ctx->fn.CmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, ctx->queries, 0);
    ctx->ticked = 1;
}

/* The plan's barriers of a pass as one memory barrier: images stay in GENERAL, and drivers flush caches whole. */
static void hbil_vk__pass_barrier(hbil_vk *ctx, VkCommandBuffer cmd, const hbil_pass *pass)
{
    VkAccessFlags written = 0, access = 0;
    for (uint32_t i = 0; i < pass->barrier_count; ++i) {
        if (pass->barriers[i].before & HBIL_ACCESS_WRITE) written |= VK_ACCESS_SHADER_WRITE_BIT;
        if (pass->barriers[i].after & HBIL_ACCESS_WRITE) access |= VK_ACCESS_SHADER_WRITE_BIT;
        for (uint32_t b = 0; b < pass->binding_count; ++b) /* it may read what others wrote */
            if (pass->bindings[b].texture == pass->barriers[i].texture && pass->bindings[b].role == HBIL_ROLE_UPDATE)
                access |= VK_ACCESS_SHADER_READ_BIT;
        if (pass->barriers[i].after & HBIL_ACCESS_SAMPLE) access |= VK_ACCESS_SHADER_READ_BIT;
    }
    if (pass->barrier_count > 0)
        hbil_vk__memory_barrier(ctx, cmd, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, written, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                                access);
}

static void hbil_vk__pass(hbil_vk *ctx, VkCommandBuffer cmd, uint32_t p, uint32_t phase, const uint32_t groups[3])
{
    const hbil_pass *pass = &ctx->plan.passes[p];
    const int labels = ctx->fn.CmdBeginDebugUtilsLabelEXT != NULL && ctx->fn.CmdEndDebugUtilsLabelEXT != NULL;
    HBIL_VK__STRUCT(VkDebugUtilsLabelEXT, label, DEBUG_UTILS_LABEL_EXT);
    label.pLabelName = pass->name;
    if (labels) ctx->fn.CmdBeginDebugUtilsLabelEXT(cmd, &label);
    hbil_vk__pass_barrier(ctx, cmd, pass);
    ctx->fn.CmdBindPipeline(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, ctx->pipelines[p]);
    const VkDescriptorSet sets[2] = { ctx->sets[p][phase], ctx->hook_set };
    ctx->fn.CmdBindDescriptorSets(cmd, VK_PIPELINE_BIND_POINT_COMPUTE, ctx->layouts[p], 0,
                                  pass->hook && ctx->hook_layout != VK_NULL_HANDLE ? 2 : 1, sets, 0, NULL);
    ctx->fn.CmdDispatch(cmd, groups[0], groups[1], groups[2]);
    if (ctx->queries != VK_NULL_HANDLE)
        ctx->fn.CmdWriteTimestamp(cmd, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, ctx->queries, p + 1);
    if (labels) ctx->fn.CmdEndDebugUtilsLabelEXT(cmd);
}

/* ------------------------------------------------------------------------------------------------------------------
 * Public
 * ------------------------------------------------------------------------------------------------------------------ */

const char *hbil_vk_result_name(hbil_vk_result result)
{
#define HBIL_VK__RESULT_TEXT(name, text) text,
    static const char *const names[] = { HBIL_VK_RESULTS(HBIL_VK__RESULT_TEXT) };
    return (unsigned)result < HBIL_VK_RESULT_COUNT ? names[result] : "unknown";
}

VkFormat hbil_vk_format(hbil_format format)
{
    switch (format) { /* no default: the compiler names a format that is missing here */
    case HBIL_FORMAT_R32F:    return VK_FORMAT_R32_SFLOAT;
    case HBIL_FORMAT_R32UI:   return VK_FORMAT_R32_UINT;
    case HBIL_FORMAT_RGBA32F: return VK_FORMAT_R32G32B32A32_SFLOAT;
    case HBIL_FORMAT_RGBA16F: return VK_FORMAT_R16G16B16A16_SFLOAT;
    case HBIL_FORMAT_ANY:
    case HBIL_FORMAT_COUNT:   break;
    }
    return VK_FORMAT_UNDEFINED;
}

hbil_vk_result hbil_vk_init(const hbil_vk_info *info, hbil_vk *ctx)
{
    if (ctx == NULL) return HBIL_VK_E_ARG;
    memset(ctx, 0, sizeof *ctx);
    if (info == NULL) return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "info is null");
    hbil_vk_result result = hbil_vk__check_info(ctx, info);
    if (result != HBIL_VK_OK) return result;
    ctx->plan = *info->plan;
    ctx->phases = 1;
    ctx->allocator = info->allocator;
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p)
        if (ctx->plan.passes[p].hook) ctx->hook_layout = info->hook_layout;
    ctx->input_layout = info->input_layout != VK_IMAGE_LAYOUT_UNDEFINED ? info->input_layout : VK_IMAGE_LAYOUT_GENERAL;
    result = hbil_vk__load(ctx, info);
    if (result == HBIL_VK_OK) result = hbil_vk__check_device(ctx, info);
    if (result == HBIL_VK_OK) {
        ctx->device = info->device;
        result = hbil_vk__make(ctx, info);
    }
    if (result != HBIL_VK_OK) hbil_vk_shutdown(ctx);
    return result;
}

hbil_vk_result hbil_vk_resize(hbil_vk *ctx, uint32_t width, uint32_t height, const VkImageView views[HBIL_MAX_TEXTURES])
{
    if (ctx == NULL) return HBIL_VK_E_ARG;
    const VkExtent3D *extents = ctx->extents;
    ctx->extents = NULL;
    ctx->runnable = 0;
    if (ctx->device == NULL || views == NULL) return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "call hbil_vk_init first; pass views");
    hbil_vk_result result = hbil_vk__check_size(ctx, width, height, views, extents);
    if (result != HBIL_VK_OK) return result;
    if (width != ctx->width || height != ctx->height) {
        hbil_vk__drop_images(ctx);
        result = hbil_vk__make_images(ctx, width, height);
        if (result != HBIL_VK_OK) {
            hbil_vk__drop_images(ctx);
            return result;
        }
        ctx->width = width;
        ctx->height = height;
        ctx->fresh = 1;
    }
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p)
        for (uint32_t phase = 0; phase < ctx->phases; ++phase) hbil_vk__write_set(ctx, p, phase, views);
    ctx->runnable = 1;
    return HBIL_VK_OK;
}

hbil_vk_result hbil_vk_record(hbil_vk *ctx, VkCommandBuffer cmd, const hbil_frame *frame)
{
    hbil_vk__frame prepared;
    if (ctx == NULL) return HBIL_VK_E_ARG;
    if (ctx->device == NULL || cmd == NULL || frame == NULL)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "call hbil_vk_init first; pass a command buffer and a frame");
    const hbil_vk_result result = hbil_vk__prepare(ctx, frame, &prepared);
    if (result != HBIL_VK_OK) return result;
    if (ctx->fresh) hbil_vk__set_up_images(ctx, cmd);
    if (ctx->constants != VK_NULL_HANDLE) hbil_vk__write_constants(ctx, cmd, &prepared);
    if (ctx->queries != VK_NULL_HANDLE) hbil_vk__start_clock(ctx, cmd);
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p)
        hbil_vk__pass(ctx, cmd, p, ctx->frames % ctx->phases, prepared.grid[p].groups);
    ++ctx->frames;
    return HBIL_VK_OK;
}

hbil_vk_result hbil_vk_timings(hbil_vk *ctx, double *ms)
{
    uint64_t ticks[HBIL_MAX_PASSES + 1];
    if (ctx == NULL) return HBIL_VK_E_ARG;
    if (ctx->queries == VK_NULL_HANDLE || ms == NULL)
        return hbil_vk__fail(ctx, HBIL_VK_E_ARG, "set timestamps in hbil_vk_info; pass ms");
    const uint32_t count = ctx->plan.pass_count + 1;
    const VkResult got = !ctx->ticked ? VK_NOT_READY : ctx->fn.GetQueryPoolResults(ctx->device, ctx->queries, 0, count,
        count * sizeof *ticks, ticks, sizeof *ticks, VK_QUERY_RESULT_64_BIT);
    if (got == VK_NOT_READY)
        return hbil_vk__fail(ctx, HBIL_VK_E_NOT_READY, "no timestamps yet: record, submit and wait for the fence first");
    if (got != VK_SUCCESS) return hbil_vk__failed(ctx, "vkGetQueryPoolResults", NULL, got);
    for (uint32_t p = 0; p < ctx->plan.pass_count; ++p)
        ms[p] = (double)((ticks[p + 1] - ticks[p]) & ctx->tick_mask) * ctx->tick_ms;
    return HBIL_VK_OK;
}

void hbil_vk_shutdown(hbil_vk *ctx)
{
    if (ctx == NULL) return;
    if (ctx->device != NULL) hbil_vk__drop(ctx);
    char message[sizeof ctx->message];
    memcpy(message, ctx->message, sizeof message); /* a failed init shuts down, and its reason must survive */
    memset(ctx, 0, sizeof *ctx);
    memcpy(ctx->message, message, sizeof message);
}

#endif /* HBIL_VK_IMPLEMENTED */
#endif /* HBIL_VK_IMPLEMENTATION */
