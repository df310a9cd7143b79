#version 450

// Eq. 6.2 summed over the particles around a column of four grid planes, gathered from the cells that a radius reaches. Cells
// along y follow each other, so each neighbouring column of cells is one stretch of the sorted particles.
//
// lavapipe ends all loops of a shader after 65,535 iterations. A dispatch takes a piece of every stretch; where one is longer,
// the next piece is marked as reached, and its dispatch adds to the sums.

layout(local_size_x = 8, local_size_y = 8) in;

#include "common/texels.glsl"

layout(push_constant, std430) uniform Gather {
    vec3 space_m;
    float per_radius; // 1 / h, per metre
    uvec3 grid; // columns, planes, rows
    uint piece;
    uvec3 cells; // along x, y and z
    float radius_m; // h
    uvec3 first; // grid point and layer of the dispatch
    float peak; // F(0, h)
} gather;

layout(set = 0, binding = 0, std430) readonly buffer Starts {
    uint list[];
} starts;

layout(set = 0, binding = 1, rgba32f) uniform readonly image2D places_by_cells; // metres

layout(set = 0, binding = 4, std430) buffer Reached {
    uint list[]; // of each piece: 0, or REACHED where some stretch has it; 2 for the first
} reached;

layout(set = 0, binding = 5, rgba32f) uniform image2DArray density;

// Particles of a stretch in one piece, four an iteration: nine stretches are 64,512 iterations.
const uint PIECE = 28672u;
const uint REACHED = 1u;
const float NO_PLANE_M = 1.0e9;

// F over its peak, at four heights.
vec4 metaballs(uint at, uint end, vec2 column_m, vec4 heights_m) {
    vec3 place_m = imageLoad(places_by_cells, texel_of(min(at, end - 1u))).xyz;
    vec2 across = (place_m.xz - column_m) * gather.per_radius;
    vec4 up = (heights_m - place_m.y) * gather.per_radius;
    // Far away a square may be infinite.
    vec4 a_squared = min(dot(across, across) + up * up, 2.0);
    vec4 inside = at < end ? max(1.0 - a_squared, 0.0) : vec4(0.0);
    return inside * inside * (1.0 - 4.0 / 9.0 * a_squared);
}

uvec3 cell_of(vec3 place_m) {
    return min(uvec3(max(place_m / gather.space_m, 0.0) * vec3(gather.cells)), gather.cells - 1u);
}

void main() {
    uvec3 at = gather.first + gl_GlobalInvocationID;
    uint state = reached.list[gather.piece];
    if (state == 0u || at.x >= gather.grid.x || at.y >= gather.grid.z) {
        return;
    }
    vec2 column_m = (vec2(at.xy) + 0.5) / vec2(gather.grid.xz) * gather.space_m.xz;
    vec4 planes = float(4u * at.z) + vec4(0.0, 1.0, 2.0, 3.0);
    vec4 heights_m = (planes + 0.5) / float(gather.grid.y) * gather.space_m.y;
    float highest_m = min(heights_m.w, gather.space_m.y);
    heights_m = mix(heights_m, vec4(NO_PLANE_M), greaterThan(planes, vec4(float(gather.grid.y) - 0.5)));
    uvec3 low = cell_of(vec3(column_m.x, heights_m.x, column_m.y) - gather.radius_m);
    uvec3 high = cell_of(vec3(column_m.x, highest_m, column_m.y) + gather.radius_m);
    // A cell is as wide as the radius: beyond three nothing is near, however rounding has it.
    high.xz = min(high.xz, low.xz + 2u);
    vec4 sum = vec4(0.0);
    bool goes_on = false;
    for (uint z = low.z; z <= high.z; z++) {
        for (uint x = low.x; x <= high.x; x++) {
            uint column = (z * gather.cells.x + x) * gather.cells.y;
            uint last = starts.list[column + high.y + 1u];
            uint first = min(starts.list[column + low.y] + gather.piece * PIECE, last);
            uint end = min(first + PIECE, last);
            goes_on = goes_on || end < last;
            for (uint i = first; i < end; i += 4u) {
                vec4 two = metaballs(i, end, column_m, heights_m) + metaballs(i + 1u, end, column_m, heights_m);
                sum += two + (metaballs(i + 2u, end, column_m, heights_m) + metaballs(i + 3u, end, column_m, heights_m));
            }
        }
    }
    ivec3 texel = ivec3(at);
    sum *= gather.peak;
    if (state == REACHED) {
        sum += imageLoad(density, texel);
    }
    imageStore(density, texel, sum);
    if (goes_on) {
        reached.list[gather.piece + 1u] = REACHED;
    }
}
