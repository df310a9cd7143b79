#version 450

// The areas of the heat boundary (3.3; with the virtual one of 4.3). R knows the irregularity already: inside is R <= r + offset.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"

layout(set = 0, binding = 1, std430) readonly buffer Rest {
    vec4 rest[]; // xyz, R
};

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    vec4 old_state[]; // position, L left
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
    float width = constants.boundary.y;
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
    if (vertex < constants.counts.x) {
        uint label = area_of(rest[vertex].w);
        labels[vertex] = label;
        if (label == DEFORMED && old_state[vertex].w > constants.solid.y && alive[vertex] == 1u) {
            atomicAdd(active_count, 1u);
        }
    }
    barrier();
    if (gl_LocalInvocationID.x == 0u && active_count > 0u) {
        atomicAdd(clock.active_vertices, active_count);
    }
}
