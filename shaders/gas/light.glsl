// Lights at infinity or at a point.

struct Light {
    vec3 source; // position of a point light, m; unit direction towards one at infinity
    uint is_point; // 1 or 0
    vec3 intensity; // linear RGB
};

layout(set = 0, binding = 2, std430) readonly buffer Lights {
    Light lights[];
};

// The ray from a point to a light.
struct LightRay {
    vec3 direction; // unit
    float distance_m;
};

LightRay ray_to_light(uint l, vec3 point) {
    vec3 source = lights[l].source;
    if (lights[l].is_point == 0u) {
        return LightRay(source, 1.0e30);
    }
    vec3 offset = source - point;
    float distance_m = max(length(offset), 1.0e-6);
    return LightRay(offset / distance_m, distance_m);
}

// Light that falls onto a surface that faces it.
vec3 irradiance(uint l, float distance_m) {
    vec3 intensity = lights[l].intensity;
    return lights[l].is_point == 0u ? intensity : intensity / (distance_m * distance_m);
}
