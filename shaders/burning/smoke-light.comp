#version 450

// The extinction of each cell of the smoke, with the light there times it.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/billboards.glsl"
#include "burning/light-flames.glsl"
#include "burning/smoke.glsl"
#include "burning/smoke-volume.glsl"

layout(set = 0, binding = 57, std430) readonly buffer SmokeGrid {
    SmokeBox grid;
};

layout(set = 0, binding = 58, std430) readonly buffer SmokeSums {
    uint smoke_sums[];
};

layout(set = 0, binding = 59, std430) buffer SmokeCells {
    vec4 smoke_cells[]; // light times extinction, linear RGB; extinction, 1 over diagonals
};

void main() {
    uint number = element(64u);
    if (number >= SMOKE_CELL_COUNT) {
        return;
    }
    vec4 lit = vec4(0.0);
    if (smoke_sums[number] > 0u) {
        int cell = int(number);
        ivec3 at = ivec3(cell % SMOKE_CELLS, (cell / SMOKE_CELLS) % SMOKE_CELLS, cell / (SMOKE_CELLS * SMOKE_CELLS));
        vec3 place = grid.low + (vec3(at) + 0.5) * grid.cell_width;
        vec3 light = SMOKE_GREY + SMOKE_ALBEDO * scattered(place);
        float unit = billboards.particle_radius * billboards.particle_radius / SMOKE_UNITS;
        float width = grid.cell_width;
        float extinction = float(smoke_sums[number]) * unit / (width * width * width);
        lit = vec4(light * extinction, extinction);
    }
    smoke_cells[number] = lit;
}
