#version 450

// Before the moments are summed.

layout(local_size_x = 64) in;

#include "burning/moments.glsl"

layout(set = 0, binding = 68, std430) buffer Sums {
    uint sums[];
};

void main() {
    uint thread = gl_GlobalInvocationID.x;
    if (thread < MOST_PARTS * MOMENTS) {
        sums[thread] = 0u;
    }
}
