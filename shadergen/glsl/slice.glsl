// slice: what the estimators share. Where samples lie, what a receiver is, whose light a sample gives.
//
// A slice is the plane of the view vector V and a tangent D of it. A direction in it is sin(t) D + cos(t) V; the side
// of +D is front, the other one back. A horizon is the cosine c of the unsigned angle from V: larger is higher.

//@ chunk hbil_hilbert
// Index of a pixel along a Hilbert curve that fills a 64 x 64 tile: neighbours on screen stay close in the sequence.
uint hbil_hilbert(uvec2 p) {
    uint index = 0u;
    for (uint side = 32u; side > 0u; side >>= 1) {
        uvec2 r = uvec2((p.x & side) != 0u ? 1u : 0u, (p.y & side) != 0u ? 1u : 0u);
        index += side * side * ((3u * r.x) ^ r.y);
        if (r.y == 0u) {
            if (r.x == 1u) p = uvec2(63u) - p;
            p = p.yx;
        }
    }
    return index;
}

//@ chunk hbil_gradient
// Interleaved gradient noise in [0, 1). Jimenez 2014
float hbil_gradient(vec2 p) {
    return fract(52.9829189 * fract(dot(p, vec2(0.06711056, 0.00583715))));
}

//@ chunk hbil_block
// Place of a pixel in its block of 4 x 4, as in a Bayer matrix: neighbours are far apart in the sequence. [0, 15]
uint hbil_block(ivec2 p) {
    uint x = uint(p.x);
    uint y = uint(p.x ^ p.y);
    return ((y & 1u) << 3) | ((x & 1u) << 2) | (y & 2u) | ((x & 2u) >> 1);
}

//@ chunk hbil_noise
// x rotates the slices, y jitters the steps, z the edges of sectors. [0, 1)
vec3 hbil_noise(ivec2 p) {
#if HBIL_NOISE_HILBERT_R2
    // R2 sequence in 32-bit fixed point: exact, the same on every device, for any frame number. Roberts 2018
#if HBIL_INTERLEAVE_YES
    uint index = hbil_block(p) + 16u * HBIL_FRAME_INDEX;
#else
    uint index = hbil_hilbert(uvec2(p) & 63u) + 288u * HBIL_FRAME_INDEX;
#endif
    uvec3 r2 = uvec3(3242174889u, 2447445414u, 2654435769u) * index + 2147483648u;
    return vec3(r2 >> 8) / 16777216.0;
#elif HBIL_NOISE_IGN
#if HBIL_INTERLEAVE_YES
    p &= 3;
#endif
    vec2 q = vec2(p) + 5.588238 * float(HBIL_FRAME_INDEX % 61u);
    return vec3(hbil_gradient(q), hbil_gradient(q.yx + vec2(47.0, 17.0)), hbil_gradient(q + vec2(31.0, 83.0)));
#else
    return vec3(0.5);
#endif
}

//@ chunk hbil_arc
// G(c) = acos(c) - c sqrt(1 - c c): twice the integral of sin^2 from the view vector to the horizon, c in [-1, 1].
// Error 8e-5, monotone: no increment below is negative by more than rounding.
float hbil_arc(float c) {
    float a = abs(c);
    float g = (1.0 - a) * sqrt(1.0 - a) * (1.570796327 + a * (0.354230314 - 0.042259066 * a));
    return c < 0.0 ? HBIL_PI - g : g;
}

//@ chunk HBIL_STRIDE
#if HBIL_SAMPLING_BILINEAR
const float HBIL_STRIDE = 0.125; // first sample, and least distance of two samples. pixels
#else
const float HBIL_STRIDE = 1.0; // first sample, and least distance of two samples. pixels
#endif

//@ chunk hbil_offset
// Distance of the sample t in [0, 1) from the pixel, for a reach of R pixels. pixels, HBIL_STRIDE at t = 0
float hbil_offset(float t, float reach_px) {
#if HBIL_SPACING_GEOMETRIC
    return HBIL_STRIDE * exp2(t * log2(max(reach_px / HBIL_STRIDE, 1.0)));
#elif HBIL_EXPONENT_1
    return HBIL_STRIDE + t * (reach_px - HBIL_STRIDE);
#elif HBIL_EXPONENT_2
    return HBIL_STRIDE + t * t * (reach_px - HBIL_STRIDE);
#else
    return HBIL_STRIDE + exp2(HBIL_EXPONENT * log2(max(t, 1e-6))) * (reach_px - HBIL_STRIDE);
#endif
}

//@ chunk hbil_border
// Pixels from p along the unit direction d until the screen ends; a little less, so that rounding leads nowhere
// outside.
float hbil_border(ivec2 p, vec2 d) {
    vec2 room = mix(vec2(p), vec2(HBIL_SIZE - 1 - p), greaterThan(d, vec2(0.0))) + 0.49;
    vec2 t = room / max(abs(d), vec2(1e-6));
    return min(t.x, t.y);
}

//@ chunk hbil_reach
// Pixels along the slice direction D in which the sphere of radius HBIL_REACH around the point shows: the tangent to
// it from the eye, in the slice. The whole screen if the eye is inside.
float hbil_reach(vec3 position, vec3 v, vec3 slice) {
#if HBIL_PROJECTION_PERSPECTIVE
    float s = min(HBIL_REACH * inversesqrt(dot(position, position)), 1.0);
    vec3 edge = slice * s - v * sqrt(1.0 - s * s);
    if (s >= 1.0 || edge.z <= 0.0) return 1e6;
    return length((edge.xy / edge.z - position.xy / position.z) / HBIL_PIXEL_TO_RAY.xy);
#else
    return length(HBIL_REACH * slice.xy / HBIL_PIXEL_TO_RAY.xy);
#endif
}

//@ chunk hbil_receiver
// What the samples of a pixel have in common.
struct hbil_receiver {
    ivec2 pixel;
    vec3 position; // pulled towards the camera
    vec3 v;        // to the eye
    vec3 n;        // n.v >= HBIL_LEAST_NY
    float ny;      // n.v, the same in every slice
#if HBIL_FAR_BITS && HBIL_FAR_SH
    hbil_sh sh;    // environment around it
#endif
};

//@ chunk HBIL_LEAST_NY
const float HBIL_LEAST_NY = 0.001; // of the cosine of normal and view vector; a turned normal darkens planes

//@ chunk hbil_turned
// A shading normal may face away from the eye (interpolated, bumped): it is turned until it does not, since the
// horizons of a slice then lie on both sides of V, which all closed forms below rely on.
vec3 hbil_turned(vec3 n, vec3 v) {
    float ny = dot(n, v);
    return ny < HBIL_LEAST_NY ? normalize(n + (HBIL_LEAST_NY - ny) * v) : n;
}

//@ chunk hbil_receive
hbil_receiver hbil_receive(ivec2 p, float z) {
    hbil_receiver r;
    r.pixel = p;
    r.position = hbil_position(vec2(p) + 0.5, z - HBIL_PULL * abs(z));
    r.v = hbil_view_vector(vec2(p) + 0.5);
    r.n = hbil_turned(hbil_load_normal(p), r.v);
    r.ny = dot(r.n, r.v);
#if HBIL_FAR_BITS && HBIL_ENVIRONMENT_PROBES
    r.sh = hbil_load_sh(hbil_world_position(r.position));
#elif HBIL_FAR_BITS && HBIL_ENVIRONMENT_SH
    r.sh = hbil_load_sh();
#endif
    return r;
}

//@ chunk hbil_surface_depth
#if HBIL_SAMPLING_BILINEAR
// Depth of the surface between four pixel centres: bilinear in nearness, so that planes are exact. HBIL_SKY where a
// corner is sky or off the screen.
float hbil_surface_depth(vec2 pixel) {
    ivec2 p = ivec2(floor(pixel - 0.5));
    vec2 f = pixel - 0.5 - vec2(p);
    if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p + 1, HBIL_SIZE))) return HBIL_SKY;
    vec4 z = vec4(hbil_load_depth(p), hbil_load_depth(p + ivec2(1, 0)),
        hbil_load_depth(p + ivec2(0, 1)), hbil_load_depth(p + ivec2(1, 1)));
    if (max(max(z.x, z.y), max(z.z, z.w)) >= HBIL_SKY) return HBIL_SKY;
    return hbil_depth_of(mix(mix(hbil_nearness(z.x), hbil_nearness(z.y), f.x),
        mix(hbil_nearness(z.z), hbil_nearness(z.w), f.x), f.y));
}
#endif

//@ chunk hbil_side
// One side of a slice.
struct hbil_side {
    vec3 tangent;   // D, or -D for the back
#if HBIL_SWEPT
    hbil_line line;
#endif
#if HBIL_SAMPLED
    vec2 d;         // its direction on the screen, unit
    float reach_px; // pixels to search
    float jitter;
#endif
#if !HBIL_ESTIMATOR_HBAO_PLUS
    float nx;       // normal along the tangent
    float c0;       // horizon of the tangent plane, where the search starts
#endif
};

//@ chunk hbil_side_of
#if HBIL_MARCH_SWEEP
hbil_side hbil_side_of(hbil_receiver r, vec3 slice, hbil_line line) {
    hbil_side s;
    s.tangent = slice;
    s.line = line;
#else
// back: -1 for the side of -D, 1 for the other one.
hbil_side hbil_side_of(hbil_receiver r, vec3 slice, vec2 d, float jitter, float back) {
    hbil_side s;
    s.tangent = back * slice;
    s.d = back * d;
    s.reach_px = hbil_border(r.pixel, s.d);
#if !HBIL_REACH_0
    s.reach_px = min(s.reach_px, hbil_reach(r.position, r.v, s.tangent));
#endif
    s.jitter = jitter;
#endif
#if !HBIL_ESTIMATOR_HBAO_PLUS
    s.nx = dot(r.n, s.tangent);
    s.c0 = -s.nx * inversesqrt(s.nx * s.nx + r.ny * r.ny); // short of 1 by 5e-7, since ny is at least HBIL_LEAST_NY
#endif
    return s;
}

//@ chunk hbil_horizon_at
#if HBIL_SWEPT
// Horizon that pixel q makes on a side.
float hbil_horizon_at(hbil_receiver r, hbil_side s, ivec2 q) {
    vec3 h = hbil_position(vec2(q) + 0.5, hbil_load_depth(q)) - r.position;
    float inv = inversesqrt(max(dot(h, h), 1e-30));
    float c = clamp(dot(h, r.v) * inv, -1.0, 1.0);
    return c > s.c0 && dot(r.n, h) * inv > HBIL_BIAS ? c : s.c0;
}
#endif

//@ chunk hbil_swept
#if HBIL_MARCH_SWEEP
// Horizon that the sweep found on a side: layer 0 or 1 of its slice. One depth to load, and the mean radiance of what
// it hides.
#if HBIL_GATHER
float hbil_swept(hbil_receiver r, hbil_side s, int layer, out vec3 radiance) {
    radiance = hbil_unpack_radiance(texelFetch(u_swept_light, ivec3(r.pixel, layer), 0).r);
#else
float hbil_swept(hbil_receiver r, hbil_side s, int layer) {
#endif
    int back = hbil_back(texelFetch(u_swept, ivec3(r.pixel, layer), 0).r);
    ivec2 from = hbil_across(s.line, r.pixel);
    int to = layer % 2 == 0 ? from.x + back : from.x - back;
    return hbil_horizon_at(r, s, hbil_pixel(s.line, from.y - hbil_shift(s.line, from.x), to)); // not at itself
}
#elif HBIL_MARCH_BOTH
// Horizon of all beyond the samples on a side: the hull of the pixel where they end, as seen from the receiver. Layer
// 0 or 1 of its slice.
#if HBIL_GATHER
float hbil_swept(hbil_receiver r, hbil_side s, int layer, out vec3 radiance) {
    radiance = vec3(0.0);
#else
float hbil_swept(hbil_receiver r, hbil_side s, int layer) {
#endif
    ivec2 from = hbil_across(s.line, r.pixel);
    int start = from.y - hbil_shift(s.line, from.x);
    int way = layer % 2 == 0 ? 1 : -1;
    hbil_vertex at;
    at.nearness = hbil_nearness(r.position.z);
    at.step = from.x;
    hbil_vertex v;
    v.step = from.x + way * (1 + int(s.reach_px * max(abs(s.line.d.x), abs(s.line.d.y))));
    ivec2 q = hbil_pixel(s.line, start, v.step);
    if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) return s.c0;
    uint code = texelFetch(u_swept, ivec3(q, layer), 0).r;
    float z = hbil_load_depth(q);
    if (z >= HBIL_SKY) { // on to the next surface
        v.step += way * hbil_back(code);
        q = hbil_pixel(s.line, start, v.step);
        if (hbil_back(code) == 0) return s.c0;
        code = texelFetch(u_swept, ivec3(q, layer), 0).r;
        z = hbil_load_depth(q);
    }
    v.nearness = hbil_nearness(z);
#if HBIL_GATHER
    at.rise = hbil_rise(s.line, at.nearness, v.nearness);
    radiance = hbil_unpack_radiance(texelFetch(u_view_radiance, q, 0).r);
    at.light = at.rise * radiance;
#endif
    while (hbil_back(code) != 0) {
        int outward = v.step + way * hbil_back(code);
        ivec2 next = hbil_pixel(s.line, start, outward);
        float nearness = hbil_nearness(hbil_load_depth(next));
        if (!hbil_steeper(at, v, outward, nearness)) break;
#if HBIL_GATHER
        v.rise = hbil_rise_in(code);
        at.rise += v.rise;
        at.light += v.rise * hbil_unpack_radiance(texelFetch(u_swept_light, ivec3(q, layer), 0).r);
#endif
        v.nearness = nearness;
        v.step = outward;
        q = next;
        code = texelFetch(u_swept, ivec3(q, layer), 0).r;
    }
#if HBIL_GATHER
    if (at.rise > 0.0) radiance = at.light / at.rise;
#endif
    return hbil_horizon_at(r, s, q);
}
#endif

//@ chunk hbil_visit
// Where a side's search is.
struct hbil_visit {
    float offset; // pixels from the receiver
    vec2 pixel;   // centres at .5
    float z;      // depth of the surface there, HBIL_SKY if there is none. m
#if HBIL_MIPS
    int level;    // that it was read from
#endif
};

//@ chunk hbil_start
// The receiver itself.
hbil_visit hbil_start(hbil_receiver r) {
    hbil_visit at;
    at.offset = 0.0;
    at.pixel = vec2(r.pixel) + 0.5;
    at.z = HBIL_SKY;
#if HBIL_MIPS
    at.level = 0;
#endif
    return at;
}

//@ chunk HBIL_FINE
const float HBIL_FINE = 4.0; // distance of a sample, in texels, from which on it reads the next coarser level

//@ chunk hbil_go
// On to sample i: never the receiver itself, never one place twice. false: the side has ended.
bool hbil_go(hbil_receiver r, hbil_side s, int i, inout hbil_visit at) {
    at.offset = max(hbil_offset((float(i) + s.jitter) / float(HBIL_STEPS), s.reach_px), at.offset + HBIL_STRIDE);
    if (at.offset > s.reach_px) return false;
#if HBIL_SAMPLING_BILINEAR
    at.pixel = vec2(r.pixel) + 0.5 + at.offset * s.d;
    at.z = hbil_surface_depth(at.pixel);
#else
    ivec2 q = r.pixel + ivec2(floor(at.offset * s.d + 0.5));
#if HBIL_MIPS
    at.level = clamp(int(log2(at.offset / HBIL_FINE)), 0, hbil_levels());
    q >>= at.level;
    at.pixel = (vec2(q) + 0.5) * float(1 << at.level);
    at.z = texelFetch(u_depth_mips, hbil_level_at(q, at.level), 0).r;
#else
    at.pixel = vec2(q) + 0.5;
    at.z = hbil_load_depth(q);
#endif
#endif
    return true;
}

//@ chunk hbil_fade
#if !HBIL_REACH_0
// What is left of an occluder at a distance. [0, 1]
float hbil_fade(float distance) {
    return clamp((1.0 - distance / HBIL_REACH) / HBIL_FALLOFF, 0.0, 1.0);
}
#endif

//@ chunk hbil_normal_at
// Normal of the surface that a sample sees. The middle of a coarser texel may lie beyond the screen.
vec3 hbil_normal_at(hbil_visit at) {
#if HBIL_MIPS
    return hbil_load_normal(min(ivec2(at.pixel), HBIL_SIZE - 1));
#else
    return hbil_load_normal(ivec2(at.pixel));
#endif
}

//@ chunk hbil_load_radiance
vec3 hbil_load_radiance(ivec2 p) {
    vec3 radiance = hbil_finite(texelFetch(u_radiance, p, 0).rgb);
#if !HBIL_FIREFLY_0
    radiance *= min(1.0, HBIL_FIREFLY / max(max(radiance.r, max(radiance.g, radiance.b)), 1e-30));
#endif
    return radiance;
}

//@ chunk hbil_radiance_at
// Light of the surface that a sample sees.
#if HBIL_MIPS
vec3 hbil_radiance_at(hbil_visit at) {
    ivec2 q = ivec2(at.pixel) >> at.level;
    return hbil_unpack_radiance(texelFetch(u_radiance_mips, hbil_level_at(q, at.level), 0).r);
}
#elif HBIL_PACKED
vec3 hbil_radiance_at(hbil_visit at) {
    return hbil_unpack_radiance(texelFetch(u_view_radiance, ivec2(at.pixel), 0).r);
}
#else
vec3 hbil_radiance_at(hbil_visit at) {
    return hbil_load_radiance(ivec2(at.pixel));
}
#endif

//@ chunk HBIL_FILTER_LOW
const float HBIL_FILTER_LOW = -0.1; // cosine at a source up to which it faces away; Mayaux 2018 gives no value

//@ chunk HBIL_FILTER_HIGH
const float HBIL_FILTER_HIGH = 0.1; // and from which on it faces the receiver

//@ chunk hbil_source
#if HBIL_FACING_FILTER
// Light that a sample sees along the unit vector `along`. A surface that faces away hides what is behind it, but is
// not what lights the receiver: the last light that was accepted stands in.
vec3 hbil_source(hbil_visit at, vec3 along, inout vec3 accepted) {
    float t = smoothstep(HBIL_FILTER_LOW, HBIL_FILTER_HIGH, -dot(hbil_normal_at(at), along));
    accepted = mix(accepted, hbil_radiance_at(at), t);
    return accepted;
}
#endif

//@ chunk hbil_sums
// Sums over the slices.
struct hbil_sums {
#if HBIL_SWEPT
    float weight;  // azimuth that the slices stand for, up to a factor
#endif
#if !HBIL_COSINE
    float hidden; // part that is occluded, as the estimator weighs it
#endif
#if HBIL_SUMS
    float full;    // light of an open sky
    float blocked; // the part of it that is hidden
#endif
#if HBIL_NEAR_LIGHT
    vec3 near;     // what comes from there instead
#endif
#if HBIL_BENT
    vec3 bent;
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    float uniform_open;
#endif
#if HBIL_OUTPUTS_SH
    vec4 sh_0;     // rgb near radiance, a visibility: integrals over solid angle, of 1
    vec4 sh_x;     // and of the direction's components
    vec4 sh_y;
    vec4 sh_z;
#endif
#if HBIL_FAR_BITS
    vec3 far;
#endif
};

//@ chunk hbil_add_moments
#if HBIL_OUTPUTS_SH
// Directions that add up to m, seen with the given rgb radiance and a visibility.
void hbil_add_moments(vec3 m, vec4 seen, inout hbil_sums sum) {
    sum.sh_x += m.x * seen;
    sum.sh_y += m.y * seen;
    sum.sh_z += m.z * seen;
}
#endif
