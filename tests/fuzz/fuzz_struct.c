/* fuzz_struct.c - hbil_config and hbil_frame of any bytes: resolve, plan, text, manifest, uniform block.
 *
 *   0, config, frame                              the structs as they lie in memory
 *   n, n times { option, kind, value }, { offset, 4 bytes }...   options one by one; then words of a frame that fits */
#include "fuzz.h"
#include "../test.h"
#include "../../backends/hbil_null.h"

#include <math.h>

#include <cJSON.h>

static void take_options(fuzz_reader *r, uint32_t count, hbil_config *c)
{
    while (count-- && r->left) {
        const hbil_option *o = hbil_option_at((int32_t)(fuzz_take(r, 1) % (uint32_t)hbil_option_count()));
        uint32_t kind = fuzz_take(r, 1), value = kind & 1 ? fuzz_take(r, 4) : fuzz_take(r, 2);
        if (!(kind & 1)) { /* near what is legal */
            float f = (float)(o->min + (o->max - o->min) * (double)value / 65000);
            int32_t i = (int32_t)(o->min - 1) + (int32_t)(value % (uint32_t)(o->max - o->min + 3 > 65536 ? 65536 : o->max - o->min + 3));
            if (o->kind == HBIL_KIND_FLOAT) memcpy(&value, &f, sizeof f);
            else if (o->kind != HBIL_KIND_SET) memcpy(&value, &i, sizeof i);
            else if (o->max > 65535) value |= (value & 3) << 16;
        }
        memcpy((char *)c + o->offset, &value, sizeof value);
    }
}

static void take_raw(fuzz_reader *r, void *out, size_t size)
{
    size_t n = r->left < size ? r->left : size;
    memcpy(out, r->at, n);
    r->at += n;
    r->left -= n;
}

/* The pointer stays ours. */
static void take_frame(fuzz_reader *r, int raw, const hbil_config *resolved, const hbil_config *live, hbil_frame *f)
{
    memset(f, 0, sizeof *f);
    if (raw) take_raw(r, f, offsetof(hbil_frame, live));
    else *f = test_frame(resolved, 64, 36);
    if (!raw && resolved->width) f->width = f->height = 0;
    while (!raw && r->left) {
        uint32_t offset = fuzz_take(r, 2) % (uint32_t)(offsetof(hbil_frame, live) / 4), word = fuzz_take(r, 4);
        memcpy((char *)f + 4 * offset, &word, sizeof word);
    }
    f->live = live;
}

static int is_whole(uint16_t type) { return type == HBIL_TYPE_INT || type == HBIL_TYPE_UINT || type == HBIL_TYPE_IVEC2; }

/* A block that is accepted holds numbers. */
static void check_block(const hbil_plan *p, const hbil_frame *f)
{
    unsigned char block[HBIL_CONSTANTS_MAX];
    hbil_diag items[4];
    hbil_diags d = { items, 4, 0 };
    hbil_dispatch grid[HBIL_MAX_PASSES];
    size_t need = 0;
    uint32_t i, at, end;
    hbil_result result = hbil_pack_constants(p, f, block, sizeof block, &need, &d);
    hbil_plan_frame(p, f, grid);
    FUZZ_REQUIRE(result == HBIL_OK || (result == HBIL_E_FRAME && d.count > 0 && items[0].text[0]));
    if (result != HBIL_OK) return;
    FUZZ_REQUIRE(need == p->constants_size);
    for (i = 0; i < p->constant_count; ++i) {
        end = i + 1 < p->constant_count ? p->constants[i + 1].offset : p->constants_size;
        for (at = p->constants[i].offset; at < end && !is_whole(p->constants[i].type); at += 4) {
            float v;
            memcpy(&v, block + at, sizeof v);
            FUZZ_REQUIRE(isfinite(v));
        }
    }
}

static void check_plan(const hbil_plan *p, uint32_t choice)
{
    static char text[2 * HBIL_GLSL_MAX];
    static const uint32_t sizes[4][2] = { { 1, 1 }, { 65, 33 }, { 16384, 1 }, { 1, 16384 } };
    hbil_diag item;
    hbil_diags d = { &item, 1, 0 };
    uint32_t w = sizes[choice % 4][0], h = sizes[choice % 4][1];
    size_t need = 0;
    cJSON *json;
    int32_t pass = (int32_t)(choice / 4 % p->pass_count);
    if (p->config.width) w = (uint32_t)p->config.width, h = (uint32_t)p->config.height;
    FUZZ_REQUIRE(hbil_plan_check(p, NULL) == HBIL_OK);
    FUZZ_REQUIRE(hbil_null_check(p, w, h, &d) == 0);
    FUZZ_REQUIRE(hbil_emit_glsl_hook(p, pass, "vec3 hbil_far_hook(vec3 p, vec3 d, float c) { return d; }\n", text, sizeof text,
                                     &need, NULL) == HBIL_OK);
    FUZZ_REQUIRE(need <= HBIL_GLSL_MAX && need == strlen(text) + 1);
    if (p->config.stage == HBIL_STAGE_FRAGMENT) FUZZ_REQUIRE(hbil_emit_vertex(p, text, sizeof text, NULL) == HBIL_OK);
    FUZZ_REQUIRE(hbil_emit_manifest(p, text, sizeof text, NULL) == HBIL_OK);
    json = cJSON_ParseWithOpts(text, NULL, 1);
    FUZZ_REQUIRE(json != NULL);
    cJSON_Delete(json);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static hbil_plan plan, again;
    fuzz_reader r = { data, size };
    const uint32_t count = fuzz_take(&r, 1);
    hbil_config c, resolved;
    hbil_diag items[4];
    hbil_diags d = { items, 4, 0 };
    hbil_frame frame;
    memset(&c, 0, sizeof c);
    if (count == 0) take_raw(&r, &c, sizeof c);
    else take_options(&r, count, &c);
    hbil_config_print(&c, 1, NULL, 0, NULL);
    memset(&plan, 0x55, sizeof plan);
    memset(&again, 0xaa, sizeof again);
    if (hbil_config_resolve(&c, &resolved, &d) != HBIL_OK || hbil_plan_build(&c, &plan, &d) != HBIL_OK) {
        FUZZ_REQUIRE(d.count > 0 && items[0].text[0]);
        return 0;
    }
    FUZZ_REQUIRE(hbil_plan_build(&resolved, &again, NULL) == HBIL_OK && memcmp(&plan, &again, sizeof plan) == 0);
    take_frame(&r, count == 0, &resolved, size % 3 ? NULL : &c, &frame);
    check_block(&plan, &frame);
    check_plan(&plan, (uint32_t)size);
    return 0;
}
