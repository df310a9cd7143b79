// The layer of fire and smoke is drawn by tiles of its pixels, a chunk of particles at a time: those that reach a tile add
// up in registers, in their order, and the layer is written once. For each line of tiles, the columns and then the rows,
// a mask has a bit for each particle that reaches it; what is in the masks of both its lines reaches a tile.

#include "burning/billboards.glsl"

const uint CHUNK = 8192u; // particles: their slots, smoke before fire
const uint TILE = 8u; // pixels along a side
const uint WORDS = CHUNK / 32u; // of a mask
const uint SUMMARIES = WORDS / 32u; // words after them, with a bit for each that is not 0
const uint ROW = 1024u; // slots in a row of the records
const uint RECORD = 3u; // texels, below each other

layout(push_constant, std430) uniform Chunk {
    uint first; // its first slot among those of all particles
    uint fire_from; // the first slot of fire: a whole number of summaries
    uint picture; // number of the pictures so far
} chunk;

// Along x and y.
uvec2 tiles_of_layer() {
    return (billboards.layer_size + TILE - 1u) / TILE;
}

ivec2 record_at(uint slot) {
    return ivec2(slot % ROW, RECORD * (slot / ROW));
}
