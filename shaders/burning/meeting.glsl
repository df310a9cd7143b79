// Where a part that falls meets one that lies still: vertices as balls. A table by a hash of a vertex's cell holds the
// lowest vertex there of what lies still.

const uint ENTRIES = 65536u;
const uint MEETINGS = 8u; // the deepest in each octant of directions

// Diameter of the balls, and width of the cells.
float ball_width() {
    return constants.mean_edge;
}

ivec3 cell_at(vec3 position) {
    return ivec3(floor(position / ball_width()));
}

uint entry_of(ivec3 cell) {
    uint h = uint(cell.x) * 0x8da6b343u ^ uint(cell.y) * 0xd8163841u ^ uint(cell.z) * 0xcb1ab31fu;
    h ^= h >> 15u;
    h *= 0x846ca68bu;
    return (h ^ (h >> 16u)) % ENTRIES;
}

uint octant_of(vec3 v) {
    return (v.x < 0.0 ? 1u : 0u) + (v.y < 0.0 ? 2u : 0u) + (v.z < 0.0 ? 4u : 0u);
}
