#version 450

// The number of triangles that touch each tile, a thread a triangle.

layout(local_size_x = 64) in;

#include "gas/footprint.glsl"
#include "gas/tiles.glsl"
#include "gas/tile-range.glsl"
#include "gas/counters.glsl"

void main() {
    uint triangle = triangle_of(gl_GlobalInvocationID.xy);
    if (triangle >= band.triangle_count) {
        return;
    }
    Footprint seen = footprint_of(triangle);
    TileRange range = tile_range(seen);
    Edges edges = edges_in(range, seen);
    uint count = range.size.x * range.size.y;
    uint at = 0u;
    for (; at < count; at++) {
        if (touches(edges, place_of(range, at), float(TILE))) {
            atomicAdd(tiles[2u * tile_of(range, at)], 1u);
        }
    }
    if (at < count) {
        is_ended = 1u;
    }
}
