#version 450

// Before the smoke's extinction is summed.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/smoke-volume.glsl"

layout(set = 0, binding = 58, std430) buffer SmokeSums {
    uint smoke_sums[];
};

void main() {
    uint cell = element(64u);
    if (cell < SMOKE_CELL_COUNT) {
        smoke_sums[cell] = 0u;
    }
}
