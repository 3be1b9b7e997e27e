layout(location = 0) flat in float v_grey;
layout(location = 0) out vec4 o_colour;

void main() { o_colour = vec4(vec3(v_grey), 1.0); }
