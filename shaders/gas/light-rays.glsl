// The light in hand.

// The ray from a point to the light.
struct LightRay {
    vec3 direction; // unit
    float distance_m;
};

LightRay ray_to_light(vec3 point) {
    if (light_in_hand.is_point == 0u) {
        return LightRay(light_in_hand.source, 1.0e30);
    }
    vec3 offset = light_in_hand.source - point;
    float distance_m = max(length(offset), 1.0e-6);
    return LightRay(offset / distance_m, distance_m);
}

// Light that falls onto a surface that faces it.
vec3 irradiance(float distance_m) {
    return light_in_hand.is_point == 0u ? light_in_hand.intensity : light_in_hand.intensity / (distance_m * distance_m);
}
