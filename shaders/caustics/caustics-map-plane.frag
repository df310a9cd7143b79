#version 450

// Caustics map of one sample plane (section 5.2.1, figure 5-4): every fragment is kept.

layout(location = 0) in vec4 surface;
layout(location = 1) in vec3 weight;

#include "caustics/plane.glsl"
#include "caustics/intensity.glsl"

layout(location = 0) out float caustics;

void main() {
    vec3 water_dx = dFdx(surface.xyz);
    vec3 water_dy = dFdy(surface.xyz);
    if (!is_lit(surface.w)) {
        discard;
    }
    caustics = intensity(water_dx, water_dy, weight, plane.up, plane.texel_area_m2);
}
