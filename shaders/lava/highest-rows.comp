#version 450

// The heights by themselves, which a ray reads many of, and the highest place of each row.

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

layout(set = 0, binding = 2, std430) buffer Heights {
    float list[]; // metres, row by row
} heights;

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= field.rows) {
        return;
    }
    float found_m = -1.0e30;
    for (uint column = 0u; column < field.columns; column++) {
        float height_m = texelFetch(normal_height, ivec2(column, row), 0).w;
        heights.list[row * field.columns + column] = height_m;
        found_m = max(found_m, height_m);
    }
    highest.rows[row] = found_m;
}
