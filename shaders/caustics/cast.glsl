layout(set = 0, binding = 0) uniform Camera {
    mat4 view_projection;
} camera;

layout(push_constant) uniform Cast {
    Box bounds;
    vec3 albedo; // diffuse reflectance, linear RGB
    float height_slack_m; // heights of the position map lie within it of the surface
    vec3 ambient; // I_a of eq. 4-20, linear RGB, added once: zero for every light but the first
} receiver;
