#version 450

// Eq. 8 to 11 of position-based fluids (Macklin and Mueller 2013): the density at the predicted places over that at rest,
// walls included, and the factor of its constraint. Lava that is pulled apart is let go: only what is too dense is pushed. Once
// none is too dense nothing changes any more. No step begins with what the last one pushed (Bender and Koschier 2017): what that has
// pushed apart would be pushed apart once more, and energy would come from nothing.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-began.glsl"
#include "lava/bed.glsl"
#include "lava/sph-walls.glsl"
#include "lava/sph-lists.glsl"

layout(set = 0, binding = 4, rgba32f) uniform readonly image2D predicted; // metres

layout(set = 0, binding = 5, std430) buffer Factors {
    vec2 list[]; // lambda times h^-2, and the density over that at rest
} factors;

layout(set = 0, binding = 7, rgba32f) uniform image2D pushing; // metres, and the factor

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // 1 where the correction of this turn finds any too dense
} unmet;

const float DENSE = 1.01;

// Softens the constraints: eq. 11's epsilon, times h^2. All are corrected at once, and inside lava the gradients' squares are
// 1.8: with a tenth of it the corrections overshoot and shake the particles by a part of their distance in every step.
const float SOFTNESS = 0.7;

vec3 place_m;
float sum = 0.0;
vec3 own = vec3(0.0);
float others = 0.0;

void gather(uint i, float weight) {
    vec3 way = apart(place_m - imageLoad(predicted, texel_of(i)).xyz) / flow.support_m;
    float q = length(way);
    sum += weight * kernel(q);
    vec3 gradient = weight * flow.volume * slope(q) * way;
    own += gradient;
    others += dot(gradient, gradient);
}

#include "lava/sph-gather.glsl"

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    bool is_met = unmet.any[(flow.turn + 2u) % 3u] == 0u;
    if (at == 0u) {
        unmet.any[(flow.turn + 1u) % 3u] = 0u;
    }
    place_m = imageLoad(predicted, texel_of(at)).xyz;
    if (is_met) {
        imageStore(pushing, texel_of(at), vec4(place_m, 0.0));
        return;
    }
    gather_around(at, began_m(at));
    Walls walls = walls_at(place_m);
    float density = flow.volume * sum + wall_share(walls);
    own += wall_gradient(walls);
    float push = max(density - 1.0, 0.0) / (dot(own, own) + others + SOFTNESS);
    factors.list[at] = vec2(-push, density);
    imageStore(pushing, texel_of(at), vec4(place_m, -push));
    if (density > DENSE) {
        unmet.any[flow.turn] = 1u;
    }
}
