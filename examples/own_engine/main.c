/* hbil-own-engine - a plan in an engine of one's own. What stands between the two marks is what you write, and what
 * backends/README.md quotes; rhi.h stands in for your RHI, executes nothing, logs each call and checks it. */
#define HBIL_IMPLEMENTATION
#include "rhi.h"

/* What environment=hook calls: a white sky. */
static const char hook[] = "vec3 hbil_far_hook(vec3 position, vec3 direction, float cos_aperture) { return vec3(1); }";

/* <<outline */
typedef struct engine {
    hbil_plan plan;
    int       texture[HBIL_MAX_TEXTURES][2], pipeline[HBIL_MAX_PASSES];
    int       frames;                                                        /* that ran so far */
} engine;

/* Once, and when config or size changes. */
static hbil_result engine_init(engine *e, const hbil_config *config, uint32_t width, uint32_t height, hbil_diags *diags)
{
    static char text[HBIL_GLSL_MAX + sizeof hook];
    hbil_result result = hbil_plan_build(config, &e->plan, diags);
    uint32_t    t, k, p, size[2];
    for (t = 0; result == HBIL_OK && t < e->plan.texture_count; ++t) {
        const hbil_texture *texture = &e->plan.textures[t];
        if (texture->copies > 2) return HBIL_E_SPACE;                        /* no plan has more */
        result = hbil_plan_extent(&e->plan, (int32_t)t, width, height, size);
        for (k = 0; result == HBIL_OK && k < texture->copies; ++k)
            if (texture->life <= HBIL_LIFE_OUTPUT) e->texture[t][k] = engine_texture(texture); /* you have it already */
            else e->texture[t][k] = rhi_texture(texture, size);
    }
    for (p = 0; result == HBIL_OK && p < e->plan.pass_count; ++p) {
        result = hbil_emit_glsl_hook(&e->plan, (int32_t)p, hook, text, sizeof text, NULL, diags);
        if (result == HBIL_OK) e->pipeline[p] = rhi_pipeline(text, e->plan.passes[p].name);
    }
    e->frames = 0;
    return result;
}

/* Each frame. With HISTORY textures: last_projection and last_view are those of the frame before, or reset is 1. */
static hbil_result engine_run(engine *e, const hbil_frame *frame, hbil_diags *diags)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_dispatch grid[HBIL_MAX_PASSES];
    size_t        bytes;
    uint32_t      p, b, k;
    hbil_result   result = hbil_pack_constants(&e->plan, frame, block, sizeof block, &bytes, diags);
    if (result == HBIL_OK) result = hbil_plan_frame(&e->plan, frame, grid);
    for (p = 0; result == HBIL_OK && p < e->plan.pass_count; ++p) {
        const hbil_pass *pass = &e->plan.passes[p];
        for (b = 0; b < pass->barrier_count; ++b) {                          /* before -> after, all compute */
            const hbil_barrier *barrier = &pass->barriers[b];
            for (k = 0; k < e->plan.textures[barrier->texture].copies; ++k)
                rhi_barrier(e->texture[barrier->texture][k], barrier->before, barrier->after);
        }
        for (b = 0; b < pass->binding_count; ++b) {
            const hbil_binding *bind = &pass->bindings[b];
            int copies = e->plan.textures[bind->texture].copies, copy = (e->frames + copies - bind->age) % copies;
            rhi_bind(bind->slot, e->texture[bind->texture][copy], bind->access, bind->mip);
        }
        if (pass->constants) rhi_uniforms((int)e->plan.constants_slot, block, bytes);
        rhi_dispatch(e->pipeline[p], grid[p].groups);
    }
    if (result == HBIL_OK) ++e->frames;
    return result;
}
/* >>outline */

/* A camera that moves to the left. */
static const hbil_frame *frame_of(int index)
{
    static const float projection[16] = { 1, 0, 0, 0, 0, 1.78f, 0, 0, 0, 0, -1.001f, -1, 0, 0, -.1001f, 0 };
    static hbil_frame frame;
    memcpy(frame.last_view, frame.view, sizeof frame.view);
    memcpy(frame.last_projection, projection, sizeof projection);
    memcpy(frame.projection, projection, sizeof projection);
    frame.view[0] = frame.view[5] = frame.view[10] = frame.view[15] = 1;
    frame.view[12] = .1f * (float)index;
    frame.width = 320;
    frame.height = 180;
    frame.index = (uint32_t)index;
    frame.reset = index == 0;
    return &frame;
}

static int help(FILE *f, int code)
{
    fputs("usage: hbil-own-engine [NAME=VALUE ...]\n\n"
          "Gives the plan of a config to an RHI that executes nothing, for three frames, and prints its log.\n"
          "The options are those of hbil.h; none is temporal=yes bounces=recursive facing=half_space downscale=2.\n"
          "exit: 0 done, 1 config or frame refused, 2 wrong usage, 3 cannot write, 4 lines of the log say FAULT\n", f);
    return code;
}

int main(int argc, char **argv)
{
    static engine e;
    hbil_config config = {0};
    hbil_diag   items[16];
    hbil_diags  diags = { items, 16, 0 };
    hbil_result result = HBIL_OK;
    int         i;
    for (i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) return help(stdout, 0);
        if (strchr(argv[i], '=') == NULL) return help(stderr, 2);
        if (hbil_config_parse(&config, argv[i], strlen(argv[i]), &diags) != HBIL_OK) result = HBIL_E_CONFIG;
    }
    if (argc == 1) {
        config.temporal = HBIL_TEMPORAL_YES;
        config.bounces = HBIL_BOUNCES_RECURSIVE;
        config.facing = HBIL_FACING_HALF_SPACE;
        config.downscale = 2;
    }
    if (config.stage == HBIL_STAGE_FRAGMENT) {
        fputs("hbil-own-engine: this RHI dispatches; drawing is in backends/hbil_gl.h. Leave stage=fragment out\n", stderr);
        return 1;
    }
    if (result == HBIL_OK) result = engine_init(&e, &config, 320, 180, &diags);
    for (i = 0; result == HBIL_OK && i < 3; ++i) {
        rhi_begin_frame(i == 0);
        result = engine_run(&e, frame_of(i), &diags);
    }
    for (i = 0; i < diags.count && i < diags.capacity; ++i) fprintf(stderr, "hbil-own-engine: %s\n", items[i].text);
    if (result != HBIL_OK) return 1;
    printf("%d checks, %d faults\n", rhi.checks, rhi.faults);
    if (fflush(stdout) != 0 || ferror(stdout)) return 3;
    return rhi.faults ? 4 : 0;
}
