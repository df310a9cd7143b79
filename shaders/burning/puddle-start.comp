#version 450

// The volume that the mesh has before it melts.

layout(local_size_x = 1) in;

#include "burning/puddle.glsl"

layout(set = 0, binding = 72, std430) buffer Films {
    Film film;
};

void main() {
    if (film.has_started == 0u) {
        film.volume_at_start = film.mesh_volume;
        film.has_started = 1u;
    }
}
