#version 450

// Every pixel's list is empty, and so are the counts; the most that any frame has counted is kept for the host.

layout(local_size_x = 64) in;

#include "gas/frame.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 11, std430) buffer Counters {
    uint counters[]; // fragments, sections; the most of both in a frame
};

void main() {
    uint pixel = gl_GlobalInvocationID.x;
    if (pixel < frame.counts.x * frame.counts.y) {
        heads[pixel] = NONE;
    }
    if (pixel == 0u) {
        counters[2] = max(counters[2], counters[0]);
        counters[3] = max(counters[3], counters[1]);
        counters[0] = 0u;
        counters[1] = 0u;
    }
}
