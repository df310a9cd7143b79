#version 450

// The particles' places in the order of their cells, and the pieces of `density` that are known to be there: the first.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/cells.glsl"

layout(set = 0, binding = 0) uniform texture2D positions;

layout(set = 0, binding = 1, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 2, std430) buffer Xs {
    float list[]; // metres
} xs;

layout(set = 0, binding = 3, std430) buffer Ys {
    float list[];
} ys;

layout(set = 0, binding = 4, std430) buffer Zs {
    float list[];
} zs;

layout(set = 0, binding = 5, std430) buffer Reached {
    uint list[];
} reached;

void main() {
    uint at = element(64u);
    if (at < cells.pieces) {
        reached.list[at] = at == 0u ? 2u : 0u;
    }
    if (at >= cells.particles) {
        return;
    }
    uint particle = items.list[at].y;
    vec3 position_m = inside(texelFetch(positions, ivec2(particle % cells.width, particle / cells.width), 0).xyz);
    xs.list[at] = position_m.x;
    ys.list[at] = position_m.y;
    zs.list[at] = position_m.z;
}
