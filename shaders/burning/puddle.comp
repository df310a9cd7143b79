#version 450

// A tick of the puddle: it gains what the mesh has lost, spreads as a thin film, whose flow goes as the cube of its
// height (lubrication theory), and evaporates by its rate. Wax sets: what is thinner than a film does not flow, so that
// it comes to rest. Both cells of a side find the same flow through it: nothing is lost.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/puddle.glsl"

layout(set = 0, binding = 72, std430) buffer Films {
    Film film;
};

layout(set = 0, binding = 73, std430) readonly buffer Melted {
    uint melted[];
};

layout(set = 0, binding = 74, std430) readonly buffer OldHeights {
    uint old_heights[]; // volume of each cell
};

layout(set = 0, binding = 75, std430) buffer NewHeights {
    uint new_heights[];
};

// Thickness that sets, and that from which on as much flows as may; diagonals.
const float SETS = 0.04;
const float FLOWS = 0.05;
// Of the difference of two cells, through their side in a tick; four sides take less than there is.
const float MOST = 0.2;
// Down which nothing flows.
const float SLOPE = 0.02;

uint flow_from(uint high, uint low) {
    float thickness = clamp((float(high) * HEIGHT_OF_UNIT - SETS) / (FLOWS - SETS), 0.0, 1.0);
    float driving = max(float(high - low) - SLOPE * CELL_WIDTH / HEIGHT_OF_UNIT, 0.0);
    return uint(MOST * thickness * thickness * thickness * driving);
}

void main() {
    uint thread = element(64u);
    if (thread >= uint(PUDDLE_CELLS * PUDDLE_CELLS)) {
        return;
    }
    float gained = max(float(film.volume_at_start - film.mesh_volume - int(film.puddle_volume) - int(film.evaporated_before)), 0.0);
    uint height = old_heights[thread];
    uint left = height;
    ivec2 cell = ivec2(int(thread) % PUDDLE_CELLS, int(thread) / PUDDLE_CELLS);
    for (int side = 0; side < 4; side++) {
        ivec2 beside = cell + (side < 2 ? ivec2(2 * side - 1, 0) : ivec2(0, 2 * side - 5));
        if (all(greaterThanEqual(beside, ivec2(0))) && all(lessThan(beside, ivec2(PUDDLE_CELLS)))) {
            uint other = old_heights[beside.y * PUDDLE_CELLS + beside.x];
            if (other < height) {
                left -= flow_from(height, other);
            } else if (other > height) {
                left += flow_from(other, height);
            }
        }
    }
    if (film.weight > 0u) {
        left += uint(gained * (float(melted[thread]) / float(film.weight)));
    }
    uint evaporated = min(left, uint(constants.evaporation_per_tick / HEIGHT_OF_UNIT));
    new_heights[thread] = left - evaporated;
    if (left > evaporated) {
        atomicAdd(film.spread_volume, left - evaporated);
    }
    if (evaporated > 0u) {
        atomicAdd(film.evaporated, evaporated);
    }
}
