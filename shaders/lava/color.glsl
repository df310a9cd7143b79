// The colour c_i of section 7.2 by height and rock, for splats and rays. The includer's constants `shading` hold
// drift_m, the distance that the rock has moved with the lava, and mode.

layout(set = 0, binding = 3) uniform texture2D rock;
layout(set = 0, binding = 4) uniform sampler linear;

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
    vec3 color = scene.glow * (scene.space_m.y - height_m);
    if (shading.mode == LAVA) {
        color *= rock;
    } else if (shading.mode == ROCK) {
        color = rock;
    } else if (shading.mode == HEIGHTS) {
        color = vec3(height_m / scene.space_m.y);
    }
    return color;
}
