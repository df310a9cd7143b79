#version 450

// What the parts meet, by the meetings that were found: one thread each, before parts move. Whether they do so in the
// next tick is not known yet.

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

layout(set = 0, binding = 70, std430) readonly buffer Contacts {
    int contacts[];
};

layout(set = 0, binding = 77, std430) buffer Met {
    Obstacle met[];
};

layout(set = 0, binding = 97, std430) buffer Moving {
    uint moving[3];
};

void main() {
    uint thread = element(64u);
    if (thread == 0u) {
        moving[0] = 0u;
    }
    // By as many threads as there are, as in falling-clear.comp.
    uint stride = 64u * gl_NumWorkGroups.x * gl_NumWorkGroups.y;
    for (uint i = thread; i < MOST_PARTS * MEETINGS; i += stride) {
        uint part = i / MEETINGS;
        int vertex = contacts[part * WORDS + GAPS + MEETINGS + i % MEETINGS];
        if (vertex != FARTHEST) {
            Meeting meeting = meeting_of(part, position_of(uint(vertex)));
            Part other = parts[min(part_of[meeting.vertex], MOST_PARTS - 1u)];
            vec3 center = turned(other.orientation, other.center) + other.offset;
            vec3 velocity = other.velocity + cross(other.spin, position_of(meeting.vertex) - center);
            met[i] = Obstacle(meeting.toward, meeting.gap, velocity);
        }
    }
}
