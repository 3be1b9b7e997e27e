// reproject: the radiance that the march reads, with what each surface reflects of the light that it got last frame.
// The albedo is this frame's, so that only smooth irradiance moves.

//@ chunk HBIL_GAIN_MAX
const float HBIL_GAIN_MAX = 0.95; // of a bounce: albedo * near_intensity. Below 1, so that light dies out

//@ chunk hbil_pull
#if HBIL_REPROJECT_SCATTER
// Light for a hole: of the finest level that knows of a surface at about this depth.
vec3 hbil_pull(ivec2 p, float z) {
    for (int level = 1; level <= HBIL_PUSHED && hbil_has_pushed(); ++level) {
        vec2 at = (vec2(p) + 0.5) / float(1 << level) - 0.5;
        ivec2 first = ivec2(floor(at));
        vec2 f = at - vec2(first);
        ivec2 size = (HBIL_SIZE + (1 << level) - 1) >> level;
        vec4 sum = vec4(0.0);
        for (int i = 0; i < 4; ++i) {
            ivec2 o = ivec2(i & 1, i >> 1);
            ivec2 q = clamp(first + o, ivec2(0), size - 1);
            vec4 t = level < 3 ? texelFetch(u_pushed, hbil_pushed_at(q, level), 0)
                : level < 4 ? texelFetch(u_pushed_8, q, 0) : texelFetch(u_pushed_far, hbil_pushed_far_at(q, level), 0);
            if (t.a == 0.0 || abs(t.a - z) > HBIL_SAME_DEPTH * hbil_depth_scale(z)) continue;
            vec2 w = mix(1.0 - f, f, vec2(o));
            sum += w.x * w.y * vec4(t.rgb, 1.0); // at is never whole: no weight is 0
        }
        if (sum.a > 0.0) return sum.rgb / sum.a;
    }
    return vec3(0.0);
}
#endif

//@ chunk hbil_last_light
// Irradiance that the surface had in the last frame.
vec3 hbil_last_light(ivec2 p, float z) {
    hbil_taps t = hbil_find(p, hbil_position(vec2(p) + 0.5, z), hbil_load_normal(p));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        if (t.weights[i] <= 0.0) continue;
        sum += t.weights[i] * hbil_last_irradiance(t.first + ivec2(i & 1, i >> 1));
    }
    if (t.all > 0.0) return sum / t.all;
#if HBIL_REPROJECT_SCATTER
    return hbil_pull(p, z); // after a reset nothing was pushed
#else
    return vec3(0.0);
#endif
}

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
    vec3 radiance = vec3(0.0);
    if (z < HBIL_SKY) {
#if HBIL_COARSE
        vec4 w = hbil_quad_weights(p, z);
        radiance = hbil_grid_radiance(p, w);
        vec3 albedo = hbil_grid_albedo(p, w);
#else
        radiance = hbil_load_radiance(p);
        vec3 albedo = hbil_load_albedo(p);
#endif
        vec3 gain = min(albedo, vec3(HBIL_GAIN_MAX / HBIL_NEAR_INTENSITY));
        radiance = hbil_finite(radiance + gain * hbil_last_light(p, z));
    }
    imageStore(u_view_radiance, p, uvec4(hbil_pack_radiance(radiance)));
#if !HBIL_TEMPORAL_YES
    imageStore(u_seen, p, uvec4(hbil_pack_seen(z, 0.0)));
#endif
}
