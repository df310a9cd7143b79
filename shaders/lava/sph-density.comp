#version 450

// Eq. 8 to 11 of position-based fluids (Macklin and Mueller 2013): the density at the predicted places over that at rest,
// walls included, and the factor of its constraint. Lava that is pulled apart is let go: only what is too dense is pushed.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-lists.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) buffer Factors {
    vec2 list[]; // lambda times h^-2, and the density over that at rest
} factors;

// Softens the constraints: eq. 11's epsilon, times h^2. All are corrected at once, and inside lava the gradients' squares are
// 1.8: with a tenth of it the corrections overshoot and shake the particles by a part of their distance in every step.
const float SOFTNESS = 0.7;

vec3 place_m;
float sum = 0.0;
vec3 own = vec3(0.0);
float others = 0.0;

void gather(uint i) {
    vec3 way = apart(place_m - predicted.list[i].xyz) / flow.support_m;
    float q = length(way);
    sum += kernel(q);
    vec3 gradient = flow.volume * slope(q) * way;
    own += gradient;
    others += dot(gradient, gradient);
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    place_m = predicted.list[at].xyz;
    gather_around(at, began_m(at));
    Walls walls = walls_at(place_m);
    float density = flow.volume * sum + wall_share(walls);
    own += wall_gradient(walls);
    float push = max(density - 1.0, 0.0) / (dot(own, own) + others + SOFTNESS);
    factors.list[at] = vec2(-push, density);
}
