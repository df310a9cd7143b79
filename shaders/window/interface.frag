#version 450

// The interface is blended as its colours are encoded: nothing here knows light.
layout(location = 0) in vec2 texel_in;
layout(location = 1) in vec4 tint_in;

layout(set = 0, binding = 0) uniform texture2D picture;
layout(set = 0, binding = 1) uniform sampler picture_sampler;

layout(location = 0) out vec4 color;

void main() {
    color = tint_in * texture(sampler2D(picture, picture_sampler), texel_in);
}
