// filter_3: the filter again, over every fourth pixel.

//@ chunk main
void main() {
    ivec2 p = hbil_texel();
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
#if HBIL_ARITHMETIC_HALF
    mediump vec4 s[HBIL_LAYERS];
#else
    vec4 s[HBIL_LAYERS];
#endif
    bool surface = hbil_filter(p, 4, s);
#if !HBIL_COARSE
    if (surface) hbil_finish(p, s);
    else hbil_finish_sky(p);
#else
    if (surface) hbil_pass_on(p, s);
#endif
}
