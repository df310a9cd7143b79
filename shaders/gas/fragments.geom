#version 450

// Section "Combining A-buffer and volume rendering techniques": conservative footprints of the triangles, for exact
// coverage.

#include "gas/footprint.glsl"

layout(points) in;
layout(triangle_strip, max_vertices = 4) out;

layout(location = 0) flat out vec4 corners_ab;
layout(location = 1) flat out vec4 corners_cd;
layout(location = 2) flat out uint seen_triangle;

void main() {
    uint triangle = uint(gl_PrimitiveIDIn);
    Footprint seen = footprint_of(triangle);
    if (seen.corners == 0u) {
        return;
    }
    for (uint i = 0u; i < 4u; i++) {
        corners_ab = seen.ab;
        corners_cd = seen.cd;
        seen_triangle = triangle;
        gl_Position = vec4(box_corner(seen.box, i), 0.5, 1.0);
        EmitVertex();
    }
    EndPrimitive();
}
