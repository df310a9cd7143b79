// The particles near each one: lists of them by `sph-neighbours`.

// Four numbers by cells in a texel, which are exact up to 16,777,216.
layout(set = 0, binding = 12, rgba32f) uniform readonly image2D neighbours;

layout(set = 0, binding = 13, std430) readonly buffer NeighbourCounts {
    uint list[]; // of each particle's, or WALKS
} neighbour_counts;

// Length of a particle's list, and how many stretches of cells it walks over in its place.
uvec2 reach_of(uint at) {
    uint count = neighbour_counts.list[at];
    return count == WALKS ? uvec2(0u, 9u) : uvec2(count, 0u);
}

// Four of its list from one on. Fewer are left at the end; what stands in place of the others is a particle too.
uvec4 neighbours_of(uint at, uint first) {
    return uvec4(ivec4(imageLoad(neighbours, four_of(at, first)))); // processors convert to int alone in one instruction
}

// Of four, of which so many are left.
vec4 weights_of(uint left) {
    return vec4(1.0, left > 1u ? 1.0 : 0.0, left > 2u ? 1.0 : 0.0, left > 3u ? 1.0 : 0.0);
}

// One of the nine around a particle.
uvec2 nth_stretch(vec3 place_m, uint n) {
    uvec2 stretch = stretch_at(place_m, int(n % 3u) - 1, int(n / 3u) - 1);
    return uvec2(stretch.x, min(stretch.y, stretch.x + MOST));
}
