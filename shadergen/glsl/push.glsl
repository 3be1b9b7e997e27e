// push: last frame's light where it fell, in coarser levels of 2, 4 and 8 pixels, for the holes between. A thread
// reduces 8 x 8 pixels.

//@ chunk hbil_landed_light
// Irradiance and depth of what fell on a pixel; a = 0: nothing did.
vec4 hbil_landed_light(ivec2 p) {
    if (any(greaterThanEqual(p, HBIL_SIZE))) return vec4(0.0);
    uint claim = texelFetch(u_claimed, p, 0).r;
    if (claim == HBIL_NOWHERE) return vec4(0.0);
    vec3 light = hbil_last_irradiance(ivec2(claim & 65535u, claim >> 16));
    return vec4(light, hbil_key_depth(texelFetch(u_landed, p, 0).r));
}

//@ chunk hbil_push_near
// Texel q of level 1 or 2 from the four below it.
vec4 hbil_push_near(ivec2 q, int level, vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 mean = hbil_push(a, b, c, d);
    if (all(lessThan(q << level, HBIL_SIZE))) imageStore(u_pushed, hbil_pushed_at(q, level), mean);
    return mean;
}

//@ chunk hbil_push_pair
// Level 2 from 4 x 4 pixels.
vec4 hbil_push_pair(ivec2 q) {
    vec4 m[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 r = 2 * q + ivec2(i & 1, i >> 1);
        m[i] = hbil_push_near(r, 1, hbil_landed_light(2 * r), hbil_landed_light(2 * r + ivec2(1, 0)),
            hbil_landed_light(2 * r + ivec2(0, 1)), hbil_landed_light(2 * r + 1));
    }
    return hbil_push_near(q, 2, m[0], m[1], m[2], m[3]);
}

//@ chunk main
void main() {
    ivec2 q = hbil_texel();
    if (any(greaterThanEqual(8 * q, HBIL_SIZE)) || !hbil_has_pushed()) return;
    vec4 mean = hbil_push(hbil_push_pair(2 * q), hbil_push_pair(2 * q + ivec2(1, 0)),
        hbil_push_pair(2 * q + ivec2(0, 1)), hbil_push_pair(2 * q + 1));
    imageStore(u_pushed_8, q, mean);
}
