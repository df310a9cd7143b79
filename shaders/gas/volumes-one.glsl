// A scene with one volume. Its numbers are read once, before all loops: a processor that does many threads in step reads a
// storage buffer thread by thread, and numbers that were read where they are used took as long as the noise.

#include "gas/volume.glsl"

const uint MAX_VOLUMES = 1u;
const uint volume_count = 1u;
const uint index_in_hand = 0u;

Volume in_hand;
vec2 helix; // where the volume is on it

void read_volumes() {
    in_hand = volumes[0];
    helix = helix_of(in_hand);
}

void take_volume(uint v) {}

#include "gas/solids.glsl"
