#version 450

// Before a tick's weights are summed, and the puddle's volume.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/puddle.glsl"

layout(set = 0, binding = 72, std430) buffer Films {
    Film film;
};

layout(set = 0, binding = 73, std430) buffer Melted {
    uint melted[]; // weight of what melts over each cell
};

void main() {
    uint thread = element(64u);
    if (thread < uint(PUDDLE_CELLS * PUDDLE_CELLS)) {
        melted[thread] = 0u;
    }
    if (thread == 0u) {
        film.puddle_volume = film.spread_volume;
        film.spread_volume = 0u;
        film.evaporated_before = film.evaporated;
        film.weight = 0u;
    }
}
