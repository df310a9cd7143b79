// Planes of smart slicing (section 4.7.2), as culling finds them: by the sub-boxes that hold the receiver.

#include "caustics/levels.glsl"
#include "caustics/slices.glsl"

layout(std430, set = 0, binding = 8) readonly buffer Sliced {
    vec4 list[]; // the Slices of each level
} sliced;

layout(std430, set = 0, binding = 9) readonly buffer Placed {
    uint planes;
    uint boxes;
} placed;

uint plane_count() {
    return min(placed.planes, cull.planes);
}

// How far a plane lies under the uppermost, metres.
float descent_to(float plane) {
    return cells.list[0].height - cells.list[uint(plane)].height;
}

// How far a ray of slope 1 moves meanwhile.
vec2 descent_texels() {
    return cull.texels_per_m;
}

float plane_of(float height) {
    uint level = level_of(height, (cull.top - height) * cull.depth_levels_per_m, cull.depth_levels);
    Slices slices = slices_of(sliced.list[level]);
    // No cell is lower than 2^-16 of the box.
    return by_cell((slices.top - height) * slices.cells_per_m, height, slices.first_plane, slices.last_plane, 0.05);
}
