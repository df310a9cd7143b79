#version 450

// Every vertex directly below its root.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/parting.glsl"
#include "burning/roots.glsl"

layout(set = 0, binding = 63, std430) buffer Searching {
    Progress progress;
};

void main() {
    uint vertex = element(64u);
    if (vertex >= constants.vertex_count) {
        return;
    }
    atomicMin(roots[vertex], root_of(vertex));
    if (vertex == 0u) {
        progress.is_unsettled = 0u;
    }
}
