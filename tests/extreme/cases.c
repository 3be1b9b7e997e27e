/* cases.c - the table of all cases: hazards by number, then every extreme value of every input through every march. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "frames.h"
#include "hazards.h"

/* ------------------------------------------------------------------------------------------------------- configs */

#define DYNAMIC "dynamic=slices+steps+exponent+reach+falloff+bias+pull+firefly+near_intensity+far_intensity+ao_exponent+sky_depth "

#define HORIZON   "outputs=ao+uniform_ao+bent+cone+near+sh+specular_occlusion slices=2"
#define ENDS      "outputs=ao+bent+near+far exponent=3 reach=1 falloff=0.6 bias=0.001 firefly=100 environment=sh ao_exponent=2 " DYNAMIC
#define THICK     "outputs=ao+uniform_ao+near+sh+far+irradiance+composite estimator=bitmask occluder=thick thickness=0.5 reach=2 " \
                  "facing=half_space environment=sh far_visibility=free_bits f0=rgb slices=2"
#define SWEEP     "outputs=ao+bent+cone+near+sh march=sweep facing=filter slices=4 ao_exponent=0.1"
#define STRIDE    "outputs=ao+near march=sweep facing=half_space sweep_stride=3 slices=2 filter=3x3"
#define BOTH      "outputs=ao+near+bent march=both estimator=bitmask occluder=thick reach=1 slices=2 noise=ign"
#define HBAO      "outputs=ao+far estimator=hbao reach=1 environment=constant attenuation=linear"
#define HBAO_PLUS "outputs=ao+multi_bounce estimator=hbao_plus reach=1"
#define GTAO      "outputs=ao+specular_occlusion+multi_bounce occluder=heuristic reach=2 falloff=0.3 mips=spread interleave=yes noise=ign " \
                  "bounce=cubic normals=world roughness=0.02 spacing=geometric"
#define SINKING   "outputs=ao+near occluder=heuristic mips=weighted gather=packed f0=scalar exponent=1 normals=depth"
#define BILINEAR  "outputs=ao+near+sh sampling=bilinear slices=1 filter=3x3 filter_passes=3 ao_exponent=0.1 spacing=geometric"
#define SIDE      "outputs=ao+near mips=nearest gather=side slices=1 firefly=10"
#define REVERSED  "outputs=ao+near+bent depth=device depth_direction=reversed depth_far=infinite normals=depth slices=2"
#define FORWARD   "outputs=ao+near depth=device clip=gl reach=1 normals=world slices=2"
#define ORTHO     "outputs=ao+near+cone projection=orthographic normals=depth reach=1 slices=2"
#define ORTHO_SWEEP "outputs=ao+near+uniform_ao projection=orthographic march=sweep depth=device downscale=2 slices=2"
#define GATHERED  "outputs=ao+near+far+irradiance bounces=recursive temporal=yes reproject=gather filter=5x5 filter_passes=2 storage=half " \
                  "arithmetic=half downscale=2 environment=cube facing=half_space"
#define SCATTERED "outputs=ao+bent+composite bounces=recursive temporal=yes reproject=scatter rectify=range environment=probes f0=rgb " \
                  "facing=filter near_intensity=2"
#define BLENDED   "outputs=ao+near+sh bounces=recursive temporal=yes rectify=none storage=half slices=1 near_intensity=100 facing=filter"
#define SWEPT_FRAMES "outputs=ao+near+composite march=sweep bounces=recursive reproject=scatter downscale=4 temporal=yes filter=3x3 " \
                  "environment=constant facing=half_space slices=2 sky_depth=1e15 history=63"
#define AO_FRAMES "outputs=ao temporal=yes storage=half downscale=2 arithmetic=half"
#define SEED      "outputs=ao+near+cone+far environment=constant seed_compat=screen_azimuth+slice_mean+noise_2pi+cone_relation+f0_ao slices=2"
#define OCTA      "outputs=ao+bent normal_encoding=octahedral slices=2"
#define TWO       "outputs=ao+bent normal_encoding=xy slices=2"

/* ------------------------------------------------------------------------------------------------- extreme inputs */

enum { WIDTH = 64, HEIGHT = 40 };

/* Frame 0 has the value at scattered pixels, in a block, a column and a corner; frame 1 everywhere; frame 2 nowhere. */
static int poked(int x, int y, int index)
{
    if (index % 3) return index % 3 == 1;
    return frames_random((uint32_t)x, (uint32_t)y) < 0.06f || (x > 8 && x < 18 && y > 20 && y < 30) || x == 40 || (x < 2 && y < 2);
}

static void poke(const hbil_plan *plan, int index, extreme_frame *out, const char *name, float value)
{
    image *img;
    int p, k;
    frames_room(plan, out, WIDTH, HEIGHT, index);
    img = frames_input(plan, out, name);
    if (!img) return;
    for (p = 0; p < img->width * img->height * image_slices(img); ++p)
        for (k = 0; k < img->channels; ++k)
            if (poked(p % img->width, p / img->width % img->height, index)) img->data[p * img->channels + k] = value;
}

/* X(id of the case, texture, value, configs, flags) */
#define POKES(X) \
    X(depth_zero, "depth", 0.0f, EVERYWHERE, EXTREME_LEGAL) \
    X(depth_one, "depth", 1.0f, EVERYWHERE, EXTREME_LEGAL) \
    X(depth_1e_4, "depth", 1e-4f, EVERYWHERE, EXTREME_LEGAL | EXTREME_TIES) \
    X(depth_1e_15, "depth", 1e-15f, EVERYWHERE, EXTREME_LEGAL | EXTREME_TIES) \
    X(depth_1e_30, "depth", 1e-30f, EVERYWHERE, EXTREME_LEGAL) \
    X(depth_least_normal, "depth", 1.2e-38f, EVERYWHERE, EXTREME_LEGAL) \
    X(depth_denormal, "depth", 1e-40f, EVERYWHERE, EXTREME_LEGAL) \
    X(depth_1e9, "depth", 9.9e8f, ON_LINEAR, EXTREME_LEGAL | EXTREME_TIES) \
    X(depth_1e14, "depth", 9e14f, ON_LINEAR, EXTREME_LEGAL | EXTREME_TIES) \
    X(depth_negative, "depth", -1.0f, ON_LINEAR, EXTREME_LEGAL) \
    X(depth_infinite, "depth", INFINITY, ON_LINEAR, EXTREME_LEGAL) \
    X(depth_minus_infinite, "depth", -INFINITY, ON_LINEAR, EXTREME_LEGAL) \
    X(depth_nan, "depth", NAN, ON_LINEAR, EXTREME_LEGAL) \
    X(device_depth_large, "depth", 9.9e8f, ON_DEVICE, 0) \
    X(device_depth_negative, "depth", -1.0f, ON_DEVICE, 0) \
    X(device_depth_infinite, "depth", INFINITY, ON_DEVICE, 0) \
    X(device_depth_minus_infinite, "depth", -INFINITY, ON_DEVICE, 0) \
    X(device_depth_nan, "depth", NAN, ON_DEVICE, 0) \
    X(normal_zero, "normal", 0.0f, ON_NORMALS, EXTREME_LEGAL) \
    X(normal_nan, "normal", NAN, ON_NORMALS, 0) \
    X(normal_infinite, "normal", INFINITY, ON_NORMALS, 0) \
    X(normal_short, "normal", 1e-5f, ON_NORMALS, 0) \
    X(normal_long, "normal", 1e5f, ON_NORMALS, 0) \
    X(normal_away, "normal", -1.0f, ON_NORMALS, 0) \
    X(radiance_zero, "radiance", 0.0f, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_half_max, "radiance", 65504.0f, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_1e30, "radiance", 1e30f, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_denormal, "radiance", 1e-40f, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_infinite, "radiance", INFINITY, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_negative, "radiance", -1.0f, ON_LIGHT, EXTREME_LEGAL) \
    X(radiance_nan, "radiance", NAN, ON_LIGHT, EXTREME_LEGAL) \
    X(direct_half_max, "direct", 65504.0f, ON_COMPOSITE, EXTREME_LEGAL) \
    X(direct_infinite, "direct", INFINITY, ON_COMPOSITE, 0) \
    X(direct_negative, "direct", -1.0f, ON_COMPOSITE, 0) \
    X(direct_nan, "direct", NAN, ON_COMPOSITE, 0) \
    X(albedo_one, "albedo", 1.0f, ON_ALBEDO, EXTREME_LEGAL) \
    X(albedo_four, "albedo", 4.0f, ON_ALBEDO, 0) \
    X(albedo_negative, "albedo", -1.0f, ON_ALBEDO, 0) \
    X(albedo_infinite, "albedo", INFINITY, ON_ALBEDO, 0) \
    X(albedo_nan, "albedo", NAN, ON_ALBEDO, 0) \
    X(f0_one, "f0", 1.0f, ON_F0, EXTREME_LEGAL) \
    X(f0_four, "f0", 4.0f, ON_F0, 0) \
    X(f0_negative, "f0", -1.0f, ON_F0, 0) \
    X(f0_nan, "f0", NAN, ON_F0, 0) \
    X(roughness_zero, "roughness", 0.0f, ON_ROUGHNESS, EXTREME_LEGAL) \
    X(roughness_one, "roughness", 1.0f, ON_ROUGHNESS, EXTREME_LEGAL) \
    X(roughness_outside, "roughness", 3.0f, ON_ROUGHNESS, 0) \
    X(roughness_nan, "roughness", NAN, ON_ROUGHNESS, 0) \
    X(motion_far, "motion", 1e4f, ON_MOTION, EXTREME_LEGAL) \
    X(motion_huge, "motion", -1e30f, ON_MOTION, 0) \
    X(motion_infinite, "motion", INFINITY, ON_MOTION, 0) \
    X(motion_nan, "motion", NAN, ON_MOTION, 0) \
    X(sky_half_max, "sky", 65504.0f, ON_CUBE, EXTREME_LEGAL) \
    X(sky_infinite, "sky", INFINITY, ON_CUBE, 0) \
    X(sky_nan, "sky", NAN, ON_CUBE, 0) \
    X(sky_negative, "sky", -1.0f, ON_CUBE, 0) \
    X(probes_half_max, "probes", 65504.0f, ON_PROBES, EXTREME_LEGAL) \
    X(probes_1e30, "probes", 1e30f, ON_PROBES, 0) \
    X(probes_infinite, "probes", -INFINITY, ON_PROBES, 0) \
    X(probes_nan, "probes", NAN, ON_PROBES, 0)

#define FILL_POKE(id, texture, value, on, flags) \
    static void fill_##id(const hbil_plan *plan, int index, extreme_frame *out) { poke(plan, index, out, texture, value); }
POKES(FILL_POKE)

/* ----------------------------------------------------------------------------------------------------- the table */

#define ONE(name, config, frames, fill, expect, flags) { name, config, frames, fill, expect, flags },

#define ON_MOTION(n, f, e, g) ONE(n, GATHERED, 4, f, e, g)
#define ON_CUBE(n, f, e, g) ONE(n, GATHERED, 4, f, e, g)
#define ON_PROBES(n, f, e, g) ONE(n, SCATTERED, 4, f, e, g)
#define ON_ROUGHNESS(n, f, e, g) ONE(n, HORIZON, 3, f, e, g)
#define ON_F0(n, f, e, g) ONE(n, THICK, 3, f, e, g) ONE(n, SINKING, 3, f, e, g) ONE(n, SCATTERED, 4, f, e, g)
#define ON_COMPOSITE(n, f, e, g) ONE(n, THICK, 3, f, e, g) ONE(n, SCATTERED, 4, f, e, g) ONE(n, SWEPT_FRAMES, 4, f, e, g)
#define ON_ALBEDO(n, f, e, g) ON_COMPOSITE(n, f, e, g) ONE(n, GATHERED, 4, f, e, g) ONE(n, BLENDED, 6, f, e, g) \
    ONE(n, GTAO, 3, f, e, g) ONE(n, HBAO_PLUS, 3, f, e, g)
#define ON_LIGHT(n, f, e, g) ON_COMPOSITE(n, f, e, g) ONE(n, HORIZON, 3, f, e, g) ONE(n, SWEEP, 3, f, e, g) ONE(n, STRIDE, 3, f, e, g) \
    ONE(n, BOTH, 3, f, e, g) ONE(n, SINKING, 3, f, e, g) ONE(n, BILINEAR, 3, f, e, g) ONE(n, SIDE, 3, f, e, g) \
    ONE(n, GATHERED, 4, f, e, g) ONE(n, BLENDED, 6, f, e, g) ONE(n, ORTHO, 3, f, e, g) ONE(n, SEED, 3, f, e, g)
#define ON_LINEAR_NORMALS(n, f, e, g) ONE(n, HORIZON, 3, f, e, g) ONE(n, ENDS, 3, f, e, g) ONE(n, THICK, 3, f, e, g) \
    ONE(n, SWEEP, 3, f, e, g) ONE(n, STRIDE, 3, f, e, g) ONE(n, BOTH, 3, f, e, g) ONE(n, HBAO, 3, f, e, g) ONE(n, HBAO_PLUS, 3, f, e, g) \
    ONE(n, GTAO, 3, f, e, g) ONE(n, BILINEAR, 3, f, e, g) ONE(n, SIDE, 3, f, e, g) ONE(n, GATHERED, 4, f, e, g) \
    ONE(n, SCATTERED, 4, f, e, g) ONE(n, BLENDED, 4, f, e, g) ONE(n, SWEPT_FRAMES, 4, f, e, g) ONE(n, AO_FRAMES, 4, f, e, g) \
    ONE(n, SEED, 3, f, e, g) ONE(n, OCTA, 3, f, e, g) ONE(n, TWO, 3, f, e, g)
#define ON_NORMALS(n, f, e, g) ON_LINEAR_NORMALS(n, f, e, g) ONE(n, FORWARD, 3, f, e, g) ONE(n, ORTHO_SWEEP, 3, f, e, g)
#define ON_LINEAR(n, f, e, g) ON_LINEAR_NORMALS(n, f, e, g) ONE(n, SINKING, 3, f, e, g) ONE(n, ORTHO, 3, f, e, g)
#define ON_DEVICE(n, f, e, g) ONE(n, FORWARD, 3, f, e, g) ONE(n, REVERSED, 3, f, e, g) ONE(n, ORTHO_SWEEP, 3, f, e, g)
#define EVERYWHERE(n, f, e, g) ON_LINEAR(n, f, e, g) ON_DEVICE(n, f, e, g)

#define ROW(id, texture, value, on, flags) on(#id, fill_##id, NULL, flags)

const extreme_case extreme_cases[] = {
    POKES(ROW)
};
const int extreme_case_count = (int)(sizeof extreme_cases / sizeof *extreme_cases);

int extreme_plan(const extreme_case *c, const char *target, hbil_plan *plan, char *error, size_t size)
{
    hbil_diag items[4];
    hbil_diags diags = { items, 4, 0 };
    hbil_config config;
    memset(&config, 0, sizeof config);
    if (hbil_config_parse(&config, c->config, strlen(c->config), &diags) == HBIL_OK
        && hbil_config_set(&config, "target", target, &diags) == HBIL_OK && hbil_plan_build(&config, plan, &diags) == HBIL_OK) return 1;
    snprintf(error, size, "%s: %s: %s", c->name, c->config, diags.count ? items[0].text : "");
    return 0;
}
