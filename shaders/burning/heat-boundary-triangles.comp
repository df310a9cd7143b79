#version 450

// A triangle belongs to the innermost area that one of its vertices has reached (3.3).

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/flammability.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 12, std430) buffer TriangleLabels {
    uint triangle_labels[];
};

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

shared uint active_count;

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        active_count = 0u;
    }
    barrier();
    uint triangle = gl_GlobalInvocationID.x;
    if (triangle < constants.triangle_count) {
        uint highest = OUTSIDE;
        bool is_active = false;
        for (uint corner = 0u; corner < 3u; corner++) {
            uint vertex = triangles[3u * triangle + corner];
            uint label = labels[vertex];
            highest = max(highest, label);
            if (label == DEFORMED && old_state[vertex].left > constants.retire_at * flammability_of(vertex) && alive[vertex] == 1u) {
                is_active = true;
            }
        }
        triangle_labels[triangle] = highest;
        if (is_active) {
            atomicAdd(active_count, 1u);
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u && active_count > 0u) {
        atomicAdd(clock.active_triangles, active_count);
    }
}
