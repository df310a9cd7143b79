// The share of its opacity that a particle of smoke has at a place of its square, -1 to 1.

#include "burning/noise.glsl"

float smoke_body(vec2 at, float age, float own) {
    float texture_noise = noise(1.6 * at + vec2(47.0 * own, 31.0 * own - 1.2 * age));
    return clamp(1.0 - length(at) - 0.7 * (texture_noise - 0.3), 0.0, 1.0);
}
