#version 450

// Illumination volumes by Snell refraction at every water vertex (section 4.3, eq. 2-8 and 4-14). A volume is its triangle's
// three rays; a ray is stored once a vertex, in the directions of the light's boxes, so that the many planes each need one
// multiplication to find where it pierces them.

#include "caustics/fresnel.glsl"
#include "caustics/refraction.glsl"

layout(local_size_x = 64) in;

#include "common/elements.glsl"

struct WaterVertex {
    vec4 position; // homogeneous point, metres
    vec4 normal; // homogeneous unit direction
};

#include "caustics/ray.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Water {
    WaterVertex vertices[];
} water;

layout(std430, set = 0, binding = 1) buffer Rays {
    Ray list[];
} rays;

layout(push_constant) uniform Light {
    vec3 source; // unit direction of parallel light, or position of a point light in metres
    uint is_point; // 1 for a point light, else 0
    vec3 reference; // point of the water above the receiver, along U, V, W, metres: keeps differences of positions precise
    float eta; // refraction index of air over that of water
    vec3 u; // axes of the light's boxes
    uint vertex_count; // of the water
    vec3 v;
    float fresnel; // 1 where the surface reflects a part of the light (no part of the thesis), 0 where all of it enters
    vec3 w;
} light;

vec3 along_axes(vec3 world) {
    return vec3(dot(light.u, world), dot(light.v, world), dot(light.w, world));
}

void main() {
    uint index = element(64u);
    if (index >= light.vertex_count) {
        return;
    }
    vec3 position = water.vertices[index].position.xyz;
    vec3 normal = water.vertices[index].normal.xyz;
    vec3 incident = light.is_point == 0u ? light.source : normalize(position - light.source);
    vec3 refracted;
    bool enters = refract_ray(incident, normal, light.eta, refracted);
    vec3 ray = along_axes(refracted);
    float cos_refracted = -ray.y;
    bool descends = cos_refracted > 0.0;
    float secant = descends ? 1.0 / cos_refracted : 0.0;

    bool is_lit = enters && descends;
    float reflected = is_lit ? light.fresnel * fresnel(-dot(incident, normal), -dot(refracted, normal), light.eta) : 0.0;
    rays.list[index] = Ray(along_axes(position) - light.reference, is_lit ? 1.0 : 0.0, ray.xz * secant, secant, 0.0,
        (1.0 - reflected) * along_axes(incident), 0.0);
}
