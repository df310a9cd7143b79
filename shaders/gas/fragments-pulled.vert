#version 450

// As fragments.geom, for devices without geometry stages: six vertices a triangle, each of which makes the whole
// footprint.

#include "gas/footprint.glsl"

layout(location = 0) flat out vec4 corners_ab;
layout(location = 1) flat out vec4 corners_cd;
layout(location = 2) flat out uint seen_triangle;

void main() {
    uint triangle = uint(gl_VertexIndex) / 6u;
    uint corner = uint(gl_VertexIndex) % 6u;
    Footprint seen = footprint_of(triangle);
    corners_ab = seen.ab;
    corners_cd = seen.cd;
    seen_triangle = triangle;
    // Two triangles of the box: 0 1 2 and 2 1 3. A triangle that is not seen has an empty box.
    uint index = corner < 3u ? corner : (corner == 3u ? 2u : (corner == 4u ? 1u : 3u));
    gl_Position = vec4(box_corner(seen.box, index), 0.5, 1.0);
}
