#version 450

// Illumination volumes by Snell refraction at every water vertex (section 4.3, eq. 2-8 and 4-14). A volume is its triangle's
// three rays; a ray is stored once a vertex, in the directions of the light's boxes, so that the many planes each need one
// multiplication to find where it pierces them.

#include "caustics/refraction.glsl"

layout(local_size_x = 64) in;

struct WaterVertex {
    vec4 position;
    vec4 normal;
};

struct Ray {
    vec4 origin; // along U, V, W, metres; then 1 where the ray enters the water, else 0
    vec4 slope; // movement along U and W per metre of descent along V, then 1 / cos(theta_t), then unused
    vec4 incident; // unit direction of the light in air, along U, V, W
};

layout(std430, set = 0, binding = 0) readonly buffer Water {
    WaterVertex vertices[];
} water;

layout(std430, set = 0, binding = 1) buffer Rays {
    Ray list[];
} rays;

layout(push_constant) uniform Light {
    vec4 source; // xyz: direction of parallel light (w = 0) or position of a point light (w = 1)
    vec4 u; // axes of the light's boxes
    vec4 v;
    vec4 w;
    vec4 reference; // point of the water above the receiver, along U, V, W: keeps differences of positions precise
    float eta; // refraction index of air over that of water
    uint vertex_count;
} light;

vec3 along_axes(vec3 world) {
    return vec3(dot(light.u.xyz, world), dot(light.v.xyz, world), dot(light.w.xyz, world));
}

void main() {
    uint index = gl_GlobalInvocationID.x;
    if (index >= light.vertex_count) {
        return;
    }
    vec3 position = water.vertices[index].position.xyz;
    vec3 normal = water.vertices[index].normal.xyz;
    vec3 incident = light.source.w == 0.0 ? light.source.xyz : normalize(position - light.source.xyz);
    vec3 refracted;
    bool enters = refract_ray(incident, normal, light.eta, refracted);
    vec3 ray = along_axes(refracted);
    float cos_refracted = -ray.y;
    bool descends = cos_refracted > 0.0;
    float per_descent = descends ? 1.0 / cos_refracted : 0.0;

    rays.list[index].origin = vec4(along_axes(position) - light.reference.xyz, enters && descends ? 1.0 : 0.0);
    rays.list[index].slope = vec4(ray.xz * per_descent, per_descent, 0.0);
    rays.list[index].incident = vec4(along_axes(incident), 0.0);
}
