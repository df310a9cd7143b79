// The levels of the map in tiles of TILE x TILE texels, of which the device holds some. A tile that it does not hold is
// answered for by the coarser one over it, whose texels bound those of the finer: what a ray reads is then the surface of a
// map that is as high there as the coarser texel, and every bound of a level holds for it as it does for the data. A
// drawing that marks what it reads tells the host what to bring.

const int TILE_BITS = 7; // src/papers/terrain/page_table.rs has it, too
const int TILE = 1 << TILE_BITS;

layout(set = 0, binding = 1) uniform utexture2D pool;

layout(set = 0, binding = 5, std430) readonly buffer Pages {
    uint list[]; // of each tile column and row of its place in the pool, 12 bits each, and then the levels up to it
} pages;

layout(set = 0, binding = 6, std430) buffer Asked {
    uint list[]; // 1 for each page that was read
} asked;

// The data's pages come first, then those of the coarser levels: of each a square as if the map were one of 2^n x 2^n texels.
int first_page(int shift) {
    int page_bits = max(map.top - TILE_BITS, 0);
    int squares = 4 << (2 * page_bits);
    int finer = min(shift, page_bits);
    // A geometric series, and then levels of one tile.
    return (squares - (squares >> (2 * finer))) / 3 + shift - finer;
}

// The pages of the lowest values, `is_lowest` being 1, follow those of the highest; the data are both.
float value_in(int is_lowest, int shift, ivec2 texel) {
    ivec2 tile = texel >> TILE_BITS;
    int page_bits = max(map.top - TILE_BITS, 0);
    int page = first_page(shift) + (tile.y << (page_bits - min(shift, page_bits))) + tile.x;
    page += is_lowest * min(shift, 1) * (first_page(map.top) + 1);
    uint entry = pages.list[page];
    // True in drawings that are not measured. No entry has its uppermost bit, which a driver cannot know: lavapipe makes a shader
    // anew for each drawing where a block alone decides.
    if (terrain.marks_tiles > int(entry >> 31)) {
        asked.list[page] = 1u;
    }
    int up = int(entry >> 24);
    ivec2 origin = ivec2(int(entry & 0xfffu), int((entry >> 12) & 0xfffu)) << TILE_BITS;
    uint bits = texelFetch(pool, origin + ((texel >> up) & (TILE - 1)), 0).x;
    return map.is_float ? uintBitsToFloat(bits) : float(int(bits));
}

float highest_at(int shift, ivec2 texel) {
    return value_in(0, shift, texel);
}

float lowest_at(int shift, ivec2 texel) {
    return value_in(1, shift, texel);
}
