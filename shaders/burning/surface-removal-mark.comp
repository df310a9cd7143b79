#version 450

#pragma variants PARTS=kept,free

// A triangle is consumed when nothing is left at its three vertices (3.5.4); it leaves the stream for good, unless parts
// are kept and its block is needed: some neighbour with weight has no other neighbour with weight, and would come off.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/grid.glsl"
#include "burning/blocks.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 13, std430) buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

#ifdef PARTS_KEPT
layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 15, std430) readonly buffer Blocks {
    Block blocks[];
};

bool has_weight(uint block) {
    return block != NONE && blocks[min(block, constants.block_count - 1u)].live > 0;
}

bool is_needed(uint block) {
    for (uint direction = 0u; direction < 6u; direction++) {
        uint neighbour = neighbour_of(block, direction);
        if (has_weight(neighbour)) {
            bool has_other = false;
            for (uint onward = 0u; onward < 6u; onward++) {
                uint other = neighbour_of(neighbour, onward);
                if (other != block && has_weight(other)) {
                    has_other = true;
                }
            }
            if (!has_other) {
                return true;
            }
        }
    }
    return false;
}
#endif

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle >= constants.triangle_count || removed[triangle] == 1u) {
        return;
    }
    uvec3 at = uvec3(triangles[3u * triangle], triangles[3u * triangle + 1u], triangles[3u * triangle + 2u]);
    if (new_state[at.x].left > 0.0 || new_state[at.y].left > 0.0 || new_state[at.z].left > 0.0) {
        return;
    }
#ifdef PARTS_KEPT
    if (is_needed(cells[at.x])) {
        return;
    }
#endif
    removed[triangle] = 1u;
    atomicAdd(clock.removed_triangles, 1u);
}
