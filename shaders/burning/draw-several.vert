#version 450

// A vertex of the mesh with its material.

#include "burning/seen.glsl"

layout(set = 0, binding = 82, std430) readonly buffer SubstanceOf {
    uint substance_of[]; // of draw vertices
};

layout(location = 4) flat out uint substance;

void main() {
    see(uint(gl_VertexIndex));
    substance = substance_of[gl_VertexIndex];
}
