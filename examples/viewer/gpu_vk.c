/* gpu_vk.c - the viewer on Vulkan 1.3: sun's shadow map, G-buffer, the plan through backends/hbil_vk.h, tone
 * mapping.
 *
 * One frame at a time: each waits for the queue, which keeps this short and lets every frame be measured. What
 * concerns hbil.h is in vk_plan (text to SPIR-V to pipelines), hand_over (its inputs and outputs) and record
 * (where it stands in the frame). The implementations of hbil_vk.h and hbil_glslang.h are in
 * examples/frame/runner_vk.c, which this program links. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "gpu_vk.h"
#include "../../backends/hbil_glslang.h"

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
static const use drawn_depth = {LAYOUT(DEPTH_ATTACHMENT_OPTIMAL),
                                STAGE(EARLY_FRAGMENT_TESTS) | STAGE(LATE_FRAGMENT_TESTS),
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
static void wait_for(vk *g, VkPipelineStageFlags2 from, VkAccessFlags2 written, VkPipelineStageFlags2 to,
                     VkAccessFlags2 access)
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

/* ---- model ------------------------------------------------------------------------------------------------------- */

static int vk_messages(const void *gpu) { return ((const vk *)gpu)->messages; }

static int vk_model(void *gpu, const gpu_vertex *vertices, size_t count)
{
    const VkDeviceSize size = count * sizeof *vertices;
    vk       *g = gpu;
    vk_buffer upload;
    int       ok;

    memset(&upload, 0, sizeof upload);
    g->vertex_count = (uint32_t)count;
    ok = vk_make_buffer(g, &g->vertices, size, VK_BUFFER_USAGE_VERTEX_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, 0)
      && vk_make_buffer(g, &upload, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, 1) && begin(g);
    if (ok) {
        const VkBufferCopy all = {0, 0, size};
        memcpy(upload.mapped, vertices, size);
        vkCmdCopyBuffer(g->cmd, upload.buffer, g->vertices.buffer, 1, &all);
        ok = finish(g, -1);
    }
    vk_drop_buffer(g, &upload);
    return ok;
}

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

/* Our images for its inputs and outputs. New outputs are left in GENERAL, where hbil_vk.h wants them. */
static int hand_over(vk *g)
{
    const hbil_plan *plan = &g->light.plan;
    VkImageView      views[HBIL_MAX_TEXTURES];
    VkExtent3D       extents[HBIL_MAX_TEXTURES];
    uint32_t         t;

    memset(views, 0, sizeof views);
    memset(extents, 0, sizeof extents);
    for (t = 0; t < HBIL_MAX_TEXTURES; t++) vk_drop_image(g, &g->outputs[t]);
    for (t = 0; t < plan->texture_count; t++) {
        const hbil_texture *texture = &plan->textures[t];
        if (texture->life == HBIL_LIFE_INPUT) {
            const int target = gpu_input_of(texture->name);
            if (target >= 0) views[t] = target == TARGET_ROUGHNESS ? g->roughness : g->targets[target].view;
            if (target >= 0) extents[t] = g->targets[target == TARGET_ROUGHNESS ? TARGET_SPECULAR : target].size;
        } else if (texture->life == HBIL_LIFE_OUTPUT) {
            if (!vk_make_image(g, &g->outputs[t], hbil_vk_format((hbil_format)texture->format), g->width, g->height,
                            texture->dim == HBIL_DIM_2D_ARRAY ? texture->layers : 0,
                            VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT)) return 0;
            views[t] = g->outputs[t].view;
            extents[t] = g->outputs[t].size;
        }
    }
    if (!begin(g)) return 0;
    for (t = 0; t < plan->texture_count; t++)
        if (g->outputs[t].image) transition(g, g->outputs[t].image, VK_IMAGE_ASPECT_COLOR_BIT, unused, computed);
    if (!finish(g, -1)) return 0;
    g->light.extents = extents; /* one that is too small is then refused by name */
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
    vk_drop_swapchain(g);
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
    for (t = 0; t < TARGETS; t++) {
        const VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT | (t == TARGET_DEPTH
            ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT);
        if (!vk_make_image(g, &g->targets[t], vk_target_formats[t], g->width, g->height, 0, usage)) return 0;
    }
    vkDestroyImageView(g->device, g->roughness, NULL);
    g->roughness = VK_NULL_HANDLE;
    return vk_make_view(g, g->targets[TARGET_SPECULAR].image, vk_target_formats[TARGET_SPECULAR], VK_IMAGE_VIEW_TYPE_2D,
                     VK_COMPONENT_SWIZZLE_A, &g->roughness)
        && vk_make_image(g, &g->picture, PICTURE_FORMAT, g->width, g->height, 0,
                      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT)
        && vk_make_buffer(g, &g->staging, (VkDeviceSize)g->width * g->height * 4, VK_BUFFER_USAGE_TRANSFER_DST_BIT, 1)
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

static void begin_draw(vk *g, uint32_t width, uint32_t height, const VkRenderingAttachmentInfo *colours,
                       uint32_t colour_count, const VkRenderingAttachmentInfo *depth)
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
    for (t = 0; t < TARGETS; t++) { /* 0 is TARGET_DEPTH, the others are colours */
        transition(g, g->targets[t].image, vk_aspect_of(vk_target_formats[t]), unused, t ? drawn : drawn_depth);
        if (t) colours[t - 1] = attachment(g->targets[t].view, drawn.layout);
    }
    begin_draw(g, g->width, g->height, colours, TARGETS - 1, &depth);
    draw(g, DRAW_MODEL, &g->vertices, g->vertex_count);
    draw(g, DRAW_SKY, NULL, 3);
    vkCmdEndRendering(g->cmd);
    for (t = 0; t < TARGETS; t++)
        transition(g, g->targets[t].image, vk_aspect_of(vk_target_formats[t]), t ? drawn : drawn_depth, sampled);
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
        vkCmdBlitImage(g->cmd, g->picture.image, copied_from.layout, from, copied_to.layout, 1, &blit,
                       VK_FILTER_NEAREST);
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
    wait_for(g, STAGE(ALL_TRANSFER), ACCESS(TRANSFER_WRITE), STAGE(VERTEX_SHADER) | STAGE(FRAGMENT_SHADER),
             ACCESS(UNIFORM_READ));
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
    if (result == VK_ERROR_OUT_OF_DATE_KHR) return 1;
    return result >= 0 || FAIL(g, "vkQueuePresentKHR returned VkResult %d", (int)result);
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
