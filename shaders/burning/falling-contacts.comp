#version 450

#pragma variants STEP=heights,vertices

// The contacts of the parts: first their heights, then the vertices that have them. A step of a height more may be the
// same vertex, rounded otherwise.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parts.glsl"
#include "burning/contacts.glsl"
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

layout(set = 0, binding = 65, std430) readonly buffer PartOf {
    uint part_of[];
};

layout(set = 0, binding = 66, std430) readonly buffer Parts {
    Part parts[];
};

#include "burning/met.glsl"

layout(set = 0, binding = 70, std430) coherent buffer Contacts {
    int contacts[];
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count) {
        return;
    }
    uint part = part_of[vertex];
    if (part >= MOST_PARTS) {
        return;
    }
    uint block = cells[vertex];
    vec3 place = bent(vertex, rotated_with_block(new_state[vertex].position, block, new_rotations[block].xyz));
    vec3 position = turned(parts[part].orientation, place) + parts[part].offset;
    uint at = part * WORDS;
#ifdef STEP_HEIGHTS
    if (position.y <= constants.floor_y + NEAR_GROUND) {
        for (uint k = 0u; k < DIRECTIONS; k++) {
            int reach = steps_of(dot(direction(k), position.xz));
            if (reach > contacts[at + k]) {
                atomicMax(contacts[at + k], reach);
            }
        }
    }
#endif
    if (parts[part].rests != 0.0) {
        return;
    }
    Meeting meeting = meeting_of(part, position);
    if (meeting.vertex != NONE) {
        uint octant = octant_of(meeting.toward);
        int gap = steps_of(meeting.gap);
#ifdef STEP_HEIGHTS
        atomicMin(contacts[at + GAPS + octant], gap);
#else
        if (gap <= contacts[at + GAPS + octant] + 1) {
            atomicMin(contacts[at + GAPS + MEETINGS + octant], int(vertex));
        }
#endif
    }
    for (uint k = 0u; k < CONTACTS; k++) {
        int height = height_over(position, k);
#ifdef STEP_HEIGHTS
        if (height < contacts[at + DIRECTIONS + k]) {
            atomicMin(contacts[at + DIRECTIONS + k], height);
        }
#else
        if (height <= contacts[at + DIRECTIONS + k] + 1) {
            atomicMin(contacts[at + DIRECTIONS + CONTACTS + k], int(vertex));
        }
#endif
    }
}
