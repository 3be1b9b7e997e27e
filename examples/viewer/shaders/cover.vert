// One triangle over the whole screen, at the far end.
layout(location = 0) out vec2 v_ndc;

void main()
{
    v_ndc = vec2(VERTEX_INDEX == 1 ? 3.0 : -1.0, VERTEX_INDEX == 2 ? 3.0 : -1.0);
    gl_Position = vec4(v_ndc, 1.0, 1.0);
}
