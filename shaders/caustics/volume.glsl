// Illumination volumes as the stencil method reads them: rays along the light's axes U, V = -T, W from its reference point.

#include "caustics/ray.glsl"

layout(std430, set = 0, binding = 0) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 1) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(set = 0, binding = 2) uniform Volumes {
    mat4 view_projection;
    vec3 u; // unit axis
    float reference_u; // coordinate of the reference point along it, metres
    vec3 v;
    float reference_v;
    vec3 w;
    float reference_w;
    vec3 intensity; // of the light, linear RGB
    float absorption_per_m; // K of eq. 4-17
    float bottom; // height along V below every receiver, from the reference point, metres
    float slack; // distance of a prism's sides beyond its volume, of that from the eye
} volumes;

uint water_vertex(uint triangle, uint corner) {
    return indices.list[3u * triangle + corner];
}
