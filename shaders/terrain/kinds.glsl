// Kinds of base, numbered as src/papers/terrain/blocks.rs does; 2 is an ellipsoid.
const int PLANE = 0;
const int CYLINDER = 1;

// Whether a kind is the asked one; `here` is any value of the pixel's or vertex's own, not below 0. A branch on members of blocks
// alone has lavapipe (Mesa 22.3) compile the shader anew whenever a block is bound, with its numbers for constants, and keep
// every one: 4 to 15 MB a frame, and the time of it. What depends on `here` is no such branch.
bool is_kind(int kind, int asked, float here) {
    return kind + min(int(min(here, 1.0)), 0) == asked;
}
