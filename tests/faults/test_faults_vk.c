/* test_faults_vk.c - Vulkan that fails: every call that can, made by hbil_vk.h or the runner, fails once, at each of its places; functions
 * that are missing, devices that have not what a plan needs, textures that are too small, recordings that are not executed, sizes that
 * change within a sequence, threads. Each gives an error that names cause and fix, leaks nothing, and a new start gives the same bytes.
 *
 * HBIL_LONG=1: every place with every error; else a slice of them, seeded by HBIL_SEED (default 1). HBIL_ONLY=NAME: tests of that name
 * alone, with * and ?. Exit code 77 (skipped) without Vulkan. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

#define VOLK_IMPLEMENTATION
#include <volk.h>
#include "vk_shim.h"
#define volkInitialize shim_initialize
#include "../../examples/frame/runner_vk.c"

#include "faults.h"

#include <pthread.h>

static int absorbed; /* faults that the program got round */

/* ------------------------------------------------------------------------------------------------- every call fails once */

/* Errors that a function may give, by the specification. */
static int faults_of(int call, VkResult out[8])
{
    int n = 0;
    out[n++] = VK_ERROR_OUT_OF_HOST_MEMORY;
    out[n++] = VK_ERROR_OUT_OF_DEVICE_MEMORY;
    if (call == CALL_QueueSubmit || call == CALL_WaitForFences || call == CALL_GetQueryPoolResults || call == CALL_CreateDevice)
        out[n++] = VK_ERROR_DEVICE_LOST;
    if (call == CALL_CreateComputePipelines || call == CALL_CreateShaderModule) out[n++] = (VkResult)-1000012000; /* INVALID_SHADER_NV */
    if (call == CALL_CreateComputePipelines || call == CALL_CreateInstance || call == CALL_CreateDevice)
        out[n++] = VK_ERROR_INITIALIZATION_FAILED;
    if (call == CALL_AllocateMemory || call == CALL_CreateSampler) out[n++] = VK_ERROR_TOO_MANY_OBJECTS;
    if (call == CALL_AllocateDescriptorSets) out[n++] = VK_ERROR_FRAGMENTED_POOL;
    if (call == CALL_AllocateDescriptorSets) out[n++] = VK_ERROR_OUT_OF_POOL_MEMORY;
    if (call == CALL_CreateInstance) out[n++] = VK_ERROR_INCOMPATIBLE_DRIVER;
    if (call == CALL_CreateInstance) out[n++] = VK_ERROR_LAYER_NOT_PRESENT;
    if (call == CALL_CreateInstance) out[n++] = VK_ERROR_EXTENSION_NOT_PRESENT;
    return n;
}

/* Does the message name what failed, and what to do? */
static void check_message(const char *message, int call, VkResult result)
{
    char number[32];
    const char *colon;
    snprintf(number, sizeof number, "VkResult %d", (int)result);
    if (call == CALL_EnumerateInstanceLayerProperties || result == VK_ERROR_INCOMPATIBLE_DRIVER) {
        assert_non_null(strstr(message, "apt-get install")); /* what the user can do is the better text */
        return;
    }
    if (call == CALL_GetPhysicalDeviceImageFormatProperties) {
        assert_non_null(strstr(message, "this device has no images of"));
        return;
    }
    if (!strstr(message, shim_names[call]) || !strstr(message, number)) fail_msg("%s, %s: \"%s\"", shim_names[call], number, message);
    colon = strstr(message, number) + strlen(number);
    if (colon[0] != ':' || strlen(colon) < 12) fail_msg("no fix: \"%s\"", message);
    if (result == VK_ERROR_DEVICE_LOST) assert_non_null(strstr(message, "make a new device"));
    if (result == VK_ERROR_OUT_OF_DEVICE_MEMORY) assert_non_null(strstr(message, "render smaller"));
}

static void fail_call(int call, int at, VkResult result)
{
    shim_clear();
    shim.call = call;
    shim.at = at;
    shim.result = result;
}

/* One fault in the life of a runner. It runs again by itself afterwards, or says that its device is lost and a new runner runs. */
static void fault_runner(const hbil_plan *plan, const float *want, int call, int at, VkResult result, int validate)
{
    float ao[TEXELS];
    int ok = 0, lost;
    runner *r;
    fail_call(call, at, result);
    r = runner_open("vulkan", validate, error, sizeof error);
    if (r) ok = run_frames(r, plan, WIDTH, HEIGHT, ao);
    if (shim.failed != 1) fail_msg("call %d of %s was not reached", at, shim_names[call]);
    lost = shim.lost;
    if (ok) ++absorbed;
    else check_message(error, call, result);
    shim.at = 0;
    if (r && lost) {
        assert_false(run_frames(r, plan, WIDTH, HEIGHT, ao));
        assert_non_null(strstr(error, "open another one"));
    }
    if (r && !ok && !lost) {
        if (!run_frames(r, plan, WIDTH, HEIGHT, ao)) fail_msg("%s, then: %s", shim_names[call], error);
        ok = 1;
    }
    if (r && !lost) assert_int_equal(runner_messages(r), 0);
    runner_close(r);
    assert_int_equal(shim.live_count, 0);
    assert_int_equal(shim.alien, 0);
    if (!ok && (lost || in_slice(4))) { /* a new one */
        r = runner_open("vulkan", 0, error, sizeof error);
        if (!r || !run_frames(r, plan, WIDTH, HEIGHT, ao)) fail_msg("%s, then: %s", shim_names[call], error);
        runner_close(r);
        ok = 1;
    }
    if (ok) assert_memory_equal(ao, want, sizeof ao);
    ++injected;
}

static void a_runner_survives_every_call_that_fails(void **state)
{
    const hbil_plan plan = plan_of(SMALL "temporal=yes multisample=yes", "vulkan");
    float want[TEXELS];
    int calls[CALLS], call, at, k, functions = 0, before = injected;
    runner *r;
    (void)state;
    shim_clear();
    r = runner_open("vulkan", 1, error, sizeof error);
    if (!r || !run_frames(r, &plan, WIDTH, HEIGHT, want)) fail_msg("%s", error);
    runner_close(r);
    memcpy(calls, shim.calls, sizeof calls);
    for (call = 0; call < CALLS; ++call) {
        VkResult results[8];
        const int count = faults_of(call, results);
        functions += calls[call] > 0;
        if (!calls[call] && call != CALL_DeviceWaitIdle) fail_msg("the runner never calls %s", shim_names[call]);
        for (at = 1; at <= calls[call]; ++at)
            for (k = 0; k < count; ++k)
                if (in_slice(calls[call] > 8 ? 40 : 20) || (at == 1 && k == call % count && call % 3 == 0))
                    fault_runner(&plan, want, call, at, results[k], 1);
    }
    print_message("runner: %d functions, %d faults\n", functions, injected - before);
}

/* ------------------------------------------------------------------------------------------------------- hbil_vk.h by itself */

/* A runner's device with images for a plan; `mine` is a backend of the test's own on them. */
typedef struct rig {
    vk_device *d;
    hbil_plan  plan;
    hbil_frame frame;
    image      inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    hbil_vk_info info;
    hbil_vk    mine;
    char      *text;
    uint32_t  *words;
} rig;

static void set_up(rig *g, const char *config)
{
    enum { WORDS = 1 << 17 };
    static const uint32_t size[2] = { WIDTH, HEIGHT };
    runner_info about;
    memset(g, 0, sizeof *g);
    shim_clear();
    g->plan = plan_of(config, "vulkan");
    g->frame = test_frame(&g->plan.config, WIDTH, HEIGHT);
    g->d = (vk_device *)vk_open(1, &about, error, sizeof error);
    if (!g->d) fail_msg("%s", error);
    make_inputs(&g->plan, WIDTH, HEIGHT, g->inputs);
    if (!set_plan(g->d, &g->plan) || !set_images(g->d, &g->plan, size, g->inputs, g->outputs) || !upload(g->d, &g->plan, g->inputs))
        fail_msg("%s", error);
    g->text = (char *)malloc(CAP_TEXT);
    g->words = (uint32_t *)malloc(WORDS * sizeof *g->words);
    assert_true(g->text && g->words && compile(g->d, &g->plan, g->text, g->words, WORDS, &g->info));
    g->info.instance = g->d->instance;
    g->info.physical_device = g->d->gpu;
    g->info.device = g->d->device;
    g->info.queue_family = g->d->family;
    g->info.get_proc = shim_proc;
    g->info.plan = &g->plan;
    g->info.input_layout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
    g->info.timestamps = 1;
}

static void tear_down(rig *g)
{
    hbil_vk_shutdown(&g->mine);
    assert_int_equal(vk_messages(g->d), 0);
    shim_clear();
    vk_close(g->d);
    free(g->text);
    free(g->words);
    free_images(g->inputs);
    free_images(g->outputs);
    assert_int_equal(shim.live_count, 0);
    assert_int_equal(shim.alien, 0);
}

static void views_of(const rig *g, VkImageView views[HBIL_MAX_TEXTURES])
{
    int t;
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) views[t] = g->d->images[t].view;
}

static hbil_vk_result resize(rig *g)
{
    VkImageView views[HBIL_MAX_TEXTURES];
    views_of(g, views);
    return hbil_vk_resize(&g->mine, WIDTH, HEIGHT, views);
}

static hbil_vk_result record(rig *g)
{
    hbil_vk_result result;
    assert_true(begin(g->d));
    result = hbil_vk_record(&g->mine, g->d->cmd, &g->frame);
    assert_true(finish(g->d));
    return result;
}

/* All four verbs on new frames; the ao of the last one. The first fault ends it. */
static hbil_vk_result live(rig *g, float ao[TEXELS])
{
    double ms[HBIL_MAX_PASSES];
    hbil_vk_result result = hbil_vk_init(&g->info, &g->mine);
    if (result == HBIL_VK_OK) result = resize(g);
    g->frame.reset = 1;
    if (result == HBIL_VK_OK) result = record(g);
    g->frame.reset = 0;
    if (result == HBIL_VK_OK) result = record(g);
    if (result == HBIL_VK_OK) result = hbil_vk_timings(&g->mine, ms);
    if (result != HBIL_VK_OK) return result;
    if (!read_back(g->d, &g->plan, g->outputs)) fail_msg("%s", error);
    memcpy(ao, g->outputs[hbil_plan_texture(&g->plan, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
    begin(g->d); /* outputs back to GENERAL, where the next frame wants them */
    transition(g->d, &g->d->images[hbil_plan_texture(&g->plan, "ao")], VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL,
               VK_ACCESS_TRANSFER_READ_BIT, VK_ACCESS_SHADER_WRITE_BIT);
    assert_true(finish(g->d));
    return HBIL_VK_OK;
}

static int is_the_runners(int call)
{
    return call == CALL_ResetCommandPool || call == CALL_BeginCommandBuffer || call == CALL_EndCommandBuffer ||
           call == CALL_QueueSubmit || call == CALL_WaitForFences || call == CALL_ResetFences;
}

static void fault_backend(rig *g, const float *want, int call, int at, VkResult result, int again)
{
    const int before = shim.live_count;
    float ao[TEXELS] = { 0 };
    hbil_vk_result got;
    fail_call(call, at, result);
    got = live(g, ao);
    if (shim.failed != 1) fail_msg("call %d of %s was not reached", at, shim_names[call]);
    if (got != HBIL_VK_E_VULKAN) fail_msg("call %d of %s: result %d", at, shim_names[call], (int)got);
    check_message(g->mine.message, call, result);
    if (g->mine.device == NULL) assert_int_equal(shim.live_count, before); /* init: nothing stays behind */
    shim.at = shim.lost = 0;
    if (g->mine.device != NULL && !g->mine.runnable) { /* resize */
        assert_int_equal(hbil_vk_record(&g->mine, g->d->cmd, &g->frame), HBIL_VK_E_FRAME);
        assert_non_null(strstr(g->mine.message, "hbil_vk_resize has to succeed first"));
        assert_int_equal(resize(g), HBIL_VK_OK); /* mended in place */
    }
    hbil_vk_shutdown(&g->mine);
    hbil_vk_shutdown(&g->mine);
    assert_int_equal(shim.live_count, before);
    assert_int_equal(shim.alien, 0);
    if (again) {
        if (live(g, ao) != HBIL_VK_OK) fail_msg("%s", g->mine.message);
        assert_memory_equal(ao, want, sizeof ao);
        hbil_vk_shutdown(&g->mine);
        assert_int_equal(shim.live_count, before);
    }
    ++injected;
}

static void the_backend_reports_every_call_that_fails(void **state)
{
    float want[TEXELS] = { 0 };
    int calls[CALLS], call, at, k, functions = 0, before = injected;
    rig g;
    (void)state;
    set_up(&g, SMALL "temporal=yes");
    shim_clear();
    assert_int_equal(live(&g, want), HBIL_VK_OK);
    memcpy(calls, shim.calls, sizeof calls);
    hbil_vk_shutdown(&g.mine);
    for (call = 0; call < CALLS; ++call) {
        VkResult results[8];
        const int count = faults_of(call, results);
        if (is_the_runners(call)) continue;
        functions += calls[call] > 0;
        for (at = 1; at <= calls[call]; ++at)
            for (k = 0; k < count; ++k) fault_backend(&g, want, call, at, results[k], in_slice(12));
    }
    assert_int_equal(functions, 15);
    tear_down(&g);
    print_message("hbil_vk.h: %d functions, %d faults\n", functions, injected - before);
}

static void init_names_the_function_that_is_missing(void **state)
{
#define NAME(name) "vk" #name,
    static const char *const needed[] = { HBIL_VK__INSTANCE_FUNCTIONS(NAME) HBIL_VK__DEVICE_FUNCTIONS(NAME) "vkGetDeviceProcAddr" };
    static const char *const optional[] = { HBIL_VK__OPTIONAL_FUNCTIONS(NAME) };
    float ao[TEXELS];
    size_t i;
    rig g;
    (void)state;
    set_up(&g, SMALL);
    for (i = 0; i < sizeof needed / sizeof *needed; ++i) {
        const int before = shim.live_count;
        shim.hidden = needed[i];
        assert_int_equal(hbil_vk_init(&g.info, &g.mine), HBIL_VK_E_ARG);
        assert_non_null(strstr(g.mine.message, needed[i]));
        assert_non_null(strstr(g.mine.message, "wrong instance"));
        assert_int_equal(shim.live_count, before);
        ++injected;
    }
    for (i = 0; i < sizeof optional / sizeof *optional; ++i) {
        shim.hidden = optional[i];
        assert_int_equal(live(&g, ao), HBIL_VK_OK);
        hbil_vk_shutdown(&g.mine);
        ++injected;
    }
    shim.hidden = NULL;
    assert_int_equal(live(&g, ao), HBIL_VK_OK);
    tear_down(&g);
}

/* ---------------------------------------------------------------------------------------------------- devices that lack something */

static void vulkan_1_0(VkPhysicalDeviceProperties *p)     { p->apiVersion = VK_API_VERSION_1_0; }
static void no_storage(VkPhysicalDeviceProperties *p)     { p->limits.maxPerStageDescriptorStorageImages = 0; }
static void no_samplers(VkPhysicalDeviceProperties *p)    { p->limits.maxPerStageDescriptorSamplers = 0; }
static void no_sampled(VkPhysicalDeviceProperties *p)     { p->limits.maxPerStageDescriptorSampledImages = 0; }
static void few_invocations(VkPhysicalDeviceProperties *p) { p->limits.maxComputeWorkGroupInvocations = 1; }
static void narrow_groups(VkPhysicalDeviceProperties *p)  { p->limits.maxComputeWorkGroupSize[0] = 1; }
static void no_layers(VkPhysicalDeviceProperties *p)      { p->limits.maxImageArrayLayers = 0; }
static void small_images(VkPhysicalDeviceProperties *p)   { p->limits.maxImageDimension2D = WIDTH - 1; }
static void no_compute(VkQueueFamilyProperties *p)        { p->queueFlags &= ~(VkQueueFlags)VK_QUEUE_COMPUTE_BIT; }
static void no_timestamps(VkQueueFamilyProperties *p)     { p->timestampValidBits = 0; }

static void none_is_local(VkPhysicalDeviceMemoryProperties *p)
{
    uint32_t i;
    for (i = 0; i < p->memoryTypeCount; ++i) p->memoryTypes[i].propertyFlags &= ~(VkMemoryPropertyFlags)VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
}

static VkFormat format_without;
static VkFormatFeatureFlags features_without;

static void without_feature(VkFormat format, VkFormatProperties *p)
{
    if (format == format_without) p->optimalTilingFeatures &= ~features_without;
}

static void expect_refused(rig *g, hbil_vk_result wanted, const char *part, const char *fix)
{
    const int before = shim.live_count;
    hbil_vk_result got = hbil_vk_init(&g->info, &g->mine);
    if (got == HBIL_VK_OK) got = resize(g);
    if (got != wanted || !strstr(g->mine.message, part) || !strstr(g->mine.message, fix))
        fail_msg("result %d, \"%s\", wanted %d, \"%s\", \"%s\"", (int)got, g->mine.message, (int)wanted, part, fix);
    hbil_vk_shutdown(&g->mine);
    assert_int_equal(shim.live_count, before);
    shim_clear();
    ++injected;
}

static void init_names_what_the_device_lacks(void **state)
{
    static const struct { void (*lie)(VkPhysicalDeviceProperties *); hbil_vk_result result; const char *part, *fix; } limits[] = {
        { vulkan_1_0, HBIL_VK_E_DEVICE, "Vulkan 1.0", "use another device or driver" },
        { no_storage, HBIL_VK_E_DEVICE, "images, the device allows 0", "fewer outputs" },
        { no_samplers, HBIL_VK_E_DEVICE, "textures, the device allows 0", "fewer inputs" },
        { no_sampled, HBIL_VK_E_DEVICE, "textures, the device allows 0", "fewer inputs" },
        { few_invocations, HBIL_VK_E_DEVICE, "the device allows 1 invocations", "use another device" },
        { narrow_groups, HBIL_VK_E_DEVICE, "1x", "use another device" },
        { no_layers, HBIL_VK_E_DEVICE, "layers, the device allows 0", "fewer slices" },
        { small_images, HBIL_VK_E_ARG, "size 19x11", "18x18" } };
    size_t i;
    uint32_t t;
    rig g;
    (void)state;
    set_up(&g, SMALL);
    for (i = 0; i < sizeof limits / sizeof *limits; ++i) {
        shim.properties = limits[i].lie;
        expect_refused(&g, limits[i].result, limits[i].part, limits[i].fix);
    }
    shim.families = no_compute;
    expect_refused(&g, HBIL_VK_E_ARG, "has no compute", "VK_QUEUE_COMPUTE_BIT");
    shim.families = no_timestamps;
    expect_refused(&g, HBIL_VK_E_DEVICE, "has no timestamps", "set timestamps to 0");
    shim.memory = none_is_local;
    expect_refused(&g, HBIL_VK_E_DEVICE, "no device-local memory", "yourself");
    for (t = 0; t < g.plan.texture_count; ++t) {
        const hbil_texture *tex = &g.plan.textures[t];
        if (tex->life == HBIL_LIFE_INPUT) continue;
        for (i = 0; i < 2; ++i) {
            format_without = hbil_vk_format((hbil_format)tex->format);
            features_without = i ? VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT : VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT;
            shim.format = without_feature;
            expect_refused(&g, HBIL_VK_E_DEVICE, hbil_format_name((hbil_format)tex->format), "change the options");
        }
    }
    tear_down(&g);
}

/* ---------------------------------------------------------------------------------------------- textures, frames, recordings */

static void a_view_that_is_too_small_is_refused_by_name(void **state)
{
    VkImageView views[HBIL_MAX_TEXTURES];
    VkExtent3D extents[HBIL_MAX_TEXTURES];
    float want[TEXELS] = { 0 };
    uint32_t t;
    int k, frames, yours = 0;
    rig g;
    (void)state;
    set_up(&g, "outputs=ao+near+sh slices=1 steps=1 bounces=recursive downscale=2");
    assert_int_equal(live(&g, want), HBIL_VK_OK);
    frames = (int)g.mine.frames;
    views_of(&g, views);
    for (t = 0; t < g.plan.texture_count; ++t) {
        const hbil_texture *tex = &g.plan.textures[t];
        uint32_t need[2] = { 0, 0 };
        assert_int_equal(hbil_plan_extent(&g.plan, (int32_t)t, WIDTH, HEIGHT, need), HBIL_OK);
        if (tex->life > HBIL_LIFE_OUTPUT) continue;
        ++yours;
        for (k = 0; k < 3; ++k) {
            memset(extents, 0, sizeof extents); /* all others: not told */
            extents[t].width = need[0] - (k == 0);
            extents[t].height = need[1] - (k == 1);
            extents[t].depth = tex->layers - (uint32_t)(k == 2);
            if (k == 2 && tex->dim != HBIL_DIM_2D_ARRAY) continue;
            g.mine.extents = extents;
            assert_int_equal(hbil_vk_resize(&g.mine, WIDTH, HEIGHT, views), HBIL_VK_E_TEXTURE);
            assert_null(g.mine.extents);
            assert_non_null(strstr(g.mine.message, tex->name));
            assert_non_null(strstr(g.mine.message, k == 2 ? "has 3 layers, the plan needs 4" : "make it that large"));
            assert_int_equal(record(&g), HBIL_VK_E_FRAME); /* before any dispatch */
            ++injected;
        }
        extents[t].width = need[0] + 1;
        extents[t].height = need[1];
        extents[t].depth = tex->layers;
        g.mine.extents = extents;
        assert_int_equal(hbil_vk_resize(&g.mine, WIDTH, HEIGHT, views), HBIL_VK_OK); /* larger is fine */
    }
    assert_true(yours > 4);
    assert_int_equal(resize(&g), HBIL_VK_OK); /* not told at all is fine */
    assert_int_equal(g.mine.fresh, 0);        /* and a refusal has not cost the history */
    assert_int_equal((int)g.mine.frames, frames);
    views[hbil_plan_texture(&g.plan, "depth")] = VK_NULL_HANDLE;
    assert_int_equal(hbil_vk_resize(&g.mine, WIDTH, HEIGHT, views), HBIL_VK_E_ARG);
    assert_int_equal(record(&g), HBIL_VK_E_FRAME);
    tear_down(&g);
}

static void a_frame_larger_than_the_images_is_refused(void **state)
{
    rig g;
    int k;
    (void)state;
    set_up(&g, SMALL);
    assert_int_equal(hbil_vk_init(&g.info, &g.mine), HBIL_VK_OK);
    assert_int_equal(record(&g), HBIL_VK_E_FRAME); /* no resize yet */
    assert_int_equal(resize(&g), HBIL_VK_OK);
    for (k = 0; k < 2; ++k) {
        g.frame.width = WIDTH + (k == 0);
        g.frame.height = HEIGHT + (k == 1);
        assert_int_equal(record(&g), HBIL_VK_E_FRAME);
        assert_non_null(strstr(g.mine.message, "the images are 19x11: call hbil_vk_resize"));
        ++injected;
    }
    g.frame.height = HEIGHT;
    assert_int_equal(record(&g), HBIL_VK_OK);
    tear_down(&g);
}

/* Recorded, and thrown away: images stay in UNDEFINED, which the layer would tell if the next recording did not set them up. */
static void a_recording_that_was_not_executed_is_made_up_for(void **state)
{
    float want[TEXELS] = { 0 }, ao[TEXELS] = { 0 };
    rig g;
    (void)state;
    set_up(&g, SMALL "temporal=yes");
    assert_int_equal(live(&g, want), HBIL_VK_OK);
    hbil_vk_shutdown(&g.mine);
    assert_int_equal(hbil_vk_init(&g.info, &g.mine), HBIL_VK_OK);
    assert_int_equal(resize(&g), HBIL_VK_OK);
    assert_true(begin(g.d));
    assert_int_equal(hbil_vk_record(&g.mine, g.d->cmd, &g.frame), HBIL_VK_OK);
    assert_true(begin(g.d)); /* which resets */
    assert_true(finish(g.d));
    g.mine.fresh = 1;
    assert_int_equal(record(&g), HBIL_VK_OK);
    assert_int_equal(record(&g), HBIL_VK_OK);
    g.mine.fresh = 1; /* also in the midst of things */
    assert_int_equal(record(&g), HBIL_VK_OK);
    assert_int_equal(record(&g), HBIL_VK_OK);
    assert_true(read_back(g.d, &g.plan, g.outputs));
    memcpy(ao, g.outputs[hbil_plan_texture(&g.plan, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
    assert_memory_equal(ao, want, sizeof ao);
    ++injected;
    tear_down(&g);
}

/* ------------------------------------------------------------------------------------------------------------ sizes, threads */

static void sizes_may_change_within_a_sequence(void **state)
{
    (void)state;
    shim_clear();
    change_sizes("vulkan");
}

typedef struct job {
    vk_device *d;
    hbil_plan  plan;
    float      want[TEXELS];
    int        rounds, wrong;
    char       error[512];
} job;

static int one_round(vk_device *d, const hbil_plan *plan, float ao[TEXELS], char *text, size_t size)
{
    static const uint32_t extent[2] = { WIDTH, HEIGHT };
    image inputs[HBIL_MAX_TEXTURES], outputs[HBIL_MAX_TEXTURES];
    int f, ok = 1;
    make_inputs(plan, WIDTH, HEIGHT, inputs);
    for (f = 0; f < FRAMES && ok; ++f) {
        hbil_frame frame = test_frame(&plan->config, WIDTH, HEIGHT);
        frame.index = (uint32_t)f;
        frame.reset = f == 0;
        memset(outputs, 0, sizeof outputs);
        ok = vk_run(d, plan, &frame, extent, inputs, outputs, 1, NULL, text, size);
        if (ok) memcpy(ao, outputs[hbil_plan_texture(plan, "ao")].data, WIDTH * HEIGHT * sizeof *ao);
        free_images(outputs);
    }
    free_images(inputs);
    return ok;
}

static void *work(void *user)
{
    job *j = (job *)user;
    float ao[TEXELS];
    int i;
    memset(ao, 0, sizeof ao);
    for (i = 0; i < j->rounds; ++i) {
        if (i % 2) hbil_vk_shutdown(&j->d->backend); /* pipelines are made beside the other's work, too */
        if (!one_round(j->d, &j->plan, ao, j->error, sizeof j->error) || memcmp(ao, j->want, sizeof ao) != 0) ++j->wrong;
    }
    return NULL;
}

static void run_both(job jobs[2])
{
    pthread_t threads[2];
    int i;
    for (i = 0; i < 2; ++i) {
        memset(jobs[i].want, 0, sizeof jobs[i].want);
        if (!one_round(jobs[i].d, &jobs[i].plan, jobs[i].want, error, sizeof error)) fail_msg("%s", error); /* alone */
        jobs[i].rounds = getenv("HBIL_LONG") ? 24 : 4;
        jobs[i].wrong = 0;
    }
    for (i = 0; i < 2; ++i) assert_int_equal(pthread_create(&threads[i], NULL, work, &jobs[i]), 0);
    for (i = 0; i < 2; ++i) pthread_join(threads[i], NULL);
    for (i = 0; i < 2; ++i)
        if (jobs[i].wrong) fail_msg("thread %d: %d rounds differ %s", i, jobs[i].wrong, jobs[i].error);
}

/* A second command pool and backend on the device of another. */
static void share_device(vk_device *b, const vk_device *a)
{
    STRUCT(VkCommandPoolCreateInfo, pool, COMMAND_POOL_CREATE_INFO);
    STRUCT(VkCommandBufferAllocateInfo, cmd, COMMAND_BUFFER_ALLOCATE_INFO);
    STRUCT(VkFenceCreateInfo, fence, FENCE_CREATE_INFO);
    memset(b, 0, sizeof *b);
    b->instance = a->instance;
    b->gpu = a->gpu;
    b->memory_types = a->memory_types;
    b->device = a->device;
    b->family = a->family;
    b->queue = a->queue;
    b->timestamps = a->timestamps;
    pool.queueFamilyIndex = b->family;
    assert_int_equal(vkCreateCommandPool(b->device, &pool, NULL, &b->pool), VK_SUCCESS);
    cmd.commandPool = b->pool;
    cmd.commandBufferCount = 1;
    assert_int_equal(vkAllocateCommandBuffers(b->device, &cmd, &b->cmd), VK_SUCCESS);
    assert_int_equal(vkCreateFence(b->device, &fence, NULL, &b->fence), VK_SUCCESS);
}

static void drop_shared(vk_device *b)
{
    int t;
    hbil_vk_shutdown(&b->backend);
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) drop_image(b, &b->images[t]);
    drop_staging(b);
    vkDestroyFence(b->device, b->fence, NULL);
    vkDestroyCommandPool(b->device, b->pool, NULL);
}

static void two_threads_have_a_device_each_or_share_one(void **state)
{
    static job jobs[2];
    static vk_device shared;
    runner_info about;
    int i;
    (void)state;
    shim_clear();
    for (i = 0; i < 2; ++i) {
        jobs[i].plan = plan_of(i ? SMALL "temporal=yes filter=3x3" : SMALL "temporal=yes estimator=bitmask", "vulkan");
        jobs[i].d = (vk_device *)vk_open(1, &about, error, sizeof error);
        assert_non_null(jobs[i].d);
    }
    run_both(jobs);
    assert_int_equal(vk_messages(jobs[0].d) + vk_messages(jobs[1].d), 0);
    vk_close(jobs[1].d);
    share_device(&shared, jobs[0].d);
    jobs[1].d = &shared;
    run_both(jobs);
    drop_shared(&shared);
    assert_int_equal(vk_messages(jobs[0].d), 0);
    vk_close(jobs[0].d);
    assert_int_equal(shim.live_count, 0);
}

/* -------------------------------------------------------------------------------------------------------- opening, validation */

static void opening_names_what_is_missing(void **state)
{
    (void)state;
    shim_clear();
    shim_no_loader = 1;
    assert_null(runner_open("vulkan", 0, error, sizeof error));
    assert_non_null(strstr(error, "no Vulkan loader: apt-get install libvulkan1"));
    shim_no_loader = 0;
    fail_call(CALL_EnumerateInstanceLayerProperties, 1, VK_ERROR_OUT_OF_HOST_MEMORY);
    assert_null(runner_open("vulkan", 1, error, sizeof error));
    assert_non_null(strstr(error, "no validation layer: apt-get install vulkan-validationlayers"));
    shim_clear();
    shim.properties = vulkan_1_0;
    assert_null(runner_open("vulkan", 0, error, sizeof error));
    assert_non_null(strstr(error, "no device with Vulkan 1.1 and compute: there are "));
    shim_clear();
    shim.families = no_compute;
    assert_null(runner_open("vulkan", 0, error, sizeof error));
    assert_non_null(strstr(error, "no device with Vulkan 1.1 and compute: there are "));
    shim_clear();
    assert_null(runner_open("metal", 0, error, sizeof error));
    assert_non_null(strstr(error, "use vulkan, gl or gles"));
    assert_int_equal(shim.live_count, 0);
    injected += 5;
}

/* That all else is silent is worth something only if this is not. */
static void validation_hears_misuse_of_each_kind(void **state)
{
    STRUCT(VkCommandPoolCreateInfo, pool, COMMAND_POOL_CREATE_INFO);
    VkCommandPool extra;
    int i, count;
    rig g;
    (void)state;
    set_up(&g, SMALL);
    assert_int_equal(vk_messages(g.d), 0);
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT; /* best practices */
    assert_int_equal(vkCreateCommandPool(g.d->device, &pool, NULL, &extra), VK_SUCCESS);
    vkDestroyCommandPool(g.d->device, extra, NULL);
    assert_true(vk_messages(g.d) > 0);
    count = vk_messages(g.d);
    assert_true(begin(g.d)); /* synchronisation: written twice with nothing in between */
    vkCmdFillBuffer(g.d->cmd, g.d->staging, 0, 16, 1);
    vkCmdFillBuffer(g.d->cmd, g.d->staging, 0, 16, 2);
    assert_true(vk_messages(g.d) > count);
    count = vk_messages(g.d);
    vkCmdDispatch(g.d->cmd, 1, 1, 1); /* validity: of no pipeline. Never submitted */
    assert_true(vk_messages(g.d) > count);
    assert_true(begin(g.d));
    assert_true(finish(g.d));
    g.d->messages = 0;
    tear_down(&g);
    for (i = 0; i < EXCUSED; ++i)
        if (!excused_seen[i]) fail_msg("%s never comes: take its row out of runner_vk.c", excused[i].id);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(opening_names_what_is_missing),
        cmocka_unit_test(validation_hears_misuse_of_each_kind),
        cmocka_unit_test(the_backend_reports_every_call_that_fails),
        cmocka_unit_test(init_names_the_function_that_is_missing),
        cmocka_unit_test(init_names_what_the_device_lacks),
        cmocka_unit_test(a_view_that_is_too_small_is_refused_by_name),
        cmocka_unit_test(a_frame_larger_than_the_images_is_refused),
        cmocka_unit_test(a_recording_that_was_not_executed_is_made_up_for),
        cmocka_unit_test(a_runner_survives_every_call_that_fails),
        cmocka_unit_test(sizes_may_change_within_a_sequence),
        cmocka_unit_test(two_threads_have_a_device_each_or_share_one),
    };
    runner *r = runner_open("vulkan", 1, error, sizeof error);
    int failed;
    if (!r) {
        printf("skipped: %s\n", error);
        return 77;
    }
    printf("%s, %s\n", runner_about(r)->device, runner_about(r)->driver);
    runner_close(r);
    if (getenv("HBIL_SEED")) seed = (uint32_t)strtoul(getenv("HBIL_SEED"), NULL, 10);
    printf("seed %u\n", seed);
    if (getenv("HBIL_ONLY")) cmocka_set_test_filter(getenv("HBIL_ONLY"));
    failed = cmocka_run_group_tests_name("faults_vk", tests, NULL, NULL);
    printf("faults of Vulkan: %d injected, %d of them got round, %d tests failed\n", injected, absorbed, failed);
    return failed;
}
