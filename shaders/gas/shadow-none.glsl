// Nothing hides a light from the gas.

float transmittance_to(uint l, vec3 point) {
    return 1.0;
}
