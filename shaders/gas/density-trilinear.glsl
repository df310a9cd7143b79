// The density of a file between its eight nearest samples, linearly along each axis.

#include "gas/density-grid.glsl"

float gas_density(vec3 world) {
    Grid grid = grids[index_in_hand];
    vec3 at = grid_position(grid, world);
    uvec3 size = grid_size(grid);
    if (!is_in_grid(at, size)) {
        return 0.0;
    }
    vec3 low = floor(at);
    vec3 t = at - low;
    uvec3 a = nearest_sample(ivec3(low), size);
    uvec3 b = nearest_sample(ivec3(low) + 1, size);
    uint first = grid.first;
    uint rows00 = first + (a.z * size.y + a.y) * size.x;
    uint rows10 = first + (a.z * size.y + b.y) * size.x;
    uint rows01 = first + (b.z * size.y + a.y) * size.x;
    uint rows11 = first + (b.z * size.y + b.y) * size.x;
    float s00 = mix(grid_samples[rows00 + a.x], grid_samples[rows00 + b.x], t.x);
    float s10 = mix(grid_samples[rows10 + a.x], grid_samples[rows10 + b.x], t.x);
    float s01 = mix(grid_samples[rows01 + a.x], grid_samples[rows01 + b.x], t.x);
    float s11 = mix(grid_samples[rows11 + a.x], grid_samples[rows11 + b.x], t.x);
    return transferred(mix(mix(s00, s10, t.y), mix(s01, s11, t.y), t.z));
}
