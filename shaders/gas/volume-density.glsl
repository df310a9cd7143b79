// The density inside a solid, by one of the files density-*.glsl.

// Density inside the solid, faded towards its boundary so that the boundary cannot be seen. Of a hypertexture solid it
// is the extinction that makes opacity = 1 - (1 - density)^(c step), so that gas and solid share one march: -ln(1 -
// density).
float volume_density(uint v, vec3 world) {
    float inside = inwardness(v, world);
    if (inside < -1.0e-4) {
        return 0.0;
    }
    made++;
    float density = gas_density(v, world);
    float falloff = volumes[v].falloff;
    if (falloff > 0.0) {
        float t = clamp(inside / falloff, 0.0, 1.0);
        density *= t * t * (3.0 - 2.0 * t);
    }
    return volumes[v].is_solid != 0u ? -log(1.0 - clamp(density, 0.0, 0.9999)) : density;
}
