#version 450

// The parts in the order of their roots: one workgroup counts them, a run of vertices a thread. A storage buffer of 128 MiB, as
// lavapipe's are, holds what 4,194,304 vertices have bent: two walks of 16,384 iterations, of the 65,535 that it allows.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/parting.glsl"
#include "burning/scan.glsl"

layout(set = 0, binding = 60, std430) readonly buffer Roots {
    uint roots[];
};

layout(set = 0, binding = 61, std430) readonly buffer Attached {
    uint attached[];
};

layout(set = 0, binding = 63, std430) buffer Searching {
    Progress progress;
};

layout(set = 0, binding = 64, std430) buffer Numbers {
    uint numbers[]; // of the part, at its root
};

uint is_root(uint vertex) {
    return roots[vertex] == vertex && (attached[vertex] & 2u) != 0u ? 1u : 0u;
}

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint vertex_count = constants.vertex_count;
    uint run = (vertex_count + GROUP - 1u) / GROUP;
    uint from = min(thread * run, vertex_count);
    uint to = min(from + run, vertex_count);
    uint own = 0u;
    for (uint vertex = from; vertex < to; vertex++) {
        own += is_root(vertex);
    }
    uint before = sum_before(thread, own);
    for (uint vertex = from; vertex < to; vertex++) {
        numbers[vertex] = before;
        before += is_root(vertex);
    }
    if (thread == 0u) {
        progress.is_numbered = 1u - progress.is_unsettled;
        progress.part_count = progress.is_unsettled == 0u ? sums[GROUP - 1u] : progress.part_count;
    }
}
