#version 450

// The areas of the heat boundary (3.3), and whether a chunk has burnt out.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/areas.glsl"
#include "burning/chunks.glsl"
#include "burning/flammability.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    RestVertex rest[];
};

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[];
};

layout(set = 0, binding = 11, std430) buffer Labels {
    uint labels[];
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
    uint vertex = element_visited();
    if (vertex < constants.vertex_count) {
        float flammability = flammability_of(vertex);
        // What does not burn is heated alone.
        uint innermost = flammability > 0.0 ? DEFORMED : INITIAL;
        uint label = min(area_of(rest[vertex].boundary_distance, clock.radius), innermost);
        labels[vertex] = label;
        if (flammability > 0.0) {
            // Before it is deformed nothing of it has burnt.
            if (label != DEFORMED || old_state[vertex].left > constants.retire_at * flammability) {
                atomicAdd(open_count, 1u);
                if (label == DEFORMED && alive[vertex] == 1u) {
                    atomicAdd(active_count, 1u);
                }
            }
        }
    }
    barrier();
    uint chunk = chunk_visited();
    if (gl_LocalInvocationID.x == 0u && chunk != NONE) {
        // Its last change is copied to the other state in this tick.
        finished[chunk] = open_count == 0u ? 1u : 0u;
        if (active_count > 0u) {
            atomicAdd(clock.active_vertices, active_count);
        }
    }
}
