#version 450

#pragma variants LIGHT=sun,flames

// Fire adds light, smoke covers what lies behind: colours are premultiplied, and the alpha of fire is 0. Both are
// tested against the mesh's depth here and fade out where they come near it, so that no square shows where it cuts the
// surface.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/billboards.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;

layout(location = 0) in vec2 square_coordinates;
layout(location = 1) in float eye_depth; // distance along the view, diagonals
layout(location = 2) in float age_fraction; // of its life
layout(location = 3) in float own_random; // 0 to 1
layout(location = 4) in float fire_flag; // 1, or 0 for smoke
#ifdef LIGHT_FLAMES
layout(location = 5) in vec3 smoke_light; // of the flames, linear RGB
#endif

layout(location = 0) out vec4 shaded;

#ifdef LIGHT_FLAMES
const float SMOKE_ALBEDO = 0.4;
#endif

float lattice(ivec2 at) {
    uint h = uint(at.x) * 0x8da6b343u ^ uint(at.y) * 0xd8163841u;
    h ^= h >> 15u;
    h *= 0x846ca68bu;
    h ^= h >> 16u;
    return float(h & 0xffffu) / 65535.0;
}

float noise(vec2 at) {
    ivec2 cell = ivec2(floor(at));
    vec2 t = at - vec2(cell);
    t = t * t * (3.0 - 2.0 * t);
    float low = mix(lattice(cell), lattice(cell + ivec2(1, 0)), t.x);
    float high = mix(lattice(cell + ivec2(0, 1)), lattice(cell + ivec2(1, 1)), t.x);
    return mix(low, high, t.y);
}

// A ramp after the colours of a black body, from dull red to yellowish white.
vec3 glow(float heat) {
    return vec3(smoothstep(0.0, 0.45, heat), 0.72 * smoothstep(0.15, 0.85, heat), 0.42 * smoothstep(0.5, 1.0, heat));
}

vec4 fire(vec2 at, float age, float own) {
    // The texture streams upwards through the flame.
    float texture_noise = noise(vec2(2.2 * at.x, 1.5 * at.y - 3.0 * age) + 61.0 * own);
    float tip = 0.5 + 0.5 * at.y;
    float edge = length(vec2(at.x * (1.0 + 0.9 * tip), at.y)) + (texture_noise - 0.35) * (0.35 + 0.6 * tip);
    float body = clamp(1.0 - edge, 0.0, 1.0);
    float heat = body * (1.25 - 0.8 * age);
    return vec4(0.5 * glow(heat) * body, 0.0);
}

vec4 smoke(vec2 at, float age, float own) {
    float texture_noise = noise(1.6 * at + vec2(47.0 * own, 31.0 * own - 1.2 * age));
    float body = clamp(1.0 - length(at) - 0.7 * (texture_noise - 0.3), 0.0, 1.0);
    float alpha = 0.3 * body * smoothstep(0.0, 0.2, age) * (1.0 - age);
    // Young smoke is lit by the fire beneath it: by a rule of its age where flames shine on nothing else.
    vec3 grey = mix(vec3(0.11, 0.075, 0.05), vec3(0.1), smoothstep(0.0, 0.5, age));
#ifdef LIGHT_FLAMES
    grey = vec3(0.1) + SMOKE_ALBEDO * smoke_light;
#endif
    return vec4(grey * alpha, alpha);
}

void main() {
#ifdef LIGHT_FLAMES
    ivec2 pixel = layer_pixel(ivec2(gl_FragCoord.xy));
#else
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#endif
    float before_mesh = eye_distance(texelFetch(mesh_depth, pixel, 0).x) - eye_depth;
    if (before_mesh <= 0.0) {
        discard;
    }
    float softness = clamp(before_mesh / billboards.particle_radius, 0.0, 1.0);
    vec4 covered = fire_flag > 0.5
        ? fire(square_coordinates, age_fraction, own_random)
        : smoke(square_coordinates, age_fraction, own_random);
    shaded = softness * covered;
}
