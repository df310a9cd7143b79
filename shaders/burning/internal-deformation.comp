#version 450

// Internal deformation (3.4) of `shell`, `low-poly` and `fully-subdivided`: one thread a vertex reads the last tick's
// positions through its incidence list and takes the mean of what its triangles ask for, so that the order of threads
// cannot matter.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
#include "burning/block-levels.glsl"
#include "burning/displacement.glsl"
#include "burning/flammability.glsl"
#include "burning/meltability.glsl"
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
    VertexState old_state[];
};

layout(set = 0, binding = 10, std430) buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 11, std430) readonly buffer Labels {
    uint labels[];
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[];
};

layout(set = 0, binding = 83, std430) readonly buffer RestCells {
    uint rest_cells[];
};

layout(push_constant, std430) uniform Slice {
    uint number; // of the slices of a tick (3.7.2): each takes its turn of the chunks
    uint division;
} slice;

void main() {
    uint vertex = element_visited();
    if (workgroup() % slice.division != slice.number || vertex >= constants.vertex_count) {
        return;
    }
    VertexState before = old_state[vertex];
    if (labels[vertex] != DEFORMED || before.left <= 0.0 || alive[vertex] == 0u) {
        new_state[vertex] = before;
        return;
    }
    vec3 b = before.position;
    float flammability = flammability_of(vertex);
    float left_fraction = before.left / flammability;
    BlockLevels block = block_levels[rest_cells[vertex]];
    vec3 sum = vec3(0.0);
    float epsilons = 0.0;
    uint from = incidence_offsets[vertex];
    uint to = incidence_offsets[vertex + 1u];
    for (uint i = from; i < to; i++) {
        uint triangle = incidence[i] / 4u;
        uint corner = incidence[i] % 4u;
        uint vertex_a = triangles[3u * triangle + (corner + 2u) % 3u];
        uint vertex_c = triangles[3u * triangle + (corner + 1u) % 3u];
        vec3 a = old_state[vertex_a].position;
        vec3 c = old_state[vertex_c].position;
        float l = fraction_along(block, length(a - b), labels[vertex_a] >= INITIAL, left_fraction);
        float m = fraction_along(block, length(c - b), labels[vertex_c] >= INITIAL, left_fraction);
        sum += cevians_meet(a, b, c, l, m) - b;
        epsilons += meltabilities_at(triangle, corner);
    }
    vec3 moved = b + sum / float(max(to - from, 1u));
    float fall = constants.gravity_per_tick * epsilons / float(max(2u * (to - from), 1u));
    moved.y -= fall; // gravity
    new_state[vertex] = VertexState(moved, before.left - 1.0);
}
