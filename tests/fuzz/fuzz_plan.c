/* fuzz_plan.c - plans of any bytes, handed to every function of hbil.h that takes one and to hbil_null.h. */
#include "damage.h"
#include "../test.h"
#include "../../backends/hbil_null.h"

static const char *const configs[] = {
    "", "outputs=ao", "march=sweep slices=4 sweep_stride=2 filter=3x3", "temporal=yes bounces=recursive reproject=scatter downscale=2",
    "target=gl stage=fragment outputs=ao+near", "target=gles stage=fragment outputs=ao", "target=gl outputs=ao+sh environment=cube outputs=far",
    "environment=hook outputs=far", "dynamic=slices+steps+reach reach=2 environment=probes outputs=irradiance width=64 height=36" };

static void check_texts(const hbil_plan *p, uint32_t pass, int sound)
{
    static char text[4 * HBIL_GLSL_MAX];
    hbil_diag item;
    hbil_diags d = { &item, 1, 0 };
    size_t need = 0;
    hbil_result result = hbil_emit_glsl_hook(p, (int32_t)pass, "vec3 hbil_far_hook(vec3 a, vec3 b, float c) { return a; }", text,
                                             sizeof text, &need, &d);
    FUZZ_REQUIRE(sound || result == HBIL_E_ARG);
    FUZZ_REQUIRE(result != HBIL_OK || need == strlen(text) + 1);
    result = hbil_emit_manifest(p, text, sizeof text, &need);
    FUZZ_REQUIRE(sound == (result == HBIL_OK));
    FUZZ_REQUIRE(!sound || need == strlen(text) + 1);
    hbil_emit_vertex(p, text, sizeof text, NULL);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static hbil_plan p;
    fuzz_reader r = { data, size };
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_dispatch grid[HBIL_MAX_PASSES];
    hbil_diag items[4];
    hbil_diags d = { items, 4, 0 };
    hbil_frame f;
    uint32_t i, wh[2];
    int sound;
    damaged_plan(&r, configs, sizeof configs / sizeof *configs, &p);
    sound = hbil_plan_check(&p, &d) == HBIL_OK;
    FUZZ_REQUIRE(sound == (d.count == 0) && (sound || strncmp(items[0].text, "plan: ", 6) == 0));
    hbil_plan_texture(&p, "a_name_longer_than_any_of_a_plan");
    hbil_plan_pass(&p, "march");
    for (i = 0; i < 40; ++i) {
        hbil_plan_extent(&p, (int32_t)i - 1, 640, 360, wh);
        hbil_plan_register(&p, (int32_t)i / 2 - 1, (int32_t)i - 1);
    }
    hbil_plan_memory(&p, 16384, 16384);
    f = test_frame(&p.config, 64, 36);
    hbil_plan_frame(&p, &f, grid);
    FUZZ_REQUIRE(hbil_pack_constants(&p, &f, block, sizeof block, NULL, &d) != HBIL_OK || p.constants_size <= sizeof block);
    check_texts(&p, (uint32_t)size % 17, sound);
    d.count = 0;
    hbil_null_check(&p, 64, 36, &d);
    FUZZ_REQUIRE(d.count == 0 || memchr(items[0].text, 0, sizeof items[0].text));
    return 0;
}
