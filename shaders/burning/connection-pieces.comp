#version 450

// Into how many pieces each part of the mesh falls without the triangles that the search of what hangs together does without.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) readonly buffer Attached {
    uint attached[]; // 2 of the root of vertices with a triangle that the search went by
};

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 99, std430) buffer Pieces {
    uint pieces[];
};

layout(set = 0, binding = 100, std430) readonly buffer Origins {
    uint origins[]; // the lowest vertex that each hangs together with at rest
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count || progress.is_unsettled != 0u) {
        return;
    }
    if (roots[vertex] == vertex && (attached[vertex] & 2u) != 0u) {
        atomicAdd(pieces[origins[vertex]], 1u);
    }
}
