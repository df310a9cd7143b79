// The smoke as extinction in a grid of cubic cells around its particles. Ours: the dissertation draws squares.

// Along each axis, and in all.
const int SMOKE_CELLS = 48;
const uint SMOKE_CELL_COUNT = 110592u;

struct SmokeBox {
    vec3 low; // corner of the grid, diagonals
    float cell_width; // diagonals; 0 where there is no smoke
};

// Sums of a cell are of extinction times volume, in these parts of a particle's squared radius: a million particles in
// one cell fit.
const float SMOKE_UNITS = 16384.0;

uint number_of(ivec3 cell) {
    return uint((cell.z * SMOKE_CELLS + cell.y) * SMOKE_CELLS + cell.x);
}
