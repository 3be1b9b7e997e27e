/* runner_vk.c - the Vulkan side of runner.h: makes a device, uploads, runs hbil_vk.h, reads back.
 *
 * Takes the first discrete GPU, else an integrated one, else a virtual one, else a software device such as lavapipe;
 * HBIL_DEVICE=<part of a device name> decides otherwise. Everything waits: this measures and compares, it does not animate. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifndef VOLK_H_ /* else who includes this file has it, with what stands between, see tests/faults */
#define VOLK_IMPLEMENTATION
#include <volk.h>
#endif

#define HBIL_VK_IMPLEMENTATION
#include "../../hbil.h"
#include "../../backends/hbil_vk.h"
#include "../../backends/hbil_glslang.h"
#include "runner_internal.h"

/* What a texture is made of. slices: layers, faces or z. */
typedef struct vk_shape {
    VkFormat format;
    uint32_t width, height, slices;
    uint16_t dim;                           /* hbil_dim */
} vk_shape;

/* An INPUT or OUTPUT of the plan, kept from call to call while its shape is the same. */
typedef struct vk_image {
    VkImage        image;
    VkDeviceMemory memory;
    VkImageView    view;
    vk_shape       shape;
    VkDeviceSize   offset;                  /* of its texels in the staging buffer */
} vk_image;

/* The shader that fills multisampled textures from the staging buffer, made when first needed. */
typedef struct vk_spread {
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout      layout;
    VkPipeline            pipeline;
    VkDescriptorPool      pool;
} vk_spread;

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
    int                              multisample; /* shaders may store into multisampled images */
    vk_spread                        spread;

    int                              compiler, messages;
    int                              lost;    /* the device is */
    const char                      *hook;
    const char                      *own_pass, *own_text; /* instead of what hbil.h emits */
    const runner_spirv              *spirv;   /* instead of all of it, see runner_words */
    char                            *error;   /* of the running call */
    size_t                           error_size;
} vk_device;

#define FAIL(d, ...) (snprintf((d)->error, (d)->error_size, __VA_ARGS__), 0)
#define ZEROED(type, name) type name; memset(&name, 0, sizeof name)
#define STRUCT(type, name, tag) ZEROED(type, name); name.sType = VK_STRUCTURE_TYPE_##tag
#define TRY(d, call, args) do {                                                                             \
        const VkResult result_ = call args;                                                                 \
        if (result_ != VK_SUCCESS) return failed(d, #call, result_);                                        \
    } while (0)
/* The same for one that makes *(out): a call that fails may leave anything there. */
#define MAKE(d, call, out, args) do {                                                                       \
        const VkResult result_ = call args;                                                                 \
        if (result_ != VK_SUCCESS) *(out) = VK_NULL_HANDLE;                                                 \
        if (result_ != VK_SUCCESS) return failed(d, #call, result_);                                        \
    } while (0)

static int failed(vk_device *d, const char *call, VkResult result)
{
    d->lost |= result == VK_ERROR_DEVICE_LOST;
    return FAIL(d, "%s returned VkResult %d: %s", call, (int)result, hbil_vk__why(result));
}

/* ------------------------------------------------------------------------------------------------------------- instance */

/* Messages of the layer that are none of ours, each with the reason. Newer layers leave out UNASSIGNED-. All else counts. */
static const struct { const char *id, *why; } excused[] = {
    { "BestPractices-vkCreateInstance-specialuse-extension-debugging",
      "VK_EXT_debug_utils and VK_EXT_validation_features are on because validation was asked for" },
    { "BestPractices-vkAllocateMemory-small-allocation",
      "this program's inputs and outputs are an allocation each, as an engine's may be; what hbil_vk.h makes shares one, and its "
      "uniform block of some hundred bytes has another, since it does not go with the size" },
    { "BestPractices-vkBindMemory-small-dedicated-allocation", "the same, seen from the image or buffer" },
};
enum { EXCUSED = sizeof excused / sizeof *excused };
static int excused_seen[EXCUSED]; /* by any runner; the tests ask whether a row is still needed */

/* Row of a message, -1: it counts. */
static int excuse_of(const char *id)
{
    static const char old[] = "UNASSIGNED-";
    if (id != NULL && strncmp(id, old, sizeof old - 1) == 0) id += sizeof old - 1;
    for (int i = 0; id != NULL && i < EXCUSED; ++i)
        if (strcmp(excused[i].id, id) == 0) return i;
    return -1;
}

static VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                                 VkDebugUtilsMessageTypeFlagsEXT types,
                                                 const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
    const int excuse = excuse_of(data->pMessageIdName);
    (void)severity, (void)types;
    if (excuse >= 0) excused_seen[excuse]++;
    if (excuse >= 0) return VK_FALSE;
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
    static const VkValidationFeatureEnableEXT enables[] = { VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT,
                                                            VK_VALIDATION_FEATURE_ENABLE_BEST_PRACTICES_EXT };
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
        features.enabledValidationFeatureCount = sizeof enables / sizeof *enables;
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
    if (result != VK_SUCCESS) d->instance = NULL;
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER) return FAIL(d, "no Vulkan driver: apt-get install mesa-vulkan-drivers");
    if (result == VK_ERROR_LAYER_NOT_PRESENT || result == VK_ERROR_EXTENSION_NOT_PRESENT)
        return FAIL(d, "vkCreateInstance returned VkResult %d: no validation layer, or one too old: apt-get install "
                    "vulkan-validationlayers, or go without validation", (int)result);
    if (result != VK_SUCCESS) return failed(d, "vkCreateInstance", result);
    volkLoadInstance(d->instance);
    if (validate) MAKE(d, vkCreateDebugUtilsMessengerEXT, &d->messenger, (d->instance, &messenger, NULL, &d->messenger));
    return 1;
}

/* --------------------------------------------------------------------------------------------------------------- device */

static int find_family(vk_device *d, VkPhysicalDevice gpu)
{
    VkQueueFamilyProperties families[32];
    const uint32_t room = sizeof families / sizeof *families;
    uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(gpu, &count, NULL);
    if (count > room) count = room;
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
    const uint32_t room = sizeof gpus / sizeof *gpus;
    uint32_t count = 0;
    char names[512] = "";
    int best = 0;
    TRY(d, vkEnumeratePhysicalDevices, (d->instance, &count, NULL));
    if (count > room) count = room;
    const VkResult listed = vkEnumeratePhysicalDevices(d->instance, &count, gpus);
    if (listed < 0) return failed(d, "vkEnumeratePhysicalDevices", listed);
    if (count == 0) return FAIL(d, "no Vulkan device: apt-get install mesa-vulkan-drivers");
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
    ZEROED(VkPhysicalDeviceFeatures, features);
    ZEROED(VkPhysicalDeviceFeatures, wanted);
    vkGetPhysicalDeviceFeatures(d->gpu, &features);
    wanted.shaderStorageImageMultisample = features.shaderStorageImageMultisample; /* for inputs of ours, not for hbil_vk.h */
    d->multisample = features.shaderStorageImageMultisample != 0;
    device.pEnabledFeatures = &wanted;
    MAKE(d, vkCreateDevice, &d->device, (d->gpu, &device, NULL, &d->device));
    vkGetDeviceQueue(d->device, d->family, 0, &d->queue);
    pool.queueFamilyIndex = d->family;
    MAKE(d, vkCreateCommandPool, &d->pool, (d->device, &pool, NULL, &d->pool));
    cmd.commandPool = d->pool;
    cmd.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    cmd.commandBufferCount = 1;
    TRY(d, vkAllocateCommandBuffers, (d->device, &cmd, &d->cmd));
    MAKE(d, vkCreateFence, &d->fence, (d->device, &fence, NULL, &d->fence));
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

static void drop_spread(vk_device *d)
{
    vkDestroyPipeline(d->device, d->spread.pipeline, NULL);
    vkDestroyPipelineLayout(d->device, d->spread.layout, NULL);
    vkDestroyDescriptorPool(d->device, d->spread.pool, NULL);
    vkDestroyDescriptorSetLayout(d->device, d->spread.set_layout, NULL);
    memset(&d->spread, 0, sizeof d->spread);
}

static void vk_close(void *device)
{
    vk_device *d = (vk_device *)device;
    if (d->device != NULL) {
        hbil_vk_shutdown(&d->backend);
        for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(d, &d->images[t]);
        drop_staging(d);
        drop_spread(d);
        vkDestroyFence(d->device, d->fence, NULL);
        vkDestroyCommandPool(d->device, d->pool, NULL);
        vkDestroyDevice(d->device, NULL);
    }
    if (d->messenger != VK_NULL_HANDLE) { /* volk's pointer is of the instance made last, which may have none */
        const PFN_vkDestroyDebugUtilsMessengerEXT destroy =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(d->instance, "vkDestroyDebugUtilsMessengerEXT");
        if (destroy != NULL) destroy(d->instance, d->messenger, NULL);
    }
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
            MAKE(d, vkAllocateMemory, out, (d->device, &info, NULL, out));
            return 1;
        }
    return FAIL(d, "no memory type of this device has the properties 0x%x", flags);
}

/* Can the device do with such an image what this program does with it? */
static int check_shape(vk_device *d, const char *name, const vk_shape *s, const VkImageCreateInfo *info)
{
    VkImageFormatProperties can;
    VkFormatProperties format;
    vkGetPhysicalDeviceFormatProperties(d->gpu, s->format, &format);
    if ((s->dim == HBIL_DIM_CUBE || s->dim == HBIL_DIM_3D) &&
        !(format.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT))
        return FAIL(d, "input %s: this device does not filter 32-bit floats. Use another one, or the gl backend", name);
    if (s->dim == HBIL_DIM_2D_MULTISAMPLE && !d->multisample)
        return FAIL(d, "input %s: this device does not store into multisampled images. Set multisample=no, or use the gl backend",
                    name);
    if (vkGetPhysicalDeviceImageFormatProperties(d->gpu, info->format, info->imageType, info->tiling, info->usage, info->flags,
                                                 &can) != VK_SUCCESS || !(can.sampleCounts & info->samples) ||
        can.maxExtent.width < info->extent.width || can.maxExtent.height < info->extent.height ||
        can.maxExtent.depth < info->extent.depth || can.maxArrayLayers < info->arrayLayers)
        return FAIL(d, "%s: this device has no images of %ux%ux%u floats in that shape. Make it smaller", name, s->width,
                    s->height, s->slices);
    return 1;
}

static VkImageCreateInfo image_info(const vk_shape *s, VkImageUsageFlags usage)
{
    STRUCT(VkImageCreateInfo, info, IMAGE_CREATE_INFO);
    info.imageType = s->dim == HBIL_DIM_3D ? VK_IMAGE_TYPE_3D : VK_IMAGE_TYPE_2D;
    info.flags = s->dim == HBIL_DIM_CUBE ? VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT : 0;
    info.format = s->format;
    info.extent.width = s->width;
    info.extent.height = s->height;
    info.extent.depth = s->dim == HBIL_DIM_3D ? s->slices : 1;
    info.mipLevels = 1;
    info.arrayLayers = s->dim == HBIL_DIM_3D ? 1 : s->slices;
    info.samples = s->dim == HBIL_DIM_2D_MULTISAMPLE ? (VkSampleCountFlagBits)RUNNER_SAMPLES : VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage | VK_IMAGE_USAGE_SAMPLED_BIT;
    return info;
}

static int make_image(vk_device *d, vk_image *t, const char *name, const vk_shape *s, VkImageUsageFlags usage)
{
    static const VkImageViewType types[] = { VK_IMAGE_VIEW_TYPE_2D, VK_IMAGE_VIEW_TYPE_2D, VK_IMAGE_VIEW_TYPE_2D,
                                             VK_IMAGE_VIEW_TYPE_2D_ARRAY, VK_IMAGE_VIEW_TYPE_CUBE, VK_IMAGE_VIEW_TYPE_3D };
    const vk_shape *old = &t->shape;
    const VkImageCreateInfo info = image_info(s, usage);
    STRUCT(VkImageViewCreateInfo, view, IMAGE_VIEW_CREATE_INFO);
    VkMemoryRequirements need;
    if (t->view != VK_NULL_HANDLE && old->format == s->format && old->width == s->width && old->height == s->height &&
        old->slices == s->slices && old->dim == s->dim) return 1;
    drop_image(d, t);
    if (!check_shape(d, name, s, &info)) return 0;
    MAKE(d, vkCreateImage, &t->image, (d->device, &info, NULL, &t->image));
    vkGetImageMemoryRequirements(d->device, t->image, &need);
    if (!allocate(d, &need, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &t->memory)) return 0;
    TRY(d, vkBindImageMemory, (d->device, t->image, t->memory, 0));
    view.image = t->image;
    view.viewType = types[s->dim];
    view.format = s->format;
    view.subresourceRange.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    view.subresourceRange.levelCount = 1;
    view.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    MAKE(d, vkCreateImageView, &t->view, (d->device, &view, NULL, &t->view));
    t->shape = *s;
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
    buffer.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
    MAKE(d, vkCreateBuffer, &d->staging, (d->device, &buffer, NULL, &d->staging));
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
    TRY(d, vkResetCommandPool, (d->device, d->pool, 0)); /* its buffer may still be in recording, after a run that failed */
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
    info.subresourceRange.levelCount = 1;
    info.subresourceRange.layerCount = VK_REMAINING_ARRAY_LAYERS;
    vkCmdPipelineBarrier(d->cmd, VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                         VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0, 0, NULL, 0, NULL, 1, &info);
}

static VkBufferImageCopy copy_region(const vk_image *t)
{
    ZEROED(VkBufferImageCopy, copy);
    copy.bufferOffset = t->offset;
    copy.imageSubresource.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT;
    copy.imageSubresource.layerCount = t->shape.dim == HBIL_DIM_3D ? 1 : t->shape.slices;
    copy.imageExtent.width = t->shape.width;
    copy.imageExtent.height = t->shape.height;
    copy.imageExtent.depth = t->shape.dim == HBIL_DIM_3D ? t->shape.slices : 1;
    return copy;
}

/* ------------------------------------------------------------------------------------------------------------------ run */

enum { CAP_TEXT = 2 * HBIL_GLSL_MAX }; /* room for a hook */

/* Compile every pass; the words of all follow each other in `words`. */
static int compile(vk_device *d, const hbil_plan *plan, char *text, uint32_t *words, size_t cap_words, hbil_vk_info *info)
{
    char log[512];
    size_t used = 0;
    for (uint32_t p = 0; p < plan->pass_count; ++p) {
        size_t need = 0;
        ZEROED(hbil_diag, diag);
        hbil_diags diags = { &diag, 1, 0 };
        const int own = d->own_text != NULL && strcmp(plan->passes[p].name, d->own_pass) == 0;
        const hbil_result emitted = hbil_emit_glsl_hook(plan, (int32_t)p, d->hook, text, CAP_TEXT, NULL, &diags);
        if (emitted != HBIL_OK)
            return FAIL(d, "pass %s: %s", plan->passes[p].name, diags.count > 0 ? diag.text : hbil_result_name(emitted));
        const hbil_glslang_result result = hbil_glslang_compile(own ? d->own_text : text, (hbil_target)plan->config.target,
                                                                words + used, cap_words - used, &need, log, sizeof log);
        if (result == HBIL_GLSLANG_E_SPACE)
            return FAIL(d, "pass %s: more than %u words of SPIR-V", plan->passes[p].name, (unsigned)cap_words);
        if (result != HBIL_GLSLANG_OK) return FAIL(d, "pass %s does not compile: %s", plan->passes[p].name, log);
        info->spirv[p].words = words + used;
        info->spirv[p].count = need;
        used += need;
    }
    return 1;
}

/* Takes the caller's words as they are. */
static void take_words(const runner_spirv *from, const hbil_plan *plan, hbil_vk_info *info)
{
    for (uint32_t p = 0; p < plan->pass_count; ++p) {
        info->spirv[p].words = from->words[p];
        info->spirv[p].count = from->counts[p];
        info->spirv[p].entry = from->entries[p];
    }
}

/* An input that a pass has as a storage image, as only a plan of the caller's own does. */
static int is_stored(const hbil_plan *plan, uint32_t texture)
{
    for (uint32_t p = 0; p < plan->pass_count; ++p)
        for (uint32_t b = 0; b < plan->passes[p].binding_count; ++b) {
            const hbil_binding *binding = &plan->passes[p].bindings[b];
            if (binding->texture == texture && binding->access == HBIL_ACCESS_WRITE) return 1;
        }
    return 0;
}

static VkImageLayout input_layout(const hbil_plan *plan)
{
    for (uint32_t t = 0; t < plan->texture_count; ++t)
        if (plan->textures[t].life == HBIL_LIFE_INPUT && is_stored(plan, t)) return VK_IMAGE_LAYOUT_GENERAL;
    return VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
}

static int set_plan(vk_device *d, const hbil_plan *plan)
{
    enum { CAP_WORDS = 1 << 18 };
    ZEROED(hbil_vk_info, info);
    if (memcmp(&d->backend.plan, plan, sizeof *plan) == 0) return 1;
    hbil_vk_shutdown(&d->backend);
    for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(d, &d->images[t]); /* an input there may be an output here */
    char *text = (char *)malloc(CAP_TEXT);
    uint32_t *words = (uint32_t *)malloc(CAP_WORDS * sizeof *words);
    int ok = text != NULL && words != NULL ? 1 : FAIL(d, "out of memory");
    if (ok && d->spirv != NULL) take_words(d->spirv, plan, &info);
    else if (ok) ok = compile(d, plan, text, words, CAP_WORDS, &info);
    if (ok) {
        info.instance = d->instance;
        info.physical_device = d->gpu;
        info.device = d->device;
        info.queue_family = d->family;
        info.get_proc = vkGetInstanceProcAddr;
        info.plan = plan;
        info.input_layout = input_layout(plan);
        info.timestamps = d->timestamps;
        ok = hbil_vk_init(&info, &d->backend) == HBIL_VK_OK || FAIL(d, "%s", d->backend.message);
    }
    free(words);
    free(text);
    return ok;
}

/* A plan for tests may make OUTPUTs of its transient textures: the bits of unsigned ones are kept as they are. */
static int output_channels(VkFormat format)
{
    return format == VK_FORMAT_R32_SFLOAT || format == VK_FORMAT_R32_UINT ? 1 : format == VK_FORMAT_R32G32B32A32_SFLOAT ? 4 : 0;
}

/* The shape of an INPUT or OUTPUT; makes the image that the caller gets of an OUTPUT. */
static int shape_of(vk_device *d, const hbil_plan *plan, uint32_t i, const uint32_t size[2], const image *in, image *out,
                    vk_shape *s)
{
    const hbil_texture *tex = &plan->textures[i];
    uint32_t extent[2] = { 0, 0 };
    memset(s, 0, sizeof *s);
    s->dim = tex->dim;
    if (tex->life == HBIL_LIFE_INPUT) {
        const int single = in->channels == 1 && tex->dim != HBIL_DIM_2D_MULTISAMPLE; /* spread() stores four */
        s->format = single ? VK_FORMAT_R32_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT;
        s->width = (uint32_t)in->width;
        s->height = (uint32_t)in->height;
        s->slices = (uint32_t)image_slices(in);
        return 1;
    }
    s->format = hbil_vk_format((hbil_format)tex->format);
    if (output_channels(s->format) == 0) return FAIL(d, "output %s has no format that can be read back", tex->name);
    if (hbil_plan_extent(plan, (int32_t)i, size[0], size[1], extent) != HBIL_OK ||
        !image_make_slices(out, (int)extent[0], (int)extent[1], tex->layers, output_channels(s->format)))
        return FAIL(d, "output %s cannot be made for a frame of %ux%u", tex->name, size[0], size[1]);
    s->width = extent[0];
    s->height = extent[1];
    s->slices = tex->layers;
    return 1;
}

/* Images of the plan's inputs and outputs, places in the staging buffer, and the images that the caller gets. */
static int set_images(vk_device *d, const hbil_plan *plan, const uint32_t size[2], const image *inputs, image *outputs)
{
    VkImageView views[HBIL_MAX_TEXTURES];
    VkExtent3D extents[HBIL_MAX_TEXTURES];
    VkDeviceSize used = 0;
    memset(views, 0, sizeof views);
    memset(extents, 0, sizeof extents);
    for (uint32_t i = 0; i < plan->texture_count; ++i) {
        const hbil_texture *tex = &plan->textures[i];
        vk_image *t = &d->images[i];
        vk_shape shape;
        VkImageUsageFlags usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        if (tex->life != HBIL_LIFE_INPUT && tex->life != HBIL_LIFE_OUTPUT) continue;
        if (!shape_of(d, plan, i, size, &inputs[i], &outputs[i], &shape)) return 0;
        if (tex->life == HBIL_LIFE_OUTPUT) usage = VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_STORAGE_BIT;
        else if (is_stored(plan, i)) usage |= VK_IMAGE_USAGE_STORAGE_BIT;
        if (shape.dim == HBIL_DIM_2D_MULTISAMPLE) usage = VK_IMAGE_USAGE_STORAGE_BIT;
        if (!make_image(d, t, tex->name, &shape, usage)) return 0;
        views[i] = t->view;
        extents[i].width = shape.width;
        extents[i].height = shape.height;
        extents[i].depth = shape.slices;
        t->offset = used;
        /* room for four channels keeps offsets aligned, even for a storage buffer */
        used += ((VkDeviceSize)shape.width * shape.height * shape.slices * 4 * sizeof(float) + 255) / 256 * 256;
    }
    if (!make_staging(d, used)) return 0;
    d->backend.extents = extents;
    return hbil_vk_resize(&d->backend, size[0], size[1], views) == HBIL_VK_OK || FAIL(d, "%s", d->backend.message);
}

/* One or four floats a texel: rgb formats are not texture formats on most devices. */
static void stage(char *to, const image *in, VkFormat format)
{
    const size_t texels = (size_t)in->width * (size_t)in->height * (size_t)image_slices(in), channels = (size_t)in->channels;
    const size_t stride = (format == VK_FORMAT_R32_SFLOAT ? 1 : 4) * sizeof(float);
    for (size_t i = 0; i < texels; ++i) {
        memset(to + i * stride, 0, stride);
        memcpy(to + i * stride, in->data + i * channels, channels * sizeof(float));
    }
}

/* ------------------------------------------------------------------------------------------------- multisampled inputs */

static int make_spread_layout(vk_device *d)
{
    const VkDescriptorPoolSize sizes[2] = { { VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, HBIL_MAX_TEXTURES },
                                            { VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, HBIL_MAX_TEXTURES } };
    const VkPushConstantRange range = { VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof(int32_t) };
    VkDescriptorSetLayoutBinding bindings[2];
    STRUCT(VkDescriptorSetLayoutCreateInfo, set, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    STRUCT(VkPipelineLayoutCreateInfo, layout, PIPELINE_LAYOUT_CREATE_INFO);
    STRUCT(VkDescriptorPoolCreateInfo, pool, DESCRIPTOR_POOL_CREATE_INFO);
    memset(bindings, 0, sizeof bindings);
    for (uint32_t i = 0; i < 2; ++i) {
        bindings[i].binding = i;
        bindings[i].descriptorType = sizes[i].type;
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    set.bindingCount = 2;
    set.pBindings = bindings;
    MAKE(d, vkCreateDescriptorSetLayout, &d->spread.set_layout, (d->device, &set, NULL, &d->spread.set_layout));
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &d->spread.set_layout;
    layout.pushConstantRangeCount = 1;
    layout.pPushConstantRanges = &range;
    MAKE(d, vkCreatePipelineLayout, &d->spread.layout, (d->device, &layout, NULL, &d->spread.layout));
    pool.maxSets = HBIL_MAX_TEXTURES;
    pool.poolSizeCount = 2;
    pool.pPoolSizes = sizes;
    MAKE(d, vkCreateDescriptorPool, &d->spread.pool, (d->device, &pool, NULL, &d->spread.pool));
    return 1;
}

static int make_spread_pipeline(vk_device *d)
{
    enum { WORDS = 4096 };
    static const char *const text = "#version 450\n"
        "layout(local_size_x = 8, local_size_y = 8) in;\n"
        "layout(set = 0, binding = 0, std430) readonly buffer from { vec4 u_from[]; };\n"
        "layout(set = 0, binding = 1, rgba32f) uniform writeonly image2DMS u_to;\n"
        "layout(push_constant) uniform block { int SAMPLE; };\n"
        "void main() {\n"
        "    ivec2 p = ivec2(gl_GlobalInvocationID.xy), size = imageSize(u_to);\n"
        "    if (any(greaterThanEqual(p, size))) return;\n"
        "    for (int i = 0; i < imageSamples(u_to); ++i)\n"
        "        imageStore(u_to, p, i, i == SAMPLE ? u_from[p.y * size.x + p.x] : vec4(7e7));\n"
        "}\n";
    uint32_t words[WORDS];
    size_t need = 0;
    char log[256];
    STRUCT(VkShaderModuleCreateInfo, module, SHADER_MODULE_CREATE_INFO);
    STRUCT(VkComputePipelineCreateInfo, pipeline, COMPUTE_PIPELINE_CREATE_INFO);
    if (hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, WORDS, &need, log, sizeof log) != HBIL_GLSLANG_OK)
        return FAIL(d, "multisampled inputs: %s", log);
    module.codeSize = need * sizeof *words;
    module.pCode = words;
    pipeline.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    pipeline.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    pipeline.stage.pName = "main";
    pipeline.layout = d->spread.layout;
    TRY(d, vkCreateShaderModule, (d->device, &module, NULL, &pipeline.stage.module));
    const VkResult made = vkCreateComputePipelines(d->device, VK_NULL_HANDLE, 1, &pipeline, NULL, &d->spread.pipeline);
    vkDestroyShaderModule(d->device, pipeline.stage.module, NULL);
    if (made == VK_SUCCESS) return 1;
    d->spread.pipeline = VK_NULL_HANDLE;
    return failed(d, "multisampled inputs: vkCreateComputePipelines", made);
}

/* Record: texels of the staging buffer to one sample of an image in GENERAL, garbage to the others. A shader does it: image
 * stores reach single samples, which copies do not. */
static int spread(vk_device *d, const vk_image *t, int32_t sample)
{
    const VkDeviceSize bytes = (VkDeviceSize)t->shape.width * t->shape.height * 4 * sizeof(float);
    const VkDescriptorBufferInfo buffer = { d->staging, t->offset, bytes };
    const VkDescriptorImageInfo to = { VK_NULL_HANDLE, t->view, VK_IMAGE_LAYOUT_GENERAL };
    VkDescriptorSet set = VK_NULL_HANDLE;
    VkWriteDescriptorSet writes[2];
    STRUCT(VkDescriptorSetAllocateInfo, info, DESCRIPTOR_SET_ALLOCATE_INFO);
    info.descriptorPool = d->spread.pool;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &d->spread.set_layout;
    TRY(d, vkAllocateDescriptorSets, (d->device, &info, &set));
    memset(writes, 0, sizeof writes);
    for (uint32_t i = 0; i < 2; ++i) {
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = set;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
    }
    writes[0].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    writes[0].pBufferInfo = &buffer;
    writes[1].descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
    writes[1].pImageInfo = &to;
    vkUpdateDescriptorSets(d->device, 2, writes, 0, NULL);
    vkCmdBindPipeline(d->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, d->spread.pipeline);
    vkCmdBindDescriptorSets(d->cmd, VK_PIPELINE_BIND_POINT_COMPUTE, d->spread.layout, 0, 1, &set, 0, NULL);
    vkCmdPushConstants(d->cmd, d->spread.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof sample, &sample);
    vkCmdDispatch(d->cmd, (t->shape.width + 7) / 8, (t->shape.height + 7) / 8, 1);
    return 1;
}

/* Sets of the last upload are free again: it has been waited for. */
static int start_spread(vk_device *d)
{
    if (d->spread.pipeline == VK_NULL_HANDLE) {
        drop_spread(d);
        if (!make_spread_layout(d) || !make_spread_pipeline(d)) return 0;
    }
    TRY(d, vkResetDescriptorPool, (d->device, d->spread.pool, 0));
    return 1;
}

/* ----------------------------------------------------------------------------------------------------------- frame by frame */

static int upload_one(vk_device *d, const hbil_plan *plan, uint32_t i, const image *in)
{
    const vk_image *t = &d->images[i];
    const VkBufferImageCopy copy = copy_region(t);
    const int samples = plan->textures[i].dim == HBIL_DIM_2D_MULTISAMPLE;
    const VkImageLayout fill = samples ? VK_IMAGE_LAYOUT_GENERAL : VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    const VkAccessFlags access = samples ? VK_ACCESS_SHADER_WRITE_BIT : VK_ACCESS_TRANSFER_WRITE_BIT;
    stage(d->staged + t->offset, in, t->shape.format);
    transition(d, t, VK_IMAGE_LAYOUT_UNDEFINED, fill, 0, access);
    if (!samples) vkCmdCopyBufferToImage(d->cmd, d->staging, t->image, fill, 1, &copy);
    else if (!spread(d, t, plan->config.sample)) return 0;
    transition(d, t, fill, input_layout(plan), access, VK_ACCESS_SHADER_READ_BIT);
    return 1;
}

static int upload(vk_device *d, const hbil_plan *plan, const image *inputs)
{
    int ok = 1;
    if (plan->config.multisample == HBIL_MULTISAMPLE_YES && !start_spread(d)) return 0;
    if (!begin(d)) return 0;
    for (uint32_t i = 0; i < plan->texture_count && ok; ++i) {
        if (plan->textures[i].life == HBIL_LIFE_INPUT) ok = upload_one(d, plan, i, &inputs[i]);
        if (plan->textures[i].life == HBIL_LIFE_OUTPUT)
            transition(d, &d->images[i], VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_GENERAL, 0, VK_ACCESS_SHADER_WRITE_BIT);
    }
    return finish(d) && ok;
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
        const size_t texels = (size_t)out->width * (size_t)out->height * (size_t)image_slices(out);
        const size_t bytes = texels * (size_t)out->channels * sizeof(float);
        if (plan->textures[i].life == HBIL_LIFE_OUTPUT) memcpy(out->data, d->staged + d->images[i].offset, bytes);
    }
    return 1;
}

/* Pipelines hold the old text: they go. */
static void vk_set_hook(void *device, const char *text)
{
    vk_device *d = (vk_device *)device;
    d->hook = text;
    hbil_vk_shutdown(&d->backend);
}

static void vk_set_text(void *device, const char *pass, const char *text)
{
    vk_device *d = (vk_device *)device;
    d->own_pass = pass;
    d->own_text = text;
    hbil_vk_shutdown(&d->backend);
}

/* Pipelines stay: a plan of other words has another hash. */
static void vk_set_words(void *device, const runner_spirv *spirv) { ((vk_device *)device)->spirv = spirv; }

/* After a run that failed: nothing is under way, and the next one begins without history on images of its own. */
static int recover(vk_device *d)
{
    d->lost |= vkDeviceWaitIdle(d->device) == VK_ERROR_DEVICE_LOST;
    vkResetFences(d->device, 1, &d->fence);
    for (int t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(d, &d->images[t]);
    d->backend.fresh = 1;
    return 0;
}

static int vk_run(void *device, const hbil_plan *plan, const hbil_frame *frame, const uint32_t size[2],
                  const image inputs[HBIL_MAX_TEXTURES], image outputs[HBIL_MAX_TEXTURES], int repeat, double *ms, char *error, size_t error_size)
{
    vk_device *d = (vk_device *)device;
    d->error = error;
    d->error_size = error_size;
    if (d->lost) return FAIL(d, "the device is lost: close this runner and open another one");
    if (!set_plan(d, plan) || !set_images(d, plan, size, inputs, outputs) || !upload(d, plan, inputs)) return recover(d);
    d->backend.block = d->spirv != NULL ? d->spirv->block : NULL;
    for (int i = 0; i < repeat; ++i)
        if (!execute(d, frame, ms != NULL ? ms + (size_t)i * plan->pass_count : NULL)) return recover(d);
    return read_back(d, plan, outputs) || recover(d);
}

const runner_ops runner_vulkan = { vk_open, vk_close, vk_messages, vk_set_hook, vk_set_text, vk_set_words, vk_run };
