#version 450

// Eq. 7.2's quotient (section 7.3); black where no splat was drawn. Colours are those of the display from the rock's
// texels to here, as in the thesis's OpenGL: nothing is decoded or encoded. Exposure and tone are ours. A black body's colour is linear
// light, which is encoded here.

#extension GL_EXT_samplerless_texture_functions : require

#include "common/tone.glsl"
#include "lava/encoding.glsl"

layout(set = 0, binding = 0) uniform texture2D accumulated_colors;

layout(push_constant, std430) uniform Tone {
    float exposure;
    float knee;
    float is_linear; // 1 or 0
} tone;

layout(location = 0) out vec4 color;

void main() {
    vec4 sums = texelFetch(accumulated_colors, ivec2(gl_FragCoord.xy), 0);
    vec3 value = toned(sums.a > 0.0 ? sums.rgb / sums.a : vec3(0.0), tone.exposure, tone.knee);
    // No branch: drivers compile a shader anew for each value that a branch on constants sees.
    color = vec4(mix(value, encoded(value), tone.is_linear), 1.0);
}
