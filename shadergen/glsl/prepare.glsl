// prepare: depth of any convention to metres, normals to view space, sky classified on the raw value.

//@ chunk hbil_load_raw_depth
float hbil_load_raw_depth(ivec2 p) {
#if HBIL_MULTISAMPLE_YES
    return texelFetch(u_depth, p, HBIL_SAMPLE).r;
#else
    return texelFetch(u_depth, p, 0).r;
#endif
}

//@ chunk HBIL_LEAST_DEPTH
#if HBIL_PROJECTION_PERSPECTIVE
const float HBIL_LEAST_DEPTH = 1e-9; // nearer is no surface: squares of lengths would underflow, nearness overflow. m
#endif

//@ chunk hbil_view_depth
// View depth of the surface at a pixel. m; HBIL_SKY where there is none. The sky test reads the raw value, before any
// arithmetic could round it, and is written so that NaN is sky too.
float hbil_view_depth(ivec2 p) {
    float raw = hbil_load_raw_depth(p);
#if HBIL_DEPTH_LINEAR
    float z = raw;
    bool surface = raw < HBIL_SKY_DEPTH;
#else
#if HBIL_DEPTH_DIRECTION_REVERSED
    float d = raw;
#else
    float d = 1.0 - raw;
#endif
    bool surface = d > 0.0;
#if HBIL_PROJECTION_ORTHOGRAPHIC
    float z = d * HBIL_DEPTH_TO_VIEW.x + HBIL_DEPTH_TO_VIEW.y;
#elif HBIL_DEPTH_FAR_INFINITE
    float z = 1.0 / max(d * HBIL_DEPTH_TO_VIEW.x, 1e-30); // the sky's: 1e30
#else
    float z = 1.0 / max(d * HBIL_DEPTH_TO_VIEW.x + HBIL_DEPTH_TO_VIEW.y, 1e-30);
#endif
#endif
#if HBIL_PROJECTION_PERSPECTIVE
    return surface && z >= HBIL_LEAST_DEPTH && z < HBIL_SKY ? z : HBIL_SKY;
#else
    return surface && abs(z) < HBIL_SKY ? z : HBIL_SKY;
#endif
}

//@ chunk hbil_unfold
#if HBIL_NORMAL_ENCODING_OCTAHEDRAL || HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM || HBIL_NORMAL_ENCODING_OCTAHEDRAL_888
// Vector of an octahedral map with +z in its middle, not normalised. o in [-1, 1]
vec3 hbil_unfold(vec2 o) {
    vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
    float fold = max(-n.z, 0.0);
    n.xy += mix(vec2(fold), vec2(-fold), greaterThanEqual(n.xy, vec2(0.0)));
    return n;
}
#endif

//@ chunk hbil_load_raw_normal
#if !HBIL_NORMALS_DEPTH
// The normal as its channels say, not normalised.
vec3 hbil_load_raw_normal(ivec2 p) {
#if HBIL_MULTISAMPLE_YES
    vec3 t = texelFetch(u_normal, p, HBIL_SAMPLE).xyz;
#else
    vec3 t = texelFetch(u_normal, p, 0).xyz;
#endif
#if HBIL_NORMAL_ENCODING_XYZ_UNORM
    return t * 2.0 - 1.0;
#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL
    return hbil_unfold(t.xy);
#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL_UNORM
    return hbil_unfold(t.xy * 2.0 - 1.0);
#elif HBIL_NORMAL_ENCODING_OCTAHEDRAL_888
    // low bytes of x and y, then their high halves in one byte
    uvec3 b = uvec3(hbil_finite(t) * 255.0 + 0.5);
    uvec2 o = b.xy | uvec2((b.z & 15u) << 8, (b.z >> 4) << 8);
    return hbil_unfold(vec2(o) / 4095.0 * 2.0 - 1.0);
#elif HBIL_NORMAL_ENCODING_XY || HBIL_NORMAL_ENCODING_XY_UNORM
#if HBIL_NORMAL_ENCODING_XY_UNORM
    t = t * 2.0 - 1.0;
#endif
    // quantised channels may be longer than 1: the root is guarded. z towards the camera
    return vec3(t.xy, -HBIL_VIEW_Z * sqrt(max(1.0 - dot(t.xy, t.xy), 0.0)));
#else
    return t;
#endif
}
#endif

//@ chunk hbil_neighbour
// Nearness at a pixel; -1e30 outside the screen and on the sky.
float hbil_neighbour(ivec2 p) {
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, hbil_frame_size()))) return -1e30;
    float z = hbil_view_depth(p);
    return z < HBIL_SKY ? hbil_nearness(z) : -1e30;
}

//@ chunk hbil_tangent
// Surface tangent along one screen axis: towards the side whose two pixels lie straighter in line with this one, so
// that a silhouette or a crease beside the pixel is not averaged in.
vec3 hbil_tangent(ivec2 p, ivec2 axis, float z) {
    float here = hbil_nearness(z);
    float left = hbil_neighbour(p - axis);
    float right = hbil_neighbour(p + axis);
    float bend_left = abs(2.0 * left - hbil_neighbour(p - 2 * axis) - here);
    float bend_right = abs(2.0 * right - hbil_neighbour(p + 2 * axis) - here);
    bool lost_left = left < -1e29;
    bool lost_right = right < -1e29;
    // right where both bend alike: by 1e30, if the first pixel of one side and the second of the other are lost
    float side = lost_right || bend_left < bend_right ? -1.0 : 1.0;
    float there = side < 0.0 ? left : right;
    if (lost_left && lost_right) there = here;
    vec2 q = hbil_centre(p + int(side) * axis);
    return side * (hbil_position(q, hbil_depth_of(there)) - hbil_position(hbil_centre(p), z));
}

//@ chunk hbil_view_normal
// Unit normal in view space, z into the screen. A normal that is zero, infinite or NaN is replaced by the view vector.
vec3 hbil_view_normal(ivec2 p, float z) {
    vec3 v = hbil_view_vector(hbil_centre(p));
#if HBIL_NORMALS_DEPTH
    vec3 n = cross(hbil_tangent(p, ivec2(1, 0), z), hbil_tangent(p, ivec2(0, 1), z));
    n /= max(max(abs(n.x), abs(n.y)), max(abs(n.z), 1e-30));
    n = dot(n, v) < 0.0 ? -n : n;
#elif HBIL_NORMALS_WORLD
    vec3 n = HBIL_WORLD_TO_VIEW * hbil_load_raw_normal(p);
#else
    vec3 n = hbil_load_raw_normal(p) * vec3(1.0, 1.0, HBIL_VIEW_Z);
#endif
    float l2 = dot(n, n);
    return l2 > 0.0 && l2 < 1e12 ? n * inversesqrt(l2) : v;
}

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, hbil_frame_size()))) return;
    float z = hbil_view_depth(p);
    uint normal = z < HBIL_SKY ? hbil_encode_normal(hbil_view_normal(p, z)) : 0u;
#if HBIL_COARSE
    imageStore(u_full_depth, p, vec4(z));
    imageStore(u_full_normal, p, uvec4(normal));
#else
    imageStore(u_view_depth, p, vec4(z));
    imageStore(u_view_normal, p, uvec4(normal));
#if HBIL_PACKED && !HBIL_BOUNCES_RECURSIVE
    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(hbil_load_radiance(p))));
#endif
#if HBIL_REPROJECT_SCATTER
    imageStore(u_landed, p, uvec4(HBIL_NOWHERE));
#endif
#endif
}
