/* fuzz_environment.c - what --env takes: texts, files of numbers, probes, cube maps; and what is made of them.
 *
 *   byte 0: 0 a text, 1 the JSON of probes, 2 a file of numbers, 3 a cube map of 1 x 6 texels whose channels follow */
#include "fuzz.h"
#include "../../examples/frame/environment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void make_cube(const uint8_t *data, size_t size)
{
    image_layer layer = { "", "RGB", { 0, 0, 0, NULL }, 0 };
    char error[256] = "";
    const int side = size % 5 == 0 ? 40 : 1; /* 40: more than is blurred from */
    FUZZ_REQUIRE(image_make(&layer.pixels, 6 * side, side, 3));
    memcpy(layer.pixels.data, data, size < 72 ? size : 72);
    FUZZ_REQUIRE(exr_write("cube.exr", &layer, 1, error, sizeof error));
    image_free(&layer.pixels);
}

static void check_numbers(const double rgb[3])
{
    FUZZ_REQUIRE(isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]));
}

static void make_plan(const char *text, hbil_plan *plan)
{
    hbil_config config;
    memset(&config, 0, sizeof config);
    FUZZ_REQUIRE(hbil_config_parse(&config, text, strlen(text), NULL) == HBIL_OK && hbil_plan_build(&config, plan, NULL) == HBIL_OK);
}

static void encode(const environment *e, const hbil_plan *plan)
{
    hbil_frame frame;
    image inputs[HBIL_MAX_TEXTURES];
    char error[256] = "";
    int i;
    memset(&frame, 0, sizeof frame);
    memset(inputs, 0, sizeof inputs);
    if (!environment_encode(e, plan, &frame, inputs, error, sizeof error)) FUZZ_REQUIRE(error[0] != 0);
    for (i = 0; i < HBIL_MAX_TEXTURES; ++i) image_free(&inputs[i]);
}

static void use(const environment *e)
{
    static const double positions[2][3] = { { 0.5, 1.5, -2 }, { 1e30, -1e30, 0 } }, directions[2][3] = { { 0, 0.6, 0.8 }, { -1, 0, 0 } };
    static hbil_plan plans[3];
    double rgb[3];
    int i;
    if (!plans[0].pass_count) {
        make_plan("outputs=far environment=cube", &plans[0]);
        make_plan("outputs=far environment=cube estimator=bitmask far_visibility=free_bits", &plans[1]);
        make_plan("outputs=far environment=probes sh_order=1", &plans[2]);
    }
    for (i = 0; i < 3; ++i) encode(e, &plans[i]);
    for (i = 0; i < 2; ++i) {
        environment at = environment_at(e, positions[i]);
        environment_radiance(&at, directions[i], rgb);
        check_numbers(rgb);
        environment_irradiance(&at, directions[i], rgb);
        check_numbers(rgb);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    environment e;
    char text[512] = "", error[512] = "";
    uint8_t kind;
    if (!ready) {
        fuzz_enter_folder();
        ready = 1;
    }
    if (!size) return 0;
    kind = *data++ % 4;
    --size;
    if (kind == 0) {
        memcpy(text, data, size < sizeof text - 1 ? size : sizeof text - 1);
        if (strchr(text, '/')) return 0; /* other people's files */
    } else {
        strcpy(text, kind == 1 ? "probes.json" : kind == 2 ? "sh:numbers.txt" : "cube.exr");
        if (kind == 3) make_cube(data, size);
        else fuzz_write(kind == 1 ? text : text + 3, data, size);
    }
    if (environment_parse(&e, text, error, sizeof error)) use(&e);
    else FUZZ_REQUIRE(error[0] != 0 && e.kind == 0);
    environment_free(&e);
    return 0;
}
