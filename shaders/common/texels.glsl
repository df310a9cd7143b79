// A list as an image: its texels row after row. Some processors read an image's texel at once, but a buffer's numbers one by one.

const uint ROW_BITS = 12u; // every device has so long rows; as src/papers/texels.rs has it

ivec2 texel_of(uint at) {
    return ivec2(int(at & ((1u << ROW_BITS) - 1u)), int(at >> ROW_BITS));
}
