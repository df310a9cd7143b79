#version 450

// The triangles that each run of nodes draws.

layout(local_size_x = 64) in;

#include "burning/refined-leaves.glsl"

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

void main() {
    uint run = gl_GlobalInvocationID.x;
    uint nodes = constants.tree.y * nodes_above(constants.tree.x + 1u);
    if (run * RUN >= nodes) {
        return;
    }
    uint sum = 0u;
    for (uint node = run * RUN; node < min(run * RUN + RUN, nodes); node++) {
        sum += leaf_of(node).triangles;
    }
    group_sums[run] = sum;
}
