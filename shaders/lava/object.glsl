// Polygon objects in the lava's space. The thesis has none: this is how its depth texture lets them hide and be hidden.

layout(push_constant, std430) uniform Object {
    vec3 eye_m;
} object;
