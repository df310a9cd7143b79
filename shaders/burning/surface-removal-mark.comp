#version 450

#pragma variants OBJECT=kept,free,parts

// A triangle is consumed when nothing is left at its three vertices that burns (3.5.4); it leaves the stream for good, unless parts
// are kept and its block is needed: some neighbour with weight has no other neighbour with weight, and would come off.
// Where parts fall, none is kept; what is consumed leaves ash on the ground below it, and so do parts beyond the most.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/chunks.glsl"
#include "burning/flammability.glsl"
#include "burning/grid.glsl"
#include "burning/blocks.glsl"
#include "burning/vertices.glsl"
#include "burning/posed.glsl"
#include "burning/ash.glsl"

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

#ifdef OBJECT_KEPT
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

#ifdef OBJECT_PARTS
layout(set = 0, binding = 71, std430) buffer Ash {
    uint ash[];
};

void leave_ash(uvec3 at) {
    vec3 sum = vec3(0.0);
    for (uint corner = 0u; corner < 3u; corner++) {
        sum += posed(at[corner], new_state[at[corner]].position);
    }
    ivec2 cell = ivec2(floor(ash_coordinates(sum.xz / 3.0)));
    if (all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(ASH_CELLS)))) {
        atomicAdd(ash[cell.y * ASH_CELLS + cell.x], 1u);
    }
}
#endif

void main() {
    uint triangle = element_visited();
    if (triangle >= constants.triangle_count) {
        return;
    }
    if (removed[triangle] == 1u) {
        return;
    }
    uvec3 at = uvec3(triangles[3u * triangle], triangles[3u * triangle + 1u], triangles[3u * triangle + 2u]);
    bool is_burnt = false;
    bool is_consumed = true;
    for (uint corner = 0u; corner < 3u; corner++) {
        bool is_spent = new_state[at[corner]].left <= 0.0;
        is_burnt = is_burnt || is_spent;
        is_consumed = is_consumed && (is_spent || flammability_of(at[corner]) <= 0.0);
    }
    is_consumed = is_consumed && is_burnt;
#ifdef OBJECT_PARTS
    is_consumed = is_consumed || part_of[at.x] == DUST;
#endif
    if (!is_consumed) {
        return;
    }
#ifdef OBJECT_KEPT
    if (is_needed(cells[at.x])) {
        return;
    }
#endif
    removed[triangle] = 1u;
#ifdef OBJECT_PARTS
    leave_ash(at);
#endif
    atomicAdd(clock.removed_triangles, 1u);
}
