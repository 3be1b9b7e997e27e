layout(location = 0) in vec2 v_ndc;
layout(location = 0) out vec4 o_normal;
layout(location = 1) out vec4 o_albedo;
layout(location = 2) out vec4 o_direct;
layout(location = 3) out vec4 o_motion;
layout(location = 4) out vec4 o_specular;

void main()
{
    vec3 direction = u_ray_x.xyz * v_ndc.x + u_ray_y.xyz * v_ndc.y + u_ray_z.xyz;
    vec4 last = u_last_clip * vec4(direction, 0.0);
    o_normal = vec4(0.0);
    o_albedo = vec4(0.0);
    o_direct = vec4(sky_radiance(normalize(direction)), 1.0);
    o_motion = vec4(last.w > 0.0 ? (last.xy / last.w - v_ndc) * 0.5 * u_size : vec2(0.0), 0.0, 0.0);
    o_specular = vec4(0.0);
}
