#version 450

#pragma variants LIGHT=sun,flames

// Smoke covers what lies behind.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/before-mesh.glsl"
#include "burning/noise.glsl"
#include "burning/smoke.glsl"

#ifdef LIGHT_FLAMES
layout(location = 4) flat in vec3 smoke_light; // of the flames, linear RGB
#endif

vec4 smoke(vec2 at, float age, float own) {
    float texture_noise = noise(1.6 * at + vec2(47.0 * own, 31.0 * own - 1.2 * age));
    float body = clamp(1.0 - length(at) - 0.7 * (texture_noise - 0.3), 0.0, 1.0);
    float alpha = smoke_opacity(age) * body;
#ifdef LIGHT_FLAMES
    vec3 grey = SMOKE_GREY + SMOKE_ALBEDO * smoke_light;
#else
    // Young smoke is lit by the fire beneath it: by a rule of its age where flames shine on nothing else.
    vec3 grey = mix(vec3(0.11, 0.075, 0.05), vec3(0.1), smoothstep(0.0, 0.5, age));
#endif
    return vec4(grey * alpha, alpha);
}

void main() {
    float distance_before = before_mesh(ivec2(gl_FragCoord.xy));
    if (distance_before <= 0.0) {
        discard;
    }
    shaded = softness(distance_before) * smoke(square_coordinates, age_fraction, own_random);
}
