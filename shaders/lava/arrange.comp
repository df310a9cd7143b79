#version 450

// The particles' places in the order of their cells, and the pieces of `density` that are known to be there: the first.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/cells.glsl"
#include "common/texels.glsl"

layout(set = 0, binding = 0) uniform texture2D positions;

layout(set = 0, binding = 1, std430) readonly buffer Items {
    uvec2 list[]; // cell and particle, by cells
} items;

layout(set = 0, binding = 2, rgba32f) uniform writeonly image2D places_by_cells; // metres

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
    imageStore(places_by_cells, texel_of(at), vec4(position_m, 0.0));
}
