#version 450

// Number of each digit's items in every block.

layout(local_size_x = 32) in;

#include "common/elements.glsl"
#include "lava/sort.glsl"

void main() {
    uint block = element(32u);
    if (block >= sort.blocks) {
        return;
    }
    for (uint digit = 0u; digit < DIGITS; digit++) {
        counts.list[digit * sort.blocks + block] = 0u;
    }
    uint end = min((block + 1u) * BLOCK, sort.items);
    for (uint at = block * BLOCK; at < end; at++) {
        counts.list[digit_of(at) * sort.blocks + block]++;
    }
}
