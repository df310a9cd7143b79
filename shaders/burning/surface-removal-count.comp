#version 450

// First phase of the compaction: how many triangles of each run are drawn.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/runs.glsl"

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

void main() {
    uint run = element(64u);
    if (run * RUN >= constants.triangle_count) {
        return;
    }
    uint sum = 0u;
    for (uint i = 0u; i < RUN; i++) {
        uint triangle = run * RUN + i;
        if (triangle < constants.triangle_count) {
            sum += 1u - removed[triangle];
        }
    }
    group_sums[run] = sum;
}
