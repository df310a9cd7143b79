// The density inside the solid of the volume in hand, by one of the files density-*.glsl.

// Density inside the solid, faded towards its boundary so that the boundary cannot be seen. Of a hypertexture solid it
// is the extinction that makes opacity = 1 - (1 - density)^(c step), so that gas and solid share one march: -ln(1 -
// density).
float volume_density(vec3 world) {
    float inside = inwardness(world);
    if (inside < -1.0e-4) {
        return 0.0;
    }
    made++;
    float density = gas_density(world);
    float falloff = in_hand.falloff;
    if (falloff > 0.0) {
        float t = clamp(inside / falloff, 0.0, 1.0);
        density *= t * t * (3.0 - 2.0 * t);
    }
    return in_hand.is_solid != 0u ? -log(1.0 - clamp(density, 0.0, 0.9999)) : density;
}
