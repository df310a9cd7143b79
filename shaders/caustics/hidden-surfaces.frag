#version 450

// Position map and diffuse map of the next surface that faces the light below the one before it (section 6.3): what that one hides from
// the light's box, where waves or a near light bend rays to it. Section 4.2.2 has the first surface alone.

layout(location = 0) in float height;
layout(location = 1) in vec3 map_normal;

#include "caustics/box.glsl"
#include "caustics/diffuse.glsl"
#include "caustics/below.glsl"

layout(push_constant) uniform Map {
    Box bounds;
    vec3 albedo;
    float top;
    float bottom;
} map;

layout(set = 0, binding = 0) uniform texture2D above; // heights of the surface before
layout(set = 0, binding = 1) uniform sampler nearest;

layout(location = 0) out float position;
layout(location = 1) out vec4 diffuse;

void main() {
    float over = texelFetch(sampler2D(above, nearest), ivec2(gl_FragCoord.xy), 0).r;
    if (!is_below(map.bounds, height, over) || dot(map_normal, map.bounds.v) <= 0.0) {
        discard;
    }
    position = height;
    diffuse = diffuse_light(map.albedo, map_normal, map.bounds.v);
}
