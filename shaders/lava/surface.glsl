// The surface at a splat (section 7.1): normal and height by bilinear interpolation, written out, since filters of
// devices differ in precision; tangent and binormal from the normal.

layout(set = 0, binding = 1) uniform texture2D normal_height;

// Steepest slope of a splat, 87 degrees: its inverse.
const float STEEPEST = 0.05;

struct Splat {
    vec3 center_m;
    vec3 tangent;
    vec3 binormal;
};

vec4 texel_at(vec2 column) {
    return texelFetch(normal_height, ivec2(clamp(column, vec2(0.0), scene.columns - 1.0)), 0);
}

Splat splat_at(vec2 place_m) {
    vec2 column = place_m / scene.space_m.xz * scene.columns - 0.5;
    vec2 base = floor(column);
    vec2 fraction = column - base;
    vec4 near_left = texel_at(base);
    vec4 near_right = texel_at(base + vec2(1.0, 0.0));
    vec4 far_left = texel_at(base + vec2(0.0, 1.0));
    vec4 far_right = texel_at(base + vec2(1.0, 1.0));
    vec4 near_row = mix(near_left, near_right, fraction.x);
    vec4 far_row = mix(far_left, far_right, fraction.x);
    vec4 surface = mix(near_row, far_row, fraction.y);
    vec3 normal = normalize(surface.xyz);

    Splat splat;
    splat.center_m = vec3(place_m.x, surface.w, place_m.y);
    // The normal points upwards, so it is never along z.
    vec3 tangent = normalize(vec3(normal.y, -normal.x, 0.0));
    // Ours: as long down a slope as the disc is that it covers of the map, so that a slope's splats lie as close as a plain's. The slope is
    // that of the heights between the columns, which the normals leave at the border.
    vec2 slope = vec2(mix(near_right.w - near_left.w, far_right.w - far_left.w, fraction.y), far_row.w - near_row.w);
    slope = clamp(slope / scene.space_m.xz * scene.columns, -1.0 / STEEPEST, 1.0 / STEEPEST);
    splat.tangent = mix(tangent, vec3(1.0, slope.x, 0.0), scene.fitted);
    splat.binormal = mix(cross(normal, tangent), vec3(0.0, -slope.y, -1.0), scene.fitted);
    return splat;
}

// A corner of the splat's square, -1 or 1 along tangent and binormal.
vec3 corner_of(Splat splat, vec2 corner) {
    return splat.center_m + scene.splat_radius_m * (corner.x * splat.tangent + corner.y * splat.binormal);
}
