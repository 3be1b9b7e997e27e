// scatter: last frame's pixels into this frame; of those that fall on one pixel the nearest depth stays.

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    imageStore(u_claimed, p, uvec4(HBIL_NOWHERE));
    if (HBIL_RESET != 0) return;
    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y) // last frame may have been larger
        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x) {
            float z = hbil_seen_depth(texelFetch(u_last_seen, ivec2(x, y), 0).r);
            if (!(z < 0.5 * HBIL_SKY)) continue; // NaN too
            vec3 landing = hbil_landing(ivec2(x, y), z);
            ivec2 q = ivec2(floor(landing.xy));
            if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) continue;
            imageAtomicMin(u_landed, q, hbil_depth_key(landing.z));
        }
}
