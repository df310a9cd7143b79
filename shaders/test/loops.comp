#version 450

// Counts the iterations that a loop makes, twice. The numbers run through all 32-bit values in an order that no compiler
// counts ahead.

layout(local_size_x = 1) in;

layout(set = 0, binding = 0, std430) readonly buffer Wanted {
    uint last[]; // numbers at which the loops are to end
};

layout(set = 0, binding = 1, std430) buffer Made {
    uint made[]; // iterations of each loop
};

void main() {
    for (uint i = 0u; i < 2u; i++) {
        uint number = 0u;
        uint count = 0u;
        while (number != last[i]) {
            number = number * 1664525u + 1013904223u;
            count++;
        }
        made[i] = count;
    }
}
