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

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint block_count = constants.block_count;
    uint weight_before = 0u;
    uint ready_before = 0u;
    for (uint base = 0u; base <= block_count; base += GROUP) {
        uint block = base + thread;
        uint weight = 0u;
        uint ready = 0u;
        if (block < block_count) {
            ready = uint(max(blocks[block].ready, 0));
            weight = ready > 0u ? uint(blocks[block].live) : 0u;
            listed[block] = 0u;
        }
        uint weight_sum = weight_before + sum_before(thread, weight);
        weight_before += sums[GROUP - 1u];
        barrier();
        uint ready_sum = ready_before + sum_before(thread, ready);
        ready_before += sums[GROUP - 1u];
        barrier();
        if (block <= block_count) {
            groups[block].first_fire = weight_sum;
            groups[block].first_ready = ready_sum;
            groups[block].weight = weight;
        }
    }
    float fraction = min(1.0, float(weight_before) / (FRACTION_FOR_ALL * float(constants.vertex_count)));
    uint fire = uint(float(constants.fire_pool) * fraction);
    uint smoke = uint(float(constants.smoke_pool) * fraction);
    for (uint block = thread; block <= block_count; block += GROUP) {
        uint before = groups[block].first_fire;
        groups[block].first_fire = first_of(fire, before, weight_before);
        groups[block].first_smoke = first_of(smoke, before, weight_before);
    }
    if (thread == 0u) {
        clock.fire_particles = 0u;
        clock.smoke_particles = 0u;
    }
}
