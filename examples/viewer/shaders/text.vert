layout(location = 0) in vec3 a_corner;
layout(location = 0) flat out float v_grey;

void main()
{
    v_grey = a_corner.z;
    gl_Position = vec4(a_corner.xy * 2.0 / u_size - 1.0, 0.0, 1.0);
}
