#version 450

#pragma variants SIMULATION=free,sph

// Numerator and denominator of eq. 7.2: the lava's colour times the Gaussian in RGB, the Gaussian in alpha. A fragment
// is blended exactly when its depth is less than epsilon behind the nearest. The colour c_i belongs to the splat: height
// and rock are those of its centre.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/ground.glsl"
#include "lava/splat-in.glsl"
#include "lava/gaussian.glsl"

layout(set = 0, binding = 1) uniform texture2D normal_height;
layout(set = 0, binding = 2) uniform texture2D visibility;

layout(push_constant, std430) uniform Shading {
    vec2 drift_m; // distance that the rock has moved with the lava, along x and z
    uint mode; // the one of the thesis's pictures that is drawn
} shading;

#include "lava/color.glsl"

layout(location = 0) out vec4 accumulated;

vec3 normal() {
    ivec2 column = ivec2(clamp(center_m.xz / scene.space_m.xz * scene.columns, vec2(0.0), scene.columns - 1.0));
    return texelFetch(normal_height, column, 0).xyz;
}

// Of lava that gives back daylight.
vec3 lit_normal() {
#ifdef SIMULATION_SPH
    return normal();
#else
    return vec3(0.0);
#endif
}

void main() {
    float ratio_squared = dot(disc, disc);
    float nearest = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).r;
    if (ratio_squared > 1.0 || eye_depth_m * scene.depth_per_m >= nearest || is_bare(center_m)) {
        discard;
    }
    vec3 color = color_of(center_m, lit_normal(), rock_at(rock_of(center_m.xz), center_m.xz));
    if (shading.mode == NORMALS) {
        color = 0.5 + 0.5 * normal();
    }
    float weight = gaussian(ratio_squared);
    accumulated = vec4(weight * color, weight);
}
