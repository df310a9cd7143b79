// Sections of gas from the sums along the columns of froxels: what lies between two depths is the difference of the sums there. All
// columns are asked at the pixel's own depths, so that a surface bounds the gas before it as it does where rays are marched,
// and nothing of what is behind it leaks around it.

#include "gas/gas.glsl"
#include "gas/froxels.glsl"

layout(set = 0, binding = 34) uniform texture3D froxel_sums;

void take_pixel(uvec2 pixel, uint pixel_index) {}

// No part of a section is left for another dispatch.
void take_up(uvec4 first, uvec4 second) {}

uvec4 first_left() {
    return uvec4(0u);
}

uvec4 second_left() {
    return uvec4(0u);
}

void read_scene() {
    read_counts();
    read_volumes();
}

// A depth: the slice that it lies in, and the part of the slice before it.
struct Place {
    uint slice;
    float part;
};

Place place_of(float depth) {
    float ratio = log(counts.froxels_last_m / counts.froxels_first_m);
    float at = log(max(depth / counts.froxels_first_m, 1.0)) / ratio * float(counts.froxel_slices);
    uint slice = min(uint(at), counts.froxel_slices - 1u);
    float near_m = slice_border(slice);
    float part = (depth - near_m) / (slice_border(slice + 1u) - near_m);
    return Place(slice, clamp(part, 0.0, 1.0));
}

// Light and transparency of a column before a depth: in a slice the gas is the same everywhere.
vec4 column_before(ivec2 column, Place place) {
    vec4 before = vec4(0.0, 0.0, 0.0, 1.0);
    if (place.slice > 0u) {
        before = texelFetch(froxel_sums, ivec3(column, int(place.slice) - 1), 0);
    }
    vec4 behind = texelFetch(froxel_sums, ivec3(column, int(place.slice)), 0);
    float whole = before.w > 0.0 ? behind.w / before.w : 1.0; // transparency of the slice
    float passed = whole < 1.0 ? pow(max(whole, 1.0e-37), place.part) : 1.0;
    float share = whole < 0.999 ? (1.0 - passed) / (1.0 - whole) : place.part;
    return vec4(mix(before.xyz, behind.xyz, share), before.w * passed);
}

// The four columns round a pixel.
vec4 gas_before(uvec2 pixel, float depth) {
    Place place = place_of(depth);
    vec2 size = vec2(float(counts.froxel_columns), float(counts.froxel_rows));
    vec2 at = clamp((vec2(pixel) + 0.5) * size / vec2(frame.size) - 0.5, vec2(0.0), size - 1.0);
    ivec2 low = ivec2(at);
    ivec2 high = min(low + 1, ivec2(size) - 1);
    vec2 t = at - vec2(low);
    vec4 columns[4];
    for (uint i = 0u; i < 4u; i++) {
        columns[i] = column_before(ivec2((i & 1u) == 0u ? low.x : high.x, i < 2u ? low.y : high.y), place);
    }
    return mix(mix(columns[0], columns[1], t.x), mix(columns[2], columns[3], t.x), t.y);
}

bool ends_at(float transparency) {
    return transparency < frame.early_end;
}

Gas march(uint pixel_index, vec3 ray, vec2 segments[MAX_VOLUMES], vec2 extent, float before, uint first_number, Gas begun) {
    uvec2 pixel = uvec2(pixel_index % frame.size.x, pixel_index / frame.size.x);
    vec4 near = gas_before(pixel, extent.x);
    vec4 far = gas_before(pixel, extent.y);
    bool is_lit = near.w > 0.0;
    vec3 color = is_lit ? max(far.xyz - near.xyz, vec3(0.0)) / near.w : vec3(0.0);
    return Gas(color, is_lit ? min(far.w / near.w, 1.0) : 1.0, 1u, 0u, true);
}
