#version 450

// The first particle of each cell in the sorted list, and its end behind the last cell, by bisection.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/cells.glsl"

layout(set = 0, binding = 0, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 1, std430) buffer Starts {
    uint list[];
} starts;

void main() {
    uint cell = element(64u);
    if (cell > cells.counts.x * cells.counts.y * cells.counts.z) {
        return;
    }
    uint low = 0u;
    uint high = cells.particles;
    while (low < high) {
        uint middle = (low + high) / 2u;
        if (items.list[middle].x < cell) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    starts.list[cell] = low;
}
