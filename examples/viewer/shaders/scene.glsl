// scene.glsl - in front of every shader here, after the line #version. VERTEX_INDEX: the API's name of it.
layout(std140, binding = 0) uniform scene {
    mat4  u_clip, u_last_clip;
    mat4  u_sun_clip, u_sun_texture;
    vec4  u_ray_x, u_ray_y, u_ray_z;
    vec4  u_eye;
    vec4  u_sun;
    vec4  u_sun_light;
    vec4  u_sky_mean, u_sky_slope;
    vec2  u_size;
    float u_exposure, u_split;
    int   u_mode;
};

vec3 sky_radiance(vec3 direction) { return u_sky_mean.rgb + u_sky_slope.rgb * direction.z; }
// E/pi of an open surface: the cosine lobe keeps two thirds of a linear slope.
vec3 sky_irradiance(vec3 normal) { return u_sky_mean.rgb + u_sky_slope.rgb * (2.0 / 3.0 * normal.z); }
