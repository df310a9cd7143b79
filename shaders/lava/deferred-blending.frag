#version 450

#pragma variants SIMULATION=free,sph

// Chapter 9, "Look at other shading techniques" and "Calculate the surface normals by accumulation": in place of a colour a splat
// leaves its normal and its depth, times the Gaussian of eq. 7.2, and the Gaussian. What is blended is what eq. 7.1 blends.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/ground.glsl"
#include "lava/splat-in.glsl"
#include "lava/gaussian.glsl"
#include "lava/height.glsl"

layout(set = 0, binding = 2) uniform texture2D visibility;

layout(location = 0) out vec4 normals; // the sum of weights in alpha
layout(location = 1) out vec4 depths; // eye-space metres in red

void main() {
    float ratio_squared = dot(disc, disc);
    float nearest = texelFetch(visibility, ivec2(gl_FragCoord.xy), 0).r;
    if (ratio_squared > 1.0 || eye_depth_m * scene.depth_per_m >= nearest || is_bare(center_m)) {
        discard;
    }
    float weight = gaussian(ratio_squared);
    vec3 normal = normalize(surface_at(columns_at(center_m.xz)).xyz);
    normals = vec4(weight * normal, weight);
    depths = vec4(weight * eye_depth_m, 0.0, 0.0, 0.0);
}
