#version 450

// Where what the mesh loses comes down: below the vertices that melt, by how far they sink in the tick.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
#include "burning/puddle.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 9, std430) readonly buffer OldState {
    VertexState old_state[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 72, std430) buffer Films {
    Film film;
};

layout(set = 0, binding = 73, std430) buffer Melted {
    uint melted[];
};

const float STEPS_A_DIAGONAL = 65536.0;
const float MOST_STEPS = 256.0;

void main() {
    uint vertex = element_visited();
    if (vertex >= constants.vertex_count) {
        return;
    }
    if (labels[vertex] < READY || alive[vertex] == 0u) {
        return;
    }
    vec3 position = new_state[vertex].position;
    float sunk = clamp((old_state[vertex].position.y - position.y) * STEPS_A_DIAGONAL, 0.0, MOST_STEPS);
    // What folds without sinking counts a little.
    uint weight = 1u + uint(sunk);
    atomicAdd(melted[cell_below(position)], weight);
    atomicAdd(film.weight, weight);
}
