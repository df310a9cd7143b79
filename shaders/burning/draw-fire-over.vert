#version 450

// Two triangles over each tile that fire or smoke reaches.

#include "burning/fire-tiles.glsl"

layout(push_constant, std430) uniform Laying {
    uint picture; // number of the pictures so far
} laying;

layout(set = 0, binding = 114, std430) readonly buffer Tiles {
    uint tiles[]; // row by row, the picture that fire or smoke reached each in last
};

void main() {
    uint tile = uint(gl_VertexIndex) / 6u;
    uint vertex = uint(gl_VertexIndex) % 6u;
    // Corners 0, 1, 2 and 3, 2, 1.
    uint corner = vertex < 3u ? vertex : 6u - vertex;
    vec2 at = (vec2(tile % TILES, tile / TILES) + vec2(corner & 1u, corner >> 1u)) / float(TILES);
    gl_Position = vec4(2.0 * at - 1.0, 0.0, 1.0);
    if (tiles[tile] != laying.picture) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // nothing of it lies in the picture
    }
}
