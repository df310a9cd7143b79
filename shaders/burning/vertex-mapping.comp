#version 450

// Each vertex turned with its block about the block's midpoint, just before it is drawn (3.5.3); the simulated position stays.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/grid.glsl"

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    vec4 new_state[]; // position, L left
};

layout(set = 0, binding = 14, std430) readonly buffer Cells {
    uint cells[];
};

layout(set = 0, binding = 17, std430) readonly buffer NewRotations {
    vec4 new_rotations[]; // pitch, yaw, roll
};

layout(set = 0, binding = 19, std430) buffer Mapped {
    vec4 mapped[]; // position, L / L0
};

// By pitch about x, then yaw about y, then roll about z.
vec3 turned(vec3 v, vec3 angles) {
    vec3 s = sin(angles);
    vec3 c = cos(angles);
    vec3 p = vec3(v.x, c.x * v.y - s.x * v.z, s.x * v.y + c.x * v.z);
    vec3 q = vec3(c.y * p.x + s.y * p.z, p.y, -s.y * p.x + c.y * p.z);
    return vec3(c.z * q.x - s.z * q.y, s.z * q.x + c.z * q.y, q.z);
}

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= constants.counts.x) {
        return;
    }
    vec4 now = new_state[vertex];
    vec3 angles = new_rotations[cells[vertex]].xyz;
    vec3 place = now.xyz;
    if (angles != vec3(0.0)) {
        vec3 midpoint = midpoint_of(cells[vertex]);
        place = midpoint + turned(now.xyz - midpoint, angles);
    }
    mapped[vertex] = vec4(place, now.w / constants.boundary.w);
}
