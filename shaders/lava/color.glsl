// The colour c_i of section 7.2 by height and rock, or a black body's, for splats and rays. The includer's constants `shading` hold
// drift_m, the distance that the rock has moved with the lava, and mode.

layout(set = 0, binding = 3) uniform texture2D rock;
layout(set = 0, binding = 4) uniform sampler linear;

#include "lava/emission.glsl"
#include "lava/encoding.glsl"

// In the order of the host's `Shading`.
const uint LAVA = 0u;
const uint COLOR = 1u;
const uint ROCK = 2u;
const uint NORMALS = 3u;
const uint HEIGHTS = 4u;

vec3 rock_at(vec2 place_m) {
    vec2 texel = fract((place_m - shading.drift_m) / scene.rock_tile_m) * scene.rock_texels;
    return textureLod(sampler2D(rock, linear), (texel + 1.0) / (scene.rock_texels + 2.0), 0.0).rgb;
}

#ifdef HEAT_CARRIED
// The particles' at the surface, linear between the columns that have any.
layout(set = 0, binding = 7) uniform texture2D temperatures;

vec2 heat_of(vec2 column) {
    vec4 found = texelFetch(temperatures, ivec2(clamp(column, vec2(0.0), scene.columns - 1.0)), 0);
    return vec2(found.r * found.g, found.g);
}

float kelvin_at(vec3 place_m) {
    vec2 column = place_m.xz / scene.space_m.xz * scene.columns - 0.5;
    vec2 base = floor(column);
    vec2 fraction = column - base;
    vec2 near_row = mix(heat_of(base), heat_of(base + vec2(1.0, 0.0)), fraction.x);
    vec2 far_row = mix(heat_of(base + vec2(0.0, 1.0)), heat_of(base + vec2(1.0, 1.0)), fraction.x);
    vec2 found = mix(near_row, far_row, fraction.y);
    return found.x / max(found.y, 1.0e-6);
}
#else
float kelvin_at(vec3 place_m) {
    return mix(scene.temperatures_k.x, scene.temperatures_k.y, place_m.y / scene.space_m.y);
}
#endif

// Normals are the caller's to show.
vec3 color_of(vec3 place_m, vec3 rock) {
    float height_m = place_m.y;
    // Linear light, where the constant orange is the display's own value. No branch: drivers compile a shader anew for each
    // value that a branch on constants sees.
    vec3 light = scene.per_brightest * emitted(kelvin_at(place_m));
    vec3 color = mix(scene.glow * (scene.space_m.y - height_m), light, scene.is_blackbody);
    if (shading.mode == LAVA) {
        color *= mix(rock, decoded(rock), scene.is_blackbody);
    } else if (shading.mode == ROCK) {
        color = rock;
    } else if (shading.mode == HEIGHTS) {
        color = vec3(height_m / scene.space_m.y);
    }
    return color;
}
