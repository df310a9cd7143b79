#version 450

// A triangle belongs to the innermost area that one of its vertices has reached (3.3). A chunk has burnt out when none of
// its triangles can become active any more.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/chunks.glsl"
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

layout(set = 0, binding = 93, std430) buffer Finished {
    uint finished[]; // of chunks
};

shared uint active_count;
shared uint open_count;

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        active_count = 0u;
        open_count = 0u;
    }
    barrier();
    uint triangle = element_visited();
    if (triangle < constants.triangle_count) {
        uint highest = OUTSIDE;
        bool is_active = false;
        bool is_open = false;
        for (uint corner = 0u; corner < 3u; corner++) {
            uint vertex = triangles[3u * triangle + corner];
            uint label = labels[vertex];
            highest = max(highest, label);
            float flammability = flammability_of(vertex);
            if (flammability > 0.0) {
                // Before it is deformed nothing of it has burnt.
                bool burns = label != DEFORMED || old_state[vertex].left > constants.retire_at * flammability;
                is_active = is_active || (burns && label == DEFORMED && alive[vertex] == 1u);
                is_open = is_open || burns;
            }
        }
        triangle_labels[triangle] = highest;
        if (is_active) {
            atomicAdd(active_count, 1u);
        }
        if (is_open) {
            atomicAdd(open_count, 1u);
        }
    }
    barrier();
    uint chunk = chunk_visited();
    if (gl_LocalInvocationID.x == 0u && chunk != NONE) {
        finished[chunk] = open_count == 0u ? 1u : 0u;
        if (active_count > 0u) {
            atomicAdd(clock.active_triangles, active_count);
        }
    }
}
