// A surface under the sun and the light of the flames, and smoke that the flames shine through. Ours: chapter 7 names
// neither.

#include "burning/fire-lights.glsl"

// Irradiance over pi, linear RGB: what a white surface with the normal `n` sends back.
vec3 fire_light(vec3 place, vec3 n) {
    vec3 sum = vec3(0.0);
    uint count = min(uint(fire_lights[0].count), MOST_LIGHTS);
    for (uint i = 0u; i < count; i++) {
        FireLight own = fire_lights[i];
        vec3 to_light = own.position - place;
        float squared = dot(to_light, to_light) + own.radius * own.radius;
        float across = inversesqrt(squared);
        // A ball that is half below the horizon still lights.
        float wrap = own.radius * across;
        float facing = max((dot(n, to_light) * across + wrap) / (1.0 + wrap), 0.0);
        sum += own.intensity * (facing / squared);
    }
    return sum;
}

// Of the light around a place what a particle there sends to every side alike.
vec3 scattered(vec3 place) {
    vec3 sum = vec3(0.0);
    uint count = min(uint(fire_lights[0].count), MOST_LIGHTS);
    for (uint i = 0u; i < count; i++) {
        FireLight own = fire_lights[i];
        vec3 to_light = own.position - place;
        sum += own.intensity * (0.25 / (dot(to_light, to_light) + own.radius * own.radius));
    }
    return sum;
}

vec3 shone_on(vec3 albedo, float sun, vec3 place, vec3 n) {
    return albedo * (sun + fire_light(place, n));
}
