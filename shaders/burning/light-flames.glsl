// A surface under the sun and the light of the flames, and smoke that the flames shine through. Ours: chapter 7 names
// neither.

#include "burning/fire-lights.glsl"

// Of a ball of light the irradiance over pi, linear RGB.
vec3 of_light(uint number, vec3 place, vec3 n) {
    FireLight own = fire_lights[number];
    vec3 to_light = own.position - place;
    float across = inversesqrt(dot(to_light, to_light) + own.radius * own.radius);
    // A ball that is half below the horizon still lights.
    float wrap = own.radius * across;
    float facing = max((dot(n, to_light) * across + wrap) / (1.0 + wrap), 0.0);
    return own.intensity * (facing * across * across);
}

// The same on every side of a place, in the mean.
vec3 around_light(uint number, vec3 place) {
    FireLight own = fire_lights[number];
    vec3 to_light = own.position - place;
    return own.intensity * (0.25 / (dot(to_light, to_light) + own.radius * own.radius));
}

// No loops: drivers that run several pixels at once (lavapipe) read a uniform at a constant place once for all of them,
// at any other pixel by pixel, which takes ten times as long as all the rest.

// What a white surface with the normal `n` sends back.
vec3 fire_light(vec3 place, vec3 n) {
    vec3 sum = vec3(0.0);
    sum += of_light(0u, place, n) + of_light(1u, place, n) + of_light(2u, place, n);
    sum += of_light(3u, place, n) + of_light(4u, place, n) + of_light(5u, place, n);
    sum += of_light(6u, place, n) + of_light(7u, place, n) + of_light(8u, place, n);
    sum += of_light(9u, place, n) + of_light(10u, place, n) + of_light(11u, place, n);
    sum += of_light(12u, place, n) + of_light(13u, place, n) + of_light(14u, place, n);
    sum += of_light(15u, place, n) + of_light(16u, place, n) + of_light(17u, place, n);
    sum += of_light(18u, place, n) + of_light(19u, place, n) + of_light(20u, place, n);
    sum += of_light(21u, place, n) + of_light(22u, place, n) + of_light(23u, place, n);
    sum += of_light(24u, place, n) + of_light(25u, place, n) + of_light(26u, place, n);
    return sum;
}

// Of the light around a place what a particle there sends to every side alike.
vec3 scattered(vec3 place) {
    vec3 sum = vec3(0.0);
    sum += around_light(0u, place) + around_light(1u, place) + around_light(2u, place);
    sum += around_light(3u, place) + around_light(4u, place) + around_light(5u, place);
    sum += around_light(6u, place) + around_light(7u, place) + around_light(8u, place);
    sum += around_light(9u, place) + around_light(10u, place) + around_light(11u, place);
    sum += around_light(12u, place) + around_light(13u, place) + around_light(14u, place);
    sum += around_light(15u, place) + around_light(16u, place) + around_light(17u, place);
    sum += around_light(18u, place) + around_light(19u, place) + around_light(20u, place);
    sum += around_light(21u, place) + around_light(22u, place) + around_light(23u, place);
    sum += around_light(24u, place) + around_light(25u, place) + around_light(26u, place);
    return sum;
}

vec3 shone_on(vec3 albedo, float sun, vec3 place, vec3 n) {
    return albedo * (sun + fire_light(place, n));
}
