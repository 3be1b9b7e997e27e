/* vk_shim.h - stands between a program and the Vulkan loader: makes the n-th call of a function fail, hides functions, lies about
 * the device, and counts what is made against what is destroyed. Include behind volk.h. */
#ifndef HBIL_TEST_VK_SHIM_H
#define HBIL_TEST_VK_SHIM_H

#include <pthread.h>
#include <string.h>

/* Functions that return a VkResult, with what they make: nothing, one handle of a kind. X(name, kind, out, parameters, arguments) */
#define SHIM_CAN_FAIL(X)                                                                                                            \
    X(CreateInstance, Instance, out, (const VkInstanceCreateInfo *i, const VkAllocationCallbacks *a, VkInstance *out), (i, a, out))  \
    X(EnumeratePhysicalDevices, NONE, NULL, (VkInstance i, uint32_t *n, VkPhysicalDevice *p), (i, n, p))                             \
    X(EnumerateInstanceLayerProperties, NONE, NULL, (uint32_t *n, VkLayerProperties *p), (n, p))                                     \
    X(CreateDebugUtilsMessengerEXT, DebugUtilsMessengerEXT, out, (VkInstance v, const VkDebugUtilsMessengerCreateInfoEXT *i,         \
      const VkAllocationCallbacks *a, VkDebugUtilsMessengerEXT *out), (v, i, a, out))                                                \
    X(GetPhysicalDeviceImageFormatProperties, NONE, NULL, (VkPhysicalDevice d, VkFormat f, VkImageType t, VkImageTiling g,           \
      VkImageUsageFlags u, VkImageCreateFlags c, VkImageFormatProperties *p), (d, f, t, g, u, c, p))                                 \
    X(CreateDevice, Device, out, (VkPhysicalDevice d, const VkDeviceCreateInfo *i, const VkAllocationCallbacks *a, VkDevice *out),   \
      (d, i, a, out))                                                                                                                \
    X(CreateCommandPool, CommandPool, out, (VkDevice d, const VkCommandPoolCreateInfo *i, const VkAllocationCallbacks *a,            \
      VkCommandPool *out), (d, i, a, out))                                                                                           \
    X(AllocateCommandBuffers, NONE, NULL, (VkDevice d, const VkCommandBufferAllocateInfo *i, VkCommandBuffer *o), (d, i, o))         \
    X(CreateFence, Fence, out, (VkDevice d, const VkFenceCreateInfo *i, const VkAllocationCallbacks *a, VkFence *out),               \
      (d, i, a, out))                                                                                                                \
    X(AllocateMemory, Memory, out, (VkDevice d, const VkMemoryAllocateInfo *i, const VkAllocationCallbacks *a,                       \
      VkDeviceMemory *out), (d, i, a, out))                                                                                          \
    X(CreateImage, Image, out, (VkDevice d, const VkImageCreateInfo *i, const VkAllocationCallbacks *a, VkImage *out),               \
      (d, i, a, out))                                                                                                                \
    X(BindImageMemory, NONE, NULL, (VkDevice d, VkImage i, VkDeviceMemory m, VkDeviceSize o), (d, i, m, o))                          \
    X(CreateImageView, ImageView, out, (VkDevice d, const VkImageViewCreateInfo *i, const VkAllocationCallbacks *a,                  \
      VkImageView *out), (d, i, a, out))                                                                                             \
    X(CreateBuffer, Buffer, out, (VkDevice d, const VkBufferCreateInfo *i, const VkAllocationCallbacks *a, VkBuffer *out),           \
      (d, i, a, out))                                                                                                                \
    X(BindBufferMemory, NONE, NULL, (VkDevice d, VkBuffer b, VkDeviceMemory m, VkDeviceSize o), (d, b, m, o))                        \
    X(MapMemory, NONE, NULL, (VkDevice d, VkDeviceMemory m, VkDeviceSize o, VkDeviceSize s, VkMemoryMapFlags f, void **p),           \
      (d, m, o, s, f, p))                                                                                                            \
    X(CreateSampler, Sampler, out, (VkDevice d, const VkSamplerCreateInfo *i, const VkAllocationCallbacks *a, VkSampler *out),       \
      (d, i, a, out))                                                                                                                \
    X(CreateQueryPool, QueryPool, out, (VkDevice d, const VkQueryPoolCreateInfo *i, const VkAllocationCallbacks *a,                  \
      VkQueryPool *out), (d, i, a, out))                                                                                             \
    X(GetQueryPoolResults, NONE, NULL, (VkDevice d, VkQueryPool q, uint32_t f, uint32_t n, size_t s, void *p, VkDeviceSize t,        \
      VkQueryResultFlags g), (d, q, f, n, s, p, t, g))                                                                               \
    X(CreateDescriptorSetLayout, DescriptorSetLayout, out, (VkDevice d, const VkDescriptorSetLayoutCreateInfo *i,                    \
      const VkAllocationCallbacks *a, VkDescriptorSetLayout *out), (d, i, a, out))                                                   \
    X(CreatePipelineLayout, PipelineLayout, out, (VkDevice d, const VkPipelineLayoutCreateInfo *i,                                   \
      const VkAllocationCallbacks *a, VkPipelineLayout *out), (d, i, a, out))                                                        \
    X(CreateDescriptorPool, DescriptorPool, out, (VkDevice d, const VkDescriptorPoolCreateInfo *i,                                   \
      const VkAllocationCallbacks *a, VkDescriptorPool *out), (d, i, a, out))                                                        \
    X(AllocateDescriptorSets, NONE, NULL, (VkDevice d, const VkDescriptorSetAllocateInfo *i, VkDescriptorSet *o), (d, i, o))         \
    X(ResetDescriptorPool, NONE, NULL, (VkDevice d, VkDescriptorPool p, VkDescriptorPoolResetFlags f), (d, p, f))                    \
    X(CreateShaderModule, ShaderModule, out, (VkDevice d, const VkShaderModuleCreateInfo *i, const VkAllocationCallbacks *a,         \
      VkShaderModule *out), (d, i, a, out))                                                                                          \
    X(CreateComputePipelines, Pipeline, out, (VkDevice d, VkPipelineCache c, uint32_t n, const VkComputePipelineCreateInfo *i,       \
      const VkAllocationCallbacks *a, VkPipeline *out), (d, c, n, i, a, out))                                                        \
    X(ResetCommandPool, NONE, NULL, (VkDevice d, VkCommandPool p, VkCommandPoolResetFlags f), (d, p, f))                             \
    X(BeginCommandBuffer, NONE, NULL, (VkCommandBuffer c, const VkCommandBufferBeginInfo *i), (c, i))                                \
    X(EndCommandBuffer, NONE, NULL, (VkCommandBuffer c), (c))                                                                        \
    X(QueueSubmit, NONE, NULL, (VkQueue q, uint32_t n, const VkSubmitInfo *i, VkFence f), (q, n, i, f))                              \
    X(WaitForFences, NONE, NULL, (VkDevice d, uint32_t n, const VkFence *f, VkBool32 w, uint64_t t), (d, n, f, w, t))                \
    X(ResetFences, NONE, NULL, (VkDevice d, uint32_t n, const VkFence *f), (d, n, f))                                                \
    X(DeviceWaitIdle, NONE, NULL, (VkDevice d), (d))
/* And those that destroy what these make. X(name, parent, handle, kind) */
#define SHIM_DESTROYS(X)                                                                                                       \
    X(DestroyDebugUtilsMessengerEXT, VkInstance, VkDebugUtilsMessengerEXT, DebugUtilsMessengerEXT)                             \
    X(DestroyCommandPool, VkDevice, VkCommandPool, CommandPool) X(DestroyFence, VkDevice, VkFence, Fence)                      \
    X(FreeMemory, VkDevice, VkDeviceMemory, Memory) X(DestroyImage, VkDevice, VkImage, Image)                                  \
    X(DestroyImageView, VkDevice, VkImageView, ImageView) X(DestroyBuffer, VkDevice, VkBuffer, Buffer)                         \
    X(DestroySampler, VkDevice, VkSampler, Sampler) X(DestroyQueryPool, VkDevice, VkQueryPool, QueryPool)                      \
    X(DestroyDescriptorSetLayout, VkDevice, VkDescriptorSetLayout, DescriptorSetLayout)                                        \
    X(DestroyPipelineLayout, VkDevice, VkPipelineLayout, PipelineLayout)                                                       \
    X(DestroyDescriptorPool, VkDevice, VkDescriptorPool, DescriptorPool)                                                       \
    X(DestroyShaderModule, VkDevice, VkShaderModule, ShaderModule) X(DestroyPipeline, VkDevice, VkPipeline, Pipeline)

#define SHIM_KINDS(X) X(NONE) X(Instance) X(DebugUtilsMessengerEXT) X(Device) X(CommandPool) X(Fence) X(Memory) X(Image) X(ImageView) \
    X(Buffer) X(Sampler) X(QueryPool) X(DescriptorSetLayout) X(PipelineLayout) X(DescriptorPool) X(ShaderModule) X(Pipeline)
#define SHIM_KIND(name) KIND_##name,
enum { SHIM_KINDS(SHIM_KIND) KINDS };
#define SHIM_ID(name, kind, out, parameters, arguments) CALL_##name,
enum { SHIM_CAN_FAIL(SHIM_ID) CALLS };
#define SHIM_NAME(name, kind, out, parameters, arguments) "vk" #name,
static const char *const shim_names[] = { SHIM_CAN_FAIL(SHIM_NAME) };

enum { SHIM_LIVE = 1024 };

static struct {
    int         call, at;           /* which call of which function fails; at 0: none */
    VkResult    result;
    int         failed;             /* faults that were injected since shim_clear */
    int         lost;               /* VK_ERROR_DEVICE_LOST was injected: all that follows says so, until the device is destroyed */
    int         calls[CALLS];       /* since shim_clear */
    const char *hidden;             /* no function of that name */
    void      (*properties)(VkPhysicalDeviceProperties *p);           /* lies, NULL: none */
    void      (*format)(VkFormat format, VkFormatProperties *p);
    void      (*families)(VkQueueFamilyProperties *p);
    void      (*memory)(VkPhysicalDeviceMemoryProperties *p);
    int         alien;              /* handles destroyed that were never made, or twice */
    struct { uint64_t handle; int kind; } live[SHIM_LIVE];
    int         live_count;
    pthread_mutex_t mine, queue;    /* of this struct; held during vkQueueSubmit, as an application with threads has to */
    PFN_vkGetInstanceProcAddr loader;
    PFN_vkGetDeviceProcAddr   device_proc;
} shim = { .mine = PTHREAD_MUTEX_INITIALIZER, .queue = PTHREAD_MUTEX_INITIALIZER };

static void shim_clear(void)
{
    shim.call = shim.at = shim.failed = shim.lost = 0;
    memset(shim.calls, 0, sizeof shim.calls);
    shim.hidden = NULL;
    shim.properties = NULL;
    shim.format = NULL;
    shim.families = NULL;
    shim.memory = NULL;
}

static void shim_made(int kind, const void *out, size_t size)
{
    uint64_t handle = 0;
    if (kind == KIND_NONE) return;
    memcpy(&handle, out, size);
    pthread_mutex_lock(&shim.mine);
    assert_true(shim.live_count < SHIM_LIVE);
    shim.live[shim.live_count].handle = handle;
    shim.live[shim.live_count++].kind = kind;
    pthread_mutex_unlock(&shim.mine);
}

/* Was it there? */
static int shim_gone(int kind, const void *in, size_t size)
{
    uint64_t handle = 0;
    int i, count;
    memcpy(&handle, in, size);
    if (handle == 0) return 1;
    pthread_mutex_lock(&shim.mine);
    count = shim.live_count;
    for (i = 0; i < count; ++i)
        if (shim.live[i].handle == handle && shim.live[i].kind == kind) break;
    if (i == count) ++shim.alien;
    else shim.live[i] = shim.live[--shim.live_count];
    pthread_mutex_unlock(&shim.mine);
    return i < count;
}

static void shim_queue(int call, int begin)
{
    if (call != CALL_QueueSubmit) return;
    if (begin) pthread_mutex_lock(&shim.queue);
    else pthread_mutex_unlock(&shim.queue);
}

/* The result of this call if it is one that fails; what it would have made is then garbage, as the specification has it. */
static VkResult shim_fault(int call, void *out, size_t size)
{
    int chosen;
    pthread_mutex_lock(&shim.mine);
    chosen = ++shim.calls[call] == shim.at && call == shim.call;
    pthread_mutex_unlock(&shim.mine);
    if (call == CALL_CreateInstance) shim.lost = 0; /* a new beginning */
    if (!chosen && !shim.lost) return VK_SUCCESS;
    shim.failed += chosen;
    shim.lost |= chosen && shim.result == VK_ERROR_DEVICE_LOST;
    if (out != NULL) memset(out, 0xDB, size);
    return shim.lost ? VK_ERROR_DEVICE_LOST : shim.result;
}

/* The device goes on where a test says that it is lost: what is under way ends before its memory does. */
static PFN_vkDeviceWaitIdle shim_real_idle;
static VkDevice             shim_device;

#define SHIM_REAL(name, kind, out, parameters, arguments) static PFN_vk##name real_##name;
SHIM_CAN_FAIL(SHIM_REAL)
#define SHIM_FUNCTION(name, kind, made_, parameters, arguments)                                                     \
    static VKAPI_ATTR VkResult VKAPI_CALL shim_##name parameters                                                    \
    {                                                                                                               \
        void *const made = (void *)(made_);                                                                         \
        VkResult result = shim_fault(CALL_##name, made, sizeof(uintptr_t));                                         \
        if (result != VK_SUCCESS && shim.lost && shim_device) shim_real_idle(shim_device);                          \
        if (result != VK_SUCCESS) return result;                                                                    \
        shim_queue(CALL_##name, 1);                                                                                 \
        result = real_##name arguments;                                                                             \
        shim_queue(CALL_##name, 0);                                                                                 \
        if (result == VK_SUCCESS && made) shim_made(KIND_##kind, made, sizeof(uintptr_t));                          \
        return result;                                                                                              \
    }
SHIM_CAN_FAIL(SHIM_FUNCTION)

#define SHIM_DESTROY(name, parent, type, kind)                                                                      \
    static PFN_vk##name real_##name;                                                                                \
    static VKAPI_ATTR void VKAPI_CALL shim_##name(parent of, type handle, const VkAllocationCallbacks *a)           \
    {                                                                                                               \
        if (shim_gone(KIND_##kind, &handle, sizeof handle)) real_##name(of, handle, a);                             \
    }
SHIM_DESTROYS(SHIM_DESTROY)

static PFN_vkDestroyInstance                          real_DestroyInstance;
static PFN_vkDestroyDevice                            real_DestroyDevice;
static PFN_vkGetDeviceQueue                           real_GetDeviceQueue;
static PFN_vkGetPhysicalDeviceProperties              real_GetPhysicalDeviceProperties;
static PFN_vkGetPhysicalDeviceFormatProperties        real_GetPhysicalDeviceFormatProperties;
static PFN_vkGetPhysicalDeviceQueueFamilyProperties   real_GetPhysicalDeviceQueueFamilyProperties;
static PFN_vkGetPhysicalDeviceMemoryProperties        real_GetPhysicalDeviceMemoryProperties;

static VKAPI_ATTR void VKAPI_CALL shim_DestroyInstance(VkInstance instance, const VkAllocationCallbacks *a)
{
    if (shim_gone(KIND_Instance, &instance, sizeof instance)) real_DestroyInstance(instance, a);
}

static VKAPI_ATTR void VKAPI_CALL shim_DestroyDevice(VkDevice device, const VkAllocationCallbacks *a)
{
    if (shim_gone(KIND_Device, &device, sizeof device)) real_DestroyDevice(device, a);
    shim.lost = 0;
    shim_device = NULL;
}

static VKAPI_ATTR void VKAPI_CALL shim_GetDeviceQueue(VkDevice device, uint32_t family, uint32_t index, VkQueue *queue)
{
    shim_device = device;
    real_GetDeviceQueue(device, family, index, queue);
}

static VKAPI_ATTR void VKAPI_CALL shim_GetPhysicalDeviceProperties(VkPhysicalDevice d, VkPhysicalDeviceProperties *p)
{
    real_GetPhysicalDeviceProperties(d, p);
    if (shim.properties) shim.properties(p);
}

static VKAPI_ATTR void VKAPI_CALL shim_GetPhysicalDeviceFormatProperties(VkPhysicalDevice d, VkFormat f, VkFormatProperties *p)
{
    real_GetPhysicalDeviceFormatProperties(d, f, p);
    if (shim.format) shim.format(f, p);
}

static VKAPI_ATTR void VKAPI_CALL shim_GetPhysicalDeviceQueueFamilyProperties(VkPhysicalDevice d, uint32_t *count,
                                                                              VkQueueFamilyProperties *p)
{
    uint32_t i;
    real_GetPhysicalDeviceQueueFamilyProperties(d, count, p);
    for (i = 0; p && shim.families && i < *count; ++i) shim.families(&p[i]);
}

static VKAPI_ATTR void VKAPI_CALL shim_GetPhysicalDeviceMemoryProperties(VkPhysicalDevice d, VkPhysicalDeviceMemoryProperties *p)
{
    real_GetPhysicalDeviceMemoryProperties(d, p);
    if (shim.memory) shim.memory(p);
}

/* The function that stands before the real one, NULL: none does. real, if known, is what it calls. */
static PFN_vkVoidFunction shim_wrapped(PFN_vkVoidFunction real, const char *name)
{
#define SHIM_TAKE(f)                                                                                                \
    if (strcmp(name, "vk" #f) == 0) {                                                                               \
        if (real) real_##f = (PFN_vk##f)real;                                                                       \
        return (PFN_vkVoidFunction)shim_##f;                                                                        \
    }
#define SHIM_TAKE_FAIL(f, kind, out, parameters, arguments) SHIM_TAKE(f)
#define SHIM_TAKE_DESTROY(f, parent, type, kind) SHIM_TAKE(f)
    if (real && strcmp(name, "vkDeviceWaitIdle") == 0) shim_real_idle = (PFN_vkDeviceWaitIdle)real;
    SHIM_CAN_FAIL(SHIM_TAKE_FAIL)
    SHIM_DESTROYS(SHIM_TAKE_DESTROY)
    SHIM_TAKE(DestroyInstance)
    SHIM_TAKE(DestroyDevice)
    SHIM_TAKE(GetDeviceQueue)
    SHIM_TAKE(GetPhysicalDeviceProperties)
    SHIM_TAKE(GetPhysicalDeviceFormatProperties)
    SHIM_TAKE(GetPhysicalDeviceQueueFamilyProperties)
    SHIM_TAKE(GetPhysicalDeviceMemoryProperties)
    return NULL;
}

/* The loader's functions take any device, so those of the instance stand for those of each device. */
static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL shim_device_proc(VkDevice device, const char *name)
{
    PFN_vkVoidFunction wrapped;
    if (shim.hidden && strcmp(name, shim.hidden) == 0) return NULL;
    wrapped = shim_wrapped(NULL, name);
    return wrapped ? wrapped : shim.device_proc(device, name);
}

static VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL shim_proc(VkInstance instance, const char *name)
{
    PFN_vkVoidFunction real, wrapped;
    if (shim.hidden && strcmp(name, shim.hidden) == 0) return NULL;
    if (strcmp(name, "vkGetInstanceProcAddr") == 0) return (PFN_vkVoidFunction)shim_proc;
    if (strcmp(name, "vkGetDeviceProcAddr") == 0) {
        shim.device_proc = (PFN_vkGetDeviceProcAddr)shim.loader(instance, name);
        return (PFN_vkVoidFunction)shim_device_proc;
    }
    real = shim.loader(instance, name);
    wrapped = real ? shim_wrapped(real, name) : NULL;
    return wrapped ? wrapped : real;
}

/* In place of volkInitialize. no_loader: as where none is installed. */
static int shim_no_loader;

static VkResult shim_initialize(void)
{
    if (shim_no_loader) return VK_ERROR_INITIALIZATION_FAILED;
    if (volkInitialize() != VK_SUCCESS) return VK_ERROR_INITIALIZATION_FAILED;
    if (vkGetInstanceProcAddr != shim_proc) shim.loader = vkGetInstanceProcAddr;
    volkInitializeCustom(shim_proc);
    return VK_SUCCESS;
}

#endif
