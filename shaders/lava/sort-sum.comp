#version 450

// The sums before each count of a run, in place of the counts, and the sum of each run.

layout(local_size_x = 32) in;

#include "common/elements.glsl"

const uint RUN = 256u;

layout(push_constant, std430) uniform Sum {
    uint first; // of the counts
    uint count;
    uint to; // place of the runs' sums
} sum;

layout(set = 0, binding = 0, std430) buffer Counts {
    uint list[];
} counts;

void main() {
    uint run = element(32u);
    if (run * RUN >= sum.count) {
        return;
    }
    uint end = min((run + 1u) * RUN, sum.count);
    uint before = 0u;
    for (uint at = run * RUN; at < end; at++) {
        uint count = counts.list[sum.first + at];
        counts.list[sum.first + at] = before;
        before += count;
    }
    counts.list[sum.to + run] = before;
}
