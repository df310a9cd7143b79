// The picture is done in bands of rows, whose lists the device's buffers hold; most pictures are one band. A slow pass
// is dispatched in parts of a band, so that no watchdog ends it, and several times where it does not finish at once.

layout(push_constant, std430) uniform Band {
    uint list_row; // the first row of the band
    uint first_row; // the first row of this dispatch
    uint end_row; // the row after its last
    uint call; // of the band's dispatches of the pass, from 0
    uint calls; // their number
    uint first_triangle; // of those that are drawn, among all
    uint triangle_count; // of those that are drawn
    uint picture_row; // the first row of the first band
    uint end_list_row; // the row after the last one of the band
    uint rest; // 1 for pixels that are not of the lattice, see lattice.glsl
    uint part; // of `volume`, see gas-pixels.glsl
    uint part_bits; // of their number, a power of two
} band;

// The list of a pixel.
uint list_of(uvec2 pixel) {
    return (pixel.y - band.list_row) * frame.size.x + pixel.x;
}

// The place of a thread's pixel in the dispatch. Of the 8 x 8 pixels of a workgroup eight threads in a row have 4 x 2, not 8 x 1: a
// processor that does eight in step waits for the one that has most to do, and near pixels have as much.
uvec2 place_of(uvec2 thread) {
    uvec2 within = thread % uvec2(8u);
    return thread - within + uvec2((within.x & 3u) | ((within.y & 1u) << 2u), (within.y & 6u) | (within.x >> 2u));
}

// The pixel of a thread; in no dispatch where is_in_band says no.
uvec2 pixel_of(uvec2 thread) {
    return place_of(thread) + uvec2(0u, band.first_row);
}

bool is_in_band(uvec2 pixel) {
    return pixel.x < frame.size.x && pixel.y < band.end_row;
}
