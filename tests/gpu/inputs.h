/* inputs.h - inputs that no capture has, made up: reflectance, roughness, sky, probes, and the
 * far light of the frame. Deterministic. */
#ifndef HBIL_TEST_INPUTS_H
#define HBIL_TEST_INPUTS_H

#include "../../examples/frame/capture.h"

/* [0, 1) from two numbers, as good as random. */
static inline float inputs_random(uint32_t a, uint32_t b)
{
    uint32_t x = a * 0x9e3779b9u ^ (b + 0x7f4a7c15u) * 0x85ebca6bu;
    x = (x ^ x >> 16) * 0x7feb352du;
    x = (x ^ x >> 15) * 0x846ca68bu;
    return (float)((x ^ x >> 16) >> 8) / 16777216.0f;
}

/* Values low + [0, span) in every channel. */
static inline void inputs_noise(image *out, int width, int height, int depth, int channels, float low, float span)
{
    size_t i, n = (size_t)width * (size_t)height * (size_t)depth * (size_t)channels;
    assert_true(image_make_slices(out, width, height, depth, channels));
    for (i = 0; i < n; ++i) out->data[i] = low + span * inputs_random((uint32_t)i, (uint32_t)(channels * depth));
}

static inline void inputs_far_light(hbil_frame *frame)
{
    static const float color[3] = { 0.5f, 0.7f, 1.0f }, origin[3] = { -1.5f, -2.0f, -0.5f }, step[3] = { 1.3f, 1.1f, 0.9f };
    int i, k;
    memcpy(frame->far_color, color, sizeof color);
    memcpy(frame->probe_origin, origin, sizeof origin);
    memcpy(frame->probe_step, step, sizeof step);
    for (i = 0; i < 9; ++i)
        for (k = 0; k < 3; ++k) frame->far_sh[i][k] = i ? inputs_random((uint32_t)i, (uint32_t)k) - 0.5f : 2.0f + (float)k;
}

/* Can a capture not give this input? */
static inline int inputs_made_up(const char *name)
{
    return strcmp(name, "f0") == 0 || strcmp(name, "roughness") == 0 || strcmp(name, "sky") == 0 || strcmp(name, "probes") == 0;
}

/* capture_encode for plans with inputs that no capture has. */
static inline int inputs_encode(const capture *cap, const hbil_plan *plan, hbil_frame *frame, image inputs[HBIL_MAX_TEXTURES],
                                char *error, size_t error_size)
{
    hbil_plan known = *plan;
    int coefficients = plan->config.sh_order == 1 ? 4 : 9;
    uint32_t t;
    for (t = 0; t < plan->texture_count; ++t)
        if (inputs_made_up(plan->textures[t].name)) known.textures[t].life = HBIL_LIFE_TRANSIENT; /* not seen by capture_encode */
    if (!capture_encode(cap, &known, frame, inputs, error, error_size)) return 0;
    inputs_far_light(frame);
    for (t = 0; t < plan->texture_count; ++t) {
        const char *name = plan->textures[t].name;
        if (strcmp(name, "f0") == 0) inputs_noise(&inputs[t], cap->width, cap->height, 1, 3, 0.0f, 1.0f);
        if (strcmp(name, "roughness") == 0) inputs_noise(&inputs[t], cap->width, cap->height, 1, 1, 0.0f, 1.0f);
        if (strcmp(name, "sky") == 0) inputs_noise(&inputs[t], 8, 8, 6, 3, 0.2f, 1.5f);
        if (strcmp(name, "probes") == 0) inputs_noise(&inputs[t], 4, 3, 5 * coefficients, 3, -0.3f, 1.5f);
    }
    return 1;
}

#endif
