// horizon: the highest sample of each side hides all below it. HBAO's horizons with GTAO's cosine weights and HBIL's
// light.

//@ chunk hbil_light
#if HBIL_GATHER
// Light of a side. Its weight is the dot product of (nx, ny) with its moments, so one set of arcs gives both.
struct hbil_light {
#if HBIL_MEAN_LIGHT
    vec3 mean; // radiance of what stands in front, of which a horizon takes its share
#else
#if HBIL_NEAR_LIGHT
    vec3 near;
#if !HBIL_FACING_HALF_SPACE
    float arc; // hbil_arc of the horizon
#endif
#endif
#if HBIL_OUTPUTS_SH
    vec3 sh_0; // integrals of L |sin|, L sin |sin|, L cos |sin| over the angle
    vec3 sh_x;
    vec3 sh_y;
#endif
#endif
#if HBIL_FACING_FILTER
    vec3 accepted;
#endif
};
#endif

//@ chunk hbil_dark
#if HBIL_GATHER
hbil_light hbil_dark(float c0) {
    hbil_light light;
#if HBIL_MEAN_LIGHT
    light.mean = vec3(0.0);
#else
#if HBIL_NEAR_LIGHT
    light.near = vec3(0.0);
#if !HBIL_FACING_HALF_SPACE
    light.arc = hbil_arc(c0);
#endif
#endif
#if HBIL_OUTPUTS_SH
    light.sh_0 = vec3(0.0);
    light.sh_x = vec3(0.0);
    light.sh_y = vec3(0.0);
#endif
#endif
#if HBIL_FACING_FILTER
    light.accepted = vec3(0.0);
#endif
    return light;
}
#endif

//@ chunk hbil_weight
// Share of a Lambertian surface's light that comes from between the horizons c and higher >= c.
float hbil_weight(float nx, float ny, float c, float higher) {
    return max(0.5 * (nx * (hbil_arc(c) - hbil_arc(higher)) + ny * (higher - c) * (higher + c)), 0.0);
}

//@ chunk hbil_lit
#if HBIL_FACING_HALF_SPACE
// The part of the arc between horizons arc.x and arc.y from where the front of a source can be seen: w . normal < 0.
vec2 hbil_lit(hbil_receiver r, hbil_side s, vec3 normal, vec2 arc) {
    float x = dot(normal, s.tangent);
    float y = dot(normal, r.v);
    // min: an inverse root may be too large, and no arc is defined beyond 1
    float edge = min((y < 0.0 ? x : -x) * inversesqrt(max(x * x + y * y, 1e-20)), 1.0);
    if (y < 0.0) arc.x = max(arc.x, edge);
    else arc.y = min(arc.y, edge);
    arc.y = max(arc.x, arc.y);
    return arc;
}
#endif

//@ chunk hbil_add_arc
#if HBIL_GATHER
// Add the light of a sample, seen along the unit vector `along`, through the arc between the horizons c and higher.
void hbil_add_arc(hbil_receiver r, hbil_side s, hbil_visit at, vec3 along, float c, float higher,
        inout hbil_light light) {
#if HBIL_FACING_FILTER
    vec3 radiance = hbil_source(at, along, light.accepted);
#else
    vec3 radiance = hbil_radiance_at(at);
#endif
    vec2 arc = vec2(c, higher);
#if HBIL_FACING_HALF_SPACE
    arc = hbil_lit(r, s, hbil_normal_at(at), arc);
#endif
#if HBIL_OCCLUDER_HEURISTIC
    float before = hbil_weight(s.nx, r.ny, s.c0, c);
    float all = before + hbil_weight(s.nx, r.ny, c, higher);
    light.mean = (light.mean * before + radiance * hbil_weight(s.nx, r.ny, arc.x, arc.y)) / max(all, 1e-20);
#else
#if HBIL_NEAR_LIGHT && HBIL_FACING_HALF_SPACE
    light.near += hbil_weight(s.nx, r.ny, arc.x, arc.y) * radiance;
#elif HBIL_NEAR_LIGHT
    // half an arc of the horizon is known from the rise before
    float next = hbil_arc(higher);
    light.near += max(0.5 * (s.nx * (light.arc - next) + r.ny * (higher - c) * (higher + c)), 0.0) * radiance;
    light.arc = next;
#endif
#if HBIL_OUTPUTS_SH
    light.sh_0 += (arc.y - arc.x) * radiance;
    light.sh_x += 0.5 * (hbil_arc(arc.x) - hbil_arc(arc.y)) * radiance;
    light.sh_y += 0.5 * (arc.y - arc.x) * (arc.y + arc.x) * radiance;
#endif
#endif
}
#endif

//@ chunk hbil_step
#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER
// From the sample before to this one: where on the screen, and the nearness of the surface at both ends.
struct hbil_step {
    vec2 to;
    vec2 way;
    float from_nearness; // -1e30: no surface there
    float to_nearness;
};
#endif

//@ chunk hbil_add_corner
#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER
// Light of one corner of the cell around a sample. It stands in front of the rays from c up to the one that meets the
// surface where that is as near as the corner; the nearest corner (depth z_top) in front of all. Moves c there.
void hbil_add_corner(hbil_receiver r, hbil_side s, hbil_step step, ivec2 q, float z_top, float c_sample, inout float c,
        inout hbil_light light) {
    float z = hbil_load_depth(q);
    float rise = step.to_nearness - step.from_nearness;
    float t = rise > 0.0 ? clamp((hbil_nearness(z) - step.from_nearness) / rise, 0.0, 1.0) : 1.0;
    vec3 h = hbil_position(step.to - (1.0 - t) * step.way, z) - r.position;
    vec3 along = h * inversesqrt(max(dot(h, h), 1e-30));
    float low = c;
    c = z <= z_top ? c_sample : clamp(dot(along, r.v), c, c_sample);
    hbil_visit at;
    at.pixel = vec2(q) + 0.5;
    hbil_add_arc(r, s, at, along, low, c, light);
}
#endif

//@ chunk hbil_add_cell
#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER
// Light through the arc between the horizons c and c_sample: each ray gets that of the nearest of the four corners that
// stand in front of it.
void hbil_add_cell(hbil_receiver r, hbil_side s, hbil_step step, float c, float c_sample, inout hbil_light light) {
    ivec2 q = ivec2(step.to);
    vec2 f = step.to - floor(step.to) - 0.5;
    ivec2 x = ivec2(f.x < 0.0 ? -1 : 1, 0);
    ivec2 y = ivec2(0, f.y < 0.0 ? -1 : 1);
    ivec2 second = abs(f.x) > abs(f.y) ? x : y;
    float z_top = min(min(hbil_load_depth(q), hbil_load_depth(q + x)),
        min(hbil_load_depth(q + y), hbil_load_depth(q + x + y)));
    hbil_add_corner(r, s, step, q, z_top, c_sample, c, light);
    hbil_add_corner(r, s, step, q + second, z_top, c_sample, c, light);
    hbil_add_corner(r, s, step, q + x + y - second, z_top, c_sample, c, light);
    hbil_add_corner(r, s, step, q + x + y, z_top, c_sample, c, light);
}
#endif

//@ chunk HBIL_DECAY_STEPS
const float HBIL_DECAY_STEPS = 8.0; // steps per side for which HBIL_DECAY is meant

//@ chunk hbil_horizon
// Highest horizon on one side of a slice, from that of the tangent plane on. Each rise adds the light of the arc that
// the sample fills.
#if HBIL_GATHER
float hbil_horizon(hbil_receiver r, hbil_side s, inout hbil_light light) {
#else
float hbil_horizon(hbil_receiver r, hbil_side s) {
#endif
    float c = s.c0;
    hbil_visit at = hbil_start(r);
#if HBIL_GATHER_SIDE && HBIL_GATHER
    hbil_visit top = at; // what makes the horizon
#elif HBIL_SAMPLING_BILINEAR && HBIL_GATHER
    hbil_step step;
    step.to = at.pixel;
    step.to_nearness = hbil_nearness(r.position.z);
#endif
#if HBIL_OCCLUDER_HEURISTIC
    // the same per side, whatever the number of steps
    float sink = 1.0 - exp2(log2(1.0 - HBIL_DECAY) * HBIL_DECAY_STEPS / float(HBIL_STEPS));
#endif
    for (int i = 0; i < HBIL_STEPS; ++i) {
        if (!hbil_go(r, s, i, at)) break;
#if HBIL_SAMPLING_BILINEAR && HBIL_GATHER && !HBIL_GATHER_SIDE
        step.way = at.pixel - step.to;
        step.to = at.pixel;
        step.from_nearness = step.to_nearness;
        step.to_nearness = at.z < HBIL_SKY ? hbil_nearness(at.z) : -1e30;
#endif
        if (at.z >= HBIL_SKY) continue;
        vec3 h = hbil_position(at.pixel, at.z) - r.position;
        float l2 = max(dot(h, h), 1e-30);
        float inv = inversesqrt(l2);
        // at silhouettes h is nearly parallel to v and rounding takes the cosine above 1
        float c_sample = clamp(dot(h, r.v) * inv, -1.0, 1.0);
#if !HBIL_REACH_0
        // fade the horizon, not its weight: near + ao stays 1
        c_sample = mix(s.c0, c_sample, hbil_fade(l2 * inv));
#endif
        if (c_sample > c && dot(r.n, h) * inv > HBIL_BIAS) {
#if HBIL_GATHER_SIDE && HBIL_GATHER
            top = at;
#elif HBIL_GATHER
#if HBIL_SAMPLING_BILINEAR
            hbil_add_cell(r, s, step, c, c_sample, light);
#else
            hbil_add_arc(r, s, at, h * inv, c, c_sample, light);
#endif
#endif
            c = c_sample;
        }
#if HBIL_OCCLUDER_HEURISTIC
        else c = max(s.c0, mix(c, min(c, c_sample), sink));
#endif
    }
#if HBIL_GATHER_SIDE && HBIL_GATHER
    light.mean = hbil_radiance_at(top);
#if HBIL_FACING_HALF_SPACE
    vec2 arc = hbil_lit(r, s, hbil_normal_at(top), vec2(s.c0, c));
    light.mean *= hbil_weight(s.nx, r.ny, arc.x, arc.y) / max(hbil_weight(s.nx, r.ny, s.c0, c), 1e-20);
#endif
#endif
    return c;
}

//@ chunk hbil_bent
// Cosine-weighted bent vector of a slice with horizons cf, cb: x along D, y along V.
#if HBIL_BENT
vec2 hbil_bent(float nx, float ny, float cf, float cb) {
#if HBIL_SEED_COMPAT_UNIFORM_BENT
    return 0.5 * vec2(hbil_arc(cf) - hbil_arc(cb), 2.0 - cf * cf - cb * cb);
#else
    float sf2 = 1.0 - cf * cf;
    float sb2 = 1.0 - cb * cb;
    float s3 = sf2 * sqrt(sf2) - sb2 * sqrt(sb2);
    float c3 = cf * cf * cf + cb * cb * cb;
    return vec2(nx * (c3 - 3.0 * (cf + cb) + 4.0) + ny * s3, nx * s3 + ny * (2.0 - c3)) / 3.0;
#endif
}
#endif

//@ chunk hbil_add_light
#if HBIL_GATHER
// The light of a side into the sums; c: its horizon.
void hbil_add_light(hbil_receiver r, hbil_side s, hbil_light light, float c, inout hbil_sums sum) {
#if HBIL_MEAN_LIGHT
#if HBIL_NEAR_LIGHT
    sum.near += light.mean * hbil_weight(s.nx, r.ny, s.c0, c);
#endif
#if HBIL_OUTPUTS_SH
    vec2 moments = 0.5 * vec2(hbil_arc(s.c0) - hbil_arc(c), (c - s.c0) * (c + s.c0));
    sum.sh_0.rgb += (c - s.c0) * light.mean;
    hbil_add_moments(s.tangent * moments.x + r.v * moments.y, vec4(light.mean, 0.0), sum);
#endif
#else
#if HBIL_NEAR_LIGHT
    sum.near += light.near;
#endif
#if HBIL_OUTPUTS_SH
    sum.sh_0.rgb += light.sh_0;
    hbil_add_moments(s.tangent, vec4(light.sh_x, 0.0), sum);
    hbil_add_moments(r.v, vec4(light.sh_y, 0.0), sum);
#endif
#endif
}
#endif

//@ chunk hbil_horizon_slice
// Add the slice with tangent D and screen direction d.
#if HBIL_MARCH_SWEEP
void hbil_horizon_slice(hbil_receiver r, vec3 slice, hbil_line line, int i, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, line);
    hbil_side back = front;
    back.tangent = -front.tangent;
    back.nx = -front.nx;
    back.c0 = -front.c0;
#else
void hbil_horizon_slice(hbil_receiver r, vec3 slice, vec2 d, float jitter, inout hbil_sums sum) {
    hbil_side front = hbil_side_of(r, slice, d, jitter, 1.0);
    hbil_side back = hbil_side_of(r, slice, d, jitter, -1.0);
#endif
    float nx = front.nx;
#if HBIL_MARCH_SWEEP && HBIL_GATHER
    hbil_light light;
    float cf = hbil_swept(r, front, 2 * i, light.mean);
    hbil_add_light(r, front, light, cf, sum);
    float cb = hbil_swept(r, back, 2 * i + 1, light.mean);
    hbil_add_light(r, back, light, cb, sum);
#elif HBIL_MARCH_SWEEP
    float cf = hbil_swept(r, front, 2 * i);
    float cb = hbil_swept(r, back, 2 * i + 1);
#elif HBIL_GATHER
    hbil_light light = hbil_dark(front.c0);
    float cf = hbil_horizon(r, front, light);
    hbil_add_light(r, front, light, cf, sum);
    light = hbil_dark(back.c0);
    float cb = hbil_horizon(r, back, light);
    hbil_add_light(r, back, light, cb, sum);
#else
    float cf = hbil_horizon(r, front);
    float cb = hbil_horizon(r, back);
#endif
#if HBIL_SUMS
    float g0 = hbil_arc(front.c0);
    sum.full += nx * (g0 - 0.5 * HBIL_PI) + r.ny * (1.0 - front.c0 * front.c0);
    sum.blocked += 0.5 * (nx * (2.0 * g0 - HBIL_PI - hbil_arc(cf) + hbil_arc(cb))
        + r.ny * (cf * cf + cb * cb - 2.0 * front.c0 * front.c0));
#endif
#if HBIL_OUTPUTS_UNIFORM_AO
    sum.uniform_open += 0.5 * (2.0 - cf - cb);
#endif
#if HBIL_BENT
    vec2 b = hbil_bent(nx, r.ny, cf, cb);
    sum.bent += b.x * slice + b.y * r.v;
#endif
#if HBIL_OUTPUTS_SH
    sum.sh_0.a += 2.0 - cf - cb;
    vec2 open = 0.5 * vec2(hbil_arc(cf) - hbil_arc(cb), 2.0 - cf * cf - cb * cb);
    hbil_add_moments(open.x * slice + open.y * r.v, vec4(0.0, 0.0, 0.0, 1.0), sum);
#endif
}
