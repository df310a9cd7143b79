// Light on the map's texels in whole units, so many to an I_c of 1, 64 bits a texel: sums of whole numbers are the same in any order
// (section 6.3).

layout(std430, set = 0, binding = 6) buffer Sums {
    uint list[]; // low and high word of each texel, row by row, surface below surface
} sums;

uint low_word(ivec2 texel, int layer) {
    return 2u * uint((layer * int(plane.map_size) + texel.y) * int(plane.map_size) + texel.x);
}

// True where the texel's low word is full, and its high word has to be told so.
bool add_low(ivec2 texel, int layer, float light) {
    uint at = low_word(texel, layer);
    // A cell's light in one texel: a word's numbers at the most.
    uint units = uint(min(light * plane.units, 4294967040.0) + 0.5);
    return units > 0u && atomicAdd(sums.list[at], units) > 0xffffffffu - units;
}

void add_high(ivec2 texel, int layer) {
    atomicAdd(sums.list[low_word(texel, layer) + 1u], 1u);
}

void add_light(ivec2 texel, int layer, float light) {
    if (add_low(texel, layer, light)) {
        add_high(texel, layer);
    }
}

bool is_in_map(ivec2 texel) {
    return all(greaterThanEqual(texel, ivec2(0))) && all(lessThan(texel, ivec2(int(plane.map_size))));
}
