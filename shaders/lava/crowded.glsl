// Set to 1 by passes that left out particles which count: more of them lie in one place than loops may take.

layout(set = 0, binding = 16, std430) buffer Crowded {
    uint by_neighbours; // sph-neighbours
    uint by_temperature; // surface-temperature
    uint by_motion; // surface-motion
    uint by_relief; // crust-relief
} crowded;
