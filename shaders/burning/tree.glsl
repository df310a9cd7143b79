// The refinement pattern of a coarse triangle: a full tree whose node (a, b, c) has the children (a, mab, mca), (mab,
// b, mbc), (mca, mbc, c) and (mab, mbc, mca), numbered level by level, inside a level by the digits of the path from
// the root. Table 4.1's attributes are arithmetic on these numbers: a node's parent is index / 4 of the level above,
// its siblings have the same, its children are 4 index + 0..3. The last level, constants.levels, has the finest
// triangles.

uint power_of_four(uint exponent) {
    return 1u << (2u * exponent);
}

// Nodes of the levels above this one.
uint nodes_above(uint level) {
    return (power_of_four(level) - 1u) / 3u;
}

// A coarse triangle's node, counted over all of them.
uint node_at(uint coarse, uint level, uint index) {
    return coarse * nodes_above(constants.levels + 1u) + nodes_above(level) + index;
}

// The first finest triangle of a node.
uint finest_at(uint coarse, uint level, uint index) {
    return coarse * power_of_four(constants.levels) + index * power_of_four(constants.levels - level);
}

// Index of a node's corner in the lists of the finest triangles' corners: child c keeps its parent's corner c, so that
// corner belongs to the descendant whose further digits are all c.
uint corner_at(uint coarse, uint level, uint index, uint corner) {
    return 3u * (finest_at(coarse, level, index) + corner * nodes_above(constants.levels - level)) + corner;
}

// Likewise the midpoint between a node's corners `edge` and the next: a corner of its child in the middle.
uint midpoint_at(uint coarse, uint level, uint index, uint edge) {
    return corner_at(coarse, level + 1u, 4u * index + 3u, edge);
}
