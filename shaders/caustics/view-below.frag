#version 450

// The plain underwater view: the cast as it is.

layout(set = 0, binding = 0) uniform texture2D underwater_color;
layout(set = 0, binding = 1) uniform sampler nearest;

layout(location = 0) out vec4 color;

void main() {
    color = texelFetch(sampler2D(underwater_color, nearest), ivec2(gl_FragCoord.xy), 0);
}
