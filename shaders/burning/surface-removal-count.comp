#version 450

// First phase of the compaction: how many triangles of each workgroup are drawn.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/scan.glsl"

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[];
};

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    uint is_drawn = 0u;
    if (triangle < constants.triangle_count) {
        is_drawn = 1u - removed[triangle];
    }
    uint thread = gl_LocalInvocationID.x;
    sum_before(thread, is_drawn);
    if (thread == 0u) {
        group_sums[gl_WorkGroupID.x] = sums[GROUP - 1u];
    }
}
