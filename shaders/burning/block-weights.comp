#version 450

// The weight of a block is the number of its live vertices (3.5.1). A vertex that is consumed or goes to another block unbalances the
// block that it was in; the direction follows from its place about the block's midpoint (3.5.2). Integer sums, so that the order of
// threads cannot matter.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/grid.glsl"

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    vec4 old_state[]; // position, L left
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    vec4 new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 14, std430) buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 15, std430) buffer Blocks {
    int blocks[]; // live, ready, signs of pitch, yaw, roll, combustion counter, inside the ready boundary, last tick with active ones
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
    if (vertex < constants.counts.x) {
        vec4 now = new_state[vertex];
        uint label = labels[vertex];
        uint old_cell = cells[vertex];
        uint cell = cell_of(now.xyz);
        cells[vertex] = cell;
        if (alive[vertex] == 1u) {
            bool is_live = now.w > 0.0;
            if (is_live) {
                atomicAdd(live_count, 1u);
                atomicAdd(blocks[8u * cell], 1);
                if (label == READY) {
                    atomicAdd(ready_count, 1u);
                    atomicAdd(blocks[8u * cell + 1u], 1);
                }
            }
            if (label >= READY) {
                atomicAdd(blocks[8u * cell + 6u], 1);
            }
            // The combustion counter of a block goes up once in each tick with active vertices (5.4).
            if (label == DEFORMED && old_state[vertex].w > constants.solid.y) {
                int tick = int(clock.tick);
                if (atomicMax(blocks[8u * cell + 7u], tick) < tick) {
                    atomicAdd(blocks[8u * cell + 5u], 1);
                }
            }
            bool is_consumed = old_state[vertex].w > 0.0 && !is_live;
            if (label >= INITIAL && (is_consumed || (is_live && cell != old_cell))) {
                vec3 offset = now.xyz - midpoint_of(old_cell);
                ivec3 signs = ivec3(sign(vec3(-offset.z, offset.y, offset.x)));
                atomicAdd(blocks[8u * old_cell + 2u], signs.x);
                atomicAdd(blocks[8u * old_cell + 3u], signs.y);
                atomicAdd(blocks[8u * old_cell + 4u], signs.z);
            }
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u) {
        atomicAdd(clock.live_vertices, live_count);
        atomicAdd(clock.ready_vertices, ready_count);
    }
}
