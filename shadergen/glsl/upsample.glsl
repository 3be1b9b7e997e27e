// upsample: from the coarser grid to every pixel. The four pixels of the grid around it count bilinearly, as far as
// they are of its surface.

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_FULL_SIZE))) return;
    float z = texelFetch(u_full_depth, p, 0).r;
    if (z >= HBIL_SKY) {
        hbil_finish_sky(p);
        return;
    }
    vec2 at = hbil_centre(p);
    hbil_surface here = hbil_surface_at(at, z, texelFetch(u_full_normal, p, 0).r);
    ivec2 first = ivec2(floor(at - 0.5));
    vec2 f = at - 0.5 - vec2(first);
    vec4 w = vec4(1.0 - f.x, f.x, 1.0 - f.x, f.x) * vec4(vec2(1.0 - f.y), vec2(f.y));
    float all = 0.0;
    float least = 1e30; // difference in depth, for a pixel that none of the four belongs to
    ivec2 like = ivec2(0);
#if HBIL_ARITHMETIC_HALF
    mediump vec4 s[HBIL_LAYERS];
#else
    vec4 s[HBIL_LAYERS];
#endif
    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 q = clamp(first + ivec2(k & 1, k >> 1), ivec2(0), HBIL_SIZE - 1);
        float share = w[k] * hbil_belongs(here, q, 1.0);
        float off = abs(hbil_load_depth(q) - z);
        if (off < least) {
            least = off;
            like = q;
        }
        if (share <= 0.0) continue;
        all += share;
        hbil_blend(q, share / all, s);
    }
    if (all < 1e-3) {
        if (hbil_load_depth(like) >= HBIL_SKY) {
            hbil_finish_sky(p);
            return;
        }
        hbil_blend(like, 1.0, s);
    }
    hbil_finish(p, s);
}
