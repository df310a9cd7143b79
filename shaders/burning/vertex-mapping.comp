#version 450

#pragma variants OBJECT=whole,parts

// Each vertex rotated with its block about the block's midpoint, just before it is drawn (3.5.3); the simulated
// position stays. Where parts fall, each goes on with its own.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/flammability.glsl"
#include "burning/rotation.glsl"
#include "burning/vertices.glsl"
#include "burning/posed.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 19, std430) buffer Mapped {
    MappedVertex mapped[];
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count) {
        return;
    }
    VertexState now = new_state[vertex];
    uint block = cells[vertex];
    vec3 position = rotated_with_block(now.position, block, new_rotations[block].xyz);
#ifdef OBJECT_PARTS
    position = posed(vertex, position);
#endif
    mapped[vertex] = MappedVertex(position, now.left / max(flammability_of(vertex), 1.0));
}
