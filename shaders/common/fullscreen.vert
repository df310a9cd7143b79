#version 450

// One triangle over the whole target, without a vertex buffer: draw 3 vertices.

layout(location = 0) out vec2 uv; // (0, 0) at the top left of the target, (1, 1) at the bottom right

void main() {
    uv = vec2(gl_VertexIndex == 1 ? 2.0 : 0.0, gl_VertexIndex == 2 ? 2.0 : 0.0);
    gl_Position = vec4(2.0 * uv - 1.0, 0.0, 1.0);
}
