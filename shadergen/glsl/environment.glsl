// environment: the light behind the visible part. Spherical harmonics are real, orthonormal, and hold radiance in world
// space.

//@ chunk hbil_to_world
// Direction from the space of the passes to the world.
vec3 hbil_to_world(vec3 direction) {
    return direction * HBIL_WORLD_TO_VIEW; // the transpose of a rotation is its inverse
}

//@ chunk hbil_world_position
vec3 hbil_world_position(vec3 position) {
    return hbil_to_world(position) + HBIL_EYE.xyz;
}

//@ chunk hbil_sh
// Y00, Y1-1, Y10, Y11; Y2-2, Y2-1, Y20, Y21, Y22
struct hbil_sh {
    vec3 low[4];
#if HBIL_SH_ORDER_2
    vec3 high[5];
#endif
};

//@ chunk HBIL_SLABS
#if HBIL_SH_ORDER_2
const int HBIL_SLABS = 9; // coefficients of a probe
#else
const int HBIL_SLABS = 4; // coefficients of a probe
#endif

//@ chunk hbil_load_sh
#if HBIL_ENVIRONMENT_PROBES
// Probes around a position in the world, trilinear; beyond the grid its border goes on.
hbil_sh hbil_load_sh(vec3 position) {
    hbil_sh sh;
    vec3 size = vec3(textureSize(u_probes, 0));
    float slab = size.z / float(HBIL_SLABS);
    vec3 cell = (position - HBIL_PROBE_ORIGIN.xyz) * HBIL_PROBE_SCALE.xyz;
    cell = clamp(cell, vec3(0.0), vec3(size.xy, slab) - 1.0) + 0.5; // half a texel from the next slab: none bleeds over
    for (int k = 0; k < 4; ++k)
        sh.low[k] = textureLod(u_probes, (cell + vec3(0.0, 0.0, float(k) * slab)) / size, 0.0).rgb;
#if HBIL_SH_ORDER_2
    for (int k = 0; k < 5; ++k)
        sh.high[k] = textureLod(u_probes, (cell + vec3(0.0, 0.0, float(k + 4) * slab)) / size, 0.0).rgb;
#endif
    return sh;
}
#else
hbil_sh hbil_load_sh() {
    hbil_sh sh;
    for (int k = 0; k < 4; ++k) sh.low[k] = HBIL_FAR_SH1[k].rgb;
#if HBIL_SH_ORDER_2
    for (int k = 0; k < 5; ++k) sh.high[k] = HBIL_FAR_SH2[k].rgb;
#endif
    return sh;
}
#endif

//@ chunk hbil_sh_sum
// Each band at the unit direction d, times a factor: (1, 1, 1) is radiance, (1, 2/3, 1/4) E/pi of an open surface.
vec3 hbil_sh_sum(hbil_sh sh, vec3 d, vec3 bands) {
    vec3 sum = 0.282095 * bands.x * sh.low[0];
    sum += 0.488603 * bands.y * (d.y * sh.low[1] + d.z * sh.low[2] + d.x * sh.low[3]);
#if HBIL_SH_ORDER_2
    sum += bands.z * (1.092548 * (d.x * d.y * sh.high[0] + d.y * d.z * sh.high[1] + d.z * d.x * sh.high[3])
        + 0.315392 * (3.0 * d.z * d.z - 1.0) * sh.high[2] + 0.546274 * (d.x * d.x - d.y * d.y) * sh.high[4]);
#endif
    return sum;
}

//@ chunk hbil_cone_bands
// E/pi of a surface that faces the axis of a cone and sees nothing else. t: cosine of its half angle. Mayaux 2018
vec3 hbil_cone_bands(float t) {
    float s2 = 1.0 - t * t;
    return vec3(s2, (1.0 - t * t * t) * 2.0 / 3.0, 0.25 * s2 * (1.0 + 3.0 * t * t));
}

//@ chunk hbil_cone_cosine
// Cosine of the half angle of the cone about its normal that has this cosine-weighted visibility.
float hbil_cone_cosine(float ao) {
#if HBIL_SEED_COMPAT_CONE_RELATION
    return 1.0 - ao; // the relation of uniform visibility
#else
    return sqrt(1.0 - ao);
#endif
}

//@ chunk hbil_fit
// Share of the environment for a visibility.
float hbil_fit(float ao) {
#if HBIL_FITTED
    return ao * (1.0 + 0.5 * exp2(0.75 * log2(max(1.0 - ao, 1e-6)))); // a fit meant for uniform visibility
#else
    return ao;
#endif
}

//@ chunk hbil_opening
#if HBIL_FAR_HERE
// The visible part of a pixel's hemisphere, as far light asks for it. World space.
struct hbil_opening {
    float ao;
#if !HBIL_ENVIRONMENT_CONSTANT
    vec3 axis;     // unit: into its middle, or the normal
#endif
#if HBIL_FAR_SH && HBIL_FAR_VISIBILITY_BENT
    float bent;    // length of the bent vector
#endif
#if HBIL_ENVIRONMENT_PROBES || HBIL_ENVIRONMENT_HOOK
    vec3 position; // of the surface. m
#endif
};
#endif

//@ chunk hbil_far
#if HBIL_FAR_HERE
// Far irradiance E/pi through an opening.
vec3 hbil_far(hbil_opening o) {
#if HBIL_ENVIRONMENT_CONSTANT
    return hbil_fit(o.ao) * hbil_finite(HBIL_FAR_COLOR.rgb);
#elif HBIL_ENVIRONMENT_CUBE
    return hbil_fit(o.ao) * hbil_finite(textureLod(u_sky, o.axis, 0.0).rgb);
#elif HBIL_ENVIRONMENT_HOOK
    return hbil_fit(o.ao) * hbil_finite(hbil_far_hook(o.position, o.axis, hbil_cone_cosine(o.ao)));
#else
#if HBIL_ENVIRONMENT_PROBES
    hbil_sh sh = hbil_load_sh(o.position);
#else
    hbil_sh sh = hbil_load_sh();
#endif
#if HBIL_FAR_VISIBILITY_CONE
    return hbil_finite(hbil_sh_sum(sh, o.axis, hbil_cone_bands(hbil_cone_cosine(o.ao))));
#elif HBIL_FAR_VISIBILITY_BENT
    // exact in bands 0 and 1, whatever is visible; band 2 as through the cone
    vec3 bands = vec3(o.ao, o.bent, hbil_cone_bands(hbil_cone_cosine(o.ao)).z);
    return hbil_finite(hbil_sh_sum(sh, o.axis, bands));
#else
    return hbil_fit(o.ao) * hbil_finite(hbil_sh_sum(sh, o.axis, vec3(1.0, 2.0 / 3.0, 0.25)));
#endif
#endif
}
#endif
