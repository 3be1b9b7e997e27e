/* test_core.c - the parts of the core: numbers, parser, sinks, diagnostics, filter, planner arguments, frame checks. */

#define HBIL_IMPLEMENTATION
#include "../test.h"

static char text[HBIL_GLSL_MAX];

static const char *number(float v, int point)
{
    static char buf[64];
    hbil__sink s = hbil__sink_open(buf, sizeof buf);
    hbil__put_float(&s, v, point);
    hbil__sink_close(&s, NULL);
    return buf;
}

static void floats_are_written_short_and_plain(void **state)
{
    (void)state;
    assert_string_equal(number(0.0f, 0), "0");
    assert_string_equal(number(0.0f, 1), "0.0");
    assert_string_equal(number(2.0f, 1), "2.0");
    assert_string_equal(number(2.5f, 0), "2.5");
    assert_string_equal(number(0.1f, 0), "0.1");
    assert_string_equal(number(1e-5f, 1), "0.00001");
    assert_string_equal(number(1e9f, 1), "1000000000.0");
    assert_string_equal(number(1e15f, 0), "1000000000000000");
    assert_string_equal(number(9.999999f, 0), "9.999999");
    assert_string_equal(number(9.9999999f, 0), "10");
    assert_string_equal(number(99999.5f, 0), "99999.5");
    assert_string_equal(number(-0.25f, 1), "-0.25");
    assert_string_equal(number(16777216.0f, 0), "16777216");
}

static void floats_read_back_equal(void **state)
{
    uint32_t bits, count = 0;
    (void)state;
    for (bits = 0x3089705fu; bits < 0x5a0e1bcau; bits += 4999) { /* 1e-9 .. 1e16 */
        float v, back;
        double d;
        memcpy(&v, &bits, sizeof v);
        number(v, 0);
        assert_true(hbil__read_number(number(v, 0), strlen(number(v, 0)), &d));
        back = (float)d;
        assert_memory_equal(&v, &back, sizeof v);
        back = strtof(number(v, 1), NULL); /* libc agrees (the test runs in the C locale) */
        assert_memory_equal(&v, &back, sizeof v);
        ++count;
    }
    print_message("%u floats\n", count);
}

static void parser_reads_files_and_reports_every_line(void **state)
{
    static const char good[] = "# a config\nslices = 4, steps=8\r\n\toutputs=ao+near # light\n\n";
    static const char bad[] = "slices=0\nslises=3\nsteps\n=5\nreach=-1 spacing=cubic\nsteps=9";
    static const char *const expected[] = { "line 1: slices=0", "line 2: slises: no such option; did you mean slices?",
                                            "line 3: expected name=value", "line 4: ", "line 5: reach=-1", "line 5: spacing=cubic" };
    hbil_diag items[8];
    hbil_diags diags = { items, 8, 0 };
    hbil_config c;
    int i;
    (void)state;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, good, sizeof good - 1, &diags), HBIL_OK);
    assert_int_equal(diags.count, 0);
    assert_int_equal(c.slices, 4);
    assert_int_equal(c.steps, 8);
    assert_int_equal(c.outputs, HBIL_OUTPUTS_AO | HBIL_OUTPUTS_NEAR);
    assert_int_equal(hbil_config_parse(&c, bad, sizeof bad - 1, &diags), HBIL_E_CONFIG);
    assert_int_equal(diags.count, 6);
    for (i = 0; i < 6; ++i) assert_memory_equal(items[i].text, expected[i], strlen(expected[i]));
    assert_int_equal(c.steps, 9); /* what is right is set */
    assert_int_equal(c.slices, 4);
    assert_int_equal(hbil_config_parse(&c, "a\0b=1", 5, NULL), HBIL_E_CONFIG); /* ends, on any bytes */
    assert_int_equal(hbil_config_parse(&c, "\0\0", 2, NULL), HBIL_E_CONFIG);
    assert_int_equal(hbil_config_parse(&c, NULL, 0, NULL), HBIL_OK);
}

static void diagnostics_count_beyond_their_capacity(void **state)
{
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    static const char bad[] = "slices=0 steps=0 exponent=0";
    (void)state;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, bad, sizeof bad - 1, &diags), HBIL_E_CONFIG);
    assert_int_equal(diags.count, 3);
    assert_non_null(strstr(item.text, "slices=0"));
    c.guard = 7;
    assert_int_equal(hbil_config_resolve(&c, &c, NULL), HBIL_E_CONFIG);
}

/* Every text function: need - 1, need, 0 and NULL. */
static void too_small_buffers_are_told_and_never_overrun(void **state)
{
    hbil_config c;
    hbil_plan p;
    int kind;
    (void)state;
    memset(&c, 0, sizeof c);
    c.slices = 5;
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
#define CALL(buf, cap, need) (kind == 0 ? hbil_emit_glsl(&p, 1, buf, cap, need) : kind == 1 ? hbil_emit_manifest(&p, buf, cap, need) : \
                              hbil_config_print(&c, 1, buf, cap, need))
    for (kind = 0; kind < 3; ++kind) {
        static char whole[HBIL_GLSL_MAX];
        size_t need = 0, again = 0, cap;
        assert_int_equal(CALL(NULL, 0, &need), HBIL_E_SPACE);
        assert_true(need > 10 && need < HBIL_GLSL_MAX);
        assert_int_equal(CALL(whole, need, &again), HBIL_OK);
        assert_int_equal(again, need);
        assert_int_equal(strlen(whole), need - 1);
        memset(text, 'x', sizeof text);
        assert_int_equal(CALL(text, need - 1, &again), HBIL_E_SPACE);
        assert_int_equal(again, need);
        assert_int_equal(strlen(text), need - 2);
        assert_memory_equal(text, whole, need - 2);
        assert_int_equal(text[need - 1], 'x');
        for (cap = 1; cap < 5; ++cap) {
            memset(text, 'x', 8);
            assert_int_equal(CALL(text, cap, NULL), HBIL_E_SPACE);
            assert_int_equal(strlen(text), cap - 1);
            assert_int_equal(text[cap], 'x');
        }
        assert_int_equal(CALL(whole, need, NULL), HBIL_OK);
    }
#undef CALL
}

static int holds(const hbil_config *c, const char *expression) { return hbil__holds(c, expression); }

static void expressions_follow_c(void **state)
{
    hbil_config c;
    (void)state;
    memset(&c, 0, sizeof c);
    c.slices = 4;
    c.dynamic = HBIL_DYNAMIC_STEPS;
    assert_int_equal(hbil_config_resolve(&c, &c, NULL), HBIL_OK);
    assert_true(holds(&c, ""));
    assert_true(holds(&c, "HBIL_SLICES_4"));
    assert_false(holds(&c, "HBIL_SLICES_3"));
    assert_false(holds(&c, "HBIL_STEPS_6")); /* dynamic: no baked value */
    assert_true(holds(&c, "HBIL_REACH_0"));
    assert_true(holds(&c, "HBIL_OUTPUTS_AO && HBIL_TARGET_VULKAN"));
    assert_true(holds(&c, "0 || !0 && 1"));
    assert_false(holds(&c, "(1 || 0) && 0"));
    assert_true(holds(&c, "1 || 0 && 0")); /* && binds tighter */
    assert_false(holds(&c, "!(HBIL_OUTPUTS_AO)"));
    assert_true(holds(&c, "!!HBIL_OUTPUTS_AO"));
    assert_true(holds(&c, "HBIL_DYNAMIC_STEPS && !HBIL_DYNAMIC_SLICES"));
}

static void filter_follows_nested_branches(void **state)
{
    static const char source[] = "a\n#if 0\nb\n#if 1\nc\n#else\nd\n#endif\n#elif 1\ne\n#if 0\nf\n#elif 0\ng\n#else\nh\n#endif\n#else\ni\n#endif\nj\n";
    hbil_config c;
    hbil__lines l;
    const char *line;
    size_t len, n = 0;
    (void)state;
    memset(&c, 0, sizeof c);
    l = hbil__lines_of(&c, source);
    while (hbil__next_line(&l, &line, &len)) text[n++] = *line;
    text[n] = 0;
    assert_string_equal(text, "aehj");
}

static void bad_arguments_are_refused_and_outputs_left_alone(void **state)
{
    hbil_config c;
    hbil_plan p, before;
    hbil_frame f;
    hbil_dispatch d[HBIL_MAX_PASSES];
    uint32_t wh[2] = { 7, 7 };
    (void)state;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
    before = p;
    c.slices = 65;
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_E_CONFIG);
    assert_memory_equal(&p, &before, sizeof p);
    assert_int_equal(hbil_plan_build(NULL, &p, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_plan_build(&c, NULL, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_emit_glsl(&p, -1, text, sizeof text, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_emit_glsl(&p, (int32_t)p.pass_count, text, sizeof text, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_plan_extent(&p, 99, 4, 4, wh), HBIL_E_ARG);
    assert_int_equal(hbil_plan_extent(&p, 0, 0, 4, wh), HBIL_E_ARG);
    assert_int_equal(hbil_plan_extent(&p, 0, 16385, 4, wh), HBIL_E_ARG);
    assert_int_equal(wh[0], 7);
    f = test_frame(&p.config, 17, 9);
    assert_int_equal(hbil_plan_frame(&p, &f, d), HBIL_OK);
    assert_int_equal(d[0].groups[0], 3);
    assert_int_equal(d[0].groups[1], 2);
    assert_int_equal(hbil_config_set(&c, "slices", NULL, NULL), HBIL_E_ARG);
    assert_null(hbil_option_at(-1));
    assert_null(hbil_option_at(hbil_option_count()));
    assert_string_equal(hbil_result_name((hbil_result)99), "unknown");
    assert_string_equal(hbil_format_name((hbil_format)0), "unknown");
    assert_string_equal(hbil_format_name(HBIL_FORMAT_RGBA32F), "rgba32f");
    assert_int_equal(hbil_version(), HBIL_VERSION);
    assert_int_equal(hbil_plan_memory(&before, 100, 100), 100 * 100 * 8); /* view_depth + view_normal */
}

static void presets_resolve_and_unknown_ones_suggest(void **state)
{
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    int32_t i;
    (void)state;
    for (i = 0; hbil_preset_name(i); ++i) {
        hbil_plan p;
        assert_int_equal(hbil_config_preset(hbil_preset_name(i), &c, NULL), HBIL_OK);
        assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
        assert_true(strlen(hbil_preset_meaning(i)) > 0);
    }
    assert_true(i >= 4);
    assert_int_equal(hbil_config_preset("balancd", &c, &diags), HBIL_E_CONFIG);
    assert_non_null(strstr(item.text, "balanced"));
}

static void options_without_effect_are_put_back_with_a_note(void **state)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    hbil_config a, b;
    static const char inert[] = "spacing=geometric exponent=3 falloff=0.5 dynamic=exponent+slices";
    static const char plain[] = "spacing=geometric dynamic=slices";
    (void)state;
    memset(&a, 0, sizeof a);
    b = a;
    assert_int_equal(hbil_config_parse(&a, inert, sizeof inert - 1, NULL), HBIL_OK);
    assert_int_equal(hbil_config_parse(&b, plain, sizeof plain - 1, NULL), HBIL_OK);
    assert_true(hbil_config_hash(&a) == hbil_config_hash(&b));
    assert_int_equal(hbil_config_resolve(&a, &a, &diags), HBIL_OK);
    assert_int_equal(diags.count, 2);
    assert_int_equal(items[0].severity, HBIL_NOTE);
    assert_memory_equal(items[0].text, "exponent has no effect", 22);
}

static void combinations_without_meaning_are_refused(void **state)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    hbil_config c;
    (void)state;
    memset(&c, 0, sizeof c);
    c.width = 640;
    c.dynamic = HBIL_DYNAMIC_REACH;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_E_CONFIG);
    assert_int_equal(diags.count, 2);
    assert_non_null(strstr(items[0].text, "set both or neither"));
    assert_non_null(strstr(items[1].text, "reach"));
}

static void more_iterations_than_mesa_runs_are_warned_about(void **state)
{
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    hbil_config c;
    (void)state;
    memset(&c, 0, sizeof c);
    c.slices = 64;
    c.steps = 500;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 0);
    c.steps = 501;
    assert_int_equal(hbil_config_resolve(&c, &c, &diags), HBIL_OK);
    assert_int_equal(diags.count, 1);
    assert_int_equal(item.severity, HBIL_WARNING);
}

/* ---------------------------------------------------------------------- frames */

static hbil_plan plan_of(const char *config)
{
    hbil_config c;
    hbil_plan p;
    memset(&c, 0, sizeof c);
    assert_int_equal(hbil_config_parse(&c, config, strlen(config), NULL), HBIL_OK);
    assert_int_equal(hbil_plan_build(&c, &p, NULL), HBIL_OK);
    return p;
}

static float constant(const hbil_plan *p, const hbil_frame *f, const char *name, int component)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    float v;
    uint32_t i;
    if (hbil_pack_constants(p, f, block, sizeof block, NULL, &diags) != HBIL_OK) fail_msg("%s", item.text);
    for (i = 0; i < p->constant_count; ++i)
        if (strcmp(p->constants[i].name, name) == 0) {
            memcpy(&v, block + p->constants[i].offset + 4 * component, 4);
            return v;
        }
    fail_msg("no constant %s", name);
    return 0;
}

static void near_float(float a, double b, double tolerance)
{
    const double x = (double)a;
    if (!(x - b <= tolerance && b - x <= tolerance)) fail_msg("%.9g is not %.9g", x, b);
}

/* 90 degree camera 64 x 36: ray x = (pixel * 2/64 - 1) * 64/36, y up. */
static void rays_follow_the_matrix_also_off_centre(void **state)
{
    hbil_plan p = plan_of("");
    hbil_frame f = test_frame(&p.config, 64, 36);
    (void)state;
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 0), 2.0 / 36, 1e-7);
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 1), -2.0 / 36, 1e-7);
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 2), -64.0 / 36, 1e-6);
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 3), 1.0, 1e-6);
    near_float(constant(&p, &f, "HBIL_VIEW_Z", 0), -1, 0);
    f.projection[8] = 0.1f; /* clip x = p0 X + 0.1 Z, Z = -depth: ndc = p0 x/depth - 0.1 */
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 2), (-1 + 0.1) * 64.0 / 36, 1e-6);
    f.projection[8] = -0.1f; /* the same camera left-handed: clip w = +Z */
    f.projection[11] = 1;
    near_float(constant(&p, &f, "HBIL_PIXEL_TO_RAY", 2), (-1 + 0.1) * 64.0 / 36, 1e-6);
    near_float(constant(&p, &f, "HBIL_VIEW_Z", 0), 1, 0);
}

static void depth_constants_invert_every_convention(void **state)
{
    static const char *const directions[] = { "forward", "reversed" }, *const fars[] = { "finite", "infinite" },
                            *const clips[] = { "vulkan", "gl" };
    int a, b, k;
    char config[160];
    (void)state;
    for (a = 0; a < 2; ++a)
        for (b = 0; b < 2; ++b)
            for (k = 0; k < 2; ++k) {
                hbil_plan p;
                hbil_frame f;
                snprintf(config, sizeof config, "depth=device depth_direction=%s depth_far=%s clip=%s", directions[a], fars[b], clips[k]);
                p = plan_of(config);
                f = test_frame(&p.config, 64, 36); /* near 0.1, far 100 or infinite */
                near_float(constant(&p, &f, "HBIL_DEPTH_TO_VIEW", 0), b ? 10 : 9.99, 1e-4);
                near_float(constant(&p, &f, "HBIL_DEPTH_TO_VIEW", 1), b ? 0 : 0.01, 1e-5);
                snprintf(config, sizeof config, "projection=orthographic depth=device depth_direction=%s clip=%s", directions[a], clips[k]);
                p = plan_of(config);
                f = test_frame(&p.config, 64, 36);
                near_float(constant(&p, &f, "HBIL_DEPTH_TO_VIEW", 0), 0.1 - 100, 1e-3); /* depth falls towards d = 1 */
                near_float(constant(&p, &f, "HBIL_DEPTH_TO_VIEW", 1), 100, 1e-3);
                near_float(constant(&p, &f, "HBIL_VIEW_Z", 0), -1, 0);
            }
}

static void refuse_frame(const hbil_plan *p, const hbil_frame *f, const char *what)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_diag item;
    hbil_diags diags = { &item, 1, 0 };
    assert_int_equal(hbil_pack_constants(p, f, block, sizeof block, NULL, &diags), HBIL_E_FRAME);
    assert_true(diags.count >= 1);
    if (!strstr(item.text, what)) fail_msg("\"%s\" does not say \"%s\"", item.text, what);
}

static void frames_that_do_not_fit_are_refused_with_the_fix(void **state)
{
    hbil_plan linear = plan_of("width=64 height=36"), forward = plan_of("depth=device"), ortho = plan_of("projection=orthographic"),
              reversed = plan_of("depth=device depth_direction=reversed"), infinite = plan_of("depth=device depth_far=infinite"),
              world = plan_of("normals=world");
    hbil_frame f = test_frame(&linear.config, 64, 36);
    (void)state;
    f.width = 65;
    refuse_frame(&linear, &f, "differs from the baked one");
    f.width = 64;
    f.guard = 1;
    refuse_frame(&forward, &f, "zero the struct");
    f.guard = 0;
    refuse_frame(&reversed, &f, "set depth_direction=forward");
    refuse_frame(&infinite, &f, "set depth_far=finite");
    refuse_frame(&ortho, &f, "set projection=perspective");
    f = test_frame(&reversed.config, 64, 36);
    refuse_frame(&forward, &f, "needs depth_direction=reversed");
    f.projection[0] = 0;
    refuse_frame(&forward, &f, "view x must map to clip x");
    f.projection[0] = 1.0f / 0.0f;
    refuse_frame(&forward, &f, "NaN or infinity");
    f = test_frame(&ortho.config, 64, 36);
    refuse_frame(&forward, &f, "set projection=orthographic");
    f = test_frame(&world.config, 64, 36);
    f.view[0] = 2;
    refuse_frame(&world, &f, "remove scale");
    f.height = 0;
    refuse_frame(&world, &f, "[1, 16384]");
}

/* A frame behind another: the motion between the two spaces, z into the screen, and what a frame without a last one says. */
static void last_frame_is_related_to_this_one(void **state)
{
    hbil_plan p = plan_of("temporal=yes reproject=scatter downscale=2");
    hbil_frame f = test_frame(&p.config, 65, 36);
    float v;
    int32_t i;
    (void)state;
    f.view[12] = 0.5f; /* the world moves right and away from this frame's camera, */
    f.view[14] = -2;
    near_float(constant(&p, &f, "HBIL_LAST_FROM_VIEW", 0), 1, 0);
    near_float(constant(&p, &f, "HBIL_LAST_FROM_VIEW", 3), -0.5, 1e-7); /* so a point was 0.5 further left and 2 m nearer */
    near_float(constant(&p, &f, "HBIL_LAST_FROM_VIEW", 11), -2, 1e-7);
    near_float(constant(&p, &f, "HBIL_VIEW_FROM_LAST", 3), 0.5, 1e-7);
    near_float(constant(&p, &f, "HBIL_VIEW_FROM_LAST", 11), 2, 1e-7);
    f.last_width = 33;
    v = constant(&p, &f, "HBIL_LAST_SIZE", 0);
    memcpy(&i, &v, 4);
    assert_int_equal(i, 17); /* of the grid, rounded up */
    {
        hbil_plan drawn = plan_of("target=gl stage=fragment temporal=yes bounces=recursive outputs=near downscale=2");
        uint32_t k;
        v = constant(&drawn, &f, "HBIL_LAST_FULL_SIZE", 0);
        memcpy(&i, &v, 4);
        assert_int_equal(i, 33); /* u_bounce has the frame's size there: a fragment writes its own pixel */
        assert_int_equal(drawn.textures[hbil_plan_texture(&drawn, "bounce")].div, 1);
        assert_int_equal(p.textures[hbil_plan_texture(&p, "seen")].div, 2);
        for (k = 0; k < drawn.pass_count; ++k) assert_int_equal(drawn.passes[k].group[0] * drawn.passes[k].group[1], 1);
    }
    f.reset = 1; /* nothing of the last frame is read */
    memset(f.last_projection, 0, sizeof f.last_projection);
    memset(f.last_view, 0, sizeof f.last_view);
    near_float(constant(&p, &f, "HBIL_LAST_FROM_VIEW", 3), 0, 1e-7);
    f.reset = 0;
    refuse_frame(&p, &f, "set reset=1 in the first frame");
    memcpy(f.last_projection, f.projection, sizeof f.projection);
    refuse_frame(&p, &f, "last_view: not a rotation");
    memcpy(f.last_view, f.view, sizeof f.view);
    f.last_height = 16385;
    refuse_frame(&p, &f, "last_width and last_height");
}

static void the_vertex_shader_is_there_for_fragments_only(void **state)
{
    hbil_plan drawn = plan_of("target=gles stage=fragment outputs=ao"), computed = plan_of("outputs=ao");
    char exact[512];
    size_t need = 0;
    (void)state;
    assert_int_equal(hbil_emit_vertex(&drawn, NULL, 0, &need), HBIL_E_SPACE);
    assert_in_range(need, 2, sizeof exact);
    assert_int_equal(hbil_emit_vertex(&drawn, text, sizeof text, NULL), HBIL_OK);
    assert_int_equal(strlen(text) + 1, need);
    assert_memory_equal(text, "#version 300 es\n", 16);
    assert_int_equal(hbil_emit_vertex(&drawn, exact, need, NULL), HBIL_OK);
    assert_int_equal(hbil_emit_vertex(&drawn, exact, need - 1, NULL), HBIL_E_SPACE);
    assert_int_equal(hbil_emit_vertex(&computed, text, sizeof text, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_emit_vertex(NULL, text, sizeof text, NULL), HBIL_E_ARG);
    assert_int_equal(hbil_emit_vertex(&drawn, NULL, 4, NULL), HBIL_E_ARG);
}

static void dynamic_options_are_read_from_live_and_checked(void **state)
{
    hbil_plan p = plan_of("slices=2 reach=3 dynamic=slices+reach");
    hbil_frame f = test_frame(&p.config, 64, 36);
    hbil_config live;
    float v;
    int32_t i;
    (void)state;
    memset(&live, 0, sizeof live);
    near_float(constant(&p, &f, "HBIL_REACH", 0), 3, 0);
    f.live = &live; /* zeros: the plan's values */
    near_float(constant(&p, &f, "HBIL_REACH", 0), 3, 0);
    live.reach = 4.5f;
    live.slices = 7;
    near_float(constant(&p, &f, "HBIL_REACH", 0), 4.5, 0);
    v = constant(&p, &f, "HBIL_SLICES", 0);
    memcpy(&i, &v, 4);
    assert_int_equal(i, 7);
    live.slices = 65;
    refuse_frame(&p, &f, "slices=65: must be in [1, 64]");
}

static void packing_needs_the_whole_block(void **state)
{
    hbil_plan p = plan_of("");
    hbil_frame f = test_frame(&p.config, 64, 36);
    unsigned char block[HBIL_CONSTANTS_MAX];
    size_t need = 0;
    (void)state;
    assert_int_equal(hbil_pack_constants(&p, &f, NULL, 0, &need, NULL), HBIL_E_SPACE);
    assert_int_equal(need, p.constants_size);
    memset(block, 0xee, sizeof block);
    assert_int_equal(hbil_pack_constants(&p, &f, block, need - 1, NULL, NULL), HBIL_E_SPACE);
    assert_int_equal(block[0], 0xee);
    assert_int_equal(hbil_pack_constants(&p, &f, block, need, NULL, NULL), HBIL_OK);
    assert_int_equal(block[need], 0xee);
}

/* ---------------------------------------------------------------------- hook */

#define HOOK_HEAD "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture)"

static hbil_result emit_hook(const char *hook, hbil_diags *diags)
{
    static char out[2 * HBIL_GLSL_MAX];
    hbil_config c;
    hbil_plan   plan;
    memset(&c, 0, sizeof c);
    c.outputs = HBIL_OUTPUTS_FAR;
    c.environment = HBIL_ENVIRONMENT_HOOK;
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    assert_int_equal(plan.passes[2].hook, 1);
    assert_int_equal(plan.passes[1].hook, 0);
    return hbil_emit_glsl_hook(&plan, 2, hook, out, sizeof out, NULL, diags);
}

static void hooks_in_any_legal_form_are_taken(void **state)
{
    static const char *const good[] = {
        HOOK_HEAD " { return direction; }",
        "vec3 hbil_far_hook(const in vec3 p, highp vec3 d, in float c)\r\n{\r\n return d; }\r\n",
        "vec3 hbil_far_hook(vec3, vec3 d, float) { return d; }",
        "// vec3 hbil_far_hook(\n/* main { */ const float k = 1.0;\nvec3 f(vec3 x) { return x; }\n" HOOK_HEAD " { return k * f(direction); }",
        "#define OPEN {\n" HOOK_HEAD " { return direction; }",
        "#ifdef A\n" HOOK_HEAD " { return direction; }\n#else\n" HOOK_HEAD " { return position; }\n#endif\n",
        HOOK_HEAD " { vec3 main = direction; return main; }",
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof good / sizeof good[0]; ++i) {
        if (emit_hook(good[i], NULL) != HBIL_OK) fail_msg("refused: %s", good[i]);
    }
}

static void hooks_that_cannot_work_are_refused_with_the_reason(void **state)
{
    static const struct { const char *hook, *word; } bad[] = {
        { NULL, "no text" }, { "", "no function" }, { "vec3 hbil_far_hook(vec3 d) { return d; }", "no function" },
        { "vec4 hbil_far_hook(vec3 p, vec3 d, float c) { return d.xyzz; }", "no function" },
        { "// " HOOK_HEAD " { return direction; }", "no function" },
        { HOOK_HEAD ";", "no function" },
        { "# version 450\n" HOOK_HEAD " { return direction; }", "#version" },
        { "#\tversion 450\n" HOOK_HEAD " { return direction; }", "#version" },
        { HOOK_HEAD " { return direction; } void main() { }", "main" },
        { HOOK_HEAD " { return direction; ", "braces" }, { "} " HOOK_HEAD " { return direction; } {", "braces" },
        { HOOK_HEAD " { return direction; } /* and", "comment" },
        { "#if 1\n" HOOK_HEAD " { return direction; }", "#endif" },
        { HOOK_HEAD " { return direction; } " HOOK_HEAD " { return position; }", "twice" },
    };
    size_t i;
    (void)state;
    for (i = 0; i < sizeof bad / sizeof bad[0]; ++i) {
        hbil_diag item;
        hbil_diags diags = { &item, 1, 0 };
        assert_int_equal(emit_hook(bad[i].hook, &diags), HBIL_E_HOOK);
        assert_int_equal(diags.count, 1);
        if (!strstr(item.text, bad[i].word)) fail_msg("%s: says %s", bad[i].hook ? bad[i].hook : "NULL", item.text);
    }
}

/* Behind the hook our own lines go on counting where they stand. */
static void lines_behind_a_hook_have_their_true_numbers(void **state)
{
    static char out[HBIL_GLSL_MAX];
    hbil_config c;
    hbil_plan   plan;
    const char *s, *mark;
    int line = 1;
    (void)state;
    memset(&c, 0, sizeof c);
    c.outputs = HBIL_OUTPUTS_FAR;
    c.environment = HBIL_ENVIRONMENT_HOOK;
    assert_int_equal(hbil_plan_build(&c, &plan, NULL), HBIL_OK);
    assert_int_equal(hbil_emit_glsl_hook(&plan, 2, HOOK_HEAD " {\n return direction;\n}\n", out, sizeof out, NULL, NULL), HBIL_OK);
    mark = strstr(strstr(out, "#line 1 1") + 1, "#line ");
    assert_non_null(mark);
    for (s = out; s < mark; ++s) line += *s == '\n';
    assert_int_equal(strtol(mark + 6, NULL, 10), line + 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_are_written_short_and_plain),
        cmocka_unit_test(floats_read_back_equal),
        cmocka_unit_test(parser_reads_files_and_reports_every_line),
        cmocka_unit_test(diagnostics_count_beyond_their_capacity),
        cmocka_unit_test(too_small_buffers_are_told_and_never_overrun),
        cmocka_unit_test(expressions_follow_c),
        cmocka_unit_test(filter_follows_nested_branches),
        cmocka_unit_test(bad_arguments_are_refused_and_outputs_left_alone),
        cmocka_unit_test(presets_resolve_and_unknown_ones_suggest),
        cmocka_unit_test(options_without_effect_are_put_back_with_a_note),
        cmocka_unit_test(combinations_without_meaning_are_refused),
        cmocka_unit_test(more_iterations_than_mesa_runs_are_warned_about),
        cmocka_unit_test(rays_follow_the_matrix_also_off_centre),
        cmocka_unit_test(depth_constants_invert_every_convention),
        cmocka_unit_test(frames_that_do_not_fit_are_refused_with_the_fix),
        cmocka_unit_test(last_frame_is_related_to_this_one),
        cmocka_unit_test(the_vertex_shader_is_there_for_fragments_only),
        cmocka_unit_test(dynamic_options_are_read_from_live_and_checked),
        cmocka_unit_test(packing_needs_the_whole_block),
        cmocka_unit_test(hooks_in_any_legal_form_are_taken),
        cmocka_unit_test(hooks_that_cannot_work_are_refused_with_the_reason),
        cmocka_unit_test(lines_behind_a_hook_have_their_true_numbers),
    };
    return cmocka_run_group_tests_name("core", tests, NULL, NULL);
}
