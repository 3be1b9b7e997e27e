// filter: one mean over the neighbours that lie on the same surface. See hbil_filter in signal.glsl.

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
    if (z >= HBIL_SKY) {
#if HBIL_FILTER_PASSES_1 && !HBIL_COARSE
        hbil_finish_sky(p);
#endif
        return;
    }
#if HBIL_ARITHMETIC_HALF
    mediump vec4 s[HBIL_LAYERS];
#else
    vec4 s[HBIL_LAYERS];
#endif
    hbil_filter(p, z, 1, s);
#if HBIL_FILTER_PASSES_1 && !HBIL_COARSE
    hbil_finish(p, s);
#else
    hbil_pass_on(p, s);
#endif
}
