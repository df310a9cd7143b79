// What a band wants of the lists, beyond their capacity as well, and the most that a band of any frame has wanted.

layout(set = 0, binding = 11, std430) buffer Counters {
    uint fragment_count;
    uint section_count;
    uint most_fragments; // in a band before
    uint most_sections;
    uint chunk_count; // of the triangles of tiles, see tiles.glsl
    uint most_chunks;
    uint most_of_tile; // triangles
    uint is_ended; // 1 where a device ended a loop over them
    uint lost_pixels; // of a frame so far, see fragments-nearest.comp
    uint most_lost_pixels; // of a frame before
    uint earlier_fragments; // of the frame's bands before this one, and what of them is beyond 32 bits
    uint earlier_fragments_high;
};

// No buffer has so many slots. Whoever is told of more takes back what he has counted, so that no count comes round to slots
// that others hold.
const uint MOST_SLOTS = 0x80000000u;
