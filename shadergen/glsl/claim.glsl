// claim: last frame's pixels again. Those of the nearest depth leave their address; of several the lowest, so that
// every run gives the same.

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_SIZE)) || HBIL_RESET != 0) return;
    ivec2 to;
    float z;
    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y)
        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x)
            if (hbil_land(ivec2(x, y), to, z) && texelFetch(u_landed, to, 0).r == hbil_depth_key(z))
                imageAtomicMin(u_claimed, to, uint(x) | uint(y) << 16);
}
