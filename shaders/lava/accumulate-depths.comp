#version 450

// Numerator and denominator of eq. 6.3 at a grid point, gathered from the columns within R: all accepted points of a column
// have one weight. A dispatch takes a band of rows, so that no shader has more iterations than lavapipe allows.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

#include "lava/gaussian.glsl"

layout(push_constant, std430) uniform Accumulate {
    vec2 spacing_m;
    ivec2 columns; // grid points along x and z
    ivec2 first; // grid point of the dispatch
    float radius_m; // R_i of eq. 6.3
    float each; // 1 where every accepted point counts, 0 where one stands for the column
    int reach; // columns to either side
    int first_row; // of the band, from the grid point's own
    int last_row;
} accumulate;

layout(set = 0, binding = 0) uniform texture2D columns;
layout(set = 0, binding = 1, rgba32f) uniform image2D sums;

// Grid points lie at multiples of the spacing, so many lie on the radius but for rounding: they count, everywhere.
const float ON_THE_RADIUS = 1.00001;

void main() {
    ivec2 at = accumulate.first + ivec2(gl_GlobalInvocationID.xy);
    if (at.x >= accumulate.columns.x || at.y >= accumulate.columns.y) {
        return;
    }
    ivec2 low = max(at + ivec2(-accumulate.reach, accumulate.first_row), ivec2(0));
    ivec2 high = min(at + ivec2(accumulate.reach, accumulate.last_row), accumulate.columns - 1);
    vec2 sum = vec2(0.0);
    for (int row = low.y; row <= high.y; row++) {
        for (int column = low.x; column <= high.x; column++) {
            vec2 across_m = vec2(ivec2(column, row) - at) * accumulate.spacing_m / accumulate.radius_m;
            float ratio_squared = dot(across_m, across_m);
            vec2 points = texelFetch(columns, ivec2(column, row), 0).xy;
            float weight = ratio_squared > ON_THE_RADIUS ? 0.0 : gaussian(ratio_squared);
            sum += weight * vec2(points.y, mix(min(points.x, 1.0), points.x, accumulate.each));
        }
    }
    vec4 before = imageLoad(sums, at);
    imageStore(sums, at, before + vec4(sum.x, 0.0, 0.0, sum.y));
}
