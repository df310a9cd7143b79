#version 450

#pragma variants LIGHT=sun,flames

// Each particle of a chunk says which lines of tiles its square reaches, and leaves what the tiles ask of it (ours).

layout(local_size_x = 64) in;

#include "common/elements.glsl"
#include "burning/constants.glsl"
#include "burning/view.glsl"
#include "burning/flames.glsl"
#include "burning/smoke.glsl"
#include "burning/fire-layer.glsl"
#include "burning/light-{LIGHT}.glsl"

layout(set = 0, binding = 43, std430) readonly buffer Particles {
    Particle particles[]; // fire, then smoke
};

layout(set = 0, binding = 116, r32ui) uniform uimage2D line_masks;
layout(set = 0, binding = 117, rgba32f) uniform writeonly image2D fire_records;

void reach_line(uint slot, uint line) {
    uint word = slot / 32u;
    uint before = imageAtomicOr(line_masks, ivec2(word, line), 1u << (slot % 32u));
    if (before == 0u) {
        imageAtomicOr(line_masks, ivec2(WORDS + word / 32u, line), 1u << (word % 32u));
    }
}

void main() {
    uint slot = element(64u);
    uint place = chunk.first + slot;
    bool is_smoke = place < chunk.fire_from;
    uint in_pool = is_smoke ? place : place - chunk.fire_from;
    uint number = is_smoke ? constants.fire_pool + in_pool : in_pool;
    Particle p = particles[min(number, constants.fire_pool + constants.smoke_pool - 1u)];
    float age = clamp(p.age_ticks / max(p.life_ticks, 1.0), 0.0, 1.0);
    // Before any branch: the lights are the same for all threads.
#ifdef LIGHT_FLAMES
    vec3 grey = SMOKE_GREY + SMOKE_ALBEDO * scattered(p.position);
#else
    vec3 grey = smoke_by_itself(age);
#endif
    vec4 middle = view.view_projection * vec4(p.position, 1.0);
    vec2 half_size = billboards.particle_radius * FLAME_SIZE * flame_height(age, p.random.y);
    if (is_smoke) {
        half_size = vec2(billboards.particle_radius * smoke_size(age, p.random.y));
    }
    // All of a square is at one distance, and its sides are the picture's.
    float right = (view.view_projection * vec4(half_size.x * billboards.right, 0.0)).x;
    float up = (view.view_projection * vec4(half_size.y * billboards.up, 0.0)).y;
    vec2 size = vec2(billboards.layer_size);
    vec2 half_pixels = 0.5 * size * vec2(right, up) / middle.w;
    vec2 center = 0.5 * size * (middle.xy / middle.w + 1.0) - 0.5;
    vec2 reach = abs(half_pixels) * vec2(is_smoke ? 1.0 : WIDEST, 1.0);
    ivec2 low = max(ivec2(ceil(clamp(center - reach, vec2(0.0), size))), ivec2(0));
    ivec2 high = min(ivec2(floor(clamp(center + reach, vec2(-1.0), size - 1.0))), ivec2(size) - 1);
    bool is_there = slot < CHUNK && in_pool < (is_smoke ? constants.smoke_pool : constants.fire_pool);
    // Smaller squares meet no pixel's middle, and places in them have no number.
    bool is_seen = middle.w > 0.0 && middle.z >= 0.0 && middle.z <= middle.w && min(reach.x, reach.y) > 1.0e-3;
    if (!is_there || !is_seen || p.life_ticks <= 0.0 || any(greaterThan(low, high))) {
        return;
    }
    ivec2 record = record_at(slot);
    imageStore(fire_records, record, vec4(center, 1.0 / half_pixels));
    imageStore(fire_records, record + ivec2(0, 1), vec4(middle.w, age, p.random.x, 0.0));
    imageStore(fire_records, record + ivec2(0, 2), vec4(grey, smoke_opacity(age)));
    uint columns = tiles_of_layer().x;
    for (uint x = uint(low.x) / TILE; x <= uint(high.x) / TILE; x++) {
        reach_line(slot, x);
    }
    for (uint y = uint(low.y) / TILE; y <= uint(high.y) / TILE; y++) {
        reach_line(slot, columns + y);
    }
}
