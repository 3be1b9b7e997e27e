/* fuzz_exr.c - frames and cube maps: whatever bytes as .exr, through OpenEXR's C API. What OpenEXR itself allocates is bounded by what is
 * asked of it here, so it is measured too: EXR_BYTES_MAX is small in this program. */
#include "fuzz.h"
#include "../../examples/frame/capture.h"
#include "../../examples/frame/environment.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char camera[] = "{\"width\": 4, \"height\": 3, \"near\": 0.1, \"far\": 100,"
    "\"projection_rows\": [[1,0,0,0],[0,1.3333334,0,0],[0,0,-1.002002,-0.2002002],[0,0,-1,0]],"
    "\"view_rows\": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}";

static void check_image(const image *i, const capture *c)
{
    volatile float last = 0.0f;
    size_t k, n = (size_t)i->width * (size_t)i->height * (size_t)i->channels;
    if (!i->data) return;
    FUZZ_REQUIRE(i->width == c->width && i->height == c->height);
    for (k = 0; k < n; ++k) last = i->data[k];
    (void)last;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static int ready;
    capture c;
    environment e;
    char error[512] = "", *names;
    int parts = 0;
    if (!ready) {
        fuzz_enter_folder();
        fuzz_write("camera.json", camera, sizeof camera - 1);
        ready = 1;
    }
    fuzz_write("frame-0.exr", data, size);
    fuzz_write("hf-0.exr", data, size);
    names = exr_names("frame-0.exr", &parts);
    free(names);
    if (capture_load(&c, "frame-0.exr", "camera.json", error, sizeof error)) {
        check_image(&c.depth, &c);
        check_image(&c.normal, &c);
        check_image(&c.albedo, &c);
        check_image(&c.direct, &c);
        check_image(&c.truth_ao, &c);
        check_image(&c.motion, &c);
        check_image(&c.hf_near, &c);
    } else {
        FUZZ_REQUIRE(error[0] != 0);
    }
    capture_free(&c);
    error[0] = 0;
    if (!environment_parse(&e, "frame-0.exr", error, sizeof error)) FUZZ_REQUIRE(error[0] != 0);
    environment_free(&e);
    return 0;
}
