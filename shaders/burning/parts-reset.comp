#version 450

// Each vertex a tree of its own, once the parts of the last search have their numbers.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"

layout(set = 0, binding = 60, std430) buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) buffer Attached {
    uint attached[];
};

layout(set = 0, binding = 63, std430) readonly buffer Searching {
    Progress progress;
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count || progress.is_numbered == 0u) {
        return;
    }
    roots[vertex] = vertex;
    attached[vertex] = 0u;
}
