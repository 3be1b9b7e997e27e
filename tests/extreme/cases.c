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

#define WALLS     "outputs=ao+near+specular_occlusion reach=4"
#define WALLS_BITS "outputs=ao+near estimator=bitmask"
#define WALLS_BOTH "outputs=ao+near march=both estimator=bitmask reach=0.5"
#define WALLS_SWEEP "outputs=ao+near march=sweep"
#define WALLS_ORTHO "outputs=ao+near projection=orthographic"
#define D32_REVERSED "outputs=ao depth=device depth_direction=reversed depth_far=infinite"
#define D32 "outputs=ao depth=device"
#define R16F "outputs=ao pull=0.0008 bias=0.02"
#define MANY      "outputs=ao slices=32 steps=64 sampling=bilinear"
#define MANY_ORTHO "outputs=ao slices=32 steps=64 projection=orthographic"
#define ONE_SLICE "outputs=ao slices=1 steps=16 projection=orthographic"
#define MIRROR    "outputs=ao noise=none slices=3"
#define FINE      "outputs=ao+near slices=2 steps=128"
#define CORE      "outputs=ao reach=2 falloff=0.6 slices=1 steps=1"
#define SKY_BITS  "outputs=far estimator=bitmask environment=cube far_visibility=free_bits slices=8 steps=2"
#define PITS      "outputs=ao+cone+specular_occlusion+near slices=2"

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
    X(depth_1e_9, "depth", 1.1e-9f, EVERYWHERE, EXTREME_LEGAL | EXTREME_TIES) \
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
    { "H1_no_sample_is_the_receiver", HORIZON, 4, fill_reach_of_near_depths, NULL, 0 },
    { "H1_no_sample_is_the_receiver", HORIZON, 5, fill_odd_wall, expect_open, EXTREME_LEGAL },
    { "H1_no_sample_is_the_receiver", WALLS, 5, fill_odd_wall, expect_open, EXTREME_LEGAL },
    { "H1_no_sample_is_the_receiver", THICK, 5, fill_odd_wall, NULL, EXTREME_LEGAL },
    { "H1b_both_sides_are_sampled_alike", MIRROR, 3, fill_ridges, expect_symmetry, EXTREME_LEGAL | EXTREME_EXACT },
    { "H2_normals_across_the_view_vector", WALLS, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H2_normals_across_the_view_vector", WALLS_BITS, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H2_normals_across_the_view_vector", WALLS_SWEEP, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H2_normals_across_the_view_vector", PITS, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H2_normals_across_the_view_vector", WALLS_ORTHO, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H3_cosines_above_one_at_silhouettes", HORIZON, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", ENDS, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", THICK, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", BOTH, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", SWEEP, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", HBAO, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", GTAO, 3, fill_silhouettes, NULL, 0 },
    { "H3_cosines_above_one_at_silhouettes", BILINEAR, 3, fill_silhouettes, NULL, 0 },
    { "H4_normals_across_a_slice", HORIZON, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H4_normals_across_a_slice", STRIDE, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H4_normals_across_a_slice", THICK, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H4_normals_across_a_slice", OCTA, 7, fill_alone, expect_open, EXTREME_LEGAL },
    { "H4_normals_across_a_slice", BOTH, 7, fill_alone, NULL, EXTREME_LEGAL },
    { "H5_cone_of_what_is_wholly_hidden", PITS, 3, fill_pit, expect_dark_pits, 0 },
    { "H5_cone_of_what_is_wholly_hidden", SWEEP, 3, fill_pit, NULL, 0 },
    { "H6_floors_see_all_of_the_sky", WALLS, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL | EXTREME_EXACT },
    { "H6_floors_see_all_of_the_sky", WALLS_BITS, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL },
    { "H6_floors_see_all_of_the_sky", WALLS_SWEEP, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL },
    { "H6_floors_see_all_of_the_sky", WALLS_BOTH, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL },
    { "H6_floors_see_all_of_the_sky", D32_REVERSED, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL },
    { "H6_floors_see_all_of_the_sky", D32, 3, fill_floor_under_sky, expect_open, EXTREME_LEGAL },
    { "H7_half_floats_of_history", GATHERED, 12, fill_poison, expect_no_trace, 0 },
    { "H7_half_floats_of_history", BLENDED, 12, fill_poison, expect_no_trace, 0 },
    { "H7_half_floats_of_history", AO_FRAMES, 12, fill_poison, expect_no_trace, 0 },
    { "H8_depth_of_D32F_reversed", D32_REVERSED, 5, fill_depth_float, expect_open, EXTREME_LEGAL },
    { "H8_depth_of_R32F", WALLS_SWEEP, 5, fill_depth_float, expect_open, EXTREME_LEGAL },
    { "H8_depth_of_R32F", WALLS_BITS, 5, fill_depth_float, expect_open, EXTREME_LEGAL },
    { "H8_depth_of_R16F", R16F, 5, fill_depth_half, expect_nearly_open, EXTREME_LEGAL },
    { "H8_depth_of_D24", D32, 5, fill_depth_24_bits, NULL, EXTREME_LEGAL },
    { "H8_depth_of_D16", D32, 5, fill_depth_16_bits, NULL, EXTREME_LEGAL },
    { "H9_near_light_of_small_rises", FINE, 2, fill_bowl, expect_near_and_ao_to_be_1, EXTREME_LEGAL },
    { "H9_near_light_of_small_rises", WALLS_SWEEP, 2, fill_bowl, expect_near_and_ao_to_be_1, EXTREME_LEGAL },
    { "H9_near_light_of_small_rises", WALLS_BITS, 2, fill_bowl, expect_near_and_ao_to_be_1, EXTREME_LEGAL },
    { "H10_powers_of_nothing", SWEEP, 3, fill_pit, NULL, 0 },
    { "H10_powers_of_nothing", BILINEAR, 3, fill_pit, NULL, 0 },
    { "H10_powers_of_nothing", ENDS, 3, fill_pit, NULL, 0 },
    { "H11_light_that_is_no_number_is_none", HORIZON, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", THICK, 2, fill_no_radiance, NULL, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", SWEEP, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", BOTH, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", SIDE, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", SINKING, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H11_light_that_is_no_number_is_none", BILINEAR, 2, fill_no_radiance, expect_no_light, EXTREME_LEGAL },
    { "H12_two_channels_longer_than_1", TWO, 2, fill_two_channels, expect_bent_along_normal, EXTREME_LEGAL },
    { "H13_no_weight_is_negative", HORIZON, 3, fill_silhouettes, NULL, 0 },
    { "H13_no_weight_is_negative", THICK, 3, fill_silhouettes, NULL, 0 },
    { "H13_no_weight_is_negative", SWEEP, 3, fill_silhouettes, NULL, 0 },
    { "H13_no_weight_is_negative", BOTH, 3, fill_silhouettes, NULL, 0 },
    { "H13_no_weight_is_negative", FINE, 3, fill_silhouettes, NULL, 0 },
    { "H14_normals_along_the_view_vector", WALLS, 1, fill_odd_wall, expect_open, EXTREME_LEGAL },
    { "H14_normals_along_the_view_vector", WALLS_BITS, 1, fill_odd_wall, expect_open, EXTREME_LEGAL },
    { "H14_normals_along_the_view_vector", WALLS_SWEEP, 1, fill_odd_wall, expect_open, EXTREME_LEGAL },
    { "H15_mirrors", HORIZON, 2, fill_mirrors, NULL, EXTREME_LEGAL },
    { "H16_samples_off_the_screen", MIRROR, 3, fill_ridges, expect_symmetry, EXTREME_LEGAL | EXTREME_EXACT },
    { "H17_azimuths_are_evenly_spread", ONE_SLICE, 4, fill_leaning, expect_blue_noise, EXTREME_LEGAL },
    { "H18_samples_beside_the_slice", WALLS, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H18_samples_beside_the_slice", WALLS_BITS, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H18_samples_beside_the_slice", WALLS_SWEEP, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H18_samples_beside_the_slice", WALLS_ORTHO, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H19_orthographic_view_vectors", MANY_ORTHO, 3, fill_leaning, expect_corner, EXTREME_LEGAL },
    { "H20_rows_grow_upwards", WALLS, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H20_rows_grow_upwards", WALLS_BITS, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H20_rows_grow_upwards", WALLS_SWEEP, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H20_rows_grow_upwards", OCTA, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H20_rows_grow_upwards", WALLS_ORTHO, 5, fill_tilted_walls, expect_open, EXTREME_LEGAL },
    { "H21_pixels_that_are_not_square", MANY, 3, fill_wide_pixels, expect_corner, EXTREME_LEGAL },
    { "H22_reach_in_pixels", ENDS, 4, fill_reach_of_near_depths, NULL, 0 },
    { "H22_reach_below_a_pixel", ENDS, 2, fill_reach_below_a_pixel, expect_open, EXTREME_LEGAL },
    { "H23_views_along_the_up_vector", HORIZON, 2, fill_off_centre, expect_open, EXTREME_LEGAL },
    { "H23_views_along_the_up_vector", WALLS_SWEEP, 2, fill_off_centre, expect_open, EXTREME_LEGAL },
    { "H23_views_along_the_up_vector", THICK, 2, fill_off_centre, NULL, EXTREME_LEGAL },
    { "H23_views_along_the_up_vector", MANY, 3, fill_leaning, expect_corner, EXTREME_LEGAL },
    { "H24_light_dies_out", GATHERED, 40, fill_white_room, expect_light_to_die_out, 0 },
    { "H24_light_dies_out", SCATTERED, 40, fill_white_room, expect_light_to_die_out, 0 },
    { "H24_light_dies_out", BLENDED, 40, fill_white_room, expect_light_to_die_out, 0 },
    { "H24_light_dies_out", SWEPT_FRAMES, 40, fill_white_room, expect_light_to_die_out, 0 },
    { "H25_angles_of_nothing", HORIZON, 7, fill_alone, NULL, EXTREME_LEGAL },
    { "H25_angles_of_nothing", GTAO, 7, fill_alone, NULL, EXTREME_LEGAL },
    { "H25_angles_of_nothing", PITS, 7, fill_alone, NULL, EXTREME_LEGAL },
    { "a_poisoned_frame_leaves_no_trace", GATHERED, 12, fill_poison, expect_no_trace, 0 },
    { "a_poisoned_frame_leaves_no_trace", SCATTERED, 12, fill_poison, expect_no_trace, 0 },
    { "a_poisoned_frame_leaves_no_trace", BLENDED, 12, fill_poison, expect_no_trace, 0 },
    { "a_poisoned_frame_leaves_no_trace", SWEPT_FRAMES, 12, fill_poison, expect_no_trace, 0 },
    { "a_poisoned_frame_leaves_no_trace", AO_FRAMES, 12, fill_poison, expect_no_trace, 0 },
    { "bright_skies_are_not_cut", SKY_BITS, 1, fill_bright_sky, expect_all_of_the_sky, EXTREME_LEGAL },
    { "fov_1_degree", HORIZON, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", ENDS, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", THICK, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SWEEP, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", STRIDE, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", BOTH, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", HBAO, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", HBAO_PLUS, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", GTAO, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SINKING, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", BILINEAR, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SIDE, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", REVERSED, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", FORWARD, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", GATHERED, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SCATTERED, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", BLENDED, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SWEPT_FRAMES, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", AO_FRAMES, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", SEED, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", OCTA, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_1_degree", TWO, 2, fill_fov_1, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", HORIZON, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", ENDS, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", THICK, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SWEEP, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", STRIDE, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", BOTH, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", HBAO, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", HBAO_PLUS, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", GTAO, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SINKING, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", BILINEAR, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SIDE, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", REVERSED, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", FORWARD, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", GATHERED, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SCATTERED, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", BLENDED, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SWEPT_FRAMES, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", AO_FRAMES, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", SEED, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", OCTA, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_170_degrees", TWO, 2, fill_fov_170, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "fov_179_9_degrees", HORIZON, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", ENDS, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", THICK, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SWEEP, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", STRIDE, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", BOTH, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", HBAO, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", HBAO_PLUS, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", GTAO, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SINKING, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", BILINEAR, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SIDE, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", REVERSED, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", FORWARD, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", GATHERED, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SCATTERED, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", BLENDED, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SWEPT_FRAMES, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", AO_FRAMES, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", SEED, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", OCTA, 2, fill_fov_179_9, NULL, 0 },
    { "fov_179_9_degrees", TWO, 2, fill_fov_179_9, NULL, 0 },
    { "near_1e_4_far_1e9", HORIZON, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", ENDS, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", THICK, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SWEEP, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", STRIDE, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", BOTH, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", HBAO, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", HBAO_PLUS, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", GTAO, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SINKING, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", BILINEAR, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SIDE, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", REVERSED, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", FORWARD, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", ORTHO, 2, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", ORTHO_SWEEP, 2, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", GATHERED, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SCATTERED, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", BLENDED, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SWEPT_FRAMES, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", AO_FRAMES, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", SEED, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", OCTA, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "near_1e_4_far_1e9", TWO, 2, fill_near_1e_4_far_1e9, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "checkerboard_depth", HORIZON, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", ENDS, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", THICK, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SWEEP, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", STRIDE, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", BOTH, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", HBAO, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", HBAO_PLUS, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", GTAO, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SINKING, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", BILINEAR, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SIDE, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", REVERSED, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", FORWARD, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", ORTHO, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", ORTHO_SWEEP, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", GATHERED, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SCATTERED, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", BLENDED, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SWEPT_FRAMES, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", AO_FRAMES, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", SEED, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", OCTA, 6, fill_checkerboard, NULL, 0 },
    { "checkerboard_depth", TWO, 6, fill_checkerboard, NULL, 0 },
    { "spikes_of_one_pixel", HORIZON, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", ENDS, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", THICK, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SWEEP, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", STRIDE, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", BOTH, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", HBAO, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", HBAO_PLUS, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", GTAO, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SINKING, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", BILINEAR, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SIDE, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", REVERSED, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", FORWARD, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", ORTHO, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", ORTHO_SWEEP, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", GATHERED, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SCATTERED, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", BLENDED, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SWEPT_FRAMES, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", AO_FRAMES, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", SEED, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", OCTA, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "spikes_of_one_pixel", TWO, 3, fill_spikes, NULL, EXTREME_LEGAL | EXTREME_TIES },
    { "options_at_their_ends", ENDS, 8, fill_dials, NULL, 0 },
    { "slices_64_steps_128", ENDS, 1, fill_most_samples, NULL, EXTREME_LEGAL },
    { "size_1x1", HORIZON, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", ENDS, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", THICK, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SWEEP, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", STRIDE, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", BOTH, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", HBAO, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", HBAO_PLUS, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", GTAO, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SINKING, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", BILINEAR, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SIDE, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", REVERSED, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", FORWARD, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", ORTHO, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", ORTHO_SWEEP, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", GATHERED, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SCATTERED, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", BLENDED, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SWEPT_FRAMES, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", AO_FRAMES, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", SEED, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", OCTA, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x1", TWO, 2, fill_1x1, NULL, EXTREME_LEGAL },
    { "size_1x4096", HORIZON, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", SWEEP, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", BOTH, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", GATHERED, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", SCATTERED, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", GTAO, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", STRIDE, 2, fill_1x4096, NULL, 0 },
    { "size_1x4096", SWEPT_FRAMES, 2, fill_1x4096, NULL, 0 },
    { "size_16384x1", HORIZON, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", SWEEP, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", BOTH, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", GATHERED, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", SCATTERED, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", GTAO, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", STRIDE, 2, fill_16384x1, NULL, 0 },
    { "size_16384x1", SWEPT_FRAMES, 2, fill_16384x1, NULL, 0 },
    { "size_7680x4320", CORE, 1, fill_7680x4320, NULL, EXTREME_LONG },
    { "broken_projections_are_refused", HORIZON, 10, fill_broken_projection, NULL, EXTREME_REFUSED },
    { "broken_projections_are_refused", ORTHO, 10, fill_broken_projection, NULL, EXTREME_REFUSED },
    { "broken_projections_are_refused", REVERSED, 10, fill_broken_projection, NULL, EXTREME_REFUSED },
    { "broken_views_are_refused", GATHERED, 8, fill_broken_view, NULL, EXTREME_REFUSED },
    { "broken_views_are_refused", SCATTERED, 8, fill_broken_view, NULL, EXTREME_REFUSED },
    { "broken_views_are_refused", THICK, 8, fill_broken_view, NULL, EXTREME_REFUSED },
    { "broken_environments_are_refused", HBAO, 6, fill_broken_environment, NULL, EXTREME_REFUSED },
    { "broken_environments_are_refused", ENDS, 6, fill_broken_environment, NULL, EXTREME_REFUSED },
    { "broken_environments_are_refused", SCATTERED, 6, fill_broken_environment, NULL, EXTREME_REFUSED },
    { "huge_environments", HBAO, 4, fill_huge_environment, NULL, 0 },
    { "huge_environments", ENDS, 4, fill_huge_environment, NULL, 0 },
    { "huge_environments", THICK, 4, fill_huge_environment, NULL, 0 },
    { "huge_environments", SEED, 4, fill_huge_environment, NULL, 0 },
    { "huge_environments", SCATTERED, 4, fill_huge_environment, NULL, 0 },
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
