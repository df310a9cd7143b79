// The tiles that a triangle's box touches.

struct TileRange {
    uvec2 first;
    uvec2 size; // 0 where it is not seen
};

TileRange tile_range(Footprint seen) {
    TileRange range;
    range.first = uvec2(seen.box.xy - vec2(0.0, band.list_row)) / TILE;
    range.size = seen.corners == 0u ? uvec2(0u)
        : (uvec2(seen.box.zw - vec2(0.0, band.list_row)) - 1u) / TILE - range.first + 1u;
    return range;
}

uint tile_of(TileRange range, uvec2 at) {
    return (range.first.y + at.y) * tiles_across() + range.first.x + at.x;
}

// The tile after another one, row by row: whole numbers are divided thread by thread.
uvec2 after(TileRange range, uvec2 at) {
    return at.x + 1u < range.size.x ? uvec2(at.x + 1u, at.y) : uvec2(0u, at.y + 1u);
}

// Its edges from the corner of the first tile.
Edges edges_in(TileRange range, Footprint seen) {
    vec2 origin = vec2(range.first) * float(TILE) + vec2(0.0, band.list_row);
    return edges_of(seen, origin, float(max(range.size.x, range.size.y) * TILE));
}

// The triangle of a thread; dispatches are 65,536 wide.
uint triangle_of(uvec2 thread) {
    return thread.y * 65536u + thread.x;
}
