// Bounds of a file's samples. The box is one in the world; on the grid, whose axes may be at any angle to it, those samples
// are taken that a box along the grid's axes around it touches.

float sample_at(uint v, uint index) {
    return grid_samples[grids[v].first + index];
}

#include "gas/bound-samples.glsl"

// `reach`: samples that a value depends on, on either side of its cell; `overshoot`: what the weights below 0 sum up to.
float grid_bound(uint v, vec3 low, vec3 high, int reach, float overshoot) {
    Grid grid = grids[v];
    vec3 middle = 0.5 * (low + high) * in_hand.half_extent_m;
    vec3 apart = 0.5 * (high - low) * in_hand.half_extent_m;
    vec3 at = grid_position(grid, in_hand.center + middle);
    vec3 around = vec3(dot(abs(grid.to_column), apart), dot(abs(grid.to_row), apart),
        dot(abs(grid.to_layer), apart));
    // Rounding of positions that are far from the middle.
    around += 1.0e-3;
    uvec3 size = grid_size(grid);
    vec3 inside = min(at + around + BORDER, vec3(size) - 1.0 + BORDER - (at - around));
    if (min(inside.x, min(inside.y, inside.z)) < 0.0) {
        return 0.0;
    }
    ivec3 last = ivec3(size) - 1;
    ivec3 first = clamp(ivec3(floor(at - around)) - reach, ivec3(0), last);
    ivec3 end = clamp(ivec3(floor(at + around)) + 1 + reach, first, last) + 1;
    Extremes found = extremes(v, first, uvec3(end - first), size);
    return transferred(found.are_known ? found.greatest + overshoot * (found.greatest - found.least) : 1.0);
}
