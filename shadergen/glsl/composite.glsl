// composite: the light that leaves each surface.

//@ chunk main
void main() {
    ivec2 p = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(p, HBIL_SIZE))) return;
    vec3 direct = hbil_finite(texelFetch(u_direct, p, 0).rgb);
    vec3 albedo = min(hbil_finite(texelFetch(u_albedo, p, 0).rgb), vec3(1.0));
    imageStore(u_composite, p, vec4(direct + albedo * texelFetch(u_near, p, 0).rgb, 1.0));
}
