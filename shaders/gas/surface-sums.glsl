// The fraction of a light that reaches a surface, by the sum of the density on its way.

float passed_to_surface(uint l, vec3 point, uint pixel_index, uint triangle) {
    return transmittance_to(l, point);
}
