#version 450

// Smoke as a volume: the march of Ebert and Parent (1990, "Volume rendering"), with a sample in the middle of each
// increment. One adds T (1 - exp(-sigma dt)) times the light there, T being the transparency before it, and takes
// exp(-sigma dt) off T, as `gas` does (gas/march-steps.glsl). The mesh ends it.

#extension GL_EXT_samplerless_texture_functions : require

#include "burning/view.glsl"
#include "burning/billboards.glsl"
#include "burning/smoke-volume.glsl"

layout(set = 0, binding = 45) uniform texture2D mesh_depth;

layout(set = 0, binding = 57, std430) readonly buffer SmokeGrid {
    SmokeBox grid;
};

layout(set = 0, binding = 59, std430) readonly buffer SmokeCells {
    vec4 smoke_cells[]; // light times extinction, linear RGB; extinction, 1 over diagonals
};

layout(location = 0) out vec4 shaded;

// One a cell of the longest way, about.
const int MOST_INCREMENTS = 96;
// Of which no more is marched.
const float LEAST_TRANSPARENCY = 0.002;

// Between the eight cells around a place.
vec4 smoke_at(vec3 place) {
    vec3 at = (place - grid.low) / grid.cell_width - 0.5;
    ivec3 first = ivec3(floor(at));
    vec3 t = at - vec3(first);
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 8; k++) {
        ivec3 corner = ivec3(k & 1, (k >> 1) & 1, k >> 2);
        vec3 weight = mix(1.0 - t, t, vec3(corner));
        ivec3 cell = clamp(first + corner, ivec3(0), ivec3(SMOKE_CELLS - 1));
        sum += weight.x * weight.y * weight.z * smoke_cells[number_of(cell)];
    }
    return sum;
}

// No division by it is one by 0.
float apart_from_zero(float value) {
    return abs(value) < 1.0e-7 ? 1.0e-7 : value;
}

void main() {
    ivec2 pixel = layer_pixel(ivec2(gl_FragCoord.xy));
    vec2 at = (2.0 * vec2(pixel) + 1.0) / vec2(billboards.last_pixel + uvec2(1u)) - 1.0;
    // The way of the pixel's ray for each distance along the view, by the rows of the projection.
    mat4 to_clip = view.view_projection;
    float along_x = dot(vec3(to_clip[0][0], to_clip[1][0], to_clip[2][0]), billboards.right);
    float along_y = dot(vec3(to_clip[0][1], to_clip[1][1], to_clip[2][1]), billboards.up);
    vec3 forward = vec3(to_clip[0][3], to_clip[1][3], to_clip[2][3]);
    vec3 ray = forward + billboards.right * (at.x / along_x) + billboards.up * (at.y / along_y);
    vec3 along = vec3(apart_from_zero(ray.x), apart_from_zero(ray.y), apart_from_zero(ray.z));
    float width = grid.cell_width;
    vec3 one = (grid.low - view.eye) / along;
    vec3 other = (grid.low + float(SMOKE_CELLS) * width - view.eye) / along;
    vec3 entries = min(one, other);
    vec3 exits = max(one, other);
    float from = max(max(entries.x, entries.y), max(entries.z, 0.0));
    float mesh = eye_distance(texelFetch(mesh_depth, pixel, 0).x);
    float to = min(min(exits.x, exits.y), min(exits.z, mesh));
    int count = 0;
    float increment = 0.0;
    if (width > 0.0 && to > from) {
        count = clamp(int(ceil((to - from) * length(ray) / width)), 1, MOST_INCREMENTS);
        increment = (to - from) / float(count);
    }
    vec3 light = vec3(0.0);
    float transparency = 1.0;
    for (int i = 0; i < MOST_INCREMENTS && i < count && transparency > LEAST_TRANSPARENCY; i++) {
        vec4 lit = smoke_at(view.eye + ray * (from + (float(i) + 0.5) * increment));
        float kept = exp(-lit.a * increment * length(ray));
        light += transparency * (1.0 - kept) * lit.rgb / max(lit.a, 1.0e-12);
        transparency *= kept;
    }
    shaded = vec4(light, 1.0 - transparency);
}
