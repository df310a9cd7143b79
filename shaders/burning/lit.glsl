// Two-sided Lambert and ambient light, and that of the flames, on the charring surface, with the glow of its combustion-ready edge.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/light-{LIGHT}.glsl"

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 rest_position;
layout(location = 2) in vec4 normal; // unit vector, how charred
layout(location = 3) in vec4 color; // charred albedo, glow

// 0 to 1: the albedo to char.
float charred_here() {
    return normal.w;
}

// Of embers, 0 to 1.
float glow_here() {
    return color.a;
}

const vec3 EMBERS = vec3(1.0, 0.35, 0.05);

// `pattern` is what a material makes of its albedo, a factor of it; `glow` is linear RGB.
vec4 shone(vec3 pattern, vec3 own_albedo, float charring, vec3 glow) {
    vec3 n = normalize(normal.xyz);
    vec3 to_eye = view.eye - position;
    if (dot(n, to_eye) < 0.0) {
        n = -n;
    }
    // `color` mixes the plain albedo with that of char; this replaces it by the pattern's.
    vec3 albedo = color.rgb + (1.0 - charring * charred_here()) * own_albedo * (pattern - 1.0);
    float light = view.ambient + (1.0 - view.ambient) * max(dot(n, view.to_light), 0.0);
    return vec4(shone_on(albedo, light, position, n) + glow, 1.0);
}

// Of an object of one material.
vec4 lit(vec3 pattern) {
    return shone(pattern, constants.albedo, constants.charring, constants.charring * glow_here() * EMBERS);
}
