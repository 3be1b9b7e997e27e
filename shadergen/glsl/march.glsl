// march: what each slice sees; visibility, near light and bent vector from the same samples.

//@ chunk hbil_nothing
hbil_sums hbil_nothing() {
    hbil_sums sum;
#if HBIL_SWEPT
    sum.weight = 0.0;
#endif
#if !HBIL_COSINE
    sum.hidden = 0.0;
#endif
#if HBIL_SUMS
    sum.full = 0.0;
    sum.blocked = 0.0;
#endif
#if HBIL_NEAR_LIGHT
    sum.near = vec3(0.0);
#endif
#if HBIL_BENT
    sum.bent = vec3(0.0);
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    sum.uniform_open = 0.0;
#endif
#if HBIL_OUTPUTS_SH
    sum.sh_0 = vec4(0.0);
    sum.sh_x = vec4(0.0);
    sum.sh_y = vec4(0.0);
    sum.sh_z = vec4(0.0);
#endif
#if HBIL_FAR_BITS
    sum.far = vec3(0.0);
#endif
    return sum;
}

//@ chunk hbil_add_sums
#if HBIL_SWEPT
// Add a slice that stands for more or less azimuth than another.
void hbil_add_sums(hbil_sums slice, float weight, inout hbil_sums sum) {
    sum.weight += weight;
#if HBIL_SUMS
    sum.full += weight * slice.full;
    sum.blocked += weight * slice.blocked;
#endif
#if HBIL_NEAR_LIGHT
    sum.near += weight * slice.near;
#endif
#if HBIL_BENT
    sum.bent += weight * slice.bent;
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    sum.uniform_open += weight * slice.uniform_open;
#endif
#if HBIL_OUTPUTS_SH
    sum.sh_0 += weight * slice.sh_0;
    sum.sh_x += weight * slice.sh_x;
    sum.sh_y += weight * slice.sh_y;
    sum.sh_z += weight * slice.sh_z;
#endif
#if HBIL_FAR_BITS
    sum.far += weight * slice.far;
#endif
}
#endif

//@ chunk hbil_march_swept
#if HBIL_SWEPT
// All slices of a pixel. The lines of a sweep are uniform on the screen: each counts for the azimuth around V that it
// stands for.
hbil_sums hbil_march_swept(ivec2 p, float z) {
    hbil_sums sum = hbil_nothing();
    hbil_receiver r = hbil_receive(p, z);
#if HBIL_MARCH_BOTH
    vec3 noise = hbil_noise(p);
#endif
    for (int i = 0; i < HBIL_SLICES; ++i) {
#if HBIL_SWEEP_STRIDE_1
        hbil_line line = hbil_line_of(i);
#else
        int turn = (2 * i < HBIL_SLICES ? p.y : p.x) % HBIL_SWEEP_STRIDE;
        hbil_line line = hbil_line_of(i * HBIL_SWEEP_STRIDE + turn);
#endif
        vec3 d = vec3(line.d * HBIL_PIXEL_TO_RAY.xy, 0.0);
        vec3 across = d - dot(d, r.v) * r.v;
        float inv = inversesqrt(dot(across, across));
        hbil_sums one = hbil_nothing();
#if HBIL_MARCH_BOTH
        hbil_bitmask_slice(r, across * inv, line, i, vec2(noise.y, fract(noise.z + float(i) * 0.61803399)), one);
#else
        hbil_horizon_slice(r, across * inv, line, i, one);
#endif
        hbil_add_sums(one, inv * inv, sum);
    }
    return sum;
}
#endif

//@ chunk hbil_march
// All slices of a pixel.
hbil_sums hbil_march(ivec2 p, float z) {
    hbil_sums sum = hbil_nothing();
    hbil_receiver r = hbil_receive(p, z);
    vec3 noise = hbil_noise(p);
#if !HBIL_SEED_COMPAT_SCREEN_AZIMUTH
    // Slices are uniform in azimuth around V, not on the screen, or walls and floors away from the image centre get the
    // wrong weight. e1, e2: any frame about V (v.z < 0); k1, k2: their directions on the screen, linear in D.
    float a = 1.0 / (1.0 - r.v.z);
    vec3 e1 = vec3(1.0 - r.v.x * r.v.x * a, -r.v.x * r.v.y * a, r.v.x);
    vec3 e2 = vec3(r.v.x * r.v.y * a, r.v.y * r.v.y * a - 1.0, -r.v.y);
    vec2 k1 = (r.v.xy * e1.z - e1.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;
    vec2 k2 = (r.v.xy * e2.z - e2.xy * r.v.z) / HBIL_PIXEL_TO_RAY.xy;
#endif
    for (int i = 0; i < HBIL_SLICES; ++i) {
#if HBIL_SEED_COMPAT_NOISE_2PI
        float phi = float(i) * HBIL_PI / float(HBIL_SLICES) + noise.x * 2.0 * HBIL_PI;
#else
        float phi = (float(i) + noise.x) * HBIL_PI / float(HBIL_SLICES);
#endif
        vec2 turn = vec2(cos(phi), sin(phi));
#if HBIL_SEED_COMPAT_SCREEN_AZIMUTH
        vec3 slice = normalize(vec3(turn, 0.0) - dot(turn, r.v.xy) * r.v);
        vec2 d = normalize(turn / HBIL_PIXEL_TO_RAY.xy);
#else
        vec3 slice = turn.x * e1 + turn.y * e2;
        vec2 d = normalize(turn.x * k1 + turn.y * k2);
#endif
#if HBIL_ESTIMATOR_BITMASK
        hbil_bitmask_slice(r, slice, d, vec2(noise.y, fract(noise.z + float(i) * 0.61803399)), sum);
#elif HBIL_ESTIMATOR_HORIZON
        hbil_horizon_slice(r, slice, d, noise.y, sum);
#else
        hbil_hbao_slice(r, slice, d, noise.y, sum);
#endif
    }
    return sum;
}

//@ chunk hbil_mean
// What turns sums over slices into means.
float hbil_mean(hbil_sums sum) {
#if HBIL_SWEPT
    return 1.0 / sum.weight;
#else
    return 1.0 / float(HBIL_SLICES);
#endif
}

//@ chunk hbil_store_ao
#if HBIL_AO
void hbil_store_ao(ivec2 p, float ao) {
#if HBIL_FILTER
    imageStore(u_raw_ao, p, vec4(ao));
#else
    imageStore(u_ao, p, vec4(ao));
#endif
}
#endif

//@ chunk hbil_store_near
#if HBIL_NEAR_LIGHT
void hbil_store_near(ivec2 p, vec3 near) {
#if HBIL_FILTER
    imageStore(u_raw_near, p, vec4(near, 1.0));
#else
    imageStore(u_near, p, vec4(near, 1.0));
#endif
}
#endif

//@ chunk hbil_store_bent
#if HBIL_BENT
void hbil_store_bent(ivec2 p, vec3 bent) {
#if HBIL_FILTER
    imageStore(u_raw_bent, p, vec4(bent, 1.0));
#else
    imageStore(u_bent, p, vec4(bent, 1.0));
#endif
}
#endif

//@ chunk hbil_store_sh
#if HBIL_OUTPUTS_SH
// Integrals of 1 and of the direction to coefficients. scale: of band 1; band 0 needs no ratio, each slice has its
// whole solid angle. Near radiance and visibility together are those of the open hemisphere.
void hbil_store_sh(ivec2 p, hbil_sums sum, float scale) {
    vec4 factor = vec4(vec3(HBIL_PI * HBIL_NEAR_INTENSITY), HBIL_PI);
    imageStore(u_sh, ivec3(p, 0), 0.282095 * hbil_mean(sum) * factor * sum.sh_0);
    imageStore(u_sh, ivec3(p, 1), 0.488603 * scale * factor * sum.sh_y);
    imageStore(u_sh, ivec3(p, 2), 0.488603 * scale * factor * HBIL_VIEW_Z * sum.sh_z);
    imageStore(u_sh, ivec3(p, 3), 0.488603 * scale * factor * sum.sh_x);
}
#endif

//@ chunk hbil_store
// Sums to outputs.
void hbil_store(ivec2 p, hbil_sums sum) {
#if HBIL_RATIO
    // what few slices get wrong about an open sky cancels. max: rounding must not make light
    float scale = 1.0 / max(max(sum.full, sum.blocked), 1e-20);
#elif HBIL_SEED_COMPAT_SLICE_MEAN && HBIL_COSINE && (HBIL_VISIBILITY || HBIL_GATHER || HBIL_FAR_BITS)
    float scale = hbil_mean(sum);
#endif
#if HBIL_VISIBILITY
#if !HBIL_COSINE
    float ao = 1.0 - sum.hidden * hbil_mean(sum);
#elif HBIL_SEED_COMPAT_SLICE_MEAN
    float ao = (sum.full - sum.blocked) * scale;
#else
    float ao = 1.0 - sum.blocked * scale;
#endif
    ao = clamp(ao, 0.0, 1.0);
#if !HBIL_AO_EXPONENT_1
    float lift = exp2((HBIL_AO_EXPONENT - 1.0) * log2(max(ao, 1e-6)));
    ao *= lift;
#endif
#endif
#if HBIL_AO
    hbil_store_ao(p, ao);
#endif
#if HBIL_BENT
    // no ratio: from two slices on the vectors of an open surface add up to 2/3 n by themselves
    vec3 bent = sum.bent * hbil_mean(sum) * vec3(1.0, 1.0, HBIL_VIEW_Z);
#if !HBIL_AO_EXPONENT_1
    bent *= lift;
#endif
    hbil_store_bent(p, bent);
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    imageStore(u_uniform_ao, p, vec4(sum.uniform_open * hbil_mean(sum)));
#endif
#if HBIL_NEAR_LIGHT
    vec3 near = scale * HBIL_NEAR_INTENSITY * sum.near;
#if !HBIL_F0_NONE
    near *= hbil_diffuse(p);
#endif
    hbil_store_near(p, near);
#endif
#if HBIL_OUTPUTS_SH
    hbil_store_sh(p, sum, scale);
#endif
#if HBIL_FAR_BITS
    vec3 far = scale * HBIL_FAR_INTENSITY * hbil_finite(sum.far);
#if !HBIL_F0_NONE
    far *= hbil_diffuse(p);
#endif
    imageStore(u_far, p, vec4(far, 1.0));
#endif
}

//@ chunk hbil_store_sky
// A pixel without a surface.
void hbil_store_sky(ivec2 p) {
#if HBIL_AO
    hbil_store_ao(p, 1.0);
#endif
#if HBIL_BENT
    hbil_store_bent(p, vec3(0.0));
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    imageStore(u_uniform_ao, p, vec4(1.0));
#endif
#if HBIL_NEAR_LIGHT
    hbil_store_near(p, vec3(0.0));
#endif
#if HBIL_OUTPUTS_SH
    for (int i = 0; i < 4; ++i) imageStore(u_sh, ivec3(p, i), vec4(0.0));
#endif
#if HBIL_FAR_BITS
    imageStore(u_far, p, vec4(0.0, 0.0, 0.0, 1.0));
#endif
}

//@ chunk main
void main() {
#if HBIL_INTERLEAVE_YES
    // place by place of the 4 x 4, each a quarter of the screen wide: a wave has one noise
    ivec2 quarter = (HBIL_SIZE + 3) / 4;
    ivec2 g = ivec2(gl_GlobalInvocationID.xy);
    ivec2 p = g % quarter * 4 + g / quarter;
    if (any(greaterThanEqual(g, 4 * quarter))) return;
#else
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
#endif
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
#if HBIL_SWEPT
    if (z < HBIL_SKY) hbil_store(p, hbil_march_swept(p, z));
#else
    if (z < HBIL_SKY) hbil_store(p, hbil_march(p, z));
#endif
    else hbil_store_sky(p);
}
