#version 450

// Copies the parameters of an indexed indirect draw, kept inside what the draw has bound: Vulkan checks indices against
// their buffer neither on the host nor on the device.

layout(local_size_x = 1) in;

struct DrawIndexed {
    uint index_count;
    uint instance_count;
    uint first_index;
    int vertex_offset;
    uint first_instance;
};

layout(set = 0, binding = 0, std430) readonly buffer Wanted {
    DrawIndexed wanted;
};

layout(set = 0, binding = 1, std430) buffer Clamped {
    DrawIndexed clamped;
};

layout(push_constant, std430) uniform DrawLimits {
    uint index_count; // in the bound buffer
    uint instance_count;
} limits;

void main() {
    uint first = min(wanted.first_index, limits.index_count);
    clamped.index_count = min(wanted.index_count, limits.index_count - first);
    clamped.instance_count = min(wanted.instance_count, limits.instance_count);
    clamped.first_index = first;
    clamped.vertex_offset = wanted.vertex_offset;
    clamped.first_instance = 0u; // another needs a feature of its own
}
