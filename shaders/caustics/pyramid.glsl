// The position map's pyramid (section 6.1): least and greatest height in squares of texels. One list of rows holds all levels, that of
// 2 x 2 texels first, each coarser one under it. An entry is one word, since loads cost by their number: both heights in steps of the
// box's height, rounded outwards, the least in its lower half. Where no receiver is, the least is above the greatest.

const uint NOTHING = 0x0000ffffu;
const float STEPS = 65535.0;
// By which heights are moved outwards before they are rounded, in steps: more than single precision loses.
const float OUTWARDS = 0.05;

// Entries of a row.
uint row_of_entries(uint map_size) {
    return (map_size + 1u) / 2u;
}

// A level's first entry; levels count from 1, and each takes half the rows of the one before, of a power of two.
uint first_entry(uint level, uint levels, uint map_size) {
    uint all = 1u << levels;
    return (all - (all >> (level - 1u))) * row_of_entries(map_size);
}

uint joined(uint a, uint b) {
    return min(a & 0xffffu, b & 0xffffu) | max(a & 0xffff0000u, b & 0xffff0000u);
}

uint entry_of(float height, float half_height) {
    float place = (height / half_height * 0.5 + 0.5) * STEPS;
    vec2 steps = clamp(vec2(floor(place - OUTWARDS), ceil(place + OUTWARDS)), vec2(0.0), vec2(STEPS));
    return uint(steps.x) | (uint(steps.y) << 16u);
}

// Metres from the box's middle.
vec2 heights_of(uint entry, float half_height) {
    vec2 steps = vec2(float(entry & 0xffffu), float(entry >> 16u));
    return entry == NOTHING ? vec2(1.0e30, -1.0e30) : (steps * (2.0 / STEPS) - 1.0) * half_height;
}
