#version 450

#pragma variants DIRECTION=placed,random

// The weight of a block is the number of its live vertices (3.5.1). A vertex that is consumed or goes to another block
// unbalances the block that it was in; the direction follows from its position about the block's midpoint (3.5.2),
// or is random, which 3.5.1 finds adequate for games.
// Integer sums, so that the order of threads cannot matter.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
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

shared uint live_count;
shared uint ready_count;

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        live_count = 0u;
        ready_count = 0u;
    }
    barrier();
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex < constants.vertex_count) {
        VertexState now = new_state[vertex];
        uint label = labels[vertex];
        uint old_cell = cells[vertex];
        uint cell = cell_of(now.position);
        cells[vertex] = cell;
        if (alive[vertex] == 1u) {
            bool is_live = now.left > 0.0;
            if (is_live) {
                atomicAdd(live_count, 1u);
                atomicAdd(blocks[cell].live, 1);
                if (label == READY) {
                    atomicAdd(ready_count, 1u);
                    atomicAdd(blocks[cell].ready, 1);
                }
            }
            if (label >= READY) {
                atomicAdd(blocks[cell].heated, 1);
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
        atomicAdd(clock.live_vertices, live_count);
        atomicAdd(clock.ready_vertices, ready_count);
    }
}
