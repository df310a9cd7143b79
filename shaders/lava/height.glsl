// The height field between its texels, for rays: bilinear over the columns' middles, as surface.glsl reads it for splats.

layout(set = 0, binding = 1) uniform texture2D normal_height;

// Places in columns: the middle of the texel (i, k) is at (i, k), the space reaches from -0.5 to columns - 0.5.
vec2 columns_at(vec2 place_m) {
    return place_m / scene.space_m.xz * scene.columns - 0.5;
}

vec4 texel_at(vec2 column) {
    return texelFetch(normal_height, ivec2(clamp(column, vec2(0.0), scene.columns - 1.0)), 0);
}

// The normal (not of unit length) and the height at a place in columns.
vec4 surface_at(vec2 column) {
    vec2 base = floor(column);
    vec2 fraction = column - base;
    vec4 near_row = mix(texel_at(base), texel_at(base + vec2(1.0, 0.0)), fraction.x);
    vec4 far_row = mix(texel_at(base + vec2(0.0, 1.0)), texel_at(base + vec2(1.0, 1.0)), fraction.x);
    return mix(near_row, far_row, fraction.y);
}
