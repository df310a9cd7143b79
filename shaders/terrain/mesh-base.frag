#version 450

// The base under and around the triangle grids.

#pragma variants BASE=plane,curved

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/terrain.glsl"
#include "terrain/levels.glsl"
#include "terrain/base-{BASE}.glsl"

layout(location = 0) out vec4 depth;

void main() {
    vec3 direction = direction_of(floor(gl_FragCoord.xy));
    float base_m = base_depth(direction).x;
    depth = vec4(base_m, base_place(direction, base_m), surface_code(base_m < NO_DEPTH ? BASE : SKY, 0, 0));
    // Where the map lies in the base, the map is seen: the base counts as a little farther away.
    gl_FragDepth = terrain.near_m / max(base_m * 1.001, terrain.near_m);
}
