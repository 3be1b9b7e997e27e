layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_albedo;
layout(location = 3) in vec3 a_emission;
layout(location = 4) in vec2 a_surface;
layout(location = 0) out vec3 v_position;
layout(location = 1) out vec3 v_normal;
layout(location = 2) out vec4 v_clip;
layout(location = 3) out vec4 v_last_clip;
layout(location = 4) flat out vec3 v_albedo;
layout(location = 5) flat out vec3 v_emission;
layout(location = 6) flat out vec2 v_surface;

void main()
{
    v_position = a_position;
    v_normal = a_normal;
    v_albedo = a_albedo;
    v_emission = a_emission;
    v_surface = a_surface;
    v_clip = u_clip * vec4(a_position, 1.0);
    v_last_clip = u_last_clip * vec4(a_position, 1.0);
    gl_Position = v_clip;
}
