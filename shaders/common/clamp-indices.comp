#version 450

// Copies the indices of a draw, none above what the device takes: Vulkan checks their values neither on the host nor on the
// device.

#include "common/elements.glsl"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0, std430) readonly buffer Wanted {
    uint wanted[];
};

layout(set = 0, binding = 1, std430) buffer Clamped {
    uint clamped[];
};

layout(push_constant, std430) uniform IndexLimits {
    uint index_count; // in the bound buffer
    uint largest;
} limits;

void main() {
    uint at = element(64u);
    if (at < limits.index_count) {
        clamped[at] = min(wanted[at], limits.largest);
    }
}
