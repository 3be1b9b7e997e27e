/* fuzz_camera.c - the JSON of a camera. */
#include "fuzz.h"
#include "../../examples/frame/capture.h"

#include <math.h>
#include <string.h>

/* A frame of 4 x 3 to go with it. */
static void make_frame(void)
{
    image_layer layers[] = { { "depth", "Z", { 0, 0, 0, NULL }, 0 }, { "normal", "XYZ", { 0, 0, 0, NULL }, 0 },
                             { "albedo", "RGB", { 0, 0, 0, NULL }, 0 }, { "direct", "RGB", { 0, 0, 0, NULL }, 0 } };
    char error[256] = "";
    int i;
    for (i = 0; i < 4; ++i) FUZZ_REQUIRE(image_make(&layers[i].pixels, 4, 3, (int)strlen(layers[i].channels)));
    FUZZ_REQUIRE(exr_write("frame.exr", layers, 4, error, sizeof error));
    for (i = 0; i < 4; ++i) image_free(&layers[i].pixels);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    capture c;
    char error[512] = "";
    int i;
    if (!ready) {
        fuzz_enter_folder();
        make_frame();
        ready = 1;
    }
    fuzz_write("camera.json", data, size);
    if (capture_load(&c, "frame.exr", "camera.json", error, sizeof error)) {
        FUZZ_REQUIRE(c.width == 4 && c.height == 3 && isfinite(c.near_z) && isfinite(c.far_z) && c.near_z < c.far_z);
        for (i = 0; i < 16; ++i) FUZZ_REQUIRE(isfinite(c.projection[i]) && isfinite(c.view[i]));
        FUZZ_REQUIRE(c.projection[0] > 0.0f && c.projection[5] < 0.0f);
    } else {
        FUZZ_REQUIRE(error[0] != 0 && memchr(error, 0, sizeof error));
    }
    capture_free(&c);
    return 0;
}
