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
    // Slices are uniform in azimuth around V, not on the screen, or walls and floors away from the image centre
    // get the wrong weight. e1, e2: any frame about V (v.z < 0); k1, k2: their directions on the screen, linear
    // in D.
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

//@ chunk hbil_store_sh
#if HBIL_OUTPUTS_SH
// Integrals of 1 and of the direction to coefficients. scale: of band 1; band 0 needs no ratio, each slice has its
// whole solid angle. Near radiance and visibility together are those of the open hemisphere.
void hbil_store_sh(hbil_sums sum, float scale, inout vec4 s[HBIL_LAYERS]) {
    vec4 factor = vec4(vec3(HBIL_PI * HBIL_NEAR_INTENSITY), HBIL_PI);
    s[HBIL_AT_SH] = 0.282095 * hbil_mean(sum) * factor * sum.sh_0;
    s[HBIL_AT_SH + 1] = 0.488603 * scale * factor * sum.sh_y;
    s[HBIL_AT_SH + 2] = 0.488603 * scale * factor * HBIL_VIEW_Z * sum.sh_z;
    s[HBIL_AT_SH + 3] = 0.488603 * scale * factor * sum.sh_x;
}
#endif

//@ chunk hbil_store
// Sums to a signal.
void hbil_store(hbil_sums sum, out vec4 s[HBIL_LAYERS]) {
    for (int i = 0; i < HBIL_LAYERS; ++i) s[i] = vec4(0.0);
#if HBIL_RATIO && !HBIL_DEFER
    // what few slices get wrong about an open sky cancels. Never 0: n.v is not
    float scale = 1.0 / sum.full;
#elif HBIL_DEFER || (HBIL_SEED_COMPAT_SLICE_MEAN && HBIL_COSINE && (HBIL_VISIBILITY || HBIL_GATHER || HBIL_FAR_BITS))
    float scale = hbil_mean(sum);
#endif
#if HBIL_DEFER
    s[0].a = scale * sum.blocked;
    s[HBIL_AT_BENT].a = scale * sum.full; // rounding may leave it below what is blocked: see hbil_finish
#elif HBIL_VISIBILITY
#if !HBIL_COSINE
    float ao = 1.0 - sum.hidden * hbil_mean(sum);
#elif HBIL_SEED_COMPAT_SLICE_MEAN
    float ao = (sum.full - sum.blocked) * scale;
#else
    float ao = 1.0 - sum.blocked * scale;
#endif
    s[0].a = clamp(ao, 0.0, 1.0);
#endif
#if HBIL_NEAR_LIGHT
    s[0].rgb = scale * HBIL_NEAR_INTENSITY * sum.near;
#endif
#if HBIL_BENT
    // no ratio: from two slices on the vectors of an open surface add up to 2/3 n by themselves
    s[HBIL_AT_BENT].xyz = sum.bent * hbil_mean(sum) * vec3(1.0, 1.0, HBIL_VIEW_Z);
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    s[HBIL_AT_FAR].a = sum.uniform_open * hbil_mean(sum);
#endif
#if HBIL_FAR_BITS
    s[HBIL_AT_FAR].rgb = hbil_finite(scale * sum.far);
#endif
#if HBIL_OUTPUTS_SH
    hbil_store_sh(sum, scale, s);
#endif
}

//@ chunk main
void main() {
#if HBIL_INTERLEAVE_YES && HBIL_STAGE_COMPUTE
    // place by place of the 4 x 4, each a quarter of the screen wide: a wave has one noise
    ivec2 quarter = (HBIL_SIZE + 3) / 4;
    ivec2 g = hbil_texel();
    ivec2 p = g % quarter * 4 + g / quarter;
    if (any(greaterThanEqual(g, 4 * quarter))) return;
#else
    ivec2 p = hbil_texel();
#endif
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
    if (z >= HBIL_SKY) {
#if !HBIL_STAGED
        hbil_finish_sky(p);
#endif
        return;
    }
    vec4 s[HBIL_LAYERS];
#if HBIL_SWEPT
    hbil_store(hbil_march_swept(p, z), s);
#else
    hbil_store(hbil_march(p, z), s);
#endif
#if HBIL_STAGED
    hbil_pass_on(p, s);
#else
    hbil_finish(p, s);
#endif
}
