// The position map's pyramid (section 6.1): least and greatest height in squares of texels. One list of rows holds all levels, that of
// 2 x 2 texels first, each coarser one under it. Both heights are those of texels, to the last digit: smart slicing knows no plane of
// any other height. Where no receiver is, the least is above the greatest.

const vec2 NOTHING = vec2(1.0e30, -1.0e30);

// Entries of a row.
uint row_of_entries(uint map_size) {
    return (map_size + 1u) / 2u;
}

// A level's first entry; levels count from 1, and each takes half the rows of the one before, of a power of two.
uint first_entry(uint level, uint levels, uint map_size) {
    uint all = 1u << levels;
    return (all - (all >> (level - 1u))) * row_of_entries(map_size);
}

// The least of two ranges and the greatest.
vec2 joined(vec2 one, vec2 other) {
    return vec2(min(one.x, other.x), max(one.y, other.y));
}
