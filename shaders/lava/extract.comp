#version 450

// A column's accepted grid points (section 6.2): their number and the sum of their heights, or for the other surfaces the
// one height that stands for them; and the range of the column's densities. The sums of eq. 6.3 begin at nothing.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant, std430) uniform Extract {
    uvec3 grid; // columns, planes, rows
    float rho;
    float space_m; // along y
    uint kind; // of the surface
} extract;

layout(set = 0, binding = 0) uniform texture2DArray density;
layout(set = 0, binding = 1, rgba32f) uniform writeonly image2D columns;
layout(set = 0, binding = 2, rgba32f) uniform writeonly image2D sums;

// In the order of the host's `SurfaceKind`.
const uint MEAN = 0u;
const uint TOP = 1u;

float count = 0.0;
float sum_m = 0.0;
float top_m = 0.0;
float crossing_m = 0.0;
float below = 0.0; // density of the highest accepted point
bool is_open = false; // the plane above it has not been seen
float lowest = 3.0e38;
float highest = 0.0;

// Planes come from the lowest up.
void take(uint plane, float found) {
    if (plane >= extract.grid.y) {
        return;
    }
    float height_m = (float(plane) + 0.5) / float(extract.grid.y) * extract.space_m;
    lowest = min(lowest, found);
    highest = max(highest, found);
    if (found >= extract.rho) {
        count += 1.0;
        sum_m += height_m;
        top_m = height_m;
        crossing_m = height_m;
        below = found;
        is_open = true;
    } else if (is_open) {
        crossing_m += (below - extract.rho) / (below - found) * (height_m - crossing_m);
        is_open = false;
    }
}

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    if (column.x >= int(extract.grid.x) || column.y >= int(extract.grid.z)) {
        return;
    }
    for (uint plane = 0u; plane < extract.grid.y; plane += 4u) {
        vec4 found = texelFetch(density, ivec3(column, int(plane / 4u)), 0);
        take(plane, found.x);
        take(plane + 1u, found.y);
        take(plane + 2u, found.z);
        take(plane + 3u, found.w);
    }
    float height_m = extract.kind == MEAN ? sum_m : extract.kind == TOP ? top_m : crossing_m;
    imageStore(columns, column, vec4(count, height_m, lowest, highest));
    imageStore(sums, column, vec4(0.0));
}
