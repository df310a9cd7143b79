// Wax on the ground: a height field of equal cells. What the mesh loses of its volume the puddle gains; volumes are
// integers, so that they add up whatever the order of threads.

const int PUDDLE_CELLS = 128; // along x, and along z
const float PUDDLE_HALF_WIDTH = 1.28; // diagonals
const float CELL_WIDTH = 2.0 * PUDDLE_HALF_WIDTH / float(PUDDLE_CELLS);
const float UNITS = 4294967296.0; // of volume in a cubed diagonal
const float HEIGHT_OF_UNIT = 1.0 / (UNITS * CELL_WIDTH * CELL_WIDTH); // over a cell, diagonals

struct Film {
    int mesh_volume; // of this tick
    int volume_at_start; // of the mesh at the first tick
    uint puddle_volume; // after the last tick
    uint spread_volume; // after this one
    uint evaporated;
    uint weight; // of this tick's vertices that melt
    uint has_started;
    uint evaporated_before; // this tick
};

// The cell below a position, the nearest one where it lies beyond.
int cell_below(vec3 position) {
    ivec2 cell = ivec2(floor((position.xz + PUDDLE_HALF_WIDTH) / CELL_WIDTH));
    cell = clamp(cell, ivec2(0), ivec2(PUDDLE_CELLS - 1));
    return cell.y * PUDDLE_CELLS + cell.x;
}
