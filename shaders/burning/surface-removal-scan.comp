#version 450

#pragma variants TRIANGLES=whole,refined

// Second phase: one workgroup makes of the counts the index of each run's first triangle, and writes what the
// draw reads. A thread adds up a run of counts, at most 8,192 where a storage buffer holds 128 MiB, by itself, so that
// no number of triangles comes near the 65,535 iterations after which lavapipe ends the loops of a shader. Of triangles that
// are not refined the stream stays as it is until another one is removed.

layout(local_size_x = 256) in;

#include "burning/constants.glsl"
#include "burning/clock.glsl"
#include "burning/compacted.glsl"
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
#ifdef TRIANGLES_WHOLE
    bool is_kept = is_compacted(clock.removed_triangles);
    barrier();
    if (thread == 0u) {
        compacted.is_kept = is_kept ? 1u : 0u;
        compacted.removed = clock.removed_triangles + 1u;
    }
    if (is_kept) {
        if (thread == 0u) {
            clock.drawn_triangles = arguments[0] / 3u;
        }
        return;
    }
#endif
    uint run = (groups.count + GROUP - 1u) / GROUP;
    uint first = min(thread * run, groups.count);
    uint end = min(first + run, groups.count);
    uint own = 0u;
    for (uint group = first; group < end; group++) {
        own += group_sums[group];
    }
    uint before = sum_before(thread, own);
    for (uint group = first; group < end; group++) {
        uint value = group_sums[group];
        group_sums[group] = before;
        before += value;
    }
    if (thread == 0u) {
        uint drawn = sums[GROUP - 1u];
        clock.drawn_triangles = drawn;
        arguments[0] = 3u * drawn;
        arguments[1] = 1u;
        arguments[2] = 0u;
        arguments[3] = 0u;
        arguments[4] = 0u;
    }
}
