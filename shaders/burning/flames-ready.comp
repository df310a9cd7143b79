#version 450

// Lists the vertices that flames can rise from, block by block. Their order within a block varies from run to run; what
// is made of the list does not depend on it. Of a block with very many a random half of LISTED or so is listed: the list
// is searched at each birth, and lavapipe ends the loops of a shader after 65,535 iterations.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/chunks.glsl"
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

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
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

// Ready vertices of a block that are all listed.
const uint LISTED = 8192u;

bool is_chosen(uint vertex, uint block) {
    uint count = groups[block + 1u].first_ready - groups[block].first_ready;
    if (count <= LISTED) {
        return true;
    }
    uint share = 0xffffffffu / count * (LISTED / 2u); // of 2^32
    return hash(uvec3(constants.seed, clock.tick, vertex)).z < share;
}

void main() {
    uint vertex = element_visited();
    if (vertex >= constants.vertex_count) {
        return;
    }
    if (labels[vertex] == READY && new_state[vertex].left > 0.0 && alive[vertex] == 1u) {
        uint block = cells[vertex];
        if (is_chosen(vertex, block)) {
            ready[groups[block].first_ready + atomicAdd(listed[block], 1u)] = vertex;
        }
    }
}
