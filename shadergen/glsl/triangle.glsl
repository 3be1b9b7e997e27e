// triangle: the vertex shader of every pass with stage=fragment. Three vertices without attributes cover the target.

//@ chunk vertex
void main() {
    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
