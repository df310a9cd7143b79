// The light that an element of gas sends to the eye (section "Illumination of gaseous phenomena").

#include "gas/gas.glsl"
#include "gas/glow-{DENSITY}.glsl"

const float PI = 3.14159265;

// Henyey and Greenstein; the angle is between the light's direction and that to the eye, so that g > 0 scatters
// forwards.
float scattered(float g, float cosine) {
    float under = max(1.0 + g * g - 2.0 * g * cosine, 1.0e-6);
    return (1.0 - g * g) / (4.0 * PI * under * sqrt(under));
}

float phase(float cosine) {
    vec2 weights = in_hand.phase_weights;
    vec2 g = in_hand.phase_g;
    return weights.x * scattered(g.x, cosine) + weights.y * scattered(g.y, cosine);
}

// The viewer's ray and two directions orthogonal to it.
struct Frames {
    vec3 ray;
    vec3 side;
    vec3 up;
};

// What an element sends to the eye, of all volumes, times their extinctions: tau density albedo (sum(I_i phase) + ambient). First
// what needs no light.
vec3 own_emission(vec3 point, float densities[MAX_VOLUMES]) {
    vec3 emission = vec3(0.0);
    uint v = 0u;
    for (; v < volume_count; v++) {
        take_volume(v);
        emission += in_hand.tau_per_m * densities[v] * in_hand.albedo * frame.ambient;
        // Hot gas sends out by the fraction that it absorbs (Kirchhoff).
        if (densities[v] > 0.0) {
            emission += in_hand.tau_per_m * densities[v] * (1.0 - in_hand.albedo) * glow_at(point);
        }
    }
    is_cut = is_cut || v < volume_count;
    return emission;
}

// What a light adds. Densities of solids are also those of `since_m` before the point, and a quarter of a step beside it and above it.
// Nothing that a driver may end follows on the way to the light.
vec3 emission_by(uint l, vec3 point, Frames frames, float densest, float since_m, float densities[MAX_VOLUMES],
    float previous[MAX_VOLUMES], float asides[MAX_VOLUMES], float aboves[MAX_VOLUMES]) {
    take_light(l);
    LightRay to_light = ray_to_light(point);
    vec3 scattering = vec3(0.0);
    uint v = 0u;
    for (; v < volume_count; v++) {
        if (densities[v] > 0.0) {
            take_volume(v);
            float response = PI * phase(dot(to_light.direction, frames.ray));
            if (in_hand.is_solid != 0u) {
                float apart = 0.25 * in_hand.step_m;
                float along = (densities[v] - previous[v]) / since_m;
                float aside = (asides[v] - densities[v]) / apart;
                float above = (aboves[v] - densities[v]) / apart;
                vec3 rise = frames.ray * along + frames.side * aside + frames.up * above;
                vec3 normal = dot(rise, rise) > 0.0 ? -normalize(rise) : -frames.ray;
                response = max(dot(normal, to_light.direction), 0.0);
            }
            scattering += in_hand.tau_per_m * densities[v] * in_hand.albedo * response;
        }
    }
    is_cut = is_cut || v < volume_count;
    // For patchy gas, shadows are not computed where it is thinner than a threshold.
    float passed = densest >= frame.shadow_threshold ? transmittance_to(l, point) : 1.0;
    return scattering * irradiance(to_light.distance_m) * passed;
}

vec3 emission_at(vec3 point, Frames frames, float densest, float since_m, float densities[MAX_VOLUMES],
    float previous[MAX_VOLUMES], float asides[MAX_VOLUMES], float aboves[MAX_VOLUMES]) {
    vec3 emission = own_emission(point, densities);
    uint l = 0u;
    do {
        emission += emission_by(l, point, frames, densest, since_m, densities, previous, asides, aboves);
        if (l < light_count) {
            l++;
        }
    } while (l < light_count);
    is_cut = is_cut || l < light_count;
    return emission;
}
