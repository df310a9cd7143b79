#version 450

#pragma variants SIMULATION=free,sph

// Deferred shading of splats (chapter 9, "Look at other shading techniques"): the accumulated normals and depths, normalised, then the
// colour of section 7.2 once for each pixel at its own place. Blending mixes the colours of the splats' middles, as Gouraud's shading
// does, and blurs the rock.

#extension GL_EXT_samplerless_texture_functions : require

#include "lava/scene.glsl"
#include "lava/rays.glsl"

layout(set = 0, binding = 1) uniform texture2D blended_normals;
layout(set = 0, binding = 2) uniform texture2D blended_depths;

#include "lava/color.glsl"
#include "lava/taps.glsl"

layout(location = 0) out vec4 accumulated;

void main() {
    vec4 sums = texelFetch(blended_normals, ivec2(gl_FragCoord.xy), 0);
    if (sums.a <= 0.0) {
        discard;
    }
    float depth_m = texelFetch(blended_depths, ivec2(gl_FragCoord.xy), 0).r / sums.a;
    vec3 normal = normalize(sums.xyz);
    vec3 direction = ray_through(gl_FragCoord.xy);
    vec3 place_m = shading.eye_m + depth_m * direction;
    vec3 rock = rock_over(place_m, depth_m, direction, normal, vec3(0.0), 0.0);
    vec3 color = color_of(place_m, normal, rock);
    accumulated = vec4(shading.mode == NORMALS ? 0.5 + 0.5 * normal : color, 1.0);
}
