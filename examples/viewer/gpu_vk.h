/* gpu_vk.h - between gpu_vk_device.c, what any renderer has, and gpu_vk.c, the frame with hbil.h in it. */
#ifndef HBIL_VIEWER_GPU_VK_H
#define HBIL_VIEWER_GPU_VK_H

#include <volk.h>
#include <GLFW/glfw3.h>

#include "../../hbil.h"
#include "../../backends/hbil_vk.h"
#include "gpu.h"

#define FAIL(g, ...) (snprintf((g)->setup.error, (g)->setup.error_size, __VA_ARGS__), 0)
#define ZEROED(type, name) type name; memset(&name, 0, sizeof name)
#define STRUCT(type, name, tag) ZEROED(type, name); name.sType = VK_STRUCTURE_TYPE_##tag
#define TRY(g, call, args) do {                                                                             \
        const VkResult result_ = call args;                                                                 \
        if (result_ != VK_SUCCESS) return FAIL(g, #call " returned VkResult %d", (int)result_);             \
    } while (0)

enum { SWAP_MAX = 16, BINDINGS = 6, TIMES_OWN = 4 };
enum { DRAW_SHADOW, DRAW_MODEL, DRAW_SKY, DRAW_SCREEN, DRAW_TEXT, DRAWS };

extern const VkFormat vk_target_formats[TARGETS];
#define PICTURE_FORMAT VK_FORMAT_R8G8B8A8_UNORM /* screen.frag encodes sRGB itself */

typedef struct vk_image {
    VkImage        image;
    VkDeviceMemory memory;
    VkImageView    view;
    VkExtent3D     size;                 /* depth: layers */
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

/* All that return int: 1, or 0 with error[] filled. */
void *vk_open(const gpu_setup *setup, char device[128]);
void  vk_close(void *gpu);
int   vk_make_buffer(vk *g, vk_buffer *b, VkDeviceSize size, VkBufferUsageFlags usage, int mapped);
void  vk_drop_buffer(vk *g, vk_buffer *b);
/* layers 0: a plain image. What was in *t goes. */
int   vk_make_image(vk *g, vk_image *t, VkFormat format, uint32_t width, uint32_t height, uint32_t layers,
                    VkImageUsageFlags usage);
void  vk_drop_image(vk *g, vk_image *t);
int   vk_make_view(vk *g, VkImage image, VkFormat format, VkImageViewType type, VkComponentSwizzle red,
                   VkImageView *out);
void  vk_drop_swapchain(vk *g);
VkImageAspectFlags vk_aspect_of(VkFormat format);

#endif
