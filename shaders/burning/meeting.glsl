// Where a part that falls meets another: vertices as balls. A table by a hash of a vertex's cell holds the lowest vertex
// there, in layers: of what lies still, and of what falls of parts of even and of odd numbers, so that a part's own balls
// hide few of the others'. Two layers more hold the lowest and the highest part in each larger cell: most balls are among
// those of their own part alone, and look no further.

#include "burning/contacts.glsl"

const uint LOWEST_PART = LAYERS;
const uint HIGHEST_PART = LAYERS + 1u; // the highest as ~part, so that it is a lowest number too
const int LARGER = 2; // doublings of a cell's sides

const uint MEETINGS = 8u; // the deepest in each octant of directions

// A ball that a part meets.
struct Obstacle {
    vec3 toward; // from it, a unit vector
    float gap; // diagonals, below 0 where the balls overlap
    vec3 velocity; // of it, diagonals a second
};

// Diameter of the balls, and width of the cells.
float ball_width() {
    return constants.mean_edge;
}

ivec3 cell_at(vec3 position) {
    return ivec3(floor(position / ball_width()));
}

uint entry_of(uint layer, ivec3 cell) {
    uint h = uint(cell.x) * 0x8da6b343u ^ uint(cell.y) * 0xd8163841u ^ uint(cell.z) * 0xcb1ab31fu;
    h ^= h >> 15u;
    h *= 0x846ca68bu;
    return layer * ENTRIES + (h ^ (h >> 16u)) % ENTRIES;
}

uint octant_of(vec3 v) {
    return (v.x < 0.0 ? 1u : 0u) + (v.y < 0.0 ? 2u : 0u) + (v.z < 0.0 ? 4u : 0u);
}
