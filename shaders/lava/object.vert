#version 450

#pragma variants SIMULATION=free,sph

// A vertex of a polygon object, and the light that comes to it from a fluid.

#include "lava/scene.glsl"

layout(location = 0) in vec3 position; // metres, in the simulation space
layout(location = 1) in vec3 normal;

layout(location = 0) out vec3 facing;
layout(location = 1) out vec3 world_m;
layout(location = 2) out float eye_depth_m;

#include "lava/lamps.glsl"

#ifdef SIMULATION_SPH
layout(set = 0, binding = 2, std430) readonly buffer Lamps {
    vec4 list[]; // three of each Lamp
} lamps;

layout(location = 3) out vec3 to_front;
layout(location = 4) out vec3 to_back;

const uint MOST_LAMPS = 1024u;
#endif

void main() {
    facing = normal;
    world_m = position;
    gl_Position = scene.view_projection * vec4(position, 1.0);
    eye_depth_m = gl_Position.w;
#ifdef SIMULATION_SPH
    vec3 outwards = normal / max(length(normal), 1.0e-20);
    uint count = min(uint(lamps.list[1].w), MOST_LAMPS);
    vec3 front = vec3(0.0);
    vec3 back = vec3(0.0);
    for (uint i = 0u; i < count; i++) {
        Lamp lamp = lamp_of(lamps.list[3u * i], lamps.list[3u * i + 1u], lamps.list[3u * i + 2u]);
        front += light_of(lamp, position, outwards);
        back += light_of(lamp, position, -outwards);
    }
    to_front = front;
    to_back = back;
#endif
}
