#version 450

// The pairs before each triangle's in its block of 256 triangles, and those of each block: the first step of a list in order
// (section 6.1).

layout(local_size_x = 256) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Kept {
    uint list[];
} kept;

layout(std430, set = 0, binding = 1) buffer Before {
    uint list[]; // pairs of the block before each triangle's
} before;

layout(std430, set = 0, binding = 2) buffer Blocks {
    uint list[]; // pairs of each block
} blocks;

shared uint sums[256];

void main() {
    uint lane = gl_LocalInvocationID.x;
    uint triangle = 256u * workgroup() + lane;
    uint own = 0u;
    if (triangle < cull.triangles) {
        for (uint word = 0u; word < cull.words; word++) {
            own += uint(bitCount(kept.list[triangle * cull.words + word]));
        }
    }
    sums[lane] = own;
    barrier();
    for (uint reach = 1u; reach < 256u; reach *= 2u) {
        uint add = 0u;
        if (lane >= reach) {
            add = sums[lane - reach];
        }
        barrier();
        sums[lane] += add;
        barrier();
    }
    if (triangle < cull.triangles) {
        before.list[triangle] = sums[lane] - own;
    }
    if (lane == 255u && workgroup() < cull.blocks) {
        blocks.list[workgroup()] = sums[255];
    }
}
