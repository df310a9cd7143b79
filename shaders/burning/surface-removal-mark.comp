#version 450

#pragma variants OBJECT=free,parts

// What is consumed leaves the stream for good (3.5.4). Where parts fall it leaves ash on the ground below it, and so do parts
// beyond the most.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/chunks.glsl"
#include "burning/consumed.glsl"
#include "burning/posed.glsl"
#include "burning/ash.glsl"

layout(set = 0, binding = 13, std430) buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 113, std430) buffer Touched {
    uint touched[]; // last tick at which a triangle of the vertex changed
};

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
    bool is_leaving = is_consumed(triangle);
#ifdef OBJECT_PARTS
    is_leaving = is_leaving || part_of[triangles[3u * triangle]] == DUST;
#endif
    if (!is_leaving) {
        return;
    }
    removed[triangle] = 1u;
    for (uint corner = 0u; corner < 3u; corner++) {
        touched[triangles[3u * triangle + corner]] = clock.tick;
    }
#ifdef OBJECT_PARTS
    leave_ash(uvec3(triangles[3u * triangle], triangles[3u * triangle + 1u], triangles[3u * triangle + 2u]));
#endif
    atomicAdd(clock.removed_triangles, 1u);
}
