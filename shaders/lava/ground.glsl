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

bool is_bare(vec3 place_m) {
    return place_m.y - ground_m(place_m.xz) <= scene.bare_m;
}
