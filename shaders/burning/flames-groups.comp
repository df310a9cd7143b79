#version 450

// The flame groups of a tick (3.6): one workgroup adds up the weights of the blocks and divides the pools. A block's
// weight counts while it has live vertices in the combustion-ready area; consumed or burnt out it weighs nothing, and
// its particles go to the others. As many particles burn as the weight warrants: all of them once a quarter of the
// object's vertices lie in such blocks (ours; the dissertation states that the number follows the vertices, and that
// not all particles are drawn at all times).

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/blocks.glsl"
#include "burning/scan.glsl"
#include "burning/flames.glsl"

layout(set = 0, binding = 15, std430) readonly buffer Blocks {
    Block blocks[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 40, std430) buffer Groups {
    Group groups[]; // blocks + 1
};

layout(set = 0, binding = 41, std430) buffer Listed {
    uint listed[]; // ready vertices of the block in the list so far
};

const float FRACTION_FOR_ALL = 0.25;

// First particle of a block that has before it `before` of the weight `total`, of `count` particles.
uint first_of(uint count, uint before, uint total) {
    return uint(float(count) * (float(before) / float(max(total, 1u))));
}

uint ready_of(uint block) {
    return uint(max(blocks[block].ready, 0));
}

uint weight_of(uint block) {
    return blocks[block].ready > 0 ? uint(blocks[block].live) : 0u;
}

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint block_count = constants.block_count;
    // A run of blocks a thread, of 4,096 at most.
    uint run = (block_count + GROUP - 1u) / GROUP;
    uint from = min(thread * run, block_count);
    uint to = min(from + run, block_count);
    uint weight = 0u;
    uint ready = 0u;
    for (uint block = from; block < to; block++) {
        weight += weight_of(block);
        ready += ready_of(block);
    }
    uint weight_before = sum_before(thread, weight);
    uint total = sums[GROUP - 1u];
    barrier();
    uint ready_before = sum_before(thread, ready);
    uint total_ready = sums[GROUP - 1u];
    float fraction = min(1.0, float(total) / (FRACTION_FOR_ALL * float(constants.vertex_count)));
    uint fire = uint(float(constants.fire_pool) * fraction);
    uint smoke = uint(float(constants.smoke_pool) * fraction);
    for (uint block = from; block < to; block++) {
        uint own = weight_of(block);
        uint first_fire = first_of(fire, weight_before, total);
        uint first_smoke = first_of(smoke, weight_before, total);
        groups[block] = Group(first_fire, first_smoke, ready_before, own);
        listed[block] = 0u;
        weight_before += own;
        ready_before += ready_of(block);
    }
    if (thread == 0u) {
        groups[block_count] = Group(first_of(fire, total, total), first_of(smoke, total, total), total_ready, 0u);
        clock.fire_particles = 0u;
        clock.smoke_particles = 0u;
    }
}
