// Illumination volumes as the stencil method reads them: rays along the light's axes U, V = -T, W from its reference point.

struct Ray {
    vec4 origin; // metres; then 1 where the ray enters the water, else 0
    vec4 slope; // movement along U and W per metre of descent along V, then 1 / cos(theta_t)
    vec4 incident;
};

layout(std430, set = 0, binding = 0) readonly buffer Rays {
    Ray list[];
} rays;

layout(std430, set = 0, binding = 1) readonly buffer Indices {
    uint list[]; // three a water triangle
} indices;

layout(set = 0, binding = 2) uniform Volumes {
    mat4 view_projection;
    vec4 u; // axis, and the reference point's coordinate along it
    vec4 v;
    vec4 w;
    vec4 intensity; // of the light, linear RGB; then K of eq. 4-17 per metre
    float bottom; // height along V below every receiver, from the reference point
} volumes;

uint water_vertex(uint triangle, uint corner) {
    return indices.list[3u * triangle + corner];
}
