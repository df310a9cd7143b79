#version 450

// No light anywhere, and no triangle listed (section 6.3).

layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Sums {
    uvec4 list[]; // two texels each
} sums;

layout(std430, set = 0, binding = 1) buffer Straddling {
    uint count;
} straddling;

layout(push_constant) uniform Empty {
    uint pairs; // of texels
    uint threads; // which take them in turn
} empty;

void main() {
    uint at = gl_GlobalInvocationID.x;
    for (uint pair = at; pair < empty.pairs; pair += empty.threads) {
        sums.list[pair] = uvec4(0u);
    }
    if (at == 0u) {
        straddling.count = 0u;
    }
}
