#version 450

// One particle a fragment (section 5.1, listing 5.1): the borders of the simulation space turn the velocity, then the
// particle moves. Velocities are per second and the step is a time, where the listing adds a velocity per frame.

#extension GL_EXT_samplerless_texture_functions : require

layout(set = 0, binding = 0) uniform texture2D positions;
layout(set = 0, binding = 1) uniform texture2D velocities;

layout(push_constant, std430) uniform Motion {
    vec3 space_m;
    float time_step_s;
} motion;

layout(location = 0) out vec4 position_m;
layout(location = 1) out vec4 velocity_m_s;

void main() {
    ivec2 particle = ivec2(gl_FragCoord.xy);
    vec3 position = texelFetch(positions, particle, 0).xyz;
    vec3 velocity = texelFetch(velocities, particle, 0).xyz;
    // Along the flow, what leaves comes in again.
    if (position.x >= motion.space_m.x) {
        position.x = 0.0;
    }
    if (position.y >= motion.space_m.y) {
        velocity.y = -abs(velocity.y);
    }
    if (position.y <= 0.0) {
        velocity.y = abs(velocity.y);
    }
    if (position.z >= motion.space_m.z) {
        velocity.z = -abs(velocity.z);
    }
    if (position.z <= 0.0) {
        velocity.z = abs(velocity.z);
    }
    position_m = vec4(position + motion.time_step_s * velocity, 0.0);
    velocity_m_s = vec4(velocity, 0.0);
}
