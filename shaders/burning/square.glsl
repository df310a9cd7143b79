// The square of a particle, as the vertex stages of `draw-fire` place it: it faces the viewer, so that all of it is at
// one distance.

#include "burning/view.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(location = 0) noperspective out vec2 square_coordinates; // -1 to 1
layout(location = 1) flat out float eye_depth; // distance along the view, diagonals
layout(location = 2) flat out float age_fraction; // of its life
layout(location = 3) flat out float own_random; // 0 to 1

float age_of(Particle p) {
    return clamp(p.age_ticks / max(p.life_ticks, 1.0), 0.0, 1.0);
}

// Six vertices a square, of two triangles: a draw of an instance each takes drivers without hardware far longer.
uint square_of_vertex() {
    return uint(gl_VertexIndex) / 6u;
}

// -1 to 1.
vec2 corner_of_vertex() {
    uint vertex = uint(gl_VertexIndex) % 6u;
    // Corners 0, 1, 2 and 3, 2, 1.
    uint corner = vertex < 3u ? vertex : 6u - vertex;
    return vec2(corner & 1u, corner >> 1u) * 2.0 - 1.0;
}

// A corner, -1 to 1, of a square of this half size in radii of a particle.
void place(Particle p, vec2 corner, vec2 half_size) {
    vec2 size = billboards.particle_radius * half_size;
    vec3 position = p.position + corner.x * size.x * billboards.right + corner.y * size.y * billboards.up;
    square_coordinates = corner;
    age_fraction = age_of(p);
    own_random = p.random.x;
    gl_Position = view.view_projection * vec4(position, 1.0);
    eye_depth = gl_Position.w;
    if (p.life_ticks <= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // nothing of it lies in the picture
    }
}
