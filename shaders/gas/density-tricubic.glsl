// The density of a file between its 64 nearest samples, by the cubic of E. Catmull and R. Rom along each axis, which goes
// through the samples. Beyond the border its samples go on. Without loops: a driver counts their iterations.

#include "gas/density-grid.glsl"

vec4 cubic_weights(float t) {
    return vec4(((1.0 - 0.5 * t) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1.0, ((2.0 - 1.5 * t) * t + 0.5) * t,
        (0.5 * t - 0.5) * t * t);
}

float cubic_row(uint row, uvec4 columns, vec4 weights) {
    vec4 values = vec4(grid_samples[row + columns.x], grid_samples[row + columns.y], grid_samples[row + columns.z],
        grid_samples[row + columns.w]);
    return dot(values, weights);
}

float cubic_layer(uint layer, uvec4 rows, vec4 row_weights, uvec4 columns, vec4 weights) {
    vec4 values = vec4(cubic_row(layer + rows.x, columns, weights), cubic_row(layer + rows.y, columns, weights),
        cubic_row(layer + rows.z, columns, weights), cubic_row(layer + rows.w, columns, weights));
    return dot(values, row_weights);
}

float gas_density(vec3 world) {
    Grid grid = grids[index_in_hand];
    vec3 at = grid_position(grid, world);
    uvec3 size = grid_size(grid);
    if (!is_in_grid(at, size)) {
        return 0.0;
    }
    vec3 low = floor(at);
    vec3 t = at - low;
    uvec3 a = nearest_sample(ivec3(low) - 1, size);
    uvec3 b = nearest_sample(ivec3(low), size);
    uvec3 c = nearest_sample(ivec3(low) + 1, size);
    uvec3 d = nearest_sample(ivec3(low) + 2, size);
    uvec4 columns = uvec4(a.x, b.x, c.x, d.x);
    uvec4 rows = uvec4(a.y, b.y, c.y, d.y) * size.x;
    uvec4 layers = uvec4(a.z, b.z, c.z, d.z) * (size.x * size.y) + grid.first;
    vec4 column_weights = cubic_weights(t.x);
    vec4 row_weights = cubic_weights(t.y);
    vec4 values = vec4(cubic_layer(layers.x, rows, row_weights, columns, column_weights),
        cubic_layer(layers.y, rows, row_weights, columns, column_weights),
        cubic_layer(layers.z, rows, row_weights, columns, column_weights),
        cubic_layer(layers.w, rows, row_weights, columns, column_weights));
    return transferred(dot(values, cubic_weights(t.z)));
}
