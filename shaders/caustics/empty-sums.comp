#version 450

// No light anywhere, and no triangle listed (section 6.3).

layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Sums {
    uint list[];
} sums;

layout(std430, set = 0, binding = 1) buffer Straddling {
    uint count;
} straddling;

layout(push_constant) uniform Empty {
    uint words; // of the sums
} empty;

void main() {
    uint at = gl_GlobalInvocationID.x;
    if (at < empty.words) {
        sums.list[at] = 0u;
    }
    if (at == 0u) {
        straddling.count = 0u;
    }
}
