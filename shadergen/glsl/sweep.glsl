// sweep: horizons of the whole screen, at a price that does not grow with the reach.
//
// All pixels of a line lie in one plane with the eye, and in (step, nearness) straight lines of that plane stay
// straight. So the horizon of a pixel is where a tangent from it touches the upper hull of the pixels before it. Every
// pixel stores how many steps back its tangent goes, and following these from the pixel before on is that hull: a walk
// needs no stack, and forgets nothing. Timonen 2013 for occlusion; the light is ours.
//
// Light: a tangent jumps over a part of the line, and stores the mean radiance of all that stands up there, each pixel
// by how far it rises as seen at 45 degrees: half from aside, half from the front. A jump is a sum of shorter ones, so
// this costs no more than the hull, and is what the pixel sees on that side, whatever its normal.

//@ chunk HBIL_BACK_LOW
const float HBIL_BACK_LOW = -0.7; // cosine of normal and way to the next pixel up to which a surface turns its back

//@ chunk HBIL_BACK_HIGH
const float HBIL_BACK_HIGH = -0.3; // and from which on it does not: a smooth surface has 0

//@ chunk hbil_lit_step
#if HBIL_GATHER && !HBIL_FACING_NONE
// Part of the light of pixel p that goes on along the line, to the pixel `next`: none if p turns its back there.
float hbil_lit_step(ivec2 p, float nearness, ivec2 next, float next_nearness) {
    vec3 way = hbil_position(vec2(next) + 0.5, hbil_depth_of(next_nearness))
        - hbil_position(vec2(p) + 0.5, hbil_depth_of(nearness));
    float facing = dot(hbil_load_normal(p), way) * inversesqrt(max(dot(way, way), 1e-30));
    return smoothstep(HBIL_BACK_LOW, HBIL_BACK_HIGH, facing);
}
#endif

//@ chunk hbil_jump
// Jump of the pixel `at`, which sees the pixel v before it: over all that stands lower, along the jumps from there on.
// With it goes what stands up below: at.rise, and at.light as a sum.
void hbil_jump(hbil_line l, int start, int way, int layer, hbil_vertex v, inout hbil_vertex at) {
    while (v.back != 0) {
        int outward = v.step - way * v.back;
        ivec2 q = hbil_pixel(l, start, outward);
        float nearness = hbil_nearness(hbil_load_depth(q));
        if (!hbil_steeper(at, v, outward, nearness)) break;
#if HBIL_GATHER
        at.rise += v.rise;
        at.light += v.rise * v.light;
        v.light = hbil_unpack_radiance(imageLoad(u_swept_light, ivec3(q, layer)).r);
#endif
        uint code = imageLoad(u_swept, ivec3(q, layer)).r;
        v.back = hbil_back(code);
#if HBIL_GATHER
        v.rise = hbil_rise_in(code);
#endif
        v.nearness = nearness;
        v.step = outward;
    }
    at.back = abs(at.step - v.step);
}

//@ chunk hbil_walk
// One walk along a line, towards smaller steps if `down`.
void hbil_walk(hbil_line l, int lane, int width, bool down, int layer) {
    int steps = hbil_across(l, HBIL_SIZE).x;
    int way = down ? -1 : 1;
    int start = lane; // place across where the line would begin
    hbil_vertex last; // the last pixel with a surface
    last.step = -1;
#if HBIL_GATHER
    vec3 own = vec3(0.0); // its own radiance
#if !HBIL_FACING_NONE
    ivec2 before = ivec2(0);
#endif
#if HBIL_FACING_FILTER
    vec3 accepted = vec3(0.0); // the last light that was taken
#endif
#endif
    for (int step = down ? steps - 1 : 0; down ? step >= 0 : step < steps; step += way) {
        int place = lane + hbil_shift(l, step);
        int here = lane - int(floor((float(place) + 0.5) / float(width))) * width;
        if (here != start) last.step = -1; // the line has come in again on the other side
        start = here;
        ivec2 p = hbil_pixel(l, start, step);
        if (any(greaterThanEqual(p, HBIL_SIZE))) continue;
        float z = hbil_load_depth(p);
        bool surface = z < HBIL_SKY;
        hbil_vertex at;
        at.nearness = hbil_nearness(z);
        at.step = step;
        at.back = last.step >= 0 ? abs(step - last.step) : 0; // of the sky: to the last surface
#if HBIL_GATHER
        at.rise = 0.0;
        at.light = vec3(0.0);
#endif
        if (surface && last.step >= 0) {
#if HBIL_GATHER
#if HBIL_FACING_HALF_SPACE
            own *= hbil_lit_step(before, last.nearness, p, at.nearness);
#elif HBIL_FACING_FILTER
            accepted = mix(accepted, own, hbil_lit_step(before, last.nearness, p, at.nearness));
            own = accepted;
#endif
            at.rise = hbil_rise(l, at.nearness, last.nearness);
            at.light = at.rise * own;
#endif
            hbil_jump(l, start, way, layer, last, at);
#if HBIL_GATHER
            at.light = at.rise > 0.0 ? at.light / at.rise : own;
#endif
        }
        imageStore(u_swept, ivec3(p, layer), uvec4(hbil_code(at)));
#if HBIL_GATHER
        imageStore(u_swept_light, ivec3(p, layer), uvec4(hbil_pack_radiance(at.light)));
#endif
        if (!surface) continue;
#if HBIL_GATHER
        own = hbil_unpack_radiance(texelFetch(u_view_radiance, p, 0).r);
#if !HBIL_FACING_NONE
        before = p;
#endif
#endif
        last = at;
    }
}

//@ chunk main
void main() {
    int lane = int(gl_GlobalInvocationID.x);
    int layer = int(gl_GlobalInvocationID.y);
    int slice = layer / 2;
    // the lines of a direction side by side: neighbours in a wave do alike
#if HBIL_SWEEP_STRIDE_1
    hbil_line l = hbil_line_of(slice);
    int width = hbil_across(l, HBIL_SIZE).y;
#else
    int lines = (hbil_across(hbil_line_of(slice * HBIL_SWEEP_STRIDE), HBIL_SIZE).y - 1) / HBIL_SWEEP_STRIDE + 1;
    int width = lines * HBIL_SWEEP_STRIDE; // whole strides: a line that comes in again keeps its turn
    hbil_line l = hbil_line_of(slice * HBIL_SWEEP_STRIDE + min(lane / lines, HBIL_SWEEP_STRIDE - 1));
    lane = lane < width ? lane % lines * HBIL_SWEEP_STRIDE + lane / lines : width;
#endif
    if (lane < width) hbil_walk(l, lane, width, layer % 2 == 0, layer);
}
