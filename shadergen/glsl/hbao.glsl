// hbao: visibility in uniform weighting, and the disc-sampled obscurance that is named after it. Ambient occlusion
// only.

//@ chunk hbil_attenuation
// Weight of an occluder at a distance. [0, 1]
float hbil_attenuation(float distance) {
#if HBIL_REACH_0
    return 1.0;
#elif HBIL_ATTENUATION_LINEAR
    return clamp(1.0 - distance / HBIL_REACH, 0.0, 1.0);
#else
    float d = distance / HBIL_REACH;
    return clamp(1.0 - d * d, 0.0, 1.0);
#endif
}

//@ chunk hbil_hidden
// Occlusion of a side. hbao: sin h - sin t, where each rise counts with the weight of the sample that made it; the
// sine of an elevation is the cosine of the angle to V. hbao_plus: sum over the samples of how far each is raised above
// the tangent plane; it knows no horizon.
float hbil_hidden(hbil_receiver r, hbil_side s) {
#if HBIL_ESTIMATOR_HBAO
    float c = s.c0 + HBIL_ANGLE_BIAS;
#endif
    float hidden = 0.0;
    hbil_visit at = hbil_start(r);
    for (int i = 0; i < HBIL_STEPS; ++i) {
        if (!hbil_go(r, s, i, at)) break;
        if (at.z >= HBIL_SKY) continue;
        vec3 h = hbil_position(at.pixel, at.z) - r.position;
        float distance = sqrt(max(dot(h, h), 1e-30));
#if HBIL_ESTIMATOR_HBAO
        float rise = max(dot(h, r.v) / distance - c, 0.0);
        c += rise;
#else
        float rise = clamp(dot(r.n, h) / distance - HBIL_ANGLE_BIAS, 0.0, 1.0);
#endif
        hidden += rise * hbil_attenuation(distance);
    }
    return hidden;
}

//@ chunk hbil_hbao_slice
// Add the slice with tangent D and screen direction d.
void hbil_hbao_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);
    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);
#if HBIL_ESTIMATOR_HBAO_PLUS
    sum.hidden += HBIL_MULTIPLIER * (hbil_hidden(r, front) + hbil_hidden(r, back)) / float(HBIL_STEPS);
#else
    sum.hidden += 0.5 * (hbil_hidden(r, front) + hbil_hidden(r, back));
#endif
}
