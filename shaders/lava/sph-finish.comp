#version 450

// The step's end: velocities from the places, both into the textures at the particles' numbers, with
// temperatures. The way that a particle has gone since the rock was laid on it is added up, for each of two
// layings that are renewed in turn, as they are stretched ever more (Neyret 2003). What viscosity did goes to the next
// step, which begins with it.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/sph.glsl"
#include "lava/sph-began.glsl"

layout(set = 0, binding = 4) uniform texture2D predicted; // metres

layout(set = 0, binding = 5, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 6, std430) readonly buffer Heat {
    vec2 list[]; // kelvin as the step ends, and the steepness of a particle's face
} heat;

layout(set = 0, binding = 7, rgba32f) uniform image2D positions;

layout(set = 0, binding = 8, rgba32f) uniform image2D velocities;

layout(set = 0, binding = 11) uniform texture2D carried_before; // metres along x and z, of both layings

layout(set = 0, binding = 12, rgba32f) uniform image2D carried_after;

layout(set = 0, binding = 13, std430) buffer Carried {
    vec4 list[]; // the same by cells
} carried;

layout(set = 0, binding = 9) uniform texture2D from; // metres per second: the last iterate of the viscosity

layout(set = 0, binding = 14, std430) readonly buffer Pushed {
    vec4 list[]; // metres per second: its right side
} pushed;

layout(set = 0, binding = 17, std430) buffer Arrived {
    vec4 list[]; // metres, by cells
} arrived;

layout(set = 0, binding = 16, std430) buffer Lasting {
    vec4 list[]; // by particles: metres per second that viscosity changed
} lasting;

void main() {
    uint at = element(64u);
    if (at >= flow.particles) {
        return;
    }
    uint particle = items.list[at].y;
    ivec2 texel = ivec2(particle % flow.width, particle / flow.width);
    vec3 place_m = texelFetch(predicted, texel_of(at), 0).xyz;
    arrived.list[at] = vec4(place_m, 0.0);
    vec2 turns = flow.periodic * floor(place_m.xz / flow.space_m.xz);
    vec3 within = vec3(place_m.x - turns.x * flow.space_m.x, place_m.y, place_m.z - turns.y * flow.space_m.z);
    vec2 way_m = place_m.xz - began_m(at).xz;
    vec2 kept = vec2(float(flow.kept_rock & 1u), float(flow.kept_rock >> 1u));
    vec4 carried_m = kept.xxyy * texelFetch(carried_before, texel, 0) + way_m.xyxy;
    carried.list[at] = carried_m;
    imageStore(carried_after, texel, carried_m);
    lasting.list[particle] = vec4(texelFetch(from, texel_of(at), 0).xyz - pushed.list[at].xyz, 0.0);
    imageStore(positions, texel, vec4(within, 0.0));
    imageStore(velocities, texel, vec4((place_m - began_m(at)) / flow.time_step_s, heat.list[at].x));
}
