// Lights at infinity or at a point.

struct Light {
    vec4 source; // position, m, and 1; or the unit direction towards it, and 0
    vec4 intensity; // linear RGB
};

layout(set = 0, binding = 2, std430) readonly buffer Lights {
    Light lights[];
};

// Unit direction towards the light; w: distance to it, m.
vec4 towards_light(uint l, vec3 point) {
    vec4 source = lights[l].source;
    if (source.w == 0.0) {
        return vec4(source.xyz, 1.0e30);
    }
    vec3 way = source.xyz - point;
    float distance_m = max(length(way), 1.0e-6);
    return vec4(way / distance_m, distance_m);
}

// Light that falls onto a surface that faces it.
vec3 irradiance(uint l, float distance_m) {
    vec3 intensity = lights[l].intensity.xyz;
    return lights[l].source.w == 0.0 ? intensity : intensity / (distance_m * distance_m);
}
