// Pixels a side of a tile whose rays begin together; src/papers/terrain/start.rs has it, too.
const int TILE_PIXELS = 8;
