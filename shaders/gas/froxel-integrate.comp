#version 450

// Light and transparency of all gas before the far border of each froxel: the sum of the section "Volume rendering" along each
// column, a slice an increment.

layout(local_size_x = 8, local_size_y = 8) in;

#extension GL_EXT_samplerless_texture_functions : require

#include "gas/frame.glsl"
#include "gas/counts.glsl"
#include "gas/froxels.glsl"

layout(set = 0, binding = 32) uniform texture3D froxel_light;

layout(set = 0, binding = 33, rgba32f) uniform writeonly image3D froxel_sums;

void main() {
    uvec2 column = gl_GlobalInvocationID.xy;
    if (column.x >= counts.froxel_columns || column.y >= counts.froxel_rows) {
        return;
    }
    float scale = length(column_ray(column));
    vec3 color = vec3(0.0);
    float transparency = 1.0;
    float near_m = slice_border(0u);
    for (uint slice = 0u; slice < counts.froxel_slices; slice++) {
        float far_m = slice_border(slice + 1u);
        vec4 light = texelFetch(froxel_light, ivec3(ivec2(column), int(slice)), 0);
        if (light.w > 0.0) {
            float passed = exp(-light.w * (far_m - near_m) * scale);
            color += light.xyz / light.w * (transparency * (1.0 - passed));
            transparency *= passed;
        }
        imageStore(froxel_sums, ivec3(ivec2(column), int(slice)), vec4(color, transparency));
        near_m = far_m;
    }
}
