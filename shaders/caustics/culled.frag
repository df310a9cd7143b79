#version 450

// As caustics-map.frag, for the pairs that culling kept (section 6.1).

layout(location = 0) in vec4 surface;
layout(location = 1) in vec3 weight;
layout(location = 2) flat in vec2 accepted;

layout(set = 0, binding = 0) uniform texture2D position_map;
layout(set = 0, binding = 1) uniform sampler nearest;

#include "caustics/culled.glsl"
#include "caustics/intensity.glsl"

layout(location = 0) out float caustics;

void main() {
    vec3 water_dx = dFdx(surface.xyz);
    vec3 water_dy = dFdy(surface.xyz);
    float height = texelFetch(sampler2D(position_map, nearest), ivec2(gl_FragCoord.xy), 0).r;
    if (height < accepted.x || height >= accepted.y || !is_lit(surface.w)) {
        discard;
    }
    caustics = intensity(water_dx, water_dy, weight, plane.up, plane.texel_area_m2);
}
