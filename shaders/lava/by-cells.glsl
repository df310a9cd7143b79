// Textures of the particles in the order of their cells.

const uint ROW_BITS = 12u; // every device has so long rows

ivec2 texel_of(uint at) {
    return ivec2(int(at & ((1u << ROW_BITS) - 1u)), int(at >> ROW_BITS));
}
