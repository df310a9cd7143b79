// A tile's pixels, a thread each, and the triangles that touch them.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/counts.glsl"
#include "gas/footprint.glsl"
#include "gas/tiles.glsl"
#include "gas/loops.glsl"
#include "gas/lists.glsl"
#include "gas/counters.glsl"
#include "gas/fragment.glsl"

layout(set = 0, binding = 23, std430) buffer TileTriangles {
    uvec4 tile_triangles[]; // of each its number in the piece, and the depths of its nearest and its farthest corner
};

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 8, std430) buffer Links {
    uvec4 links[]; // each a Link
};

layout(set = 0, binding = 9, std430) buffer Surfaces {
    uvec4 surfaces[]; // each a Surface
};

layout(set = 0, binding = 10, std430) buffer Colors {
    uvec2 colors[]; // each a Color
};

layout(set = 0, binding = 25, std430) readonly buffer TilePixels {
    uvec2 tile_pixels[];
};

struct Chunks {
    uint from;
    uint to;
};

uint tile_of_group() {
    uvec2 place = gl_GlobalInvocationID.xy / TILE;
    return place.y * tiles_across() + place.x;
}

// Those of the tile that this dispatch does; none for a thread beside the picture.
Chunks chunks_of_call(uint tile, bool is_mine) {
    uint first = tiles[2u * tile + 1u];
    uint count = chunks_of(tiles[2u * tile]);
    Chunks chunks;
    chunks.from = min(first + min(band.call * CHUNKS_A_CALL, count), counts.chunks);
    chunks.to = min(first + min((band.call + 1u) * CHUNKS_A_CALL, count), counts.chunks);
    chunks.to = is_mine ? chunks.to : chunks.from;
    return chunks;
}

// What a triangle that touches a pixel leaves in it.
Fragment fragment_in(uint triangle, vec2 origin) {
    Facet facet = facet_of(triangle);
    Footprint seen = polygon_of(to_view(facet.p0 + facet.offset), to_view(facet.p1 + facet.offset),
        to_view(facet.p2 + facet.offset));
    return fragment_of(facet, seen.ab, seen.cd, origin);
}
