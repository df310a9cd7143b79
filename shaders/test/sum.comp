#version 450

// Sums each run of 64 values, in a fixed order.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Values {
    float values[];
};

layout(set = 0, binding = 1, std430) buffer Sums {
    uint group_count; // written by the first thread of all
    float sums[];
};

layout(push_constant, std430) uniform Range {
    uint value_count;
} range;

shared float partial[64];

void main() {
    uint thread = gl_LocalInvocationID.x;
    uint index = gl_GlobalInvocationID.x;
    partial[thread] = index < range.value_count ? values[index] : 0.0;
    barrier();
    for (uint half_count = 32u; half_count > 0u; half_count /= 2u) {
        if (thread < half_count) {
            partial[thread] += partial[thread + half_count];
        }
        barrier();
    }
    if (thread == 0u) {
        sums[gl_WorkGroupID.x] = partial[0];
    }
    if (index == 0u) {
        group_count = gl_NumWorkGroups.x;
    }
}
