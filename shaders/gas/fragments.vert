#version 450

// One point a triangle; the geometry stage makes its footprint.

void main() {
    gl_Position = vec4(0.0, 0.0, 0.5, 1.0);
    gl_PointSize = 1.0;
}
