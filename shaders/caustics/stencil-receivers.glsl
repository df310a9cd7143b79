layout(set = 0, binding = 0) uniform Camera {
    mat4 view_projection;
} camera;

layout(push_constant) uniform Receiver {
    vec3 albedo; // diffuse reflectance, linear RGB
    vec3 ambient; // I_a of eq. 4-20, linear RGB
} receiver;
