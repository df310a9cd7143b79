// The light of a flame, by a place of its square.

#include "burning/noise.glsl"

// As smoothstep, with a product for its quotient: the edges are constants.
float rise(float from, float to, float at) {
    float t = clamp((at - from) * (1.0 / (to - from)), 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

// A ramp after the colours of a black body, from dull red to yellowish white.
vec3 glow(float heat) {
    return vec3(rise(0.0, 0.45, heat), 0.72 * rise(0.15, 0.85, heat), 0.42 * rise(0.5, 1.0, heat));
}

// Linear RGB; the place is -1 to 1, the age a fraction of its life.
vec3 fire(vec2 at, float age, float own) {
    // The texture streams upwards through the flame.
    float texture_noise = noise(vec2(2.2 * at.x, 1.5 * at.y - 3.0 * age) + 61.0 * own);
    float tip = 0.5 + 0.5 * at.y;
    float edge = length(vec2(at.x * (1.0 + 0.9 * tip), at.y)) + (texture_noise - 0.35) * (0.35 + 0.6 * tip);
    float body = clamp(1.0 - edge, 0.0, 1.0);
    float heat = body * (1.25 - 0.8 * age);
    return 0.5 * glow(heat) * body;
}
