// signal: what goes from the march through the filters, and the outputs that the last of these passes makes of it.

//@ chunk HBIL_LAYERS
const int HBIL_LAYERS = 0 // of a signal, each a vec4
#if HBIL_LIGHT_LAYER
    + 1 // rgb near light, a ao. One slice: both not yet divided by the light of an open sky, and a what is hidden
#endif
#if HBIL_BENT_LAYER
    + 1 // xyz bent vector. One slice: a light of an open sky
#endif
#if HBIL_FAR_LAYER
    + 1 // rgb far light, a uniform ao
#endif
#if HBIL_OUTPUTS_SH
    + 4 // as u_sh
#endif
    ;

//@ chunk HBIL_AT_BENT
#if HBIL_LIGHT_LAYER
const int HBIL_AT_BENT = 1; // layer of the bent vector
#else
const int HBIL_AT_BENT = 0; // layer of the bent vector
#endif

//@ chunk HBIL_AT_FAR
const int HBIL_AT_FAR = 0 // layer of far light
#if HBIL_LIGHT_LAYER
    + 1
#endif
#if HBIL_BENT_LAYER
    + 1
#endif
    ;

//@ chunk HBIL_AT_SH
const int HBIL_AT_SH = HBIL_LAYERS - 4; // first layer of sh

//@ chunk hbil_signal
// Layer of the signal that the pass before left. Ao alone lies in the only channel.
vec4 hbil_signal(ivec2 p, int layer) {
#if HBIL_ONLY_AO
    return texelFetch(u_from, ivec3(p, layer), 0).rrrr;
#else
    return texelFetch(u_from, ivec3(p, layer), 0);
#endif
}

//@ chunk hbil_pass_on
// Leave a signal for the next pass.
void hbil_pass_on(ivec2 p, vec4 s[HBIL_LAYERS]) {
#if HBIL_STORAGE_HALF || HBIL_ARITHMETIC_HALF
    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = clamp(s[i], vec4(-HBIL_RADIANCE_MAX), vec4(HBIL_RADIANCE_MAX));
#endif
#if HBIL_ONLY_AO
    s[0] = vec4(s[0].a);
#endif
#if HBIL_STAGE_COMPUTE
    for (int i = 0; i < HBIL_LAYERS; ++i) imageStore(u_to, ivec3(p, i), s[i]);
#else
#if HBIL_LIGHT_LAYER
    u_to[0] = s[0];
#endif
#if HBIL_BENT_LAYER
    u_to[HBIL_AT_BENT] = s[HBIL_AT_BENT];
#endif
#if HBIL_FAR_LAYER
    u_to[HBIL_AT_FAR] = s[HBIL_AT_FAR];
#endif
#if HBIL_OUTPUTS_SH
    u_to[HBIL_AT_SH] = s[HBIL_AT_SH];
    u_to[HBIL_AT_SH + 1] = s[HBIL_AT_SH + 1];
    u_to[HBIL_AT_SH + 2] = s[HBIL_AT_SH + 2];
    u_to[HBIL_AT_SH + 3] = s[HBIL_AT_SH + 3];
#endif
#endif
}

//@ chunk hbil_store_sh_at
// The output sh.
void hbil_store_sh_at(ivec2 p, vec4 a, vec4 b, vec4 c, vec4 d) {
#if HBIL_STAGE_COMPUTE
    imageStore(u_sh, ivec3(p, 0), a);
    imageStore(u_sh, ivec3(p, 1), b);
    imageStore(u_sh, ivec3(p, 2), c);
    imageStore(u_sh, ivec3(p, 3), d);
#else
    u_sh[0] = a;
    u_sh[1] = b;
    u_sh[2] = c;
    u_sh[3] = d;
#endif
}

//@ chunk hbil_finish
// A signal to outputs.
void hbil_finish(ivec2 p, vec4 s[HBIL_LAYERS]) {
#if HBIL_DEFER
    float scale = 1.0 / s[HBIL_AT_BENT].a; // never 0: n.v is not
    s[0] *= scale;
    s[0].a = 1.0 - s[0].a;
#if HBIL_FAR_BITS
    s[HBIL_AT_FAR].rgb = hbil_finite(scale * s[HBIL_AT_FAR].rgb); // scale: a thousand where the surface is seen edge-on
#endif
#if HBIL_OUTPUTS_SH
    for (int i = 1; i < 4; ++i) s[HBIL_AT_SH + i] *= scale;
#endif
#endif
#if HBIL_VISIBILITY
    float ao = clamp(s[0].a, 0.0, 1.0);
#if !HBIL_AO_EXPONENT_1
    float lift = exp2((HBIL_AO_EXPONENT - 1.0) * log2(max(ao, 1e-6)));
    ao = min(ao * lift, 1.0); // Vulkan lets a logarithm of 1 be wrong by 5e-7
#endif
#endif
#if HBIL_AO
    imageStore(u_ao, p, vec4(ao));
#endif
#if HBIL_BENT
    vec3 bent = s[HBIL_AT_BENT].xyz;
#if !HBIL_AO_EXPONENT_1
    bent *= lift;
#endif
    bent *= min(inversesqrt(max(dot(bent, bent), 1e-12)), 1.0); // one slice or a lift may take it beyond 1
    imageStore(u_bent, p, vec4(bent, 1.0));
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    imageStore(u_uniform_ao, p, vec4(min(s[HBIL_AT_FAR].a, 1.0)));
#endif
#if HBIL_NEAR_LIGHT
    vec3 near = s[0].rgb;
#if !HBIL_F0_NONE
    near *= hbil_diffuse(p);
#endif
    imageStore(u_near, p, vec4(near, 1.0));
#endif
#if HBIL_OUTPUTS_SH
    vec4 a = s[HBIL_AT_SH + 1];
    vec4 b = s[HBIL_AT_SH + 2];
    vec4 c = s[HBIL_AT_SH + 3];
    // no light comes from less than one direction, but the ratio of few slices may say so
    vec4 fit = min(1.7320508 * s[HBIL_AT_SH] * inversesqrt(max(a * a + b * b + c * c, vec4(1e-30))), vec4(1.0));
    hbil_store_sh_at(p, s[HBIL_AT_SH], fit * a, fit * b, fit * c);
#endif
#if HBIL_FAR_BITS
    vec3 far = HBIL_FAR_INTENSITY * s[HBIL_AT_FAR].rgb;
#if !HBIL_F0_NONE
    far *= hbil_diffuse(p);
#endif
    imageStore(u_far, p, vec4(far, 1.0));
#endif
}

//@ chunk hbil_finish_sky
// Outputs of a pixel without a surface.
void hbil_finish_sky(ivec2 p) {
#if HBIL_AO
    imageStore(u_ao, p, vec4(1.0));
#endif
#if HBIL_BENT
    imageStore(u_bent, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    imageStore(u_uniform_ao, p, vec4(1.0));
#endif
#if HBIL_NEAR_LIGHT
    imageStore(u_near, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
#if HBIL_OUTPUTS_SH
    hbil_store_sh_at(p, vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
#endif
#if HBIL_FAR_BITS
    imageStore(u_far, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
}

//@ chunk HBIL_FILTER_PLANE
const float HBIL_FILTER_PLANE = 1.0; // distance from the tangent plane at which a neighbour counts no more. pixels

//@ chunk HBIL_FILTER_NORMAL
const float HBIL_FILTER_NORMAL = 4.0; // 1 / square of the angle between normals at which it does not. rad^-2

//@ chunk hbil_surface
// The surface at a pixel, as its neighbours are held against it.
struct hbil_surface {
    vec3 position;
    vec3 n;
    vec2 code;     // of n, octahedral
    float pixel;   // width of a pixel of the grid there. m
};

//@ chunk hbil_surface_at
// pixel: on the grid
hbil_surface hbil_surface_at(vec2 pixel, float z, uint normal) {
    hbil_surface s;
    s.position = hbil_position(pixel, z);
    s.n = hbil_decode_normal(normal);
    s.code = hbil_unpack_snorm(normal);
    s.pixel = length(hbil_position(pixel + vec2(1.0, 0.0), z) - s.position);
    return s;
}

//@ chunk hbil_belongs
// How far pixel q of the grid, `gap` pixels away, is part of a surface: up to 1, 0 and less is not.
float hbil_belongs(hbil_surface s, ivec2 q, float gap) {
    float z = hbil_load_depth(q);
    if (z >= HBIL_SKY) return 0.0;
    float off = abs(dot(s.n, hbil_position(vec2(q) + 0.5, z) - s.position));
    vec2 turn = hbil_unpack_snorm(texelFetch(u_view_normal, q, 0).r) - s.code;
    return max(1.0 - off / max(HBIL_FILTER_PLANE * gap * s.pixel, 1e-30), 0.0)
        * (1.0 - HBIL_FILTER_NORMAL * dot(turn, turn));
}

//@ chunk HBIL_FILTER_RADIUS
#if HBIL_FILTER_3X3
const int HBIL_FILTER_RADIUS = 1; // pixels
#else
const int HBIL_FILTER_RADIUS = 2; // pixels
#endif

//@ chunk hbil_blend
// Move the mean towards the signal at a pixel: no sum can leave the range of a half float.
#if HBIL_ARITHMETIC_HALF
void hbil_blend(ivec2 q, mediump float share, inout mediump vec4 s[HBIL_LAYERS]) {
    for (int i = 0; i < HBIL_LAYERS; ++i) {
        mediump vec4 other = hbil_signal(q, i);
        s[i] += share * (other - s[i]);
    }
}
#else
void hbil_blend(ivec2 q, float share, inout vec4 s[HBIL_LAYERS]) {
    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] += share * (hbil_signal(q, i) - s[i]);
}
#endif

//@ chunk hbil_filter_share
#if HBIL_TEMPORAL_YES
// Weight of a neighbour beside the pixel itself: noise of the running mean falls faster with its frames than detail is
// worth.
float hbil_filter_share(ivec2 p) {
    float frames = float(texelFetch(u_seen, p, 0).r & 63u);
    return max(1.0 / (1.0 + 0.05 * frames * frames), 0.1);
}
#endif

//@ chunk hbil_filter
// Mean of a signal over the neighbours of a pixel, `gap` pixels apart, that lie on the same surface. What few slices
// per pixel get wrong differs from pixel to pixel, and cancels. False: there is no surface.
#if HBIL_ARITHMETIC_HALF
bool hbil_filter(ivec2 p, int gap, out mediump vec4 s[HBIL_LAYERS]) {
#else
bool hbil_filter(ivec2 p, int gap, out vec4 s[HBIL_LAYERS]) {
#endif
    float z = hbil_load_depth(p);
    if (z >= HBIL_SKY) return false;
    hbil_surface here = hbil_surface_at(vec2(p) + 0.5, z, texelFetch(u_view_normal, p, 0).r);
    float all = 1.0;
#if HBIL_TEMPORAL_YES
    float share = hbil_filter_share(p);
#endif
    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = hbil_signal(p, i);
    for (int y = -HBIL_FILTER_RADIUS; y <= HBIL_FILTER_RADIUS; ++y)
        for (int x = -HBIL_FILTER_RADIUS; x <= HBIL_FILTER_RADIUS; ++x) {
            ivec2 q = p + gap * ivec2(x, y);
            if (q == p || any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) continue;
            float w = hbil_belongs(here, q, float(gap));
            if (w <= 0.0) continue;
#if HBIL_TEMPORAL_YES
            w *= share;
#endif
            all += w;
            hbil_blend(q, w / all, s);
        }
    return true;
}
