// The colour c_i of section 7.2 by height and rock, or a black body's, for splats and rays. The includer's constants `shading` hold
// drift_m, the distance that the rock has moved with the lava, and mode.

layout(set = 0, binding = 3) uniform texture2D rock;
layout(set = 0, binding = 4) uniform sampler linear;

#include "lava/glow.glsl"
#include "lava/encoding.glsl"
#include "lava/sky.glsl"

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

#ifdef SIMULATION_SPH
// How far the lava at the surface has carried the rock of each of two layings, and the share of the first.
layout(set = 0, binding = 8) uniform texture2D carried;

struct Rock {
    vec4 carried_m; // along x and z, of the first and of the second
    float share;
};

// Linear between the columns that have lava.
Rock rock_of(vec2 place_m) {
    vec2 column = place_m / scene.space_m.xz * scene.columns - 0.5;
    vec2 base = floor(column);
    vec2 fraction = column - base;
    vec4 sum = vec4(0.0);
    float weights = 0.0;
    for (int corner = 0; corner < 4; corner++) {
        vec2 aside = vec2(float(corner & 1), float(corner >> 1));
        ivec2 at = ivec2(clamp(base + aside, vec2(0.0), scene.columns - 1.0));
        vec2 near = mix(1.0 - fraction, fraction, aside);
        float weight = near.x * near.y * texelFetch(temperatures, at, 0).g;
        sum += weight * texelFetch(carried, at, 0);
        weights += weight;
    }
    return Rock(sum / max(weights, 1.0e-6), texelFetch(temperatures, ivec2(0), 0).b);
}

vec3 rock_at(Rock rock, vec2 place_m) {
    return mix(rock_at(place_m - rock.carried_m.zw), rock_at(place_m - rock.carried_m.xy), rock.share);
}

// Daylight that the crust gives back: a fresh basalt's share of it.
const float GIVEN_BACK = 0.25;

vec3 reflected(vec3 place_m, vec3 normal) {
    vec3 mirrored = reflect(normalize(place_m - scene.eye_m), normal);
    return GIVEN_BACK * sky_on(normal) + scene.gloss * sky_towards(mirrored);
}
#else
// One sheet over all of the lava.
struct Rock {
    bool is_one;
};

Rock rock_of(vec2 place_m) {
    return Rock(true);
}

vec3 rock_at(Rock rock, vec2 place_m) {
    return rock_at(place_m);
}

// The thesis's lava gives back no light.
vec3 reflected(vec3 place_m, vec3 normal) {
    return vec3(0.0);
}
#endif

// Normals are the caller's to show.
vec3 color_of(vec3 place_m, vec3 normal, vec3 rock) {
    vec3 color = glow_of(place_m);
    if (shading.mode == LAVA) {
        vec3 daylight = reflected(place_m, normal);
        color += scene.daylight * mix(daylight, decoded(daylight), scene.is_blackbody);
        color *= mix(rock, decoded(rock), scene.is_blackbody);
    } else if (shading.mode == ROCK) {
        color = rock;
    } else if (shading.mode == HEIGHTS) {
        color = vec3(place_m.y / scene.space_m.y);
    }
    return color;
}
