#version 450

// The drawn triangles in the order of their nodes, whatever the order of the threads.

layout(local_size_x = 64) in;

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

uint corner(Leaf leaf, uint number) {
    return corners[corner_at(leaf.coarse, leaf.level, leaf.index, number % 3u)];
}

uint midpoint(Leaf leaf, uint edge) {
    return corners[midpoint_at(leaf.coarse, leaf.level, leaf.index, edge % 3u)];
}

void put(uint triangle, uint a, uint b, uint c) {
    stream[3u * triangle] = a;
    stream[3u * triangle + 1u] = b;
    stream[3u * triangle + 2u] = c;
}

// Windings stay the node's own.
void write(Leaf leaf, uint at) {
    uint k = 0u; // the corner that the pattern is turned to
    if (leaf.triangles == 1u) {
        put(at, corner(leaf, 0u), corner(leaf, 1u), corner(leaf, 2u));
    } else if (leaf.triangles == 2u) {
        k = leaf.split.x != 0u ? 0u : leaf.split.y != 0u ? 1u : 2u; // the split edge leaves from it
        uint middle = midpoint(leaf, k);
        put(at, corner(leaf, k), middle, corner(leaf, k + 2u));
        put(at + 1u, middle, corner(leaf, k + 1u), corner(leaf, k + 2u));
    } else if (leaf.triangles == 3u) {
        k = leaf.split.x == 0u ? 1u : leaf.split.y == 0u ? 2u : 0u; // the whole edge arrives at it
        uint first = midpoint(leaf, k);
        uint second = midpoint(leaf, k + 1u);
        put(at, corner(leaf, k), first, second);
        put(at + 1u, first, corner(leaf, k + 1u), second);
        put(at + 2u, corner(leaf, k), second, corner(leaf, k + 2u));
    } else {
        uvec3 middle = uvec3(midpoint(leaf, 0u), midpoint(leaf, 1u), midpoint(leaf, 2u));
        put(at, corner(leaf, 0u), middle.x, middle.z);
        put(at + 1u, middle.x, corner(leaf, 1u), middle.y);
        put(at + 2u, middle.z, middle.y, corner(leaf, 2u));
        put(at + 3u, middle.x, middle.y, middle.z);
    }
}

void main() {
    uint run = gl_GlobalInvocationID.x;
    uint nodes = constants.tree.y * nodes_above(constants.tree.x + 1u);
    if (run * RUN >= nodes) {
        return;
    }
    uint at = group_sums[run];
    for (uint node = run * RUN; node < min(run * RUN + RUN, nodes); node++) {
        Leaf leaf = leaf_of(node);
        if (leaf.triangles > 0u) {
            write(leaf, at);
            at += leaf.triangles;
        }
    }
}
