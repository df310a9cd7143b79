#version 450

// The rock texture from a buffer of packed sRGB texels into an sRGB target, which encodes again; at load. A border one
// texel wide repeats the opposite side, so that a filter finds its neighbours across the seam.

layout(set = 0, binding = 0, std430) readonly buffer Rock {
    uint packed_texels[];
};

layout(push_constant, std430) uniform Texels {
    uvec2 size; // without the border
} texels;

layout(location = 0) out vec4 color;

float to_linear(float encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

void main() {
    uvec2 texel = (uvec2(gl_FragCoord.xy) + texels.size - 1u) % texels.size;
    vec4 encoded = unpackUnorm4x8(packed_texels[texel.y * texels.size.x + texel.x]);
    color = vec4(to_linear(encoded.r), to_linear(encoded.g), to_linear(encoded.b), 1.0);
}
