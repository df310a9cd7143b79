#version 450

// The highest values of the levels above the data as floats, each where it is in its layer, for rays over bilinear terrain. Once for each
// map.

#extension GL_EXT_samplerless_texture_functions : require

#include "terrain/packing.glsl"

layout(location = 0) out float highest;

void main() {
    uint bits = texelFetch(levels, ivec3(ivec2(gl_FragCoord.xy), 1), 0).x;
    highest = packing.is_float != 0 ? uintBitsToFloat(bits) : float(int(bits));
}
