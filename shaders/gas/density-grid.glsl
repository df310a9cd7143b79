// Densities of files: samples on a grid in the box of each volume. What the device filters itself has a fraction of 8 bits
// or so: samples are interpolated by hand.

#include "gas/densest.glsl"

struct Grid {
    vec3 to_column; // columns a metre
    uint columns;
    vec3 to_row;
    uint rows;
    vec3 to_layer;
    uint layers;
    vec3 middle; // of the volume, in samples
    uint first; // sample of the grid
};

layout(set = 0, binding = 27, std430) readonly buffer Grids {
    Grid grids[]; // one a volume
};

layout(set = 0, binding = 28, std430) readonly buffer Samples {
    float grid_samples[]; // columns run fastest; 0 at density 0, 1 at density 1
};

// A grid ends half a sample's distance beyond its outermost samples, and a thousandth more, so that rounding opens no gap.
const float BORDER = 0.501;

// In samples from the first one.
vec3 grid_position(Grid grid, vec3 world) {
    vec3 p = world - in_hand.center;
    vec3 at = vec3(dot(grid.to_column, p), dot(grid.to_row, p), dot(grid.to_layer, p));
    return at + grid.middle;
}

uvec3 grid_size(Grid grid) {
    return uvec3(grid.columns, grid.rows, grid.layers);
}

// The nearest sample that there is.
uvec3 nearest_sample(ivec3 at, uvec3 size) {
    return uvec3(clamp(at, ivec3(0), ivec3(size) - 1));
}

bool is_in_grid(vec3 at, uvec3 size) {
    vec3 inside = min(at + BORDER, vec3(size) - 1.0 + BORDER - at);
    return min(inside.x, min(inside.y, inside.z)) >= 0.0;
}

// Density of an interpolated sample.
float transferred(float value) {
    return min(pow(clamp(value, 0.0, 1.0) * in_hand.opaque, in_hand.power), MOST_DENSITY);
}
