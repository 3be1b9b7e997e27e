// temporal: running mean of the signal with what the last frames saw of the same surface. Where there was none it
// begins anew.

//@ chunk HBIL_RECTIFY_WIDTH
#if HBIL_RECTIFY_VARIANCE
const float HBIL_RECTIFY_WIDTH = 2.0; // standard deviations that history may be off
#endif

//@ chunk hbil_rectify
#if !HBIL_RECTIFY_NONE
// History that this frame's 3 x 3 pixels could have made.
vec4 hbil_rectify(ivec2 p, int layer, vec4 past) {
#if HBIL_RECTIFY_VARIANCE
    vec4 sum = vec4(0.0);
    vec4 squares = vec4(0.0);
#else
    vec4 low = vec4(1e30);
    vec4 high = vec4(-1e30);
#endif
    float count = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 q = clamp(p + ivec2(x, y), ivec2(0), HBIL_SIZE - 1);
            if (hbil_load_depth(q) >= HBIL_SKY) continue;
            vec4 s = hbil_signal(q, layer);
#if HBIL_RECTIFY_VARIANCE
            sum += s;
            squares += s * s;
#else
            low = min(low, s);
            high = max(high, s);
#endif
            count += 1.0;
        }
#if HBIL_RECTIFY_VARIANCE
    vec4 mean = sum / count;
    vec4 room = HBIL_RECTIFY_WIDTH * sqrt(max(squares / count - mean * mean, vec4(0.0)));
    return clamp(past, mean - room, mean + room);
#else
    return clamp(past, low, high);
#endif
}
#endif

//@ chunk hbil_last_signal
// The same of last frame's running mean.
vec4 hbil_last_signal(ivec2 p, int layer) {
#if HBIL_ONLY_AO
    return texelFetch(u_last_signal, ivec3(p, layer), 0).rrrr;
#else
    return texelFetch(u_last_signal, ivec3(p, layer), 0);
#endif
}

//@ chunk HBIL_SANE
const float HBIL_SANE = 1e7; // history beyond, or that is no number, is thrown away

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
    if (z >= HBIL_SKY) {
        imageStore(u_seen, p, uvec4(hbil_pack_seen(HBIL_SKY, 0.0)));
#if HBIL_FILTER_NONE && !HBIL_COARSE
        hbil_finish_sky(p);
#endif
        return;
    }
    hbil_taps t = hbil_find(p, hbil_position(vec2(p) + 0.5, z), hbil_load_normal(p));
    float frames = t.all > 0.0 ? min(t.frames / t.all + 1.0, float(HBIL_HISTORY)) : 1.0;
    vec4 s[HBIL_LAYERS];
    for (int i = 0; i < HBIL_LAYERS; ++i) {
        s[i] = hbil_signal(p, i);
        if (t.all <= 0.0) continue;
        vec4 past = vec4(0.0);
        for (int k = 0; k < 4; ++k)
            if (t.weights[k] > 0.0)
                past += t.weights[k] * hbil_last_signal(t.first + ivec2(k & 1, k >> 1), i);
        past /= t.all;
        if (!all(lessThan(abs(past), vec4(HBIL_SANE)))) { // NaN too
            frames = 1.0;
            continue;
        }
#if !HBIL_RECTIFY_NONE
        past = hbil_rectify(p, i, past);
#endif
        s[i] = mix(past, s[i], 1.0 / frames);
    }
    imageStore(u_seen, p, uvec4(hbil_pack_seen(z, frames)));
    hbil_pass_on(p, s);
#if HBIL_FILTER_NONE && !HBIL_COARSE
    hbil_finish(p, s);
#endif
}
