/* fuzz_vk.c - damaged plans on hbil_vk.h, over a Vulkan whose every object is a byte of the heap and whose calls may fail:
 * what is freed twice, kept or read beyond its end, AddressSanitizer sees. */
#include "damage.h"
#include "../test.h"

#include <vulkan/vulkan.h>

#define HBIL_VK_IMPLEMENTATION
#include "../../backends/hbil_vk.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif

static const char *const configs[] = { "outputs=ao", "", "march=sweep slices=4", "temporal=yes bounces=recursive reproject=scatter downscale=2",
                                       "environment=probes outputs=irradiance", "outputs=far environment=hook" };
static uint32_t fail_at, calls;    /* the call that fails; 0: none */
static volatile uint32_t seen;     /* of all that is read */

static VkResult answer(void) { return ++calls == fail_at ? VK_ERROR_OUT_OF_DEVICE_MEMORY : VK_SUCCESS; }

#define HANDLE(type) ((type)(uintptr_t)malloc(1))
#define MAKE(name, type, info)                                                                                              \
    static VKAPI_ATTR VkResult VKAPI_CALL name(VkDevice d, const info *i, const VkAllocationCallbacks *a, type *out)         \
    { const VkResult r = answer(); if (r == VK_SUCCESS) *out = HANDLE(type); seen += (uint32_t)i->sType; return r; }
#define DROP(name, type)                                                                                                    \
    static VKAPI_ATTR void VKAPI_CALL name(VkDevice d, type x, const VkAllocationCallbacks *a) { free((void *)(uintptr_t)x); }

MAKE(CreateImage, VkImage, VkImageCreateInfo)
DROP(DestroyImage, VkImage)
MAKE(CreateImageView, VkImageView, VkImageViewCreateInfo)
DROP(DestroyImageView, VkImageView)
MAKE(AllocateMemory, VkDeviceMemory, VkMemoryAllocateInfo)
DROP(FreeMemory, VkDeviceMemory)
MAKE(CreateBuffer, VkBuffer, VkBufferCreateInfo)
DROP(DestroyBuffer, VkBuffer)
MAKE(CreateSampler, VkSampler, VkSamplerCreateInfo)
DROP(DestroySampler, VkSampler)
DROP(DestroyDescriptorSetLayout, VkDescriptorSetLayout)
MAKE(CreateDescriptorPool, VkDescriptorPool, VkDescriptorPoolCreateInfo)
DROP(DestroyDescriptorPool, VkDescriptorPool)
MAKE(CreateShaderModule, VkShaderModule, VkShaderModuleCreateInfo)
DROP(DestroyShaderModule, VkShaderModule)
MAKE(CreatePipelineLayout, VkPipelineLayout, VkPipelineLayoutCreateInfo)
DROP(DestroyPipelineLayout, VkPipelineLayout)
DROP(DestroyPipeline, VkPipeline)
MAKE(CreateQueryPool, VkQueryPool, VkQueryPoolCreateInfo)
DROP(DestroyQueryPool, VkQueryPool)

static VKAPI_ATTR VkResult VKAPI_CALL CreateDescriptorSetLayout(VkDevice d, const VkDescriptorSetLayoutCreateInfo *i,
                                                                const VkAllocationCallbacks *a, VkDescriptorSetLayout *out)
{
    const VkResult r = answer();
    uint32_t k, m;
    for (k = 0; k < i->bindingCount; ++k) {
        FUZZ_REQUIRE(i->pBindings[k].descriptorCount == 1);
        for (m = 0; m < k; ++m) FUZZ_REQUIRE(i->pBindings[k].binding != i->pBindings[m].binding); /* or the driver may do anything */
    }
    if (r == VK_SUCCESS) *out = HANDLE(VkDescriptorSetLayout);
    return r;
}

static VKAPI_ATTR VkResult VKAPI_CALL CreateComputePipelines(VkDevice d, VkPipelineCache c, uint32_t n, const VkComputePipelineCreateInfo *i,
                                                             const VkAllocationCallbacks *a, VkPipeline *out)
{
    const VkResult r = answer();
    FUZZ_REQUIRE(n == 1 && i->layout != VK_NULL_HANDLE && i->stage.module != VK_NULL_HANDLE);
    *out = r == VK_SUCCESS ? HANDLE(VkPipeline) : VK_NULL_HANDLE;
    return r;
}

static VKAPI_ATTR VkResult VKAPI_CALL AllocateDescriptorSets(VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *out)
{
    const VkResult r = answer();
    if (r == VK_SUCCESS) *out = (VkDescriptorSet)(uintptr_t)i->pSetLayouts[0]; /* freed with their pool: nothing to own */
    return r;
}

static VKAPI_ATTR void VKAPI_CALL UpdateDescriptorSets(VkDevice d, uint32_t n, const VkWriteDescriptorSet *w, uint32_t copies,
                                                       const VkCopyDescriptorSet *c)
{
    uint32_t i;
    for (i = 0; i < n; ++i) {
        FUZZ_REQUIRE(w[i].dstSet != VK_NULL_HANDLE && w[i].descriptorCount == 1);
        if (w[i].descriptorType == VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER) FUZZ_REQUIRE(w[i].pBufferInfo->buffer != VK_NULL_HANDLE);
        else FUZZ_REQUIRE(w[i].pImageInfo->imageView != VK_NULL_HANDLE);
    }
}

#define NEED(name, type)                                                                                                    \
    static VKAPI_ATTR void VKAPI_CALL name(VkDevice d, type x, VkMemoryRequirements *out)                                    \
    { FUZZ_REQUIRE(x != VK_NULL_HANDLE); out->size = 4096; out->alignment = 256; out->memoryTypeBits = 1; }
NEED(GetImageMemoryRequirements, VkImage)
NEED(GetBufferMemoryRequirements, VkBuffer)
static VKAPI_ATTR VkResult VKAPI_CALL BindImageMemory(VkDevice d, VkImage i, VkDeviceMemory m, VkDeviceSize at) { return answer(); }
static VKAPI_ATTR VkResult VKAPI_CALL BindBufferMemory(VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize at) { return answer(); }

static VKAPI_ATTR VkResult VKAPI_CALL GetQueryPoolResults(VkDevice d, VkQueryPool q, uint32_t first, uint32_t n, size_t size, void *data,
                                                          VkDeviceSize stride, VkQueryResultFlags f)
{
    memset(data, 0, size);
    return answer();
}

static VKAPI_ATTR void VKAPI_CALL CmdPipelineBarrier(VkCommandBuffer c, VkPipelineStageFlags from, VkPipelineStageFlags to,
    VkDependencyFlags f, uint32_t n, const VkMemoryBarrier *m, uint32_t bn, const VkBufferMemoryBarrier *b, uint32_t in,
    const VkImageMemoryBarrier *i)
{
    FUZZ_REQUIRE(n + in == 1 && (in == 0 || i->image != VK_NULL_HANDLE));
}
static VKAPI_ATTR void VKAPI_CALL CmdUpdateBuffer(VkCommandBuffer c, VkBuffer b, VkDeviceSize at, VkDeviceSize size, const void *data)
{
    const unsigned char *byte = (const unsigned char *)data;
    FUZZ_REQUIRE(b != VK_NULL_HANDLE && size > 0 && size % 4 == 0 && size <= 65536);
    while (size--) seen += byte[size];
}
static VKAPI_ATTR void VKAPI_CALL CmdResetQueryPool(VkCommandBuffer c, VkQueryPool q, uint32_t first, uint32_t n) { seen += n; }
static VKAPI_ATTR void VKAPI_CALL CmdWriteTimestamp(VkCommandBuffer c, VkPipelineStageFlagBits s, VkQueryPool q, uint32_t n)
{
    FUZZ_REQUIRE(n <= HBIL_MAX_PASSES);
}
static VKAPI_ATTR void VKAPI_CALL CmdBindPipeline(VkCommandBuffer c, VkPipelineBindPoint b, VkPipeline p) { FUZZ_REQUIRE(p != VK_NULL_HANDLE); }
static VKAPI_ATTR void VKAPI_CALL CmdBindDescriptorSets(VkCommandBuffer c, VkPipelineBindPoint b, VkPipelineLayout l, uint32_t first,
    uint32_t n, const VkDescriptorSet *sets, uint32_t offsets, const uint32_t *o)
{
    while (n--) FUZZ_REQUIRE(sets[n] != VK_NULL_HANDLE);
}
static VKAPI_ATTR void VKAPI_CALL CmdDispatch(VkCommandBuffer c, uint32_t x, uint32_t y, uint32_t z)
{
    FUZZ_REQUIRE(x > 0 && y > 0 && z > 0 && x <= 65535 && y <= 65535 && z <= 65535);
}

static VKAPI_ATTR void VKAPI_CALL GetPhysicalDeviceProperties(VkPhysicalDevice p, VkPhysicalDeviceProperties *out)
{
    out->apiVersion = VK_API_VERSION_1_1;
    out->limits.maxImageDimension2D = 16384;
    out->limits.maxImageArrayLayers = 2048;
    out->limits.maxPerStageDescriptorStorageImages = 16;
    out->limits.maxComputeWorkGroupInvocations = 1024;
}
static VKAPI_ATTR void VKAPI_CALL GetPhysicalDeviceQueueFamilyProperties(VkPhysicalDevice p, uint32_t *n, VkQueueFamilyProperties *out)
{
    memset(out, 0, sizeof *out);
    out->queueFlags = VK_QUEUE_COMPUTE_BIT;
    out->timestampValidBits = 64;
    *n = 1;
}
static VKAPI_ATTR void VKAPI_CALL GetPhysicalDeviceMemoryProperties(VkPhysicalDevice p, VkPhysicalDeviceMemoryProperties *out)
{
    memset(out, 0, sizeof *out);
    out->memoryTypeCount = 1;
    out->memoryTypes[0].propertyFlags = VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
}
static VKAPI_ATTR void VKAPI_CALL GetPhysicalDeviceFormatProperties(VkPhysicalDevice p, VkFormat f, VkFormatProperties *out)
{
    out->optimalTilingFeatures = f == VK_FORMAT_UNDEFINED ? 0 : VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT;
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_device_proc(VkDevice d, const char *name)
{
#define ROW(function) if (strcmp(name, "vk" #function) == 0) return (PFN_vkVoidFunction)function;
    HBIL_VK__DEVICE_FUNCTIONS(ROW)
    return NULL;
}
static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL get_proc(VkInstance i, const char *name)
{
    HBIL_VK__INSTANCE_FUNCTIONS(ROW)
    return strcmp(name, "vkGetDeviceProcAddr") == 0 ? (PFN_vkVoidFunction)get_device_proc : NULL;
}

static void check(hbil_vk *ctx, hbil_vk_result result)
{
    FUZZ_REQUIRE(result == HBIL_VK_OK || (ctx->message[0] && memchr(ctx->message, 0, sizeof ctx->message)));
}

static void run(const hbil_plan *plan, const hbil_vk_info *info, uint32_t choice)
{
    static hbil_vk ctx;
    VkImageView views[HBIL_MAX_TEXTURES];
    hbil_frame frame;
    hbil_vk_result result = hbil_vk_init(info, &ctx);
    double ms[HBIL_MAX_PASSES];
    uint32_t i;
    check(&ctx, result);
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) views[i] = (VkImageView)(uintptr_t)&seen;
    if (result == HBIL_VK_OK) {
        FUZZ_REQUIRE(hbil_plan_check(plan, NULL) == HBIL_OK);
        result = hbil_vk_resize(&ctx, choice & 1 ? 64 : 16384, 36, views);
        check(&ctx, result);
    }
    frame = test_frame(&plan->config, 64, 36);
    for (i = 0; result == HBIL_VK_OK && i < 3; ++i) {
        result = hbil_vk_record(&ctx, (VkCommandBuffer)(uintptr_t)&seen, &frame);
        check(&ctx, result);
        if (result == HBIL_VK_OK && info->timestamps) check(&ctx, hbil_vk_timings(&ctx, ms));
        if (i == 1 && result == HBIL_VK_OK) check(&ctx, hbil_vk_resize(&ctx, 65, 37, views));
    }
    hbil_vk_shutdown(&ctx);
    hbil_vk_shutdown(&ctx);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const uint32_t words[5] = { 0x07230203 };
    static hbil_plan plan;
    static hbil_vk_info info;
    fuzz_reader r = { data, size };
    uint32_t i;
    fail_at = fuzz_take(&r, 1);
    calls = 0;
    damaged_plan(&r, configs, sizeof configs / sizeof *configs, &plan);
    memset(&info, 0, sizeof info);
    info.instance = (VkInstance)(uintptr_t)&seen;
    info.physical_device = (VkPhysicalDevice)(uintptr_t)&seen;
    info.device = (VkDevice)(uintptr_t)&seen;
    info.get_proc = get_proc;
    info.plan = &plan;
    info.timestamps = size & 1;
    for (i = 0; i < HBIL_MAX_PASSES; ++i) info.spirv[i].words = words, info.spirv[i].count = 5;
    run(&plan, &info, (uint32_t)size / 2);
    return 0;
}
