#version 450

// The triangles that each run of nodes draws.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/refined-leaves.glsl"

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

void main() {
    uint run = element(64u);
    if (run * RUN >= constants.coarse_count * nodes_above(constants.levels + 1u)) {
        return;
    }
    uint sum = 0u;
    for (uint used = used_nodes(run); used != 0u; used &= used - 1u) {
        sum += leaf_of(run * RUN + uint(findLSB(used))).triangles;
    }
    group_sums[run] = sum;
}
