#version 450

// Third phase: each drawn triangle's corners to their offset in the stream, in their old order.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/scan.glsl"

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
    uint group_sums[];
};

void main() {
    uint triangle = gl_GlobalInvocationID.x;
    uint is_drawn = 0u;
    if (triangle < constants.triangle_count) {
        is_drawn = 1u - removed[triangle];
    }
    uint index = sum_before(gl_LocalInvocationID.x, is_drawn);
    if (is_drawn == 1u) {
        index += group_sums[gl_WorkGroupID.x];
        for (uint corner = 0u; corner < 3u; corner++) {
            stream[3u * index + corner] = corners[3u * triangle + corner];
        }
    }
}
