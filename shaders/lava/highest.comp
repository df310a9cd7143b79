#version 450

// The highest place of all rows: no ray meets anything above it.

layout(local_size_x = 1) in;

layout(push_constant, std430) uniform Field {
    uint columns;
    uint rows;
} field;

layout(set = 0, binding = 0, std430) buffer Highest {
    float all; // metres
    float rows[];
} highest;

void main() {
    float found_m = -1.0e30;
    for (uint row = 0u; row < field.rows; row++) {
        found_m = max(found_m, highest.rows[row]);
    }
    highest.all = found_m;
}
