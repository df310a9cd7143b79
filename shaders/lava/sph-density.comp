#version 450

// Eq. 8 to 11 of position-based fluids (Macklin and Mueller 2013): the density at the predicted places over that at rest,
// walls included, and the factor of its constraint. Lava that is pulled apart is let go: only what is too dense is pushed.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Predicted {
    vec4 list[]; // metres
} predicted;

layout(set = 0, binding = 5, std430) buffer Factors {
    vec2 list[]; // lambda times h^-2, and the density over that at rest
} factors;

layout(set = 0, binding = 6, std430) buffer Crowded {
    uint any; // 1 where a stretch has more particles than a loop may
} crowded;

// Softens the constraints: eq. 11's epsilon, times h^2. All are corrected at once, and inside lava the gradients' squares are
// 1.8: with a tenth of it the corrections overshoot and shake the particles by a part of their distance in every step.
const float SOFTNESS = 0.7;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    vec3 began = began_m(at);
    vec3 place_m = predicted.list[at].xyz;
    float sum = 0.0;
    vec3 own = vec3(0.0);
    float others = 0.0;
    bool is_crowded = false;
    for (int z = -1; z <= 1; z++) {
        for (int x = -1; x <= 1; x++) {
            uvec2 stretch = stretch_at(began, x, z);
            uint end = min(stretch.y, stretch.x + MOST);
            is_crowded = is_crowded || end < stretch.y;
            for (uint i = stretch.x; i < end; i++) {
                vec3 way = apart(place_m - predicted.list[i].xyz) / flow.support_m;
                float q = length(way);
                sum += kernel(q);
                vec3 gradient = flow.volume * slope(q) * way;
                own += gradient;
                others += dot(gradient, gradient);
            }
        }
    }
    Walls walls = walls_at(place_m);
    float density = flow.volume * sum + wall_share(walls);
    own += wall_gradient(walls);
    float push = max(density - 1.0, 0.0) / (dot(own, own) + others + SOFTNESS);
    factors.list[at] = vec2(-push, density);
    if (is_crowded) {
        crowded.any = 1u;
    }
}
