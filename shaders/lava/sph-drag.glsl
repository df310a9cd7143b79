// What two particles drag each other by, which is the same for both.

#ifdef RHEOLOGY_BASALT
layout(set = 0, binding = 9, std430) readonly buffer Viscosities {
    float list[]; // over the melt's
} viscosities;

float viscosity_at(uint at) {
    return viscosities.list[at];
}

// The harmonic mean, without the product, which single precision may not hold; the same in either order.
float mean_of(float a, float b) {
    return 2.0 * min(a, b) * (max(a, b) / (a + b));
}
#else
float viscosity_at(uint at) {
    return 1.0;
}

float mean_of(float a, float b) {
    return 1.0;
}
#endif

float drag_by(vec3 place_m, float viscosity, uint i) {
    float q = length(apart(place_m - began_m(i))) / flow.support_m;
    return -flow.drag * mean_of(viscosity, viscosity_at(i)) * slope(q);
}
