#version 450
#pragma variants TREE=whole,pieces

// The scene as seen from above the water (chapter 1, section 2.4) under waves.

#include "caustics/waves.glsl"

layout(push_constant) uniform Water {
    uint wave_count;
    float eta; // refraction index of air over that of water
    float absorption_per_m;
} water;

// Height above the level in x, slopes along x and z in y and z.
vec3 surface_at(vec2 place) {
    return wave_at(place, water.wave_count);
}

#include "caustics/view-above.glsl"
