#version 450

// The pairs before each word in its block of 256 words, and those of each block: the first step of a list in order (section 6.1).

layout(local_size_x = 256) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Kept {
    uint list[];
} kept;

layout(std430, set = 0, binding = 1) buffer Before {
    uint list[]; // pairs of the block before each word
} before;

layout(std430, set = 0, binding = 2) buffer Blocks {
    uint list[]; // pairs of each block
} blocks;

shared uint sums[256];

void main() {
    uint word = gl_GlobalInvocationID.x;
    uint lane = gl_LocalInvocationID.x;
    uint all_words = cull.words * cull.planes;
    uint own = 0u;
    if (word < all_words) {
        own = uint(bitCount(kept.list[word]));
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
    if (word < all_words) {
        before.list[word] = sums[lane] - own;
    }
    if (lane == 255u) {
        blocks.list[word / 256u] = sums[255];
    }
}
