// Light to picture. Modes: gpu_mode in gpu.h.
layout(location = 0) in vec2 v_ndc;
layout(location = 0) out vec4 o_colour;
layout(binding = 2) uniform sampler2D u_normal;
layout(binding = 3) uniform sampler2D u_albedo;
layout(binding = 4) uniform sampler2D u_direct;
layout(binding = 5) uniform sampler2D u_shown;

// Narkowicz 2015: a fit of the ACES curve. Then sRGB.
vec3 tone_map(vec3 radiance)
{
    vec3 x = radiance * u_exposure;
    x = clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0);
    return mix(12.92 * x, 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, x));
}

void main()
{
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 direct = texelFetch(u_direct, at, 0).rgb, albedo = texelFetch(u_albedo, at, 0).rgb;
    vec3 shown = texelFetch(u_shown, at, 0).rgb;
    vec3 sky = sky_irradiance(texelFetch(u_normal, at, 0).xyz);
    int mode = gl_FragCoord.x < u_split ? 6 : u_mode;
    vec3 colour = mode == 0 ? tone_map(shown)
                : mode == 1 ? tone_map(direct + albedo * shown)
                : mode == 2 ? tone_map(direct + albedo * sky * shown)
                : mode == 3 ? tone_map(direct + albedo * sky * shown.r)
                : mode == 4 ? shown.rrr
                : mode == 5 ? 0.5 + 0.5 * shown
                : tone_map(direct);
    if (abs(gl_FragCoord.x - u_split) < 1.0) colour = vec3(1.0);
    o_colour = vec4(colour, 1.0);
}
