#version 450

#pragma variants LIGHT=sun,flames

// A square for each particle, smoke first: what of it hides fire is in front mostly, and fire shines through.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"
#include "burning/light-{LIGHT}.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(location = 0) out vec2 square_coordinates; // -1 to 1
layout(location = 1) out float eye_depth; // distance along the view, diagonals
layout(location = 2) out float age_fraction; // of its life
layout(location = 3) out float own_random; // 0 to 1
layout(location = 4) out float fire_flag; // 1, or 0 for smoke
#ifdef LIGHT_FLAMES
layout(location = 5) out vec3 smoke_light; // of the flames, linear RGB
#endif

// Of the square, times the particle's radius, the most that it comes to. Smoke spreads.
vec2 half_size(bool is_fire, float age, float random) {
    if (is_fire) {
        return FLAME_SIZE * flame_height(age, random);
    }
    return vec2((0.45 + 0.55 * age) * (0.75 + 0.25 * random));
}

void main() {
    uint instance = uint(gl_InstanceIndex);
    uint fire_pool = constants.fire_pool;
    uint smoke_pool = constants.smoke_pool;
    bool is_fire = instance >= smoke_pool;
    Particle p = particles[is_fire ? instance - smoke_pool : instance + fire_pool];
    age_fraction = clamp(p.age_ticks / max(p.life_ticks, 1.0), 0.0, 1.0);
    vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
#ifdef LIGHT_FLAMES
    // Beyond this a flame is dark, whatever its noise.
    corner.x *= is_fire ? 0.881 : 1.0;
    smoke_light = vec3(0.0);
    if (!is_fire) {
        smoke_light = scattered(p.position);
    }
#endif
    vec2 size = billboards.particle_radius * half_size(is_fire, age_fraction, p.random.y);
    vec3 position = p.position + corner.x * size.x * billboards.right + corner.y * size.y * billboards.up;
    square_coordinates = corner;
    own_random = p.random.x;
    fire_flag = is_fire ? 1.0 : 0.0;
    gl_Position = view.view_projection * vec4(position, 1.0);
    eye_depth = gl_Position.w;
    if (p.life_ticks <= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // nothing of it lies in the picture
    }
}
