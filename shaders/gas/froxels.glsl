// Froxels (ours; after B. Wronski, "Volumetric Fog", 2014): cells of the view frustum, columns and rows of the picture and
// slices even in the logarithm of depth, from the depth at which the first volume begins to that at which the last one ends.

// Depth of the border before a slice, or behind the one before it.
float slice_border(uint border) {
    float ratio = counts.froxels_last_m / counts.froxels_first_m;
    return counts.froxels_first_m * pow(ratio, float(border) / float(counts.froxel_slices));
}

// The ray in the middle of a column, of depth 1.
vec3 column_ray(uvec2 column) {
    vec2 pixels = vec2(frame.size) / vec2(float(counts.froxel_columns), float(counts.froxel_rows));
    return ray_direction((vec2(column) + 0.5) * pixels);
}
