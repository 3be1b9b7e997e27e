// Chunks that several passes use. The space of all passes: x right, y up, z into the screen, metres, eye at the
// origin.

//@ chunk HBIL_SKY
const float HBIL_SKY = 1e15; // view depth of a pixel without a surface. m

//@ chunk HBIL_RADIANCE_MAX
const float HBIL_RADIANCE_MAX = 60000.0; // below the largest half float: history and blends stay finite

//@ chunk HBIL_PI
const float HBIL_PI = 3.141592654;

//@ chunk hbil_texel
// Where this invocation stands in its grid.
ivec2 hbil_texel() {
#if HBIL_STAGE_FRAGMENT
    return ivec2(gl_FragCoord.xy);
#else
    return ivec2(gl_GlobalInvocationID.xy);
#endif
}

//@ chunk hbil_position
// Point seen at a pixel position (centres at .5) and view depth. m
vec3 hbil_position(vec2 pixel, float z) {
    vec2 ray = pixel * HBIL_PIXEL_TO_RAY.xy + HBIL_PIXEL_TO_RAY.zw;
#if HBIL_PROJECTION_PERSPECTIVE
    return vec3(ray * z, z);
#else
    return vec3(ray, z);
#endif
}

//@ chunk hbil_nearness
// The quantity that is linear on the screen for every plane; larger is nearer.
float hbil_nearness(float z) {
#if HBIL_PROJECTION_PERSPECTIVE
    return 1.0 / z;
#else
    return -z;
#endif
}

//@ chunk hbil_depth_of
// View depth of a nearness. m
float hbil_depth_of(float nearness) {
#if HBIL_PROJECTION_PERSPECTIVE
    return 1.0 / nearness;
#else
    return -nearness;
#endif
}

//@ chunk hbil_view_vector
// Unit vector from the surface seen at a pixel position to the eye. From the pixel alone: exact at any depth.
vec3 hbil_view_vector(vec2 pixel) {
#if HBIL_PROJECTION_PERSPECTIVE
    return -normalize(hbil_position(pixel, 1.0));
#else
    return vec3(0.0, 0.0, -1.0);
#endif
}

//@ chunk hbil_finite
// Radiance that can do no harm: NaN and negative become 0, infinity and fireflies the maximum.
vec3 hbil_finite(vec3 radiance) {
    return mix(vec3(0.0), min(radiance, vec3(HBIL_RADIANCE_MAX)), greaterThan(radiance, vec3(0.0)));
}

//@ chunk hbil_pack_snorm
// Two numbers in [-1, 1] as 16 bits each. GLSL 3.30 has no packSnorm2x16.
uint hbil_pack_snorm(vec2 v) {
#if HBIL_STAGE_FRAGMENT
    ivec2 i = ivec2(floor(v * 32767.0 + 0.5));
    return uint(i.x & 65535) | (uint(i.y) << 16);
#else
    return packSnorm2x16(v);
#endif
}

//@ chunk hbil_unpack_snorm
vec2 hbil_unpack_snorm(uint code) {
#if HBIL_STAGE_FRAGMENT
    return vec2(ivec2(int(code) << 16, int(code)) >> 16) / 32767.0;
#else
    return unpackSnorm2x16(code);
#endif
}

//@ chunk hbil_encode_normal
// Octahedral map of a unit vector, 2 x snorm16. Error below 5e-5 rad. Meyer 2010
uint hbil_encode_normal(vec3 n) {
    vec2 o = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    vec2 fold = (1.0 - abs(o.yx)) * mix(vec2(-1.0), vec2(1.0), greaterThanEqual(o, vec2(0.0)));
    return hbil_pack_snorm(n.z > 0.0 ? fold : o);
}

//@ chunk hbil_decode_normal
vec3 hbil_decode_normal(uint code) {
    vec2 o = hbil_unpack_snorm(code);
    vec3 n = vec3(o, abs(o.x) + abs(o.y) - 1.0);
    float fold = max(n.z, 0.0);
    n.xy += mix(vec2(fold), vec2(-fold), greaterThanEqual(n.xy, vec2(0.0)));
    return normalize(n);
}

//@ chunk hbil_load_depth
float hbil_load_depth(ivec2 p) {
    return texelFetch(u_view_depth, p, 0).r;
}

//@ chunk hbil_load_normal
vec3 hbil_load_normal(ivec2 p) {
    return hbil_decode_normal(texelFetch(u_view_normal, p, 0).r);
}

//@ chunk hbil_direction
// Unit vector along v, a bent vector; more and more along `other` where so little is left of v that it is rounding.
vec3 hbil_direction(vec3 v, vec3 other) {
    return normalize(v + 2e-5 * other);
}

//@ chunk hbil_diffuse
// Part of the light that a surface does not mirror: 1 - F0. Metals get none.
vec3 hbil_diffuse(ivec2 p) {
#if HBIL_F0_RGB
    return 1.0 - min(hbil_finite(texelFetch(u_f0, p, 0).rgb), 1.0);
#else
    return 1.0 - min(hbil_finite(texelFetch(u_f0, p, 0).rrr), 1.0);
#endif
}

//@ chunk hbil_load_albedo
vec3 hbil_load_albedo(ivec2 p) {
    return min(hbil_finite(texelFetch(u_albedo, p, 0).rgb), vec3(1.0));
}
