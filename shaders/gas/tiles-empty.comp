#version 450

// No tile has a triangle.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/band.glsl"

layout(set = 0, binding = 22, std430) buffer Tiles {
    uint tiles[];
};

void main() {
    uvec2 tile = gl_GlobalInvocationID.xy;
    uvec2 size = (uvec2(frame.size.x, band.end_row - band.list_row) + 7u) / 8u;
    if (tile.x < size.x && tile.y < size.y) {
        tiles[2u * (tile.y * size.x + tile.x)] = 0u;
    }
}
