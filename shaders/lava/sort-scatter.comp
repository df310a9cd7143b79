#version 450

// Every item to its place by this digit: behind all lower digits, and behind those of its own digit that come before it.

layout(local_size_x = 32) in;

#include "common/elements.glsl"
#include "lava/sort.glsl"

layout(set = 0, binding = 2, std430) buffer To {
    uvec2 list[];
} to;

void main() {
    uint block = element(32u);
    if (block >= sort.blocks) {
        return;
    }
    uint end = min((block + 1u) * BLOCK, sort.items);
    for (uint at = block * BLOCK; at < end; at++) {
        uint entry = digit_of(at) * sort.blocks + block;
        uint before = counts.list[entry];
        counts.list[entry] = before + 1u;
        uint run = entry / RUN;
        uint place = before + counts.list[sort.first_sum + run] + counts.list[sort.second_sum + run / RUN];
        to.list[place] = from.list[at];
    }
}
