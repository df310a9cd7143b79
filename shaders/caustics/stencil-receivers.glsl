layout(set = 0, binding = 0) uniform Camera {
    mat4 view_projection;
} camera;

layout(push_constant) uniform Receiver {
    vec4 albedo;
    vec4 ambient; // I_a of eq. 4-20
} receiver;
