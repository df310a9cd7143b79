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

// Normals are the caller's to show.
vec3 color_of(float height_m, vec3 rock) {
    float kelvin = mix(scene.temperatures_k.x, scene.temperatures_k.y, height_m / scene.space_m.y);
    // Linear light, where the constant orange is the display's own value. No branch: drivers compile a shader anew for each
    // value that a branch on constants sees.
    vec3 light = scene.per_brightest * emitted(kelvin);
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
