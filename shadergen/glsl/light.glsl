// light: what follows from visibility per pixel; cone, far light, sums, specular occlusion, bounces.

//@ chunk hbil_angle
// acos by sums and products, which are exact everywhere: Vulkan lets acos and atan be wrong by 5e-4. c in [-1, 1]; rad,
// error 5e-7. Abramowitz and Stegun 4.4.46
float hbil_angle(float c) {
    float a = abs(c);
    float p = ((0.0066700901 - 0.0012624911 * a) * a - 0.0170881256) * a + 0.0308918810;
    p = (((p * a - 0.0501743046) * a + 0.0889789874) * a - 0.2145988016) * a + 1.5707963050;
    float angle = sqrt(1.0 - a) * p;
    return c < 0.0 ? HBIL_PI - angle : angle;
}

//@ chunk hbil_caps
// Solid angle that two spherical caps share, neither more than a hemisphere. c1, c2: cosines of their half angles; cd:
// of the angle between their axes, which rounding may take beyond 1.
float hbil_caps(float c1, float c2, float cd) {
    float s1 = sqrt((1.0 - c1) * (1.0 + c1));
    float s2 = sqrt((1.0 - c2) * (1.0 + c2));
    if (cd <= c1 * c2 - s1 * s2) return 0.0;
    if (cd >= min(c1 * c2 + s1 * s2, 1.0)) return 2.0 * HBIL_PI * (1.0 - max(c1, c2));
    // from here on no cap is a point, and their axes are not the same
    float sd = sqrt((1.0 - cd) * (1.0 + cd));
    float lens = HBIL_PI - hbil_angle(clamp((cd - c1 * c2) / (s1 * s2), -1.0, 1.0))
        - c1 * hbil_angle(clamp((c2 - cd * c1) / (sd * s1), -1.0, 1.0))
        - c2 * hbil_angle(clamp((c1 - cd * c2) / (sd * s2), -1.0, 1.0));
    return 2.0 * lens;
}

//@ chunk hbil_specular_occlusion
// Part of the specular lobe that the visible cone leaves: GTSO with the open hemisphere's share of the lobe below it,
// so that an open surface gets 1. Rough lobes are wider than a cone can say: they get ao. r: perceptual roughness.
float hbil_specular_occlusion(vec3 n, vec3 v, float ao, vec3 axis, float r) {
    float lobe = exp2(-3.32193 * max(r, 0.02) * max(r, 0.02));
    vec3 mirror = 2.0 * dot(n, v) * n - v;
    // min: a root of 1 may be above it
    float seen = hbil_caps(min(sqrt(1.0 - ao), 1.0), lobe, dot(axis, mirror));
    float open = hbil_caps(0.0, lobe, dot(n, mirror));
    return mix(clamp(seen / open, 0.0, 1.0), ao, smoothstep(0.5, 0.8, r));
}

//@ chunk hbil_multi_bounce
// Visibility after all bounces between surfaces of this albedo and visibility, per channel.
vec3 hbil_multi_bounce(float ao, vec3 albedo) {
#if HBIL_BOUNCE_CUBIC
    vec3 a = 2.0404 * albedo - 0.3324;
    vec3 b = -4.7951 * albedo + 0.6417;
    vec3 c = 2.7552 * albedo + 0.6903;
    return clamp(((a * ao + b) * ao + c) * ao, vec3(ao), vec3(1.0)); // the fit passes 1 by 1e-4
#else
    return ao / max(1.0 - albedo * (1.0 - ao), vec3(max(ao, 1e-6)));
#endif
}

//@ chunk hbil_far_light
#if HBIL_FAR_HERE
// Far irradiance of a pixel.
vec3 hbil_far_light(ivec2 p, hbil_opening o) {
    vec3 far = HBIL_FAR_INTENSITY * hbil_far(o);
#if !HBIL_F0_NONE
    far *= hbil_diffuse(p);
#endif
    return far;
}
#endif

//@ chunk hbil_store_bounce
#if HBIL_BOUNCES_RECURSIVE
// What the surface may reflect in the next frame, on the grid.
void hbil_store_bounce(ivec2 p, vec3 irradiance) {
    uint code = hbil_pack_radiance(hbil_finite(irradiance));
#if HBIL_STAGE_FRAGMENT
    imageStore(u_bounce, p, uvec4(code)); // of every pixel: a fragment cannot write another one
#else
    ivec2 q = p / HBIL_DOWNSCALE;
    if (p == hbil_middle(q)) imageStore(u_bounce, q, uvec4(code));
#endif
}
#endif

//@ chunk hbil_shade
// Outputs of a pixel with a surface.
void hbil_shade(ivec2 p, float z) {
#if HBIL_LIGHT_AO
    float ao = texelFetch(u_ao, p, 0).r;
#endif
#if HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || (HBIL_FAR_HERE && !HBIL_ENVIRONMENT_CONSTANT)
    vec3 v = hbil_view_vector(hbil_centre(p));
#if HBIL_COARSE
    vec3 n = hbil_turned(hbil_decode_normal(texelFetch(u_full_normal, p, 0).r), v);
#else
    vec3 n = hbil_turned(hbil_load_normal(p), v);
#endif
#endif
#if HBIL_OUTPUTS_CONE || HBIL_OUTPUTS_SPECULAR_OCCLUSION || HBIL_FAR_BENT
    vec3 bent = texelFetch(u_bent, p, 0).xyz * vec3(1.0, 1.0, HBIL_VIEW_Z);
#endif
#if HBIL_OUTPUTS_CONE
    imageStore(u_cone, p, vec4(hbil_direction(bent, n) * vec3(1.0, 1.0, HBIL_VIEW_Z), hbil_cone_cosine(ao)));
#endif
#if HBIL_OUTPUTS_SPECULAR_OCCLUSION
#if HBIL_ROUGHNESS_0
    float roughness = hbil_finite(texelFetch(u_roughness, p, 0).rrr).r;
#else
    float roughness = HBIL_ROUGHNESS;
#endif
    imageStore(u_specular_occlusion, p, vec4(hbil_specular_occlusion(n, v, ao, hbil_direction(bent, n), roughness)));
#endif
#if HBIL_OUTPUTS_MULTI_BOUNCE
    imageStore(u_multi_bounce, p, vec4(hbil_multi_bounce(ao, hbil_load_albedo(p)), 1.0));
#endif
#if HBIL_FAR_HERE
    hbil_opening o;
    o.ao = ao;
#if HBIL_FAR_VISIBILITY_AO && !HBIL_ENVIRONMENT_CONSTANT
    o.axis = hbil_to_world(n);
#elif !HBIL_ENVIRONMENT_CONSTANT
    o.axis = hbil_to_world(hbil_direction(bent, n));
#endif
#if HBIL_FAR_SH && HBIL_FAR_VISIBILITY_BENT
    o.bent = length(bent);
#endif
#if HBIL_ENVIRONMENT_PROBES || HBIL_ENVIRONMENT_HOOK
    o.position = hbil_world_position(hbil_position(hbil_centre(p), z));
#endif
    vec3 irradiance = hbil_far_light(p, o);
#elif HBIL_FAR_BITS && HBIL_SUMMED
    vec3 irradiance = texelFetch(u_far, p, 0).rgb;
#elif HBIL_SUMMED
    vec3 irradiance = vec3(0.0);
#endif
#if HBIL_OUTPUTS_FAR && !HBIL_FAR_BITS
    imageStore(u_far, p, vec4(irradiance, 1.0));
#endif
#if HBIL_NEAR_LIGHT && HBIL_SUMMED
    irradiance += texelFetch(u_near, p, 0).rgb;
#endif
#if HBIL_OUTPUTS_IRRADIANCE
    imageStore(u_irradiance, p, vec4(irradiance, 1.0));
#endif
#if HBIL_BOUNCES_RECURSIVE
    hbil_store_bounce(p, irradiance);
#endif
#if HBIL_OUTPUTS_COMPOSITE
    vec3 direct = hbil_finite(texelFetch(u_direct, p, 0).rgb);
    imageStore(u_composite, p, vec4(direct + hbil_load_albedo(p) * irradiance, 1.0));
#endif
}

//@ chunk hbil_shade_sky
// Outputs of a pixel without a surface.
void hbil_shade_sky(ivec2 p) {
#if HBIL_OUTPUTS_CONE
    imageStore(u_cone, p, vec4(0.0));
#endif
#if HBIL_OUTPUTS_SPECULAR_OCCLUSION
    imageStore(u_specular_occlusion, p, vec4(1.0));
#endif
#if HBIL_OUTPUTS_MULTI_BOUNCE
    imageStore(u_multi_bounce, p, vec4(1.0));
#endif
#if HBIL_OUTPUTS_FAR && !HBIL_FAR_BITS
    imageStore(u_far, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
#if HBIL_OUTPUTS_IRRADIANCE
    imageStore(u_irradiance, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
#if HBIL_BOUNCES_RECURSIVE
    hbil_store_bounce(p, vec3(0.0));
#endif
#if HBIL_OUTPUTS_COMPOSITE
    imageStore(u_composite, p, vec4(hbil_finite(texelFetch(u_direct, p, 0).rgb), 1.0));
#endif
}

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, hbil_frame_size()))) return;
#if HBIL_COARSE
    float z = texelFetch(u_full_depth, p, 0).r;
#else
    float z = hbil_load_depth(p);
#endif
    if (z < HBIL_SKY) hbil_shade(p, z);
    else hbil_shade_sky(p);
}
