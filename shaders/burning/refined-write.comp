#version 450

// The drawn triangles in the order of their nodes, whatever the order of the threads.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/refined-leaves.glsl"

layout(set = 0, binding = 29, std430) readonly buffer GroupSums {
    uint group_sums[]; // triangles drawn before each run
};

layout(set = 0, binding = 5, std430) readonly buffer Corners {
    uint corners[]; // three drawn vertices a finest triangle
};

layout(set = 0, binding = 22, std430) buffer Stream {
    uint stream[];
};

// A point of the node, from the corner that its pattern is rotated to: 0 to 2 its corners, 3 to 5 the midpoints of the
// edges after them.
uint point(Leaf leaf, uint rotation, uint number) {
    uint at = corner_at(leaf.coarse, leaf.level, leaf.index, (rotation + number) % 3u);
    if (number >= 3u) {
        at = midpoint_at(leaf.coarse, leaf.level, leaf.index, (rotation + number) % 3u);
    }
    return corners[at];
}

// Windings stay the node's own.
void write(Leaf leaf, uint first) {
    // The points of the triangles of a node that is whole, or whose first edge, first two edges or all edges are split.
    uint patterns[10] = uint[10](0x012u, 0x032u, 0x312u, 0x034u, 0x314u, 0x042u, 0x035u, 0x314u, 0x542u, 0x345u);
    uint pattern = (leaf.triangles * (leaf.triangles - 1u)) / 2u;
    uint rotation = 0u;
    if (leaf.triangles == 2u) {
        rotation = leaf.split.y + 2u * leaf.split.z;
    } else if (leaf.triangles == 3u) {
        rotation = leaf.split.x == 0u ? 1u : leaf.split.y == 0u ? 2u : 0u;
    }
    for (uint i = 0u; i < leaf.triangles; i++) {
        uint points = patterns[pattern + i];
        stream[3u * (first + i)] = point(leaf, rotation, points >> 8u);
        stream[3u * (first + i) + 1u] = point(leaf, rotation, (points >> 4u) & 15u);
        stream[3u * (first + i) + 2u] = point(leaf, rotation, points & 15u);
    }
}

void main() {
    uint run = element(64u);
    if (run * RUN >= constants.coarse_count * nodes_above(constants.levels + 1u)) {
        return;
    }
    uint at = group_sums[run];
    for (uint used = used_nodes(run); used != 0u; used &= used - 1u) {
        Leaf leaf = leaf_of(run * RUN + uint(findLSB(used)));
        write(leaf, at);
        at += leaf.triangles;
    }
}
