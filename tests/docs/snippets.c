/* snippets.c - what README.md quotes of the Vulkan and GL backends, built and run: on lavapipe and OSMesa, over a frame whose ao is
 * known to be neither open nor black. Exit code 77 (skipped) where there is no driver. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#include "../../examples/frame/runner_vk.c" /* a Vulkan device, and images with content */
#include "../../backends/hbil_gl.h"
#include <GL/glcorearb.h>

enum { WIDTH = 48, HEIGHT = 27 };

/* <<gl */
static char    scratch[HBIL_GLSL_MAX];
static hbil_gl gl_light;

/* Once, with your context current. get_proc: around SDL_GL_GetProcAddress, glfwGetProcAddress or the like. */
static int gl_start(const hbil_plan *plan, void *(*get_proc)(void *user, const char *name), void *user)
{
    hbil_gl_info info = {0};
    info.plan = plan;                                        /* of a config with target=gl */
    info.get_proc = get_proc;
    info.user = user;
    info.scratch = scratch;
    info.scratch_size = sizeof scratch;
    return hbil_gl_init(&info, &gl_light) == HBIL_GL_OK;     /* if not: gl_light.message says what to do */
}

/* When the size or a texture changes: your GL names, by the names of the plan (-1: this plan has no such texture). */
static int gl_size(const hbil_plan *plan, uint32_t width, uint32_t height, unsigned depth, unsigned normal, unsigned ao)
{
    unsigned textures[HBIL_MAX_TEXTURES] = {0};
    textures[hbil_plan_texture(plan, "depth")] = depth;
    textures[hbil_plan_texture(plan, "normal")] = normal;
    textures[hbil_plan_texture(plan, "ao")] = ao;            /* r32f, see hbil_gl_format */
    return hbil_gl_resize(&gl_light, width, height, textures) == HBIL_GL_OK;
}

/* Each frame, after your G-buffer. hbil_frame: size, projection, view, frame number. Then glMemoryBarrier, and sample ao. */
static int gl_frame(const hbil_frame *frame) { return hbil_gl_run(&gl_light, frame) == HBIL_GL_OK; }
/* >>gl */

/* <<vulkan */
static char     text[HBIL_GLSL_MAX];
static uint32_t words[HBIL_MAX_PASSES][32768];
static hbil_vk  vk_light;

/* Once. Or generate the words offline, and do without glslang. */
static int vk_start(const hbil_plan *plan, VkInstance instance, VkPhysicalDevice gpu, VkDevice on, uint32_t queue_family)
{
    hbil_vk_info info = {0};
    uint32_t     p;
    for (p = 0; p < plan->pass_count; ++p) {
        hbil_emit_glsl(plan, (int32_t)p, text, sizeof text, NULL);
        if (hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words[p], 32768, &info.spirv[p].count, NULL, 0) != HBIL_GLSLANG_OK) return 0;
        info.spirv[p].words = words[p];
    }
    info.plan = plan;
    info.instance = instance;
    info.physical_device = gpu;
    info.device = on;
    info.queue_family = queue_family;
    info.get_proc = vkGetInstanceProcAddr;
    info.input_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    return hbil_vk_init(&info, &vk_light) == HBIL_VK_OK;     /* if not: vk_light.message says what to do */
}

/* When the size or a view changes. made: how large your images are. Said once, and one that is too small is refused by name. */
static int vk_size(const hbil_plan *plan, uint32_t width, uint32_t height, VkExtent3D made, VkImageView depth, VkImageView normal,
                   VkImageView ao)
{
    VkImageView views[HBIL_MAX_TEXTURES] = {0};
    VkExtent3D  extents[HBIL_MAX_TEXTURES] = {0};
    views[hbil_plan_texture(plan, "depth")] = depth;
    views[hbil_plan_texture(plan, "normal")] = normal;
    views[hbil_plan_texture(plan, "ao")] = ao;               /* in GENERAL, before and after */
    extents[hbil_plan_texture(plan, "depth")] = extents[hbil_plan_texture(plan, "normal")] = made;
    extents[hbil_plan_texture(plan, "ao")] = made;
    vk_light.extents = extents;
    return hbil_vk_resize(&vk_light, width, height, views) == HBIL_VK_OK;
}

/* Each frame, after your G-buffer, outside a render pass; then submit as ever. */
static int vk_frame(VkCommandBuffer cmd, const hbil_frame *frame) { return hbil_vk_record(&vk_light, cmd, frame) == HBIL_VK_OK; }
/* >>vulkan */

static char error[512];

/* Of a valley seen from above, across the screen. m */
static float depth_at(float x) { return 4.0f - 0.06f * (x < 0.0f ? -x : x); }
static float right_at(float x) { return x * depth_at(x) * 2.0f / HEIGHT; } /* test_frame: 90 degrees of height */

/* Darker in its middle than on its banks. */
static void fill_valley(float *depth, float *normal)
{
    int i;
    for (i = 0; i < WIDTH * HEIGHT; ++i) {
        float x = (float)(i % WIDTH - WIDTH / 2);
        depth[i] = depth_at(x);
        normal[3 * i] = depth_at(x + 0.5f) - depth_at(x - 0.5f); /* of any length */
        normal[3 * i + 2] = right_at(x + 0.5f) - right_at(x - 0.5f);
    }
}

static hbil_plan plan_of(hbil_target target)
{
    hbil_config config;
    hbil_plan plan;
    memset(&config, 0, sizeof config);
    config.target = (int32_t)target;
    config.outputs = HBIL_OUTPUTS_AO;
    assert_int_equal(hbil_plan_build(&config, &plan, NULL), HBIL_OK);
    return plan;
}

static void check_valley(const float *ao)
{
    float middle = ao[HEIGHT / 2 * WIDTH + WIDTH / 2], bank = ao[HEIGHT / 2 * WIDTH + WIDTH / 8];
    print_message("ao %.3f in the valley, %.3f on its bank\n", (double)middle, (double)bank);
    assert_true(middle > 0.2f && middle < 0.98f && bank > middle);
}

static void vulkan_snippet(void **state)
{
    const VkExtent3D made[2] = { { WIDTH, HEIGHT - 1, 1 }, { WIDTH, HEIGHT, 1 } };
    static const uint32_t size[2] = { WIDTH, HEIGHT };
    const hbil_plan plan = plan_of(HBIL_TARGET_VULKAN);
    const hbil_frame frame = test_frame(&plan.config, WIDTH, HEIGHT);
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES], *depth, *normal;
    runner_info about;
    vk_device *d = (vk_device *)vk_open(1, &about, error, sizeof error);
    int32_t ao = hbil_plan_texture(&plan, "ao");
    int i;
    (void)state;
    if (!d) {
        print_message("skipped: %s\n", error);
        skip();
    }
    memset(inputs, 0, sizeof inputs);
    memset(outputs, 0, sizeof outputs);
    depth = &inputs[hbil_plan_texture(&plan, "depth")];
    normal = &inputs[hbil_plan_texture(&plan, "normal")];
    assert_true(image_make(depth, WIDTH, HEIGHT, 1) && image_make(normal, WIDTH, HEIGHT, 3));
    fill_valley(depth->data, normal->data);
    d->error = error;
    d->error_size = sizeof error;
    assert_true(vk_start(&plan, d->instance, d->gpu, d->device, d->family));
    /* the runner's images, which its own instance of the backend gets too */
    if (!set_plan(d, &plan) || !set_images(d, &plan, size, inputs, outputs) || !upload(d, &plan, inputs)) fail_msg("%s", error);
    for (i = 0; i < 2; ++i) {
        const int fits = vk_size(&plan, WIDTH, HEIGHT, made[i], d->images[hbil_plan_texture(&plan, "depth")].view,
                                 d->images[hbil_plan_texture(&plan, "normal")].view, d->images[ao].view);
        assert_int_equal(fits, i);
        if (!fits) assert_non_null(strstr(vk_light.message, "depth: your view is 48x26, the frame needs 48x27"));
    }
    assert_true(begin(d));
    if (!vk_frame(d->cmd, &frame)) fail_msg("%s", vk_light.message);
    assert_true(finish(d));
    if (!read_back(d, &plan, outputs)) fail_msg("%s", error);
    check_valley(outputs[ao].data);
    hbil_vk_shutdown(&vk_light);
    assert_int_equal(vk_messages(d), 0);
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]), image_free(&outputs[i]);
    vk_close(d);
}

void *runner_gl_proc(void *user, const char *name); /* in examples/frame/runner_gl.c */

static void *gl_of(void *device, const char *name)
{
    void *address = runner_gl_proc(device, name);
    assert_non_null(address);
    return address;
}

static unsigned gl_texture(void *device, GLenum format, GLenum channels, const float *data)
{
    PFNGLGENTEXTURESPROC generate;
    PFNGLBINDTEXTUREPROC bind;
    PFNGLTEXSTORAGE2DPROC storage;
    PFNGLTEXSUBIMAGE2DPROC upload_texels;
    void *p[4] = { gl_of(device, "glGenTextures"), gl_of(device, "glBindTexture"), gl_of(device, "glTexStorage2D"),
                   gl_of(device, "glTexSubImage2D") };
    unsigned name = 0;
    memcpy(&generate, &p[0], sizeof p[0]);
    memcpy(&bind, &p[1], sizeof p[0]);
    memcpy(&storage, &p[2], sizeof p[0]);
    memcpy(&upload_texels, &p[3], sizeof p[0]);
    generate(1, &name);
    bind(GL_TEXTURE_2D, name);
    storage(GL_TEXTURE_2D, 1, format, WIDTH, HEIGHT);
    if (data) upload_texels(GL_TEXTURE_2D, 0, 0, 0, WIDTH, HEIGHT, channels, GL_FLOAT, data);
    return name;
}

static void gl_snippet(void **state)
{
    static float depth[WIDTH * HEIGHT], normal[3 * WIDTH * HEIGHT], result[WIDTH * HEIGHT];
    const hbil_plan plan = plan_of(HBIL_TARGET_GL);
    const hbil_frame frame = test_frame(&plan.config, WIDTH, HEIGHT);
    PFNGLBINDTEXTUREPROC bind;
    PFNGLGETTEXIMAGEPROC read;
    PFNGLMEMORYBARRIERPROC wait;
    runner_info about;
    void *device = runner_gl.open(1, &about, error, sizeof error), *p;
    unsigned ao;
    (void)state;
    if (!device) {
        print_message("skipped: %s\n", error);
        skip();
    }
    fill_valley(depth, normal);
    assert_true(gl_start(&plan, runner_gl_proc, device));
    ao = gl_texture(device, GL_R32F, GL_RED, NULL);
    if (!gl_size(&plan, WIDTH, HEIGHT, gl_texture(device, GL_R32F, GL_RED, depth), gl_texture(device, GL_RGBA32F, GL_RGB, normal), ao))
        fail_msg("%s", gl_light.message);
    assert_true(gl_frame(&frame));
    p = gl_of(device, "glMemoryBarrier");
    memcpy(&wait, &p, sizeof p);
    wait(GL_TEXTURE_UPDATE_BARRIER_BIT);
    p = gl_of(device, "glBindTexture");
    memcpy(&bind, &p, sizeof p);
    bind(GL_TEXTURE_2D, ao);
    p = gl_of(device, "glGetTexImage");
    memcpy(&read, &p, sizeof p);
    read(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, result);
    check_valley(result);
    hbil_gl_shutdown(&gl_light);
    assert_int_equal(runner_gl.messages(device), 0);
    runner_gl.close(device);
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(vulkan_snippet), cmocka_unit_test(gl_snippet) };
    int failed;
    hbil_glslang_init();
    failed = cmocka_run_group_tests_name("snippets", tests, NULL, NULL);
    hbil_glslang_shutdown();
    return failed;
}
