#version 450

#pragma variants ORDER=own,cached

// First phase of the compaction: how many triangles of each run are drawn.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/clock.glsl"
#include "burning/compacted.glsl"
#include "burning/constants.glsl"
#include "burning/runs.glsl"
#include "burning/order-{ORDER}.glsl"

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 18, std430) readonly buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

void main() {
    uint run = element(64u);
    if (run * RUN >= constants.triangle_count || is_compacted(clock.removed_triangles)) {
        return;
    }
    uint sum = 0u;
    for (uint i = 0u; i < RUN; i++) {
        uint place = run * RUN + i;
        if (place < constants.triangle_count) {
            sum += 1u - removed[drawn_triangle(place)];
        }
    }
    group_sums[run] = sum;
}
