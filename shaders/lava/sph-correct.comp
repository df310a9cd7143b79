#version 450

// Eq. 12 of position-based fluids (Macklin and Mueller 2013): where the constraints push each particle, and walls. What two
// particles do to each other is opposite and equal.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-inside.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) readonly buffer Factors {
    vec2 list[]; // lambda times h^-2, and the density over that at rest
} factors;

layout(set = 0, binding = 6, std430) buffer Corrected {
    vec4 list[]; // metres
} corrected;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 began = began_m(at);
    vec3 place_m = predicted.list[at].xyz;
    float factor = factors.list[at].x;
    vec3 pushed = vec3(0.0);
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(began, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            for (uint i = stretch.x; i < end; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz) / flow.support_m;
                pushed += (factor + factors.list[i].x) * slope(length(way)) * way;
            }
        }
    }
    pushed = flow.volume * pushed + factor * wall_gradient(walls_at(place_m));
    corrected.list[at] = vec4(inside(place_m + flow.support_m * pushed), 0.0);
}
