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

// Asked for where there is no list alone, so sampled: the other four are as many storage images as every device has.
layout(set = 0, binding = 1) uniform texture2D places_by_cells; // metres, as the step begins

vec3 began_m(uint at) {
    return texelFetch(places_by_cells, texel_of(at), 0).xyz;
}

#include "lava/sph-drag.glsl"

layout(set = 0, binding = 4, rgba32f) uniform readonly image2D drags; // as the lists, 0 for what only fills up the last four

layout(set = 0, binding = 5, std430) readonly buffer WallDrags {
    float list[];
} wall_drags;

layout(set = 0, binding = 6, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second
} pushed;

layout(set = 0, binding = 7, rgba32f) uniform readonly image2D from;

layout(set = 0, binding = 8, rgba32f) uniform image2D to;

layout(set = 0, binding = 11, std430) buffer Change {
    vec4 list[];
} change;

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // 1 where an iteration of this turn leaves a residual that is not small
} unmet;

vec3 velocity_of(uint at) {
    return imageLoad(from, texel_of(at)).xyz;
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
        uvec4 four = neighbours_of(at, first);
        vec4 drag = imageLoad(drags, four_of(at, first));
        dragged += drag.x * (velocity - velocity_of(four.x));
        dragged += drag.y * (velocity - velocity_of(four.y));
        dragged += drag.z * (velocity - velocity_of(four.z));
        dragged += drag.w * (velocity - velocity_of(four.w));
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
