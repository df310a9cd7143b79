#version 450

// The areas of the heat boundary (3.3; with the virtual one of 4.3). R knows the irregularity already: inside is R <= r
// + offset.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
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

shared uint active_count;

uint area_of(float distance_to_boundary) {
    float r = clock.radius;
    float width = constants.area_width;
    if (distance_to_boundary <= r - 2.0 * width) {
        return DEFORMED;
    }
    if (distance_to_boundary <= r - width) {
        return READY;
    }
    if (distance_to_boundary <= r) {
        return INITIAL;
    }
    // Chapter 3 has no virtual area; nothing of it reads this label.
    return distance_to_boundary <= r + 2.0 * width ? VIRTUAL : OUTSIDE;
}

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        active_count = 0u;
    }
    barrier();
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex < constants.vertex_count) {
        // What does not burn is heated alone.
        uint innermost = flammability_of(vertex) > 0.0 ? DEFORMED : INITIAL;
        uint label = min(area_of(rest[vertex].boundary_distance), innermost);
        labels[vertex] = label;
        if (label == DEFORMED && old_state[vertex].left > constants.retire_at * flammability_of(vertex) && alive[vertex] == 1u) {
            atomicAdd(active_count, 1u);
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u && active_count > 0u) {
        atomicAdd(clock.active_vertices, active_count);
    }
}
