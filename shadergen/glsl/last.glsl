// last: where a pixel was in the last frame, and what was seen there.

//@ chunk HBIL_NOWHERE
const uint HBIL_NOWHERE = 0xffffffffu; // no surface of last frame falls here

//@ chunk hbil_pack_seen
// View depth and a number of frames in [0, 63]. Relative error of the depth below 1e-5.
uint hbil_pack_seen(float z, float frames) {
    return (floatBitsToUint(z) & ~63u) | uint(frames + 0.5);
}

//@ chunk hbil_seen_depth
float hbil_seen_depth(uint code) {
    return uintBitsToFloat(code & ~63u);
}

//@ chunk hbil_move
// A point by the rows of a motion.
vec3 hbil_move(vec4 rows[3], vec3 p) {
    return vec3(dot(rows[0].xyz, p), dot(rows[1].xyz, p), dot(rows[2].xyz, p)) + vec3(rows[0].w, rows[1].w, rows[2].w);
}

//@ chunk hbil_last_position
// Point that the last frame saw at a pixel position and view depth, in its own space. m
vec3 hbil_last_position(vec2 pixel, float z) {
    vec2 ray = pixel * HBIL_LAST_TO_RAY.xy + HBIL_LAST_TO_RAY.zw;
#if HBIL_PROJECTION_PERSPECTIVE
    return vec3(ray * z, z);
#else
    return vec3(ray, z);
#endif
}

//@ chunk hbil_pixel_of
// Pixel position at which a camera sees a point in front of it; far away where it does not.
vec2 hbil_pixel_of(vec3 p, vec4 to_ray) {
#if HBIL_PROJECTION_PERSPECTIVE
    if (p.z <= 0.0) return vec2(-1e9);
    return (p.xy / p.z - to_ray.zw) / to_ray.xy;
#else
    return (p.xy - to_ray.zw) / to_ray.xy;
#endif
}

//@ chunk hbil_landing
// Where a surface of last frame falls in this one: xy pixel position, z view depth.
vec3 hbil_landing(ivec2 q, float z) {
    vec3 here = hbil_move(HBIL_VIEW_FROM_LAST, hbil_last_position(vec2(q) + 0.5, z));
    return vec3(hbil_pixel_of(here, HBIL_PIXEL_TO_RAY), here.z);
}

//@ chunk hbil_land
// The pixel of this frame on which a pixel q of last frame falls, and its depth there. False: on none.
bool hbil_land(ivec2 q, out ivec2 p, out float z) {
    float before = hbil_seen_depth(texelFetch(u_last_seen, q, 0).r);
    if (before >= 0.5 * HBIL_SKY) return false;
    vec3 landing = hbil_landing(q, before);
    // before it is made an int: none holds NaN or what is far away
    if (!(all(greaterThanEqual(landing.xy, vec2(0.0))) && all(lessThan(landing.xy, vec2(HBIL_SIZE))))) return false;
    p = ivec2(landing.xy);
    z = landing.z;
    return true;
}

//@ chunk hbil_depth_key
// Order of view depths as whole numbers.
uint hbil_depth_key(float z) {
#if HBIL_PROJECTION_PERSPECTIVE
    return floatBitsToUint(z);
#else
    uint bits = floatBitsToUint(z);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
#endif
}

//@ chunk hbil_key_depth
// And back.
float hbil_key_depth(uint key) {
#if HBIL_PROJECTION_PERSPECTIVE
    return uintBitsToFloat(key);
#else
    return uintBitsToFloat((key & 0x80000000u) != 0u ? key ^ 0x80000000u : ~key);
#endif
}

//@ chunk hbil_claim
#if HBIL_REPROJECT_SCATTER
// The pixel of last frame that fell on p or, in the cracks of a surface that has come nearer, beside it.
uint hbil_claim(ivec2 p) {
    uint claim = texelFetch(u_claimed, p, 0).r;
    for (int i = 0; i < 4 && claim == HBIL_NOWHERE; ++i) {
        ivec2 q = p + ivec2(i == 0 ? -1 : i == 1 ? 1 : 0, i == 2 ? -1 : i == 3 ? 1 : 0);
        if (all(greaterThanEqual(q, ivec2(0))) && all(lessThan(q, HBIL_SIZE))) claim = texelFetch(u_claimed, q, 0).r;
    }
    return claim;
}
#endif

//@ chunk hbil_last_pixel
// Where the surface at p, at `there` in last frame's space if it stands still, was on its grid. Far away: nobody
// knows.
vec2 hbil_last_pixel(ivec2 p, vec3 there) {
#if HBIL_REPROJECT_GATHER
    return vec2(p) + 0.5 + texelFetch(u_motion, hbil_middle(p), 0).rg / float(HBIL_DOWNSCALE);
#elif HBIL_REPROJECT_CAMERA
    return hbil_pixel_of(there, HBIL_LAST_TO_RAY);
#else
    uint claim = hbil_claim(p);
    if (claim == HBIL_NOWHERE) return vec2(-1e9);
    ivec2 q = ivec2(claim & 65535u, claim >> 16);
    vec3 landing = hbil_landing(q, hbil_seen_depth(texelFetch(u_last_seen, q, 0).r));
    return vec2(p) + vec2(q) + 1.0 - landing.xy;
#endif
}

//@ chunk HBIL_LAST_PLANE
const float HBIL_LAST_PLANE = 0.01; // of a depth: farther from the tangent plane is another surface

//@ chunk hbil_taps
// The four pixels of last frame around a place, and what each of them counts: 0 if it saw another surface.
struct hbil_taps {
    ivec2 first;
    vec4 weights; // add up to `all`
    float all;    // [0, 1]
    float frames; // in the running mean there
};

//@ chunk hbil_find
// Last frame's pixels of the surface with normal n at `position`, seen at pixel p.
hbil_taps hbil_find(ivec2 p, vec3 position, vec3 n) {
    hbil_taps t;
    t.first = p;
    t.weights = vec4(0.0);
    t.all = 0.0;
    t.frames = 0.0;
    vec3 there = hbil_move(HBIL_LAST_FROM_VIEW, position);
    vec2 pixel = hbil_last_pixel(p, there);
    // written so that NaN is off the screen, too. A branch on uniforms alone makes lavapipe compile anew in each frame
    bool seen = all(greaterThan(pixel, vec2(-1.0))) && all(lessThan(pixel, vec2(HBIL_LAST_SIZE) + 1.0));
    if (!seen || HBIL_RESET != 0) return t;
    there = hbil_last_position(pixel, there.z); // moving things: at the depth of still ones
    n = hbil_move(HBIL_LAST_FROM_VIEW, position + n) - hbil_move(HBIL_LAST_FROM_VIEW, position);
    float limit = HBIL_LAST_PLANE * hbil_depth_scale(there.z); // below 0 behind the eye: nothing is near
    t.first = ivec2(floor(pixel - 0.5));
    vec2 f = pixel - 0.5 - vec2(t.first);
    vec4 w = vec4(1.0 - f.x, f.x, 1.0 - f.x, f.x) * vec4(vec2(1.0 - f.y), vec2(f.y));
    for (int i = 0; i < 4; ++i) {
        ivec2 q = t.first + ivec2(i & 1, i >> 1);
        if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_LAST_SIZE))) continue;
        uint code = texelFetch(u_last_seen, q, 0).r;
        float z = hbil_seen_depth(code);
        float off = abs(dot(n, hbil_last_position(vec2(q) + 0.5, z) - there));
        if (!(z < 0.5 * HBIL_SKY && off < limit)) continue;
        t.weights[i] = w[i];
        t.all += w[i];
        t.frames += w[i] * float(code & 63u);
    }
    return t;
}

//@ chunk hbil_last_irradiance
// E/pi that pixel q of last frame's grid may reflect.
vec3 hbil_last_irradiance(ivec2 q) {
#if HBIL_STAGE_FRAGMENT && HBIL_COARSE
    q = min(q * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2, HBIL_LAST_FULL_SIZE - 1); // as hbil_middle was
#endif
    return hbil_unpack_radiance(texelFetch(u_last_bounce, q, 0).r);
}

//@ chunk hbil_pushed_at
// Texel q of level 1 or 2 in u_pushed.
ivec2 hbil_pushed_at(ivec2 q, int level) {
    return q + ivec2(level == 2 ? (HBIL_SIZE.x + 1) / 2 : 0, 0);
}

//@ chunk hbil_pushed_far_at
// Texel q of level 4, 5 or 6 in u_pushed_far.
ivec2 hbil_pushed_far_at(ivec2 q, int level) {
    ivec2 size = (HBIL_SIZE + 7) / 8;
    return q + ivec2(level > 4 ? (size.x + 1) / 2 : 0, level > 5 ? (size.y + 3) / 4 : 0);
}

//@ chunk HBIL_PUSHED
const int HBIL_PUSHED = 6; // levels, of 2 to 64 pixels

//@ chunk hbil_has_pushed
// Is there room for them?
bool hbil_has_pushed() {
    return min(HBIL_SIZE.x, HBIL_SIZE.y) >= 16;
}

//@ chunk hbil_push
// One texel from the four below it: mean of those that are about as far as the farthest, since holes open onto what is
// behind.
vec4 hbil_push(vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 z = vec4(a.a, b.a, c.a, d.a);
    vec4 there = vec4(notEqual(z, vec4(0.0)));
    vec4 known = mix(vec4(-1e30), z, greaterThan(there, vec4(0.0)));
    float most = max(max(known.x, known.y), max(known.z, known.w));
    vec4 w = there * vec4(greaterThan(known, vec4(most - HBIL_SAME_DEPTH * hbil_depth_scale(most))));
    return (w.x * a + w.y * b + w.z * c + w.w * d) / max(dot(w, vec4(1.0)), 1.0);
}
