// The blocks of 3.5.1, numbered x first, then y, then z.

// The block of a position; the nearest one for a position outside.
uint cell_of(vec3 position) {
    vec3 at = floor((position - constants.grid_origin) / constants.block_size);
    uvec3 cell = uvec3(clamp(at, vec3(0.0), vec3(constants.blocks) - 1.0));
    return (cell.z * constants.blocks.y + cell.y) * constants.blocks.x + cell.x;
}

uvec3 coordinates_of(uint cell) {
    uint columns = constants.blocks.x;
    uint rows = constants.blocks.y;
    return uvec3(cell % columns, (cell / columns) % rows, cell / (columns * rows));
}

vec3 midpoint_of(uint cell) {
    return constants.grid_origin + (vec3(coordinates_of(cell)) + 0.5) * constants.block_size;
}

// The face neighbour in direction 0 to 5: -x, +x, -z, +z (the sides), -y, +y (down and up). NONE outside the grid.
uint neighbour_of(uint cell, uint direction) {
    ivec3 steps[6] = ivec3[6](
        ivec3(-1, 0, 0), ivec3(1, 0, 0), ivec3(0, 0, -1), ivec3(0, 0, 1), ivec3(0, -1, 0), ivec3(0, 1, 0)
    );
    ivec3 at = ivec3(coordinates_of(cell)) + steps[direction];
    ivec3 size = ivec3(constants.blocks);
    if (at.x < 0 || at.y < 0 || at.z < 0 || at.x >= size.x || at.y >= size.y || at.z >= size.z) {
        return NONE;
    }
    return uint((at.z * size.y + at.y) * size.x + at.x);
}
