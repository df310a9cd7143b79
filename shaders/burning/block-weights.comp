#version 450

#pragma variants DIRECTION=placed,random

// The weight of a block is the number of its live vertices (3.5.1). A vertex that is consumed or goes to another block
// unbalances the block that it was in; the direction follows from its position about the block's midpoint (3.5.2),
// or is random, which 3.5.1 finds adequate for games.
// What a vertex amounts to is kept, and its block's counts change by what that does: vertices that the tick cannot have
// changed are not visited. Integer sums, so that the order of threads cannot matter.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/chunks.glsl"
#include "burning/flammability.glsl"
#include "burning/grid.glsl"
#include "burning/blocks.glsl"
#include "burning/hash.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 14, std430) buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 15, std430) buffer Blocks {
    Block blocks[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 95, std430) buffer Counted {
    uint counted[]; // of vertices: the block that they count in times 8, and as what
};

// What a vertex counts as.
const uint LIVE = 1u;
const uint LIVE_READY = 2u;
const uint HEATED = 4u;

shared int live_change;
shared int ready_change;

void count(uint word, int change) {
    uint block = word / 8u;
    if ((word & LIVE) != 0u) {
        atomicAdd(live_change, change);
        atomicAdd(blocks[block].live, change);
    }
    if ((word & LIVE_READY) != 0u) {
        atomicAdd(ready_change, change);
        atomicAdd(blocks[block].ready, change);
    }
    if ((word & HEATED) != 0u) {
        atomicAdd(blocks[block].heated, change);
    }
}

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        live_change = 0;
        ready_change = 0;
    }
    barrier();
    uint vertex = element_visited();
    if (vertex < constants.vertex_count) {
        VertexState now = new_state[vertex];
        uint label = labels[vertex];
        uint old_cell = cells[vertex];
        uint cell = cell_of(now.position);
        cells[vertex] = cell;
        if (alive[vertex] == 1u) {
            bool is_live = now.left > 0.0;
            uint word = 8u * cell + (is_live ? LIVE : 0u);
            word += is_live && label == READY ? LIVE_READY : 0u;
            word += label >= READY ? HEATED : 0u;
            uint before = counted[vertex];
            if (word != before) {
                count(before, -1);
                count(word, 1);
                counted[vertex] = word;
            }
            // The combustion counter of a block goes up once in each tick with active vertices (5.4).
            if (label == DEFORMED && old_state[vertex].left > constants.retire_at * flammability_of(vertex)) {
                int tick = int(clock.tick);
                if (atomicMax(blocks[cell].last_active_tick, tick) < tick) {
                    atomicAdd(blocks[cell].combustion, 1);
                }
            }
            bool is_consumed = old_state[vertex].left > 0.0 && !is_live;
            if (label >= INITIAL && (is_consumed || (is_live && cell != old_cell))) {
#ifdef DIRECTION_RANDOM
                uvec3 random = hash(uvec3(constants.seed, vertex, clock.tick));
                ivec3 signs = 2 * ivec3(random >> 31u) - 1;
#else
                vec3 offset = now.position - midpoint_of(old_cell);
                ivec3 signs = ivec3(sign(vec3(-offset.z, offset.y, offset.x)));
#endif
                atomicAdd(blocks[old_cell].pitch_sign, signs.x);
                atomicAdd(blocks[old_cell].yaw_sign, signs.y);
                atomicAdd(blocks[old_cell].roll_sign, signs.z);
            }
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u) {
        atomicAdd(clock.live_vertices, uint(live_change));
        atomicAdd(clock.ready_vertices, uint(ready_change));
    }
}
