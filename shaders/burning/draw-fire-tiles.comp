#version 450

// Each particle marks the tiles that its square reaches with the number of the picture (ours).

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/flames.glsl"
#include "burning/smoke.glsl"
#include "burning/billboards.glsl"
#include "burning/fire-tiles.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(set = 0, binding = 114, std430) buffer Tiles {
    uint tiles[]; // row by row, the picture that fire or smoke reached each in last
};

void main() {
    uint particle = element(64u);
    if (particle >= constants.fire_pool + constants.smoke_pool) {
        return;
    }
    Particle p = particles[particle];
    vec4 middle = view.view_projection * vec4(p.position, 1.0);
    if (p.life_ticks <= 0.0 || middle.w <= 0.0) {
        return;
    }
    float age = clamp(p.age_ticks / p.life_ticks, 0.0, 1.0);
    vec2 half_size = billboards.particle_radius * FLAME_SIZE * flame_height(age, p.random.y);
    if (particle >= constants.fire_pool) {
        half_size = vec2(billboards.particle_radius * smoke_size(age, p.random.y));
    }
    vec3 to_corner = half_size.x * billboards.right + half_size.y * billboards.up;
    // All of a square is at one distance.
    vec2 reach = abs((view.view_projection * vec4(to_corner, 0.0)).xy) / middle.w;
    // Pixels take of the layer's pixels around them, and the layer's size is rounded up.
    vec2 pixels = vec2(billboards.last_pixel) + 1.0;
    reach += 2.0 * (3.0 * float(billboards.layer_scale) + 1.0) / pixels;
    vec2 at = middle.xy / middle.w;
    float last = float(TILES - 1u);
    uvec2 low = uvec2(clamp((at - reach) * 0.5 + 0.5, 0.0, 1.0) * float(TILES));
    uvec2 high = uvec2(clamp(((at + reach) * 0.5 + 0.5) * float(TILES), 0.0, last));
    for (uint y = low.y; y <= high.y; y++) {
        for (uint x = low.x; x <= high.x; x++) {
            // Whoever marks a tile writes the same.
            tiles[y * TILES + x] = laying.picture;
        }
    }
}
