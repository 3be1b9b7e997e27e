// march: horizons of every slice; visibility, near light and bent vector from the same samples.
//
// A slice is the plane of the view vector V and a tangent D of it. A direction in it is sin(t) D + cos(t) V; the side of
// +D is front, the other one back. A horizon is the cosine c of the unsigned angle from V: larger is higher.

//@ chunk HBIL_PI
const float HBIL_PI = 3.141592654;

//@ chunk hbil_load_depth
float hbil_load_depth(ivec2 p) {
    return texelFetch(u_view_depth, p, 0).r;
}

//@ chunk hbil_load_normal
vec3 hbil_load_normal(ivec2 p) {
    return hbil_decode_normal(texelFetch(u_view_normal, p, 0).r);
}

//@ chunk hbil_load_radiance
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
vec3 hbil_load_radiance(ivec2 p) {
    return hbil_finite(texelFetch(u_radiance, p, 0).rgb);
}
#endif

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

//@ chunk hbil_noise
// x rotates the slices, y jitters the steps. [0, 1)
vec2 hbil_noise(ivec2 p) {
#if HBIL_NOISE_HILBERT_R2
    // R2 sequence in 32-bit fixed point: exact, the same on every device, for any frame number. Roberts 2018
    uint index = hbil_hilbert(uvec2(p) & 63u) + 288u * HBIL_FRAME_INDEX;
    uvec2 r2 = uvec2(3242174889u, 2447445414u) * index + 2147483648u;
    return vec2(r2 >> 8) / 16777216.0;
#elif HBIL_NOISE_IGN
    vec2 q = vec2(p) + 5.588238 * float(HBIL_FRAME_INDEX & 63u);
    return vec2(hbil_gradient(q), hbil_gradient(q.yx + vec2(47.0, 17.0)));
#else
    return vec2(0.5);
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
// Pixels from p along the unit direction d until the screen ends.
float hbil_border(ivec2 p, vec2 d) {
    vec2 room = mix(vec2(p), vec2(HBIL_SIZE - 1 - p), greaterThan(d, vec2(0.0))) + 0.5;
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
    if (s >= 1.0 || edge.z <= 1e-4) return 1e6;
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
    vec3 n;        // n.v >= HBIL_FACING
    float ny;      // n.v, the same in every slice
};

//@ chunk HBIL_FACING
const float HBIL_FACING = 0.001; // least cosine of normal and view vector: small, since a turned normal darkens planes

//@ chunk hbil_receive
// A shading normal may face away from the eye (interpolated, bumped): it is bent back until it does not, since the
// horizons of a slice then lie on both sides of V, which all closed forms below rely on.
hbil_receiver hbil_receive(ivec2 p, float z) {
    hbil_receiver r;
    r.pixel = p;
    r.position = hbil_position(vec2(p) + 0.5, z - HBIL_PULL * abs(z));
    r.v = hbil_view_vector(vec2(p) + 0.5);
    r.n = hbil_load_normal(p);
    r.ny = dot(r.n, r.v);
    if (r.ny < HBIL_FACING) {
        r.n = normalize(r.n + (HBIL_FACING - r.ny) * r.v);
        r.ny = dot(r.n, r.v);
    }
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

//@ chunk hbil_arc_light
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
// Light of the pixel q through the arc between the horizons c and c_sample >= c.
vec3 hbil_arc_light(ivec2 q, float nx, float ny, float c, float c_sample) {
    float w = 0.5 * (nx * (hbil_arc(c) - hbil_arc(c_sample)) + ny * (c_sample - c) * (c_sample + c));
    return max(w, 0.0) * hbil_load_radiance(q);
}
#endif

//@ chunk hbil_step
#if HBIL_SAMPLING_BILINEAR && (HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE)
// From the sample before to this one: where on the screen, and the nearness of the surface at both ends.
struct hbil_step {
    vec2 to;
    vec2 way;
    float from_nearness; // -1e30: no surface there
    float to_nearness;
};
#endif

//@ chunk hbil_corner_light
#if HBIL_SAMPLING_BILINEAR && (HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE)
// Light of one corner of the cell around a sample. It stands in front of the rays from c up to the one that meets the
// surface where that is as near as the corner; the nearest corner (depth z_top) in front of all. Moves c there.
vec3 hbil_corner_light(hbil_receiver r, hbil_step s, ivec2 q, float z_top, float nx, float c_sample, inout float c) {
    float z = hbil_load_depth(q);
    float rise = s.to_nearness - s.from_nearness;
    float t = rise > 0.0 && rise < 1e29 ? clamp((hbil_nearness(z) - s.from_nearness) / rise, 0.0, 1.0) : 1.0;
    vec3 h = hbil_position(s.to - (1.0 - t) * s.way, z) - r.position;
    float low = c;
    c = z <= z_top ? c_sample : clamp(dot(h, r.v) * inversesqrt(max(dot(h, h), 1e-30)), c, c_sample);
    return hbil_arc_light(q, nx, r.ny, low, c);
}
#endif

//@ chunk hbil_cell_light
#if HBIL_SAMPLING_BILINEAR && (HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE)
// Light through the arc between the horizons c and c_sample: each ray gets that of the nearest of the four corners that
// stand in front of it.
vec3 hbil_cell_light(hbil_receiver r, hbil_step s, float nx, float c, float c_sample) {
    ivec2 q = ivec2(floor(s.to));
    vec2 f = s.to - floor(s.to) - 0.5;
    ivec2 x = ivec2(f.x < 0.0 ? -1 : 1, 0);
    ivec2 y = ivec2(0, f.y < 0.0 ? -1 : 1);
    ivec2 second = abs(f.x) > abs(f.y) ? x : y;
    float z_top = min(min(hbil_load_depth(q), hbil_load_depth(q + x)),
        min(hbil_load_depth(q + y), hbil_load_depth(q + x + y)));
    vec3 light = hbil_corner_light(r, s, q, z_top, nx, c_sample, c);
    light += hbil_corner_light(r, s, q + second, z_top, nx, c_sample, c);
    light += hbil_corner_light(r, s, q + x + y - second, z_top, nx, c_sample, c);
    light += hbil_corner_light(r, s, q + x + y, z_top, nx, c_sample, c);
    return light;
}
#endif

//@ chunk hbil_horizon
// Highest horizon on one side of a slice. d: unit direction on the screen, reach_px: pixels to search, nx: normal along
// this side, c: horizon of the tangent plane, where the search starts. Each rise adds the light of the arc that the
// sample fills.
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
float hbil_horizon(hbil_receiver r, vec2 d, float reach_px, float jitter, float nx, float c, inout vec3 near) {
#else
float hbil_horizon(hbil_receiver r, vec2 d, float reach_px, float jitter, float nx, float c) {
#endif
#if !HBIL_REACH_0
    float c_tangent = c;
#endif
    float offset = 0.0;
#if HBIL_SAMPLING_BILINEAR && (HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE)
    hbil_step s;
    s.to = vec2(r.pixel) + 0.5;
    s.to_nearness = hbil_nearness(r.position.z);
#endif
    for (int i = 0; i < HBIL_STEPS; ++i) {
        // never the receiver itself, never one place twice
        offset = max(hbil_offset((float(i) + jitter) / float(HBIL_STEPS), reach_px), offset + HBIL_STRIDE);
        if (offset > reach_px) break;
#if HBIL_SAMPLING_BILINEAR
        vec2 pixel = vec2(r.pixel) + 0.5 + offset * d;
        float z = hbil_surface_depth(pixel);
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
        s.way = pixel - s.to;
        s.to = pixel;
        s.from_nearness = s.to_nearness;
        s.to_nearness = z < HBIL_SKY ? hbil_nearness(z) : -1e30;
#endif
#else
        ivec2 q = r.pixel + ivec2(floor(offset * d + 0.5));
        if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) break;
        vec2 pixel = vec2(q) + 0.5;
        float z = hbil_load_depth(q);
#endif
        if (z >= HBIL_SKY) continue;
        vec3 h = hbil_position(pixel, z) - r.position;
        float l2 = max(dot(h, h), 1e-30);
        float inv = inversesqrt(l2);
        // at silhouettes h is nearly parallel to v and rounding takes the cosine above 1
        float c_sample = clamp(dot(h, r.v) * inv, -1.0, 1.0);
#if !HBIL_REACH_0
        // fade the horizon, not its weight: near + ao stays 1
        float fade = clamp((1.0 - l2 * inv / HBIL_REACH) / HBIL_FALLOFF, 0.0, 1.0);
        c_sample = mix(c_tangent, c_sample, fade);
#endif
        if (c_sample > c && dot(r.n, h) * inv > HBIL_BIAS) {
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
#if HBIL_SAMPLING_BILINEAR
            near += hbil_cell_light(r, s, nx, c, c_sample);
#else
            near += hbil_arc_light(q, nx, r.ny, c, c_sample);
#endif
#endif
            c = c_sample;
        }
    }
    return c;
}

//@ chunk hbil_bent
// Cosine-weighted bent vector of a slice with horizons cf, cb: x along D, y along V.
#if HBIL_OUTPUTS_BENT
vec2 hbil_bent(float nx, float ny, float cf, float cb) {
    float sf2 = max(1.0 - cf * cf, 0.0);
    float sb2 = max(1.0 - cb * cb, 0.0);
    float s3 = sf2 * sqrt(sf2) - sb2 * sqrt(sb2);
    float c3 = cf * cf * cf + cb * cb * cb;
    return vec2(nx * (c3 - 3.0 * (cf + cb) + 4.0) + ny * s3, nx * s3 + ny * (2.0 - c3)) / 3.0;
}
#endif

//@ chunk hbil_lighting
// Sums over the slices: the light that reaches the pixel from an open sky, the part that is blocked, the light that
// comes from the blockers instead, the bent vector.
struct hbil_lighting {
    float full;
    float blocked;
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
    vec3 near;
#endif
#if HBIL_OUTPUTS_BENT
    vec3 bent;
#endif
};

//@ chunk hbil_slice
// Add the slice with tangent D and screen direction d.
void hbil_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_lighting sum) {
    float nx = dot(r.n, slice);
    float q = inversesqrt(nx * nx + r.ny * r.ny);
    float cb0 = clamp(nx * q, -1.0, 1.0); // back horizon of the tangent plane; the front one is its negative
    float g0 = hbil_arc(-cb0);
    float front_px = hbil_border(r.pixel, d);
    float back_px = hbil_border(r.pixel, -d);
#if !HBIL_REACH_0
    front_px = min(front_px, hbil_reach(r.position, r.v, slice));
    back_px = min(back_px, hbil_reach(r.position, r.v, -slice));
#endif
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
    float cf = hbil_horizon(r, d, front_px, jitter, nx, -cb0, sum.near);
    float cb = hbil_horizon(r, -d, back_px, jitter, -nx, cb0, sum.near);
#else
    float cf = hbil_horizon(r, d, front_px, jitter, nx, -cb0);
    float cb = hbil_horizon(r, -d, back_px, jitter, -nx, cb0);
#endif
    sum.full += nx * (g0 - 0.5 * HBIL_PI) + r.ny * r.ny * r.ny * q * q;
    sum.blocked += 0.5 * (nx * (2.0 * g0 - HBIL_PI - hbil_arc(cf) + hbil_arc(cb))
        + r.ny * (cf * cf + cb * cb - 2.0 * cb0 * cb0));
#if HBIL_OUTPUTS_BENT
    vec2 b = hbil_bent(nx, r.ny, cf, cb);
    sum.bent += b.x * slice + b.y * r.v;
#endif
}

//@ chunk hbil_march
// All slices of a pixel.
hbil_lighting hbil_march(ivec2 p, float z) {
    hbil_lighting sum;
    sum.full = 0.0;
    sum.blocked = 0.0;
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
    sum.near = vec3(0.0);
#endif
#if HBIL_OUTPUTS_BENT
    sum.bent = vec3(0.0);
#endif
    hbil_receiver r = hbil_receive(p, z);
    vec2 noise = hbil_noise(p);
#if !HBIL_SEED_COMPAT_SCREEN_AZIMUTH
    // Slices are uniform in azimuth around V, not on the screen, or walls and floors away from the image centre get the
    // wrong weight. e1, e2: any frame about V (v.z < 0); k1, k2: their directions on the screen, linear in D.
    float a = 1.0 / (1.0 - r.v.z);
    vec3 e1 = vec3(1.0 - r.v.x * r.v.x * a, -r.v.x * r.v.y * a, r.v.x);
    vec3 e2 = vec3(r.v.x * r.v.y * a, r.v.y * r.v.y * a - 1.0, -r.v.y);
    vec2 k1 = (r.v.xy * e1.z - e1.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;
    vec2 k2 = (r.v.xy * e2.z - e2.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;
#endif
    for (int i = 0; i < HBIL_SLICES; ++i) {
        float phi = (float(i) + noise.x) * HBIL_PI / float(HBIL_SLICES);
        vec2 turn = vec2(cos(phi), sin(phi));
#if HBIL_SEED_COMPAT_SCREEN_AZIMUTH
        vec3 slice = normalize(vec3(turn, 0.0) - dot(turn, r.v.xy) * r.v);
        vec2 d = normalize(turn / HBIL_PIXEL_TO_RAY.xy);
#else
        vec3 slice = turn.x * e1 + turn.y * e2;
        vec2 d = normalize(turn.x * k1 + turn.y * k2);
#endif
        hbil_slice(r, slice, d, noise.y, sum);
    }
    return sum;
}

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float ao = 1.0;
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
    vec3 near = vec3(0.0);
#endif
#if HBIL_OUTPUTS_BENT
    vec3 bent = vec3(0.0);
#endif
    float z = hbil_load_depth(p);
    if (z < HBIL_SKY) {
        hbil_lighting sum = hbil_march(p, z);
#if HBIL_SEED_COMPAT_SLICE_MEAN
        float scale = 1.0 / float(HBIL_SLICES);
        ao = (sum.full - sum.blocked) * scale;
#else
        // ratio: what few slices get wrong about an open sky cancels. max: rounding must not make light
        float scale = 1.0 / max(sum.full, sum.blocked);
        ao = 1.0 - max(sum.blocked, 0.0) * scale;
#endif
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
        near = sum.near * scale;
#endif
#if HBIL_OUTPUTS_BENT
        bent = sum.bent * scale * vec3(1.0, 1.0, HBIL_VIEW_Z);
#endif
    }
#if HBIL_OUTPUTS_AO
    imageStore(u_ao, p, vec4(ao));
#endif
#if HBIL_OUTPUTS_NEAR || HBIL_OUTPUTS_COMPOSITE
    imageStore(u_near, p, vec4(near, 1.0));
#endif
#if HBIL_OUTPUTS_BENT
    imageStore(u_bent, p, vec4(bent, 1.0));
#endif
}
