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
#include "lava/sph-drag.glsl"

layout(set = 0, binding = 4, std430) readonly buffer Drags {
    float list[]; // as the lists
} drags;

layout(set = 0, binding = 5, std430) readonly buffer WallDrags {
    float list[];
} wall_drags;

layout(set = 0, binding = 6, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second
} pushed;

layout(set = 0, binding = 7, std430) readonly buffer From {
    vec4 list[];
} from;

layout(set = 0, binding = 8, std430) buffer To {
    vec4 list[];
} to;

layout(set = 0, binding = 11, std430) buffer Change {
    vec4 list[];
} change;

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // 1 where an iteration of this turn leaves a residual that is not small
} unmet;

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
    vec3 velocity = from.list[at].xyz;
    if (is_met) {
        to.list[at] = vec4(velocity, 0.0);
        return;
    }
    uvec2 reach = reach_of(at);
    vec3 dragged = wall_drags.list[at] * velocity;
    for (uint n = 0u; n < reach.x; n++) {
        dragged += drags.list[n * flow.listed + at] * (velocity - from.list[neighbour_of(at, n)].xyz);
    }
    if (reach.y > 0u) {
        vec3 place_m = began_m(at);
        float viscosity = viscosity_at(at);
        for (uint n = 0u; n < reach.y; n++) {
            uvec2 stretch = nth_stretch(place_m, n);
            for (uint i = stretch.x; i < stretch.y; i++) {
                dragged += drag_by(place_m, viscosity, i) * (velocity - from.list[i].xyz);
            }
        }
    }
    vec3 residual = pushed.list[at].xyz - (velocity + dragged);
    vec3 changed = flow.kept * change.list[at].xyz + flow.gained * residual;
    change.list[at] = vec4(changed, 0.0);
    to.list[at] = vec4(velocity + changed, 0.0);
    if (length(residual) > SMALL * flow.time_step_s * length(flow.gravity_m_s2)) {
        unmet.any[flow.turn] = 1u;
    }
}
