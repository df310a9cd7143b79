// Sections of an object, by their distance from its foot, with the joints at which they meet: ours. See
// papers/burning/model/sections.rs.

const uint MOST_SECTIONS = 512u;
const float LENGTH_UNIT = 1.0 / 65536.0; // of the lengths of joints, diagonals

struct Section {
    vec3 place; // mean of its vertices at rest
    uint first; // of its joints in the list of neighbours
};

struct Joint {
    vec3 place; // middle of the line around it at rest
    uint units; // of the length of the line
    uvec2 ends; // sections
};

struct Cut {
    uint a; // vertices; c is b of two that touch
    uint b;
    uint c;
    uint triangle; // NONE of two that touch
    uint joint;
    uint units; // of the length of the joint's line through it
};

// The sections that a vertex goes with.
struct Hold {
    uint sections; // its own in the low 16 bits, the nearest other in the high ones
    float share; // of the other
};

// What is there of a section.
struct Load {
    uint weight; // of its vertices
    uint part; // the lowest part that it has vertices of, those that lie still first; NONE without any
    uint is_foot; // 1 where one of them is on the ground
};

const uint MOVING = 0x10000u; // added to the number of a part that does not lie still

// The turn of a section, and of all beyond it, about the joint towards its foot in a tick.
struct Hinge {
    vec3 axis; // a unit vector, horizontal
    float angle; // radians
    vec3 pivot; // a place in the object
    uint joint; // towards the foot; NONE of a foot, and of what does not hang together with one
};

// A rotation about the origin, then a displacement.
struct Bend {
    vec4 turn; // unit quaternion
    vec3 offset; // diagonals
};
