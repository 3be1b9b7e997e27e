/* hazards.h - frames in which one hazard of the arithmetic each shows, and the truth about them. */
#ifndef HBIL_EXTREME_HAZARDS_H
#define HBIL_EXTREME_HAZARDS_H

#include "cases.h"

#define HAZARD_BLUE 0.2 /* share of the power of white noise that means of 8 x 8 pixels may keep */

extreme_fill fill_tilted_walls, fill_depth_float, fill_depth_24_bits, fill_depth_16_bits, fill_depth_half, fill_odd_wall,
    fill_leaning, fill_wide_pixels, fill_alone, fill_two_channels, fill_pit, fill_ridges, fill_silhouettes, fill_bowl,
    fill_floor_under_sky, fill_reach_below_a_pixel, fill_reach_of_near_depths, fill_dials, fill_most_samples,
    fill_white_room, fill_no_radiance, fill_mirrors, fill_poison, fill_bright_sky, fill_fov_1, fill_fov_170,
    fill_fov_179_9, fill_near_1e_4_far_1e9, fill_off_centre, fill_1x1, fill_1x4096, fill_16384x1, fill_7680x4320,
    fill_checkerboard, fill_spikes, fill_broken_projection, fill_broken_view, fill_broken_environment, fill_huge_environment;
extreme_expect expect_open, expect_nearly_open, expect_corner, expect_near_and_ao_to_be_1, expect_no_light, expect_symmetry,
    expect_blue_noise, expect_bent_along_normal, expect_dark_pits, expect_light_to_die_out, expect_no_trace,
    expect_all_of_the_sky;

#endif
