// What the lava shines with at a place of its surface: the constant orange of section 7.2 by its height in the space, which is one high
// in the thesis, or a black body's light by its
// temperature.

#include "lava/emission.glsl"

#ifdef SIMULATION_SPH
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

// Linear light, where the constant orange is the display's own value. No branch: drivers compile a shader anew for each value
// that a branch on constants sees.
vec3 glow_of(vec3 place_m) {
    vec3 light = scene.per_brightest * emitted(kelvin_at(place_m));
    return mix(scene.glow * (1.0 - place_m.y / scene.space_m.y), light, scene.is_blackbody);
}
