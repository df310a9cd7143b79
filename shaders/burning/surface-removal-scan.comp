#version 450

// Second phase: one workgroup makes of the counts the index of each workgroup's first triangle, and writes what the
// draw reads.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/scan.glsl"

layout(set = 0, binding = 18, std430) buffer Clock {
    Counts clock;
};

layout(set = 0, binding = 23, std430) buffer Arguments {
    uint arguments[]; // indices, instances, first index, vertex offset, first instance
};

layout(set = 0, binding = 29, std430) buffer GroupSums {
    uint group_sums[];
};

layout(push_constant, std430) uniform Groups {
    uint count;
} groups;

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint before = 0u;
    for (uint base = 0u; base < groups.count; base += GROUP) {
        uint group = base + thread;
        uint value = 0u;
        if (group < groups.count) {
            value = group_sums[group];
        }
        uint first = before + sum_before(thread, value);
        if (group < groups.count) {
            group_sums[group] = first;
        }
        before += sums[GROUP - 1u];
        barrier();
    }
    if (thread == 0u) {
        clock.drawn_triangles = before;
        arguments[0] = 3u * before;
        arguments[1] = 1u;
        arguments[2] = 0u;
        arguments[3] = 0u;
        arguments[4] = 0u;
    }
}
