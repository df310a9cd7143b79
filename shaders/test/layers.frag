#version 450

// The first components of the two layers of an array, side by side.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform texture2DArray layers;

layout(location = 0) out vec4 target;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    target = vec4(texelFetch(layers, ivec3(texel, 0), 0).x, texelFetch(layers, ivec3(texel, 1), 0).x, 0.0, 1.0);
}
