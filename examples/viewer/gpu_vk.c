/* gpu_vk.c - the viewer on Vulkan 1.3: sun's shadow map, G-buffer, the plan through backends/hbil_vk.h, tone mapping.
 *
 * One frame at a time: each waits for the queue, which keeps this short and lets every frame be measured. What concerns hbil.h is in
 * vk_plan (text to SPIR-V to pipelines), hand_over (its inputs and outputs) and record (where it stands in the frame).
 * The implementations of hbil_vk.h, hbil_glslang.h and volk are in examples/frame/runner_vk.c, which this program links. */
#include <volk.h>
#include <GLFW/glfw3.h>
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "../../hbil.h"
#include "../../backends/hbil_vk.h"
#include "../../backends/hbil_glslang.h"
#include "gpu.h"
#include "viewer_shaders.h"

#define FAIL(g, ...) (snprintf((g)->setup.error, (g)->setup.error_size, __VA_ARGS__), 0)
#define ZEROED(type, name) type name; memset(&name, 0, sizeof name)
#define STRUCT(type, name, tag) ZEROED(type, name); name.sType = VK_STRUCTURE_TYPE_##tag
#define TRY(g, call, args) do {                                                                             \
        const VkResult result_ = call args;                                                                 \
        if (result_ != VK_SUCCESS) return FAIL(g, #call " returned VkResult %d", (int)result_);             \
    } while (0)

enum { SWAP_MAX = 16, BINDINGS = 6, TIMES_OWN = 4 };
enum { DRAW_SHADOW, DRAW_MODEL, DRAW_SKY, DRAW_SCREEN, DRAW_TEXT, DRAWS };

static const VkFormat target_formats[TARGETS] = {
    VK_FORMAT_D32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT,
    VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM
};
static const VkFormat picture_format = VK_FORMAT_R8G8B8A8_UNORM; /* screen.frag encodes sRGB itself */

typedef struct vk_image {
    VkImage        image;
    VkDeviceMemory memory;
    VkImageView    view;
} vk_image;

typedef struct vk_buffer {
    VkBuffer       buffer;
    VkDeviceMemory memory;
    void          *mapped;               /* NULL: on the device alone */
} vk_buffer;

typedef struct vk {
    gpu_setup                        setup;
    VkInstance                       instance;
    VkDebugUtilsMessengerEXT         messenger;
    VkSurfaceKHR                     surface;
    VkPhysicalDevice                 gpu;
    VkPhysicalDeviceMemoryProperties memory_types;
    VkDevice                         device;
    uint32_t                         family;
    VkQueue                          queue;
    VkCommandPool                    commands;
    VkCommandBuffer                  cmd;
    VkQueryPool                      queries;  /* start, after shadow, after G-buffer, before and after the screen */
    double                           tick_ms;

    VkSwapchainKHR                   swapchain;
    VkFormat                         swap_format;
    VkExtent2D                       swap_size;
    VkImage                          swap_images[SWAP_MAX];
    VkSemaphore                      acquired, rendered[SWAP_MAX];

    VkSampler                        sampler;
    VkDescriptorSetLayout            set_layout;
    VkPipelineLayout                 layout;
    VkDescriptorPool                 pool;
    VkDescriptorSet                  set;
    VkPipeline                       draws[DRAWS];
    vk_buffer                        uniforms, vertices, text, staging;
    uint32_t                         vertex_count;

    uint32_t                         width, height;  /* 0 before the first resize */
    vk_image                         shadow, targets[TARGETS], picture;
    VkImageView                      roughness;
    vk_image                         outputs[HBIL_MAX_TEXTURES];
    hbil_vk                          light;          /* zeroed while there is none */
    int                              compiler, messages;
} vk;

/* ---- instance and device ----------------------------------------------------------------------------------------- */

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity, (void)types;
    ((vk *)user)->messages++;
    fprintf(stderr, "vulkan: %s\n", data->pMessage);
    return VK_FALSE;
}

static int make_instance(vk *g)
{
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
    static const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    const char *extensions[8];
    uint32_t    count = 0, wanted = 0, i;
    const char *const *by_window = g->setup.window ? glfwGetRequiredInstanceExtensions(&wanted) : NULL;
    STRUCT(VkApplicationInfo, application, APPLICATION_INFO);
    STRUCT(VkInstanceCreateInfo, info, INSTANCE_CREATE_INFO);
    STRUCT(VkValidationFeaturesEXT, features, VALIDATION_FEATURES_EXT);
    STRUCT(VkDebugUtilsMessengerCreateInfoEXT, messenger, DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);

    if (volkInitialize() != VK_SUCCESS) return FAIL(g, "no Vulkan loader: apt-get install libvulkan1, or try --gl");
    if (g->setup.window && !by_window) return FAIL(g, "this display has no Vulkan surfaces: try --gl, or --headless");
    for (i = 0; i < wanted && count < 6; i++) extensions[count++] = by_window[i];
    application.apiVersion = VK_API_VERSION_1_3;
    info.pApplicationInfo = &application;
    if (g->setup.validate) {
        extensions[count++] = VK_EXT_DEBUG_UTILS_EXTENSION_NAME;
        extensions[count++] = VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME;
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.pNext = &features;
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = enables;
        features.pNext = &messenger; /* for messages of vkCreateInstance and vkDestroyInstance */
        messenger.messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        messenger.messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        messenger.pfnUserCallback = on_message;
        messenger.pUserData = g;
    }
    info.enabledExtensionCount = count;
    info.ppEnabledExtensionNames = extensions;
    const VkResult result = vkCreateInstance(&info, NULL, &g->instance);
    if (result == VK_ERROR_LAYER_NOT_PRESENT) return FAIL(g, "no validation layer: apt-get install vulkan-validationlayers");
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return FAIL(g, "no Vulkan driver: apt-get install mesa-vulkan-drivers, or --gl");
    if (result != VK_SUCCESS) return FAIL(g, "vkCreateInstance returned VkResult %d", (int)result);
    volkLoadInstance(g->instance);
    if (g->setup.validate) TRY(g, vkCreateDebugUtilsMessengerEXT, (g->instance, &messenger, NULL, &g->messenger));
    if (g->setup.window) TRY(g, glfwCreateWindowSurface, (g->instance, g->setup.window, NULL, &g->surface));
    return 1;
}

/* A queue that draws, computes, measures and, with a window, presents. */
static int find_family(vk *g, VkPhysicalDevice gpu)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = sizeof families / sizeof *families, i;

    vkGetPhysicalDeviceQueueFamilyProperties(gpu, &count, families);
    for (i = 0; i < count; i++) {
        VkBool32 presents = VK_TRUE;
        if (g->surface) vkGetPhysicalDeviceSurfaceSupportKHR(gpu, i, g->surface, &presents);
        if (!presents || !families[i].timestampValidBits || !(families[i].queueFlags & VK_QUEUE_GRAPHICS_BIT) ||
            !(families[i].queueFlags & VK_QUEUE_COMPUTE_BIT)) continue;
        g->family = i;
        return 1;
    }
    return 0;
}

/* A discrete GPU before an integrated one before the rest; HBIL_DEVICE=<part of a name> decides otherwise. */
static int pick_device(vk *g, char device[128])
{
    const char *wanted = getenv("HBIL_DEVICE");
    VkPhysicalDevice gpus[16];
    uint32_t count = sizeof gpus / sizeof *gpus, i;
    int best = 0;

    if (vkEnumeratePhysicalDevices(g->instance, &count, gpus) < 0) count = 0;
    for (i = 0; i < count; i++) {
        VkPhysicalDeviceProperties p;
        vkGetPhysicalDeviceProperties(gpus[i], &p);
        const int rank = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU ? 3 :
                         p.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? 2 : 1;
        if (p.apiVersion < VK_API_VERSION_1_3 || rank <= best || !find_family(g, gpus[i])) continue;
        if (wanted && !strstr(p.deviceName, wanted)) continue;
        best = rank;
        g->gpu = gpus[i];
        g->tick_ms = (double)p.limits.timestampPeriod * 1e-6;
        snprintf(device, 128, "%.127s", p.deviceName);
    }
    if (!best) return FAIL(g, "no device with Vulkan 1.3, graphics, compute and timestamps%s%s: apt-get install "
                           "mesa-vulkan-drivers, or try --gl", wanted ? " by HBIL_DEVICE=" : "", wanted ? wanted : "");
    vkGetPhysicalDeviceMemoryProperties(g->gpu, &g->memory_types);
    return find_family(g, g->gpu);
}

static int make_device(vk *g)
{
    static const char *const extensions[] = {VK_KHR_SWAPCHAIN_EXTENSION_NAME};
    const float priority = 1.0f;
    STRUCT(VkDeviceQueueCreateInfo, queue, DEVICE_QUEUE_CREATE_INFO);
    STRUCT(VkPhysicalDeviceVulkan13Features, features, PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    STRUCT(VkDeviceCreateInfo, device, DEVICE_CREATE_INFO);
    STRUCT(VkCommandPoolCreateInfo, pool, COMMAND_POOL_CREATE_INFO);
    STRUCT(VkCommandBufferAllocateInfo, cmd, COMMAND_BUFFER_ALLOCATE_INFO);
    STRUCT(VkQueryPoolCreateInfo, queries, QUERY_POOL_CREATE_INFO);

    queue.queueFamilyIndex = g->family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    features.dynamicRendering = features.synchronization2 = VK_TRUE;
    device.pNext = &features;
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queue;
    device.enabledExtensionCount = g->surface ? 1 : 0;
    device.ppEnabledExtensionNames = extensions;
    TRY(g, vkCreateDevice, (g->gpu, &device, NULL, &g->device));
    vkGetDeviceQueue(g->device, g->family, 0, &g->queue);
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = g->family;
    TRY(g, vkCreateCommandPool, (g->device, &pool, NULL, &g->commands));
    cmd.commandPool = g->commands;
    cmd.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    cmd.commandBufferCount = 1;
    TRY(g, vkAllocateCommandBuffers, (g->device, &cmd, &g->cmd));
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = TIMES_OWN + 1;
    TRY(g, vkCreateQueryPool, (g->device, &queries, NULL, &g->queries));
    return 1;
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static int allocate(vk *g, const VkMemoryRequirements *need, VkMemoryPropertyFlags flags, VkDeviceMemory *out)
{
    STRUCT(VkMemoryAllocateInfo, info, MEMORY_ALLOCATE_INFO);
    uint32_t i;

    info.allocationSize = need->size;
    for (i = 0; i < g->memory_types.memoryTypeCount; i++) {
        if (!(need->memoryTypeBits >> i & 1) || (g->memory_types.memoryTypes[i].propertyFlags & flags) != flags) continue;
        info.memoryTypeIndex = i;
        TRY(g, vkAllocateMemory, (g->device, &info, NULL, out));
        return 1;
    }
    return FAIL(g, "no memory type of this device has the properties 0x%x", flags);
}

static void drop_buffer(vk *g, vk_buffer *b)
{
    vkDestroyBuffer(g->device, b->buffer, NULL);
    vkFreeMemory(g->device, b->memory, NULL); /* unmaps it */
    memset(b, 0, sizeof *b);
}

static int make_buffer(vk *g, vk_buffer *b, VkDeviceSize size, VkBufferUsageFlags usage, int mapped)
{
    const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    STRUCT(VkBufferCreateInfo, info, BUFFER_CREATE_INFO);
    VkMemoryRequirements need;

    drop_buffer(g, b);
    info.size = size;
    info.usage = usage;
    TRY(g, vkCreateBuffer, (g->device, &info, NULL, &b->buffer));
    vkGetBufferMemoryRequirements(g->device, b->buffer, &need);
    if (!allocate(g, &need, mapped ? host : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &b->memory)) return 0;
    TRY(g, vkBindBufferMemory, (g->device, b->buffer, b->memory, 0));
    if (mapped) TRY(g, vkMapMemory, (g->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped));
    return 1;
}

static VkImageAspectFlags aspect_of(VkFormat format)
{
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

static void drop_image(vk *g, vk_image *t)
{
    vkDestroyImageView(g->device, t->view, NULL);
    vkDestroyImage(g->device, t->image, NULL);
    vkFreeMemory(g->device, t->memory, NULL);
    memset(t, 0, sizeof *t);
}

static int make_view(vk *g, VkImage image, VkFormat format, VkImageViewType type, VkComponentSwizzle red, VkImageView *out)
{
    STRUCT(VkImageViewCreateInfo, info, IMAGE_VIEW_CREATE_INFO);

    info.image = image;
    info.viewType = type;
    info.format = format;
    info.components.r = red;
    info.subresourceRange.aspectMask = aspect_of(format);
    info.subresourceRange.levelCount = 1;
    info.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    TRY(g, vkCreateImageView, (g->device, &info, NULL, out));
    return 1;
}

/* layers 0: a plain image. */
static int make_image(vk *g, vk_image *t, VkFormat format, uint32_t width, uint32_t height, uint32_t layers,
                      VkImageUsageFlags usage)
{
    STRUCT(VkImageCreateInfo, info, IMAGE_CREATE_INFO);
    VkMemoryRequirements need;

    drop_image(g, t);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent.width = width;
    info.extent.height = height;
    info.extent.depth = 1;
    info.mipLevels = 1;
    info.arrayLayers = layers ? layers : 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage;
    TRY(g, vkCreateImage, (g->device, &info, NULL, &t->image));
    vkGetImageMemoryRequirements(g->device, t->image, &need);
    if (!allocate(g, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &t->memory)) return 0;
    TRY(g, vkBindImageMemory, (g->device, t->image, t->memory, 0));
    return make_view(g, t->image, format, layers ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
                     VK_COMPONENT_SWIZZLE_IDENTITY, &t->view);
}

/* ---- commands ---------------------------------------------------------------------------------------------------- */

static int begin(vk *g)
{
    STRUCT(VkCommandBufferBeginInfo, info, COMMAND_BUFFER_BEGIN_INFO);

    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    TRY(g, vkBeginCommandBuffer, (g->cmd, &info));
    return 1;
}

/* Submit and wait. swap: index of the image to draw into once it is free, and to signal; -1: none. */
static int finish(vk *g, int swap)
{
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT; /* the blit is the first that touches it */
    STRUCT(VkSubmitInfo, submit, SUBMIT_INFO);

    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &g->cmd;
    if (swap >= 0) {
        submit.waitSemaphoreCount = submit.signalSemaphoreCount = 1;
        submit.pWaitSemaphores = &g->acquired;
        submit.pWaitDstStageMask = &stage;
        submit.pSignalSemaphores = &g->rendered[swap];
    }
    TRY(g, vkEndCommandBuffer, (g->cmd));
    TRY(g, vkQueueSubmit, (g->queue, 1, &submit, VK_NULL_HANDLE));
    TRY(g, vkQueueWaitIdle, (g->queue));
    return 1;
}

typedef struct use { VkImageLayout layout; VkPipelineStageFlags2 stage; VkAccessFlags2 access; } use;
#define LAYOUT(name) VK_IMAGE_LAYOUT_##name
#define STAGE(name)  VK_PIPELINE_STAGE_2_##name##_BIT
#define ACCESS(name) VK_ACCESS_2_##name##_BIT
static const use unused = {LAYOUT(UNDEFINED), 0, 0};
static const use drawn = {LAYOUT(COLOR_ATTACHMENT_OPTIMAL), STAGE(COLOR_ATTACHMENT_OUTPUT),
                          ACCESS(COLOR_ATTACHMENT_WRITE) | ACCESS(COLOR_ATTACHMENT_READ)};
static const use drawn_depth = {LAYOUT(DEPTH_ATTACHMENT_OPTIMAL), STAGE(EARLY_FRAGMENT_TESTS) | STAGE(LATE_FRAGMENT_TESTS),
                                ACCESS(DEPTH_STENCIL_ATTACHMENT_WRITE) | ACCESS(DEPTH_STENCIL_ATTACHMENT_READ)};
static const use sampled = {LAYOUT(SHADER_READ_ONLY_OPTIMAL), STAGE(FRAGMENT_SHADER) | STAGE(COMPUTE_SHADER),
                            ACCESS(SHADER_SAMPLED_READ)};
static const use computed = {LAYOUT(GENERAL), STAGE(COMPUTE_SHADER), ACCESS(SHADER_STORAGE_WRITE)};
static const use shown = {LAYOUT(GENERAL), STAGE(FRAGMENT_SHADER), ACCESS(SHADER_SAMPLED_READ)};
static const use copied_from = {LAYOUT(TRANSFER_SRC_OPTIMAL), STAGE(ALL_TRANSFER), ACCESS(TRANSFER_READ)};
static const use copied_to = {LAYOUT(TRANSFER_DST_OPTIMAL), STAGE(ALL_TRANSFER), ACCESS(TRANSFER_WRITE)};
static const use presented = {LAYOUT(PRESENT_SRC_KHR), 0, 0};

static void transition(vk *g, VkImage image, VkImageAspectFlags aspect, use from, use to)
{
    STRUCT(VkImageMemoryBarrier2, info, IMAGE_MEMORY_BARRIER_2);
    STRUCT(VkDependencyInfo, dependency, DEPENDENCY_INFO);

    info.srcStageMask = from.stage;
    info.srcAccessMask = from.access;
    info.dstStageMask = to.stage;
    info.dstAccessMask = to.access;
    info.oldLayout = from.layout;
    info.newLayout = to.layout;
    info.srcQueueFamilyIndex = info.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    info.image = image;
    info.subresourceRange.aspectMask = aspect;
    info.subresourceRange.levelCount = 1;
    info.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    dependency.imageMemoryBarrierCount = 1;
    dependency.pImageMemoryBarriers = &info;
    vkCmdPipelineBarrier2(g->cmd, &dependency);
}

/* Of buffers. */
static void wait_for(vk *g, VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to, VkAccessFlags2 access)
{
    STRUCT(VkMemoryBarrier2, info, MEMORY_BARRIER_2);
    STRUCT(VkDependencyInfo, dependency, DEPENDENCY_INFO);

    info.srcStageMask = from;
    info.srcAccessMask = written;
    info.dstStageMask = to;
    info.dstAccessMask = access;
    dependency.memoryBarrierCount = 1;
    dependency.pMemoryBarriers = &info;
    vkCmdPipelineBarrier2(g->cmd, &dependency);
}

static void stamp(vk *g, uint32_t query)
{
    vkCmdWriteTimestamp2(g->cmd, STAGE(ALL_COMMANDS), g->queries, query);
}

/* ---- pipelines --------------------------------------------------------------------------------------------------- */

/* One stage of shaders/ to a module. */
static int compile(vk *g, const char *name, const char *text, int fragment, VkShaderModule *out)
{
    char full[16384];
    ZEROED(glslang_input_t, in);
    STRUCT(VkShaderModuleCreateInfo, info, SHADER_MODULE_CREATE_INFO);
    glslang_shader_t *shader;
    glslang_program_t *program = glslang_program_create();
    int ok = 0;

    snprintf(full, sizeof full, "#version 450\n#define VERTEX_INDEX gl_VertexIndex\n%s%s", shader_scene_glsl, text);
    in.language = GLSLANG_SOURCE_GLSL;
    in.stage = fragment ? GLSLANG_STAGE_FRAGMENT : GLSLANG_STAGE_VERTEX;
    in.client = GLSLANG_CLIENT_VULKAN;
    in.client_version = GLSLANG_TARGET_VULKAN_1_1;
    in.target_language = GLSLANG_TARGET_SPV;
    in.target_language_version = GLSLANG_TARGET_SPV_1_3;
    in.code = full;
    in.default_version = 450;
    in.default_profile = GLSLANG_CORE_PROFILE;
    in.messages = (glslang_messages_t)((int)GLSLANG_MSG_SPV_RULES_BIT | (int)GLSLANG_MSG_VULKAN_RULES_BIT);
    in.resource = glslang_default_resource();
    shader = glslang_shader_create(&in);
    if (glslang_shader_preprocess(shader, &in) && glslang_shader_parse(shader, &in)) {
        glslang_program_add_shader(program, shader);
        if (glslang_program_link(program, (int)in.messages)) {
            glslang_program_SPIRV_generate(program, in.stage);
            info.codeSize = glslang_program_SPIRV_get_size(program) * sizeof(uint32_t);
            info.pCode = glslang_program_SPIRV_get_ptr(program);
            ok = vkCreateShaderModule(g->device, &info, NULL, out) == VK_SUCCESS;
        }
    }
    if (!ok) ok = FAIL(g, "shader %s: %s%s", name, glslang_shader_get_info_log(shader), glslang_program_get_info_log(program));
    glslang_program_delete(program);
    glslang_shader_delete(shader);
    return ok;
}

/* Binding 0 is the uniform block, the others textures. */
static int make_set(vk *g)
{
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, BINDINGS - 1}};
    VkDescriptorSetLayoutBinding bindings[BINDINGS];
    STRUCT(VkDescriptorSetLayoutCreateInfo, set, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    STRUCT(VkPipelineLayoutCreateInfo, layout, PIPELINE_LAYOUT_CREATE_INFO);
    STRUCT(VkDescriptorPoolCreateInfo, pool, DESCRIPTOR_POOL_CREATE_INFO);
    STRUCT(VkDescriptorSetAllocateInfo, info, DESCRIPTOR_SET_ALLOCATE_INFO);
    STRUCT(VkSamplerCreateInfo, sampler, SAMPLER_CREATE_INFO); /* texelFetch alone uses it */
    uint32_t i;

    memset(bindings, 0, sizeof bindings);
    for (i = 0; i < BINDINGS; i++) {
        bindings[i].binding = i;
        bindings[i].descriptorType = sizes[i > 0].type;
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    }
    set.bindingCount = BINDINGS;
    set.pBindings = bindings;
    TRY(g, vkCreateDescriptorSetLayout, (g->device, &set, NULL, &g->set_layout));
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &g->set_layout;
    TRY(g, vkCreatePipelineLayout, (g->device, &layout, NULL, &g->layout));
    pool.maxSets = 1;
    pool.poolSizeCount = 2;
    pool.pPoolSizes = sizes;
    TRY(g, vkCreateDescriptorPool, (g->device, &pool, NULL, &g->pool));
    info.descriptorPool = g->pool;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &g->set_layout;
    TRY(g, vkAllocateDescriptorSets, (g->device, &info, &g->set));
    TRY(g, vkCreateSampler, (g->device, &sampler, NULL, &g->sampler));
    return 1;
}

/* What a draw reads per corner. */
static void describe_vertices(int draw, VkVertexInputBindingDescription *binding, VkVertexInputAttributeDescription attributes[5],
                              VkPipelineVertexInputStateCreateInfo *info)
{
    static const VkFormat formats[] = {0, 0, VK_FORMAT_R32G32_SFLOAT, VK_FORMAT_R32G32B32_SFLOAT};
    static const uint32_t rows[][2] = GPU_ATTRIBUTES;
    uint32_t i;

    memset(binding, 0, sizeof *binding);
    memset(attributes, 0, 5 * sizeof *attributes);
    binding->stride = draw == DRAW_TEXT ? 3 * sizeof(float) : sizeof(gpu_vertex);
    for (i = 0; i < 5; i++) {
        attributes[i].location = i;
        attributes[i].format = formats[rows[i][1]];
        attributes[i].offset = rows[i][0] * (uint32_t)sizeof(float);
    }
    info->vertexBindingDescriptionCount = draw == DRAW_SKY || draw == DRAW_SCREEN ? 0 : 1;
    info->pVertexBindingDescriptions = binding;
    info->vertexAttributeDescriptionCount = draw == DRAW_MODEL ? 5 : info->vertexBindingDescriptionCount;
    info->pVertexAttributeDescriptions = attributes;
}

static int make_pipeline(vk *g, int draw, VkShaderModule vertex, VkShaderModule fragment)
{
    static const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkVertexInputBindingDescription binding;
    VkVertexInputAttributeDescription attributes[5];
    VkPipelineColorBlendAttachmentState blends[TARGETS];
    VkPipelineShaderStageCreateInfo stages[2];
    STRUCT(VkPipelineVertexInputStateCreateInfo, input, PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
    STRUCT(VkPipelineInputAssemblyStateCreateInfo, assembly, PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
    STRUCT(VkPipelineViewportStateCreateInfo, viewport, PIPELINE_VIEWPORT_STATE_CREATE_INFO);
    STRUCT(VkPipelineRasterizationStateCreateInfo, raster, PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
    STRUCT(VkPipelineMultisampleStateCreateInfo, samples, PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
    STRUCT(VkPipelineDepthStencilStateCreateInfo, depth, PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
    STRUCT(VkPipelineColorBlendStateCreateInfo, blend, PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
    STRUCT(VkPipelineDynamicStateCreateInfo, dynamic, PIPELINE_DYNAMIC_STATE_CREATE_INFO);
    STRUCT(VkPipelineRenderingCreateInfo, rendering, PIPELINE_RENDERING_CREATE_INFO);
    STRUCT(VkGraphicsPipelineCreateInfo, info, GRAPHICS_PIPELINE_CREATE_INFO);
    const int screen = draw == DRAW_SCREEN || draw == DRAW_TEXT;
    uint32_t i;

    memset(stages, 0, sizeof stages);
    memset(blends, 0, sizeof blends);
    for (i = 0; i < 2; i++) {
        stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
        stages[i].stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT;
        stages[i].module = i ? fragment : vertex;
        stages[i].pName = "main";
    }
    describe_vertices(draw, &binding, attributes, &input);
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    viewport.viewportCount = viewport.scissorCount = 1;
    raster.lineWidth = 1.0f; /* no culling: surfaces have two sides */
    samples.rasterizationSamples = VK_SAMPLE_COUNT_1_BIT;
    depth.depthTestEnable = !screen;
    depth.depthWriteEnable = !screen && draw != DRAW_SKY;
    depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
    for (i = 0; i < TARGETS; i++) blends[i].colorWriteMask = 15;
    blend.attachmentCount = screen ? 1 : draw == DRAW_SHADOW ? 0 : TARGETS - 1;
    blend.pAttachments = blends;
    dynamic.dynamicStateCount = 2;
    dynamic.pDynamicStates = dynamics;
    rendering.colorAttachmentCount = blend.attachmentCount;
    rendering.pColorAttachmentFormats = screen ? &picture_format : target_formats + 1;
    rendering.depthAttachmentFormat = screen ? VK_FORMAT_UNDEFINED : target_formats[TARGET_DEPTH];
    info.pNext = &rendering;
    info.stageCount = 2;
    info.pStages = stages;
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &samples;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = g->layout;
    TRY(g, vkCreateGraphicsPipelines, (g->device, VK_NULL_HANDLE, 1, &info, NULL, &g->draws[draw]));
    return 1;
}

static int make_pipelines(vk *g)
{
    static const char *const names[DRAWS] = {"shadow", "model", "sky", "screen", "text"};
    static const char *const texts[DRAWS][2] = {
        {shader_shadow_vert, shader_shadow_frag}, {shader_model_vert, shader_model_frag}, {shader_cover_vert, shader_sky_frag},
        {shader_cover_vert, shader_screen_frag}, {shader_text_vert, shader_text_frag}};
    int draw;

    for (draw = 0; draw < DRAWS; draw++) {
        VkShaderModule vertex = VK_NULL_HANDLE, fragment = VK_NULL_HANDLE;
        const int ok = compile(g, names[draw], texts[draw][0], 0, &vertex) && compile(g, names[draw], texts[draw][1], 1, &fragment)
                    && make_pipeline(g, draw, vertex, fragment);
        vkDestroyShaderModule(g->device, vertex, NULL);
        vkDestroyShaderModule(g->device, fragment, NULL);
        if (!ok) return 0;
    }
    return 1;
}

/* ---- open and close ---------------------------------------------------------------------------------------------- */

static void drop_swapchain(vk *g)
{
    int i;

    for (i = 0; i < SWAP_MAX; i++) vkDestroySemaphore(g->device, g->rendered[i], NULL);
    memset(g->rendered, 0, sizeof g->rendered);
    if (g->swapchain) vkDestroySwapchainKHR(g->device, g->swapchain, NULL);
    g->swapchain = VK_NULL_HANDLE;
}

static void drop_device(vk *g)
{
    int i;

    vkDeviceWaitIdle(g->device);
    hbil_vk_shutdown(&g->light);
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) drop_image(g, &g->outputs[i]);
    for (i = 0; i < TARGETS; i++) drop_image(g, &g->targets[i]);
    vkDestroyImageView(g->device, g->roughness, NULL);
    drop_image(g, &g->shadow);
    drop_image(g, &g->picture);
    drop_buffer(g, &g->uniforms);
    drop_buffer(g, &g->vertices);
    drop_buffer(g, &g->text);
    drop_buffer(g, &g->staging);
    for (i = 0; i < DRAWS; i++) vkDestroyPipeline(g->device, g->draws[i], NULL);
    vkDestroySampler(g->device, g->sampler, NULL);
    vkDestroyDescriptorPool(g->device, g->pool, NULL);
    vkDestroyPipelineLayout(g->device, g->layout, NULL);
    vkDestroyDescriptorSetLayout(g->device, g->set_layout, NULL);
    drop_swapchain(g);
    vkDestroySemaphore(g->device, g->acquired, NULL);
    vkDestroyQueryPool(g->device, g->queries, NULL);
    vkDestroyCommandPool(g->device, g->commands, NULL);
    vkDestroyDevice(g->device, NULL);
}

static void vk_close(void *gpu)
{
    vk *g = gpu;

    if (g->device) drop_device(g);
    if (g->surface) vkDestroySurfaceKHR(g->instance, g->surface, NULL);
    if (g->messenger) vkDestroyDebugUtilsMessengerEXT(g->instance, g->messenger, NULL);
    if (g->instance) {
        /* Both leave a few kilobytes behind. Kept in memory, they can be named in a leak checker's suppressions. */
        dlopen("libvulkan_lvp.so", RTLD_NOW | RTLD_NODELETE | RTLD_NOLOAD);
        dlopen("libVkLayer_khronos_validation.so", RTLD_NOW | RTLD_NODELETE | RTLD_NOLOAD);
        vkDestroyInstance(g->instance, NULL);
    }
    if (g->compiler) hbil_glslang_shutdown();
    free(g);
}

static int start(vk *g, char device[128])
{
    const VkImageUsageFlags usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_SAMPLED_BIT;
    STRUCT(VkSemaphoreCreateInfo, semaphore, SEMAPHORE_CREATE_INFO);

    g->compiler = hbil_glslang_init();
    if (!g->compiler) return FAIL(g, "glslang does not start: out of memory");
    if (!make_instance(g) || !pick_device(g, device) || !make_device(g) || !make_set(g) || !make_pipelines(g)) return 0;
    TRY(g, vkCreateSemaphore, (g->device, &semaphore, NULL, &g->acquired));
    return make_image(g, &g->shadow, target_formats[TARGET_DEPTH], SHADOW_SIZE, SHADOW_SIZE, 0, usage)
        && make_buffer(g, &g->uniforms, sizeof(gpu_uniforms), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, 0)
        && make_buffer(g, &g->text, TEXT_CORNERS * 3 * sizeof(float), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, 1);
}

static void *vk_open(const gpu_setup *setup, char device[128])
{
    vk *g = calloc(1, sizeof *g);

    if (!g) {
        snprintf(setup->error, setup->error_size, "out of memory");
        return NULL;
    }
    g->setup = *setup;
    if (start(g, device)) return g;
    vk_close(g);
    return NULL;
}

static int vk_messages(const void *gpu) { return ((const vk *)gpu)->messages; }

static int vk_model(void *gpu, const gpu_vertex *vertices, size_t count)
{
    const VkDeviceSize size = count * sizeof *vertices;
    vk       *g = gpu;
    vk_buffer upload;
    int       ok;

    memset(&upload, 0, sizeof upload);
    g->vertex_count = (uint32_t)count;
    ok = make_buffer(g, &g->vertices, size, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, 0)
      && make_buffer(g, &upload, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, 1) && begin(g);
    if (ok) {
        const VkBufferCopy all = {0, 0, size};
        memcpy(upload.mapped, vertices, size);
        vkCmdCopyBuffer(g->cmd, upload.buffer, g->vertices.buffer, 1, &all);
        ok = finish(g, -1);
    }
    drop_buffer(g, &upload);
    return ok;
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* Our images for its inputs and outputs. New outputs are left in GENERAL, where hbil_vk.h wants them. */
static int hand_over(vk *g)
{
    const hbil_plan *plan = &g->light.plan;
    VkImageView      views[HBIL_MAX_TEXTURES];
    uint32_t         t;

    memset(views, 0, sizeof views);
    for (t = 0; t < HBIL_MAX_TEXTURES; t++) drop_image(g, &g->outputs[t]);
    for (t = 0; t < plan->texture_count; t++) {
        const hbil_texture *texture = &plan->textures[t];
        if (texture->life == HBIL_LIFE_INPUT) {
            const int target = gpu_input_of(texture->name);
            views[t] = target == TARGET_ROUGHNESS ? g->roughness : target >= 0 ? g->targets[target].view : VK_NULL_HANDLE;
        } else if (texture->life == HBIL_LIFE_OUTPUT) {
            if (!make_image(g, &g->outputs[t], hbil_vk_format((hbil_format)texture->format), g->width, g->height,
                            texture->dim == HBIL_DIM_2D_ARRAY ? texture->layers : 0,
                            VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT)) return 0;
            views[t] = g->outputs[t].view;
        }
    }
    if (!begin(g)) return 0;
    for (t = 0; t < plan->texture_count; t++)
        if (g->outputs[t].image) transition(g, g->outputs[t].image, VK_IMAGE_ASPECT_COLOR_BIT, unused, computed);
    if (!finish(g, -1)) return 0;
    return hbil_vk_resize(&g->light, g->width, g->height, views) == HBIL_VK_OK || FAIL(g, "%s", g->light.message);
}

/* Text of every pass to SPIR-V, words of all after each other. */
static int compile_plan(vk *g, const hbil_plan *plan, uint32_t *words, size_t room, hbil_vk_info *info)
{
    static char text[HBIL_GLSL_MAX];
    char        log[512];
    uint32_t    p;

    for (p = 0; p < plan->pass_count; p++) {
        size_t need = 0;
        if (hbil_emit_glsl(plan, (int32_t)p, text, sizeof text, NULL) != HBIL_OK)
            return FAIL(g, "pass %s: needs a hook, of which this program has none", plan->passes[p].name);
        if (hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, room, &need, log, sizeof log) != HBIL_GLSLANG_OK)
            return FAIL(g, "pass %s does not compile: %s", plan->passes[p].name, log);
        info->spirv[p].words = words;
        info->spirv[p].count = need;
        words += need;
        room -= need;
    }
    return 1;
}

static int vk_plan(void *gpu, const hbil_plan *plan)
{
    enum { WORDS = 1 << 18 };
    vk       *g = gpu;
    uint32_t *words = malloc(WORDS * sizeof *words);
    hbil_vk   next;
    int       ok;
    ZEROED(hbil_vk_info, info);

    memset(&next, 0, sizeof next);
    ok = words ? compile_plan(g, plan, words, WORDS, &info) : FAIL(g, "out of memory");
    if (ok) {
        info.instance = g->instance;
        info.physical_device = g->gpu;
        info.device = g->device;
        info.queue_family = g->family;
        info.get_proc = vkGetInstanceProcAddr;
        info.plan = plan;
        info.input_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        info.timestamps = 1;
        ok = hbil_vk_init(&info, &next) == HBIL_VK_OK || FAIL(g, "%s", next.message);
    }
    free(words);
    if (!ok) return 0;
    hbil_vk_shutdown(&g->light); /* the queue is idle between frames */
    g->light = next;
    return g->width == 0 || hand_over(g);
}

/* ---- size -------------------------------------------------------------------------------------------------------- */

static int make_swapchain(vk *g)
{
    VkSurfaceCapabilitiesKHR can;
    VkSurfaceFormatKHR formats[64];
    uint32_t count = sizeof formats / sizeof *formats, i, pick;
    STRUCT(VkSwapchainCreateInfoKHR, info, SWAPCHAIN_CREATE_INFO_KHR);
    STRUCT(VkSemaphoreCreateInfo, semaphore, SEMAPHORE_CREATE_INFO);

    TRY(g, vkGetPhysicalDeviceSurfaceCapabilitiesKHR, (g->gpu, g->surface, &can));
    if (vkGetPhysicalDeviceSurfaceFormatsKHR(g->gpu, g->surface, &count, formats) < 0) count = 0;
    for (pick = 0; pick < count && formats[pick].format != VK_FORMAT_B8G8R8A8_UNORM &&
         formats[pick].format != VK_FORMAT_R8G8B8A8_UNORM; pick++) {}
    if (pick == count) return FAIL(g, "the window has no 8-bit format without sRGB conversion: try --gl");
    drop_swapchain(g);
    info.surface = g->surface;
    info.minImageCount = can.minImageCount + 1;
    if (can.maxImageCount && info.minImageCount > can.maxImageCount) info.minImageCount = can.maxImageCount;
    info.imageFormat = g->swap_format = formats[pick].format;
    info.imageColorSpace = formats[pick].colorSpace;
    g->swap_size.width = g->width;
    g->swap_size.height = g->height;
    if (can.currentExtent.width != ~0u) g->swap_size = can.currentExtent;
    info.imageExtent = g->swap_size;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    if ((can.supportedUsageFlags & info.imageUsage) != info.imageUsage)
        return FAIL(g, "images of the window cannot be copied to and from: try --gl");
    info.preTransform = can.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;
    info.clipped = VK_TRUE;
    TRY(g, vkCreateSwapchainKHR, (g->device, &info, NULL, &g->swapchain));
    count = SWAP_MAX;
    TRY(g, vkGetSwapchainImagesKHR, (g->device, g->swapchain, &count, g->swap_images));
    for (i = 0; i < count; i++) TRY(g, vkCreateSemaphore, (g->device, &semaphore, NULL, &g->rendered[i]));
    return 1;
}

static int vk_resize(void *gpu, int width, int height)
{
    vk *g = gpu;
    int t;

    TRY(g, vkDeviceWaitIdle, (g->device));
    g->width = (uint32_t)width;
    g->height = (uint32_t)height;
    if (g->surface && !make_swapchain(g)) return 0;
    for (t = 0; t < TARGETS; t++)
        if (!make_image(g, &g->targets[t], target_formats[t], g->width, g->height, 0,
                        VK_IMAGE_USAGE_SAMPLED_BIT | (t == TARGET_DEPTH ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT
                                                                         : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT))) return 0;
    vkDestroyImageView(g->device, g->roughness, NULL);
    g->roughness = VK_NULL_HANDLE;
    return make_view(g, g->targets[TARGET_SPECULAR].image, target_formats[TARGET_SPECULAR], VK_IMAGE_VIEW_TYPE_2D,
                     VK_COMPONENT_SWIZZLE_A, &g->roughness)
        && make_image(g, &g->picture, picture_format, g->width, g->height, 0,
                      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT)
        && make_buffer(g, &g->staging, (VkDeviceSize)g->width * g->height * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT, 1)
        && hand_over(g);
}

/* ---- one frame --------------------------------------------------------------------------------------------------- */

static VkRenderingAttachmentInfo attachment(VkImageView view, VkImageLayout layout)
{
    STRUCT(VkRenderingAttachmentInfo, info, RENDERING_ATTACHMENT_INFO);

    info.imageView = view;
    info.imageLayout = layout;
    info.loadOp = VK_ATTACHMENT_LOAD_OP_CLEAR;
    info.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    if (layout == VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL) info.clearValue.depthStencil.depth = 1.0f;
    return info;
}

static void begin_draw(vk *g, uint32_t width, uint32_t height, const VkRenderingAttachmentInfo *colours, uint32_t colour_count,
                       const VkRenderingAttachmentInfo *depth)
{
    const VkViewport viewport = {0.0f, 0.0f, (float)width, (float)height, 0.0f, 1.0f};
    STRUCT(VkRenderingInfo, info, RENDERING_INFO);

    info.renderArea.extent.width = width;
    info.renderArea.extent.height = height;
    info.layerCount = 1;
    info.colorAttachmentCount = colour_count;
    info.pColorAttachments = colours;
    info.pDepthAttachment = depth;
    vkCmdBeginRendering(g->cmd, &info);
    vkCmdSetViewport(g->cmd, 0, 1, &viewport);
    vkCmdSetScissor(g->cmd, 0, 1, &info.renderArea);
}

static void draw(vk *g, int what, const vk_buffer *vertices, uint32_t count)
{
    const VkDeviceSize offset = 0;

    vkCmdBindPipeline(g->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, g->draws[what]);
    vkCmdBindDescriptorSets(g->cmd, VK_PIPELINE_BIND_POINT_GRAPHICS, g->layout, 0, 1, &g->set, 0, NULL);
    if (vertices) vkCmdBindVertexBuffers(g->cmd, 0, 1, &vertices->buffer, &offset);
    vkCmdDraw(g->cmd, count, 1, 0, 0);
}

static void write_set(vk *g, const gpu_frame *frame)
{
    const VkDescriptorBufferInfo block = {g->uniforms.buffer, 0, sizeof(gpu_uniforms)};
    const VkImageView views[BINDINGS - 1] = {
        g->shadow.view, g->targets[TARGET_NORMAL].view, g->targets[TARGET_ALBEDO].view, g->targets[TARGET_DIRECT].view,
        frame->shown >= 0 ? g->outputs[frame->shown].view : g->targets[TARGET_DIRECT].view};
    VkDescriptorImageInfo images[BINDINGS - 1];
    VkWriteDescriptorSet  writes[BINDINGS];
    uint32_t i;

    memset(writes, 0, sizeof writes);
    for (i = 0; i < BINDINGS; i++) {
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = g->set;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = i ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        writes[i].pBufferInfo = &block;
        if (i == 0) continue;
        images[i - 1].sampler = g->sampler;
        images[i - 1].imageView = views[i - 1];
        images[i - 1].imageLayout = i == BINDINGS - 1 && frame->shown >= 0 ? shown.layout : sampled.layout;
        writes[i].pImageInfo = &images[i - 1];
    }
    vkUpdateDescriptorSets(g->device, BINDINGS, writes, 0, NULL);
}

static void draw_scene(vk *g)
{
    VkRenderingAttachmentInfo colours[TARGETS - 1], depth = attachment(g->shadow.view, drawn_depth.layout);
    int t;

    transition(g, g->shadow.image, VK_IMAGE_ASPECT_DEPTH_BIT, unused, drawn_depth);
    begin_draw(g, SHADOW_SIZE, SHADOW_SIZE, NULL, 0, &depth);
    draw(g, DRAW_SHADOW, &g->vertices, g->vertex_count);
    vkCmdEndRendering(g->cmd);
    transition(g, g->shadow.image, VK_IMAGE_ASPECT_DEPTH_BIT, drawn_depth, sampled);
    stamp(g, 1);

    depth = attachment(g->targets[TARGET_DEPTH].view, drawn_depth.layout);
    for (t = 0; t < TARGETS; t++) {
        transition(g, g->targets[t].image, aspect_of(target_formats[t]), unused, t == TARGET_DEPTH ? drawn_depth : drawn);
        if (t != TARGET_DEPTH) colours[t - 1] = attachment(g->targets[t].view, drawn.layout);
    }
    begin_draw(g, g->width, g->height, colours, TARGETS - 1, &depth);
    draw(g, DRAW_MODEL, &g->vertices, g->vertex_count);
    draw(g, DRAW_SKY, NULL, 3);
    vkCmdEndRendering(g->cmd);
    for (t = 0; t < TARGETS; t++)
        transition(g, g->targets[t].image, aspect_of(target_formats[t]), t == TARGET_DEPTH ? drawn_depth : drawn, sampled);
    stamp(g, 2);
}

static void draw_screen(vk *g, const gpu_frame *frame)
{
    const VkRenderingAttachmentInfo colour = attachment(g->picture.view, drawn.layout);

    if (frame->shown >= 0)
        transition(g, g->outputs[frame->shown].image, VK_IMAGE_ASPECT_COLOR_BIT, computed, shown);
    transition(g, g->picture.image, VK_IMAGE_ASPECT_COLOR_BIT, unused, drawn);
    begin_draw(g, g->width, g->height, &colour, 1, NULL);
    draw(g, DRAW_SCREEN, NULL, 3);
    if (frame->text_corners > 0) draw(g, DRAW_TEXT, &g->text, (uint32_t)frame->text_corners);
    vkCmdEndRendering(g->cmd);
    transition(g, g->picture.image, VK_IMAGE_ASPECT_COLOR_BIT, drawn, copied_from);
}

/* The picture to the window, and what is then shown, or the picture itself, to the staging buffer. */
static void copy_picture(vk *g, int swap, int read)
{
    VkImage from = g->picture.image;
    ZEROED(VkBufferImageCopy, copy);

    if (swap >= 0) {
        ZEROED(VkImageBlit, blit);
        blit.srcSubresource.aspectMask = blit.dstSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
        blit.srcSubresource.layerCount = blit.dstSubresource.layerCount = 1;
        blit.srcOffsets[1].x = (int32_t)g->width;
        blit.srcOffsets[1].y = (int32_t)g->height;
        blit.dstOffsets[1].x = (int32_t)g->swap_size.width;
        blit.dstOffsets[1].y = (int32_t)g->swap_size.height;
        blit.srcOffsets[1].z = blit.dstOffsets[1].z = 1;
        from = g->swap_images[swap];
        transition(g, from, VK_IMAGE_ASPECT_COLOR_BIT, (use){LAYOUT(UNDEFINED), STAGE(ALL_TRANSFER), 0}, copied_to);
        vkCmdBlitImage(g->cmd, g->picture.image, copied_from.layout, from, copied_to.layout, 1, &blit, VK_FILTER_NEAREST);
        transition(g, from, VK_IMAGE_ASPECT_COLOR_BIT, copied_to, read ? copied_from : presented);
    }
    if (read) {
        copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
        copy.imageSubresource.layerCount = 1;
        copy.bufferRowLength = g->width;
        copy.imageExtent.width = swap >= 0 && g->swap_size.width < g->width ? g->swap_size.width : g->width;
        copy.imageExtent.height = swap >= 0 && g->swap_size.height < g->height ? g->swap_size.height : g->height;
        copy.imageExtent.depth = 1;
        vkCmdCopyImageToBuffer(g->cmd, from, copied_from.layout, g->staging.buffer, 1, &copy);
        wait_for(g, STAGE(ALL_TRANSFER), ACCESS(TRANSFER_WRITE), STAGE(HOST), ACCESS(HOST_READ));
        if (swap >= 0) transition(g, from, VK_IMAGE_ASPECT_COLOR_BIT, copied_from, presented);
    }
}

static int record(vk *g, const gpu_frame *frame, int swap)
{
    uint32_t t;

    if (!begin(g)) return 0;
    vkCmdResetQueryPool(g->cmd, g->queries, 0, TIMES_OWN + 1);
    vkCmdUpdateBuffer(g->cmd, g->uniforms.buffer, 0, sizeof frame->scene, &frame->scene);
    wait_for(g, STAGE(ALL_TRANSFER), ACCESS(TRANSFER_WRITE), STAGE(VERTEX_SHADER) | STAGE(FRAGMENT_SHADER), ACCESS(UNIFORM_READ));
    stamp(g, 0);
    draw_scene(g);
    /* the last frame's picture read an output, in an earlier submission: a barrier for the new one's writes */
    for (t = 0; t < HBIL_MAX_TEXTURES; t++)
        if (g->outputs[t].image) transition(g, g->outputs[t].image, VK_IMAGE_ASPECT_COLOR_BIT, shown, computed);
    if (hbil_vk_record(&g->light, g->cmd, &frame->light) != HBIL_VK_OK) return FAIL(g, "%s", g->light.message);
    stamp(g, 3);
    draw_screen(g, frame);
    stamp(g, 4);
    copy_picture(g, swap, frame->pixels != NULL);
    return finish(g, swap);
}

static void read_pixels(const vk *g, unsigned char *to)
{
    const unsigned char *from = g->staging.mapped;
    const int   swapped = g->surface && g->swap_format == VK_FORMAT_B8G8R8A8_UNORM;
    const size_t count = (size_t)g->width * g->height;
    size_t      i;

    for (i = 0; i < count; i++, from += 4, to += 4) {
        to[0] = from[swapped ? 2 : 0];
        to[1] = from[1];
        to[2] = from[swapped ? 0 : 2];
        to[3] = 255;
    }
}

static int vk_frame(void *gpu, const gpu_frame *frame)
{
    vk      *g = gpu;
    uint32_t swap = 0;
    VkResult result;
    STRUCT(VkPresentInfoKHR, info, PRESENT_INFO_KHR);

    write_set(g, frame);
    if (frame->text_corners > 0) memcpy(g->text.mapped, frame->text, (size_t)frame->text_corners * 3 * sizeof(float));
    if (g->surface) {
        result = vkAcquireNextImageKHR(g->device, g->swapchain, UINT64_MAX, g->acquired, VK_NULL_HANDLE, &swap);
        if (result == VK_ERROR_OUT_OF_DATE_KHR) return 1; /* the window was resized: its event is on the way */
        if (result < 0) return FAIL(g, "vkAcquireNextImageKHR returned VkResult %d", (int)result);
    }
    if (!record(g, frame, g->surface ? (int)swap : -1)) return 0;
    if (frame->pixels) read_pixels(g, frame->pixels);
    if (!g->surface) return 1;
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &g->rendered[swap];
    info.swapchainCount = 1;
    info.pSwapchains = &g->swapchain;
    info.pImageIndices = &swap;
    result = vkQueuePresentKHR(g->queue, &info);
    return result >= 0 || result == VK_ERROR_OUT_OF_DATE_KHR || FAIL(g, "vkQueuePresentKHR returned VkResult %d", (int)result);
}

static int vk_times(void *gpu, gpu_time times[GPU_TIMES])
{
    static const char *const names[] = {"shadow", "g-buffer", "screen"};
    vk      *g = gpu;
    uint64_t ticks[TIMES_OWN + 1];
    double   ms[HBIL_MAX_PASSES];
    const double own = g->tick_ms;
    int      count = 0;
    uint32_t p;

    if (vkGetQueryPoolResults(g->device, g->queries, 0, TIMES_OWN + 1, sizeof ticks, ticks, sizeof *ticks,
                              VK_QUERY_RESULT_64_BIT) != VK_SUCCESS) return 0;
    if (hbil_vk_timings(&g->light, ms) != HBIL_VK_OK) return 0;
    for (p = 0; p < 2; p++, count++) {
        snprintf(times[count].name, sizeof times[count].name, "%s", names[p]);
        times[count].ms = own * (double)(ticks[p + 1] - ticks[p]);
    }
    for (p = 0; p < g->light.plan.pass_count; p++, count++) {
        snprintf(times[count].name, sizeof times[count].name, "%s", g->light.plan.passes[p].name);
        times[count].ms = ms[p];
    }
    snprintf(times[count].name, sizeof times[count].name, "%s", names[2]);
    times[count++].ms = own * (double)(ticks[4] - ticks[3]);
    return count;
}

const gpu_ops gpu_vulkan = {"vulkan", vk_open, vk_close, vk_messages, vk_model, vk_plan, vk_resize, vk_frame, vk_times};
