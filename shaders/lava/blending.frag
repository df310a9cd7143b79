#version 450

#pragma variants HEAT=height,carried

// Numerator and denominator of eq. 7.2: the lava's colour times the Gaussian in RGB, the Gaussian in alpha. A fragment
// is blended exactly when its depth is less than epsilon behind the nearest. The colour c_i belongs to the splat: height
// and rock are those of its centre.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
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

void main() {
    float ratio_squared = dot(disc, disc);
    float nearest = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).r;
    if (ratio_squared > 1.0 || eye_depth_m * scene.depth_per_m >= nearest || center_m.y <= scene.bare_m) {
        discard;
    }
    vec3 color = color_of(center_m, rock_at(center_m.xz));
    if (shading.mode == NORMALS) {
        ivec2 column = ivec2(clamp(center_m.xz / scene.space_m.xz * scene.columns, vec2(0.0), scene.columns - 1.0));
        color = 0.5 + 0.5 * texelFetch(normal_height, column, 0).xyz;
    }
    float weight = gaussian(ratio_squared);
    accumulated = vec4(weight * color, weight);
}
