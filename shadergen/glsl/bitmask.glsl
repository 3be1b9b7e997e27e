// bitmask: each slice is 32 sectors of equal cosine-weighted light; an occluder with two ends fills those between.
//
// Sectors are counted by u in [0, 1], the share of the slice's light between the back end of the hemisphere and a
// direction.

//@ chunk hbil_fan
// A slice as its sectors lie.
struct hbil_fan {
#if HBIL_SPANS || HBIL_FACING_HALF_SPACE
    hbil_side front;
    hbil_side back;
#endif
    float ny;
    float light_front; // of each side, open: above 0, as ny is at least HBIL_LEAST_NY
    float light_back;
    float jitter;      // common to all edges: the expected number of sectors is exact
};

//@ chunk hbil_edge_light
// Light between the view vector and the horizon c of a side.
float hbil_edge_light(float nx, float ny, float c) {
    return 0.5 * (nx * hbil_arc(c) + ny * (1.0 - c) * (1.0 + c));
}

//@ chunk hbil_fan_of
hbil_fan hbil_fan_of(hbil_receiver r, hbil_side front, hbil_side back, float jitter) {
    hbil_fan f;
#if HBIL_SPANS || HBIL_FACING_HALF_SPACE
    f.front = front;
    f.back = back;
#endif
    f.ny = r.ny;
    f.light_front = hbil_edge_light(front.nx, r.ny, front.c0);
    f.light_back = hbil_edge_light(back.nx, r.ny, back.c0);
    f.jitter = jitter;
    return f;
}

//@ chunk hbil_edge
// Sector edge of the horizon c of a side: 0 to 32.
int hbil_edge(hbil_fan f, hbil_side s, bool is_back, float c) {
    if (c <= s.c0) return is_back ? 0 : 32;
    float light = hbil_edge_light(s.nx, f.ny, c);
    float u = (f.light_back + (is_back ? -light : light)) / (f.light_front + f.light_back);
    return clamp(int(32.0 * u + f.jitter), 0, 32);
}

//@ chunk hbil_bits
// Sectors from edge `low` to edge `high`. None: a shift by 32 would be undefined.
uint hbil_bits(int low, int high) {
    int count = high - low;
    return count > 0 ? (0xffffffffu >> uint(32 - count)) << uint(low) : 0u;
}

//@ chunk hbil_lit_bits
#if HBIL_FACING_HALF_SPACE
// Sectors from where the front of a source can be seen: directions w with w . normal < 0.
uint hbil_lit_bits(hbil_receiver r, hbil_fan f, vec3 normal) {
    float x = dot(normal, f.front.tangent);
    float y = dot(normal, r.v);
    // the source's plane meets the slice in a line; of its two ends, the one above the receiver
    float side = y * f.front.nx - x * r.ny < 0.0 ? -1.0 : 1.0;
    vec2 end = side * vec2(y, -x) * inversesqrt(max(x * x + y * y, 1e-20));
    float c = min(end.y, 1.0); // an inverse root may be too large, and no arc is defined beyond 1
    int edge = end.x < 0.0 ? hbil_edge(f, f.back, true, c) : hbil_edge(f, f.front, false, c);
    return side > 0.0 ? hbil_bits(edge, 32) : hbil_bits(0, edge);
}
#endif

//@ chunk hbil_turn
// Direction of a sector's edge: x = -1 back or 1 front, y = its horizon. Newton's method on the root of the light below
// the horizon, which is nearly linear in it: three rounds leave an error of 5e-5.
vec2 hbil_turn(hbil_fan f, int edge) {
    float light = float(edge) / 32.0 * (f.light_front + f.light_back) - f.light_back;
    bool is_back = light < 0.0;
    float nx = is_back ? f.back.nx : f.front.nx;
    float c0 = is_back ? f.back.c0 : f.front.c0;
    float all = is_back ? f.light_back : f.light_front;
    float goal = sqrt(clamp(1.0 - abs(light) / all, 0.0, 1.0));
    float c = min(mix(c0, 1.0, goal), 1.0); // a root of 1 may be above it
    for (int i = 0; i < 3; ++i) {
        float root = sqrt(clamp(1.0 - hbil_edge_light(nx, f.ny, c) / all, 1e-12, 1.0));
        float slope = nx * sqrt((1.0 - c) * (1.0 + c)) + f.ny * c;
        c = clamp(c + 2.0 * (goal - root) * root * all / max(slope, 1e-6), c0, 1.0);
    }
    return vec2(is_back ? -1.0 : 1.0, edge == (is_back ? 0 : 32) ? c0 : c);
}

//@ chunk hbil_span
// What a set of sectors holds, in coordinates of the slice: x along D, y along V.
struct hbil_span {
#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH
    float angle;  // integral of |sin|
#endif
#if HBIL_OUTPUTS_SH
    vec2 moments; // of direction |sin|
#endif
#if HBIL_BENT || HBIL_FAR_BITS
    vec2 bent;    // of direction (n . direction) |sin|
#endif
};

//@ chunk hbil_span_to
// From the view vector to an edge, signed.
hbil_span hbil_span_to(hbil_fan f, vec2 edge) {
    hbil_span to;
    float side = edge.x;
    float c = edge.y;
#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH
    to.angle = side * (1.0 - c);
#endif
#if HBIL_OUTPUTS_SH
    to.moments = 0.5 * vec2(hbil_arc(c), side * (1.0 - c) * (1.0 + c));
#endif
#if HBIL_BENT || HBIL_FAR_BITS
    float s2 = (1.0 - c) * (1.0 + c);
    float s3 = s2 * sqrt(s2);
    to.bent = vec2(side * f.front.nx * (c * c * c - 3.0 * c + 2.0) + f.ny * s3,
        f.front.nx * s3 + side * f.ny * (1.0 - c * c * c)) / 3.0;
#endif
    return to;
}

//@ chunk hbil_lowest_bit
// Number of the lowest bit that is set; one is. GLSL 3.30 has no findLSB.
int hbil_lowest_bit(uint bits) {
#if HBIL_STAGE_FRAGMENT
    return int(floatBitsToUint(float(bits & (~bits + 1u))) >> 23) - 127;
#else
    return findLSB(bits);
#endif
}

//@ chunk hbil_bit_count
// Bits that are set.
int hbil_bit_count(uint bits) {
#if HBIL_STAGE_FRAGMENT
    bits -= (bits >> 1) & 0x55555555u;
    bits = (bits & 0x33333333u) + ((bits >> 2) & 0x33333333u);
    return int((((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24);
#else
    return bitCount(bits);
#endif
}

//@ chunk hbil_span_of
// Sum over the runs of sectors.
hbil_span hbil_span_of(hbil_fan f, uint bits) {
    hbil_span sum;
#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH
    sum.angle = 0.0;
#endif
#if HBIL_OUTPUTS_SH
    sum.moments = vec2(0.0);
#endif
#if HBIL_BENT || HBIL_FAR_BITS
    sum.bent = vec2(0.0);
#endif
    while (bits != 0u) {
        int low = hbil_lowest_bit(bits);
        uint gaps = ~(bits >> uint(low));
        int high = gaps == 0u ? 32 : low + hbil_lowest_bit(gaps);
        hbil_span a = hbil_span_to(f, hbil_turn(f, low));
        hbil_span b = hbil_span_to(f, hbil_turn(f, high));
#if HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH
        sum.angle += b.angle - a.angle;
#endif
#if HBIL_OUTPUTS_SH
        sum.moments += b.moments - a.moments;
#endif
#if HBIL_BENT || HBIL_FAR_BITS
        sum.bent += b.bent - a.bent;
#endif
        bits &= ~hbil_bits(low, high);
    }
    return sum;
}

//@ chunk hbil_add_bits
#if HBIL_GATHER
// Radiance through sectors that nothing nearer has filled.
void hbil_add_bits(hbil_receiver r, hbil_fan f, uint bits, vec3 radiance, inout hbil_sums sum) {
#if HBIL_NEAR_LIGHT
    sum.near += float(hbil_bit_count(bits)) / 32.0 * (f.light_front + f.light_back) * radiance;
#endif
#if HBIL_OUTPUTS_SH
    hbil_span span = hbil_span_of(f, bits);
    sum.sh_0.rgb += span.angle * radiance;
    hbil_add_moments(span.moments.x * f.front.tangent + span.moments.y * r.v, vec4(radiance, 0.0), sum);
#endif
}
#endif

//@ chunk hbil_low_end
// Horizon at which an occluder ends that is seen at `position`.
float hbil_low_end(hbil_receiver r, hbil_side s, vec3 position) {
#if HBIL_OCCLUDER_THICK
    // along the sample's own view ray
#if HBIL_PROJECTION_PERSPECTIVE
    vec3 h = position + HBIL_THICKNESS * normalize(position) - r.position;
#else
    vec3 h = position + vec3(0.0, 0.0, HBIL_THICKNESS) - r.position;
#endif
    return clamp(dot(h, r.v) * inversesqrt(max(dot(h, h), 1e-30)), s.c0, 1.0);
#else
    return s.c0;
#endif
}

//@ chunk hbil_fill
// Fill the sectors that one side's samples hide.
void hbil_fill(hbil_receiver r, hbil_fan f, hbil_side s, bool is_back, inout uint hidden, inout hbil_sums sum) {
#if HBIL_FACING_FILTER
    vec3 accepted = vec3(0.0);
#endif
    hbil_visit at = hbil_start(r);
    for (int i = 0; i < HBIL_STEPS; ++i) {
        if (!hbil_go(r, s, i, at)) break;
        if (at.z >= HBIL_SKY) continue;
        vec3 position = hbil_position(at.pixel, at.z);
        vec3 h = position - r.position;
        float l2 = max(dot(h, h), 1e-30);
        float inv = inversesqrt(l2);
        float high = clamp(dot(h, r.v) * inv, -1.0, 1.0);
        float low = hbil_low_end(r, s, position);
#if HBIL_MARCH_SAMPLED && !HBIL_REACH_0
        high = mix(low, high, hbil_fade(l2 * inv));
#endif
        if (dot(r.n, h) * inv <= HBIL_BIAS) continue;
        int a = hbil_edge(f, s, is_back, low);
        int b = hbil_edge(f, s, is_back, high);
        uint bits = hbil_bits(min(a, b), max(a, b));
#if HBIL_GATHER
        uint fresh = bits & ~hidden;
        if (fresh != 0u) {
#if HBIL_FACING_FILTER
            vec3 radiance = hbil_source(at, h * inv, accepted);
#else
            vec3 radiance = hbil_radiance_at(at);
#endif
#if HBIL_FACING_HALF_SPACE
            fresh &= hbil_lit_bits(r, f, hbil_normal_at(at));
#endif
            hbil_add_bits(r, f, fresh, radiance, sum);
        }
#endif
        hidden |= bits;
    }
}

//@ chunk hbil_fill_swept
#if HBIL_MARCH_BOTH
// Fill what the sweep hides beyond the samples of one side, as a solid.
void hbil_fill_swept(hbil_receiver r, hbil_fan f, hbil_side s, bool is_back, int layer, inout uint hidden,
        inout hbil_sums sum) {
#if HBIL_GATHER
    vec3 radiance;
    float c = hbil_swept(r, s, layer, radiance);
#else
    float c = hbil_swept(r, s, layer);
#endif
    int a = hbil_edge(f, s, is_back, s.c0);
    int b = hbil_edge(f, s, is_back, c);
    uint bits = hbil_bits(min(a, b), max(a, b)) & ~hidden;
#if HBIL_GATHER
    hbil_add_bits(r, f, bits, radiance, sum);
#endif
    hidden |= bits;
}
#endif

//@ chunk hbil_far_arc
#if HBIL_FAR_BITS
// Light of the environment through a group of free sectors. energy: their share of a Lambertian surface's light;
// bent: their cosine-weighted directions in the space of the passes; r: the receiver.
vec3 hbil_far_arc(hbil_receiver r, float energy, vec3 bent) {
    vec3 d = hbil_to_world(hbil_direction(bent / energy, r.n));
#if HBIL_ENVIRONMENT_CUBE
    return energy * hbil_finite(textureLod(u_sky, d, 0.0).rgb);
#elif HBIL_ENVIRONMENT_HOOK
    return energy * hbil_finite(hbil_far_hook(hbil_world_position(r.position), d, 1.0));
#else
    return hbil_sh_sum(r.sh, d, vec3(energy, length(bent), energy));
#endif
}
#endif

//@ chunk hbil_bitmask_slice
// Add the slice with tangent D and screen direction d.
#if HBIL_MARCH_BOTH
void hbil_bitmask_slice(hbil_receiver r, vec3 slice, hbil_line line, int i, vec2 jitter, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, line.d, jitter.x, 1.0);
    hbil_side back = hbil_side_of(r, slice, line.d, jitter.x, -1.0);
    front.line = line;
    back.line = line;
#else
void hbil_bitmask_slice(hbil_receiver r, vec3 slice, vec2 d, vec2 jitter, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, d, jitter.x, 1.0);
    hbil_side back = hbil_side_of(r, slice, d, jitter.x, -1.0);
#endif
    hbil_fan f = hbil_fan_of(r, front, back, jitter.y);
    uint hidden = 0u;
    hbil_fill(r, f, front, false, hidden, sum);
    hbil_fill(r, f, back, true, hidden, sum);
#if HBIL_MARCH_BOTH
    hbil_fill_swept(r, f, front, false, 2 * i, hidden, sum);
    hbil_fill_swept(r, f, back, true, 2 * i + 1, hidden, sum);
#endif
#if HBIL_SUMS || HBIL_FAR_BITS
    float full = f.light_front + f.light_back;
#endif
#if HBIL_SUMS
    sum.full += full;
    sum.blocked += full * float(hbil_bit_count(hidden)) / 32.0;
#endif
#if HBIL_BENT || HBIL_OUTPUTS_UNIFORM_AO || HBIL_OUTPUTS_SH
    hbil_span open = hbil_span_of(f, ~hidden);
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    sum.uniform_open += 0.5 * open.angle;
#endif
#if HBIL_BENT
    sum.bent += open.bent.x * slice + open.bent.y * r.v;
#endif
#if HBIL_OUTPUTS_SH
    sum.sh_0.a += open.angle;
    hbil_add_moments(open.moments.x * slice + open.moments.y * r.v, vec4(0.0, 0.0, 0.0, 1.0), sum);
#endif
#if HBIL_FAR_BITS
    for (int i = 0; i < 32; i += 8) {
        uint bits = ~hidden & (0xffu << uint(i));
        if (bits == 0u) continue;
        vec2 b = hbil_span_of(f, bits).bent;
        sum.far += hbil_far_arc(r, full * float(hbil_bit_count(bits)) / 32.0, b.x * slice + b.y * r.v);
    }
#endif
}
