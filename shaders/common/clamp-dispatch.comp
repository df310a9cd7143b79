#version 450

// Copies the parameters of an indirect dispatch, kept inside what the device takes: Vulkan checks them neither on the
// host nor on the device.

layout(local_size_x = 1) in;

struct Groups {
    uint x;
    uint y;
    uint z;
};

layout(set = 0, binding = 0, std430) readonly buffer Wanted {
    Groups wanted;
};

layout(set = 0, binding = 1, std430) buffer Clamped {
    Groups clamped;
};

layout(push_constant, std430) uniform DispatchLimits {
    uint x;
    uint y;
    uint z;
} limits;

void main() {
    clamped.x = min(wanted.x, limits.x);
    clamped.y = min(wanted.y, limits.y);
    clamped.z = min(wanted.z, limits.z);
}
