#version 450

// Another sweep of the folding over what melts while it sets: ours. Within the time in which wax comes to rest one step a
// tick does not bring long edges into range.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
#include "burning/clock.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 3, std430) readonly buffer IncidenceOffsets {
    uint incidence_offsets[];
};

layout(set = 0, binding = 4, std430) readonly buffer Incidence {
    uint incidence[]; // triangle * 4 + corner, ascending
};

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[]; // before the sweep
};

layout(set = 0, binding = 10, std430) buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 52, std430) readonly buffer Flows {
    vec4 flows[]; // w is 1 where the vertex keeps its place
};

#include "burning/folding.glsl"

void main() {
    uint vertex = element_visited();
    if (vertex >= constants.vertex_count) {
        return;
    }
    VertexState state = old_state[vertex];
    bool flows_on = labels[vertex] >= READY && alive[vertex] != 0u && flows[vertex].w == 0.0;
    if (flows_on && is_setting()) {
        state.position += warmth() * folding(vertex, state.position);
        state.position.y = max(state.position.y, constants.floor_y);
    }
    new_state[vertex] = state;
}
