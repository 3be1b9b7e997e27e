// shrink: one pixel of a coarser grid for each block. Where the four pixels around its middle lie on one plane, that
// plane is taken exactly at the middle, so that planes stay planes. Elsewhere neighbouring blocks take the nearest
// and the farthest surface in turns, so that the upsampling finds both.

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    vec4 z;
    for (int i = 0; i < 4; ++i) z[i] = texelFetch(u_full_depth, hbil_quad(p, i), 0).r;
    bool farthest = ((p.x + p.y) & 1) != 0;
    int taken = 0;
    for (int i = 1; i < 4; ++i)
        if (z[taken] >= HBIL_SKY || (z[i] < HBIL_SKY && (farthest ? z[i] > z[taken] : z[i] < z[taken]))) taken = i;
    uint code = texelFetch(u_full_normal, hbil_quad(p, taken), 0).r;
    float depth = z[taken];
    hbil_surface s = hbil_surface_at(hbil_centre(hbil_quad(p, taken)), depth, code);
    bool flat_here = depth < HBIL_SKY;
    for (int i = 0; i < 4; ++i)
        flat_here = flat_here
            && abs(dot(s.n, hbil_position(hbil_centre(hbil_quad(p, i)), z[i]) - s.position)) < 0.5 * s.pixel;
    if (flat_here) {
        // 0.5 but in blocks that leave the frame
        vec2 t = (vec2(p) + 0.5 - hbil_centre(hbil_quad(p, 0))) * float(HBIL_DOWNSCALE);
        float nearness = mix(mix(hbil_nearness(z.x), hbil_nearness(z.y), t.x),
            mix(hbil_nearness(z.z), hbil_nearness(z.w), t.x), t.y);
        float middle = hbil_depth_of(nearness);
        if (abs(middle - depth) < 0.5 * hbil_depth_scale(depth)) depth = middle; // NaN not
    }
    imageStore(u_view_depth, p, vec4(depth));
    imageStore(u_view_normal, p, uvec4(code));
#if HBIL_GATHER && !HBIL_BOUNCES_RECURSIVE
    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(hbil_grid_radiance(p, hbil_quad_weights(p, depth)))));
#endif
#if HBIL_REPROJECT_SCATTER
    imageStore(u_landed, p, uvec4(HBIL_NOWHERE));
#endif
}
