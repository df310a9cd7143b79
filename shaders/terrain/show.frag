#version 450

// The processor's picture and depth, from its memory.

layout(set = 0, binding = 0, std430) readonly buffer Colors {
    uint values[]; // red in the lowest byte
} colors;

layout(set = 0, binding = 1, std430) readonly buffer Depths {
    vec4 values[];
} depths;

layout(push_constant, std430) uniform Size {
    uint columns;
} size;

layout(location = 0) out vec4 picture;
layout(location = 1) out vec4 depth;

void main() {
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uint index = pixel.y * size.columns + pixel.x;
    picture = unpackUnorm4x8(colors.values[index]);
    depth = depths.values[index];
}
