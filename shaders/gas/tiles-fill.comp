#version 450

// The triangles of each tile in its chunks, a thread a triangle. Their order in a tile follows from nothing: what they
// leave in a pixel is sorted.

layout(local_size_x = 64) in;

#include "gas/counts.glsl"
#include "gas/footprint.glsl"
#include "gas/tiles.glsl"
#include "gas/tile-range.glsl"
#include "gas/counters.glsl"
#include "gas/facet.glsl"

layout(set = 0, binding = 23, std430) buffer TileTriangles {
    uvec4 tile_triangles[]; // of each its number in the piece, and the depths of its nearest and its farthest corner
};

layout(set = 0, binding = 24, std430) buffer ChunkTiles {
    uint chunk_tiles[]; // the tile of each chunk
};

void main() {
    uint chunk_room = counts.chunks;
    uint triangle = triangle_of(gl_GlobalInvocationID.xy);
    if (triangle >= band.triangle_count) {
        return;
    }
    Footprint seen = footprint_of(triangle);
    TileRange range = tile_range(seen);
    Edges edges = edges_in(range, seen);
    uint count = range.size.x * range.size.y;
    vec2 depths = facet_of(triangle).range;
    uvec2 at = uvec2(0u);
    uint done = 0u;
    for (; done < count; done++) {
        if (touches(edges, vec2(at) * float(TILE), float(TILE))) {
            uint tile = tile_of(range, at);
            uint slot = tiles[2u * tile + 1u] * CHUNK + atomicAdd(tiles[2u * tile], 1u);
            // Another rounding than that of the count could at most leave a triangle out.
            if (slot < min(chunk_room, tiles[2u * tile + 3u]) * CHUNK) {
                tile_triangles[slot] = uvec4(triangle, floatBitsToUint(depths.x), floatBitsToUint(depths.y), 0u);
                if (slot % CHUNK == 0u) {
                    chunk_tiles[slot / CHUNK] = tile;
                }
            }
        }
        at = after(range, at);
    }
    if (done < count) {
        is_ended = 1u;
    }
}
