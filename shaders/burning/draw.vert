#version 450

#pragma variants COLORS=surface,areas,blocks

// A vertex of the mesh in the colour of its surface, of its area of the heat boundary or of its block.

#include "burning/seen.glsl"

void main() {
    see(uint(gl_VertexIndex));
}
