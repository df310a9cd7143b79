#version 450

// The volume that the mesh encloses, by the tetrahedra that its triangles make with a point of the ground; a thread adds
// up a run of them. Sums wrap around and come back: their end lies in range.

layout(local_size_x = 64) in;

#include "burning/constants.glsl"
#include "burning/puddle.glsl"
#include "burning/vertices.glsl"

layout(set = 0, binding = 2, std430) readonly buffer Triangles {
    uint triangles[];
};

layout(set = 0, binding = 10, std430) readonly buffer NewState {
    VertexState new_state[];
};

layout(set = 0, binding = 72, std430) buffer Films {
    Film film;
};

const uint RUN = 16u;

void main() {
    uint first = gl_GlobalInvocationID.x * RUN;
    vec3 origin = vec3(0.0, constants.floor_y, 0.0);
    int sum = 0;
    for (uint i = 0u; i < RUN; i++) {
        uint triangle = first + i;
        if (triangle < constants.triangle_count) {
            vec3 a = new_state[triangles[3u * triangle]].position - origin;
            vec3 b = new_state[triangles[3u * triangle + 1u]].position - origin;
            vec3 c = new_state[triangles[3u * triangle + 2u]].position - origin;
            sum += int(round(constants.outward * dot(a, cross(b, c)) / 6.0 * UNITS));
        }
    }
    if (sum != 0) {
        atomicAdd(film.mesh_volume, sum);
    }
}
