#version 450

// Each particle of smoke adds its extinction to the eight cells around it: as much as its square's opacity comes to over
// the square, so that thin smoke looks as dense either way. Sums are of integers: their order does not matter.

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/flames.glsl"
#include "burning/smoke.glsl"
#include "burning/smoke-volume.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(set = 0, binding = 57, std430) readonly buffer SmokeGrid {
    SmokeBox grid;
};

layout(set = 0, binding = 58, std430) buffer SmokeSums {
    uint smoke_sums[];
};

// The integral of clamp(1 - r - 0.7 (noise - 0.3), 0, 1) over the square (draw-smoke.frag), in the mean over the noise.
const float BODY = 0.775;

void main() {
    uint i = element(64u);
    if (i >= constants.smoke_pool) {
        return;
    }
    Particle p = particles[constants.fire_pool + i];
    if (p.life_ticks <= 0.0) {
        return;
    }
    float age = clamp(p.age_ticks / p.life_ticks, 0.0, 1.0);
    float size = smoke_size(age, p.random.y);
    float own = BODY * smoke_opacity(age) * size * size;
    vec3 at = (p.position - grid.low) / grid.cell_width - 0.5;
    ivec3 first = clamp(ivec3(floor(at)), ivec3(0), ivec3(SMOKE_CELLS - 2));
    vec3 t = clamp(at - vec3(first), 0.0, 1.0);
    for (int k = 0; k < 8; k++) {
        ivec3 corner = ivec3(k & 1, (k >> 1) & 1, k >> 2);
        vec3 weight = mix(1.0 - t, t, vec3(corner));
        uint share = uint(own * weight.x * weight.y * weight.z * SMOKE_UNITS + 0.5);
        atomicAdd(smoke_sums[number_of(first + corner)], share);
    }
}
