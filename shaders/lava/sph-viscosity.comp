#version 450

#pragma variants RHEOLOGY=constant,basalt

// One step of Chebyshev's semi-iteration (Golub and Varga 1961) on the implicit viscosity of Morris et al. (1997):
// (1 + sum of a_ij + a_wall) v_i - sum of a_ij v_j = what gravity left. The matrix is symmetric and its rows add up to 1, so
// no step changes the momentum of lava that touches no wall; no sum over all particles is needed. A velocity is as far off as the
// largest residual at most, since no row of the inverse adds up to more than 1: once every residual is small nothing changes any more.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-lists.glsl"
#include "lava/sph-began.glsl"
#include "lava/sph-drag.glsl"

layout(set = 0, binding = 4) uniform texture2D drags; // as the lists

layout(set = 0, binding = 5, std430) readonly buffer WallDrags {
    float list[];
} wall_drags;

layout(set = 0, binding = 6, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second
} pushed;

layout(set = 0, binding = 7) uniform texture2D from;

layout(set = 0, binding = 8, rgba32f) uniform image2D to;

layout(set = 0, binding = 11, std430) buffer Change {
    vec4 list[];
} change;

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // 1 where an iteration of this turn leaves a residual that is not small
} unmet;

vec3 velocity_of(uint at) {
    return texelFetch(from, texel_of(at), 0).xyz;
}

// Of what gravity changes in a step.
const float SMALL = 3.0e-4;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    bool is_met = unmet.any[(flow.turn + 2u) % 3u] == 0u;
    if (at == 0u) {
        unmet.any[(flow.turn + 1u) % 3u] = 0u;
    }
    vec3 velocity = velocity_of(at);
    if (is_met) {
        imageStore(to, texel_of(at), vec4(velocity, 0.0));
        return;
    }
    uvec2 reach = reach_of(at);
    vec3 dragged = wall_drags.list[at] * velocity;
    for (uint first = 0u; first < reach.x; first += 4u) {
        vec4 four = neighbours_of(at, first);
        vec4 drag = texelFetch(drags, four_of(at, first), 0);
        uint count = min(reach.x - first, 4u);
        for (uint n = 0u; n < count; n++) {
            dragged += drag.x * (velocity - velocity_of(uint(four.x)));
            drag = drag.yzwx;
            four = four.yzwx;
        }
    }
    if (reach.y > 0u) {
        vec3 place_m = began_m(at);
        float viscosity = viscosity_at(at);
        for (uint n = 0u; n < reach.y; n++) {
            uvec2 stretch = nth_stretch(place_m, n);
            for (uint i = stretch.x; i < stretch.y; i++) {
                dragged += drag_by(place_m, viscosity, i) * (velocity - velocity_of(i));
            }
        }
    }
    vec3 residual = pushed.list[at].xyz - (velocity + dragged);
    vec3 changed = flow.kept * change.list[at].xyz + flow.gained * residual;
    change.list[at] = vec4(changed, 0.0);
    imageStore(to, texel_of(at), vec4(velocity + changed, 0.0));
    if (length(residual) > SMALL * flow.time_step_s * length(flow.gravity_m_s2)) {
        unmet.any[flow.turn] = 1u;
    }
}
