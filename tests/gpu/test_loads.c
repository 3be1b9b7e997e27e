/* test_loads.c - how many texels a pixel loads, measured: the text of the passes march and light is rewritten so that every
 * texelFetch and textureLod counts, and the outputs hold the count. A table for all presets, and limits that must hold.
 * Works on the device of a runner, whose file it includes. Exit code 77 (skipped) where there is no Vulkan. */
#define HBIL_IMPLEMENTATION
#include "../test.h"

static hbil_result emit_counting(const hbil_plan *plan, int32_t pass, const char *hook, char *buf, size_t cap, size_t *need,
                                 hbil_diags *diags);
#define hbil_emit_glsl_hook emit_counting
#include "../../examples/frame/runner_vk.c"
#undef hbil_emit_glsl_hook

#include "../captures.h"
#include "../numeric/decimate.h"
#include "inputs.h"

static vk_device *device;
static char       error[512];
static capture    cap;

/* What is counted: loads of these textures. */
typedef struct kind { const char *name, *textures; } kind;
static const kind kinds[] = {
    { "depth", " view_depth depth_mips swept " }, { "normal", " view_normal " }, { "radiance", " radiance view_radiance radiance_mips swept_light " },
    { "environment", " sky probes " },
    { "other", " ao bent near far f0 roughness albedo direct " },
};
enum { DEPTH, NORMAL, RADIANCE, ENVIRONMENT, OTHER, KINDS };

static int counted; /* the kind that the next texts count */

/* ------------------------------------------------------------------------------------------------------ text that counts */

typedef struct writer { char *at, *end; } writer;

static void put(writer *w, const char *s, size_t n)
{
    assert_true((size_t)(w->end - w->at) > n);
    memcpy(w->at, s, n);
    w->at += n;
    *w->at = 0;
}

static void puts_to(writer *w, const char *s) { put(w, s, strlen(s)); }

/* From the ( at s to behind its ). */
static const char *behind_bracket(const char *s)
{
    int depth = 0;
    do {
        assert_true(*s);
        depth += *s == '(' ? 1 : *s == ')' ? -1 : 0;
        ++s;
    } while (depth);
    return s;
}

/* Is the sampler u_NAME at s of the kind that is counted? Every name must be of some kind. */
static int counts(const char *s)
{
    char name[32];
    int n = 0, k, known = 0;
    assert_memory_equal(s, "u_", 2);
    while (hbil__is_word(s[2 + n])) ++n;
    snprintf(name, sizeof name, " %.*s ", n, s + 2);
    for (k = 0; k < KINDS; ++k) known += strstr(kinds[k].textures, name) != NULL;
    if (known != 1) print_error("of no kind:%s\n", name);
    assert_int_equal(known, 1);
    return strstr(kinds[counted].textures, name) != NULL;
}

static void rewrite(writer *w, const char *s, const char *end);

/* The load at s, with the loads among its arguments. Returns what is behind it. */
static const char *rewrite_load(writer *w, const char *s)
{
    const char *open = strchr(s, '('), *end = behind_bracket(open);
    puts_to(w, counts(open + 1) ? "(hbil_loads += 1u, " : "(");
    put(w, s, (size_t)(open - s));
    rewrite(w, open, end);
    puts_to(w, ")");
    return end;
}

/* imageStore(u_X, p, v) stores the count instead. v is an argument of a function: its loads come first. */
static const char *rewrite_store(writer *w, const char *s)
{
    const char *open = strchr(s, '('), *end = behind_bracket(open), *at = open + 1;
    int depth = 0, commas = 0;
    for (; commas < 2; ++at) {
        assert_true(at < end);
        depth += *at == '(' ? 1 : *at == ')' ? -1 : 0;
        commas += *at == ',' && depth == 0;
    }
    put(w, s, (size_t)(at - s));
    puts_to(w, " hbil_count(");
    rewrite(w, at, end);
    puts_to(w, ")");
    return end;
}

static void rewrite(writer *w, const char *s, const char *end)
{
    while (s < end) {
        if (strncmp(s, "texelFetch(", 11) == 0 || strncmp(s, "textureLod(", 11) == 0) s = rewrite_load(w, s);
        else if (strncmp(s, "imageStore(", 11) == 0) s = rewrite_store(w, s);
        else put(w, s++, 1);
    }
}

static const char counter[] = "uint hbil_loads = 0u;\nvec4 hbil_count(vec4 v) { return vec4(float(hbil_loads)); }\n";

/* hbil_emit_glsl_hook, but for passes whose outputs others need. */
static hbil_result emit_counting(const hbil_plan *plan, int32_t pass, const char *hook, char *buf, size_t cap_text,
                                 size_t *need, hbil_diags *diags)
{
    static char text[HBIL_GLSL_MAX];
    writer w;
    const hbil_result result = hbil_emit_glsl_hook(plan, pass, hook, text, sizeof text, need, diags);
    const char *layout = strstr(text, "layout(local"), *body;
    if (result != HBIL_OK) return result;
    assert_non_null(layout);
    body = strchr(layout, '\n') + 1;
    if (strcmp(plan->passes[pass].name, "march") && strcmp(plan->passes[pass].name, "light"))
        body = layout = text + strlen(text);
    w.at = buf;
    w.end = buf + cap_text;
    put(&w, text, (size_t)(body - text));
    if (*body) puts_to(&w, counter);
    rewrite(&w, body, body + strlen(body));
    return HBIL_OK;
}

/* --------------------------------------------------------------------------------------------------------------- measure */

/* Loads of the pixels with a surface. */
typedef struct loads { double mean[KINDS]; int most[KINDS]; } loads;
typedef struct measured { hbil_plan plan; loads march, light; int prepare; } measured;

static int writes(const hbil_plan *plan, const hbil_pass *pass, uint32_t texture)
{
    uint32_t b;
    for (b = 0; b < pass->binding_count; ++b)
        if (pass->bindings[b].texture == texture && pass->bindings[b].access == HBIL_ACCESS_WRITE)
            return plan->textures[texture].life == HBIL_LIFE_OUTPUT;
    return 0;
}

/* The last store of a pass has all of its loads: the largest of its outputs. */
static void count_pass(const hbil_plan *plan, const char *name, const image out[HBIL_MAX_TEXTURES], loads *to)
{
    const int32_t index = hbil_plan_pass(plan, name);
    const int count = cap.width * cap.height;
    double sum = 0;
    int i, surfaces = 0, seen = 0;
    uint32_t t;
    if (index < 0) return;
    for (i = 0; i < count; ++i) {
        int n = 0;
        if (!(cap.depth.data[i] < 1e9f)) continue;
        for (t = 0; t < plan->texture_count; ++t) {
            const int last = writes(plan, &plan->passes[index], t) ? image_slices(&out[t]) - 1 : -1;
            if (last < 0) continue;
            const size_t at = (size_t)last * (size_t)count + (size_t)i;
            const int here = (int)out[t].data[at * (size_t)out[t].channels];
            seen = 1;
            if (here > n) n = here;
        }
        sum += n;
        ++surfaces;
        if (n > to->most[counted]) to->most[counted] = n;
    }
    assert_true(seen && surfaces > 0); /* an output must be there to hold the count */
    to->mean[counted] = sum / surfaces;
}

/* Fetches in the text of prepare. Each runs once per pixel: with normals=view it has no loop and calls nothing twice. */
static int count_prepare(const hbil_plan *plan)
{
    static char text[HBIL_GLSL_MAX];
    static uint32_t words[65536];
    size_t need = 0, i;
    int n = 0;
    assert_int_equal(plan->config.normals, HBIL_NORMALS_VIEW);
    assert_int_equal(hbil_emit_glsl(plan, hbil_plan_pass(plan, "prepare"), text, sizeof text, NULL), HBIL_OK);
    assert_int_equal(hbil_glslang_compile(text, HBIL_TARGET_VULKAN, words, 65536, &need, error, sizeof error),
                     HBIL_GLSLANG_OK);
    for (i = 5; i < need; i += words[i] >> 16) n += (words[i] & 0xffff) == 95; /* OpImageFetch */
    return n;
}

static void measure(const hbil_config *config, measured *m)
{
    const uint32_t size[2] = { (uint32_t)cap.width, (uint32_t)cap.height };
    hbil_frame frame;
    image in[HBIL_MAX_TEXTURES], out[HBIL_MAX_TEXTURES];
    int t;
    memset(m, 0, sizeof *m);
    memset(in, 0, sizeof in);
    assert_int_equal(hbil_plan_build(config, &m->plan, NULL), HBIL_OK);
    m->prepare = count_prepare(&m->plan);
    if (!inputs_encode(&cap, &m->plan, &frame, in, error, sizeof error)) fail_msg("%s", error);
    for (counted = 0; counted < KINDS; ++counted) {
        memset(out, 0, sizeof out);
        vk_set_hook(device, NULL); /* drops the pipelines: the next ones count something else */
        if (!vk_run(device, &m->plan, &frame, size, in, out, 1, NULL, error, sizeof error)) fail_msg("%s", error);
        count_pass(&m->plan, "march", out, &m->march);
        count_pass(&m->plan, "light", out, &m->light);
        for (t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&out[t]);
    }
    for (t = 0; t < HBIL_MAX_TEXTURES; ++t) image_free(&in[t]);
    assert_int_equal(vk_messages(device), 0);
}

static void measure_text(const char *text, measured *m)
{
    hbil_config c;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, text, strlen(text), NULL), HBIL_OK);
    measure(&c, m);
}

/* Most depth loads of the march: the pixel itself, and one per sample; bilinear samples have four, and eight for light. A side of a
 * sweep has one, and the jump that leads there. */
static int depth_limit(const hbil_config *c)
{
    if (c->march == HBIL_MARCH_SWEEP) return 1 + 4 * c->slices;
    return 1 + 2 * c->slices * c->steps * (c->sampling == HBIL_SAMPLING_NEAREST ? 1 : 12);
}

/* ----------------------------------------------------------------------------------------------------------------- tests */

static void print_row(const char *name, const char *note, const measured *m)
{
    double sum = m->prepare;
    int k;
    for (k = 0; k < KINDS; ++k) sum += m->march.mean[k] + m->light.mean[k];
    print_message("%-12s %4d x %-4d %5d |%8.1f %5d %7.1f %8.1f %6.1f %6.1f |%6.1f %6.1f %6.1f %6.1f | %8.1f%s\n", name,
                  (int)m->plan.config.slices, (int)m->plan.config.steps, m->prepare, m->march.mean[DEPTH],
                  m->march.most[DEPTH], m->march.mean[NORMAL], m->march.mean[RADIANCE], m->march.mean[ENVIRONMENT],
                  m->march.mean[OTHER],
                  m->light.mean[DEPTH], m->light.mean[NORMAL], m->light.mean[ENVIRONMENT], m->light.mean[OTHER], sum, note);
}

static void loads_per_pixel_of_each_preset(void **state)
{
    int32_t i;
    (void)state;
    print_message("loads per pixel, means over the pixels with a surface\n"
                  "%-12s slices x  pre- | march: depth                          envi-        | light:              envi-\n"
                  "%-12s      steps pare |    mean  most  normal radiance ronment  other | depth normal ronment  other |"
                  "      all\n", "", "");
    for (i = 0; hbil_preset_name(i); ++i) {
        hbil_config c;
        measured m;
        const char *note = "";
        assert_int_equal(hbil_config_preset(hbil_preset_name(i), &c, NULL), HBIL_OK);
        if (c.slices * c.steps > 256) { /* slow on a CPU */
            c.slices = 4;
            c.steps = 32;
            note = " (slices and steps reduced for this table)";
        }
        if (c.filter || c.temporal || c.downscale) { /* would mix the counts of neighbours and frames */
            c.filter = HBIL_FILTER_NONE;
            c.temporal = HBIL_TEMPORAL_NO;
            c.downscale = 1;
            note = " (the bare march; the pass sweep not counted)";
        }
        c.bounces = HBIL_BOUNCES_ONE;
        measure(&c, &m);
        print_row(hbil_preset_name(i), note, &m);
        assert_true(m.march.most[DEPTH] <= depth_limit(&m.plan.config));
        assert_true(m.march.mean[DEPTH] > 1);
        assert_true(m.march.most[RADIANCE] <= m.march.most[DEPTH]);
        assert_true(m.light.most[DEPTH] <= 1 && m.light.most[NORMAL] <= 1 && m.light.most[RADIANCE] == 0);
        assert_int_equal(m.march.most[ENVIRONMENT] + m.light.most[ENVIRONMENT], 0); /* of all presets: SH are uniforms */
    }
}

/* Ambient occlusion alone: depths, one normal, nothing else, and no pass behind the march. */
static void ao_loads_depth_and_one_normal(void **state)
{
    static const char *const configs[] = { "outputs=ao", "outputs=ao estimator=bitmask", "outputs=ao estimator=hbao reach=2",
        "outputs=ao estimator=hbao_plus", "outputs=ao occluder=heuristic", "outputs=ao+uniform_ao+bent",
        "outputs=ao+bent estimator=bitmask occluder=thick", "outputs=ao slices=1 steps=1",
        "outputs=ao spacing=geometric steps=40", "outputs=ao mips=spread", "outputs=ao march=sweep" };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof configs / sizeof configs[0]; ++i) {
        measured m;
        measure_text(configs[i], &m);
        assert_true(m.march.most[DEPTH] <= depth_limit(&m.plan.config));
        assert_true(m.march.most[DEPTH] > depth_limit(&m.plan.config) / 2); /* it does count */
        assert_int_equal(m.march.most[NORMAL], 1);
        assert_int_equal(m.march.most[RADIANCE] + m.march.most[ENVIRONMENT] + m.march.most[OTHER], 0);
        assert_int_equal(hbil_plan_pass(&m.plan, "light"), -1);
        assert_int_equal(m.prepare, 2);
    }
}

/* Near light changes nothing about the depths that are read, and each of them brings one radiance at most. The ways to leave
 * out what faces away also read the normal there. */
static void near_light_adds_one_radiance_per_depth(void **state)
{
    static const char *const estimators[] = { "", " estimator=bitmask", " occluder=heuristic", " facing=filter",
        " facing=half_space", " estimator=bitmask occluder=thick facing=half_space",
        " gather=packed", " gather=side", " mips=spread", " march=sweep" };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof estimators / sizeof estimators[0]; ++i) {
        char ao[128], near[128];
        measured a, n;
        const int faces = strstr(estimators[i], "facing") != NULL;
        snprintf(ao, sizeof ao, "outputs=ao%s", estimators[i]);
        snprintf(near, sizeof near, "outputs=ao+near%s", estimators[i]);
        measure_text(ao, &a);
        measure_text(near, &n);
        assert_true(n.march.mean[DEPTH] == a.march.mean[DEPTH] && n.march.most[DEPTH] == a.march.most[DEPTH]);
        /* the pixel's own depth has none */
        assert_true(n.march.most[RADIANCE] > 0 && n.march.most[RADIANCE] < n.march.most[DEPTH]);
        assert_true(n.march.mean[RADIANCE] < n.march.mean[DEPTH] - 1 + 1e-9);
        assert_int_equal(n.march.most[NORMAL], faces ? 1 + n.march.most[RADIANCE] : 1);
        assert_int_equal(n.march.most[ENVIRONMENT] + n.march.most[OTHER], 0);
    }
}

/* Spherical harmonics are uniforms; a cube map is read once per pixel, or per group of free sectors. */
static void far_light_by_sh_loads_no_environment(void **state)
{
    measured ao, sh, cube, probes, bits;
    (void)state;
    measure_text("outputs=ao", &ao);
    measure_text("outputs=ao+far environment=sh", &sh);
    measure_text("outputs=ao+far environment=cube", &cube);
    measure_text("outputs=ao+far environment=probes", &probes);
    measure_text("outputs=ao+far environment=cube estimator=bitmask far_visibility=free_bits", &bits);
    assert_memory_equal(&sh.march, &ao.march, sizeof ao.march);
    assert_int_equal(sh.light.most[ENVIRONMENT], 0);
    assert_int_equal(sh.light.most[DEPTH], 1);
    assert_int_equal(sh.light.most[OTHER], 2); /* ao, bent */
    assert_int_equal(cube.light.most[ENVIRONMENT], 1);
    assert_int_equal(probes.light.most[ENVIRONMENT], 9);
    assert_true(bits.march.most[ENVIRONMENT] > 0 && bits.march.most[ENVIRONMENT] <= 4 * bits.plan.config.slices);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loads_per_pixel_of_each_preset),
        cmocka_unit_test(ao_loads_depth_and_one_normal),
        cmocka_unit_test(near_light_adds_one_radiance_per_depth),
        cmocka_unit_test(far_light_by_sh_loads_no_environment),
    };
    const capture_names names = captures_list();
    runner_info about;
    int failed, ok;
    device = (vk_device *)vk_open(1, &about, error, sizeof error);
    if (!device) {
        printf("skipped: %s\n", error);
        return 77;
    }
    ok = names.count ? captures_load(names.name[0], 0, &cap, error, sizeof error) :
                       capture_scene(&cap, "cornell", 320, 180, 0, NULL, error, sizeof error);
    if (!ok || (names.count && !getenv("HBIL_LONG") && !decimate(&cap, 2))) { /* time */
        printf("%s\n", error);
        return 1;
    }
    printf("%s, %s; %s, %dx%d\n", about.device, about.driver, names.count ? names.name[0] : "built-in cornell", cap.width,
           cap.height);
    failed = cmocka_run_group_tests_name("loads", tests, NULL, NULL);
    capture_free(&cap);
    vk_close(device);
    return failed;
}
