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

// Place of a corner, cells.
vec2 above(uint vertex) {
    return ash_coordinates(posed(vertex, new_state[vertex].position).xz);
}

// In the middles of the triangles that its own is cut into, in rows of 1, 3, 5 and 7.
void leave_ash(uvec3 at) {
    vec2 a = above(at.x);
    vec2 b = above(at.y);
    vec2 c = above(at.z);
    const float rows = sqrt(float(ASH_PARTS));
    for (uint part = 0u; part < ASH_PARTS; part++) {
        uint row = uint(sqrt(float(part) + 0.5));
        uint place = part - row * row;
        float inward = place % 2u == 0u ? 1.0 / 3.0 : 2.0 / 3.0;
        float from_a = (float(row) + 1.0 - inward) / rows;
        float towards_c = (float(place / 2u) + inward) / rows;
        ivec2 cell = ivec2(floor(a + from_a * (b - a) + towards_c * (c - b)));
        if (all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, ivec2(ASH_CELLS)))) {
            atomicAdd(ash[cell.y * ASH_CELLS + cell.x], 1u);
        }
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
