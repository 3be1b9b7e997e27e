// scatter: last frame's pixels into this frame; of those that fall on one pixel the nearest depth stays.

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    bool inside = all(lessThan(p, HBIL_SIZE));
    if (inside) imageStore(u_claimed, p, uvec4(HBIL_NOWHERE));
    if (!inside || HBIL_RESET != 0) return; // in one condition: see hbil_find
    ivec2 to;
    float z;
    for (int y = p.y; y < HBIL_LAST_SIZE.y; y += HBIL_SIZE.y) // last frame may have been larger
        for (int x = p.x; x < HBIL_LAST_SIZE.x; x += HBIL_SIZE.x)
            if (hbil_land(ivec2(x, y), to, z)) imageAtomicMin(u_landed, to, hbil_depth_key(z));
}
