#version 450

#pragma variants ORDER=own,cached

// Third phase: each drawn triangle's corners to their offset in the stream, in their order.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/compacted.glsl"
#include "burning/constants.glsl"
#include "burning/runs.glsl"
#include "burning/order-{ORDER}.glsl"

layout(set = 0, binding = 5, std430) readonly buffer Corners {
    uint corners[];
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 22, std430) buffer Stream {
    uint stream[];
};

layout(set = 0, binding = 29, std430) readonly buffer GroupSums {
    uint group_sums[]; // triangles drawn before each run
};

void main() {
    uint run = element(64u);
    if (run * RUN >= constants.triangle_count || compacted.is_kept == 1u) {
        return;
    }
    uint at = group_sums[run];
    for (uint i = 0u; i < RUN; i++) {
        uint place = run * RUN + i;
        if (place < constants.triangle_count) {
            uint triangle = drawn_triangle(place);
            if (removed[triangle] == 0u) {
                for (uint corner = 0u; corner < 3u; corner++) {
                    stream[3u * at + corner] = corners[3u * triangle + corner];
                }
                at++;
            }
        }
    }
}
