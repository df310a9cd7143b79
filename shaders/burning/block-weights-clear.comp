#version 450

// Before a tick's events are counted. What the vertices amount to, and the combustion counters of 5.4, go on.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/blocks.glsl"

layout(set = 0, binding = 15, std430) buffer Blocks {
    Block blocks[];
};

void main() {
    uint block = element(64u);
    if (block >= constants.block_count) {
        return;
    }
    blocks[block].pitch_sign = 0;
    blocks[block].yaw_sign = 0;
    blocks[block].roll_sign = 0;
}
