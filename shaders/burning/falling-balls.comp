#version 450

// The vertices of the parts, for others to meet.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parts.glsl"
#include "burning/meeting.glsl"
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

layout(set = 0, binding = 76, std430) buffer Balls {
    uint balls[];
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
    uint layer = parts[part].rests != 0.0 ? 0u : 1u + part % 2u;
    ivec3 cell = cell_at(position);
    atomicMin(balls[entry_of(layer, cell)], vertex);
    atomicMin(balls[entry_of(LOWEST_PART, cell >> LARGER)], part);
    atomicMin(balls[entry_of(HIGHEST_PART, cell >> LARGER)], ~part);
}
