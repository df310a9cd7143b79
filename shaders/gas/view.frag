#version 450

// The resolved picture as it is shown.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform texture2D radiance;

layout(location = 0) out vec4 color;

void main() {
    color = vec4(clamp(texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).xyz, 0.0, 1.0), 1.0);
}
