#version 450

// A corner of a triangle of the interface, in pixels from the top left.
layout(location = 0) in vec2 place;
layout(location = 1) in vec2 texel;
// Red, green, blue and alpha from the lowest byte up, sRGB with the alpha multiplied in.
layout(location = 2) in uint tint;

layout(push_constant) uniform Screen {
    vec2 pixels;
} screen;

layout(location = 0) out vec2 texel_out;
layout(location = 1) out vec4 tint_out;

void main() {
    gl_Position = vec4(2.0 * place / screen.pixels - 1.0, 0.0, 1.0);
    texel_out = texel;
    tint_out = vec4((uvec4(tint) >> uvec4(0u, 8u, 16u, 24u)) & 255u) / 255.0;
}
