// push_2: the same from 8 pixels on: levels of 16, 32 and 64. A thread reduces 64 x 64 pixels.

//@ chunk hbil_pushed
// What push made of 8 x 8 pixels.
vec4 hbil_pushed(ivec2 q) {
    return any(greaterThanEqual(8 * q, HBIL_SIZE)) ? vec4(0.0) : texelFetch(u_pushed_8, q, 0);
}

//@ chunk hbil_push_far
// Texel q of level 4 to 6 from the four below it.
vec4 hbil_push_far(ivec2 q, int level, vec4 a, vec4 b, vec4 c, vec4 d) {
    vec4 mean = hbil_push(a, b, c, d);
    if (all(lessThan(q << level, HBIL_SIZE))) imageStore(u_pushed_far, hbil_pushed_far_at(q, level), mean);
    return mean;
}

//@ chunk hbil_push_pair
// Level 5 from 4 x 4 texels of level 3.
vec4 hbil_push_pair(ivec2 q) {
    vec4 m[4];
    for (int i = 0; i < 4; ++i) {
        ivec2 r = 2 * q + ivec2(i & 1, i >> 1);
        m[i] = hbil_push_far(r, 4, hbil_pushed(2 * r), hbil_pushed(2 * r + ivec2(1, 0)),
            hbil_pushed(2 * r + ivec2(0, 1)), hbil_pushed(2 * r + 1));
    }
    return hbil_push_far(q, 5, m[0], m[1], m[2], m[3]);
}

//@ chunk main
void main() {
    ivec2 q = hbil_texel();
    if (!hbil_has_pushed()) return;
    hbil_push_far(q, 6, hbil_push_pair(2 * q), hbil_push_pair(2 * q + ivec2(1, 0)),
        hbil_push_pair(2 * q + ivec2(0, 1)), hbil_push_pair(2 * q + 1));
}
