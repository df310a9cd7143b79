#version 450

// The particles as they start, from buffers into textures; at load.

layout(set = 0, binding = 0, std430) readonly buffer Positions {
    vec4 start_m[];
};
layout(set = 0, binding = 1, std430) readonly buffer Velocities {
    vec4 start_m_s[];
};

layout(push_constant, std430) uniform Texels {
    uint width;
} texels;

layout(location = 0) out vec4 position_m;
layout(location = 1) out vec4 velocity_m_s;

void main() {
    uint index = uint(gl_FragCoord.y) * texels.width + uint(gl_FragCoord.x);
    position_m = start_m[index];
    velocity_m_s = start_m_s[index];
}
