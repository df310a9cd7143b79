#version 450

// One triangle over the whole target, without a vertex buffer: draw 3 vertices. Fragment stages tell their place by
// gl_FragCoord.

void main() {
    vec2 corner = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);
    gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
