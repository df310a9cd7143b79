#version 450

// Velocities after gravity alone, in the order of the cells: what viscosity takes. Its first guess is that
// it does as much as in the step before. Temperatures come with them.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"

layout(set = 0, binding = 4) uniform texture2D velocities;

layout(set = 0, binding = 5, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 6, std430) buffer Pushed {
    vec4 list[]; // metres per second, and kelvin as the step begins
} pushed;

layout(set = 0, binding = 7, rgba32f) uniform image2D to; // metres per second

layout(set = 0, binding = 8, std430) buffer Change {
    vec4 list[]; // metres per second
} change;

layout(set = 0, binding = 9, std430) readonly buffer Lasting {
    vec4 list[]; // by particles: metres per second that viscosity changed
} lasting;

layout(set = 0, binding = 14, std430) buffer Unmet {
    uint any[3]; // of `sph-viscosity`
} unmet;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    if (at == 0u) {
        unmet.any[0] = 0u;
        unmet.any[2] = 1u;
    }
    uint particle = items.list[at].y;
    ivec2 texel = ivec2(particle % flow.width, particle / flow.width);
    vec4 before = texelFetch(velocities, texel, 0);
    vec4 after = before + vec4(flow.time_step_s * flow.gravity_m_s2, 0.0);
    pushed.list[at] = after;
    vec3 changed = flow.kept * lasting.list[particle].xyz;
    imageStore(to, texel_of(at), vec4(after.xyz + changed, 0.0));
    change.list[at] = vec4(0.0);
}
