#version 450

// Caustics map of the level map (sections 4.4 and 4.5, figure 4-15 steps 2.2 and 2.3): added up where the receiver's height lies
// in the plane's cell. The map and the position map share one parametrisation, so a fragment's texel is its own.

layout(location = 0) in vec4 surface;
layout(location = 1) in vec3 weight;

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

#include "caustics/plane.glsl"
#include "caustics/intensity.glsl"

layout(location = 0) out float caustics;

void main() {
    vec3 water_dx = dFdx(surface.xyz);
    vec3 water_dy = dFdy(surface.xyz);
    float height = texelFetch(sampler2D(position_map, nearest), ivec2(gl_FragCoord.xy), 0).r;
    // Half-open cells that share their boundaries: every texel is accepted by exactly one plane.
    if (height < plane.lower || height >= plane.upper || !is_lit(surface.w)) {
        discard;
    }
    caustics = intensity(water_dx, water_dy, weight, plane.up, plane.texel_area_m2);
}
