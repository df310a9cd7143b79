// Tiles of 8 x 8 pixels, the first at the band's first row, with the triangles that touch them. A tile's triangles are
// in chunks of 32, its own alone, one after the other; a chunk's triangles are the bits of a word of each pixel.

const uint TILE = 8u;
const uint CHUNK = 32u;
const uint CHUNKS_A_ROW = 32768u; // of a dispatch with a workgroup a chunk

layout(set = 0, binding = 22, std430) buffer Tiles {
    uint tiles[]; // of each its triangles, and its first chunk
};

uint tiles_across() {
    return (frame.size.x + TILE - 1u) / TILE;
}

uint chunks_of(uint triangle_count) {
    return (triangle_count + CHUNK - 1u) / CHUNK;
}

// The edges of a polygon as functions of a place from an origin, positive inside. Rounding, here and where coverage is
// cut, stays below the slack. The last edge of a triangle is none and positive everywhere.
struct Edges {
    vec4 at_origin;
    vec4 per_column;
    vec4 per_row;
    vec4 slack;
    bvec4 is_edge;
};

Edges edges_of(Footprint seen, vec2 origin, float reach) {
    vec4 x = vec4(seen.ab.x, seen.ab.z, seen.cd.x, seen.cd.z) - origin.x;
    vec4 y = vec4(seen.ab.y, seen.ab.w, seen.cd.y, seen.cd.w) - origin.y;
    vec4 along_x = x.yzwx - x;
    vec4 along_y = y.yzwx - y;
    float inwards = signed_area(seen.ab, seen.cd) >= 0.0 ? 1.0 : -1.0;
    Edges edges;
    edges.per_column = -inwards * along_y;
    edges.per_row = inwards * along_x;
    edges.at_origin = -(edges.per_column * x + edges.per_row * y);
    vec4 size = max(abs(x), abs(y)) + vec4(max(origin.x, origin.y) + reach);
    size = max(size, size.yzwx);
    edges.slack = 1.0e-6 * size * (abs(along_x) + abs(along_y) + abs(x) + abs(y) + vec4(2.0 * reach));
    edges.is_edge = bvec4(uvec4(notEqual(along_x, vec4(0.0))) | uvec4(notEqual(along_y, vec4(0.0))));
    return edges;
}

// No edge has all of the square of that side at a place on its outside.
bool touches(Edges edges, vec2 place, float side) {
    vec4 most = edges.at_origin + edges.slack + edges.per_column * place.x + edges.per_row * place.y
        + side * (max(edges.per_column, vec4(0.0)) + max(edges.per_row, vec4(0.0)));
    return min(min(most.x, most.y), min(most.z, most.w)) >= 0.0;
}
