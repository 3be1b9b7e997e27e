/* gpu_vk_device.c - what any renderer on Vulkan 1.3 has: instance, device, memory, pipelines of shaders/.
 * gpu_vk.c has the frame.
 *
 * The implementations of hbil_glslang.h and volk are in examples/frame/runner_vk.c, which this program links. */
#include <glslang/Include/glslang_c_interface.h>
#include <glslang/Public/resource_limits_c.h>

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu_vk.h"
#include "../../backends/hbil_glslang.h"
#include "viewer_shaders.h"

const VkFormat vk_target_formats[TARGETS] = {
    VK_FORMAT_D32_SFLOAT, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT,
    VK_FORMAT_R16G16_SFLOAT, VK_FORMAT_R8G8B8A8_UNORM
};

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
    if (result == VK_ERROR_LAYER_NOT_PRESENT) 
        return FAIL(g, "no validation layer: apt-get install vulkan-validationlayers");
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) 
        return FAIL(g, "no Vulkan driver: apt-get install mesa-vulkan-drivers, or try --gl");
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
        const VkMemoryPropertyFlags has = g->memory_types.memoryTypes[i].propertyFlags;
        if (!(need->memoryTypeBits >> i & 1) || (has & flags) != flags) continue;
        info.memoryTypeIndex = i;
        TRY(g, vkAllocateMemory, (g->device, &info, NULL, out));
        return 1;
    }
    return FAIL(g, "no memory type of this device has the properties 0x%x", flags);
}

void vk_drop_buffer(vk *g, vk_buffer *b)
{
    vkDestroyBuffer(g->device, b->buffer, NULL);
    vkFreeMemory(g->device, b->memory, NULL); /* unmaps it */
    memset(b, 0, sizeof *b);
}

int vk_make_buffer(vk *g, vk_buffer *b, VkDeviceSize size, VkBufferUsageFlags usage, int mapped)
{
    const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    STRUCT(VkBufferCreateInfo, info, BUFFER_CREATE_INFO);
    VkMemoryRequirements need;

    vk_drop_buffer(g, b);
    info.size = size;
    info.usage = usage;
    TRY(g, vkCreateBuffer, (g->device, &info, NULL, &b->buffer));
    vkGetBufferMemoryRequirements(g->device, b->buffer, &need);
    if (!allocate(g, &need, mapped ? host : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &b->memory)) return 0;
    TRY(g, vkBindBufferMemory, (g->device, b->buffer, b->memory, 0));
    if (mapped) TRY(g, vkMapMemory, (g->device, b->memory, 0, VK_WHOLE_SIZE, 0, &b->mapped));
    return 1;
}

VkImageAspectFlags vk_aspect_of(VkFormat format)
{
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

void vk_drop_image(vk *g, vk_image *t)
{
    vkDestroyImageView(g->device, t->view, NULL);
    vkDestroyImage(g->device, t->image, NULL);
    vkFreeMemory(g->device, t->memory, NULL);
    memset(t, 0, sizeof *t);
}

int vk_make_view(vk *g, VkImage image, VkFormat format, VkImageViewType type, VkComponentSwizzle red,
                     VkImageView *out)
{
    STRUCT(VkImageViewCreateInfo, info, IMAGE_VIEW_CREATE_INFO);

    info.image = image;
    info.viewType = type;
    info.format = format;
    info.components.r = red;
    info.subresourceRange.aspectMask = vk_aspect_of(format);
    info.subresourceRange.levelCount = 1;
    info.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    TRY(g, vkCreateImageView, (g->device, &info, NULL, out));
    return 1;
}

/* layers 0: a plain image. */
int vk_make_image(vk *g, vk_image *t, VkFormat format, uint32_t width, uint32_t height, uint32_t layers,
                      VkImageUsageFlags usage)
{
    STRUCT(VkImageCreateInfo, info, IMAGE_CREATE_INFO);
    VkMemoryRequirements need;

    vk_drop_image(g, t);
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
    t->size = info.extent;
    if (layers) t->size.depth = layers;
    return vk_make_view(g, t->image, format, layers ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_2D,
                     VK_COMPONENT_SWIZZLE_IDENTITY, &t->view);
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
    if (!ok) ok = FAIL(g, "shader %s: %s%s", name, glslang_shader_get_info_log(shader),
                       glslang_program_get_info_log(program));
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
static void describe_vertices(int draw, VkVertexInputBindingDescription *binding,
                              VkVertexInputAttributeDescription attributes[5],
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

static int make_pipeline(vk *g, int draw, const VkPipelineShaderStageCreateInfo stages[2])
{
    static const VkFormat picture = PICTURE_FORMAT;
    static const VkDynamicState dynamics[] = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkVertexInputBindingDescription binding;
    VkVertexInputAttributeDescription attributes[5];
    VkPipelineColorBlendAttachmentState blends[TARGETS];
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

    memset(blends, 0, sizeof blends);
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
    rendering.pColorAttachmentFormats = screen ? &picture : vk_target_formats + 1;
    rendering.depthAttachmentFormat = screen ? VK_FORMAT_UNDEFINED : vk_target_formats[TARGET_DEPTH];
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
        {shader_shadow_vert, shader_shadow_frag}, {shader_model_vert, shader_model_frag},
        {shader_cover_vert, shader_sky_frag}, {shader_cover_vert, shader_screen_frag},
        {shader_text_vert, shader_text_frag}};
    VkPipelineShaderStageCreateInfo stages[2];
    int draw, i, ok = 1;

    for (draw = 0; draw < DRAWS && ok; draw++) {
        memset(stages, 0, sizeof stages);
        for (i = 0; i < 2 && ok; i++) {
            stages[i].sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
            stages[i].stage = i ? VK_SHADER_STAGE_FRAGMENT_BIT : VK_SHADER_STAGE_VERTEX_BIT;
            stages[i].pName = "main";
            ok = compile(g, names[draw], texts[draw][i], i, &stages[i].module);
        }
        ok = ok && make_pipeline(g, draw, stages);
        for (i = 0; i < 2; i++) vkDestroyShaderModule(g->device, stages[i].module, NULL);
    }
    return ok;
}

/* ---- open and close ---------------------------------------------------------------------------------------------- */

void vk_drop_swapchain(vk *g)
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
    for (i = 0; i < HBIL_MAX_TEXTURES; i++) vk_drop_image(g, &g->outputs[i]);
    for (i = 0; i < TARGETS; i++) vk_drop_image(g, &g->targets[i]);
    vkDestroyImageView(g->device, g->roughness, NULL);
    vk_drop_image(g, &g->shadow);
    vk_drop_image(g, &g->picture);
    vk_drop_buffer(g, &g->uniforms);
    vk_drop_buffer(g, &g->vertices);
    vk_drop_buffer(g, &g->text);
    vk_drop_buffer(g, &g->staging);
    for (i = 0; i < DRAWS; i++) vkDestroyPipeline(g->device, g->draws[i], NULL);
    vkDestroySampler(g->device, g->sampler, NULL);
    vkDestroyDescriptorPool(g->device, g->pool, NULL);
    vkDestroyPipelineLayout(g->device, g->layout, NULL);
    vkDestroyDescriptorSetLayout(g->device, g->set_layout, NULL);
    vk_drop_swapchain(g);
    vkDestroySemaphore(g->device, g->acquired, NULL);
    vkDestroyQueryPool(g->device, g->queries, NULL);
    vkDestroyCommandPool(g->device, g->commands, NULL);
    vkDestroyDevice(g->device, NULL);
}

void vk_close(void *gpu)
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
    return vk_make_image(g, &g->shadow, vk_target_formats[TARGET_DEPTH], SHADOW_SIZE, SHADOW_SIZE, 0, usage)
        && vk_make_buffer(g, &g->uniforms, sizeof(gpu_uniforms),
                       VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, 0)
        && vk_make_buffer(g, &g->text, TEXT_CORNERS * 3 * sizeof(float), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT, 1);
}

void *vk_open(const gpu_setup *setup, char device[128])
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

