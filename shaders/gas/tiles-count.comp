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
    uvec2 at = uvec2(0u);
    uint done = 0u;
    for (; done < count; done++) {
        if (touches(edges, vec2(at) * float(TILE), float(TILE))) {
            atomicAdd(tiles[2u * tile_of(range, at)], 1u);
        }
        at = after(range, at);
    }
    if (done < count) {
        is_ended = 1u;
    }
}
