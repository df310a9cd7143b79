#version 450

#pragma variants OBJECT=whole,parts

// Each vertex rotated with its block about the block's midpoint, just before it is drawn (3.5.3); the simulated
// position stays. Where parts fall, each goes on with its own. A vertex that has moved since the last picture touches all
// of its triangles: the normals at their corners change.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/flammability.glsl"
#include "burning/rotation.glsl"
#include "burning/shown.glsl"
#include "burning/vertices.glsl"
#include "burning/posed.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 3, std430) readonly buffer IncidenceOffsets {
    uint incidence_offsets[];
};

layout(set = 0, binding = 4, std430) readonly buffer Incidence {
    uint incidence[]; // triangle * 4 + corner
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 19, std430) buffer Mapped {
    MappedVertex mapped[];
};

layout(set = 0, binding = 113, std430) buffer Touched {
    uint touched[]; // last tick at which a triangle of the vertex changed
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
    // Gravity and the turn of blocks know no ground.
    position.y = max(position.y, constants.ground_y);
    bool has_moved = shown.since == 0u || position != mapped[vertex].position;
    mapped[vertex] = MappedVertex(position, now.left / max(flammability_of(vertex), 1.0));
    uint from = incidence_offsets[vertex];
    uint to = has_moved ? incidence_offsets[vertex + 1u] : from;
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        // Whoever touches a vertex writes the same.
        for (uint corner = 0u; corner < 3u; corner++) {
            touched[triangles[3u * triangle + corner]] = clock.tick;
        }
    }
}
