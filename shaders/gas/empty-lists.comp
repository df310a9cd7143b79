#version 450

// Every pixel's list is empty, and so are the counts; the most that any band of any frame has counted is kept for the host.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"
#include "gas/band.glsl"

layout(set = 0, binding = 7, std430) buffer Heads {
    uint heads[];
};

layout(set = 0, binding = 11, std430) buffer Counters {
    uint counters[]; // fragments, sections; the most of both in a band
};

void main() {
    uvec2 pixel = pixel_of(gl_GlobalInvocationID.xy);
    if (is_in_band(pixel)) {
        heads[list_of(pixel)] = NONE;
    }
    if (gl_GlobalInvocationID.x == 0u && gl_GlobalInvocationID.y == 0u) {
        counters[2] = max(counters[2], counters[0]);
        counters[3] = max(counters[3], counters[1]);
        counters[0] = 0u;
        counters[1] = 0u;
    }
}
