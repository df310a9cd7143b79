#version 450

// A square for each particle, smoke first: what of it hides fire is in front mostly, and fire shines through.

#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/flames.glsl"
#include "burning/billboards.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(location = 0) out vec2 place_in_square; // -1 to 1
layout(location = 1) out vec4 character; // share of its life, two numbers of its own, whether it is fire
layout(location = 2) out float eye_depth;

// Of the square, times the particle's radius, the most that it comes to. A flame is tall, swells at once and tapers; smoke spreads.
vec2 half_size(bool is_fire, float age, float random) {
    if (is_fire) {
        float height = smoothstep(0.0, 0.15, age) * (1.0 - 0.5 * age) * (0.75 + 0.25 * random);
        return vec2(0.75, 1.15) * height;
    }
    return vec2((0.45 + 0.55 * age) * (0.75 + 0.25 * random));
}

void main() {
    uint instance = uint(gl_InstanceIndex);
    uint fire_pool = constants.tree.z;
    uint smoke_pool = constants.tree.w;
    bool is_fire = instance >= smoke_pool;
    Particle p = particles[is_fire ? instance - smoke_pool : instance + fire_pool];
    float life = p.character.x;
    float age = clamp(p.place.w / max(life, 1.0), 0.0, 1.0);
    vec2 corner = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1) * 2.0 - 1.0;
    vec2 size = billboards.right.w * half_size(is_fire, age, p.character.w);
    vec3 place = p.place.xyz + corner.x * size.x * billboards.right.xyz + corner.y * size.y * billboards.up.xyz;
    place_in_square = corner;
    character = vec4(age, p.character.z, p.character.w, is_fire ? 1.0 : 0.0);
    gl_Position = view.view_projection * vec4(place, 1.0);
    eye_depth = gl_Position.w;
    if (life <= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0); // nothing of it lies in the picture
    }
}
