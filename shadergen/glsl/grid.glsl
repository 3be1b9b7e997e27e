// grid: the pixels that are marched, one for each block of HBIL_DOWNSCALE x HBIL_DOWNSCALE pixels of the frame.

//@ chunk hbil_frame_size
// Render size. pixels
ivec2 hbil_frame_size() {
#if HBIL_COARSE
    return HBIL_FULL_SIZE;
#else
    return HBIL_SIZE;
#endif
}

//@ chunk hbil_centre
// Where the centre of a pixel of the frame lies on the grid. Pixels of the grid have theirs at .5
vec2 hbil_centre(ivec2 p) {
#if HBIL_COARSE
    return (vec2(p) + 0.5) / float(HBIL_DOWNSCALE);
#else
    return vec2(p) + 0.5;
#endif
}

//@ chunk hbil_middle
// Pixel of the frame in the middle of a block; at the border, the last there is.
ivec2 hbil_middle(ivec2 p) {
#if HBIL_COARSE
    return min(p * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2, HBIL_FULL_SIZE - 1);
#else
    return p;
#endif
}

//@ chunk hbil_quad
#if HBIL_COARSE
// The four pixels of the frame around the middle of a block, i in [0, 3]. Blocks that leave the frame take its last
// ones.
ivec2 hbil_quad(ivec2 p, int i) {
    ivec2 first = max(min(p * HBIL_DOWNSCALE + HBIL_DOWNSCALE / 2 - 1, HBIL_FULL_SIZE - 2), ivec2(0));
    return min(first + ivec2(i & 1, i >> 1), HBIL_FULL_SIZE - 1);
}
#endif

//@ chunk HBIL_SAME_DEPTH
const float HBIL_SAME_DEPTH = 0.1; // of a depth (orthographic: of the screen's height): another surface

//@ chunk hbil_depth_scale
// Length that depths are held against. m
float hbil_depth_scale(float z) {
#if HBIL_PROJECTION_PERSPECTIVE
    return z;
#else
    return abs(HBIL_PIXEL_TO_RAY.y) * float(HBIL_SIZE.y);
#endif
}

//@ chunk hbil_quad_weights
#if HBIL_COARSE
// Which of the four are of the surface that the grid took, at depth z. Adds up to 1.
vec4 hbil_quad_weights(ivec2 p, float z) {
    vec4 w;
    for (int i = 0; i < 4; ++i) {
        float off = abs(texelFetch(u_full_depth, hbil_quad(p, i), 0).r - z);
        w[i] = off < HBIL_SAME_DEPTH * hbil_depth_scale(z) ? 1.0 : 1e-3;
    }
    return w / dot(w, vec4(1.0));
}
#endif

//@ chunk hbil_grid_radiance
// Radiance of a pixel of the grid. w: hbil_quad_weights
#if HBIL_COARSE
vec3 hbil_grid_radiance(ivec2 p, vec4 w) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) sum += w[i] * hbil_load_radiance(hbil_quad(p, i));
    return sum;
}
#endif

//@ chunk hbil_grid_albedo
// The same of albedo.
#if HBIL_COARSE
vec3 hbil_grid_albedo(ivec2 p, vec4 w) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) sum += w[i] * hbil_load_albedo(hbil_quad(p, i));
    return sum;
}
#endif
