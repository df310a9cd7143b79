#version 450

// The rock texture from a buffer of packed texels, as they are; at load. A border one texel wide repeats the opposite
// side, so that a filter finds its neighbours across the seam.

layout(set = 0, binding = 0, std430) readonly buffer Rock {
    uint packed_texels[];
};

layout(push_constant, std430) uniform Texels {
    uvec2 size; // without the border
} texels;

layout(location = 0) out vec4 color;

void main() {
    uvec2 texel = (uvec2(gl_FragCoord.xy) + texels.size - 1u) % texels.size;
    color = unpackUnorm4x8(packed_texels[texel.y * texels.size.x + texel.x]);
}
