// The levels of the map in tiles of TILE x TILE texels, of which the device holds some. A tile that it does not hold is
// answered for by the coarser one over it, whose texels bound those of the finer: what a ray reads is then the surface of a
// map that is as high there as the coarser texel, and every bound of a level holds for it as it does for the data. Each tile that
// is read is noted, so that the host can bring what is missing.

const int TILE_BITS = 7; // src/papers/terrain/page_table.rs has them, too
const int TILE = 1 << TILE_BITS;
// Of the pages' head: the first page of the highest values of each level, the data first, then that of the lowest ones.
const int LOWEST_PAGES = 32;
const int COLUMN_BITS = 31; // the place of the binary logarithm of the tiles in a row of the image

layout(set = 0, binding = 1) uniform utexture2D pool;

layout(set = 0, binding = 5, std430) readonly buffer Pages {
    uint list[]; // the head; then of each tile the place in the image, and from bit 24 on the levels up to it
} pages;

layout(set = 0, binding = 6, std430) buffer Asked {
    uint list[]; // 1 for each page that was read
} asked;

float value_in(int first_page, int shift, ivec2 texel) {
    ivec2 tile = texel >> TILE_BITS;
    int columns = (map.last.x >> shift >> TILE_BITS) + 1;
    int page = int(pages.list[first_page + shift]) + tile.y * columns + tile.x;
    uint entry = pages.list[page];
    asked.list[page] = 1u;
    int up = int(entry >> 24);
    int place = int(entry & 0xffffffu);
    int column_bits = int(pages.list[COLUMN_BITS]);
    ivec2 origin = ivec2(place & ((1 << column_bits) - 1), place >> column_bits) << TILE_BITS;
    uint bits = texelFetch(pool, origin + ((texel >> up) & (TILE - 1)), 0).x;
    return map.is_float ? uintBitsToFloat(bits) : float(int(bits));
}

float highest_at(int shift, ivec2 texel) {
    return value_in(0, shift, texel);
}

float lowest_at(int shift, ivec2 texel) {
    return value_in(LOWEST_PAGES, shift, texel);
}
