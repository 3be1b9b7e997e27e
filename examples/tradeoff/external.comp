#version 450
// external.comp - screen-space ambient occlusion by 16 fixed taps: an example of a shader that is not hbil.h's, for
// hbil-tradeoff --external. See README.md.
layout(local_size_x = 8, local_size_y = 8) in;

layout(binding = 0) uniform sampler2D u_depth;  // m along the view axis
layout(binding = 1) uniform sampler2D u_normal; // view space
layout(binding = 2, r32f) uniform writeonly image2D u_ao;
layout(binding = 3, std140) uniform Frame {     // the block of --external, as far as it is read here
    ivec2 size;
    vec2  texel;
    mat4  projection, inverse_projection;
};

const int   TAPS = 16;
const float RADIUS = 2.0; // m
const float BIAS = 0.05;  // sine

vec3 position(ivec2 p) {
    vec2 ndc = 2.0 * (vec2(p) + 0.5) * texel - 1.0;
    vec4 ray = inverse_projection * vec4(ndc, 0.0, 1.0);
    return ray.xyz / -ray.z * texelFetch(u_depth, p, 0).r; // perspective
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, size))) return;
    vec3  p = position(pixel), n = texelFetch(u_normal, pixel, 0).xyz;
    vec2  reach = 0.5 * vec2(size) * abs(vec2(projection[0][0], projection[1][1])) * RADIUS / -p.z; // pixels
    float turn = 6.2831853 * fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715))));
    float hidden = 0.0;
    for (int i = 0; i < TAPS; ++i) { // a spiral that the noise turns
        float angle = turn + 2.3999632 * float(i), r = sqrt((float(i) + 0.5) / float(TAPS));
        vec3  v = position(clamp(pixel + ivec2(r * reach * vec2(cos(angle), sin(angle))), ivec2(0), size - 1)) - p;
        float d = max(length(v), 1e-4);
        hidden += max(dot(n, v) / d - BIAS, 0.0) * max(1.0 - d / RADIUS, 0.0);
    }
    imageStore(u_ao, pixel, vec4(max(1.0 - 4.0 * hidden / float(TAPS), 0.0)));
}
