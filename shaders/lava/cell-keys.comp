#version 450

// The cell of every particle (section 5.2), beside its number: what is sorted.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "lava/cells.glsl"

layout(set = 0, binding = 0) uniform texture2D positions;

layout(set = 0, binding = 1, std430) buffer Items {
    uvec2 list[]; // cell and particle
} items;

void main() {
    uint particle = element(64u);
    if (particle >= cells.particles) {
        return;
    }
    vec3 position_m = inside(texelFetch(positions, ivec2(particle % cells.width, particle / cells.width), 0).xyz);
    uvec3 cell = min(uvec3(position_m / cells.space_m * vec3(cells.counts)), cells.counts - 1u);
    items.list[particle] = uvec2((cell.z * cells.counts.x + cell.x) * cells.counts.y + cell.y, particle);
}
