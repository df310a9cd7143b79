#version 450

// The highest place of each row of the height field.

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

void main() {
    uint row = gl_GlobalInvocationID.x;
    if (row >= field.rows) {
        return;
    }
    float found_m = -1.0e30;
    for (uint column = 0u; column < field.columns; column++) {
        found_m = max(found_m, texelFetch(normal_height, ivec2(column, row), 0).w);
    }
    highest.rows[row] = found_m;
}
