#version 450

#pragma variants FIRE=none,layer

// The display's picture of linear light (ours): fire and smoke over it, the exposure, and the tone of what is brighter
// than the display.

#extension GL_EXT_samplerless_texture_functions : require

#include "common/tone.glsl"
#include "burning/over-{FIRE}.glsl"

layout(set = 0, binding = 54) uniform texture2D radiance;

layout(push_constant, std430) uniform Tone {
    float exposure;
    float knee;
} tone;

layout(location = 0) out vec4 shaded;

// Of 16-bit floats: sums of very many flames have none.
const vec3 GREATEST = vec3(65504.0);

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 light = with_fire(texelFetch(radiance, pixel, 0).rgb, pixel);
    shaded = vec4(toned(min(light, GREATEST), tone.exposure, tone.knee), 1.0);
}
