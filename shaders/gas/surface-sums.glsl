// The fraction of a light that reaches a surface, by the sum of the density on its way, of which no part is left for another
// dispatch.

void take_up(uvec4 first, uvec3 second) {}

uvec4 first_left() {
    return uvec4(0u);
}

uvec3 second_left() {
    return uvec3(0u);
}

float passed_to_surface(uint l, vec3 point, uint pixel_index, uint triangle) {
    return transmittance_to(l, point);
}
