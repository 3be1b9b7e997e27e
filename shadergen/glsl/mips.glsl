// mips: three coarser levels of depth, and of radiance, at once: a group reduces its 8 x 8 pixels to 4 x 4, 2 x 2 and
// 1.

//@ chunk hbil_tile
#if HBIL_STAGE_COMPUTE
shared float hbil_tile[64]; // nearness of the group's texels, -1e30: sky or off the screen
#else
float hbil_tile[64]; // nearness of the texels under this one, rows of 8, -1e30: sky or off the screen
#endif

//@ chunk hbil_tile_light
#if HBIL_GATHER && HBIL_STAGE_COMPUTE
shared vec3 hbil_tile_light[64];
#elif HBIL_GATHER
vec3 hbil_tile_light[64];
#endif

//@ chunk HBIL_SAME_SURFACE
const float HBIL_SAME_SURFACE = 0.95; // of the nearest texel's nearness (its inverse for an orthographic camera)

//@ chunk hbil_weights
// How much each of four texels counts.
vec4 hbil_weights(vec4 nearness) {
    vec4 there = vec4(greaterThan(nearness, vec4(-1e29)));
#if HBIL_MIPS_MEAN || HBIL_MIPS_SPREAD
    return there;
#else
    float top = max(max(nearness.x, nearness.y), max(nearness.z, nearness.w));
#if HBIL_MIPS_NEAREST
    return there * vec4(equal(nearness, vec4(top)));
#elif HBIL_PROJECTION_PERSPECTIVE
    return there * vec4(greaterThanEqual(nearness, vec4(top * HBIL_SAME_SURFACE)));
#else
    return there * vec4(greaterThanEqual(nearness, vec4(top - abs(top) * (1.0 - HBIL_SAME_SURFACE))));
#endif
#endif
}

//@ chunk hbil_load_tile
// Pixel p into the tile.
void hbil_load_tile(ivec2 p, int i) {
    bool inside = all(lessThan(p, HBIL_SIZE));
    float z = inside ? hbil_load_depth(p) : HBIL_SKY;
    hbil_tile[i] = z < HBIL_SKY ? hbil_nearness(z) : -1e30;
#if HBIL_GATHER
    hbil_tile_light[i] = hbil_unpack_radiance(inside ? texelFetch(u_view_radiance, p, 0).r : 0u);
#endif
}

//@ chunk hbil_reduce
// One texel of a level from four of the level below, i: the first of them in the tile, stride: to its neighbours.
void hbil_reduce(int i, int stride) {
    vec4 n = vec4(hbil_tile[i], hbil_tile[i + stride], hbil_tile[i + 8 * stride], hbil_tile[i + 9 * stride]);
    vec4 w = hbil_weights(n);
    float all = dot(w, vec4(1.0));
    float inv = 1.0 / max(all, 1.0);
    vec4 known = mix(vec4(0.0), n, greaterThan(w, vec4(0.0)));
    float mean = dot(w, known) * inv;
#if HBIL_MIPS_SPREAD
    vec4 off = known - mean;
    mean += sqrt(dot(w, off * off) * inv);
#endif
    hbil_tile[i] = all > 0.0 ? mean : -1e30;
#if HBIL_GATHER
    vec3 light = w.x * hbil_tile_light[i] + w.y * hbil_tile_light[i + stride]
        + w.z * hbil_tile_light[i + 8 * stride] + w.w * hbil_tile_light[i + 9 * stride];
    hbil_tile_light[i] = light * inv;
#endif
}

//@ chunk hbil_store_level
// What the tile holds at i, to texel q of a level.
void hbil_store_level(ivec2 q, int level, int i) {
    vec4 z = vec4(hbil_tile[i] > -1e29 ? hbil_depth_of(hbil_tile[i]) : HBIL_SKY);
#if HBIL_STAGE_COMPUTE
    imageStore(u_depth_mips, hbil_level_at(q, level), z);
#else
    u_depth_mips[1] = z;
#endif
#if HBIL_GATHER && HBIL_STAGE_COMPUTE
    imageStore(u_radiance_mips, hbil_level_at(q, level), uvec4(hbil_pack_radiance(hbil_tile_light[i])));
#elif HBIL_GATHER
    u_radiance_mips[1] = uvec4(hbil_pack_radiance(hbil_tile_light[i]));
#endif
}

//@ chunk main
#if HBIL_STAGE_COMPUTE
void main() {
    ivec2 p = hbil_texel();
    ivec2 at = ivec2(gl_LocalInvocationID.xy);
    int i = at.y * 8 + at.x;
    hbil_load_tile(p, i);
    if (all(lessThan(p, HBIL_SIZE))) {
        imageStore(u_depth_mips, ivec3(p, 0), vec4(hbil_load_depth(p)));
#if HBIL_GATHER
        imageStore(u_radiance_mips, ivec3(p, 0), uvec4(texelFetch(u_view_radiance, p, 0).r));
#endif
    }
    for (int level = 1; level <= HBIL_LEVELS; ++level) {
        int stride = 1 << level;
        ivec2 q = p >> level;
        barrier();
        if (at.x % stride != 0 || at.y % stride != 0) continue;
        hbil_reduce(i, stride / 2);
        if (all(lessThan(q << level, HBIL_SIZE)) && hbil_levels() > 0) hbil_store_level(q, level, i);
    }
}
#else
// Each pixel is layer 0 and, in layer 1, a texel of the level that lies there: it reduces the pixels under that.
void main() {
    ivec2 p = hbil_texel();
    u_depth_mips[0] = vec4(hbil_load_depth(p));
#if HBIL_GATHER
    u_radiance_mips[0] = uvec4(texelFetch(u_view_radiance, p, 0).r);
#endif
    ivec2 corner = hbil_level_at(ivec2(0), 3).xy;
    int level = p.x < corner.x ? 1 : p.y < corner.y ? 2 : 3;
    ivec2 q = p - hbil_level_at(ivec2(0), level).xy;
    int side = 1 << level;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) hbil_load_tile(side * q + ivec2(x, y), 8 * y + x);
    for (int stride = 2; stride <= side; stride *= 2)
        for (int y = 0; y < side; y += stride)
            for (int x = 0; x < side; x += stride) hbil_reduce(8 * y + x, stride / 2);
    hbil_store_level(q, level, 0);
}
#endif
