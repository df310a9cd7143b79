#version 450

// The sheet's bilinear patch over each cell between the middles of four columns, which a ray reads many of, by one fetch, and the highest
// place of each row. Before the first columns and behind the last are cells too, where the heights go on level.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 32) in;

layout(push_constant, std430) uniform Field {
    uint columns;
    uint rows;
} field;

layout(set = 0, binding = 0) uniform texture2D normal_height;

layout(set = 0, binding = 1, std430) buffer Highest {
    float all; // metres
    float rows[];
} highest;

// Metres: the height at the corner of least column and row, how much more it is along the row, along the column, and beyond both.
layout(set = 0, binding = 2, rgba32f) uniform writeonly image2D patches;

float height_of(ivec2 column) {
    return texelFetch(normal_height, clamp(column, ivec2(0), ivec2(field.columns, field.rows) - 1), 0).w;
}

void main() {
    int row = int(gl_GlobalInvocationID.x);
    if (row > int(field.rows)) {
        return;
    }
    float found_m = -1.0e30;
    float left_m = height_of(ivec2(-1, row - 1));
    float left_below_m = height_of(ivec2(-1, row));
    for (int column = 0; column <= int(field.columns); column++) {
        float right_m = height_of(ivec2(column, row - 1));
        float right_below_m = height_of(ivec2(column, row));
        float across_m = right_m - left_m;
        float down_m = left_below_m - left_m;
        imageStore(patches, ivec2(column, row), vec4(left_m, across_m, down_m, right_below_m - left_m - across_m - down_m));
        found_m = max(found_m, right_below_m);
        left_m = right_m;
        left_below_m = right_below_m;
    }
    if (row < int(field.rows)) {
        highest.rows[row] = found_m;
    }
}
