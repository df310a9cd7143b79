layout(set = 0, binding = 0) uniform Camera {
    mat4 view_projection;
} camera;

layout(push_constant) uniform Cast {
    Box bounds;
    vec4 albedo;
    vec4 ambient; // I_a of eq. 4-20, added once: zero for every light but the first; w: how far the position map may lie from the surface, metres
} receiver;
