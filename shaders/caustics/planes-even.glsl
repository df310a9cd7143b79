// Planes of equal cells (section 4.2.1), as culling finds them.

uint plane_count() {
    return cull.planes;
}

// How far a plane lies under the uppermost: one a plane.
float descent_to(float plane) {
    return plane;
}

// How far a ray of slope 1 moves meanwhile.
vec2 descent_texels() {
    return cull.texels_per_m / cull.cells_per_m;
}

float plane_of(float height) {
    return by_cell((cull.top - height) * cull.cells_per_m, height, 0.0, float(cull.planes) - 1.0, 2.0e-3);
}
