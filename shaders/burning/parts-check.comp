#version 450

// Which vertices have a triangle that is there, which roots such vertices, and whether the search has come to its end. A
// root may have lost its own triangles since the search began.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) buffer Attached {
    uint attached[]; // 1 of a vertex with a triangle that is there, 2 of the root of such vertices
};

layout(set = 0, binding = 63, std430) buffer Searching {
    Progress progress;
};

void main() {
    uint triangle = element(64u);
    if (triangle >= constants.triangle_count || removed[triangle] != 0u) {
        return;
    }
    uint root = roots[triangles[3u * triangle]];
    bool is_settled = roots[root] == root;
    for (uint corner = 0u; corner < 3u; corner++) {
        uint vertex = triangles[3u * triangle + corner];
        atomicOr(attached[vertex], 1u);
        is_settled = is_settled && roots[vertex] == root;
    }
    atomicOr(attached[root], 2u);
    if (!is_settled) {
        progress.is_unsettled = 1u;
    }
}
