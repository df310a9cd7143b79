// Smart slicing (section 4.7.2) on the device: what its passes share.

// Neighbouring levels that hold the receiver, and the planes in them.
struct SubBox {
    uint first; // level
    uint end; // level after the last
    uint first_plane;
    uint planes;
};

// Planes of a sub-box of so many levels (eq. 4-21 and 4-22), and the height of a cell as a sum: each part has so few bits that its
// product with a plane's number is exact. So nothing depends on whether a compiler contracts product and difference, and the host
// places the same planes bit for bit.
struct Fit {
    uint planes;
    float coarse; // metres
    float fine;
};

layout(std430, set = 0, binding = 0) buffer Held {
    uint list[]; // 1 for each level that holds a texel
} held;

layout(std430, set = 0, binding = 1) readonly buffer Fits {
    Fit list[]; // of one level, of two, and so on
} fits;

layout(push_constant) uniform Smart {
    float top; // of the box along V, from its centre, metres
    float middle; // height of the box's centre along V, from the rays' reference point, metres
    uint levels;
    uint most; // planes that there is room for
} smart;
