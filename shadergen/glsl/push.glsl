// push: last frame's light where it fell, in six ever coarser levels, for the holes between. A thread reduces 8 x 8
// pixels, a group 64 x 64.

//@ chunk hbil_tile
shared vec4 hbil_tile[64]; // level 3 of the group, and what becomes of it

//@ chunk hbil_landed_light
// Irradiance and depth of what fell on a pixel; a = 0: nothing did.
vec4 hbil_landed_light(ivec2 p) {
    if (any(greaterThanEqual(p, HBIL_SIZE))) return vec4(0.0);
    uint claim = texelFetch(u_claimed, p, 0).r;
    if (claim == HBIL_NOWHERE) return vec4(0.0);
    ivec2 q = ivec2(claim & 65535u, claim >> 16);
    vec3 light = hbil_unpack_radiance(texelFetch(u_last_bounce, q, 0).r);
    return vec4(light, hbil_landing(q, hbil_seen_depth(texelFetch(u_last_seen, q, 0).r)).z);
}

//@ chunk hbil_push
// One texel from the four below it: mean of those that are about as far as the farthest, since holes open onto what is
// behind.
vec4 hbil_push(ivec2 q, int level, vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 z = vec4(a.a, b.a, c.a, d.a);
    vec4 there = vec4(notEqual(z, vec4(0.0)));
    vec4 known = mix(vec4(-1e30), z, greaterThan(there, vec4(0.0)));
    float most = max(max(known.x, known.y), max(known.z, known.w));
    vec4 w = there * vec4(greaterThan(known, vec4(most - HBIL_SAME_DEPTH * hbil_depth_scale(most))));
    vec4 mean = (w.x * a + w.y * b + w.z * c + w.w * d) / max(dot(w, vec4(1.0)), 1.0);
    if (all(lessThan(q << level, HBIL_SIZE))) imageStore(u_pushed, hbil_pushed_at(q, level), mean);
    return mean;
}

//@ chunk hbil_push_pair
// Level 2 from 4 x 4 pixels.
vec4 hbil_push_pair(ivec2 q) {
    vec4 m[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 r = 2 * q + ivec2(i & 1, i >> 1);
        m[i] = hbil_push(r, 1, hbil_landed_light(2 * r), hbil_landed_light(2 * r + ivec2(1, 0)),
            hbil_landed_light(2 * r + ivec2(0, 1)), hbil_landed_light(2 * r + 1));
    }
    return hbil_push(q, 2, m[0], m[1], m[2], m[3]);
}

//@ chunk main
void main() {
    ivec2 tile = ivec2(gl_WorkGroupID.xy);
    if (any(greaterThanEqual(64 * tile, HBIL_SIZE)) || !hbil_has_pushed()) return; // whole groups
    ivec2 at = ivec2(gl_LocalInvocationID.xy);
    ivec2 q = 8 * tile + at;
    int i = at.y * 8 + at.x;
    hbil_tile[i] = hbil_push(q, 3, hbil_push_pair(2 * q), hbil_push_pair(2 * q + ivec2(1, 0)),
        hbil_push_pair(2 * q + ivec2(0, 1)), hbil_push_pair(2 * q + 1));
    for (int level = 4; level <= HBIL_PUSHED; ++level) {
        int stride = 1 << (level - 3);
        int half_stride = stride / 2;
        barrier();
        if (at.x % stride == 0 && at.y % stride == 0)
            hbil_tile[i] = hbil_push(q >> (level - 3), level, hbil_tile[i], hbil_tile[i + half_stride],
                hbil_tile[i + 8 * half_stride], hbil_tile[i + 9 * half_stride]);
    }
}
