layout(location = 0) in vec3 a_position;

void main() { gl_Position = u_sun_clip * vec4(a_position, 1.0); }
