// Ash on the ground: parts of triangles that have come down on each cell of a square about the object's base.

const int ASH_CELLS = 128; // along x, and along z
const float ASH_HALF_WIDTH = 1.0; // of the square, diagonals
const uint ASH_PARTS = 16u; // of a triangle, which may be wider than a cell

vec2 ash_coordinates(vec2 xz) {
    return (xz / (2.0 * ASH_HALF_WIDTH) + 0.5) * float(ASH_CELLS);
}
