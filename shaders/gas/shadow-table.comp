#version 450

// Section "Calculation of the shadow table", figure 2: the sum of density times step between an entry and the light.
// The ray towards the light pierces a face of the cube of the entry's neighbours; there the sums of the four entries
// round the point, and their densities times the distance to it, are interpolated. They must be finished before: the
// text sorts the entries by their distance from the light, which reads unfinished ones where a farther entry lies on a
// nearer ray. Here a dispatch does all entries of one Manhattan distance, counted in entries from the cell that holds
// the light, along each axis from where on it is the longest of some entry's ray: the four are nearer by it always. They
// are whole planes where one axis is the longest of all rays, as under every light at infinity. The eight entries of the light's cell see it
// before the face and are integrated directly. What lies outside the table has no density. The text lists six of the cube's eight corners, and
// stores sums of densities that it multiplies by one step later; ours are times their own steps, which differ with the
// ray.

layout(local_size_x = 8, local_size_y = 8) in;

#include "gas/frame.glsl"

layout(set = 0, binding = 15, std430) readonly buffer DensityTables {
    vec2 density_tables[]; // of an entry, and of the one after it in x
};

layout(set = 0, binding = 16, std430) buffer ShadowTables {
    vec2 shadow_tables[]; // a table a volume and light: of an entry, and of the one after it in x
};

layout(push_constant, std430) uniform Wave {
    vec3 source; // a point light, or the direction towards one at infinity, in entries
    uint is_point; // 1 or 0
    vec3 spacing_m; // between entries
    int distance; // from the light's cell to this wave's entries
    ivec3 cell; // the light's; -1 or the last entry where it lies outside
    uint first_density; // entry of the volume's densities
    ivec2 first_column; // of entries that this wave may have, along the threads' axes
    ivec2 free; // distances along the threads' axes that are not counted
    ivec3 column_axis; // of the threads' columns, a unit vector
    uint first_sum; // entry of the volume's and light's sums
    ivec3 row_axis; // and of their rows
} wave;

int component(ivec3 of, ivec3 axis) {
    ivec3 parts = of * axis;
    return parts.x + parts.y + parts.z;
}

int distance_along(int entry, int cell) {
    return entry <= cell ? cell - entry : entry - cell - 1;
}

uint index_of(ivec3 entry) {
    int n = int(frame.table_size);
    return uint((entry.z * n + entry.y) * n + entry.x);
}

// Of an entry and of the one after it in x, the sums plus the densities over the step to them.
vec2 sums_through(ivec3 entry, float step_m) {
    uint at = index_of(entry);
    return shadow_tables[wave.first_sum + at] + density_tables[wave.first_density + at] * step_m;
}

float sum_to_light(ivec3 entry) {
    int n = int(frame.table_size);
    vec3 to_light = wave.is_point == 0u ? wave.source : wave.source - vec3(entry);
    // At a face and leaving the table: nothing lies between the entry and the light.
    for (int axis = 0; axis < 3; axis++) {
        if ((entry[axis] == 0 && to_light[axis] < 0.0) || (entry[axis] == n - 1 && to_light[axis] > 0.0)) {
            return 0.0;
        }
    }
    vec3 size = abs(to_light);
    float largest = max(size.x, max(size.y, size.z));
    float distance_m = length(to_light * wave.spacing_m);
    if (wave.is_point != 0u && largest <= 1.0) {
        return density_tables[wave.first_density + index_of(entry)].x * distance_m;
    }
    if (largest <= 0.0) {
        return 0.0;
    }
    // The offset to the face, a whole entry along its largest axis; b and c run along the face.
    vec3 to_face = to_light / largest;
    float step_m = distance_m / largest;
    ivec3 a = size.x == largest ? ivec3(1, 0, 0) : (size.y == largest ? ivec3(0, 1, 0) : ivec3(0, 0, 1));
    ivec3 b = ivec3(a.z, a.x, a.y);
    ivec3 c = ivec3(a.y, a.z, a.x);
    ivec3 signs = ivec3(to_light.x >= 0.0 ? 1 : -1, to_light.y >= 0.0 ? 1 : -1, to_light.z >= 0.0 ? 1 : -1);
    ivec3 last = ivec3(n - 1);
    ivec3 base = entry + a * signs;
    float fraction_b = abs(dot(to_face, vec3(b)));
    float fraction_c = abs(dot(to_face, vec3(c)));
    // Beyond a face only with fraction 0: clamped, not read outside.
    ivec3 base_b = clamp(base + b * signs, ivec3(0), last);
    ivec3 base_c = clamp(base + c * signs, ivec3(0), last);
    ivec3 base_bc = clamp(base + (b + c) * signs, ivec3(0), last);
    // Two that are beside each other in x are read at once. What is not needed, and may be unfinished, is read and left.
    bool is_along_x = a.x != 0;
    bool is_b_x = b.x != 0;
    int first_x = is_along_x ? base.x : min(base.x, is_b_x ? base_b.x : base_c.x);
    bool is_turned = !is_along_x && first_x != base.x;
    bool is_beside = !is_along_x && (is_b_x ? base_b.x : base_c.x) != base.x;
    ivec3 across = is_b_x ? base_c : base_b; // along the axis of the face that is not x, or one of the two
    vec2 near = sums_through(ivec3(first_x, base.yz), step_m);
    vec2 far = sums_through(ivec3(first_x, across.yz), step_m);
    float s0 = is_turned ? near.y : near.x;
    float s_across = is_turned ? far.y : far.x;
    float s_x = is_beside ? (is_turned ? near.x : near.y) : s0;
    float s_both = is_beside ? (is_turned ? far.x : far.y) : s_across;
    float sb = is_b_x ? s_x : s_across;
    float sc = is_b_x ? s_across : s_x;
    if (is_along_x) {
        sc = sums_through(base_c, step_m).x;
        s_both = sums_through(base_bc, step_m).x;
    }
    bool has_b = fraction_b > 0.0;
    bool has_c = fraction_c > 0.0;
    float sbc = has_b && has_c ? s_both : (has_b ? sb : s0);
    sb = has_b ? sb : s0;
    sc = has_c ? sc : s0;
    return mix(mix(s0, sb, fraction_b), mix(sc, sbc, fraction_b), fraction_c);
}

void main() {
    int n = int(frame.table_size);
    ivec2 at = ivec2(gl_GlobalInvocationID.xy) + wave.first_column;
    if (at.x >= n || at.y >= n) {
        return;
    }
    ivec3 swept_axis = ivec3(1) - wave.column_axis - wave.row_axis;
    ivec3 column = wave.column_axis * at.x + wave.row_axis * at.y;
    ivec2 distances = max(ivec2(distance_along(at.x, component(wave.cell, wave.column_axis)),
        distance_along(at.y, component(wave.cell, wave.row_axis))) - wave.free, ivec2(0));
    int along = wave.distance - distances.x - distances.y;
    if (along < 0) {
        return;
    }
    // Along the third axis two entries have the distance, one on each side of the light's cell, or one where it lies outside.
    int cell = component(wave.cell, swept_axis);
    int nearer = cell - along;
    int beyond = cell + 1 + along;
    bool has_beyond = beyond < n;
    int place = nearer >= 0 ? nearer : beyond;
    bool is_left = nearer >= 0 || has_beyond;
    do {
        if (is_left) {
            ivec3 entry = column + swept_axis * place;
            float sum = sum_to_light(entry);
            uint to = wave.first_sum + index_of(entry);
            shadow_tables[to].x = sum;
            // Of the last one of a row the first stands for the one after it, which none asks for.
            uint before = entry.x > 0 ? to - 1u : to + uint(n - 1);
            shadow_tables[before].y = sum;
        }
        is_left = is_left && has_beyond && place != beyond;
        place = beyond;
    } while (is_left);
}
