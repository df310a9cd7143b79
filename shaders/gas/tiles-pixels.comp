#version 450

// The triangles of a chunk that touch each pixel of its tile, and those that fill it and are opaque: a workgroup a
// chunk, first a thread a triangle, then a thread a row of pixels.

layout(local_size_x = 32) in;

#include "gas/counts.glsl"
#include "gas/footprint.glsl"
#include "gas/tiles.glsl"
#include "gas/counters.glsl"

layout(set = 0, binding = 23, std430) buffer TileTriangles {
    uvec4 tile_triangles[]; // of each its number in the piece, and the depths of its nearest and its farthest corner
};

layout(set = 0, binding = 24, std430) readonly buffer ChunkTiles {
    uint chunk_tiles[];
};

layout(set = 0, binding = 25, std430) buffer TilePixels {
    uvec2 tile_pixels[]; // of each chunk for each pixel: the triangles that touch it, those that fill it
};

shared uint touched[64]; // of each triangle the pixels of the upper four rows, and of the lower ones
shared uint filled[64];

// Bits of `columns` numbers from `first` on, of those from 0 to 7.
uint bits_between(float first, float end) {
    uint low = uint(clamp(first, 0.0, 8.0));
    uint high = uint(clamp(end, 0.0, 8.0));
    return high > low ? (1u << high) - (1u << low) : 0u;
}

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint chunk = gl_GlobalInvocationID.y * CHUNKS_A_ROW + gl_GlobalInvocationID.x / CHUNK;
    bool is_used = chunk < min(chunk_count, counts.chunks);
    uint tile = is_used ? chunk_tiles[chunk] : 0u;
    uint before = is_used ? (chunk - tiles[2u * tile + 1u]) * CHUNK : 0u;
    uint count = is_used ? min(tiles[2u * tile] - before, CHUNK) : 0u;
    uvec2 touching = uvec2(0u);
    uvec2 filling = uvec2(0u);
    if (lane < count) {
        uint triangle = tile_triangles[chunk * CHUNK + lane].x;
        Footprint seen = footprint_of(triangle);
        uint across = tiles_across();
        vec2 corner = vec2(tile % across, tile / across) * float(TILE) + vec2(0.0, band.list_row);
        Edges edges = edges_of(seen, corner, float(TILE));
        vec4 box = seen.box - vec4(corner, corner);
        vec4 outer = edges.at_origin + edges.slack + max(edges.per_column, vec4(0.0)) + max(edges.per_row, vec4(0.0));
        vec4 inner = edges.at_origin - edges.slack + min(edges.per_column, vec4(0.0)) + min(edges.per_row, vec4(0.0));
        inner = mix(vec4(1.0), inner, edges.is_edge);
        uint object = triangle_at(triangle).object;
        bool is_opaque = objects[object].opacity >= 1.0 && objects[object].solid_texture < 0;
        uint columns = bits_between(box.x, box.z);
        uint rows = bits_between(box.y, box.w);
        uint row = 0u;
        do {
            vec4 out_of = outer + edges.per_row * float(row);
            vec4 inside = inner + edges.per_row * float(row);
            uint some = 0u;
            uint all = 0u;
            uint column = 0u;
            do {
                vec4 a = out_of + edges.per_column * float(column);
                vec4 b = inside + edges.per_column * float(column);
                some |= min(min(a.x, a.y), min(a.z, a.w)) >= 0.0 ? 1u << column : 0u;
                all |= min(min(b.x, b.y), min(b.z, b.w)) > 0.0 ? 1u << column : 0u;
                column++;
            } while (column < TILE);
            uint seen_bits = (rows >> row & 1u) != 0u ? columns : 0u;
            uint shift = (row & 3u) * 8u;
            uvec2 half_of = row < 4u ? uvec2(1u, 0u) : uvec2(0u, 1u);
            touching |= half_of * ((some & seen_bits) << shift);
            filling |= half_of * ((is_opaque ? all & seen_bits : 0u) << shift);
            row++;
        } while (row < TILE);
    }
    touched[2u * lane] = touching.x;
    touched[2u * lane + 1u] = touching.y;
    filled[2u * lane] = filling.x;
    filled[2u * lane + 1u] = filling.y;
    barrier();
    uint part = (lane >> 2u) & 1u;
    uint shift = (lane & 3u) * 8u;
    uvec4 some_low = uvec4(0u);
    uvec4 some_high = uvec4(0u);
    uvec4 all_low = uvec4(0u);
    uvec4 all_high = uvec4(0u);
    const uvec4 LOW = uvec4(0u, 1u, 2u, 3u);
    const uvec4 HIGH = uvec4(4u, 5u, 6u, 7u);
    for (uint i = 0u; i < (lane < TILE ? count : 0u); i++) {
        uint some = touched[2u * i + part] >> shift;
        uint all = filled[2u * i + part] >> shift;
        some_low |= (uvec4(some) >> LOW & 1u) << i;
        some_high |= (uvec4(some) >> HIGH & 1u) << i;
        all_low |= (uvec4(all) >> LOW & 1u) << i;
        all_high |= (uvec4(all) >> HIGH & 1u) << i;
    }
    if (is_used && lane < TILE) {
        uint first = chunk * 64u + lane * TILE;
        tile_pixels[first] = uvec2(some_low.x, all_low.x);
        tile_pixels[first + 1u] = uvec2(some_low.y, all_low.y);
        tile_pixels[first + 2u] = uvec2(some_low.z, all_low.z);
        tile_pixels[first + 3u] = uvec2(some_low.w, all_low.w);
        tile_pixels[first + 4u] = uvec2(some_high.x, all_high.x);
        tile_pixels[first + 5u] = uvec2(some_high.y, all_high.y);
        tile_pixels[first + 6u] = uvec2(some_high.z, all_high.z);
        tile_pixels[first + 7u] = uvec2(some_high.w, all_high.w);
    }
}
