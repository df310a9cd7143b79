#version 450

// Adds a step to every value.

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) buffer Values {
    float values[];
};

layout(push_constant, std430) uniform Advance {
    uint value_count;
    float step;
} advance;

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index < advance.value_count) {
        values[index] += advance.step;
    }
}
