#version 450

// The surface's normals as colours.

layout(location = 2) in vec4 normal; // unit vector, how charred

layout(location = 0) out vec4 shaded;

void main() {
    shaded = vec4(0.5 + 0.5 * normalize(normal.xyz), 1.0);
}
