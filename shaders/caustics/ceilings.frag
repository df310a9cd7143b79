#version 450

// The lowest surface that faces away from the light between two that face it (section 6.3): the room above the lower one ends there, and
// what is higher is inside the receiver.

layout(location = 0) in float height;
layout(location = 1) in vec3 map_normal;

#include "caustics/box.glsl"
#include "caustics/below.glsl"

layout(push_constant) uniform Map {
    Box bounds;
    vec3 albedo;
    float top;
    float bottom;
} map;

layout(set = 0, binding = 0) uniform texture2D above; // heights of the upper surface
layout(set = 0, binding = 1) uniform sampler nearest;
layout(set = 0, binding = 2) uniform texture2D below; // heights of the lower one

layout(location = 0) out float ceiling;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    float over = texelFetch(sampler2D(above, nearest), texel, 0).r;
    float under = texelFetch(sampler2D(below, nearest), texel, 0).r;
    if (!is_below(map.bounds, height, over) || height <= under || dot(map_normal, map.bounds.v) > 0.0) {
        discard;
    }
    ceiling = height;
}
