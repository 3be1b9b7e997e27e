layout(location = 0) in vec3 v_position;
layout(location = 1) in vec3 v_normal;
layout(location = 2) in vec4 v_clip;
layout(location = 3) in vec4 v_last_clip;
layout(location = 4) flat in vec3 v_albedo;
layout(location = 5) flat in vec3 v_emission;
layout(location = 6) flat in vec2 v_surface;
layout(location = 0) out vec4 o_normal;
layout(location = 1) out vec4 o_albedo;
layout(location = 2) out vec4 o_direct;
layout(location = 3) out vec4 o_motion;
layout(location = 4) out vec4 o_specular;
layout(binding = 1) uniform sampler2D u_shadow;

// Lit part of 3x3 texels. Bias: along the normal by a texel, more where the sun grazes. A texel without any surface
// lies past the edge of this one, and would let light through where two walls meet.
float sun_visibility(vec3 normal, float facing)
{
    vec3 at = (u_sun_texture * vec4(v_position + normal * u_sun.w * (2.5 - 1.5 * facing), 1.0)).xyz;
    ivec2 texel = ivec2(floor(at.xy * vec2(textureSize(u_shadow, 0))));
    float lit = 0.0, count = 0.0;
    if (any(lessThan(texel, ivec2(1))) || any(greaterThan(texel, textureSize(u_shadow, 0) - 2))) return 1.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            float depth = texelFetch(u_shadow, texel + ivec2(x, y), 0).r;
            count += depth < 1.0 ? 1.0 : 0.0;
            lit += at.z <= depth && depth < 1.0 ? 1.0 : 0.0;
        }
    return count > 0.0 ? lit / count : 1.0;
}

void main()
{
    vec3 normal = normalize(v_normal);
    if (dot(normal, u_eye.xyz - v_position) < 0.0) normal = -normal; // surfaces have two sides
    vec3 diffuse = v_albedo * (1.0 - v_surface.x);
    float facing = dot(normal, u_sun.xyz);
    float sun = facing > 0.0 ? facing * sun_visibility(normal, facing) : 0.0;
    o_normal = vec4(normal, 0.0);
    o_albedo = vec4(diffuse, 1.0);
    o_direct = vec4(v_emission + diffuse * u_sun_light.rgb * sun, 1.0);
    o_motion = vec4((v_last_clip.xy / v_last_clip.w - v_clip.xy / v_clip.w) * 0.5 * u_size, 0.0, 0.0);
    o_specular = vec4(mix(vec3(0.04), v_albedo, v_surface.x), v_surface.y);
}
