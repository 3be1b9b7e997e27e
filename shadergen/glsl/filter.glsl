// filter: one mean over the neighbours that lie on the same surface. What few slices per pixel get wrong differs from
// pixel to pixel, and cancels.

//@ chunk HBIL_FILTER_RADIUS
#if HBIL_FILTER_3X3
const int HBIL_FILTER_RADIUS = 1; // pixels
#else
const int HBIL_FILTER_RADIUS = 2; // pixels
#endif

//@ chunk HBIL_FILTER_PLANE
const float HBIL_FILTER_PLANE = 1.0; // distance from the tangent plane at which a neighbour counts no more. pixels

//@ chunk hbil_filter_weight
// How far a neighbour is part of the surface with normal n at `position`. [0, 1]
float hbil_filter_weight(ivec2 q, vec3 position, vec3 n, float pixel) {
    float z = hbil_load_depth(q);
    if (z >= HBIL_SKY) return 0.0;
    float off = abs(dot(n, hbil_position(vec2(q) + 0.5, z) - position));
    return clamp(1.0 - off / (HBIL_FILTER_PLANE * pixel), 0.0, 1.0);
}

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    float z = hbil_load_depth(p);
    vec3 position = hbil_position(vec2(p) + 0.5, z);
    vec3 n = hbil_load_normal(p);
    // width of a pixel there
    float pixel = length(hbil_position(vec2(p) + vec2(1.5, 0.5), z) - position);
    float all = 0.0;
#if HBIL_AO
    float ao = 0.0;
#endif
#if HBIL_NEAR_LIGHT
    vec3 near = vec3(0.0);
#endif
#if HBIL_BENT
    vec3 bent = vec3(0.0);
#endif
    for (int y = -HBIL_FILTER_RADIUS; y <= HBIL_FILTER_RADIUS; ++y)
        for (int x = -HBIL_FILTER_RADIUS; x <= HBIL_FILTER_RADIUS; ++x) {
            ivec2 q = p + ivec2(x, y);
            if (any(lessThan(q, ivec2(0))) || any(greaterThanEqual(q, HBIL_SIZE))) continue;
            // the pixel itself always counts, a sky pixel nothing else
            float w = q == p ? 1.0 : z < HBIL_SKY ? hbil_filter_weight(q, position, n, pixel) : 0.0;
            all += w;
#if HBIL_AO
            ao += w * texelFetch(u_raw_ao, q, 0).r;
#endif
#if HBIL_NEAR_LIGHT
            near += w * texelFetch(u_raw_near, q, 0).rgb;
#endif
#if HBIL_BENT
            bent += w * texelFetch(u_raw_bent, q, 0).xyz;
#endif
        }
#if HBIL_AO
    imageStore(u_ao, p, vec4(ao / all));
#endif
#if HBIL_NEAR_LIGHT
    imageStore(u_near, p, vec4(near / all, 1.0));
#endif
#if HBIL_BENT
    imageStore(u_bent, p, vec4(bent / all, 1.0));
#endif
}
