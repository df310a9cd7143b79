// Sections 4.4.1 and 4.5: the triangles that are drawn of a node of the refinement pattern. Drawn are the active nodes,
// and at the level of detail the inactive ones for all below them. An edge whose midpoint exists on its other side is
// drawn with it, so that no crack opens: one, two or three such edges split a node into two, three or four triangles.
//
// "If number of children of T with higher burn level than T is >= 2 and SetLevel >= 5 then hide T": since only
// triangles of the finest level burn, what is printed would hide nothing else. A coarser one is hidden when two or more
// of its four children are gone, and a child that is coarser is gone by the same rule.

#include "burning/constants.glsl"
#include "burning/runs.glsl"
#include "burning/tree.glsl"
#include "burning/statuses.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[]; // three vertices a finest triangle
};

layout(set = 0, binding = 25, std430) readonly buffer Statuses {
    int statuses[]; // of nodes
};

layout(set = 0, binding = 24, std430) readonly buffer Alive {
    uint alive[]; // of vertices
};

layout(set = 0, binding = 13, std430) readonly buffer Removed {
    uint removed[]; // of finest triangles
};

layout(push_constant, std430) uniform Leaves {
    uint level_of_detail; // the finest level that is drawn
} leaves;

struct Leaf {
    uint coarse;
    uint level;
    uint index;
    uvec3 split; // 1 for each edge that is drawn with its midpoint
    uint triangles; // to be drawn, 0 to 4
};

// True for a node above the finest level that is gone. The counts of gone children lie four bits a level in one
// integer: a count is full when the digit of its level is 3.
bool is_gone(uint first, uint below) {
    uint counts = 0u;
    for (uint finest = 0u; finest < power_of_four(below); finest++) {
        uint gone = removed[first + finest] != 0u ? 1u : 0u;
        for (uint level = 0u; level < below; level++) {
            counts += gone << (4u * level);
            if (((finest >> (2u * level)) & 3u) != 3u) {
                break;
            }
            gone = ((counts >> (4u * level)) & 15u) >= 2u ? 1u : 0u;
            counts &= ~(15u << (4u * level));
            if (level + 1u == below) {
                return gone != 0u;
            }
        }
    }
    return false;
}

uint midpoint_exists(Leaf leaf, uint edge) {
    return alive[triangles[midpoint_at(leaf.coarse, leaf.level, leaf.index, edge)]];
}

// The nodes of a run that are in use, a bit each: most runs of a cold object have none, and are done.
uint used_nodes(uint run) {
    uint nodes = constants.coarse_count * nodes_above(constants.levels + 1u);
    uint used = 0u;
    for (uint i = 0u; i < RUN; i++) {
        uint node = run * RUN + i;
        if (node < nodes) {
            used |= statuses[node] != UNUSED ? 1u << i : 0u;
        }
    }
    return used;
}

// The leaf of a node that is in use, counted over all coarse triangles.
Leaf leaf_of(uint node) {
    uint nodes = nodes_above(constants.levels + 1u);
    Leaf leaf = Leaf(node / nodes, 0u, 0u, uvec3(0u), 0u);
    int status = statuses[node];
    // Level k begins at (4^k - 1) / 3.
    uint own = node % nodes;
    leaf.level = uint(findMSB(3u * own + 1u)) / 2u;
    leaf.index = own - nodes_above(leaf.level);
    if (leaf.level > leaves.level_of_detail || (leaf.level < leaves.level_of_detail && status == INACTIVE)) {
        return leaf;
    }
    uint below = constants.levels - leaf.level;
    uint first = finest_at(leaf.coarse, leaf.level, leaf.index);
    if (below == 0u ? removed[first] != 0u : status == INACTIVE && is_gone(first, below)) {
        return leaf;
    }
    if (leaf.level < leaves.level_of_detail) {
        leaf.split = uvec3(midpoint_exists(leaf, 0u), midpoint_exists(leaf, 1u), midpoint_exists(leaf, 2u));
    }
    leaf.triangles = 1u + leaf.split.x + leaf.split.y + leaf.split.z;
    return leaf;
}
