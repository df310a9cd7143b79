// A scene with any number of volumes, whose numbers are read when one is taken in hand.

#include "gas/volume.glsl"

const uint MAX_VOLUMES = 8u;

uint volume_count = 0u;
uint index_in_hand = NONE;
Volume in_hand;
vec2 helix; // where it is on it

void read_volumes() {
    volume_count = counts.volumes;
}

void take_volume(uint v) {
    in_hand = volumes[v];
    index_in_hand = v;
    helix = helix_of(in_hand);
}

#include "gas/solids.glsl"
