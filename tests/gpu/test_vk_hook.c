/* test_vk_hook.c - hbil_vk.h binds the descriptor set of a hook that reads resources of its own; the validation layer
 * is silent. Works on the device of a runner, whose file it includes. Exit code 77 (skipped) where there is no Vulkan. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include "../../examples/frame/runner_vk.c"

enum { WIDTH = 19, HEIGHT = 11 };

static vk_device *device;
static char       error[512];

static const char hook[] = "layout(set = 1, binding = 3, std140) uniform Mine { vec4 u_mine; };\n"
                           "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) { return u_mine.rgb; }\n";

/* The engine's own: a block of one vec4 at binding 3. */
typedef struct mine {
    VkBuffer              buffer;
    VkDeviceMemory        memory;
    VkDescriptorSetLayout layout;
    VkDescriptorPool      pool;
    VkDescriptorSet       set;
} mine;

static void make_buffer(mine *m, const float value[4])
{
    STRUCT(VkBufferCreateInfo, info, BUFFER_CREATE_INFO);
    VkMemoryRequirements need;
    void *mapped = NULL;
    info.size = 4 * sizeof(float);
    info.usage = VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    assert_int_equal(vkCreateBuffer(device->device, &info, NULL, &m->buffer), VK_SUCCESS);
    vkGetBufferMemoryRequirements(device->device, m->buffer, &need);
    assert_true(allocate(device, &need, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT, &m->memory));
    assert_int_equal(vkBindBufferMemory(device->device, m->buffer, m->memory, 0), VK_SUCCESS);
    assert_int_equal(vkMapMemory(device->device, m->memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
    memcpy(mapped, value, 4 * sizeof(float));
}

static void make_set(mine *m)
{
    const VkDescriptorSetLayoutBinding binding = { 3, VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL };
    const VkDescriptorPoolSize size = { VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1 };
    const VkDescriptorBufferInfo buffer = { m->buffer, 0, VK_WHOLE_SIZE };
    STRUCT(VkDescriptorSetLayoutCreateInfo, layout, DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    STRUCT(VkDescriptorPoolCreateInfo, pool, DESCRIPTOR_POOL_CREATE_INFO);
    STRUCT(VkDescriptorSetAllocateInfo, set, DESCRIPTOR_SET_ALLOCATE_INFO);
    STRUCT(VkWriteDescriptorSet, write, WRITE_DESCRIPTOR_SET);
    layout.bindingCount = 1;
    layout.pBindings = &binding;
    assert_int_equal(vkCreateDescriptorSetLayout(device->device, &layout, NULL, &m->layout), VK_SUCCESS);
    pool.maxSets = pool.poolSizeCount = 1;
    pool.pPoolSizes = &size;
    assert_int_equal(vkCreateDescriptorPool(device->device, &pool, NULL, &m->pool), VK_SUCCESS);
    set.descriptorPool = m->pool;
    set.descriptorSetCount = 1;
    set.pSetLayouts = &m->layout;
    assert_int_equal(vkAllocateDescriptorSets(device->device, &set, &m->set), VK_SUCCESS);
    write.dstSet = m->set;
    write.dstBinding = 3;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    write.pBufferInfo = &buffer;
    vkUpdateDescriptorSets(device->device, 1, &write, 0, NULL);
}

static void drop_mine(mine *m)
{
    vkDestroyDescriptorPool(device->device, m->pool, NULL);
    vkDestroyDescriptorSetLayout(device->device, m->layout, NULL);
    vkDestroyBuffer(device->device, m->buffer, NULL);
    vkFreeMemory(device->device, m->memory, NULL);
}

/* What set_plan of the runner does, with a layout for set 1. */
static void init_backend(const hbil_plan *plan, VkDescriptorSetLayout layout)
{
    enum { WORDS = 1 << 17 };
    static char text[CAP_TEXT];
    static uint32_t words[WORDS];
    ZEROED(hbil_vk_info, info);
    device->hook = hook;
    device->error = error;
    device->error_size = sizeof error;
    if (!compile(device, plan, text, words, WORDS, &info)) fail_msg("%s", error);
    info.instance = device->instance;
    info.physical_device = device->gpu;
    info.device = device->device;
    info.queue_family = device->family;
    info.get_proc = vkGetInstanceProcAddr;
    info.plan = plan;
    info.input_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    info.timestamps = device->timestamps;
    info.hook_layout = layout;
    if (hbil_vk_init(&info, &device->backend) != HBIL_VK_OK) fail_msg("%s", device->backend.message);
}

static hbil_plan plan_of(const char *config)
{
    hbil_config c;
    hbil_plan plan;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    return plan;
}

static void check_far(const hbil_plan *plan, const image *outputs, const float value[4])
{
    const image *ao = &outputs[hbil_plan_texture(plan, "ao")], *far_light = &outputs[hbil_plan_texture(plan, "far")];
    int p, k;
    for (p = 0; p < WIDTH * HEIGHT; ++p)
        for (k = 0; k < 3; ++k) {
            float want = value[k] * ao->data[p], got = far_light->data[4 * p + k];
            assert_true(want > 0.0f && got > 0.999f * want && got < 1.001f * want);
        }
}

/* Every pass uses its own set 0, so a set 1 that the engine had bound itself would not survive them: hbil_vk.h binds it. */
static void a_hook_reads_a_set_of_yours(void **state)
{
    static const char *const configs[] = { "outputs=ao+far normals=depth environment=hook",
        "outputs=ao+far normals=depth environment=hook estimator=bitmask far_visibility=free_bits" };
    static const float value[4] = { 0.5f, 2.0f, 3.0f, 0.0f };
    static const uint32_t size[2] = { WIDTH, HEIGHT };
    mine m;
    int i, p;
    (void)state;
    memset(&m, 0, sizeof m);
    make_buffer(&m, value);
    make_set(&m);
    for (i = 0; i < 2; ++i) {
        hbil_plan plan = plan_of(configs[i]);
        hbil_frame frame = test_frame(&plan.config, WIDTH, HEIGHT);
        image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
        image *depth = &inputs[hbil_plan_texture(&plan, "depth")];
        memset(inputs, 0, sizeof inputs);
        memset(outputs, 0, sizeof outputs);
        assert_true(image_make(depth, WIDTH, HEIGHT, 1));
        for (p = 0; p < WIDTH * HEIGHT; ++p) depth->data[p] = 4.0f + 0.01f * (float)(p % WIDTH);
        init_backend(&plan, m.layout);
        assert_false(vk_run(device, &plan, &frame, size, inputs, outputs, 1, NULL, error, sizeof error));
        assert_non_null(strstr(error, "hook_set is null"));
        assert_int_equal(vkEndCommandBuffer(device->cmd), VK_SUCCESS); /* the runner left it open */
        for (p = 0; p < HBIL_MAX_TEXTURES; ++p) image_free(&outputs[p]);
        device->backend.hook_set = m.set;
        if (!vk_run(device, &plan, &frame, size, inputs, outputs, 2, NULL, error, sizeof error)) fail_msg("%s", error);
        check_far(&plan, outputs, value);
        for (p = 0; p < HBIL_MAX_TEXTURES; ++p) image_free(&outputs[p]);
        image_free(depth);
        vk_set_hook(device, NULL);
    }
    drop_mine(&m);
    assert_int_equal(vk_messages(device), 0);
}

/* A layout is asked for where a pass has a hook, and nowhere else. */
static void a_plan_without_hook_needs_no_set(void **state)
{
    const hbil_plan plan = plan_of("outputs=ao normals=depth");
    mine m;
    static const float none[4];
    (void)state;
    memset(&m, 0, sizeof m);
    make_buffer(&m, none);
    make_set(&m);
    init_backend(&plan, m.layout);
    assert_true(device->backend.hook_layout == VK_NULL_HANDLE);
    vk_set_hook(device, NULL);
    drop_mine(&m);
    assert_int_equal(vk_messages(device), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_hook_reads_a_set_of_yours),
        cmocka_unit_test(a_plan_without_hook_needs_no_set),
    };
    runner_info about;
    int failed;
    device = (vk_device *)vk_open(1, &about, error, sizeof error);
    if (!device) {
        printf("skipped: %s\n", error);
        return 77;
    }
    printf("%s, %s\n", about.device, about.driver);
    failed = cmocka_run_group_tests_name("vk_hook", tests, NULL, NULL);
    vk_close(device);
    return failed;
}
