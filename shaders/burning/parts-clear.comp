#version 450

// Before the moments are summed.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/moments.glsl"

layout(set = 0, binding = 68, std430) buffer Sums {
    uint sums[];
};

void main() {
    uint thread = element(64u);
    if (thread < MOST_PARTS * MOMENTS) {
        sums[thread] = 0u;
    }
}
