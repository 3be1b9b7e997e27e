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

//@ chunk hbil_hbao
#if HBIL_ESTIMATOR_HBAO
// Occlusion of a side: sin h - sin t, where each rise counts with the weight of the sample that made it. The sine of an
// elevation is the cosine of the angle to V.
float hbil_hbao(hbil_receiver r, hbil_side s) {
    float c = min(s.c0 + HBIL_ANGLE_BIAS, 1.0);
    float hidden = 0.0;
    hbil_visit at = hbil_visit(0.0, vec2(r.pixel) + 0.5, HBIL_SKY);
    for (int i = 0; i < HBIL_STEPS; ++i) {
        if (!hbil_go(r, s, i, at)) break;
        if (at.z >= HBIL_SKY) continue;
        vec3 h = hbil_position(at.pixel, at.z) - r.position;
        float distance = sqrt(max(dot(h, h), 1e-30));
        float rise = clamp(dot(h, r.v) / distance, -1.0, 1.0) - c;
        hidden += max(rise, 0.0) * hbil_attenuation(distance);
        c += max(rise, 0.0);
    }
    return hidden;
}
#endif

//@ chunk hbil_raised
#if HBIL_ESTIMATOR_HBAO_PLUS
// Sum over the samples of a side of how far each is raised above the tangent plane. It knows no horizon.
float hbil_raised(hbil_receiver r, hbil_side s) {
    float raised = 0.0;
    hbil_visit at = hbil_visit(0.0, vec2(r.pixel) + 0.5, HBIL_SKY);
    for (int i = 0; i < HBIL_STEPS; ++i) {
        if (!hbil_go(r, s, i, at)) break;
        if (at.z >= HBIL_SKY) continue;
        vec3 h = hbil_position(at.pixel, at.z) - r.position;
        float distance = sqrt(max(dot(h, h), 1e-30));
        raised += clamp(dot(r.n, h) / distance - HBIL_ANGLE_BIAS, 0.0, 1.0) * hbil_attenuation(distance);
    }
    return raised;
}
#endif

//@ chunk hbil_hbao_slice
// Add the slice with tangent D and screen direction d.
void hbil_hbao_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);
    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);
#if HBIL_ESTIMATOR_HBAO_PLUS
    sum.hidden += HBIL_MULTIPLIER * (hbil_raised(r, front) + hbil_raised(r, back)) / float(HBIL_STEPS);
#else
    sum.hidden += 0.5 * (hbil_hbao(r, front) + hbil_hbao(r, back));
#endif
}
