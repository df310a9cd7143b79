// Light of a file's temperatures (ours): that of a black body at each sample, interpolated linearly along each axis whatever the
// density's interpolation is.

layout(set = 0, binding = 35, std430) readonly buffer Glow {
    vec4 glow[]; // as grid_samples, where there are temperatures; linear RGB
};

vec3 glow_at(vec3 world) {
    if (counts.glow == 0u) {
        return vec3(0.0);
    }
    Grid grid = grids[index_in_hand];
    vec3 at = grid_position(grid, world);
    uvec3 size = grid_size(grid);
    vec3 low = floor(at);
    vec3 t = at - low;
    uvec3 a = nearest_sample(ivec3(low), size);
    uvec3 b = nearest_sample(ivec3(low) + 1, size);
    uint first = grid.first;
    uint rows00 = first + (a.z * size.y + a.y) * size.x;
    uint rows10 = first + (a.z * size.y + b.y) * size.x;
    uint rows01 = first + (b.z * size.y + a.y) * size.x;
    uint rows11 = first + (b.z * size.y + b.y) * size.x;
    vec3 s00 = mix(glow[rows00 + a.x].xyz, glow[rows00 + b.x].xyz, t.x);
    vec3 s10 = mix(glow[rows10 + a.x].xyz, glow[rows10 + b.x].xyz, t.x);
    vec3 s01 = mix(glow[rows01 + a.x].xyz, glow[rows01 + b.x].xyz, t.x);
    vec3 s11 = mix(glow[rows11 + a.x].xyz, glow[rows11 + b.x].xyz, t.x);
    return mix(mix(s00, s10, t.y), mix(s01, s11, t.y), t.z);
}
