#version 450

// The volume that the mesh encloses, by the tetrahedra that its triangles make with a point of the ground. A chunk's sum is
// kept, and the volume changes by what that does. Sums wrap around and come back: their end lies in range.

layout(local_size_x = 128) in;

#include "burning/constants.glsl"
#include "burning/chunks.glsl"
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

layout(set = 0, binding = 96, std430) buffer Volumes {
    int volumes[]; // of chunks
};

shared int sum;

void main() {
    if (gl_LocalInvocationID.x == 0u) {
        sum = 0;
    }
    barrier();
    uint triangle = element_visited();
    if (triangle < constants.triangle_count) {
        vec3 origin = vec3(0.0, constants.floor_y, 0.0);
        vec3 a = new_state[triangles[3u * triangle]].position - origin;
        vec3 b = new_state[triangles[3u * triangle + 1u]].position - origin;
        vec3 c = new_state[triangles[3u * triangle + 2u]].position - origin;
        atomicAdd(sum, int(round(constants.outward * dot(a, cross(b, c)) / 6.0 * UNITS)));
    }
    barrier();
    uint chunk = chunk_visited();
    if (gl_LocalInvocationID.x == 0u && chunk != NONE) {
        atomicAdd(film.mesh_volume, sum - volumes[chunk]);
        volumes[chunk] = sum;
    }
}
