#version 450

// Before the vertices are counted. The combustion counters of 5.4 go on.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"

layout(set = 0, binding = 15, std430) buffer Blocks {
    int blocks[]; // live, ready, signs of pitch, yaw, roll, combustion counter, inside the ready boundary, last tick with active ones
};

void main() {
    uint block = gl_GlobalInvocationID.x;
    if (block >= constants.counts.w) {
        return;
    }
    for (uint i = 0u; i < 5u; i++) {
        blocks[8u * block + i] = 0;
    }
    blocks[8u * block + 6u] = 0;
}
