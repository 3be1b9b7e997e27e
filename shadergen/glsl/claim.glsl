// claim: last frame's pixels again. Those of the nearest depth leave their address; of several the lowest, so that
// every run gives the same.

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE)) || HBIL_RESET != 0) return;
    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y)
        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x) {
            float z = hbil_seen_depth(texelFetch(u_last_seen, ivec2(x, y), 0).r);
            if (!(z < 0.5 * HBIL_SKY)) continue; // NaN too
            vec3 landing = hbil_landing(ivec2(x, y), z);
            ivec2 q = ivec2(floor(landing.xy));
            if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) continue;
            if (texelFetch(u_landed, q, 0).r == hbil_depth_key(landing.z))
                imageAtomicMin(u_claimed, q, uint(x) | uint(y) << 16);
        }
}
