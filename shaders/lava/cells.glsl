// Cells of the simulation space, in which the variant gpu-driven sorts its particles: neighbours along y follow each other.

layout(push_constant, std430) uniform Cells {
    vec3 space_m;
    uint particles;
    uvec3 counts; // cells along x, y and z
    uint width; // of the particles' textures
    uint pieces; // of the lists of `density`
} cells;

// A particle may have left the space by one step; it counts at the nearest point inside.
vec3 inside(vec3 position_m) {
    return clamp(position_m, vec3(0.0), cells.space_m);
}
