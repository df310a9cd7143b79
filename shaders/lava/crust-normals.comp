#version 450

// Normals of the crust from finite differences of its heights, as section 6.4 takes those of the surface.

#extension GL_EXT_samplerless_texture_functions : require

layout(local_size_x = 8, local_size_y = 8) in;

layout(push_constant, std430) uniform Sides {
    vec2 space_m; // along x and z
} sides;

layout(set = 0, binding = 0) uniform texture2D heights; // metres in alpha

layout(set = 0, binding = 1, rgba32f) uniform image2D normal_height;

float height_at(ivec2 column) {
    return texelFetch(heights, column, 0).a;
}

// Height difference per metre along one axis: central, at the sides one-sided.
float slope(ivec2 column, ivec2 axis, float spacing_m) {
    ivec2 last = textureSize(heights, 0) - 1;
    ivec2 before = max(column - axis, ivec2(0));
    ivec2 after = min(column + axis, last);
    ivec2 steps = after - before;
    int count = steps.x + steps.y;
    return count > 0 ? (height_at(after) - height_at(before)) / (float(count) * spacing_m) : 0.0;
}

void main() {
    ivec2 column = ivec2(gl_GlobalInvocationID.xy);
    ivec2 columns = imageSize(normal_height);
    if (column.x >= columns.x || column.y >= columns.y) {
        return;
    }
    vec2 spacing_m = sides.space_m / vec2(columns);
    vec2 slopes = vec2(slope(column, ivec2(1, 0), spacing_m.x), slope(column, ivec2(0, 1), spacing_m.y));
    imageStore(normal_height, column, vec4(normalize(vec3(-slopes.x, 1.0, -slopes.y)), height_at(column)));
}
