#version 450

// The kept pairs as one list of indices (section 6.1), triangle after triangle: on each plane they keep the level map's order, and no
// texel is lit from two planes. An index names a vertex of the water and a plane: vertex + plane x vertices.

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
    uint triangle = element(64u);
    if (triangle >= cull.triangles) {
        return;
    }
    uvec3 corners = uvec3(indices.list[3u * triangle], indices.list[3u * triangle + 1u], indices.list[3u * triangle + 2u]);
    uint next = 3u * (before.list[triangle] + blocks.list[triangle / 256u]);
    for (uint word = 0u; word < cull.words; word++) {
        uint bits = kept.list[triangle * cull.words + word];
        while (bits != 0u) {
            uvec3 pair = corners + (32u * word + uint(findLSB(bits))) * cull.vertices;
            pairs.list[next] = pair.x;
            pairs.list[next + 1u] = pair.y;
            pairs.list[next + 2u] = pair.z;
            next += 3u;
            bits &= bits - 1u;
        }
    }
}
