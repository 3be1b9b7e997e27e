// lines: the directions of a sweep. Each has its own parallel lines of pixels, one pixel per column (or row), that
// cover the screen; a line that leaves the screen comes in again on the other side, so that all lines are equally
// long.

//@ chunk hbil_frame_turn
// Part of the angle between two directions by which all of them are turned. One value for the whole frame: [0, 1)
float hbil_frame_turn() {
#if HBIL_NOISE_NONE
    return 0.5;
#else
    return float((2654435769u * HBIL_FRAME_INDEX + 2147483648u) >> 8) / 16777216.0;
#endif
}

//@ chunk hbil_line
// Lines of a direction.
struct hbil_line {
    vec2 d;       // along them, to larger columns or rows: unit, pixels
    bool is_row;  // steps go along x, by one pixel each; else along y
    int  slope;   // of a line, per step and in strides of HBIL_SWEEP_STRIDE pixels, with 16 fractional bits
};

//@ chunk hbil_line_of
// Direction of HBIL_SLICES * HBIL_SWEEP_STRIDE, from 45 degrees on one side of x to 45 degrees on the other side of y.
hbil_line hbil_line_of(int direction) {
    hbil_line l;
    float turn = (float(direction) + hbil_frame_turn()) / float(HBIL_SLICES * HBIL_SWEEP_STRIDE);
    float phi = (turn - 0.25) * HBIL_PI;
    l.d = vec2(cos(phi), sin(phi));
    l.is_row = turn < 0.5;
    float slope = l.is_row ? l.d.y / l.d.x : l.d.x / l.d.y;
    l.slope = int(roundEven(slope * (65536.0 / float(HBIL_SWEEP_STRIDE))));
    return l;
}

//@ chunk hbil_shift
// Pixels sideways from where a line begins to its pixel at a step. Whole strides: a line keeps its turn.
int hbil_shift(hbil_line l, int step) {
    return HBIL_SWEEP_STRIDE * ((l.slope * step + 32768) >> 16);
}

//@ chunk hbil_across
// (column, row) to (step, place across), and back.
ivec2 hbil_across(hbil_line l, ivec2 p) {
    return l.is_row ? p : p.yx;
}

//@ chunk hbil_pixel
// Pixel at a step of the line that begins at `start` across.
ivec2 hbil_pixel(hbil_line l, int start, int step) {
    return hbil_across(l, ivec2(step, start + hbil_shift(l, step)));
}

//@ chunk hbil_vertex
// Pixel of a line, and the jump from it to the pixel that makes its horizon.
struct hbil_vertex {
    float nearness;
    int   step;
    int   back;  // steps of the jump, 0: there is none
#if HBIL_GATHER
    float rise;  // of all that stands up below it
    vec3  light; // mean radiance of that
#endif
};

//@ chunk hbil_code
// Low half: steps. High half: rise, as the upper half of a float.
uint hbil_code(hbil_vertex v) {
#if HBIL_GATHER
    return uint(v.back) | ((floatBitsToUint(v.rise) + 0x8000u) & 0xffff0000u);
#else
    return uint(v.back);
#endif
}

//@ chunk hbil_back
int hbil_back(uint code) {
#if HBIL_GATHER
    return int(code & 0xffffu);
#else
    return int(code);
#endif
}

//@ chunk hbil_rise_in
float hbil_rise_in(uint code) {
    return uintBitsToFloat(code & 0xffff0000u);
}

//@ chunk hbil_steeper
// Does the pixel `outward` stand higher over `at` than v, which is nearer to it?
bool hbil_steeper(hbil_vertex at, hbil_vertex v, int outward, float nearness) {
    return (nearness - at.nearness) * float(abs(at.step - v.step))
        > (v.nearness - at.nearness) * float(abs(at.step - outward));
}

//@ chunk hbil_rise
#if HBIL_GATHER
// Rise of the line from a pixel to the one before, both by their nearness.
float hbil_rise(hbil_line l, float from, float before) {
    // of a surface that is seen at 45 degrees, at depth 1
    float pitch = length(HBIL_PIXEL_TO_RAY.xy * l.d) / max(abs(l.d.x), abs(l.d.y));
#if HBIL_PROJECTION_PERSPECTIVE
    pitch *= from;
#endif
    return max(before - from + pitch, 0.0);
}
#endif

//@ chunk hbil_pack_radiance
// 3 x 9 bits with a common exponent: relative error of the largest channel below 0.002. r in [0, 60000]
uint hbil_pack_radiance(vec3 r) {
    float top = max(max(r.r, r.g), r.b) * 1.001; // so that no channel rounds up to 512
    uint e = uint(clamp(int(floatBitsToUint(top) >> 23) - 111, 0, 31));
    uvec3 m = uvec3(r * uintBitsToFloat((151u - e) << 23) + 0.5);
    return m.r | (m.g << 9) | (m.b << 18) | (e << 27);
}

//@ chunk hbil_unpack_radiance
vec3 hbil_unpack_radiance(uint code) {
    uvec3 m = (uvec3(code) >> uvec3(0u, 9u, 18u)) & 511u;
    return vec3(m) * uintBitsToFloat(((code >> 27) + 103u) << 23);
}
