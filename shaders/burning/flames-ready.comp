#version 450

// Lists the vertices that flames can rise from, block by block. Their order within a block varies from run to run; what
// is made of the list does not depend on it.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/flames.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 40, std430) readonly buffer Groups {
    Group groups[];
};

layout(set = 0, binding = 41, std430) buffer Listed {
    uint listed[];
};

layout(set = 0, binding = 42, std430) buffer Ready {
    uint ready[];
};

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= constants.vertex_count) {
        return;
    }
    if (labels[vertex] == READY && new_state[vertex].left > 0.0 && alive[vertex] == 1u) {
        uint block = cells[vertex];
        ready[groups[block].first_ready + atomicAdd(listed[block], 1u)] = vertex;
    }
}
