#version 450

// The kept pairs as one list of indices, plane after plane and triangle after triangle as the level map draws them (section 6.1). An
// index names a vertex of the water and a plane: vertex + plane x vertices.

layout(local_size_x = 64) in;

#include "caustics/cull.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(std430, set = 0, binding = 1) readonly buffer Kept {
    uint list[];
} kept;

layout(std430, set = 0, binding = 2) readonly buffer Before {
    uint list[];
} before;

layout(std430, set = 0, binding = 3) readonly buffer Blocks {
    uint list[];
} blocks;

layout(std430, set = 0, binding = 4) buffer Pairs {
    uint list[]; // three a pair
} pairs;

void main() {
    uint word = gl_GlobalInvocationID.x;
    uint plane = gl_GlobalInvocationID.y;
    if (word >= cull.words || plane >= cull.planes) {
        return;
    }
    uint at = plane * cull.words + word;
    uint bits = kept.list[at];
    uint next = 3u * (before.list[at] + blocks.list[at / 256u]);
    if (bits == 0u) {
        return;
    }
    // One round a pair, 32 at the most.
    for (uint round = 0u; round < 32u && bits != 0u; round++) {
        uint corner = 3u * (32u * word + uint(findLSB(bits)));
        pairs.list[next] = indices.list[corner] + plane * cull.vertices;
        pairs.list[next + 1u] = indices.list[corner + 1u] + plane * cull.vertices;
        pairs.list[next + 2u] = indices.list[corner + 2u] + plane * cull.vertices;
        next += 3u;
        bits &= bits - 1u;
    }
}
