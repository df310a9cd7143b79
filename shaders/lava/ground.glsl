// Height of the ground under a place, and places that have no lava on it.

#include "lava/bed.glsl"

#ifdef SIMULATION_SPH
float ground_m(vec2 place_m) {
    return bed_at(place_m / scene.space_m.xz).z;
}
#else
float ground_m(vec2 place_m) {
    return 0.0;
}
#endif

// Beyond the middles of the outermost columns the surface is level, and the ground is not.
bool is_bare(vec3 place_m) {
    vec2 half_m = 0.5 * scene.space_m.xz / scene.columns;
    return place_m.y - ground_m(clamp(place_m.xz, half_m, scene.space_m.xz - half_m)) <= scene.bare_m;
}
