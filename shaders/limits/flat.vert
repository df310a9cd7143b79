#version 450

// Vertices in one place: triangles without area, which cover nothing.

void main() {
    gl_Position = vec4(0.0, 0.0, 0.5, 1.0);
}
