#version 450

// Eq. 12 of position-based fluids (Macklin and Mueller 2013): where the constraints push each particle, and walls. What two
// particles do to each other is opposite and equal.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-began.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-inside.glsl"
#include "lava/sph-lists.glsl"

layout(set = 0, binding = 4, rgba32f) uniform readonly image2D pushing; // metres, and lambda times h^-2

layout(set = 0, binding = 6, rgba32f) uniform image2D corrected; // metres

layout(set = 0, binding = 14, std430) readonly buffer Unmet {
    uint any[3]; // of `sph-density`
} unmet;

vec3 place_m;
float factor;
vec3 pushed = vec3(0.0);

void gather(uint i, float weight) {
    vec4 other = imageLoad(pushing, texel_of(i));
    vec3 way = apart(place_m - other.xyz) / flow.support_m;
    pushed += weight * (factor + other.w) * slope(length(way)) * way;
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec4 own = imageLoad(pushing, texel_of(at));
    place_m = own.xyz;
    if (unmet.any[(flow.turn + 2u) % 3u] == 0u) {
        imageStore(corrected, texel_of(at), vec4(place_m, 0.0));
        return;
    }
    factor = own.w;
    gather_around(at, began_m(at));
    pushed = flow.volume * pushed + factor * wall_gradient(walls_at(place_m));
    imageStore(corrected, texel_of(at), vec4(inside(place_m + flow.support_m * pushed), 0.0));
}
