/* runner_vk.c - the Vulkan side of runner.h: makes a device, uploads, runs hbil_vk.h, reads back.
 *
 * Takes the first discrete GPU, else an integrated one, else a virtual one, else a software device such as lavapipe;
 * HBIL_DEVICE=<part of a device name> decides otherwise. Everything waits: this measures and compares, it does not animate. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define VOLK_IMPLEMENTATION
#include <volk.h>

#define HBIL_VK_IMPLEMENTATION
#include "../../hbil.h"
#include "../../backends/hbil_vk.h"
#define HBIL_GLSLANG_IMPLEMENTATION
#include "../../backends/hbil_glslang.h"
#include "runner_internal.h"

/* An INPUT or OUTPUT of the plan, kept from call to call while its shape is the same. */
typedef struct vk_image {
    VkImage        image;
    VkDeviceMemory memory;
    VkImageView    view;
    VkFormat       format;
    uint32_t       width, height;
    VkDeviceSize   offset;                  /* of its texels in the staging buffer */
} vk_image;

typedef struct vk_device {
    VkInstance                       instance;
    VkDebugUtilsMessengerEXT         messenger;
    VkPhysicalDevice                 gpu;
    VkPhysicalDeviceMemoryProperties memory_types;
    VkDevice                         device;
    uint32_t                         family;
    int                              timestamps;
    VkQueue                          queue;
    VkCommandPool                    pool;
    VkCommandBuffer                  cmd;
    VkFence                          fence;

    hbil_vk                          backend; /* zeroed while there is none */
    vk_image                         images[HBIL_MAX_TEXTURES];
    VkBuffer                         staging;
    VkDeviceMemory                   staging_memory;
    VkDeviceSize                     staging_size;
    char                            *staged;  /* its mapping */

    int                              compiler, messages;
    char                            *error;   /* of the running call */
    size_t                           error_size;
} vk_device;

#define FAIL(d, ...) (snprintf((d)->error, (d)->error_size, __VA_ARGS__), 0)
#define ZEROED(type, name) type name; memset(&name, 0, sizeof name)
#define STRUCT(type, name, tag) ZEROED(type, name); name.sType = VK_STRUCTURE_TYPE_##tag
#define TRY(d, call, args) do {                                                                             \
        const VkResult result_ = call args;                                                                 \
        if (result_ != VK_SUCCESS) return FAIL(d, #call " returned VkResult %d", (int)result_);             \
    } while (0)

/* ------------------------------------------------------------------------------------------------------------- instance */

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    (void)severity, (void)types;
    ((vk_device *)user)->messages++;
    fprintf(stderr, "vulkan: %s\n", data->pMessage);
    return VK_FALSE;
}

static int has_validation_layer(void)
{
    VkLayerProperties layers[64];
    uint32_t count = sizeof layers / sizeof *layers;
    if (vkEnumerateInstanceLayerProperties(&count, layers) < 0) return 0;
    for (uint32_t i = 0; i < count; ++i)
        if (strcmp(layers[i].layerName, "VK_LAYER_KHRONOS_validation") == 0) return 1;
    return 0;
}

static int make_instance(vk_device *d, int validate)
{
    static const char *const layers[] = { "VK_LAYER_KHRONOS_validation" };
    static const char *const extensions[] = { VK_EXT_DEBUG_UTILS_EXTENSION_NAME, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME };
    static const VkValidationFeatureEnableEXT enables[] = { VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT };
    STRUCT(VkApplicationInfo, application, APPLICATION_INFO);
    STRUCT(VkInstanceCreateInfo, info, INSTANCE_CREATE_INFO);
    STRUCT(VkValidationFeaturesEXT, features, VALIDATION_FEATURES_EXT);
    STRUCT(VkDebugUtilsMessengerCreateInfoEXT, messenger, DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
    if (volkInitialize() != VK_SUCCESS) return FAIL(d, "no Vulkan loader: apt-get install libvulkan1");
    if (validate && !has_validation_layer()) return FAIL(d, "no validation layer: apt-get install vulkan-validationlayers");
    application.apiVersion = VK_API_VERSION_1_2;
    info.pApplicationInfo = &application;
    if (validate) {
        info.enabledLayerCount = 1;
        info.ppEnabledLayerNames = layers;
        info.enabledExtensionCount = 2;
        info.ppEnabledExtensionNames = extensions;
        info.pNext = &features;
        features.enabledValidationFeatureCount = 1;
        features.pEnabledValidationFeatures = enables;
        features.pNext = &messenger; /* for messages of vkCreateInstance and vkDestroyInstance */
        messenger.messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
        messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT |
                                VK_DEBUG_UTILS_MESSAGE_TYPE_PERFORMANCE_BIT_EXT;
        messenger.pfnUserCallback = on_message;
        messenger.pUserData = d;
    }
    const VkResult result = vkCreateInstance(&info, NULL, &d->instance);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return FAIL(d, "no Vulkan driver: apt-get install mesa-vulkan-drivers");
    if (result != VK_SUCCESS) return FAIL(d, "vkCreateInstance returned VkResult %d", (int)result);
    volkLoadInstance(d->instance);
    if (validate) TRY(d, vkCreateDebugUtilsMessengerEXT, (d->instance, &messenger, NULL, &d->messenger));
    return 1;
}

/* --------------------------------------------------------------------------------------------------------------- device */

static int find_family(vk_device *d, VkPhysicalDevice gpu)
{
    VkQueueFamilyProperties families[32];
    uint32_t count = sizeof families / sizeof *families;
    vkGetPhysicalDeviceQueueFamilyProperties(gpu, &count, families);
    for (uint32_t i = 0; i < count; ++i)
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            d->family = i;
            d->timestamps = families[i].timestampValidBits > 0;
            return 1;
        }
    return 0;
}

/* 0 is not usable; higher is better. */
static int rank(vk_device *d, VkPhysicalDevice gpu, const char *wanted, char *names, size_t names_size)
{
    static const VkPhysicalDeviceType order[] = { VK_PHYSICAL_DEVICE_TYPE_OTHER, VK_PHYSICAL_DEVICE_TYPE_CPU,
        VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU, VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU, VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU };
    VkPhysicalDeviceProperties device;
    vkGetPhysicalDeviceProperties(gpu, &device);
    const size_t used = strlen(names);
    snprintf(names + used, names_size - used, "%s%s", used > 0 ? ", " : "", device.deviceName);
    if (device.apiVersion < VK_API_VERSION_1_1 || !find_family(d, gpu)) return 0;
    if (wanted != NULL && strstr(device.deviceName, wanted) == NULL) return 0;
    int place = 0;
    while (place < 4 && order[place] != device.deviceType) ++place;
    return order[place] == device.deviceType ? place + 1 : 1;
}

static int pick_device(vk_device *d)
{
    const char *wanted = getenv("HBIL_DEVICE");
    VkPhysicalDevice gpus[16];
    uint32_t count = sizeof gpus / sizeof *gpus;
    char names[512] = "";
    int best = 0;
    if (vkEnumeratePhysicalDevices(d->instance, &count, gpus) < 0 || count == 0)
        return FAIL(d, "no Vulkan device: apt-get install mesa-vulkan-drivers");
    for (uint32_t i = 0; i < count; ++i) {
        const int ranked = rank(d, gpus[i], wanted, names, sizeof names);
        if (ranked > best) d->gpu = gpus[i];
        if (ranked > best) best = ranked;
    }
    if (best == 0 && wanted != NULL) return FAIL(d, "HBIL_DEVICE=%s is no part of a device name: there are %s", wanted, names);
    if (best == 0) return FAIL(d, "no device with Vulkan 1.1 and compute: there are %s", names);
    vkGetPhysicalDeviceMemoryProperties(d->gpu, &d->memory_types);
    return find_family(d, d->gpu);
}

static int make_device(vk_device *d)
{
    const float priority = 1;
    STRUCT(VkDeviceQueueCreateInfo, queue, DEVICE_QUEUE_CREATE_INFO);
    STRUCT(VkDeviceCreateInfo, device, DEVICE_CREATE_INFO);
    STRUCT(VkCommandPoolCreateInfo, pool, COMMAND_POOL_CREATE_INFO);
    STRUCT(VkCommandBufferAllocateInfo, cmd, COMMAND_BUFFER_ALLOCATE_INFO);
    STRUCT(VkFenceCreateInfo, fence, FENCE_CREATE_INFO);
    queue.queueFamilyIndex = d->family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queue;
    TRY(d, vkCreateDevice, (d->gpu, &device, NULL, &d->device));
    vkGetDeviceQueue(d->device, d->family, 0, &d->queue);
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = d->family;
    TRY(d, vkCreateCommandPool, (d->device, &pool, NULL, &d->pool));
    cmd.commandPool = d->pool;
    cmd.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    cmd.commandBufferCount = 1;
    TRY(d, vkAllocateCommandBuffers, (d->device, &cmd, &d->cmd));
    TRY(d, vkCreateFence, (d->device, &fence, NULL, &d->fence));
    return 1;
}

static void describe(const vk_device *d, runner_info *about)
{
    STRUCT(VkPhysicalDeviceProperties2, device, PHYSICAL_DEVICE_PROPERTIES_2);
    STRUCT(VkPhysicalDeviceDriverProperties, driver, PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    vkGetPhysicalDeviceProperties(d->gpu, &device.properties);
    const VkPhysicalDeviceProperties *p = &device.properties;
    if (p->apiVersion >= VK_API_VERSION_1_2) {
        device.pNext = &driver;
        vkGetPhysicalDeviceProperties2(d->gpu, &device);
    }
    memset(about, 0, sizeof *about);
    snprintf(about->backend, sizeof about->backend, "vulkan");
    snprintf(about->device, sizeof about->device, "%.127s", p->deviceName);
    snprintf(about->driver, sizeof about->driver, "version 0x%x", p->driverVersion);
    if (driver.driverName[0] != '\0')
        snprintf(about->driver, sizeof about->driver, "%.50s %.70s", driver.driverName, driver.driverInfo);
    if (d->timestamps) snprintf(about->timing, sizeof about->timing, "Vulkan timestamps, %g ns", (double)p->limits.timestampPeriod);
    else snprintf(about->timing, sizeof about->timing, "none: this queue has no timestamps");
}

static void drop_image(vk_device *d, vk_image *t)
{
    vkDestroyImageView(d->device, t->view, NULL);
    vkDestroyImage(d->device, t->image, NULL);
    vkFreeMemory(d->device, t->memory, NULL);
    memset(t, 0, sizeof *t);
}

static void drop_staging(vk_device *d)
{
    vkDestroyBuffer(d->device, d->staging, NULL);
    vkFreeMemory(d->device, d->staging_memory, NULL); /* unmaps it */
    d->staging = VK_NULL_HANDLE;
    d->staging_memory = VK_NULL_HANDLE;
    d->staging_size = 0;
}

static void vk_close(void *device)
{
    vk_device *d = (vk_device *)device;
    if (d->device != NULL) {
        hbil_vk_shutdown(&d->backend);
        for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(d, &d->images[t]);
        drop_staging(d);
        vkDestroyFence(d->device, d->fence, NULL);
        vkDestroyCommandPool(d->device, d->pool, NULL);
        vkDestroyDevice(d->device, NULL);
    }
    if (d->messenger != VK_NULL_HANDLE) vkDestroyDebugUtilsMessengerEXT(d->instance, d->messenger, NULL);
    if (d->instance != NULL) {
        /* Both leave a few kilobytes behind. Kept in memory, they can be named in a leak checker's suppressions. */
        dlopen("libvulkan_lvp.so", RTLD_NOW | RTLD_NODELETE | RTLD_NOLOAD);
        dlopen("libVkLayer_khronos_validation.so", RTLD_NOW | RTLD_NODELETE | RTLD_NOLOAD);
        vkDestroyInstance(d->instance, NULL);
    }
    if (d->compiler) hbil_glslang_shutdown();
    free(d);
}

static void *vk_open(int validate, runner_info *about, char *error, size_t error_size)
{
    vk_device *d = (vk_device *)calloc(1, sizeof *d);
    if (d == NULL) {
        snprintf(error, error_size, "out of memory");
        return NULL;
    }
    d->error = error;
    d->error_size = error_size;
    d->compiler = hbil_glslang_init();
    if (!d->compiler) snprintf(error, error_size, "glslang does not start: out of memory");
    if (!d->compiler || !make_instance(d, validate) || !pick_device(d) || !make_device(d)) {
        vk_close(d);
        return NULL;
    }
    describe(d, about);
    return d;
}

static int vk_messages(const void *device)
{
    return ((const vk_device *)device)->messages;
}

/* --------------------------------------------------------------------------------------------------------------- memory */

/* The first type that has all of `flags`. */
static int allocate(vk_device *d, const VkMemoryRequirements *need, VkMemoryPropertyFlags flags, VkDeviceMemory *out)
{
    STRUCT(VkMemoryAllocateInfo, info, MEMORY_ALLOCATE_INFO);
    info.allocationSize = need->size;
    for (uint32_t i = 0; i < d->memory_types.memoryTypeCount; ++i)
        if ((need->memoryTypeBits >> i & 1) && (d->memory_types.memoryTypes[i].propertyFlags & flags) == flags) {
            info.memoryTypeIndex = i;
            TRY(d, vkAllocateMemory, (d->device, &info, NULL, out));
            return 1;
        }
    return FAIL(d, "no memory type of this device has the properties 0x%x", flags);
}

static int make_image(vk_device *d, vk_image *t, VkFormat format, uint32_t width, uint32_t height, VkImageUsageFlags usage)
{
    STRUCT(VkImageCreateInfo, info, IMAGE_CREATE_INFO);
    STRUCT(VkImageViewCreateInfo, view, IMAGE_VIEW_CREATE_INFO);
    VkMemoryRequirements need;
    if (t->view != VK_NULL_HANDLE && t->format == format && t->width == width && t->height == height) return 1;
    drop_image(d, t);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent.width = width;
    info.extent.height = height;
    info.extent.depth = info.mipLevels = info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage | VK_IMAGE_USAGE_SAMPLED_BIT;
    TRY(d, vkCreateImage, (d->device, &info, NULL, &t->image));
    vkGetImageMemoryRequirements(d->device, t->image, &need);
    if (!allocate(d, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &t->memory)) return 0;
    TRY(d, vkBindImageMemory, (d->device, t->image, t->memory, 0));
    view.image = t->image;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    view.subresourceRange.levelCount = view.subresourceRange.layerCount = 1;
    TRY(d, vkCreateImageView, (d->device, &view, NULL, &t->view));
    t->format = format;
    t->width = width;
    t->height = height;
    return 1;
}

static int make_staging(vk_device *d, VkDeviceSize size)
{
    const VkMemoryPropertyFlags flags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    STRUCT(VkBufferCreateInfo, buffer, BUFFER_CREATE_INFO);
    VkMemoryRequirements need;
    void *mapped = NULL;
    if (size <= d->staging_size) return 1;
    drop_staging(d);
    buffer.size = size;
    buffer.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    TRY(d, vkCreateBuffer, (d->device, &buffer, NULL, &d->staging));
    vkGetBufferMemoryRequirements(d->device, d->staging, &need);
    /* cached memory reads back fast, but not every device has it */
    if (!allocate(d, &need, flags | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, &d->staging_memory) &&
        !allocate(d, &need, flags, &d->staging_memory)) return 0;
    TRY(d, vkBindBufferMemory, (d->device, d->staging, d->staging_memory, 0));
    TRY(d, vkMapMemory, (d->device, d->staging_memory, 0, VK_WHOLE_SIZE, 0, &mapped));
    d->staged = (char *)mapped;
    d->staging_size = size;
    return 1;
}

/* ------------------------------------------------------------------------------------------------------------- commands */

static int begin(vk_device *d)
{
    STRUCT(VkCommandBufferBeginInfo, info, COMMAND_BUFFER_BEGIN_INFO);
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    TRY(d, vkBeginCommandBuffer, (d->cmd, &info));
    return 1;
}

static int finish(vk_device *d)
{
    STRUCT(VkSubmitInfo, submit, SUBMIT_INFO);
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &d->cmd;
    TRY(d, vkEndCommandBuffer, (d->cmd));
    TRY(d, vkQueueSubmit, (d->queue, 1, &submit, d->fence));
    TRY(d, vkWaitForFences, (d->device, 1, &d->fence, VK_TRUE, UINT64_MAX));
    TRY(d, vkResetFences, (d->device, 1, &d->fence));
    return 1;
}

static void barrier(vk_device *d, VkPipelineStageFlags from, VkAccessFlags written, VkPipelineStageFlags to, VkAccessFlags access)
{
    STRUCT(VkMemoryBarrier, memory, MEMORY_BARRIER);
    memory.srcAccessMask = written;
    memory.dstAccessMask = access;
    vkCmdPipelineBarrier(d->cmd, from, to, 0, 1, &memory, 0, NULL, 0, NULL);
}

static void transition(vk_device *d, const vk_image *t, VkImageLayout before, VkImageLayout after, VkAccessFlags written,
                       VkAccessFlags access)
{
    STRUCT(VkImageMemoryBarrier, info, IMAGE_MEMORY_BARRIER);
    info.srcAccessMask = written;
    info.dstAccessMask = access;
    info.oldLayout = before;
    info.newLayout = after;
    info.srcQueueFamilyIndex = info.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    info.image = t->image;
    info.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    info.subresourceRange.levelCount = info.subresourceRange.layerCount = 1;
    vkCmdPipelineBarrier(d->cmd, VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL, 0, NULL, 1, &info);
}

static VkBufferImageCopy copy_region(const vk_image *t)
{
    ZEROED(VkBufferImageCopy, copy);
    copy.bufferOffset = t->offset;
    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = 1;
    copy.imageExtent.width = t->width;
    copy.imageExtent.height = t->height;
    copy.imageExtent.depth = 1;
    return copy;
}

/* ------------------------------------------------------------------------------------------------------------------ run */

/* Compile every pass; the words of all follow each other in `words`. */
static int compile(vk_device *d, const hbil_plan *plan, char *text, uint32_t *words, size_t cap_words, hbil_vk_info *info)
{
    char log[512];
    size_t used = 0;
    for (uint32_t p = 0; p < plan->pass_count; ++p) {
        size_t need = 0;
        const hbil_result emitted = hbil_emit_glsl(plan, (int32_t)p, text, HBIL_GLSL_MAX, NULL);
        if (emitted != HBIL_OK) return FAIL(d, "pass %s: %s", plan->passes[p].name, hbil_result_name(emitted));
        const hbil_glslang_result result = hbil_glslang_compile(text, (hbil_target)plan->config.target, words + used,
                                                                cap_words - used, &need, log, sizeof log);
        if (result == HBIL_GLSLANG_E_SPACE)
            return FAIL(d, "pass %s: more than %u words of SPIR-V", plan->passes[p].name, (unsigned)cap_words);
        if (result != HBIL_GLSLANG_OK) return FAIL(d, "pass %s does not compile: %s", plan->passes[p].name, log);
        info->spirv[p].words = words + used;
        info->spirv[p].count = need;
        used += need;
    }
    return 1;
}

static int set_plan(vk_device *d, const hbil_plan *plan)
{
    enum { CAP_WORDS = 1 << 18 };
    ZEROED(hbil_vk_info, info);
    if (memcmp(&d->backend.plan, plan, sizeof *plan) == 0) return 1;
    hbil_vk_shutdown(&d->backend);
    for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(d, &d->images[t]); /* an input there may be an output here */
    char *text = (char *)malloc(HBIL_GLSL_MAX);
    uint32_t *words = (uint32_t *)malloc(CAP_WORDS * sizeof *words);
    int ok = text != NULL && words != NULL ? compile(d, plan, text, words, CAP_WORDS, &info) : FAIL(d, "out of memory");
    if (ok) {
        info.instance = d->instance;
        info.physical_device = d->gpu;
        info.device = d->device;
        info.queue_family = d->family;
        info.get_proc = vkGetInstanceProcAddr;
        info.plan = plan;
        info.input_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
        info.timestamps = d->timestamps;
        ok = hbil_vk_init(&info, &d->backend) == HBIL_VK_OK || FAIL(d, "%s", d->backend.message);
    }
    free(words);
    free(text);
    return ok;
}

static int output_channels(VkFormat format)
{
    return format == VK_FORMAT_R32_SFLOAT ? 1 : format == VK_FORMAT_R32G32B32A32_SFLOAT ? 4 : 0;
}

/* Images of the plan's inputs and outputs, places in the staging buffer, and the images that the caller gets. */
static int set_images(vk_device *d, const hbil_plan *plan, uint32_t width, uint32_t height, const image *inputs, image *outputs)
{
    VkImageView views[HBIL_MAX_TEXTURES];
    VkDeviceSize size = 0;
    memset(views, 0, sizeof views);
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        const hbil_texture *tex = &plan->textures[i];
        vk_image *t = &d->images[i];
        uint32_t extent[2] = { (uint32_t)inputs[i].width, (uint32_t)inputs[i].height };
        VkFormat format = inputs[i].channels == 1 ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
        VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        if (tex->life != HBIL_LIFE_INPUT && tex->life != HBIL_LIFE_OUTPUT) continue;
        if (tex->life == HBIL_LIFE_OUTPUT) {
            format = hbil_vk_format((hbil_format)tex->format);
            usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
            if (output_channels(format) == 0) return FAIL(d, "output %s does not hold floats", tex->name);
            if (hbil_plan_extent(plan, (int32_t)i, width, height, extent) != HBIL_OK ||
                !image_make(&outputs[i], (int)extent[0], (int)extent[1], output_channels(format)))
                return FAIL(d, "output %s cannot be made for a frame of %ux%u", tex->name, width, height);
        }
        if (!make_image(d, t, format, extent[0], extent[1], usage)) return 0;
        views[i] = t->view;
        t->offset = size;
        size += (VkDeviceSize)t->width * t->height * 4 * sizeof(float); /* room for four channels keeps offsets aligned */
    }
    if (!make_staging(d, size)) return 0;
    return hbil_vk_resize(&d->backend, width, height, views) == HBIL_VK_OK || FAIL(d, "%s", d->backend.message);
}

/* One or four floats a texel: rgb formats are not texture formats on most devices. */
static void stage(char *to, const image *in)
{
    const size_t texels = (size_t)in->width * (size_t)in->height, channels = (size_t)in->channels;
    const size_t stride = (channels == 1 ? 1 : 4) * sizeof(float);
    for (size_t i = 0; i < texels; ++i) {
        memset(to + i * stride, 0, stride);
        memcpy(to + i * stride, in->data + i * channels, channels * sizeof(float));
    }
}

static int upload(vk_device *d, const hbil_plan *plan, const image *inputs)
{
    if (!begin(d)) return 0;
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        const vk_image *t = &d->images[i];
        const VkBufferImageCopy copy = copy_region(t);
        if (plan->textures[i].life == HBIL_LIFE_INPUT) {
            stage(d->staged + t->offset, &inputs[i]);
            transition(d, t, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0, VK_ACCESS_TRANSFER_WRITE_BIT);
            vkCmdCopyBufferToImage(d->cmd, d->staging, t->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
            transition(d, t, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                       VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_SHADER_READ_BIT);
        } else if (plan->textures[i].life == HBIL_LIFE_OUTPUT) {
            transition(d, t, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, 0, VK_ACCESS_SHADER_WRITE_BIT);
        }
    }
    return finish(d);
}

static int execute(vk_device *d, const hbil_frame *frame, double *ms)
{
    if (!begin(d)) return 0;
    /* outputs are ours to guard: the run before wrote them */
    barrier(d, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
            VK_ACCESS_SHADER_WRITE_BIT);
    if (hbil_vk_record(&d->backend, d->cmd, frame) != HBIL_VK_OK) return FAIL(d, "%s", d->backend.message);
    if (!finish(d)) return 0;
    return ms == NULL || hbil_vk_timings(&d->backend, ms) == HBIL_VK_OK || FAIL(d, "%s", d->backend.message);
}

static int read_back(vk_device *d, const hbil_plan *plan, image *outputs)
{
    if (!begin(d)) return 0;
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        const vk_image *t = &d->images[i];
        const VkBufferImageCopy copy = copy_region(t);
        if (plan->textures[i].life != HBIL_LIFE_OUTPUT) continue;
        transition(d, t, VK_IMAGE_LAYOUT_GENERAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_ACCESS_TRANSFER_READ_BIT);
        vkCmdCopyImageToBuffer(d->cmd, t->image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, d->staging, 1, &copy);
    }
    barrier(d, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    if (!finish(d)) return 0;
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        image *out = &outputs[i];
        const size_t bytes = (size_t)out->width * (size_t)out->height * (size_t)out->channels * sizeof(float);
        if (plan->textures[i].life == HBIL_LIFE_OUTPUT) memcpy(out->data, d->staged + d->images[i].offset, bytes);
    }
    return 1;
}

static int vk_run(void *device, const hbil_plan *plan, const hbil_frame *frame, const image inputs[HBIL_MAX_TEXTURES],
                  image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    vk_device *d = (vk_device *)device;
    const uint32_t width = frame->width != 0 ? frame->width : (uint32_t)plan->config.width;
    const uint32_t height = frame->height != 0 ? frame->height : (uint32_t)plan->config.height;
    d->error = error;
    d->error_size = error_size;
    if (!set_plan(d, plan) || !set_images(d, plan, width, height, inputs, outputs) || !upload(d, plan, inputs)) return 0;
    for (int i = 0; i < repeat; ++i)
        if (!execute(d, frame, ms != NULL ? ms + (size_t)i * plan->pass_count : NULL)) return 0;
    return read_back(d, plan, outputs);
}

const runner_ops runner_vulkan = { vk_open, vk_close, vk_messages, vk_run };
