// The water's surface by a height map (section 5.2 leaves its shape to the program): the bicubic spline through the samples, given
// by the coefficients of its B-spline. Its curvature is continuous, and with it the caustic's brightness, so that no pattern of the
// map's cells shows. Beyond the border the border's coefficients go on.

struct HeightMap {
    vec2 node; // x and z of the sample (columns / 2, rows / 2), metres
    vec2 spacing; // between columns and between rows, metres
    uint columns; // along x
    uint rows; // along z
};

layout(std430, set = 0, binding = 0) readonly buffer Coefficients {
    float list[]; // metres above the level, row by row
} coefficients;

// Weights of four coefficients at the fraction t between the second and the third.
vec4 b_spline(float t) {
    float s = 1.0 - t;
    return vec4(s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0, 3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t) / 6.0;
}

// Their derivatives by t.
vec4 b_spline_slope(float t) {
    float s = 1.0 - t;
    return 0.5 * vec4(-s * s, 3.0 * t * t - 4.0 * t, 4.0 * s - 3.0 * s * s, t * t);
}

float coefficient_at(HeightMap map, ivec2 at) {
    ivec2 inside = clamp(at, ivec2(0), ivec2(int(map.columns), int(map.rows)) - 1);
    return coefficients.list[inside.y * int(map.columns) + inside.x];
}

vec4 four_along_x(HeightMap map, ivec2 second) {
    return vec4(coefficient_at(map, second - ivec2(1, 0)), coefficient_at(map, second), coefficient_at(map, second + ivec2(1, 0)),
        coefficient_at(map, second + ivec2(2, 0)));
}

// Height above the level in x, slopes along x and z in y and z.
vec3 map_at(HeightMap map, vec2 place) {
    vec2 size = vec2(float(map.columns), float(map.rows));
    // Two samples beyond the border all four are the border's, and farther out nothing changes.
    vec2 at = clamp((place - map.node) / map.spacing, -size - 2.0, size + 2.0);
    vec2 base = floor(at);
    vec2 t = at - base;
    ivec2 second = ivec2(base) + ivec2(int(map.columns / 2u), int(map.rows / 2u));
    // The weights of a slope cancel: small numbers keep its digits.
    float near = coefficient_at(map, second);
    vec4 a = four_along_x(map, second - ivec2(0, 1)) - near;
    vec4 b = four_along_x(map, second) - near;
    vec4 c = four_along_x(map, second + ivec2(0, 1)) - near;
    vec4 d = four_along_x(map, second + ivec2(0, 2)) - near;
    vec4 across = b_spline(t.y);
    vec4 column = a * across.x + b * across.y + c * across.z + d * across.w;
    vec4 along = b_spline(t.x);
    float height = near + dot(column, along);
    float slope_x = dot(column, b_spline_slope(t.x));
    vec4 steps = b_spline_slope(t.y);
    float slope_z = dot(a * steps.x + b * steps.y + c * steps.z + d * steps.w, along);
    return vec3(height, slope_x / map.spacing.x, slope_z / map.spacing.y);
}
