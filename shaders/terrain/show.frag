#version 450

// The picture of the processor's variant, from its bytes.

layout(set = 0, binding = 0, std430) readonly buffer Colors {
    uint values[]; // red in the lowest byte
} colors;

layout(push_constant, std430) uniform Size {
    uint columns;
} size;

layout(location = 0) out vec4 picture;

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    picture = unpackUnorm4x8(colors.values[pixel.y * size.columns + pixel.x]);
}
