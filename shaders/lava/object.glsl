// Polygon objects in the lava's space. The thesis has none; its depth texture lets them hide and be hidden.

layout(push_constant, std430) uniform Object {
    vec3 eye_m;
    float exposure;
    float knee;
    float paint; // share of light that comes back
} object;
