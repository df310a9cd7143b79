// The pass `illumination` of one pixel: Lambert's law under the sun and the sky, the ground's colour by height or from what is
// draped over it, haze by distance. The paper names the pass and no model of light.

// Before this file stand light.glsl and one for what is draped over the terrain.

#include "terrain/base-normal.glsl"

layout(set = 0, binding = 1) uniform texture2D depth;
layout(set = 0, binding = 2) uniform texture2D normal;
layout(set = 0, binding = 4) uniform texture2D shadow; // a single texel where none are thrown

// Hypsometric tints, linear: meadow, forest, heath, rock, ash, and the pale summit.
const vec3 TINTS[6] = vec3[](vec3(0.22, 0.30, 0.10), vec3(0.10, 0.20, 0.06), vec3(0.24, 0.20, 0.10),
                             vec3(0.25, 0.17, 0.11), vec3(0.30, 0.26, 0.23), vec3(0.55, 0.53, 0.51));
const vec3 ROCK = vec3(0.20, 0.17, 0.15);
const vec3 BASE_TINT = vec3(0.17, 0.22, 0.12);

// At a height of 0 to 1 from the lowest to the highest.
vec3 tint_at(float height) {
    float place = clamp(height, 0.0, 1.0) * 5.0;
    int below = min(int(place), 4);
    return mix(TINTS[below], TINTS[below + 1], place - float(below));
}

vec3 sky(vec3 direction) {
    float up = clamp(normalize(direction).y, 0.0, 1.0);
    return mix(light.haze_color, vec3(0.16, 0.34, 0.68), pow(up, 0.5));
}

vec3 albedo_at(int surface, float upright, float height) {
    vec3 tint = surface == 1 ? BASE_TINT : tint_at(height);
    // Nothing grows on a cliff.
    return mix(ROCK, tint, smoothstep(0.45, 0.75, upright));
}

vec4 color_of(ivec2 pixel) {
    vec4 hit = texelFetch(depth, pixel, 0);
    vec4 facing = texelFetch(normal, pixel, 0);
    float sunlit = texelFetch(shadow, min(pixel, textureSize(shadow, 0) - 1), 0).x;
    vec3 direction = view_direction(vec2(pixel));
    int surface = int(hit.w) & 7;
    vec3 color = sky(direction);
    if (surface != 0) {
        float height = (facing.w - light.lowest_m) / max(light.highest_m - light.lowest_m, 1.0e-6);
        vec3 up = up_at(light.eye + hit.x * direction, facing.w);
        vec3 albedo = albedo_at(surface, dot(facing.xyz, up), height);
        if (surface == 2) {
            albedo = under_drape(albedo, direction, hit, facing);
        }
        color = lit_color(albedo, facing.xyz, up, sunlit, hit.x * length(direction));
    }
    return vec4(encoded(color), 1.0);
}
