#version 450

// A vertex of the mesh.

#include "burning/seen.glsl"

void main() {
    see(uint(gl_VertexIndex));
}
