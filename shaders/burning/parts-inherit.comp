#version 450

// A part goes on as the part did that its root belonged to: parts split and never join.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"
#include "burning/parts.glsl"
#include "burning/bent.glsl"
#include "burning/rotation.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) readonly buffer Attached {
    uint attached[];
};

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 64, std430) readonly buffer Numbers {
    uint numbers[];
};

layout(set = 0, binding = 65, std430) readonly buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 66, std430) readonly buffer Parts {
    Part parts[];
};

layout(set = 0, binding = 67, std430) buffer Inherited {
    Part inherited[];
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count || progress.is_numbered == 0u) {
        return;
    }
    if (roots[vertex] != vertex || (attached[vertex] & 2u) == 0u || numbers[vertex] >= MOST_PARTS) {
        return;
    }
    uint block = cells[vertex];
    vec3 place = bent(vertex, rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz));
    Part part = Part(vec4(0.0, 0.0, 0.0, 1.0), vec3(0.0), 1.0, vec3(0.0), 0.0, vec3(0.0), 0.0, place, 0.0, place, 0.0);
    uint before = part_of[vertex];
    if (before < MOST_PARTS) {
        part = parts[before];
        part.anchor = place;
    }
    inherited[numbers[vertex]] = part;
}
